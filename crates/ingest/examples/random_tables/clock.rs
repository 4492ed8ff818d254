//! Forms of time: elapsed, of the wall, or both.

use crate::dice::Dice;

use crate::truth::{SECOND, Truth};
use crate::units::{TIMES, Unit};
use crate::wall::Wall;

/// Form of elapsed time.
#[derive(Debug, Clone, Copy)]
pub enum Elapsed {
    /// A number of this unit.
    Number(Unit),
    /// `h:mm:ss`, the form stated in the name or not.
    Hms { stated: bool, digits: usize },
    /// `mm:ss`, the form stated in the name or not.
    Ms { stated: bool, digits: usize },
    /// `[d.]hh:mm:ss`.
    DayDot { digits: usize },
    /// `1d 02:03:04`.
    DayLetter { digits: usize },
    /// A counter of us that wraps at 2^32.
    Counter { from: i64 },
    /// Seconds that start anew at the step, beside the number of the step.
    StepRestart,
}

/// All columns of time.
#[derive(Debug, Clone, Copy)]
pub struct Clock {
    /// Elapsed.
    pub elapsed: Option<Elapsed>,
    /// Of the wall.
    pub wall: Option<Wall>,
    /// By what the elapsed time is wrong.
    pub contradiction: Option<f64>,
    /// Elapsed time of the first row, us.
    pub from_us: i64,
}

impl Clock {
    /// Draws the columns of time of such a table.
    pub fn random(dice: &mut Dice, truth: &Truth) -> Clock {
        let of_logs = [(8, (false, true)), (1, (true, true))];
        let of_runs = [(6, (true, false)), (2, (false, true)), (2, (true, true))];
        let (elapsed, wall) = dice.weighted(if truth.is_log { &of_logs[..] } else { &of_runs });
        let elapsed = elapsed.then(|| Elapsed::random(dice, truth, wall));
        let span_s = (truth.time_us.last().copied().unwrap_or(0) / SECOND) as f64;
        let is_number = matches!(elapsed, Some(Elapsed::Number(_)));
        let contradicts = wall && is_number && truth.parts.len() == 1 && span_s > 20.0 && dice.chance(0.2);
        let wall = wall.then(|| Wall::random(dice, truth));
        let from_us = match elapsed {
            Some(_) if wall.is_some() => 0,
            Some(Elapsed::Number(_)) if dice.chance(0.25) => -truth.time_us[truth.step_row],
            Some(Elapsed::Hms { .. } | Elapsed::DayDot { .. } | Elapsed::DayLetter { .. })
                if dice.chance(0.3) =>
            {
                dice.pick(&[86_390, 3590, 100, 172_000]) * SECOND
            }
            _ => 0,
        };
        Clock {
            elapsed,
            wall,
            contradiction: contradicts.then(|| dice.pick(&[1000.0, 60.0, 1e-3, 1.0 / 60.0])),
            from_us,
        }
    }

    /// Whether only dates time the rows.
    pub fn is_pure_wall(&self) -> bool {
        self.elapsed.is_none()
    }

    /// In words.
    pub fn words(&self) -> String {
        let elapsed = match self.elapsed {
            Some(Elapsed::Number(unit)) => format!("elapsed in {}", unit.snake),
            Some(other) => format!("elapsed {other:?}"),
            None => String::new(),
        };
        let wall = self.wall.map_or(String::new(), |wall| wall.words());
        let wrong = self
            .contradiction
            .map_or(String::new(), |by| format!(" contradicting by {by:.4}"));
        format!("{elapsed} {wall}{wrong}").trim().to_owned()
    }
}

impl Elapsed {
    fn random(dice: &mut Dice, truth: &Truth, beside_wall: bool) -> Elapsed {
        let digits = digits(truth);
        let whole = digits == 0 && dice.chance(0.8);
        let digits = if whole { 0 } else { digits.max(1) };
        let stated = dice.chance(0.5);
        let restarted = truth.parts.len() > 1;
        match dice.whole(0, 19) {
            0..=1 => Elapsed::Hms { stated, digits },
            2..=3 => Elapsed::Ms { stated, digits },
            4 => Elapsed::DayDot { digits },
            5 => Elapsed::DayLetter { digits },
            6 if !restarted && !beside_wall => Elapsed::Counter {
                from: dice.whole(0, 1 << 32),
            },
            7 if !restarted && !beside_wall => Elapsed::StepRestart,
            _ => Elapsed::Number(dice.weighted(&TIMES)),
        }
    }
}

/// Digits behind the second that tell the rows apart.
pub fn digits(truth: &Truth) -> usize {
    let has_jitter = truth.time_us.iter().any(|t| t % truth.interval_us != 0) && truth.parts.len() == 1;
    match truth.interval_us {
        _ if has_jitter => 3,
        step if step % SECOND == 0 => 0,
        step if step % 100_000 == 0 => 1,
        step if step % 10_000 == 0 => 2,
        _ => 3,
    }
}
