//! Every run's current fit: one row a run, one column a parameter that any of them has.

use super::TableInput;
use super::cells::{Shown, parameter_cell, run_sources};
use super::extended::{effect_cell, effect_column, effect_keys, shared_notes};
use crate::parameters::{FURTHER, PARAMETERS, ParameterInfo};
use ieap_show::{Cell, Column, Notes, Row, Table};

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let fitted: Vec<usize> = (0..input.runs.len())
        .filter(|&run| input.runs[run].fit.is_some())
        .collect();
    let occurs = |info: &&'static ParameterInfo| {
        let fits = fitted.iter().filter_map(|&run| input.runs[run].fit.as_ref());
        fits.into_iter().any(|fit| fit.parameter(info.key).is_some())
    };
    let shown: Vec<Shown> = PARAMETERS
        .iter()
        .chain(&FURTHER)
        .filter(occurs)
        .map(Shown::parameter)
        .collect();
    let effects = effect_keys(input);
    let mut notes = Notes::default();
    let rows = fitted.iter().map(|&index| {
        let run = &input.runs[index];
        let sources = || run_sources(input, &[index]);
        let fit = run.fit.as_ref();
        let mut model = Cell::text(
            fit.map(|fit| format!("{} v{}", fit.model, fit.model_version)),
            sources(),
        );
        for note in shared_notes(input, &[index]) {
            model = model.noted(notes.at(&note));
        }
        let mut cells = vec![Cell::text(Some(run.path.as_str()), sources()), model];
        for shown in &shown {
            let has_it = fit.is_some_and(|fit| fit.parameter(shown.key).is_some());
            cells.push(if has_it {
                parameter_cell(input, &[index], shown, &mut notes)
            } else {
                Cell::text(None::<String>, sources())
            });
        }
        cells.extend(
            effects
                .iter()
                .map(|key| effect_cell(input, &[index], key, &mut notes)),
        );
        Row {
            label: run.path.clone(),
            cells,
        }
    });
    let rows = rows.collect();
    let mut columns = vec![
        Column::plain("run", "Run", "run"),
        Column::plain("model", "Model", "model and its version"),
    ];
    columns.extend(shown.iter().map(Shown::column));
    columns.extend(effects.iter().map(|key| effect_column(key)));
    Table {
        title: "Current fits of all runs".to_owned(),
        columns,
        stub: 1,
        rows,
        notes: notes.into_texts(),
        remarks: vec!["Values are given with the standard error of the fit.".to_owned()],
        ..Table::default()
    }
}
