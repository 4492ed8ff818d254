//! The columns of time of a written table, with the times they say.

use crate::clock::{Clock, Elapsed};
use crate::dialect::Dialect;
use crate::dice::Dice;
use crate::names;
use crate::number::{whole, written};
use crate::table::{Written, describe, time_column};
use crate::truth::{SECOND, Truth};
use crate::units::{self, Unit};
use crate::wall::{DateForm, Layout, Wall, seconds};

/// Columns of time with the times they say.
pub struct Times {
    /// Columns.
    pub columns: Vec<Written>,
    /// What each row says, s: elapsed, or since the first row.
    pub time_s: Vec<f64>,
    /// A unit of the last written digit, s.
    pub digit_s: f64,
    /// A reader may count from another zero.
    pub free_offset: bool,
    /// Moment of the first row as it is written, us on the local clock.
    pub start_us: Option<i64>,
}

/// Writes the columns of time.
pub fn times(dice: &mut Dice, truth: &Truth, dialect: &Dialect) -> Times {
    let clock = &dialect.clock;
    let mut times = Times {
        columns: Vec::new(),
        time_s: Vec::new(),
        digit_s: 0.0,
        free_offset: clock.is_pure_wall(),
        start_us: None,
    };
    if let Some(wall) = &clock.wall {
        times.columns = wall_columns(dice, truth, dialect, wall);
        let said: Vec<i64> = truth
            .time_us
            .iter()
            .map(|t| wall.written_us(truth.start_us + t))
            .collect();
        times.start_us = said.first().copied();
        times.digit_s = wall.digits.map_or(60.0, |digits| 10f64.powi(-(digits as i32)));
        times.time_s = said.iter().map(|us| (us - said[0]) as f64 / 1e6).collect();
    }
    if let Some(elapsed) = &clock.elapsed {
        elapsed_columns(dice, truth, dialect, elapsed, &mut times);
    }
    times
}

fn wall_columns(dice: &mut Dice, truth: &Truth, dialect: &Dialect, wall: &Wall) -> Vec<Written> {
    let comma = if dialect.decimal == ',' && dice.chance(0.5) {
        ','
    } else {
        '.'
    };
    let mut name = |of: [&'static [&'static str]; 10]| dice.pick(of[dialect.language]).to_owned();
    let moments: Vec<i64> = truth.time_us.iter().map(|t| truth.start_us + t).collect();
    let [mut dates, mut clocks] = [Vec::new(), Vec::new()];
    for us in &moments {
        let (date, time) = wall.texts(*us, comma);
        dates.push(date);
        clocks.push(time);
    }
    match wall.columns {
        Layout::One => {
            let title = match wall.form {
                DateForm::Epoch { ms } => (if ms { "Epoch_ms" } else { "Epoch" }).to_owned(),
                _ => name(names::MOMENT),
            };
            vec![time_column(
                title,
                moments.iter().map(|us| wall.whole(*us, comma)).collect(),
            )]
        }
        Layout::DateTime => vec![
            time_column(name(names::DATE), dates),
            time_column(name(names::TIME_OF_DAY), clocks),
        ],
        Layout::TimeDate => vec![
            time_column(name(names::TIME_OF_DAY), clocks),
            time_column(name(names::DATE), dates),
        ],
    }
}

/// Elapsed time of each row, us.
fn elapsed_us(truth: &Truth, clock: &Clock) -> Vec<i64> {
    let part_of = |row: usize| {
        *truth
            .parts
            .iter()
            .rev()
            .find(|first| **first <= row)
            .unwrap_or(&0)
    };
    (0..truth.time_us.len())
        .map(|row| truth.time_us[row] - truth.time_us[part_of(row)] + clock.from_us)
        .collect()
}

