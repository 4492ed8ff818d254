//! Trains of cycles: one row a cycle.

use ieap_domain::RunRecord;
use ieap_domain::tag::keys;

use super::TableInput;
use super::cells::{figure_cells, figure_columns, run_source};
use crate::cycles::{CYCLE_FIGURES, Cycle, CycleRun};
use ieap_show::{Cell, Column, Content, Notes, Row, Table};

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let mut notes = Notes::default();
    let mut rows = Vec::new();
    for own in input.cycles {
        let run = input.runs.iter().find(|run| run.id == own.run_id);
        for cycle in &own.cycles {
            rows.push(row(own, cycle, run, &mut notes));
        }
    }
    let mut remarks: Vec<String> = input
        .cycles
        .iter()
        .flat_map(|own| {
            own.sentences
                .iter()
                .map(|sentence| format!("{}: {sentence}", own.path))
        })
        .collect();
    remarks.push(if rows.is_empty() {
        "No run has a train of three cycles or more.".to_owned()
    } else {
        "Errors are those of the noise and of where the edges lie, or what neighbouring cycles differ by where that is more."
            .to_owned()
    });
    Table {
        title: "Trains, cycle by cycle".to_owned(),
        columns: columns(),
        stub: 2,
        rows,
        notes: notes.into_texts(),
        remarks,
        ..Table::default()
    }
}

fn columns() -> Vec<Column> {
    let mut columns = vec![
        Column::plain("run", "Run", "run"),
        Column::plain("cycle", "Cycle", "number of the cycle"),
        Column::plain("sample", "Sample", "sample"),
        Column::of("start_s", "t", "when the cycle begins", "s"),
        Column::of("lowest_v", "V_low", "lowest voltage", "V"),
        Column::of("highest_v", "V_high", "highest voltage", "V"),
    ];
    columns.extend(figure_columns(&CYCLE_FIGURES));
    columns
}

fn row(own: &CycleRun, cycle: &Cycle, run: Option<&RunRecord>, notes: &mut Notes) -> Row {
    let source = run_source(own.run_id, &own.path);
    let of_run = || vec![source.clone()];
    let rough = |value: f64, digits| Cell::new(Content::Rough(value, digits), of_run());
    let mut cells = vec![
        Cell::text(Some(own.path.as_str()), of_run()),
        Cell::exact(Some(cycle.number as f64), of_run()),
        Cell::text(run.and_then(|run| run.tag(keys::SAMPLE)), of_run()),
        rough(cycle.start_s, 6),
        rough(own.voltage_v.0, 4),
        rough(own.voltage_v.1, 4),
    ];
    cells.extend(figure_cells(&CYCLE_FIGURES, &cycle.values, &source, notes));
    Row {
        label: format!("{}, cycle {}", own.path, cycle.number),
        cells,
    }
}
