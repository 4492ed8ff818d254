//! The responses of a run as words-sized pictures, for the table of all runs.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use ieap_domain::{Quantity, RunCurve};
use serde::{Deserialize, Serialize};

use crate::figures::thin::{self, Pixels};

/// Half width of the band: single readings stay within it in 95 of 100 cases.
pub const BAND_SIGMA: f64 = 2.0;
/// Room of a picture, px; the template states the same.
pub const SIZE: (f64, f64) = (60.0, 16.0);
/// Time after the step from which on the picture is logarithmic, as a part of the longest.
const UNIT: f64 = 1e-3;
/// Readings are on whole pixels: of a column one point is enough.
const COLUMNS: usize = 60;

/// Path data of both responses; empty where there is none.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sparks {
    /// Of the current.
    pub current: String,
    /// Of the curvature, or what is measured in its place.
    pub motion: String,
    /// What the fit leaves of each channel.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub residuals: Vec<ResidualSpark>,
}

/// What a fit leaves of a channel as a small picture, over the same time as its response.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ResidualSpark {
    /// The channel, `current`.
    pub channel: String,
    /// Upright strokes from the least to the largest residual of each column.
    pub strokes: String,
    /// Upper edge and height of the band that holds 95 of 100 residuals of noise alone.
    pub band: (u32, u32),
}

impl Sparks {
    /// Whether there is any picture.
    pub fn is_drawn(&self) -> bool {
        !(self.current.is_empty() && self.motion.is_empty())
    }

    /// Whether the strip was seen to move.
    pub fn is_moving(&self) -> bool {
        !self.motion.is_empty()
    }

    /// Of these curves.
    pub fn of(curves: &[RunCurve]) -> Sparks {
        let path = |is_wanted: &dyn Fn(Quantity) -> bool| {
            let curve = curves.iter().find(|curve| is_wanted(curve.quantity));
            curve.map_or_else(String::new, path)
        };
        let is_current = |quantity| matches!(quantity, Quantity::Current | Quantity::CurrentDensity);
        Sparks {
            current: path(&is_current),
            motion: path(&|quantity| !is_current(quantity) && quantity != Quantity::Voltage),
            residuals: curves.iter().filter_map(residuals).collect(),
        }
    }
}

/// Room of a picture of residuals, px; the template states the same.
const RESIDUAL_SIZE: (u32, u32) = (150, 36);
/// Half height of such a picture in standard deviations of the noise, where no residual is larger.
const LEAST_SIGMAS: f64 = 4.0;

/// The residuals after the step; none where nothing was fitted, or too little.
fn residuals(curve: &RunCurve) -> Option<ResidualSpark> {
    let left = curve
        .time_s
        .iter()
        .copied()
        .zip(curve.residual_sigma.iter().copied());
    let after: Vec<(f64, f64)> = left
        .filter(|(t, sigmas)| *t >= 0.0 && sigmas.is_finite())
        .collect();
    let last_s = after.last().map_or(0.0, |(t, _)| *t);
    if after.len() < 3 || last_s <= 0.0 {
        return None;
    }
    let (width, height) = (f64::from(RESIDUAL_SIZE.0), f64::from(RESIDUAL_SIZE.1));
    let largest = after
        .iter()
        .map(|(_, sigmas)| sigmas.abs())
        .fold(LEAST_SIGMAS, f64::max);
    let y = |sigmas: f64| (0.5 * height * (1.0 - sigmas / largest)).round() as u32;
    // Two pixels a column.
    let mut columns: BTreeMap<u32, (u32, u32)> = BTreeMap::new();
    for (t, sigmas) in after {
        let column = (0.5 * (width - 1.0) * log_place(t, last_s)) as u32;
        let (up, down) = columns.entry(column).or_insert((y(sigmas), y(sigmas)));
        (*up, *down) = ((*up).min(y(sigmas)), (*down).max(y(sigmas)));
    }
    let strokes = columns
        .into_iter()
        .map(|(column, (up, down))| format!("M{} {up}v{}", 2 * column + 1, (down - up).max(1)));
    let upper = y(BAND_SIGMA);
    Some(ResidualSpark {
        channel: curve.quantity.label().to_lowercase(),
        strokes: strokes.collect(),
        band: (upper, RESIDUAL_SIZE.1 - 2 * upper),
    })
}

