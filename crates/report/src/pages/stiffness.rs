//! Is a change of alpha one of stiffness or of coupling? The answer, one figure, the numbers.

use std::collections::BTreeMap;

use ieap_analysis::conditions::Conditions;
use ieap_analysis::stiffness::{Change, SampleRow, answer, sample_rows, sentences};
use ieap_domain::blocked::LARGEST_BENDING_RAD;
use ieap_domain::{BlockedRun, Estimate, range_of};
use serde::Serialize;

use super::Content;
use super::wording::{EstimateText, IssueText, RunLink, surroundings_label, voltage_label};
use crate::error::ReportError;
use crate::figures::axis::Axis;
use crate::figures::law::{Beside, Curve, Mark, law_panel};
use crate::input::Input;
use crate::site::Site;
use ieap_domain::number::{fixed, significant};

/// N m2 to µN m2, and N m / C to mN m / C.
const MICRO: f64 = 1e6;
const MILLI: f64 = 1e3;
/// Ratios beyond this factor of the least and greatest value do not stretch the axes.
const STRETCH: f64 = 1.5;

#[derive(Debug, Serialize)]
struct Page {
    answer: String,
    sentences: Vec<String>,
    figure: Option<String>,
    samples: Vec<Key>,
    rows: Vec<Row>,
    held: Vec<Held>,
}

/// A sample with its marker in the figure.
#[derive(Debug, Serialize)]
struct Key {
    name: String,
    /// Class of its colour.
    color: usize,
}

#[derive(Debug, Serialize)]
struct Row {
    sample: String,
    condition: String,
    against: String,
    /// Alpha, E I, mu by the modulus, mu of the held strip.
    numbers: Vec<EstimateText>,
    /// Ratios of alpha, E I and mu.
    ratios: Vec<EstimateText>,
    cause: &'static str,
}

/// A run of a held strip.
#[derive(Debug, Serialize)]
struct Held {
    run: Option<RunLink>,
    path: String,
    force: String,
    numbers: Vec<EstimateText>,
    remark: String,
    issues: Vec<IssueText>,
}

/// Whether stiffness or coupling is known of a sample that was measured in two conditions, or a force was measured.
pub fn is_shown(input: &Input) -> bool {
    let is_known = |row: &SampleRow| {
        let of_change =
            |change: &Change| [&change.ratios.stiffness, &change.ratios.coupling].map(|own| own.value);
        row.change
            .as_ref()
            .is_some_and(|change| of_change(change).iter().any(Option::is_some))
    };
    !input.blocked.is_empty()
        || !input.modulus_logs.is_empty() && sample_rows(&input.of_tables()).1.iter().any(is_known)
}

/// Makes the page.
pub fn content(site: &Site) -> Result<Content, ReportError> {
    let (table, rows) = sample_rows(&site.input.of_tables());
    let mut figures = BTreeMap::new();
    let names = names(&rows);
    let figure = figure(&rows, &names, &mut figures)?;
    let page = Page {
        answer: answer(&rows),
        sentences: sentences(&table, &rows),
        samples: match figure {
            Some(_) => keys(&names),
            None => Vec::new(),
        },
        figure,
        rows: rows.iter().map(|row| shown(&table, &rows, row)).collect(),
        held: site
            .input
            .blocked
            .iter()
            .map(|run| held(site, &rows, run))
            .collect(),
    };
    Content::new("stiffness.html", &page, figures)
}

/// Samples that have a change, in the order of the rows.
fn names(rows: &[SampleRow]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for row in rows.iter().filter(|row| row.change.is_some()) {
        if !names.contains(&row.sample) {
            names.push(row.sample.clone());
        }
    }
    names
}

fn keys(names: &[String]) -> Vec<Key> {
    let key = |(at, name): (usize, &String)| Key {
        name: name.clone(),
        color: at % crate::figures::Ink::SERIES.len() + 1,
    };
    names.iter().enumerate().map(key).collect()
}

