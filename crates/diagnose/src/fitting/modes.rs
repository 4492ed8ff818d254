//! Other places where an effect with several parameters explains the readings as well.
//!
//! Shapes that differ much can draw the same curve through the few voltages of a campaign, with a rise between them that no
//! search from the best crosses. An interval that ends at such a rise would leave out values that the readings allow.

use rayon::prelude::*;

use crate::fitting::fitted::Fitted;
use crate::fitting::policy::RISE_OF_NO_INTERVAL;
use crate::fitting::problem::ExtendedProblem;
use crate::readings::group::RunGroup;
use ieap_model::effects::Scale;
use ieap_model::extended::ExtendedModel;

/// A place where all is at its best, and its sum of squares beyond that of the best place.
pub(crate) struct Mode {
    pub(crate) model: ExtendedModel,
    pub(crate) rise: f64,
}

/// Evaluations of the search from each probe.
const SEARCH: u64 = 20;
/// A search has settled where a step lowers the sum of squares by less.
pub(crate) const SETTLE: f64 = 0.02;
/// Strengths that each search may start from, in parts of the probe's.
const PARTS: [f64; 9] = [0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0];

/// Where searches from each probe of effect `number` of the model end, as far as they explain the readings nearly as well as
/// the model does; none of an effect with one parameter.
pub(crate) fn modes(group: &RunGroup, fitted: &Fitted, number: usize, scale: &Scale) -> Vec<Mode> {
    let free_effect = &fitted.problem.effects[number];
    if free_effect.free() < 2 {
        return Vec::new();
    }
    let probes = free_effect.effect.search(free_effect.variant, scale).probes;
    let of = |probe: Vec<f64>| from_probe(group, fitted, number, &probe);
    probes.into_par_iter().filter_map(of).collect()
}

fn from_probe(group: &RunGroup, fitted: &Fitted, number: usize, probe: &[f64]) -> Option<Mode> {
    let best = fitted.problem.model(&fitted.at);
    let problem = ExtendedProblem::new(group, &best.base, fitted.problem.effects.clone());
    let start = |part: f64| {
        let mut values: Vec<Vec<f64>> = best.effects.iter().map(|e| e.parameters.clone()).collect();
        values[number] = probe.to_vec();
        values[number][0] *= part;
        problem.coordinates(&best.base, &values)
    };
    let nearest = (PARTS.iter().map(|&part| start(part)))
        .map(|at| (problem.square(&at), at))
        .filter(|(square, _)| square.is_finite())
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    let bottom = problem.search(&nearest.1, SEARCH, SETTLE, &[]);
    let rise = (bottom.local.square - fitted.square).max(0.0);
    (rise < RISE_OF_NO_INTERVAL).then(|| Mode {
        model: problem.model(&bottom.at),
        rise,
    })
}
