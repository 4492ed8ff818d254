//! LaTeX with booktabs and siunitx: a document by itself, and a table where it is read by `\input`.

use super::latex_text::{symbol, unit, words};
use super::shown::{
    CONCISE, MISSING, NOT_DETERMINED, ShownCell, caption, grid, group_starts, has_errors, head, note_letter,
    note_letters, remarks, repeated,
};
use ieap_analysis::tables::Table;
use ieap_domain::number::Rounded;

/// Words longer than this many characters are set in a paragraph.
const LONGEST_LINE: usize = 40;
/// Width of such a paragraph.
const PARAGRAPH: &str = "p{48mm}";

/// What makes the file a document where no class is loaded yet: LaTeX itself tells a second `\documentclass`.
const BEFORE: &str = r"\expandafter\ifx\csname @twoclasseserror\endcsname\documentclass
\def\ieapend{}%
\else
\documentclass[a4paper]{article}
\usepackage[T1]{fontenc}
\usepackage[utf8]{inputenc}
\usepackage{booktabs,siunitx,graphicx,textcomp}
\usepackage[landscape,margin=12mm]{geometry}
\begin{document}
\def\ieapend{\end{document}}%
\fi
";

/// A table that is wider than the text is made smaller, never larger.
const SHRINK: &str = "\\resizebox{\\ifdim\\width>\\linewidth\\linewidth\\else\\width\\fi}{!}{%\n";

/// Rows of a table on one page; a longer one goes on in a table of its own, for what is shrunk to a width has no page breaks.
const MOST_ROWS: usize = 30;

/// Lines of a page that rows and notes share, and letters in a line of notes: of a landscape page of A4.
const LINES_OF_PAGE: usize = 42;
const LETTERS_OF_LINE: usize = 190;

/// Writes the table.
pub fn write(table: &Table) -> String {
    let table = &table.as_read();
    let cells = grid(table);
    let layout: Vec<&str> = (0..table.columns.len())
        .map(|column| layout(&cells, column))
        .collect();
    let mut out = format!(
        "% {} of {}.\n% Alone it is a document; \\input it where booktabs, siunitx and graphicx are loaded.\n{BEFORE}",
        table.name,
        words(&table.origin)
    );
    let lines = lines(table, &cells);
    let parts: Vec<&[String]> = lines.chunks(MOST_ROWS).collect();
    let last = parts.len().saturating_sub(1);
    let rows_before = parts.last().map_or(0, |rows| rows.len());
    let mut notes = pages_of_notes(&notes(table), rows_before).into_iter();
    for at in 0..parts.len().max(1) {
        let (caption, label) = match at {
            0 => (words(&caption(table)), format!("\\label{{tab:{}}}\n", table.name)),
            _ => (format!("{} (continued)", words(&table.title)), String::new()),
        };
        out += &format!(
            "\\begin{{table}}[htbp]\n\\centering\n\\caption{{{caption}}}\n{label}\\footnotesize\n\\setlength{{\\tabcolsep}}{{4pt}}\n"
        );
        out += SHRINK;
        out += &format!(
            "\\begin{{tabular}}{{{}}}\n\\toprule\n{}\\midrule\n",
            layout.join(""),
            heads(table)
        );
        out += &parts.get(at).map_or_else(String::new, |rows| rows.concat());
        out += "\\bottomrule\n\\end{tabular}}\n";
        if at == last {
            out += &notes.next().map_or_else(String::new, |lines| foot(&lines));
        }
        out += "\\end{table}\n";
    }
    for lines in notes {
        let title = words(&table.title);
        out += &format!(
            "\\begin{{table}}[htbp]\n\\centering\n\\caption{{{title} (notes)}}\n{}\\end{{table}}\n",
            foot(&lines)
        );
    }
    out + "\\ieapend\n"
}

/// The names of the columns, and their units below them.
fn heads(table: &Table) -> String {
    let heads = table.columns.iter().map(head).map(|(text, _)| symbol(&text));
    let mut out = format!("{} \\\\\n", heads.collect::<Vec<_>>().join(" & "));
    let second = table.columns.iter().map(|column| match column.unit.as_str() {
        "" => words(&head(column).1),
        text => unit(text),
    });
    let second: Vec<String> = second.collect();
    if second.iter().any(|line| !line.is_empty()) {
        out += &format!("{} \\\\\n", second.join(" & "));
    }
    out
}

/// Each row as it is set; on the first of a page stands what it shares with the one above.
fn lines(table: &Table, cells: &[Vec<ShownCell>]) -> Vec<String> {
    let repeated = repeated(table);
    let line = |(row, starts): (usize, bool)| {
        let is_first = row % MOST_ROWS == 0;
        let texts = cells[row].iter().enumerate().map(|(column, cell)| {
            let text = if repeated[row][column] && !is_first {
                String::new()
            } else {
                cell_text(cell)
            };
            match note_letters(&table.rows[row].cells[column].notes) {
                letters if letters.is_empty() => text,
                // A bare letter above a number reads as its exponent.
                letters => format!("{text}\\,\\textsuperscript{{{letters})}}"),
            }
        });
        let space = if starts && !is_first {
            "\\addlinespace\n"
        } else {
            ""
        };
        format!("{space}{} \\\\\n", texts.collect::<Vec<_>>().join(" & "))
    };
    group_starts(table).into_iter().enumerate().map(line).collect()
}

