//! What columns mean once their cells are known: text among numbers, flags, units that do not fit.

use super::assemble::Raw;
use super::cells::CellColumn;
use super::error::quoted;
use crate::domain::{Issue, Quantity};
use crate::ingest::text::header::{Header, Meaning};

/// Share of the cells of a number column that may hold text (one cell always may) before it is refused.
const TEXT_SHARE: f64 = 0.05;

/// Turns `true` and `false` in flag columns into 1 and 0; other words are text where a flag must stand.
pub fn read_flags(raw: &mut Raw) {
    for (index, column) in raw.cells.columns.iter_mut().enumerate() {
        if raw.headers[index].meaning.quantity() != Some(Quantity::OpenCircuit) {
            continue;
        }
        for (row, text) in std::mem::take(&mut column.texts) {
            match text.to_ascii_lowercase().as_str() {
                "true" | "yes" | "open" => column.numbers[row as usize] = 1.0,
                "false" | "no" | "closed" => column.numbers[row as usize] = 0.0,
                _ => column
                    .text
                    .add(raw.cells.line_of_row[row as usize] as usize, || text.clone()),
            }
        }
    }
}

/// The meaning of each column: one that holds too much text is refused. Notes what a reader must know of it.
pub fn judge_columns(raw: &Raw, issues: &mut Vec<Issue>) -> Vec<Meaning> {
    let judge = |(index, header): (usize, &Header)| {
        let column = &raw.cells.columns[index];
        let place = |line: usize| format!("line {line}, column {}", index + 1);
        issues.extend(refused_unit(header).map(|issue| issue.at(place(raw.cells.header_line))));
        issues.extend(text(header, column).map(|issue| issue.at(place(column.text.line()))));
        issues.extend(not_finite(header, column).map(|issue| issue.at(place(column.not_finite.line()))));
        match holds_text(column) {
            true => Meaning::Other,
            false => header.meaning.clone(),
        }
    };
    raw.headers.iter().enumerate().map(judge).collect()
}

fn refused_unit(header: &Header) -> Option<Issue> {
    let Meaning::Refused { error, .. } = &header.meaning else {
        return None;
    };
    let message = format!(
        "column {}: {error}; it is kept, but not used",
        quoted(&header.raw_name)
    );
    let mend = "write the unit into the header, as in Current (mA)";
    Some(Issue::warning("column-refused", message).mend(mend))
}

fn text(header: &Header, column: &CellColumn) -> Option<Issue> {
    let (_, first) = column.text.first.as_ref()?;
    let (name, first) = (quoted(&header.raw_name), quoted(first));
    let (count, filled) = (column.text.count, column.filled);
    let message = format!("{count} of {filled} cells of column {name} hold text, first {first}");
    Some(match (holds_text(column), &header.meaning) {
        (false, _) => Issue::warning("text-in-number-column", message + "; taken as empty"),
        (true, Meaning::Other) => Issue::note("text-column", message + "; the column is left out"),
        (true, _) => Issue::warning("column-refused", message + "; the column is left out")
            .mend("leave only numbers below the header"),
    })
}

fn not_finite(header: &Header, column: &CellColumn) -> Option<Issue> {
    let (_, first) = column.not_finite.first.as_ref()?;
    let message = format!(
        "{} of {} cells of column {} hold no finite number, first {}; left out",
        column.not_finite.count,
        column.filled,
        quoted(&header.raw_name),
        quoted(first)
    );
    Some(Issue::warning("not-finite", message))
}

/// Whether so many cells hold text that the column is none of numbers.
pub fn holds_text(column: &CellColumn) -> bool {
    let count = column.text.count;
    2 * count > column.filled || (count > 1 && count as f64 > TEXT_SHARE * column.filled as f64)
}
