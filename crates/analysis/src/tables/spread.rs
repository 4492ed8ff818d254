//! Where the uncertainty of a mean comes from: fits, runs, samples; one row a condition and parameter.

use super::TableInput;
use super::cells::{Shown, condition_columns, condition_stub, parameter_cell};
use crate::conditions::conditions;
use crate::parameters::PARAMETERS;
use ieap_show::{Cell, Column, Content, Notes, Row, Table};

/// Digits of a spread: few repeats know it to one or two.
const DIGITS: i32 = 2;

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let table = conditions(input.runs, input.campaign);
    let mut notes = Notes::default();
    let mut rows = Vec::new();
    for condition in table.measured.iter().filter(|condition| condition.runs.len() > 1) {
        for info in &PARAMETERS {
            let shown = Shown::parameter(info);
            let cell = parameter_cell(input, &condition.runs, &shown, &mut notes);
            let (label, mut cells) = condition_stub(input, &table, condition);
            cells.extend([
                Cell::text(Some(info.symbol), vec![]),
                Cell::text(Some(info.shown_unit), vec![]),
            ]);
            cells.extend(spreads(&cell));
            cells.insert(6, cell);
            rows.push(Row {
                label: format!("{label}, {}", info.key),
                cells,
            });
        }
    }
    let mut columns = condition_columns();
    columns.extend([
        Column::plain("parameter", "Parameter", "parameter"),
        Column::plain("unit", "Unit", "unit of the row"),
        Column::plain("mean", "Mean", "random-effects mean"),
        Column::plain(
            "from_fits",
            "Fits",
            "standard error that the fits alone would leave",
        ),
        Column::plain(
            "between_runs",
            "Between runs",
            "standard deviation between runs of a sample, the fits' errors taken out",
        ),
        Column::plain(
            "between_samples",
            "Between samples",
            "standard deviation between samples, all else taken out",
        ),
        Column::plain("samples", "Samples", "number of samples that determine it"),
        Column::plain("runs", "Runs", "number of runs that determine it"),
    ]);
    let remark = if rows.is_empty() {
        "No condition has more than one run."
    } else {
        "Standard deviations by the method of moments (DerSimonian and Laird); 0 means that the runs differ by no more than the fits' errors explain. A single sample says nothing of the spread between samples."
    };
    Table {
        title: "Means over repeats, and where their uncertainty comes from".to_owned(),
        columns,
        stub: 6,
        rows,
        notes: notes.into_texts(),
        remarks: vec![remark.to_owned()],
        ..Table::default()
    }
}

/// Fits, between runs, between samples, number of samples and of runs.
fn spreads(cell: &Cell) -> Vec<Cell> {
    let pooled = match cell.content {
        Content::Measured(measured) => measured.pooled,
        _ => None,
    };
    let rough = |number: Option<f64>| {
        let content = number.map_or(Content::Missing, |number| Content::Rough(number, DIGITS));
        Cell::new(content, cell.sources.clone())
    };
    let count = |count: Option<usize>| Cell::exact(count.map(|count| count as f64), cell.sources.clone());
    vec![
        rough(pooled.map(|mean| mean.fit_standard_error)),
        rough(pooled.and_then(|mean| mean.between_runs)),
        rough(pooled.and_then(|mean| mean.between_samples)),
        count(pooled.map(|mean| mean.samples)),
        count(pooled.map(|mean| mean.runs)),
    ]
}
