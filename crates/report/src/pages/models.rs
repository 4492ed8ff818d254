//! Models held against each other: the answer for every material and environment, what each leaves, and their curves. It
//! shows what `ieap compare` stored.

use std::collections::BTreeMap;

use serde::Serialize;

use super::Content;
use crate::error::ReportError;
use crate::figures::svg::inline;
use crate::input::Input;
use crate::prints::models::of_run;
use crate::site::Site;
use ieap_analysis::models_compared::{ComparedCondition, ComparedModel, models_compared, outdated};
use ieap_domain::number::{fixed, significant, with_sign};

/// Width of a figure, px.
const WIDTH: u32 = 560;

#[derive(Debug, Serialize)]
struct Page {
    outdated: String,
    conditions: Vec<Condition>,
}

#[derive(Debug, Serialize)]
struct Condition {
    id: String,
    title: String,
    sentence: String,
    rows: Vec<Row>,
    figure: String,
    run: String,
    href: String,
}

#[derive(Debug, Serialize)]
struct Row {
    model: String,
    cells: Vec<String>,
}

/// Whether models were compared.
pub fn is_shown(input: &Input) -> bool {
    !input.comparisons.is_empty()
}

/// Makes the page.
pub fn content(site: &Site) -> Result<Content, ReportError> {
    let input = site.input;
    let found = models_compared(&input.comparisons, &input.runs, &input.campaign);
    let mut figures = BTreeMap::new();
    let mut conditions = Vec::new();
    for (number, condition) in found.iter().enumerate() {
        conditions.push(shown(site, number, condition, &mut figures)?);
    }
    let page = Page {
        outdated: outdated(input.outdated_comparisons),
        conditions,
    };
    Content::new("models.html", &page, figures)
}

fn shown(
    site: &Site,
    number: usize,
    condition: &ComparedCondition,
    figures: &mut BTreeMap<String, String>,
) -> Result<Condition, ReportError> {
    let figure = format!("models-{number}");
    let (mut run, mut href) = (String::new(), String::new());
    // The run at the highest voltage, as in the figure for print.
    if let Some(&last) = condition.comparisons.last() {
        let one = &site.input.comparisons[last];
        let title = format!(
            "{} in {}: models compared",
            condition.material, condition.surroundings
        );
        let drawn = of_run(site, one, WIDTH).map_err(|reason| ReportError::Figure {
            figure: figure.clone(),
            reason,
        })?;
        figures.insert(figure.clone(), inline(&drawn, &title, &condition.sentence));
        if let Some(place) = site.input.runs.iter().position(|run| run.path == one.run) {
            run = site.run_name(place).to_owned();
            href = site.run_href(place);
        }
    }
    Ok(Condition {
        id: figure.clone(),
        title: format!("{} in {}", condition.material, condition.surroundings),
        sentence: condition.sentence.clone(),
        rows: condition.models.iter().map(row).collect(),
        figure,
        run,
        href,
    })
}

fn row(model: &ComparedModel) -> Row {
    let rough = |number: Option<f64>| number.map_or("–".to_owned(), |number| significant(number, 2));
    let whole = |number: Option<f64>| number.map_or("–".to_owned(), |number| fixed(number, 0));
    Row {
        model: model.model.clone(),
        cells: vec![
            model.runs.to_string(),
            whole(model.parameters),
            rough(model.leaves_current),
            rough(model.leaves_curvature),
            rough(model.later),
            rough(model.other_voltages),
            match model.bic_beyond_best {
                Some(0.0) => "best".to_owned(),
                Some(bic) => with_sign(bic, 0),
                None => "–".to_owned(),
            },
        ],
    }
}
