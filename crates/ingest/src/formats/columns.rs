//! What columns mean once their cells are known: text among numbers, flags, units that do not fit.

use super::assemble::Raw;
use super::cells::CellColumn;
use super::error::quoted;
use crate::text::header::{Header, Meaning, leave_lone_phases};
use crate::text::likely::likely;
use ieap_domain::{Issue, Quantity};

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
        if column.holds_text() {
            Meaning::Other
        } else {
            header.meaning.clone()
        }
    };
    let mut meanings: Vec<Meaning> = raw.headers.iter().enumerate().map(judge).collect();
    leave_lone_phases(&mut meanings);
    // An instrument's software names its columns without slips.
    if raw.must_be_run {
        take_likely(raw, &mut meanings, issues);
    }
    meanings
}

/// Code of the warning of a column that is read although its name is not quite known.
pub const TAKEN: &str = "column-taken";
/// Code of what is said of numbers that are none; a warning where the column is read.
pub const NOT_FINITE: &str = "not-finite";
/// Code of what is said of text among the numbers of a column; a warning where the column is read.
pub const TEXT_AMONG_NUMBERS: &str = "text-in-number-column";
/// Code of the warning of a column that probably measures something and is not read.
pub const UNREAD: &str = "column-unread";

/// Reads columns whose name is nearly known and whose unit fits, and proposes a reading for those of which the unit
/// alone speaks; where a column of the quantity is there already, neither.
fn take_likely(raw: &Raw, meanings: &mut [Meaning], issues: &mut Vec<Issue>) {
    for index in 0..meanings.len() {
        let header = &raw.headers[index];
        let Some(found) = likely(header).filter(|_| !raw.cells.columns[index].holds_text()) else {
            continue;
        };
        let quantity = found.quantity;
        if meanings
            .iter()
            .any(|known| known.named_quantity() == Some(quantity))
        {
            continue;
        }
        let (shown, label) = (quoted(&header.raw_name), quantity.label().to_lowercase());
        let unit = &found.unit;
        let issue = match found.named {
            Some((name, conversion)) => {
                meanings[index] = Meaning::Known { quantity, conversion };
                let message = format!(
                    "column {shown} is read as {label} in {unit}: its name is nearly \"{name}\", and its unit fits"
                );
                Issue::warning(TAKEN, message).mend(format!(
                    "name it {name} ({unit}) if that is right; if not, give it another name"
                ))
            }
            None => {
                let message = format!(
                    "column {shown} has a unit of {label}, {unit}, under a name that is not known; it is kept, but not used"
                );
                Issue::warning(UNREAD, message).mend(format!(
                    "name it {label} ({unit}) if it is that; `ieap profile FILE` does the same without a change of files"
                ))
            }
        };
        let place = format!("line {}, column {}", raw.cells.header_line, index + 1);
        issues.push(issue.at(place));
    }
}

/// Code of the issue of a column whose name is known and that cannot be used.
pub const COLUMN_REFUSED: &str = "column-refused";

fn refused_unit(header: &Header) -> Option<Issue> {
    let Meaning::Refused { error, .. } = &header.meaning else {
        return None;
    };
    let message = format!(
        "column {}: {error}; it is kept, but not used",
        quoted(&header.raw_name)
    );
    let mend = "write the unit into the header, as in Current (mA)";
    Some(Issue::warning(COLUMN_REFUSED, message).mend(mend))
}

fn text(header: &Header, column: &CellColumn) -> Option<Issue> {
    let (_, first) = column.text.first.as_ref()?;
    let (name, first) = (quoted(&header.raw_name), quoted(first));
    let (count, filled) = (column.text.count, column.filled);
    let message = format!("{count} of {filled} cells of column {name} hold text, first {first}");
    Some(match (column.holds_text(), &header.meaning) {
        (false, Meaning::Other) => Issue::note(TEXT_AMONG_NUMBERS, message + "; taken as empty"),
        (false, _) => Issue::warning(TEXT_AMONG_NUMBERS, message + "; taken as empty"),
        (true, Meaning::Other) => Issue::note("text-column", message + "; the column is left out"),
        (true, _) => Issue::warning(COLUMN_REFUSED, message + "; the column is left out")
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
    Some(match header.meaning {
        Meaning::Other => Issue::note(NOT_FINITE, message),
        _ => Issue::warning(NOT_FINITE, message),
    })
}
