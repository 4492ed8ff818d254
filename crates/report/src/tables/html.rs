//! HTML: one page that stands alone; the table in it can be copied out.

use super::shown::{caption, grid, group_starts, note_letter, note_letters, remarks, repeated};
use crate::visible::{escaped, indexed};
use ieap_analysis::tables::Table;

const STYLE: &str = "body{font:16px/1.4 system-ui,sans-serif;margin:2rem}\
table{border-collapse:collapse;border-top:2px solid;border-bottom:2px solid}\
caption{text-align:left;padding-bottom:.5rem;max-width:50rem}\
thead{border-bottom:1px solid}th,td{padding:.15rem .6rem;text-align:left;font-weight:400;vertical-align:baseline}\
.number{text-align:right;white-space:nowrap}tr.group>*{padding-top:.7rem}small{opacity:.75}";

/// Writes the table.
pub fn write(table: &Table) -> String {
    let table = &table.as_read();
    let cells = grid(table);
    let repeated = repeated(table);
    let class = |column: usize| {
        if cells.iter().all(|row| row[column].is_number()) {
            " class=\"number\""
        } else {
            ""
        }
    };
    let mut out = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{}</title>\
         <meta name=\"viewport\" content=\"width=device-width\"><style>{STYLE}</style></head><body>\n\
         <table id=\"{}\">\n<caption>{}</caption>\n<thead><tr>",
        escaped(&table.title),
        escaped(&table.name),
        escaped(&caption(table)),
    );
    for (at, column) in table.columns.iter().enumerate() {
        let unit = if column.unit.is_empty() {
            String::new()
        } else {
            format!(" <small>{}</small>", escaped(&column.unit))
        };
        out += &format!(
            "<th scope=\"col\"{} title=\"{}\">{}{unit}</th>",
            class(at),
            escaped(&column.quantity),
            indexed(&column.symbol)
        );
    }
    out += "</tr></thead>\n<tbody>\n";
    for (row, starts) in group_starts(table).into_iter().enumerate() {
        out += if starts { "<tr class=\"group\">" } else { "<tr>" };
        for (column, cell) in table.rows[row].cells.iter().enumerate() {
            let text = if repeated[row][column] {
                String::new()
            } else {
                escaped(&cells[row][column].text())
            };
            let letters = match note_letters(&cell.notes) {
                letters if letters.is_empty() => letters,
                letters => format!("<sup>{letters}</sup>"),
            };
            out += &if column < table.stub {
                format!("<th scope=\"row\"{}>{text}{letters}</th>", class(column))
            } else {
                format!("<td{}>{text}{letters}</td>", class(column))
            };
        }
        out += "</tr>\n";
    }
    out += "</tbody>\n</table>\n";
    for (at, note) in table.notes.iter().enumerate() {
        out += &format!("<p><sup>{}</sup> {}</p>\n", note_letter(at), escaped(note));
    }
    for remark in remarks(table) {
        out += &format!("<p>{}</p>\n", escaped(&remark));
    }
    out += &format!(
        "<p><small>{}</small></p>\n</body></html>\n",
        escaped(&table.origin)
    );
    out
}
