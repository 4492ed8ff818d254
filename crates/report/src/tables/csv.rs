//! CSV for programs: rounded numbers in plain notation, uncertainty and interval in columns of their own. Texts are written
//! so that a spreadsheet calculates none of them.

use super::shown::{ShownCell, grid, note_letter};
use crate::number::{Rounded, rounded, rounded_bound};
use ieap_analysis::tables::{Cell, Content, Table};
use ieap_domain::safe_text::csv_text;

/// Writes the table. A column with measured numbers becomes four: the value, `_standard_error`, `_low_95`,
/// `_high_95`; a last column, `notes`, has the footnotes of the row.
pub fn write(table: &Table) -> String {
    let is_measured = |column: usize| {
        let mut cells = table.rows.iter().filter_map(|row| row.cells.get(column));
        cells.any(|cell| matches!(cell.content, Content::Measured(_) | Content::Bound { .. }))
    };
    let measured: Vec<bool> = (0..table.columns.len()).map(is_measured).collect();
    let mut head: Vec<String> = Vec::new();
    for (column, measured) in table.columns.iter().zip(&measured) {
        head.push(csv_text(&column.key).into_owned());
        if *measured {
            head.extend(["standard_error", "low_95", "high_95"].map(|part| format!("{}_{part}", column.key)));
        }
    }
    head.push("notes".to_owned());
    let mut out = line(&head);
    for (row, shown) in table.rows.iter().zip(grid(table)) {
        let mut fields = Vec::new();
        for ((cell, shown), measured) in row.cells.iter().zip(shown).zip(&measured) {
            match measured {
                true => fields.extend(numbers(cell)),
                false => fields.push(field(&shown)),
            }
        }
        fields.push(notes(table, &row.cells));
        out += &line(&fields);
    }
    out
}

/// Value, standard error and the ends of the interval; what is not known is empty.
fn numbers(cell: &Cell) -> [String; 4] {
    match &cell.content {
        Content::Measured(measured) => {
            let shown = rounded(measured.value, measured.standard_error.unwrap_or(0.0));
            let error = shown.error.clone().map(|value| Rounded {
                value,
                error: None,
                exponent: shown.exponent,
            });
            let end = |number: Option<f64>| {
                let error = measured.standard_error.unwrap_or(0.0);
                number.map_or(String::new(), |number| machine(&rounded(number, error)))
            };
            [
                machine(&shown),
                error.as_ref().map_or(String::new(), machine),
                end(measured.low_95),
                end(measured.high_95),
            ]
        }
        Content::Bound { low, high } => {
            let bound = |bound: &Option<f64>, is_upper| {
                bound.map_or(String::new(), |bound| machine(&rounded_bound(bound, is_upper)))
            };
            [String::new(), String::new(), bound(low, false), bound(high, true)]
        }
        Content::Text(words) => [
            csv_text(words).into_owned(),
            String::new(),
            String::new(),
            String::new(),
        ],
        _ => Default::default(),
    }
}

/// A cell without uncertainty; what is not there is empty.
fn field(shown: &ShownCell) -> String {
    match shown {
        ShownCell::Words(words) => csv_text(words).into_owned(),
        ShownCell::Number(number) => machine(number),
        ShownCell::NotDetermined | ShownCell::Missing => String::new(),
        other => other.text(),
    }
}

/// `9.4e-5`
fn machine(number: &Rounded) -> String {
    let value = number.value.replace('−', "-");
    match number.exponent {
        Some(power) => format!("{value}e{power}"),
        None => value,
    }
}

fn notes(table: &Table, cells: &[Cell]) -> String {
    let mut parts = Vec::new();
    for (column, cell) in table.columns.iter().zip(cells) {
        for &note in &cell.notes {
            let text = table
                .notes
                .get(note)
                .cloned()
                .unwrap_or_else(|| note_letter(note));
            parts.push(format!("{}: {text}", column.key));
        }
    }
    csv_text(&parts.join("; ")).into_owned()
}

/// One record after RFC 4180, with a line feed.
fn line(fields: &[String]) -> String {
    let quoted = |field: &String| match field.contains(['"', ',', '\n', '\r']) {
        true => format!("\"{}\"", field.replace('"', "\"\"")),
        false => field.clone(),
    };
    fields.iter().map(quoted).collect::<Vec<_>>().join(",") + "\n"
}
