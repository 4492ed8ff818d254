//! All parameters from all readings at once, each weighted by its noise and what else it gets wrong.

use super::described::{self, electrical_parameters};
use super::electrical::starts;
use super::input::DistributedInput;
use super::mechanical::{Mechanical, rates};
use super::readings::{Kind, Readings};
use super::squares::{Fitted, StripProblem};

const ALL: [Kind; 3] = [Kind::Voltage, Kind::Current, Kind::Curvature];
/// Rates of relaxation that each electrical start is tried with.
const RATES: usize = 8;
/// Starts that are searched from.
const SEARCHED: usize = 4;

/// All readings against all parameters: the electrical ones, mu in units of `scale`, ln lambda.
pub(super) fn problem<'a>(
    input: &'a DistributedInput<'a>,
    readings: &'a Readings,
    scale: f64,
) -> StripProblem<'a> {
    let parameters = electrical_parameters(&input.strip) + 2;
    StripProblem::new(input, readings, &ALL, parameters, move |at| {
        described::whole(&input.strip, at, scale)
    })
}

/// From what the phases found.
pub(super) fn refine(
    input: &DistributedInput,
    readings: &Readings,
    electrical: &Fitted,
    mechanical: &Mechanical,
) -> (Fitted, Mechanical) {
    let mut start = electrical.at.clone();
    start.extend([mechanical.fitted.at[0], mechanical.fitted.at[1]]);
    let first = problem(input, readings, mechanical.scale);
    let mut fitted = first.search(&start);
    // Curvatures of many frames err alike in all of them: by their noise alone they would outweigh a current that
    // knows better.
    let weighed = readings.less_sure(&first.excess(&fitted.at));
    let found = problem(input, &weighed, mechanical.scale).search(&fitted.at);
    fitted = Fitted {
        evaluations: fitted.evaluations + found.evaluations,
        ..found
    };
    fitted.evaluations += electrical.evaluations + mechanical.fitted.evaluations;
    parts(input, readings, &fitted, mechanical.scale)
}

/// From curvatures along the strip alone.
pub(super) fn from_curvatures(input: &DistributedInput, readings: &Readings) -> (Fitted, Mechanical) {
    let coarse = readings.thinned();
    let unit = problem(input, &coarse, 1.0);
    let (low, high) = rates(readings);
    let mut tried: Vec<(f64, f64, Vec<f64>)> = Vec::new();
    for electrical in starts(input, readings) {
        for k in 0..RATES {
            let rate = low + (high - low) * k as f64 / (RATES - 1) as f64;
            let mut at = electrical.clone();
            at.extend([1.0, rate]);
            let (mu, square) = unit.best_scale(&at);
            if square.is_finite() && mu != 0.0 {
                tried.push((square, mu, at));
            }
        }
    }
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    let searched = tried.iter().take(SEARCHED).map(|(_, scale, start)| {
        let found = problem(input, &coarse, *scale).search(start);
        (found.square, *scale, found.at)
    });
    let best = searched.min_by(|a, b| a.0.total_cmp(&b.0));
    let (_, scale, start) = best.unwrap_or_else(|| {
        let mut at = vec![0.0; electrical_parameters(&input.strip)];
        at.extend([1.0, low]);
        (0.0, 1.0, at)
    });
    let fitted = problem(input, readings, scale).search(&start);
    parts(input, readings, &fitted, scale)
}

/// The electrical and the mechanical parameters of a minimum in all of them; parameters beyond these are left out.
pub(super) fn parts(
    input: &DistributedInput,
    readings: &Readings,
    fitted: &Fitted,
    scale: f64,
) -> (Fitted, Mechanical) {
    let electrical = electrical_parameters(&input.strip);
    let first: Vec<usize> = (0..electrical).collect();
    let mut bending = fitted.part(&[electrical, electrical + 1]);
    bending.evaluations = 0;
    let electrical = fitted.part(&first);
    let mechanical = Mechanical::of(input, readings, &electrical.at, bending, scale);
    (electrical, mechanical)
}
