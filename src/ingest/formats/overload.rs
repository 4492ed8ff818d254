//! Overload flags: readings that an instrument itself marks as no measurement.

use super::assemble::Raw;
use super::cells::CellColumn;
use super::error::quoted;
use crate::domain::Issue;

/// Excludes the rows in which `is_overload` holds for the flag column `index`, which is one of texts and becomes
/// no channel. Cells with a number other than zero are overloads in any case.
pub fn exclude(raw: &mut Raw, index: usize, is_overload: impl Fn(&str) -> bool, issues: &mut Vec<Issue>) {
    let header = &raw.headers[index];
    let flagged = flagged_rows(&raw.cells.columns[index], is_overload);
    if let Some((row, text)) = flagged.first() {
        let line = raw.cells.line_of_row[*row as usize];
        let message = format!(
            "{} of {} rows are marked {} (first {}); their current is no measurement and is left out of fits",
            flagged.len(),
            raw.cells.rows(),
            quoted(&header.raw_name),
            quoted(text)
        );
        issues.push(Issue::note("overload-excluded", message).at(format!("line {line}")));
    }
    raw.excluded_rows = flagged.into_iter().map(|(row, _)| row).collect();
}

fn flagged_rows(column: &CellColumn, is_overload: impl Fn(&str) -> bool) -> Vec<(u32, String)> {
    let texts = column.texts.iter().filter(|(_, text)| is_overload(text)).cloned();
    let is_set = |(_, number): &(usize, &f64)| !number.is_nan() && **number != 0.0;
    let numbers = column.numbers.iter().enumerate().filter(is_set);
    let mut flagged: Vec<(u32, String)> = texts
        .chain(numbers.map(|(row, number)| (row as u32, number.to_string())))
        .collect();
    flagged.sort_by_key(|(row, _)| *row);
    flagged
}
