//! Plain text for a terminal: columns aligned, symbols above units.

use super::shown::{
    ShownCell, caption, grid, group_starts, head, note_letter, note_letters, remarks, repeated,
};
use crate::visible::one_line;
use ieap_analysis::tables::Table;

/// Words of a cell are cut here: the full text is in every other format.
const WIDEST: usize = 60;

/// Writes the table.
pub fn write(table: &Table) -> String {
    let cells = texts(table);
    let (symbols, units): (Vec<String>, Vec<String>) = table.columns.iter().map(head).unzip();
    let width = |column: usize| {
        let heads = [&symbols[column], &units[column]]
            .into_iter()
            .map(|text| text.chars().count());
        let body = cells.iter().map(|row| row[column].0.chars().count());
        heads.chain(body).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..table.columns.len()).map(width).collect();
    let right: Vec<bool> = (0..table.columns.len())
        .map(|column| is_right(&cells, column))
        .collect();
    let line = |texts: &[String]| {
        let padded = texts
            .iter()
            .enumerate()
            .map(|(column, text)| pad(text, widths[column], right[column]));
        padded.collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
    };
    let mut out = format!("{}\n\n", one_line(&caption(table)));
    out += &line(&symbols);
    if units.iter().any(|unit| !unit.is_empty()) {
        out += &line(&units);
    }
    out += &"─".repeat(widths.iter().sum::<usize>() + 2 * widths.len().saturating_sub(1));
    out.push('\n');
    let starts = group_starts(table);
    for (row, starts) in cells.iter().zip(starts) {
        if starts {
            out.push('\n');
        }
        out += &line(&row.iter().map(|(text, _)| text.clone()).collect::<Vec<_>>());
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
    match text.chars().count() > WIDEST {
        true => text.chars().take(WIDEST - 1).chain(['…']).collect(),
        false => text.to_owned(),
    }
}

fn pad(text: &str, width: usize, right: bool) -> String {
    let room = " ".repeat(width.saturating_sub(text.chars().count()));
    match right {
        true => format!("{room}{text}"),
        false => format!("{text}{room}"),
    }
}
