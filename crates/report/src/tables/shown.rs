//! A cell as it is printed: rounded, but in no notation yet.

use ieap_analysis::tables::{Column, Content, Table};
use ieap_domain::number::{Rounded, plain, rounded, rounded_bound, rounded_to, score};

/// Decimals at most of a column of settings.
const MOST_DECIMALS: usize = 3;

/// What is printed in a cell.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ShownCell {
    /// Words.
    Words(String),
    /// A number, with its uncertainty where it has one.
    Number(Rounded),
    /// Below that number.
    Below(Rounded),
    /// Above that number.
    Above(Rounded),
    /// Between two numbers.
    Between(Rounded, Rounded),
    /// Not determined.
    NotDetermined,
    /// Nothing.
    Missing,
}

/// Printed in place of what is not determined.
pub const NOT_DETERMINED: &str = "n.d.";
/// Printed in place of what is not there.
pub const MISSING: &str = "–";
/// Said below a table in which something is not determined.
pub const LEGEND: &str = "n.d.: not determined by the data.";

impl ShownCell {
    /// The cell in plain Unicode: `(9.4 ± 1.2)·10⁻⁵`, `< 4·10⁻⁵`.
    pub fn text(&self) -> String {
        match self {
            ShownCell::Words(words) => words.clone(),
            ShownCell::Number(number) => number.text(),
            ShownCell::Below(number) => format!("< {}", number.text()),
            ShownCell::Above(number) => format!("> {}", number.text()),
            ShownCell::Between(low, high) => format!("{} to {}", low.text(), high.text()),
            ShownCell::NotDetermined => NOT_DETERMINED.to_owned(),
            ShownCell::Missing => MISSING.to_owned(),
        }
    }

    /// Whether it stands to the right, as numbers do.
    pub fn is_number(&self) -> bool {
        !matches!(self, ShownCell::Words(_))
    }
}

/// A content in plain Unicode.
pub fn text_of(content: &Content) -> String {
    shown(content).text()
}

/// A content rounded by the rules of [`ieap_domain::number`].
pub fn shown(content: &Content) -> ShownCell {
    match content {
        Content::Text(words) => ShownCell::Words(words.clone()),
        Content::Exact(number) => ShownCell::Number(digits(plain(*number))),
        Content::Rough(number, places) => ShownCell::Number(rounded_to(*number, *places)),
        Content::Score(number) => ShownCell::Number(digits(score(*number))),
        Content::Measured(measured) => {
            ShownCell::Number(rounded(measured.value, measured.standard_error.unwrap_or(0.0)))
        }
        Content::Bound {
            low: Some(low),
            high: Some(high),
        } => ShownCell::Between(rounded_bound(*low, false), rounded_bound(*high, true)),
        Content::Bound { low: Some(low), .. } => ShownCell::Above(rounded_bound(*low, false)),
        Content::Bound { high: Some(high), .. } => ShownCell::Below(rounded_bound(*high, true)),
        Content::Bound { .. } | Content::NotDetermined => ShownCell::NotDetermined,
        Content::Missing => ShownCell::Missing,
    }
}

fn digits(value: String) -> Rounded {
    Rounded {
        value,
        error: None,
        exponent: None,
    }
}

/// All cells as they are printed; settings of one column get the same number of decimals: `1.2`, `2.0`.
pub fn grid(table: &Table) -> Vec<Vec<ShownCell>> {
    let decimals: Vec<usize> = (0..table.columns.len())
        .map(|column| decimals(table, column))
        .collect();
    let cell = |(column, cell): (usize, &ieap_analysis::tables::Cell)| match &cell.content {
        Content::Exact(number) if decimals[column] > 0 => {
            ShownCell::Number(digits(ieap_domain::number::fixed(*number, decimals[column])))
        }
        content => shown(content),
    };
    let row = |row: &ieap_analysis::tables::Row| row.cells.iter().enumerate().map(cell).collect();
    table.rows.iter().map(row).collect()
}

/// Decimals that the settings of a column need; none where one of them needs too many.
fn decimals(table: &Table, column: usize) -> usize {
    let exact = table
        .rows
        .iter()
        .filter_map(|row| match row.cells.get(column)?.content {
            Content::Exact(number) => Some(number),
            _ => None,
        });
    let needed = |number: f64| {
        let places = 0..=MOST_DECIMALS;
        let is_enough = |places: &usize| {
            let scaled = number * 10f64.powi(*places as i32);
            (scaled - scaled.round()).abs() < 1e-6
        };
        places.into_iter().find(is_enough)
    };
    exact
        .map(needed)
        .try_fold(0, |most, places| Some(most.max(places?)))
        .unwrap_or(0)
}

