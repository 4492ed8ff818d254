//! Proposes a profile for a file: what its rows show is written down, what they do not show is left open.

use std::fmt::Write;

use super::guess::{Guess, TimeGuess, guess_sheet, guess_text};
use crate::formats::error::ReadError;
use crate::formats::sheet_cells::is_workbook;
use crate::formats::{sheet_cells, unpacking};
use crate::table::Answers;
use crate::table::columns;
use crate::table::numbers::decimal_word;
use crate::text::header::{Header, Meaning, leave_lone_phases};
use crate::text::likely::headed_by_unit;
use ieap_domain::Quantity;
use ieap_domain::words::in_a_row;

/// A profile as it may be saved.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Proposal {
    /// Its text.
    pub text: String,
    /// Names and units of the file's columns: files that share them need one profile.
    pub header: String,
    /// What the file does not show and a person has to fill in; empty where the profile can be used as it is.
    pub open: Vec<String>,
}

/// What a person says of a column whose name or unit does not.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StatedColumn {
    /// Name of the column.
    pub column: String,
    /// What it measures.
    pub quantity: Quantity,
    /// Its unit; none where the name holds it.
    pub unit: Option<String>,
}

/// The profile that answers what a file of that name leaves open, for all files with the same names of columns.
///
/// # Errors
/// The file is no text with a table.
pub fn answered(name: &str, bytes: &[u8], answers: &Answers) -> Result<Proposal, ReadError> {
    let mut text = String::new();
    let _ = writeln!(
        text,
        "# What files of this source leave open, answered; proposed from {}.",
        one_line(name)
    );
    let _ = write!(
        text,
        "[profile]\nversion = 1\ntitle = {}\n\n[recognise]\n",
        quoted(name)
    );
    let extension = name.rsplit_once('.').map_or("", |(_, extension)| extension);
    let named = if is_workbook(bytes) {
        String::new()
    } else {
        names_of(bytes)?
    };
    let _ = if named.is_empty() {
        writeln!(text, "name = {}", quoted(&format!("*.{extension}")))
    } else {
        writeln!(text, "contains = [{}]", quoted(&named))
    };
    let _ = write!(text, "\n[answers]\n");
    for (key, answer) in answers.iter() {
        let _ = writeln!(text, "{key} = {}", quoted(answer));
    }
    Ok(Proposal {
        header: named,
        text,
        open: Vec::new(),
    })
}

/// The line that names the columns of a text.
fn names_of(bytes: &[u8]) -> Result<String, ReadError> {
    guess_text(bytes)
        .and_then(|guess| guess.names_line)
        .ok_or_else(|| ReadError::NoHeader {
            line: 0,
            found: "no line that names columns".to_owned(),
        })
}

/// Proposes a profile for a file of that name, in which columns are what is `stated` of them.
///
/// # Errors
/// The file is empty, is no text and no workbook, or has no table of numbers.
pub fn propose(name: &str, bytes: &[u8], stated: &[StatedColumn]) -> Result<Proposal, ReadError> {
    if bytes.is_empty() {
        return Err(ReadError::Empty);
    }
    let guess = if is_workbook(bytes) {
        guess_sheet(&sheet_cells::read(bytes, unpacking::MOST)?)
    } else {
        guess_text(bytes)
    };
    let guess = guess.ok_or_else(|| ReadError::NoHeader {
        line: 0,
        found: "no table of numbers, two columns or more in at least two rows".to_owned(),
    })?;
    Ok(written(name, &guess, stated))
}

fn written(name: &str, guess: &Guess, stated: &[StatedColumn]) -> Proposal {
    let mut text = String::new();
    let mut open = Vec::new();
    // Writing to a String cannot fail.
    let _ = writeln!(text, "# Proposed from {}: check every line.", one_line(name));
    let _ = write!(text, "[profile]\nversion = 1\ntitle = {}\n\n", quoted(name));
    recognise(&mut text, name, guess);
    layout(&mut text, guess);
    time(&mut text, guess, &mut open);
    start(&mut text, guess);
    let mut has_response = false;
    let headers = with_stated(headers(guess), guess, stated, &mut open);
    for (index, name) in guess.names.iter().enumerate() {
        has_response |= column(&mut text, guess, (index, &headers[index]), name, &mut open);
    }
    if !has_response && open.is_empty() {
        open.push(
            "no column is known as current, curvature, tip_displacement or a modulus: say which column measures what"
                .to_owned(),
        );
    }
    let header = [guess.names.as_slice(), &guess.units].concat().join("\t");
    Proposal { text, header, open }
}

