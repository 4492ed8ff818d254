//! What stands above the rows: preamble, names, units.

use crate::dialect::{Dialect, UnitPlace};
use crate::dice::Dice;
use crate::table::Written;
use crate::truth::{SECOND, Truth};
use crate::wall::{Layout, Wall};
use crate::write::line;

/// Keys with values as instruments write them.
const PAIRS: [(&str, &str); 10] = [
    ("Serial number", "SN-204417"),
    ("Operator", "M. Example"),
    ("Sample", "A12"),
    ("Firmware", "2.31"),
    ("Channel", "3"),
    ("Range", "auto"),
    ("Gain", "1.0"),
    ("Device", "Data logger"),
    ("Batch", "7"),
    ("Comment", "strip 2 of 3"),
];
const TEXTS: [&str; 7] = [
    "Exported data",
    "Measured in the glove box, strip clamped at 5 mm.",
    "--------------------",
    "[Header]",
    "Data:",
    "",
    "Second strip of three; soaked for 24 h",
];
const START: [&str; 5] = ["Date", "Start time", "Started", "Start", "Date and time"];
const OTHER: [&str; 3] = ["Calibration date", "Calibrated", "Firmware date"];

/// The lines above the names.
pub fn preamble(dice: &mut Dice, truth: &Truth, dialect: &Dialect, columns: &[Written]) -> Vec<String> {
    let mut lines = Vec::new();
    let has_colon = dice.chance(0.6) || dialect.delimiter == ' ';
    let pair = |key: &str, value: &str| {
        if has_colon {
            format!("{key}: {value}")
        } else {
            line(&[key.to_owned(), value.to_owned()], dialect)
        }
    };
    while lines.len() < dialect.preamble {
        let (key, value) = dice.pick(&PAIRS);
        let text = dice.pick(&TEXTS);
        lines.push(if dice.chance(0.7) {
            pair(key, value)
        } else {
            text.to_owned()
        });
    }
    let mut place = |dice: &mut Dice, text: String| {
        let at = dice.whole(0, lines.len() as i64 - 1) as usize;
        lines[at] = text;
    };
    if dialect.preamble > 0 && dialect.other_date {
        let us = truth.start_us - 86_400 * SECOND * dice.whole(30, 900);
        let date = Wall::stamp(dice).texts(us, '.').0;
        let key = dice.pick(&OTHER);
        place(dice, pair(key, &date));
    }
    if let Some(stamp) = dialect.preamble_date.filter(|_| dialect.preamble > 0) {
        let (date, time) = stamp.texts(truth.start_us, '.');
        let text = match stamp.columns {
            Layout::One => {
                let key = dice.pick(&START);
                pair(key, &stamp.whole(truth.start_us, '.'))
            }
            _ => format!("{}\u{0}{}", pair("Date", &date), pair("Time", &time)),
        };
        place(dice, text);
    }
    let mut lines: Vec<String> = lines
        .iter()
        .flat_map(|text| text.split('\u{0}'))
        .map(str::to_owned)
        .collect();
    if dialect.units == UnitPlace::Preamble {
        lines.extend(
            columns
                .iter()
                .filter(|c| !c.unit.is_empty())
                .map(|c| format!("{} = {}", c.name, c.unit)),
        );
    }
    if dialect.commented {
        lines.iter_mut().for_each(|text| *text = format!("# {text}"));
    }
    if dialect.sep_line {
        lines.insert(0, format!("sep={}", dialect.delimiter));
    }
    lines
}

/// The lines of names and units.
pub fn names(dialect: &Dialect, columns: &[Written]) -> Vec<String> {
    let mut rows = vec![
        columns
            .iter()
            .map(|column| name(column, dialect))
            .collect::<Vec<String>>(),
    ];
    if let UnitPlace::Row(brackets) = dialect.units {
        rows.push(
            columns
                .iter()
                .map(|column| unit_cell(column, brackets, dialect))
                .collect(),
        );
    } else if dialect.two_rows && rows[0].iter().any(|name| name.contains(' ')) {
        let halves = rows[0]
            .iter()
            .map(|name| name.split_once(' ').unwrap_or((name, "")));
        let (above, below): (Vec<&str>, Vec<&str>) = halves.unzip();
        rows = [above, below]
            .map(|row| row.into_iter().map(str::to_owned).collect())
            .to_vec();
    }
    let mark = if dialect.commented { "# " } else { "" };
    rows.iter()
        .map(|row| format!("{mark}{}", line(row, dialect)))
        .collect()
}

fn unit_cell(column: &Written, brackets: &str, dialect: &Dialect) -> String {
    match (column.unit.as_str(), brackets.split_at(brackets.len() / 2)) {
        ("", _) if dialect.delimiter == ' ' => "-".to_owned(),
        ("", _) => String::new(),
        (unit, (open, close)) => format!("{open}{unit}{close}"),
    }
}

/// The cell of its unit where units stand apart from names.
pub fn unit_of(column: &Written, dialect: &Dialect) -> Option<String> {
    match dialect.units {
        UnitPlace::Row(brackets) => Some(unit_cell(column, brackets, dialect)),
        _ => None,
    }
}

/// Name and unit as the dialect writes them.
pub fn name(column: &Written, dialect: &Dialect) -> String {
    let UnitPlace::Name(style) = dialect.units else {
        return column.name.clone();
    };
    let (name, unit) = (&column.name, &column.unit);
    let is_form = column.snake.is_empty() && !unit.is_empty();
    match style {
        _ if unit.is_empty() => name.clone(),
        '[' => format!("{name} [{unit}]"),
        '_' if name.is_ascii() && !is_form => format!("{name}_{}", column.snake)
            .replace(' ', "_")
            .to_lowercase(),
        '/' if !is_form => format!("{name}/{unit}"),
        ',' => format!("{name}, {unit}"),
        ' ' if !is_form => format!("{name} {unit}"),
        _ => format!("{name} ({unit})"),
    }
}