fn elapsed_columns(dice: &mut Dice, truth: &Truth, dialect: &Dialect, elapsed: &Elapsed, times: &mut Times) {
    let name = dice.pick(names::ELAPSED[dialect.language]).to_owned();
    // Nothing but a name tells hours, minutes and seconds from a time of day.
    let is_explicit = names::IS_ELAPSED.contains(&name.as_str());
    let us = elapsed_us(truth, &dialect.clock);
    let mut column = time_column(name, Vec::new());
    let comma = dialect.decimal;
    let mut time_s: Vec<f64> = us.iter().map(|us| *us as f64 / 1e6).collect();
    let clock_cells = |digits: usize, text: &dyn Fn(i64) -> String| -> (Vec<String>, Vec<f64>) {
        let step = SECOND / 10_i64.pow(digits as u32);
        (
            us.iter().map(|us| text(*us)).collect(),
            us.iter().map(|us| (us / step * step) as f64 / 1e6).collect(),
        )
    };
    let mut digit_s = 1e-6;
    let hms = |us: i64, digits: usize| {
        format!(
            "{:02}:{:02}{}",
            us / SECOND / 3600,
            us / SECOND / 60 % 60,
            seconds(us % (60 * SECOND), digits, comma)
        )
    };
    match *elapsed {
        Elapsed::Number(unit) => {
            describe(dice, &mut column, dialect, &unit);
            let wrong = dialect.clock.contradiction.unwrap_or(1.0);
            (column.cells, time_s) = number_cells(&us, &unit, wrong, dialect);
            digit_s = time_s.iter().map(|t| t.abs()).fold(0.0, f64::max) * 1e-8;
        }
        Elapsed::Hms { stated, digits } => {
            times.free_offset = !is_explicit;
            (column.cells, time_s) = clock_cells(digits, &|us| hms(us, digits));
            state(&mut column, stated, "h:mm:ss");
            digit_s = 10f64.powi(-(digits as i32));
        }
        Elapsed::Ms { stated, digits } => {
            let text = |us: i64| {
                format!(
                    "{:02}{}",
                    us / SECOND / 60,
                    seconds(us % (60 * SECOND), digits, comma)
                )
            };
            (column.cells, time_s) = clock_cells(digits, &text);
            state(&mut column, stated, "mm:ss");
            digit_s = 10f64.powi(-(digits as i32));
        }
        Elapsed::DayDot { digits } | Elapsed::DayLetter { digits } => {
            let day_us = 86_400 * SECOND;
            let is_dot = matches!(elapsed, Elapsed::DayDot { .. });
            let text = |us: i64| match (us / day_us, is_dot) {
                (0, true) => hms(us, digits),
                (days, true) => format!("{days}.{}", hms(us % day_us, digits)),
                (days, false) => format!("{days}d {}", hms(us % day_us, digits)),
            };
            (column.cells, time_s) = clock_cells(digits, &text);
            let has_days = us.iter().any(|us| us / day_us > 0);
            times.free_offset |= is_dot && !has_days && !is_explicit;
            digit_s = 10f64.powi(-(digits as i32));
        }
        Elapsed::Counter { from } => {
            let counted = us.iter().map(|us| (us + from).rem_euclid(1 << 32));
            column.cells = counted.map(|count| whole(count, dialect)).collect();
            (column.unit, column.snake) = ("us".to_owned(), "us".to_owned());
            times.free_offset = true;
        }
        Elapsed::StepRestart => {
            let step_us = us[truth.step_row];
            let since: Vec<i64> = us
                .iter()
                .map(|us| if *us >= step_us { us - step_us } else { *us })
                .collect();
            let unit = units::TIMES[0].1;
            describe(dice, &mut column, dialect, &unit);
            column.cells = number_cells(&since, &unit, 1.0, dialect).0;
            let steps = (0..us.len()).map(|row| if row < truth.step_row { "1" } else { "2" }.to_owned());
            times
                .columns
                .push(time_column("Step".to_owned(), steps.collect()));
        }
    }
    times.columns.push(column);
    if dialect.clock.contradiction.is_some() {
        // What the wall's clock says is true.
        times.free_offset = true;
    } else {
        (times.time_s, times.digit_s) = (time_s, digit_s);
    }
}

/// Elapsed time as numbers of a unit, `wrong` times too large.
fn number_cells(us: &[i64], unit: &Unit, wrong: f64, dialect: &Dialect) -> (Vec<String>, Vec<f64>) {
    let decimals = match unit.snake {
        "us" => 0,
        "ms" => {
            if us.iter().all(|us| us % 1000 == 0) {
                0
            } else {
                3
            }
        }
        "s" => {
            if us.iter().all(|us| us % SECOND == 0) {
                0
            } else {
                3
            }
        }
        _ => 8,
    };
    let decimals = if wrong == 1.0 { decimals } else { 6 };
    us.iter()
        .map(|us| {
            let (text, said) = written(*us as f64 / 1e6 / unit.scale * wrong, decimals, 10, dialect);
            (text, said * unit.scale)
        })
        .unzip()
}

fn state(column: &mut Written, stated: bool, form: &str) {
    if stated {
        column.unit = form.to_owned();
    }
}