fn layout(cells: &[Vec<ShownCell>], column: usize) -> &'static str {
    let mut here = cells.iter().map(|row| &row[column]);
    if here.clone().all(ShownCell::is_number) {
        return "r";
    }
    if here.any(|cell| cell.text().chars().count() > LONGEST_LINE) {
        PARAGRAPH
    } else {
        "l"
    }
}

fn cell_text(cell: &ShownCell) -> String {
    match cell {
        ShownCell::Words(text) => words(text),
        ShownCell::Number(number) => num(number),
        ShownCell::Below(number) => format!("$<$\\,{}", num(number)),
        ShownCell::Above(number) => format!("$>$\\,{}", num(number)),
        ShownCell::Between(low, high) => format!("{} to {}", num(low), num(high)),
        ShownCell::NotDetermined => words(NOT_DETERMINED),
        ShownCell::Missing => words(MISSING),
    }
}

/// `\num{9.4(12)e-5}`: the uncertainty in units of the last digit, which all versions of siunitx read.
fn num(number: &Rounded) -> String {
    if !number.is_number() {
        return words(&number.text());
    }
    let power = number.exponent.map(|power| format!("e{power}"));
    format!("\\num{{{}{}}}", number.concise(), power.unwrap_or_default())
}

/// Notes and remarks below the rows.
fn notes(table: &Table) -> Vec<String> {
    let notes = table
        .notes
        .iter()
        .enumerate()
        .map(|(at, note)| format!("\\textsuperscript{{{})}}~{}", note_letter(at), words(note)));
    let concise = has_errors(table).then(|| CONCISE.to_owned());
    let remarks: Vec<String> = remarks(table).into_iter().chain(concise).collect();
    notes.chain(remarks.iter().map(|remark| words(remark))).collect()
}

/// Notes by the page that they stand on, the first of them below so many rows: what floats has no page breaks.
fn pages_of_notes(notes: &[String], rows: usize) -> Vec<Vec<String>> {
    let (mut pages, mut used) = (vec![Vec::new()], rows);
    for note in notes {
        let lines = note.chars().count().div_ceil(LETTERS_OF_LINE);
        if used + lines > LINES_OF_PAGE {
            pages.push(Vec::new());
            used = 0;
        }
        used += lines;
        pages
            .last_mut()
            .into_iter()
            .for_each(|page| page.push(note.clone()));
    }
    pages
}

fn foot(lines: &[String]) -> String {
    if lines.is_empty() {
        String::new()
    } else {
        format!(
            "\\par\\smallskip\n\\begin{{minipage}}{{0.95\\linewidth}}\\scriptsize\n{}\n\\end{{minipage}}\n",
            lines.join("\\par\n")
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::number::rounded;

    #[test]
    fn a_long_table_goes_on_and_names_its_rows_anew() {
        use ieap_show::{Quantity, Sheet};
        let sheet = Sheet::<usize>::new("long", "Long", 1)
            .column(Quantity::plain("run", "Run", "run"), |at| {
                if *at < 40 { "a" } else { "b" }
            })
            .column(Quantity::plain("at", "At", "number"), |at| *at);
        let text = write(&sheet.over(0..91));
        assert_eq!(text.matches("\\end{tabular}").count(), 4, "{text}");
        assert_eq!(text.matches("(continued)").count(), 3);
        assert_eq!(text.matches("\\label").count(), 1);
        assert!(text.contains("\\midrule\na & \\num{30}"), "{text}");
        assert!(
            (0..91).all(|at| text.contains(&format!("& \\num{{{at}}} "))),
            "{text}"
        );
    }

    #[test]
    fn notes_that_a_page_has_no_room_for_stand_on_the_next() {
        let notes: Vec<String> = (0..60).map(|at| format!("{at} {}", "x".repeat(200))).collect();
        let pages = pages_of_notes(&notes, 30);
        let lengths: Vec<usize> = pages.iter().map(Vec::len).collect();
        assert_eq!(lengths, [6, 21, 21, 12]);
        assert_eq!(pages.concat(), notes);
        assert_eq!(pages_of_notes(&notes[..3], 30).len(), 1);
        assert_eq!(pages_of_notes(&[], 30), [Vec::<String>::new()]);
    }

    #[test]
    fn numbers_are_left_to_siunitx() {
        assert_eq!(num(&rounded(24.6183, 0.3142)), "\\num{24.62(31)}");
        assert_eq!(num(&rounded(9.43e-5, 1.2e-5)), "\\num{9.4(12)e-5}");
        assert_eq!(num(&rounded(f64::NAN, 1.0)), "--");
    }
}
