//! CSV for programs: rounded numbers in plain notation, uncertainty and interval in columns of their own. Texts are written
//! so that a spreadsheet calculates none of them.

use super::shown::{ShownCell, grid, note_letter};
use ieap_analysis::tables::{Cell, Content, Table};
use ieap_domain::number::{Rounded, rounded, rounded_bound};
use ieap_domain::safe_text::csv_text;

/// How numbers and fields are told apart.
#[derive(Clone, Copy)]
struct Notation {
    separator: char,
    decimal: char,
}

const POINT: Notation = Notation {
    separator: ',',
    decimal: '.',
};

/// As spreadsheets set to a language with a decimal comma expect it.
const COMMA: Notation = Notation {
    separator: ';',
    decimal: ',',
};

/// Writes the table with decimal points and commas between fields.
pub fn write(table: &Table) -> String {
    written(table, POINT)
}

/// The same with decimal commas and semicolons between fields.
pub fn write_with_decimal_comma(table: &Table) -> String {
    written(table, COMMA)
}

/// The table in a notation. A column with measured numbers becomes four: the value, `_standard_error`, `_low_95`,
/// `_high_95`; a last column, `notes`, has the footnotes of the row.
fn written(table: &Table, notation: Notation) -> String {
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
    let mut out = line(&head, notation);
    for (row, shown) in table.rows.iter().zip(grid(table)) {
        let mut fields = Vec::new();
        for ((cell, shown), measured) in row.cells.iter().zip(shown).zip(&measured) {
            match measured {
                true => fields.extend(numbers(cell, notation)),
                false => fields.push(field(&shown, notation)),
            }
        }
        fields.push(notes(table, &row.cells));
        out += &line(&fields, notation);
    }
    out
}

/// Value, standard error and the ends of the interval; what is not known is empty.
fn numbers(cell: &Cell, notation: Notation) -> [String; 4] {
    let machine = |number: &Rounded| machine(number, notation);
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
fn field(shown: &ShownCell, notation: Notation) -> String {
    match shown {
        ShownCell::Words(words) => csv_text(words).into_owned(),
        ShownCell::Number(number) => machine(number, notation),
        ShownCell::NotDetermined | ShownCell::Missing => String::new(),
        other => other.text(),
    }
}

/// `9.4e-5`, or `9,4e-5`
fn machine(number: &Rounded, notation: Notation) -> String {
    let value = number
        .value
        .replace('−', "-")
        .replace('.', &notation.decimal.to_string());
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
fn line(fields: &[String], notation: Notation) -> String {
    let quoted = |field: &String| {
        if field.contains(['"', notation.separator, '\n', '\r']) {
            format!("\"{}\"", field.replace('"', "\"\""))
        } else {
            field.clone()
        }
    };
    fields
        .iter()
        .map(quoted)
        .collect::<Vec<_>>()
        .join(&notation.separator.to_string())
        + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_analysis::tables::{Column, Measured, Row};

    #[test]
    fn a_decimal_comma_leaves_no_doubt_where_a_field_ends() {
        let measured = Measured {
            value: 1.25e-4,
            standard_error: Some(2e-6),
            low_95: Some(1.21e-4),
            high_95: Some(1.29e-4),
            pooled: None,
        };
        let table = Table {
            columns: vec![
                Column::plain("sample", "", ""),
                Column::plain("voltage_v", "", ""),
                Column::plain("c", "", ""),
            ],
            rows: vec![Row {
                label: "a".to_owned(),
                cells: vec![
                    Cell::text(Some("a,b;c"), vec![]),
                    Cell::exact(Some(2.5), vec![]),
                    Cell::new(Content::Measured(measured), vec![]),
                ],
            }],
            ..Table::default()
        };
        let text = write_with_decimal_comma(&table);
        let mut reader = csv_reader(&text);
        let row: Vec<String> = reader.next().expect("a row");
        assert_eq!(row[0], "a,b;c");
        assert_eq!(row[1], "2,5");
        let number = |text: &str| text.replace(',', ".").parse::<f64>().expect("a number");
        assert!((number(&row[2]) - 1.25e-4).abs() < 1e-6, "{text}");
        assert_eq!(row.len(), text.lines().next().expect("a head").split(';').count());
    }

    /// Fields of the rows after the head, as a spreadsheet parts them.
    fn csv_reader(text: &str) -> impl Iterator<Item = Vec<String>> {
        let part = |line: &str| {
            let (mut fields, mut quoted) = (vec![String::new()], false);
            for character in line.chars() {
                match character {
                    '"' => quoted = !quoted,
                    ';' if !quoted => fields.push(String::new()),
                    other => fields.last_mut().expect("a field").push(other),
                }
            }
            fields
        };
        text.lines().skip(1).map(part).collect::<Vec<_>>().into_iter()
    }
}
