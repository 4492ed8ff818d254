//! Plain text for a terminal: columns aligned, symbols above units.

use super::shown::{
    ShownCell, caption, grid, group_starts, head, note_letter, note_letters, remarks, repeated,
};
use crate::visible::one_line;
use ieap_analysis::tables::Table;

/// Words of a cell are cut here: the full text is in every other format.
const WIDEST: usize = 60;
/// Blanks between columns.
const GAP: usize = 2;

/// Writes the table, as wide as it is.
pub fn write(table: &Table) -> String {
    write_within(table, usize::MAX)
}

/// Writes the table into lines of at most `width` characters: columns that have no room beside the others stand in blocks
/// below, each led by the columns that say what a row is about. A column that is wider by itself stays whole.
pub fn write_within(table: &Table, width: usize) -> String {
    let table = &table.as_read();
    let grid = Grid::of(table);
    let mut out = format!("{}\n\n", one_line(&caption(table)));
    for (at, columns) in grid.blocks(table.stub, width).iter().enumerate() {
        if at > 0 {
            out.push('\n');
        }
        grid.write(columns, &mut out);
    }
    for (at, note) in table.notes.iter().enumerate() {
        let gap = if at == 0 { "\n" } else { "" };
        out += &format!("{gap}{}  {}\n", note_letter(at), one_line(note));
    }
    for (at, remark) in remarks(table).iter().enumerate() {
        let gap = if at == 0 { "\n" } else { "" };
        out += &format!("{gap}{}\n", one_line(remark));
    }
    out
}

/// What is printed, with the width of each column.
struct Grid {
    symbols: Vec<String>,
    units: Vec<String>,
    cells: Vec<Vec<(String, bool)>>,
    starts: Vec<bool>,
    widths: Vec<usize>,
    right: Vec<bool>,
}

impl Grid {
    fn of(table: &Table) -> Grid {
        let cells = texts(table);
        let (symbols, units): (Vec<String>, Vec<String>) = table.columns.iter().map(head).unzip();
        let width = |column: usize| {
            let heads = [&symbols[column], &units[column]]
                .into_iter()
                .map(|text| text.chars().count());
            let body = cells.iter().map(|row| row[column].0.chars().count());
            heads.chain(body).max().unwrap_or(0)
        };
        Grid {
            widths: (0..table.columns.len()).map(width).collect(),
            right: (0..table.columns.len())
                .map(|column| is_right(&cells, column))
                .collect(),
            starts: group_starts(table),
            symbols,
            units,
            cells,
        }
    }

    /// Characters of a line of these columns.
    fn width(&self, columns: &[usize]) -> usize {
        let widths = columns.iter().map(|&column| self.widths[column] + GAP);
        widths.sum::<usize>().saturating_sub(GAP)
    }

    /// Which columns stand beside each other in lines of `width` characters, the first `stub` of them in every block.
    fn blocks(&self, stub: usize, width: usize) -> Vec<Vec<usize>> {
        let stub: Vec<usize> = (0..stub.min(self.widths.len())).collect();
        let mut blocks = Vec::new();
        let mut block = stub.clone();
        for column in stub.len()..self.widths.len() {
            let wider = [&block[..], &[column]].concat();
            if self.width(&wider) > width && block.len() > stub.len() {
                blocks.push(block);
                block = [&stub[..], &[column]].concat();
            } else {
                block = wider;
            }
        }
        blocks.push(block);
        blocks
    }

    fn write(&self, columns: &[usize], out: &mut String) {
        let line = |text: &dyn Fn(usize) -> String| {
            let padded = columns
                .iter()
                .map(|&column| pad(&text(column), self.widths[column], self.right[column]));
            padded.collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
        };
        *out += &line(&|column| self.symbols[column].clone());
        if columns.iter().any(|&column| !self.units[column].is_empty()) {
            *out += &line(&|column| self.units[column].clone());
        }
        *out += &"─".repeat(self.width(columns));
        out.push('\n');
        for (row, starts) in self.cells.iter().zip(&self.starts) {
            if *starts {
                out.push('\n');
            }
            *out += &line(&|column| row[column].0.clone());
        }
    }
}

/// Text of every cell, and whether it is a number.
fn texts(table: &Table) -> Vec<Vec<(String, bool)>> {
    let repeated = repeated(table);
    let text = |row: usize, column: usize, cell: &ShownCell| {
        if repeated[row][column] {
            return (String::new(), cell.is_number());
        }
        let mut text = cut(&one_line(&cell.text()));
        let letters = note_letters(&table.rows[row].cells[column].notes);
        if !letters.is_empty() {
            text += &format!(" {letters}");
        }
        (text, cell.is_number())
    };
    let of_row = |(row, cells): (usize, Vec<ShownCell>)| {
        let cells = cells.iter().enumerate();
        cells.map(|(column, cell)| text(row, column, cell)).collect()
    };
    grid(table).into_iter().enumerate().map(of_row).collect()
}

/// A column is set to the right where no cell holds words.
fn is_right(cells: &[Vec<(String, bool)>], column: usize) -> bool {
    cells.iter().all(|row| row[column].1)
}

fn cut(text: &str) -> String {
    if text.chars().count() > WIDEST {
        text.chars().take(WIDEST - 1).chain(['…']).collect()
    } else {
        text.to_owned()
    }
}

fn pad(text: &str, width: usize, right: bool) -> String {
    let room = " ".repeat(width.saturating_sub(text.chars().count()));
    if right {
        format!("{room}{text}")
    } else {
        format!("{text}{room}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_analysis::tables::{Cell, Column, Row};

    fn table() -> Table {
        let cells = ["CNaf", "1.25", "3.5", "17"].map(|text| Cell::text(Some(text), vec![]));
        Table {
            title: "A table".to_owned(),
            columns: ["Material", "first", "second", "third"]
                .map(|key| Column::plain(key, key, key))
                .to_vec(),
            stub: 1,
            rows: vec![Row {
                label: "CNaf".to_owned(),
                cells: cells.to_vec(),
            }],
            ..Table::default()
        }
    }

    #[test]
    fn columns_without_room_stand_below_led_by_what_names_the_row() {
        let text = write_within(&table(), 24);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(
            lines,
            [
                "A table.",
                "",
                "Material  first  second",
                "───────────────────────",
                "CNaf      1.25   3.5",
                "",
                "Material  third",
                "───────────────",
                "CNaf      17",
            ]
        );
        assert!(lines.iter().all(|line| line.chars().count() <= 24));
    }

    #[test]
    fn with_room_there_is_one_block_and_without_any_each_column_stands_whole() {
        assert_eq!(write_within(&table(), 31), write(&table()));
        let narrow = write_within(&table(), 3);
        assert_eq!(narrow.matches("Material").count(), 3, "{narrow}");
    }
}