fn recognise(text: &mut String, name: &str, guess: &Guess) {
    let extension = name.rsplit_once('.').map_or("", |(_, extension)| extension);
    if let Some(line) = &guess.names_line {
        let _ = write!(text, "[recognise]\ncontains = [{}]\n\n", quoted(line));
    } else if guess.header_line == 0 {
        let _ = write!(
            text,
            "[recognise]\nname = {}    # the file names no columns, so its own name tells it apart\n\n",
            quoted(name)
        );
    } else if !extension.is_empty() {
        let _ = write!(
            text,
            "[recognise]\nname = {}\n\n",
            quoted(&format!("*.{extension}"))
        );
    }
}

fn layout(text: &mut String, guess: &Guess) {
    let _ = writeln!(text, "[layout]");
    match &guess.dialect {
        Some(dialect) => {
            let separator = dialect.delimiter.label();
            let decimal = decimal_word(dialect.numbers.decimal);
            let _ = writeln!(text, "separator = \"{separator}\"\ndecimal = \"{decimal}\"");
            // Found anew in each file where it is left out.
            let _ = writeln!(text, "# encoding = \"{}\"", guess.encoding.unwrap_or("utf-8"));
        }
        None => {
            let _ = writeln!(text, "kind = \"sheet\"");
            if let Some(sheet) = &guess.sheet {
                let _ = writeln!(text, "sheet = {}", quoted(sheet));
            }
        }
    }
    let _ = match &guess.names_line {
        Some(line) => writeln!(text, "header_contains = {}", quoted(line)),
        None => writeln!(text, "header_line = {}", guess.header_line),
    };
    if guess.lines_after_header > 0 {
        let _ = writeln!(text, "lines_after_header = {}", guess.lines_after_header);
    }
    let _ = writeln!(text);
}

/// When the run began, where the head says it and no column of dates does.
fn start(text: &mut String, guess: &Guess) {
    let has_dates = matches!(
        guess.time,
        Some(TimeGuess::Clock { .. } | TimeGuess::Epoch { .. })
    );
    let Some(start) = guess.start.as_ref().filter(|_| !has_dates) else {
        return;
    };
    let begins = quoted(&start.begins);
    let _ = match start.orders.as_slice() {
        [only] => writeln!(
            text,
            "[start]\nline_begins = {begins}\norder = \"{only}\"\nkind = \"start\"\n"
        ),
        several => writeln!(
            text,
            "# The line {begins} holds the start, which can be read as {}: say which, or tag the runs with started_at.\n\
             # [start]\n# line_begins = {begins}\n# order = \"\"\n# kind = \"start\"\n",
            several.join(" or ")
        ),
    };
}

fn time(text: &mut String, guess: &Guess, open: &mut Vec<String>) {
    let _ = writeln!(text, "[time]");
    match &guess.time {
        Some(TimeGuess::Elapsed { index, unit }) => {
            let _ = writeln!(text, "base = \"elapsed\"\ncolumn = {}", column_ref(guess, *index));
            match unit {
                Some(unit) => {
                    let _ = writeln!(text, "unit = {}", quoted(unit));
                }
                None => {
                    open.push("[time] unit: the file names no unit of time".to_owned());
                    let _ = writeln!(
                        text,
                        "unit = \"\"    # the file does not say: s, ms, us, min, h or d"
                    );
                }
            }
        }
        Some(TimeGuess::Epoch { index, unit }) => {
            let _ = writeln!(
                text,
                "base = \"epoch\"    # numbers since 1970, by their size\ncolumn = {}\nunit = \"{unit}\"",
                column_ref(guess, *index)
            );
        }
        Some(TimeGuess::Clock { index, date, orders }) => {
            let _ = writeln!(text, "base = \"clock\"\ncolumn = {}", column_ref(guess, *index));
            if let Some(date) = date {
                let _ = writeln!(text, "date_column = {}", column_ref(guess, *date));
            }
            match orders.as_slice() {
                [only] => {
                    let _ = writeln!(text, "order = \"{only}\"");
                }
                several => {
                    open.push(format!(
                        "[time] order: the dates can be read as {}",
                        several.join(" or ")
                    ));
                    let _ = writeln!(text, "order = \"\"    # the dates fit {}", in_a_row(several));
                }
            }
            let _ = writeln!(
                text,
                "# zone = \"Europe/Tallinn\"    # where it is not the campaign's"
            );
        }
        Some(TimeGuess::TimeOfDay { index }) => {
            let _ = writeln!(
                text,
                "base = \"time-of-day\"\ncolumn = {}",
                column_ref(guess, *index)
            );
        }
        None => {
            open.push("[time]: no column of times was found".to_owned());
            let _ = writeln!(
                text,
                "base = \"interval\"    # no column of times was found\ninterval_s = 0.0    # seconds between two rows, or \
                 another base"
            );
        }
    }
    let _ = writeln!(
        text,
        "zero = \"clock\"    # or \"step\", where the voltage is stepped at time 0\n"
    );
}