/// Coupling against stiffness, both over the reference: a halved alpha lies to the right, or below.
fn figure(
    rows: &[SampleRow],
    names: &[String],
    figures: &mut BTreeMap<String, String>,
) -> Result<Option<String>, ReportError> {
    let marks: Vec<Mark> = rows.iter().filter_map(|row| mark(row, names)).collect();
    if marks.is_empty() {
        return Ok(None);
    }
    let axis = |values: Vec<f64>, bars: Vec<f64>, title: &str| {
        let (low, high) = range_of(values.into_iter().chain([1.0]));
        let bars = bars
            .into_iter()
            .map(|end| end.clamp(low / STRETCH, high * STRETCH));
        let (low, high) = range_of(bars.chain([low, high, 0.5, 1.5]));
        Axis::linear_rounded(low, high, title, "", 5)
    };
    let across = marks.iter().map(|mark| mark.x).collect();
    let across_bars = marks
        .iter()
        .flat_map(|mark| [mark.x - mark.x_error, mark.x + mark.x_error]);
    let x = axis(across, across_bars.collect(), "Stiffness E I over the driest");
    let up = marks.iter().map(|mark| mark.y).collect();
    let y = axis(
        up,
        marks.iter().flat_map(|mark| [mark.bar.0, mark.bar.1]).collect(),
        "Coupling μ over the driest",
    );
    let (low, high) = (x.low.max(y.low), x.high.min(y.high));
    let beside = Beside {
        law: Curve {
            x: vec![low, high],
            y: vec![low, high],
            band: vec![(low, low), (high, high)],
        },
        limits: vec![1.0],
        changes: vec![1.0],
        names: names.to_vec(),
        ..Beside::default()
    };
    let desc = "Coupling against stiffness of every sample and condition, both over those of its driest condition, with intervals of 95 %. On the slanted line alpha is unchanged; right of the upright line the strip is stiffer; below the level line a charge pulls less.";
    let id = "stiffness-coupling".to_owned();
    let svg = law_panel((&x, &y), &marks, &beside, "Stiffness or coupling", desc);
    let svg = svg.map_err(|reason| ReportError::Figure {
        figure: id.clone(),
        reason,
    })?;
    figures.insert(id.clone(), svg);
    Ok(Some(id))
}

fn mark(row: &SampleRow, names: &[String]) -> Option<Mark> {
    let ratios = &row.change.as_ref()?.ratios;
    let (stiffness, coupling) = (&ratios.stiffness, &ratios.coupling);
    let x = stiffness.value?;
    Some(Mark {
        x,
        x_error: (stiffness.high_95? - stiffness.low_95?) / 2.0,
        y: coupling.value?,
        bar: (coupling.low_95?, coupling.high_95?),
        style: names.iter().position(|name| *name == row.sample)?,
        run: row.free.first().copied(),
        came_from: 0,
    })
}

fn shown(table: &Conditions, rows: &[SampleRow], row: &SampleRow) -> Row {
    let words = |row: &SampleRow| {
        let condition = &table.measured[row.condition];
        let surroundings = surroundings_label(&table.surroundings[condition.surroundings]);
        format!(
            "{surroundings}, {}",
            voltage_label(table.voltages_v[condition.voltage])
        )
    };
    let text = |estimate: &Estimate, factor: f64| EstimateText::of(estimate, factor);
    let ratios = |change: &Change| {
        [&change.alpha, &change.ratios.stiffness, &change.ratios.coupling]
            .map(|ratio| text(ratio, 1.0))
            .to_vec()
    };
    Row {
        sample: row.sample.clone(),
        condition: words(row),
        against: row.change.as_ref().map_or_else(String::new, |change| {
            let reference = &rows[change.reference];
            if reference.sample == row.sample {
                words(reference)
            } else {
                format!("{}, {}", reference.sample, words(reference))
            }
        }),
        numbers: vec![
            text(&row.alpha, 1.0),
            text(&row.stiffness_n_m2, MICRO),
            text(&row.coupling_n_m_per_c, MILLI),
            text(&row.blocked_n_m_per_c, MILLI),
        ],
        ratios: row.change.as_ref().map_or_else(Vec::new, ratios),
        cause: row
            .change
            .as_ref()
            .map_or("reference", |change| change.cause.words()),
    }
}

fn held(site: &Site, rows: &[SampleRow], run: &BlockedRun) -> Held {
    let index = site.run_of(&run.path);
    let bending = rows
        .iter()
        .find(|row| index.is_some_and(|index| row.held.contains(&index)))
        .and_then(|row| row.free_bending_rad);
    let remark = match bending {
        Some(bending) if bending > LARGEST_BENDING_RAD => format!(
            "the free strip bends by {} rad up to the sensor: beyond {} rad the moment is wrong by more than 2\u{a0}%",
            fixed(bending, 1),
            fixed(LARGEST_BENDING_RAD, 0)
        ),
        Some(_) => String::new(),
        None => "how far the strip bends when free is not known here".to_owned(),
    };
    Held {
        run: index.map(|index| RunLink::to(site, index)),
        path: run.path.clone(),
        force: run
            .largest_force_mn
            .map_or_else(|| "–".to_owned(), |force| significant(force, 3)),
        numbers: vec![
            // mN mm to µN m: the same number.
            EstimateText::of(&run.per_charge_mn_mm_per_c, 1e-3),
            EstimateText::of(&run.per_volt_mn_mm_per_v, 1.0),
            EstimateText::of(&run.relaxation_per_s, 1.0),
        ],
        remark,
        issues: run.issues.iter().map(IssueText::from).collect(),
    }
}
