//! A table as bytes, with what a right reading of it holds.

use crate::dialect::Dialect;
use crate::dice::Dice;
use crate::ending::{encoded, ended};
use crate::expected::{Expected, expected};
use crate::head;
use crate::odd::{Order, footer, on_its_side};
use crate::table::{Written, data, sentinels};
use crate::times::{Times, times};
use crate::truth::Truth;

/// A written table.
pub struct Table {
    /// Name of the file.
    pub file: &'static str,
    /// Bytes.
    pub bytes: Vec<u8>,
    /// What it holds.
    pub expected: Expected,
}

/// Writes a table.
pub fn table(dice: &mut Dice, truth: &Truth, dialect: &Dialect) -> Table {
    let times = times(dice, truth, dialect);
    let mut columns: Vec<Written> = truth
        .columns
        .iter()
        .map(|column| data(dice, truth, dialect, column))
        .collect();
    sentinels(dice, truth, dialect, &mut columns);
    let mut all = arranged(dice, truth, dialect, &times, columns);
    let mut lines = head::preamble(dice, truth, dialect, &all);
    let head = head::names(dialect, &all);
    lines.extend(vec![String::new(); dialect.blank_lines.0]);
    lines.extend(head.iter().cloned());
    let rows = truth.time_us.len();
    let order: Vec<usize> = if dialect.newest_first {
        (0..rows).rev().collect()
    } else {
        (0..rows).collect()
    };
    if dialect.odd.order == Order::OnItsSide {
        lines.truncate(lines.len() - head.len());
        lines.extend(on_its_side(dialect, &all, &order));
    }
    let rows = if dialect.odd.order == Order::OnItsSide {
        &[][..]
    } else {
        &order
    };
    for (nth, &row) in rows.iter().enumerate() {
        if row > 0 && truth.parts.contains(&row) {
            lines.extend(head.iter().cloned());
        }
        let cells: Vec<String> = all.iter().map(|column| column.cells[row].clone()).collect();
        lines.push(line(&cells, dialect));
        if dialect.blank_lines.1 > 0 && (nth + 1) % dialect.blank_lines.1 == 0 {
            lines.push(String::new());
        }
    }
    let last = *order.last().unwrap_or(&0);
    if dialect.odd.footer > 0 {
        lines.extend(footer(dice, dialect, &all, last));
    }
    let text = ended(dice, lines, dialect, &mut all, last);
    Table {
        file: dice.pick(if truth.is_log {
            &["log.csv", "log.txt"]
        } else {
            &["run.csv", "run.txt", "run.dat"]
        }),
        bytes: encoded(&text, dialect),
        expected: expected(truth, dialect, &times, &all),
    }
}

fn arranged(
    dice: &mut Dice,
    truth: &Truth,
    dialect: &Dialect,
    times: &Times,
    columns: Vec<Written>,
) -> Vec<Written> {
    let plain = |name: &str, cells: Vec<String>| Written {
        name: name.to_owned(),
        unit: String::new(),
        snake: String::new(),
        cells,
        expect: Vec::new(),
        quantity: None,
        is_time: false,
    };
    let mut all: Vec<Written> = times.columns.clone();
    if let Some(sensors) = &truth.sensor_of_row {
        let name = dice.pick(crate::names::SENSOR[dialect.language]);
        let words = sensors.iter().map(|sensor| truth.sensors[*sensor].to_owned());
        let at = if dice.chance(0.5) { 0 } else { all.len() };
        all.insert(at, plain(name, words.collect()));
    }
    all.extend(columns);
    if dialect.shuffled {
        dice.shuffle(&mut all);
    }
    if dialect.index {
        let name = dice.pick(&["No.", "#", "Index", "Nr.", ""]);
        let name = if dialect.delimiter == ' ' && name.is_empty() {
            "No."
        } else {
            name
        };
        // `#` in front of all names would be a comment.
        let name = if name == "#" && dialect.commented {
            "Index"
        } else {
            name
        };
        all.insert(
            0,
            plain(name, (1..=truth.time_us.len()).map(|n| n.to_string()).collect()),
        );
    }
    let group = |column: &Written| match column.quantity {
        Some((quantity, _)) if !truth.is_log => quantity as usize,
        Some((_, sensor)) => sensor,
        None => usize::MAX,
    };
    dialect.odd.arranged(all, group)
}

/// A line of cells, and a delimiter behind it where the dialect has one.
pub fn line(cells: &[String], dialect: &Dialect) -> String {
    let quoted = |cell: &String| {
        let must = dialect.delimiter != ' ' && cell.contains(dialect.delimiter);
        if dialect.quoted || must {
            format!("\"{cell}\"")
        } else {
            cell.clone()
        }
    };
    let mut between = dialect.delimiter.to_string();
    if dialect.delimiter == ' ' {
        between = "   ".to_owned();
    } else if dialect.padded {
        between.push(' ');
    }
    let text = cells.iter().map(quoted).collect::<Vec<String>>().join(&between);
    if dialect.trailing {
        format!("{text}{}", dialect.delimiter)
    } else {
        text
    }
}
