//! Markdown: a pipe table, footnotes below.

use super::shown::{caption, grid, note_letter, note_letters, remarks};
use crate::visible::one_line;
use ieap_analysis::tables::Table;

/// Writes the table.
pub fn write(table: &Table) -> String {
    let table = &table.as_read();
    let cells = grid(table);
    let mut out = format!("**{}**\n\n|", escaped(&caption(table)));
    for column in &table.columns {
        out += &if column.unit.is_empty() {
            format!(" {} |", escaped(&column.symbol))
        } else {
            format!(" {} ({}) |", escaped(&column.symbol), escaped(&column.unit))
        };
    }
    out += "\n|";
    for column in 0..table.columns.len() {
        let right = cells.iter().all(|row| row[column].is_number());
        out += if right { " ---: |" } else { " --- |" };
    }
    out.push('\n');
    for (row, shown) in table.rows.iter().zip(&cells) {
        out.push('|');
        for (cell, shown) in row.cells.iter().zip(shown) {
            let letters = match note_letters(&cell.notes) {
                letters if letters.is_empty() => letters,
                letters => format!(" <sup>{letters}</sup>"),
            };
            out += &format!(" {}{letters} |", escaped(&shown.text()));
        }
        out.push('\n');
    }
    for (at, note) in table.notes.iter().enumerate() {
        out += &format!("\n<sup>{}</sup> {}\n", note_letter(at), escaped(note));
    }
    for remark in remarks(table) {
        out += &format!("\n{}\n", escaped(&remark));
    }
    out
}

/// Text in which nothing is markup.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in one_line(text).chars() {
        match character {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '\\' | '`' | '*' | '_' | '[' | ']' | '|' | '#' | '>' | '~' => {
                out.push('\\');
                out.push(character);
            }
            plain => out.push(plain),
        }
    }
    out
}
