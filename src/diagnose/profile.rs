//! The profile likelihood of the strength of every effect.

use rayon::prelude::*;

use crate::domain::StrengthProfile;

use super::fitted::Fitted;
use super::group::Group;
use super::problem::{Problem, Sought};

/// Strengths that are looked at on either side, in standard errors.
const AT: [f64; 4] = [0.5, 1.0, 2.0, 3.0];
/// Evaluations of each search, from the place that the covariance expects.
const SHORT: u64 = 6;
const SETTLE: f64 = 0.02;

/// Profiles of the effects whose strength is searched and has a standard error.
pub(super) fn profiles(group: &Group, fitted: &Fitted) -> Vec<StrengthProfile> {
    let (slope, _) = fitted.problem.slope(&fitted.at, &[]);
    let inverse = slope.normal.inverse(1e-12);
    let effects = &fitted.problem.effects;
    let mut place = fitted.problem.base_len();
    let mut wanted = Vec::new();
    for (number, sought) in effects.iter().enumerate() {
        if !sought.limits[0].held {
            wanted.push((number, place));
        }
        place += sought.free();
    }
    let of = |(number, place): (usize, usize)| {
        let sd = inverse.get(place, place).max(0.0).sqrt();
        let shift: Vec<f64> = (0..fitted.at.len())
            .map(|k| inverse.get(k, place) / (sd * sd))
            .collect();
        profile(group, fitted, (number, place), sd, &shift)
    };
    wanted.into_par_iter().filter_map(of).collect()
}

/// One profile; `shift` is how the other coordinates follow the strength's to first order.
fn profile(
    group: &Group,
    fitted: &Fitted,
    (number, place): (usize, usize),
    sd: f64,
    shift: &[f64],
) -> Option<StrengthProfile> {
    if !(sd > 0.0 && sd.is_finite()) {
        return None;
    }
    let sought = &fitted.problem.effects[number];
    let below = AT.iter().rev().map(|at| -at);
    let steps: Vec<f64> = below.chain([0.0]).chain(AT).map(|at| at * sd).collect();
    let (mut values, mut rises) = (Vec::new(), Vec::new());
    for step in steps {
        let at: Vec<f64> = fitted.at.iter().zip(shift).map(|(x, s)| x + s * step).collect();
        if fitted.problem.is_outside(place, at[place]) {
            continue;
        }
        let model = fitted.problem.model(&at);
        let strength = model.effects[number].parameters[0];
        let mut all = fitted.problem.effects.clone();
        all[number] = held(sought, &model.effects[number].parameters);
        let problem = Problem::new(group, &model.base, all);
        let parameters: Vec<Vec<f64>> = model.effects.iter().map(|e| e.parameters.clone()).collect();
        let start = problem.coordinates(&model.base, &parameters);
        let square = problem.descend(&start, SHORT, SETTLE, &[]).slope.square;
        if !square.is_finite() {
            continue;
        }
        values.push(strength);
        rises.push((square - fitted.square).max(0.0));
    }
    let about = sought.effect.about();
    (values.len() > 2).then(|| StrengthProfile {
        effect: about.id.to_owned(),
        key: about.parameters[0].key.to_owned(),
        values,
        rises,
    })
}

/// The effect with its strength held.
fn held(sought: &Sought, parameters: &[f64]) -> Sought {
    let mut limits = sought.limits.clone();
    limits[0].held = true;
    Sought::new(sought.effect, sought.variant, limits, parameters)
}
