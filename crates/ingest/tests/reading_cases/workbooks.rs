//! Workbooks: cells that hold durations, formulas that no program has computed.

use crate::base_run::base;
use crate::expected::Expected;
use crate::reads::{of, refused};
use crate::sheet_writer::Xml::{self, Duration, Formula, Number, Text};
use crate::sheet_writer::{sheet, workbook};

/// A workbook of one sheet.
fn one_sheet(rows: &[Vec<Xml<'_>>]) -> Vec<u8> {
    let rows: Vec<&[Xml<'_>]> = rows.iter().map(Vec::as_slice).collect();
    workbook(&[sheet(&rows)])
}

#[test]
fn case_21_cells_that_hold_durations() {
    let mut rows = vec![vec![Text("Elapsed time"), Text("U (V)"), Text("I (mA)")]];
    rows.extend(base().iter().map(|row| {
        let days = (row.t + 2.0) / 86_400.0;
        vec![Duration(days), Number(row.volts), Number(row.ma)]
    }));
    Expected::run(&base(), 2.0).is_all_of(&of("run.xlsx", one_sheet(&rows)));
}

#[test]
fn case_21b_formulas_without_values_are_said_to_be_that() {
    let formulas: Vec<String> = (0..85).map(|k| format!("C{}/10", k + 2)).collect();
    let mut rows = vec![vec![
        Text("t (s)"),
        Text("U (V)"),
        Text("raw (mV)"),
        Text("I (mA)"),
    ]];
    rows.extend(base().iter().zip(&formulas).map(|(row, formula)| {
        vec![
            Number(row.t),
            Number(row.volts),
            Number(row.ma * 10.0),
            Formula(formula),
        ]
    }));
    let error = refused("run.xlsx", one_sheet(&rows));
    assert_eq!(error.code(), "formulas-without-values", "{error}");
    assert!(error.to_string().contains("85 cells hold formulas"), "{error}");
}