/// For every row whether its stub cells are said again: not where they and all before them are as in the row above.
pub fn repeated(table: &Table) -> Vec<Vec<bool>> {
    let mut found = Vec::new();
    for (at, row) in table.rows.iter().enumerate() {
        let above = at.checked_sub(1).map(|above| &table.rows[above]);
        let mut still = table.stub > 1;
        let of_row = (0..table.columns.len()).map(|column| {
            still &= column < table.stub
                && above.is_some_and(|above| above.cells[column].content == row.cells[column].content);
            still
        });
        found.push(of_row.collect());
    }
    found
}

/// Rows before which a little room sets a group apart: where the leading stub cell, or the one after it, changes.
pub fn group_starts(table: &Table) -> Vec<bool> {
    let leading = table.stub.saturating_sub(1).min(2);
    let key = |row: &ieap_analysis::tables::Row| -> Vec<ieap_analysis::tables::Content> {
        row.cells
            .iter()
            .take(leading)
            .map(|cell| cell.content.clone())
            .collect()
    };
    let starts = |at: usize| at > 0 && key(&table.rows[at]) != key(&table.rows[at - 1]);
    (0..table.rows.len()).map(starts).collect()
}

/// Remarks with the legend for what is not determined.
pub fn remarks(table: &Table) -> Vec<String> {
    let cells = table.rows.iter().flat_map(|row| &row.cells);
    let undetermined = cells
        .into_iter()
        .any(|cell| cell.content == Content::NotDetermined);
    let legend = undetermined.then(|| LEGEND.to_owned());
    table.remarks.iter().cloned().chain(legend).collect()
}

/// Said below a table whose errors stand in parentheses.
pub const CONCISE: &str = "Digits in parentheses are the standard error in units of the last digits.";

/// Whether some cell has a standard error.
pub fn has_errors(table: &Table) -> bool {
    let mut cells = table.rows.iter().flat_map(|row| &row.cells);
    cells.any(|cell| matches!(cell.content, Content::Measured(measured) if measured.standard_error.is_some()))
}

/// The two lines of a column's head: symbol and unit; a symbol like `R² (current)` without a unit is broken.
pub fn head(column: &Column) -> (String, String) {
    match column.symbol.split_once(" (") {
        Some((symbol, rest)) if column.unit.is_empty() => (symbol.to_owned(), format!("({rest}")),
        _ => (column.symbol.clone(), column.unit.clone()),
    }
}

/// Letter of a footnote: `a` to `z`, then `aa`, `ab`, ... A figure beside a power of ten would be misread.
pub fn note_letter(index: usize) -> String {
    let last = char::from(b'a' + (index % 26) as u8);
    match index / 26 {
        0 => last.to_string(),
        before => format!("{}{last}", note_letter(before - 1)),
    }
}

/// Letters of a cell's footnotes: `a,c`; empty without any.
pub fn note_letters(notes: &[usize]) -> String {
    let letters: Vec<String> = notes.iter().map(|&note| note_letter(note)).collect();
    letters.join(",")
}

/// The caption: title, and what the campaign says of itself.
pub fn caption(table: &Table) -> String {
    match &table.notice {
        Some(notice) => format!("{}. {notice}", table.title),
        None => format!("{}.", table.title),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_analysis::tables::{Cell, Row};

    #[test]
    fn settings_of_a_column_have_the_same_decimals() {
        let row = |number: f64| Row {
            label: String::new(),
            cells: vec![Cell::exact(Some(number), vec![])],
        };
        let table = Table {
            columns: vec![Column::plain("voltage_v", "V", "")],
            rows: vec![row(1.2), row(2.0), row(-0.65)],
            ..Table::default()
        };
        let texts: Vec<String> = grid(&table).iter().map(|row| row[0].text()).collect();
        assert_eq!(texts, ["1.20", "2.00", "−0.65"]);
    }

    #[test]
    fn letters_go_on_after_z() {
        let letters = [0, 25, 26, 52].map(note_letter);
        assert_eq!(letters, ["a", "z", "aa", "ba"]);
    }
}