/// What the names and units of all columns say.
fn headers(guess: &Guess) -> Vec<Header> {
    let names: Vec<&str> = guess.names.iter().map(String::as_str).collect();
    let units = (!guess.units.is_empty()).then_some(guess.units.as_slice());
    let mut headers = columns::headers(&names, units);
    // A unit alone may head a column of a table that nobody else names.
    for header in headers.iter_mut().filter(|header| header.raw_unit.is_empty()) {
        if let Some(by_unit) = headed_by_unit(&header.raw_name, &header.raw_name) {
            *header = by_unit;
        }
    }
    let mut meanings: Vec<Meaning> = headers.iter().map(|header| header.meaning.clone()).collect();
    leave_lone_phases(&mut meanings);
    for (header, meaning) in headers.iter_mut().zip(meanings) {
        header.meaning = meaning;
    }
    headers
}

/// The same with what is stated of columns; what is stated of none is left open.
fn with_stated(
    mut headers: Vec<Header>,
    guess: &Guess,
    stated: &[StatedColumn],
    open: &mut Vec<String>,
) -> Vec<Header> {
    for said in stated {
        let Some(index) = guess.names.iter().position(|name| *name == said.column) else {
            open.push(format!(
                "there is no column {}; there are {}",
                one_line(&said.column),
                one_line(&guess.names.join(", "))
            ));
            continue;
        };
        let unit = said
            .unit
            .clone()
            .unwrap_or_else(|| headers[index].raw_unit.clone());
        headers[index] = Header::with_unit(said.quantity.label(), &unit);
    }
    headers
}

/// One column that may have a meaning; tells whether it is a response or a modulus.
fn column(
    text: &mut String,
    guess: &Guess,
    (index, header): (usize, &Header),
    name: &str,
    open: &mut Vec<String>,
) -> bool {
    if guess.time_columns().contains(&index) || !guess.is_number[index] {
        return false;
    }
    let reference = column_ref(guess, index);
    match &header.meaning {
        Meaning::Known { quantity, .. } if *quantity != Quantity::Time => {
            let _ = writeln!(
                text,
                "[[column]]\ncolumn = {reference}\nquantity = \"{}\"\nunit = {}\n",
                quantity.key(),
                quoted(&header.raw_unit)
            );
            quantity.is_response() || quantity.is_modulus()
        }
        Meaning::Refused { quantity, .. } if *quantity != Quantity::Time => {
            open.push(format!(
                "unit of column {}: the file names none that fits",
                one_line(name)
            ));
            let _ = writeln!(
                text,
                "[[column]]\ncolumn = {reference}\nquantity = \"{}\"\nunit = \"\"    # the file does not say\n",
                quantity.key()
            );
            quantity.is_response() || quantity.is_modulus()
        }
        _ => {
            let _ = writeln!(
                text,
                "# [[column]]                 # kept under its own name\n# column = {reference}\n# quantity = \"\"             # \
                 current, voltage, curvature, tip_displacement, ...\n# unit = {}\n",
                quoted(&header.raw_unit)
            );
            false
        }
    }
}

/// A column by its name where that is its own, else by its number.
fn column_ref(guess: &Guess, index: usize) -> String {
    let name = &guess.names[index];
    if guess.names.iter().filter(|other| *other == name).count() == 1 && !name.is_empty() {
        quoted(name)
    } else {
        (index + 1).to_string()
    }
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// A text for a comment of the profile.
fn one_line(text: &str) -> String {
    text.chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect()
}
