//! Models held against each other: one row a material, surroundings and model.

use super::TableInput;
use crate::models_compared::{ComparedCondition, ComparedModel, models_compared, outdated};
use ieap_domain::Quantity;
use ieap_show::{Cell, Column, Content, Row, Source, SourceOrigin, Table};

/// Digits of a multiple of the noise, and of a time.
const DIGITS: i32 = 2;

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let found = models_compared(input.comparisons, input.runs, input.campaign);
    let rows = found
        .iter()
        .flat_map(|condition| condition.models.iter().map(|model| row(input, condition, model)))
        .collect();
    let in_noise = "in units of the noise, root mean square, median over the runs";
    let mut remarks: Vec<String> = found.iter().map(|condition| condition.sentence.clone()).collect();
    let outdated = outdated(input.outdated_comparisons);
    let remark = if found.is_empty() && outdated.is_empty() {
        "No models were compared yet: `ieap compare` does it."
    } else if found.is_empty() {
        ""
    } else {
        "Every model has the same circuit step and the same noise, found without the models. BIC is summed over the runs, less that of the best; models that do not describe all runs have none. Later times: the last 30 % of a run, predicted by a fit to what came before. Other voltages: predicted with the parameters of the runs at the nearest lower and higher voltage."
    };
    let further = [outdated.as_str(), remark]
        .into_iter()
        .filter(|text| !text.is_empty());
    remarks.extend(further.map(str::to_owned));
    Table {
        title: "Models compared".to_owned(),
        columns: vec![
            Column::plain("material", "Material", "material"),
            Column::plain("surroundings", "Environment", "environment"),
            Column::plain("model", "Model", "model, the best first"),
            Column::plain(
                "runs",
                "Runs",
                "number of runs that it describes in all responses",
            ),
            Column::plain(
                "parameters",
                "Parameters",
                "number of parameters that are searched",
            ),
            Column::plain(
                "leaves_current",
                "Current",
                &format!("what it leaves of the current, {in_noise}"),
            ),
            Column::plain(
                "leaves_curvature",
                "Curvature",
                &format!("what it leaves of the curvature, {in_noise}"),
            ),
            Column::plain(
                "later",
                "Later times",
                &format!("what it leaves of later times, {in_noise}"),
            ),
            Column::plain(
                "other_voltages",
                "Other voltages",
                &format!("what it leaves at other voltages, {in_noise}"),
            ),
            Column::plain(
                "bic_beyond_best",
                "BIC",
                "Bayesian information criterion less that of the best",
            ),
            Column::of("seconds", "Time", "time that its fits took together", "s"),
        ],
        stub: 3,
        rows,
        remarks,
        ..Table::default()
    }
}

fn row(input: &TableInput, condition: &ComparedCondition, model: &ComparedModel) -> Row {
    let sources = || -> Vec<Source> {
        let of_run = |&place: &usize| {
            let name = &input.comparisons[place].run;
            let run = input.runs.iter().find(|run| run.path == *name)?;
            Some(Source {
                origin: SourceOrigin::Comparison(run.id),
                name: name.clone(),
                key: None,
                estimate: None,
                left_out: None,
            })
        };
        condition.comparisons.iter().filter_map(of_run).collect()
    };
    let rough = |number: Option<f64>| {
        Cell::new(
            number.map_or(Content::Missing, |number| Content::Rough(number, DIGITS)),
            sources(),
        )
    };
    let deciding = |number: Option<f64>| rough(number);
    Row {
        label: format!(
            "{}, {}, {}",
            condition.material, condition.surroundings, model.model
        ),
        cells: vec![
            Cell::text(Some(&*condition.material), vec![]),
            Cell::text(Some(&*condition.surroundings), vec![]),
            Cell::text(Some(&*model.model), vec![]),
            Cell::exact(Some(model.runs as f64), sources()),
            Cell::exact(model.parameters, sources()),
            rough(model.leaves(Quantity::Current)),
            rough(model.leaves(Quantity::Curvature)),
            deciding(model.later),
            deciding(model.other_voltages),
            Cell::exact(model.bic_beyond_best.map(f64::round), sources()),
            rough(Some(model.seconds)),
        ],
    }
}
