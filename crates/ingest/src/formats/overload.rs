//! Flags of single readings: kept as stretches of time; those that mark no measurement leave their rows out of fits.

use super::assemble::{Raw, RowFlag};
use super::cells::CellColumn;
use super::error::quoted;
use ieap_domain::Issue;

/// Keeps the marks of the flag column `index`, which is one of texts and becomes no channel, and excludes the rows in
/// which `is_overload` holds. Cells with a number other than zero are overloads in any case.
pub fn exclude(
    raw: &mut Raw,
    index: usize,
    is_marked: impl Fn(&str) -> bool,
    is_overload: impl Fn(&str) -> bool,
    issues: &mut Vec<Issue>,
) {
    let name = raw.headers[index].raw_name.clone();
    let marked = marked_rows(&raw.cells.columns[index], is_marked);
    let flag = |(row, flag, is_number): (u32, String, bool)| RowFlag {
        row,
        column: name.clone(),
        excludes: is_number || is_overload(&flag),
        flag,
    };
    raw.flags = marked.into_iter().map(flag).collect();
    let mut excluding = raw.flags.iter().filter(|flag| flag.excludes);
    if let Some(first) = excluding.next() {
        let line = raw.cells.line_of_row[first.row as usize];
        let message = format!(
            "{} of {} rows are marked {} (first {}); their current is no measurement and is left out of fits",
            1 + excluding.count(),
            raw.cells.rows(),
            quoted(&name),
            quoted(&first.flag)
        );
        issues.push(Issue::note("overload-excluded", message).at(format!("line {line}")));
    }
}

/// Row and mark, and whether the mark is a number, in the order of rows.
fn marked_rows(column: &CellColumn, is_marked: impl Fn(&str) -> bool) -> Vec<(u32, String, bool)> {
    let texts = column.texts.iter().filter(|(_, text)| is_marked(text));
    let is_set = |(_, number): &(usize, &f64)| !number.is_nan() && **number != 0.0;
    let numbers = column.numbers.iter().enumerate().filter(is_set);
    let mut marked: Vec<(u32, String, bool)> = texts
        .map(|(row, text)| (*row, text.clone(), false))
        .chain(numbers.map(|(row, number)| (row as u32, number.to_string(), true)))
        .collect();
    marked.sort_by_key(|(row, _, _)| *row);
    marked
}