/// Place of a time after the step between 0 and 1: linear at first, then logarithmic.
fn log_place(t: f64, last_s: f64) -> f64 {
    (t / (UNIT * last_s)).ln_1p() / UNIT.recip().ln_1p()
}

/// The readings after the step over a time that is linear at first and then logarithmic; empty where there are too few.
fn path(curve: &RunCurve) -> String {
    let readings = curve.time_s.iter().copied().zip(curve.measured.iter().copied());
    let after: Vec<(f64, f64)> = readings.filter(|(t, y)| *t >= 0.0 && y.is_finite()).collect();
    let last_s = after.last().map_or(0.0, |(t, _)| *t);
    let (low, high) = ieap_domain::range_of(after.iter().map(|(_, y)| *y));
    if after.len() < 3 || last_s <= 0.0 || high <= low {
        return String::new();
    }
    let x = |t: f64| SIZE.0 * log_place(t, last_s);
    let y = |value: f64| (SIZE.1 - 1.0) * (1.0 - (value - low) / (high - low)) + 0.5;
    let mut points: Vec<(f64, f64)> = after.iter().map(|(t, value)| (x(*t), y(*value))).collect();
    points.dedup_by_key(|(x, _)| (*x * COLUMNS as f64 / SIZE.0) as usize);
    let pixels = Pixels { across: 1.0, up: 1.0 };
    let corners = thin::line(&points, pixels);
    let mut data = String::new();
    let mut at = (0, 0);
    for (k, (x, y)) in corners.into_iter().enumerate() {
        let to = (x.round() as i32, y.round() as i32);
        let (dx, dy) = (to.0 - at.0, to.1 - at.1);
        // Writing to a String cannot fail.
        let _ = match k {
            0 => write!(data, "M{} {}", to.0, to.1),
            _ if (dx, dy) == (0, 0) => Ok(()),
            _ => write!(data, "l{dx}{}{dy}", if dy < 0 { "" } else { " " }),
        };
        at = to;
    }
    data
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(quantity: Quantity, n: usize) -> RunCurve {
        let time_s: Vec<f64> = (0..n).map(|k| k as f64 - 3.0).collect();
        RunCurve {
            quantity,
            measured: time_s.iter().map(|t| (-t / 20.0).exp()).collect(),
            time_s,
            fitted: Vec::new(),
            residual_sigma: Vec::new(),
            readings: n,
        }
    }

    #[test]
    fn a_decay_falls_from_the_upper_left_to_the_lower_right_in_few_bytes() {
        let sparks = Sparks::of(&[curve(Quantity::Curvature, 400), curve(Quantity::Current, 400)]);
        assert!(sparks.current.starts_with("M0 "), "{}", sparks.current);
        assert!(sparks.current.len() < 120, "{}", sparks.current);
        assert_eq!(sparks.current, sparks.motion);
        let upward = sparks
            .current
            .split('l')
            .skip(1)
            .filter(|step| step.contains('-'));
        assert_eq!(upward.count(), 0, "{}", sparks.current);
    }

    #[test]
    fn residuals_stand_about_a_band_that_narrows_where_they_are_large() {
        let fitted = |residual: &dyn Fn(usize) -> f64| RunCurve {
            residual_sigma: (0..400).map(residual).collect(),
            ..curve(Quantity::Current, 400)
        };
        let of = |residual: &dyn Fn(usize) -> f64| Sparks::of(&[fitted(residual)]).residuals.remove(0);
        let quiet = of(&|k| if k % 2 == 0 { 1.0 } else { -1.0 });
        assert_eq!((quiet.channel.as_str(), quiet.band), ("current", (9, 18)));
        let loud = of(&|k| 20.0 * (k as f64 / 400.0));
        assert!(loud.band.1 <= 4, "{loud:?}");
        assert!(loud.strokes.starts_with("M1 "), "{}", loud.strokes);
        assert!(loud.strokes.len() < 900, "{}", loud.strokes.len());
    }

    #[test]
    fn too_little_draws_nothing() {
        assert_eq!(Sparks::of(&[curve(Quantity::Current, 4)]), Sparks::default());
        assert_eq!(Sparks::of(&[]), Sparks::default());
    }
}
