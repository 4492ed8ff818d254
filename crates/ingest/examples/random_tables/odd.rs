//! What some writers do besides: footers, blocks side by side, tables on their side, full-width digits, a decimal mark for each
//! column.

use crate::dialect::{Dialect, Numbers};
use crate::dice::Dice;
use crate::head::{name, unit_of};
use crate::table::{Expect, Written, time_column};
use crate::truth::Truth;
use crate::write::line;

/// How the columns stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// Side by side, one time for all.
    Plain,
    /// In blocks with a time each, a column without a name between them or not.
    Blocks { parted: bool },
    /// One line for each column.
    OnItsSide,
}

/// All of it.
#[derive(Debug, Clone, Copy)]
pub struct Odd {
    /// How the columns stand.
    pub order: Order,
    /// Lines behind the rows.
    pub footer: usize,
    /// Digits and marks in full width.
    pub full_width: bool,
    /// Every second column has the other decimal mark.
    pub mixed_marks: bool,
}

impl Odd {
    /// Draws what such a dialect allows.
    pub fn random(dice: &mut Dice, truth: &Truth, dialect: &Dialect) -> Odd {
        let may_block = dialect.delimiter != ' '
            && truth.parts.len() == 1
            && truth.sensor_of_row.is_none()
            && !(dialect.index || dialect.shuffled || dialect.two_rows || dialect.cut);
        let may_turn = may_block && !dialect.newest_first && dialect.blank_lines.1 == 0;
        let order = match dice.whole(0, 29) {
            0..=1 if may_block => Order::Blocks {
                parted: dice.chance(0.5),
            },
            2 if may_turn => Order::OnItsSide,
            _ => Order::Plain,
        };
        let has_marks = dialect.thousands.is_none() && dialect.numbers == Numbers::Fixed;
        let may_mix = !matches!(dialect.delimiter, ',' | ' ') && has_marks;
        let may_end = !(dialect.cut || dialect.newest_first || dialect.open_end) && order != Order::OnItsSide;
        Odd {
            order,
            footer: if may_end && dice.chance(0.12) {
                dice.whole(1, 3) as usize
            } else {
                0
            },
            full_width: dialect.language >= 8 && dialect.delimiter != ' ' && dice.chance(0.1),
            mixed_marks: may_mix && dice.chance(0.08),
        }
    }

    /// In words.
    pub fn words(&self) -> Vec<&'static str> {
        let order = match self.order {
            Order::Plain => None,
            Order::Blocks { .. } => Some("blocks side by side"),
            Order::OnItsSide => Some("on its side"),
        };
        let named = [
            (self.footer > 0, "footer"),
            (self.full_width, "full width"),
            (self.mixed_marks, "a decimal mark a column"),
        ];
        let said = named.into_iter().filter(|(is, _)| *is).map(|(_, word)| word);
        order.into_iter().chain(said).collect()
    }

    /// The columns as they stand, with the marks of their cells.
    pub fn arranged(&self, mut all: Vec<Written>, first_of: impl Fn(&Written) -> usize) -> Vec<Written> {
        if self.mixed_marks {
            let swap = |text: &String| text.replace('.', "\u{0}").replace(',', ".").replace('\u{0}', ",");
            for column in all
                .iter_mut()
                .filter(|column| column.quantity.is_some())
                .skip(1)
                .step_by(2)
            {
                column.cells = column.cells.iter().map(swap).collect();
            }
        }
        if self.full_width {
            for column in &mut all {
                column.cells = column.cells.iter().map(|text| full_width(text)).collect();
            }
        }
        match self.order {
            Order::Blocks { parted } => blocks(all, parted, first_of),
            _ => all,
        }
    }
}

/// Digits, letters and marks in full width.
fn full_width(text: &str) -> String {
    let wide = |c: char| match c {
        '!'..='~' => char::from_u32(c as u32 + 0xfee0).unwrap_or(c),
        c => c,
    };
    text.chars().map(wide).collect()
}

/// The columns of each group behind the columns of time.
fn blocks(all: Vec<Written>, parted: bool, group_of: impl Fn(&Written) -> usize) -> Vec<Written> {
    let (times, data): (Vec<Written>, Vec<Written>) = all.into_iter().partition(|column| column.is_time);
    let mut groups: Vec<usize> = data.iter().map(&group_of).collect();
    groups.dedup();
    let mut out: Vec<Written> = Vec::new();
    for group in groups {
        if parted && !out.is_empty() {
            let rows = out[0].cells.len();
            out.push(Written {
                is_time: false,
                ..time_column(String::new(), vec![String::new(); rows])
            });
        }
        out.extend(times.iter().cloned());
        out.extend(data.iter().filter(|column| group_of(column) == group).cloned());
    }
    out
}

/// One line for each column, its name and unit in front.
pub fn on_its_side(dialect: &Dialect, all: &[Written], order: &[usize]) -> Vec<String> {
    let of = |column: &Written| {
        let mut cells = vec![name(column, dialect)];
        cells.extend(unit_of(column, dialect));
        cells.extend(order.iter().map(|row| column.cells[*row].clone()));
        line(&cells, dialect)
    };
    all.iter().map(of).collect()
}

/// The lines behind the rows.
pub fn footer(dice: &mut Dice, dialect: &Dialect, all: &[Written], last: usize) -> Vec<String> {
    const TEXTS: [&str; 8] = [
        "",
        "Checksum: 3F2A9C01",
        "End of data",
        "Export finished 3 channels",
        "Rows: 120",
        "*** END ***",
        "Ende der Messung",
        "",
    ];
    const OF_JAPANESE: [&str; 3] = ["記録終了", "件数：120", "以上"];
    const OF_CHINESE: [&str; 3] = ["导出结束", "记录数：120", "完"];
    const COUNTED: [[&str; 3]; 3] = [
        ["Average", "Min", "Max"],
        ["平均", "最小", "最大"],
        ["平均值", "最小值", "最大值"],
    ];
    let language = dialect.language.saturating_sub(7).min(2);
    let is_table = dialect.delimiter != ' ' && dice.chance(0.4) && all[0].is_time;
    let mut lines: Vec<String> = Vec::new();
    for counted in COUNTED[language].iter().take(dialect.odd.footer) {
        if is_table {
            let mut cells: Vec<String> = all.iter().map(|column| summed(column, last)).collect();
            cells[0] = (*counted).to_owned();
            lines.push(line(&cells, dialect));
        } else {
            lines.push(
                match language {
                    1 => dice.pick(&OF_JAPANESE),
                    2 => dice.pick(&OF_CHINESE),
                    _ => dice.pick(&TEXTS),
                }
                .to_owned(),
            );
        }
    }
    lines
}

/// What stands below a column of readings: one of them.
fn summed(column: &Written, last: usize) -> String {
    match column.expect.get(last) {
        Some(Expect::Reading(_)) => column.cells[last].clone(),
        _ => String::new(),
    }
}
