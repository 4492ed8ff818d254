//! The thesis's table 5: parameters of the lumped model, one row a condition.

use super::TableInput;
use super::cells::{
    Shown, condition_columns, condition_stub, parameter_cell, pooled_remark, run_sources, sample_count,
    score_cell,
};
use super::extended::{effect_cell, effect_column, effect_keys, shared_notes};
use crate::conditions::conditions;
use crate::parameters::PARAMETERS;
use ieap_show::{Cell, Column, Notes, Row, Table};

/// Number of parameters that are identified from the current; they stand first among [`PARAMETERS`].
const ELECTRICAL: usize = 5;
/// Number of parameters shown: the two sums of figure 26 are left to other tables.
const SHOWN: usize = 7;

/// Place of the step voltage among the columns of a condition.
const VOLTAGE: usize = 3;

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let table = conditions(input.runs, input.campaign);
    let shown: Vec<Shown> = PARAMETERS[..SHOWN].iter().map(Shown::parameter).collect();
    let (electrical, mechanical) = shown.split_at(ELECTRICAL);
    let effects = effect_keys(input);
    let mut notes = Notes::default();
    let rows = table.measured.iter().map(|condition| {
        let runs = &condition.runs;
        let (label, mut cells) = condition_stub(input, &table, condition);
        for note in shared_notes(input, runs) {
            cells[VOLTAGE] = cells[VOLTAGE].clone().noted(notes.at(&note));
        }
        let mut parameters = |of: &[Shown]| -> Vec<Cell> {
            of.iter()
                .map(|s| parameter_cell(input, runs, s, &mut notes))
                .collect()
        };
        cells.extend(parameters(electrical));
        let mechanical = parameters(mechanical);
        cells.push(score_cell(input, runs, |fit| fit.r_squared_current));
        cells.extend(mechanical);
        cells.push(score_cell(input, runs, |fit| fit.r_squared_curvature));
        cells.extend(
            effects
                .iter()
                .map(|key| effect_cell(input, runs, key, &mut notes)),
        );
        let count = |count: usize| Cell::exact(Some(count as f64), run_sources(input, runs));
        cells.push(count(sample_count(input, runs)));
        cells.push(count(runs.len()));
        Row { label, cells }
    });
    let rows = rows.collect();
    let mut columns = condition_columns();
    columns.extend(electrical.iter().map(Shown::column));
    columns.push(score("r_squared_current", "current"));
    columns.extend(mechanical.iter().map(Shown::column));
    columns.push(score("r_squared_curvature", "curvature"));
    columns.extend(effects.iter().map(|key| effect_column(key)));
    columns.push(Column::plain("samples", "N", "number of samples"));
    columns.push(Column::plain("runs", "n", "number of runs"));
    let mut remarks = vec![pooled_remark(), "N: samples, n: runs.".to_owned()];
    if !table.unplaced.is_empty() {
        remarks.push(format!(
            "{} without sample, environment or held voltage, or with fewer than 10 readings, left out.",
            match table.unplaced.len() {
                1 => "1 run".to_owned(),
                count => format!("{count} runs"),
            }
        ));
    }
    Table {
        title: "Fitted values of the electromechanical equivalent circuit".to_owned(),
        columns,
        stub: 4,
        rows,
        notes: notes.into_texts(),
        remarks,
        ..Table::default()
    }
}

fn score(key: &str, of: &str) -> Column {
    Column::plain(
        key,
        &format!("R² ({of})"),
        &format!("coefficient of determination of the {of}"),
    )
}
