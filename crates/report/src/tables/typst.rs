//! Typst: a figure that compiles alone and after `#include`, without packages.

use super::shown::{
    CONCISE, ShownCell, caption, grid, group_starts, has_errors, head, note_letter, note_letters, remarks,
    repeated,
};
use crate::visible::one_line;
use ieap_analysis::tables::Table;
use ieap_domain::number::Rounded;

/// Words longer than this many characters share the width that is left.
const LONGEST_LINE: usize = 40;

/// Captions stand above tables, and one that is longer than a page goes on on the next; a table that is wider than the text is made
/// smaller, never larger.
const HEAD: &str = "#show figure.where(kind: table): set figure.caption(position: top)
#show figure.where(kind: table): set block(breakable: true)
#let fitted(body) = layout(size => {
  let width = measure(body).width
  if width > size.width { scale(100% * (size.width / width), reflow: true, body) } else { body }
})
";

/// Writes the table.
pub fn write(table: &Table) -> String {
    let table = &table.as_read();
    let cells = grid(table);
    let repeated = repeated(table);
    let is_number = |column: usize| cells.iter().all(|row| row[column].is_number());
    let is_long = |column: usize| {
        cells
            .iter()
            .any(|row| row[column].text().chars().count() > LONGEST_LINE)
    };
    let columns = 0..table.columns.len();
    let joined = |texts: Vec<&str>| texts.join(", ");
    let widths = joined(
        columns
            .clone()
            .map(|column| if is_long(column) { "1fr" } else { "auto" })
            .collect(),
    );
    let sides = joined(
        columns
            .clone()
            .map(|column| if is_number(column) { "right" } else { "left" })
            .collect(),
    );
    let wrapper = if columns.clone().any(is_long) {
        ""
    } else {
        "fitted"
    };
    let mut out = format!("// {} of {}\n{HEAD}", table.name, one_line(&table.origin));
    out += &format!(
        "#figure(\n  kind: table,\n  caption: {},\n  {{\n  set text(size: 8pt)\n  {wrapper}(table(\n    columns: ({widths},),\n    align: ({sides},),\n    stroke: none,\n    inset: (x: 3pt, y: 2.5pt),\n    table.hline(),\n    table.header(",
        string(&caption(table))
    );
    let heads = table.columns.iter().map(head).map(|(symbol, second)| {
        if second.is_empty() {
            string(&symbol)
        } else {
            format!("[#{} #linebreak() #{}]", string(&symbol), string(&second))
        }
    });
    out += &format!(
        "{}),\n    table.hline(stroke: 0.5pt),\n",
        heads.collect::<Vec<_>>().join(", ")
    );
    for (row, starts) in group_starts(table).into_iter().enumerate() {
        if starts {
            out += &format!(
                "    table.cell(colspan: {}, inset: 1pt, []),\n",
                table.columns.len()
            );
        }
        let texts = cells[row].iter().enumerate().map(|(column, cell)| {
            let text = if repeated[row][column] {
                String::new()
            } else {
                cell_text(cell)
            };
            match note_letters(&table.rows[row].cells[column].notes) {
                letters if letters.is_empty() => format!("[{text}]"),
                letters => format!("[{text}#super[{letters}]]"),
            }
        });
        out += &format!("    {},\n", texts.collect::<Vec<_>>().join(", "));
    }
    out += "    table.hline(),\n  ))\n";
    out += &foot(table);
    out += &format!("  }},\n) <{}>\n", table.name);
    out
}

fn cell_text(cell: &ShownCell) -> String {
    match cell {
        ShownCell::Number(number) => num(number),
        ShownCell::Below(number) => format!("$<$ {}", num(number)),
        ShownCell::Above(number) => format!("$>$ {}", num(number)),
        ShownCell::Between(low, high) => format!("{} to {}", num(low), num(high)),
        other => format!("#{}", string(&other.text())),
    }
}

/// `$9.4(12) dot 10^(-5)$`; what is no number stays words.
fn num(number: &Rounded) -> String {
    if !number.is_number() {
        return format!("#{}", string(&number.text()));
    }
    let digits = number.concise();
    match number.exponent {
        None => format!("${digits}$"),
        Some(power) => format!("${digits} dot 10^({power})$"),
    }
}

/// A string literal: in it nothing is markup.
fn string(text: &str) -> String {
    format!(
        "\"{}\"",
        one_line(text).replace('\\', "\\\\").replace('"', "\\\"")
    )
}

fn foot(table: &Table) -> String {
    let notes = table
        .notes
        .iter()
        .enumerate()
        .map(|(at, note)| format!("#super[{}] #{}", note_letter(at), string(note)));
    let concise = has_errors(table).then(|| CONCISE.to_owned());
    let remarks: Vec<String> = remarks(table).into_iter().chain(concise).collect();
    let lines: Vec<String> = notes
        .chain(remarks.iter().map(|remark| format!("#{}", string(remark))))
        .collect();
    if lines.is_empty() {
        String::new()
    } else {
        format!(
            "  align(left, text(size: 7pt)[{}])\n",
            lines.join(" #linebreak()\n    ")
        )
    }
}
