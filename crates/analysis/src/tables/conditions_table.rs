//! The conditions that were measured: how often, and the two sums that the thesis's figure 26 shows.

use super::TableInput;
use super::cells::{
    Shown, condition_columns, condition_stub, parameter_cell, pooled_remark, run_sources, sample_count,
};
use crate::conditions::conditions;
use crate::parameters::PARAMETERS;
use ieap_show::{Cell, Column, Notes, Row, Table};

/// The sums stand last among the parameters.
const FIRST_SUM: usize = 7;

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let table = conditions(input.runs, input.campaign);
    let sums: Vec<Shown> = PARAMETERS[FIRST_SUM..].iter().map(Shown::parameter).collect();
    let mut notes = Notes::default();
    let rows = table.measured.iter().map(|condition| {
        let runs = &condition.runs;
        let (label, mut cells) = condition_stub(input, &table, condition);
        let fitted = runs.iter().filter(|&&run| input.runs[run].fit.is_some()).count();
        for count in [sample_count(input, runs), runs.len(), fitted] {
            cells.push(Cell::exact(Some(count as f64), run_sources(input, runs)));
        }
        cells.extend(
            sums.iter()
                .map(|shown| parameter_cell(input, runs, shown, &mut notes)),
        );
        Row { label, cells }
    });
    let rows = rows.collect();
    let mut columns = condition_columns();
    columns.extend([
        Column::plain("samples", "Samples", "number of samples"),
        Column::plain("runs", "Runs", "number of runs"),
        Column::plain("fitted", "Fitted", "number of runs with a fit"),
    ]);
    columns.extend(sums.iter().map(Shown::column));
    Table {
        title: "Conditions that were measured".to_owned(),
        columns,
        stub: 4,
        rows,
        notes: notes.into_texts(),
        remarks: vec![pooled_remark()],
        ..Table::default()
    }
}
