//! Units that stand in every cell of a column, `21.00 °C`: they are lifted into its name, and the cells are numbers.

use super::header::Header;
use super::number::{self, unquote};
use super::policy::OBEYING_SHARE;
use super::{Cell, Decimal, Delimiter};
use ieap_domain::unit;

/// Lines that are asked first: a text without such cells costs no more. Chosen.
const LINES_ASKED: usize = 64;
/// Fewest rows that show a unit. Chosen.
const FEWEST_ROWS: usize = 3;

/// A column whose cells hold its unit.
struct Column {
    index: usize,
    unit: String,
    /// Index of the first line with it.
    first: usize,
}

/// The text with the units of such columns in their names; none where there is no such column.
pub fn lifted(text: &str) -> Option<String> {
    let head: Vec<&str> = text.lines().take(LINES_ASKED).collect();
    let under = |delimiter: Delimiter| (delimiter, columns(&head, delimiter));
    let (delimiter, columns) =
        (Delimiter::SURE.into_iter().map(under)).max_by_key(|(_, found)| found.len())?;
    let first = columns.iter().map(|column| column.first).min()?;
    let width = count(head[first], delimiter);
    let names = (0..first).rev().find(|at| count(head[*at], delimiter) == width)?;
    // A name with another unit than its cells says something that only a person knows: `9.4m` below `Current (A)`.
    let columns: Vec<Column> = (columns.into_iter())
        .filter(|column| is_free(head[names], delimiter, column))
        .collect();
    if columns.is_empty() {
        return None;
    }
    let mut written = String::with_capacity(text.len());
    for (at, line) in text.split_inclusive('\n').enumerate() {
        match at {
            at if at == names => replace(line, delimiter, &mut written, |index, cell| {
                let column = columns.iter().find(|column| column.index == index)?;
                let bare = unquote(cell);
                Header::parse(bare)
                    .raw_unit
                    .is_empty()
                    .then(|| format!("{bare} ({})", column.unit))
            }),
            at if at >= first => replace(line, delimiter, &mut written, |index, cell| {
                let column = columns.iter().find(|column| column.index == index)?;
                let (number, unit) = parted(cell)?;
                (unit == column.unit).then(|| number.to_owned())
            }),
            _ => written.push_str(line),
        }
    }
    Some(written)
}

/// The columns of which nearly all cells are a number with one unit, from the first such line on.
fn columns(lines: &[&str], delimiter: Delimiter) -> Vec<Column> {
    let mut found: Vec<(Column, usize, bool)> = Vec::new();
    for (at, line) in lines.iter().enumerate() {
        delimiter.split(line, |index, cell| {
            let Some((_, unit)) = parted(cell) else {
                return;
            };
            match found.iter_mut().find(|(column, ..)| column.index == index) {
                Some((column, rows, is_one)) => {
                    *rows += 1;
                    *is_one &= column.unit == unit;
                }
                None => {
                    let unit = unit.to_owned();
                    found.push((
                        Column {
                            index,
                            unit,
                            first: at,
                        },
                        1,
                        true,
                    ));
                }
            }
        });
    }
    let rows_from = |first: usize| {
        lines[first..]
            .iter()
            .filter(|line| !line.trim().is_empty())
            .count()
    };
    let holds = |(column, rows, is_one): &(Column, usize, bool)| {
        *is_one && *rows >= FEWEST_ROWS && *rows as f64 >= OBEYING_SHARE * rows_from(column.first) as f64
    };
    found
        .into_iter()
        .filter(holds)
        .map(|(column, ..)| column)
        .collect()
}

/// Whether the name of a column states no unit, or the one that stands in its cells.
fn is_free(names: &str, delimiter: Delimiter, column: &Column) -> bool {
    let mut is_free = false;
    delimiter.split(names, |index, cell| {
        let unit = Header::parse(unquote(cell)).raw_unit;
        is_free |= index == column.index && (unit.is_empty() || unit == column.unit);
    });
    is_free
}

/// A number and the known unit behind it.
fn parted(cell: &str) -> Option<(&str, &str)> {
    let text = unquote(cell).trim();
    let is_of_number = |c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '\u{2212}' | '.' | ',');
    let end = text.find(|c: char| !is_of_number(c))?;
    let (number, rest) = text.split_at(end);
    let unit = rest.trim();
    let is_number = [Decimal::Point, Decimal::Comma]
        .into_iter()
        .any(|decimal| matches!(number::parse(number, decimal), Cell::Number(_)));
    // Half of a number that another separator cut is none: `914018 <tab> 1`.
    let is_unit = !unit.is_empty() && !unit.starts_with(|c: char| c.is_ascii_digit()) && is_known(unit);
    (is_number && is_unit).then_some((number, unit))
}

/// Whether a text is a unit, `%RH` and `% r.F.` among them.
fn is_known(unit: &str) -> bool {
    let percent = unit
        .strip_prefix('%')
        .is_some_and(|rest| rest.chars().count() <= 6 && !rest.contains(|c: char| c.is_ascii_digit()));
    percent || unit::is_known(unit)
}

fn count(line: &str, delimiter: Delimiter) -> usize {
    delimiter.split(line, |_, _| {})
}

/// Writes a line with some of its cells replaced.
fn replace(
    line: &str,
    delimiter: Delimiter,
    written: &mut String,
    new: impl Fn(usize, &str) -> Option<String>,
) {
    let body = line.trim_end_matches(['\r', '\n']);
    let mut at = 0;
    delimiter.split(body, |index, cell| {
        if let Some(text) = new(index, cell) {
            let from = cell.as_ptr() as usize - body.as_ptr() as usize;
            written.push_str(&body[at..from]);
            written.push_str(&text);
            at = from + cell.len();
        }
    });
    written.push_str(&line[at..]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_in_all_cells_of_a_column_stand_in_its_name() {
        let text = "Logger 3\nTime;T;RH\n10:00;21.0 °C;45 %RH\n10:01;21.1 °C;45 %RH\n10:02;21.2 °C;46 %RH\n";
        assert_eq!(
            lifted(text).as_deref(),
            Some("Logger 3\nTime;T (°C);RH (%RH)\n10:00;21.0;45\n10:01;21.1;45\n10:02;21.2;46\n")
        );
        assert_eq!(lifted("time_s,current_a\n0,1\n1,2\n2,3\n"), None);
        let decimal_commas = "t\tF\ta\n\t0,914018\t1,204792\n\t0,537321\t1,208403\n\t0,616905\t1,213915\n";
        assert_eq!(lifted(decimal_commas), None);
    }
}
