//! Reading lines of numbers into columns, without a text of its own for any cell.

use super::delimiter::Delimiter;
use super::lines::Line;
use super::number::{self, Decimal, NumberForm};
use crate::formats::cells::CellTable;

/// How a table is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dialect {
    /// Between the cells.
    pub delimiter: Delimiter,
    /// The numbers.
    pub numbers: NumberForm,
}

impl Dialect {
    /// Cells between `delimiter`, numbers with that decimal sign and no marks between thousands.
    pub fn new(delimiter: Delimiter, decimal: Decimal) -> Dialect {
        Dialect {
            delimiter,
            numbers: decimal.into(),
        }
    }
}

/// Adds one line as a row. A delimiter behind the last field, with nothing after it, is no field.
pub fn push_line(table: &mut CellTable, line: Line<'_>, dialect: Dialect) {
    push_line_in(table, line, dialect, &[]);
}

/// As [`push_line`], with the form of the numbers of each column where columns differ.
pub fn push_line_in(table: &mut CellTable, line: Line<'_>, dialect: Dialect, own: &[NumberForm]) {
    let needed = table.columns.len();
    let mut filled_beyond = false;
    let found = dialect
        .delimiter
        .split(line.text, |index, text| match table.columns.get_mut(index) {
            Some(column) => {
                let form = own.get(index).copied().unwrap_or(dialect.numbers);
                column.push(line.number, number::parse_in(text, form), || {
                    number::unquote(text).to_owned()
                });
            }
            None => filled_beyond |= !text.trim().is_empty(),
        });
    let found = if found > needed && !filled_beyond {
        needed
    } else {
        found
    };
    table.end_row(line.number, found);
}

/// Whether a line holds no reading: blank, only delimiters, or a comment.
pub fn is_blank_or_comment(text: &str) -> bool {
    is_comment(text) || is_blank(text)
}

/// Whether a line is a comment. A mark alone in the first cell is the name of a column of numbers of rows.
pub fn is_comment(text: &str) -> bool {
    let rest = text.trim_start().strip_prefix('#');
    rest.is_some_and(|rest| !rest.starts_with([';', ',', '\t', '|']))
}

/// Whether a line is blank or holds delimiters only.
pub fn is_blank(text: &str) -> bool {
    let is_mark = |c| matches!(c, ';' | ',' | '\t' | ' ' | '\r' | '|' | '\u{1a}' | '\u{feff}');
    text.chars().all(is_mark)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(lines: &[&str]) -> CellTable {
        let mut table = CellTable::new(1, &[false, false], 0);
        let dialect = Dialect::new(Delimiter::Semicolon, Decimal::Comma);
        for (k, &text) in lines.iter().enumerate() {
            let line = Line {
                number: k + 2,
                text,
                ended: true,
            };
            push_line(&mut table, line, dialect);
        }
        table
    }

    #[test]
    fn ragged_rows_are_kept_and_counted() {
        let table = table(&["0,5;1", "1", "1,5;2;", "2;3;4"]);
        assert_eq!(table.rows(), 4);
        assert_eq!(
            (table.ragged.count, table.ragged.first),
            (2, Some((3, "1".to_owned())))
        );
        assert_eq!(table.columns[0].numbers, [0.5, 1.0, 1.5, 2.0]);
        assert!(table.columns[1].numbers[1].is_nan());
    }

    #[test]
    fn cells_that_are_no_numbers_are_counted_with_their_line() {
        let table = table(&["0;x", "1;NaN", "2;"]);
        let column = &table.columns[1];
        assert_eq!((column.text.count, column.text.line()), (1, 2));
        assert_eq!((column.not_finite.count, column.not_finite.line()), (1, 3));
        assert_eq!((column.filled, column.numbers.len()), (2, 3));
    }
}
