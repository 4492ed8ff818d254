//! Courses of what is measured.

use crate::dice::Dice;
use crate::truth::SECOND;

/// A moment of the last years, us since 1970.
pub fn moment(dice: &mut Dice) -> i64 {
    let (day, second) = (dice.whole(15_500, 20_600), dice.whole(0, 86_399));
    let second = if dice.chance(0.3) {
        second / 60 * 60
    } else {
        second
    };
    let fraction = if dice.chance(0.3) {
        dice.whole(0, 999) * 1000
    } else {
        0
    };
    (day * 86_400 + second) * SECOND + fraction
}

/// A step of voltage in each part, V.
pub fn voltage(dice: &mut Dice, each: usize, step_row: usize, parts: usize) -> Vec<f64> {
    let step = (dice.number(0.1, 5.0) * 20.0).round() / 20.0 * if dice.chance(0.15) { -1.0 } else { 1.0 };
    let noise = if dice.chance(0.4) { 2e-4 } else { 0.0 };
    (0..each * parts)
        .map(|row| if row % each < step_row { 0.0 } else { step } + noise * dice.number(-1.0, 1.0))
        .collect()
}

/// What answers a step, of a size between these; it decays or it rises.
pub fn response(
    dice: &mut Dice,
    rows: usize,
    each: usize,
    step_row: usize,
    sizes: (f64, f64),
    decays: bool,
) -> Vec<f64> {
    let size = dice.decade(sizes.0, sizes.1) * if dice.chance(0.15) { -1.0 } else { 1.0 };
    let (slow, noise, rest) = (
        each as f64 / dice.number(2.0, 30.0),
        size * 0.002,
        dice.number(0.02, 0.3),
    );
    (0..rows)
        .map(|row| {
            let since = row as f64 % each as f64 - step_row as f64;
            let shape = match since {
                s if s < 0.0 => 0.0,
                s if decays => rest + (1.0 - rest) * (-s / slow).exp(),
                s => 1.0 - (-s / slow).exp(),
            };
            size * shape + noise * dice.number(-1.0, 1.0)
        })
        .collect()
}

/// Something that drifts slowly around a middle between these.
pub fn drift(dice: &mut Dice, rows: usize, between: (f64, f64), wave: f64) -> Vec<f64> {
    let (middle, turns) = (dice.number(between.0, between.1), dice.number(0.5, 4.0));
    (0..rows)
        .map(|row| {
            middle
                + wave * (row as f64 / rows as f64 * turns * std::f64::consts::TAU).sin()
                + wave * 0.05 * dice.number(-1.0, 1.0)
        })
        .collect()
}

/// Relative humidity, %, clamped to what is possible.
pub fn humidity(dice: &mut Dice, rows: usize) -> Vec<f64> {
    let wave = dice.number(0.5, 10.0);
    let low_or_high = [(0.0, 5.0), (5.0, 95.0), (5.0, 95.0), (5.0, 95.0), (95.0, 100.0)];
    let between = dice.pick(&low_or_high);
    drift(dice, rows, between, wave)
        .iter()
        .map(|value| value.clamp(0.0, 100.0))
        .collect()
}
