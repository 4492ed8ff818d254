//! How near a foreign trace is to what its own effect's forms leave after the refit.

use ieap_diagnose::in_units_of_noise;
use ieap_model::effects::{Applied, Effect, Limits};
use ieap_model::extended::Responses;

use crate::case::{Case, responses};
use crate::hidden::scale;
use crate::oracle::{basis, dot, remove};
use crate::reach::{Range, reach};

/// Steps in which a shape parameter is moved towards what fits.
const FACTORS: [f64; 3] = [1.5, 1.2, 1.07];

/// Largest cosine of what `found` leaves after the refit with what the effect's own forms leave: at every probe, and
/// from the best on at the same strength, with each shape parameter moved towards what fits.
pub fn cosine(case: &Case, effect: &'static dyn Effect, found: &[Responses], d: f64) -> f64 {
    let left = Left::new(case);
    let trace = left.of(found);
    let alike = |own: &Applied| left.alike(&trace, own);
    let Some(mut best) = best_probe(case, effect, &alike) else {
        return 0.0;
    };
    if let Some(strength) = matched(case, &best, d) {
        best.own.parameters[0] = strength;
        best.cosine = best.cosine.max(alike(&best.own));
    }
    for factor in FACTORS {
        for k in 1..best.limits.len() {
            for by in [factor, 1.0 / factor] {
                best.try_shape(k, by, &alike);
            }
        }
    }
    best.cosine
}

/// What is left after the refit, to first order.
struct Left<'a> {
    case: &'a Case,
    plain: Vec<f64>,
    basis: Vec<Vec<f64>>,
}

impl Left<'_> {
    fn new(case: &Case) -> Left<'_> {
        Left {
            case,
            plain: in_units_of_noise(&responses(case, &[]), case.noise),
            basis: basis(case),
        }
    }

    fn of(&self, with: &[Responses]) -> Vec<f64> {
        let with = in_units_of_noise(with, self.case.noise);
        let mut change: Vec<f64> = with.iter().zip(&self.plain).map(|(w, p)| w - p).collect();
        remove(&self.basis, &mut change);
        change
    }

    /// Cosine of a trace with that of an own form; 0 where that leaves nothing.
    fn alike(&self, trace: &[f64], own: &Applied) -> f64 {
        let own = self.of(&responses(self.case, std::slice::from_ref(own)));
        let cosine = dot(&own, trace) / (dot(&own, &own) * dot(trace, trace)).sqrt();
        if cosine.is_nan() { 0.0 } else { cosine }
    }
}

/// The own form that is most alike so far.
struct Best {
    cosine: f64,
    own: Applied,
    limits: Vec<Limits>,
    /// Whether a larger strength leaves less.
    falls: bool,
}

impl Best {
    fn try_shape(&mut self, k: usize, by: f64, alike: &impl Fn(&Applied) -> f64) {
        let limit = self.limits[k];
        if limit.held {
            return;
        }
        let mut moved = self.own.clone();
        moved.parameters[k] = (moved.parameters[k] * by).clamp(limit.low, limit.high);
        let cosine = alike(&moved);
        if cosine > self.cosine {
            (self.cosine, self.own) = (cosine, moved);
        }
    }
}

fn best_probe(case: &Case, effect: &'static dyn Effect, alike: &impl Fn(&Applied) -> f64) -> Option<Best> {
    let scale = scale(case);
    let mut best: Option<Best> = None;
    for variant in 0..effect.about().variants.len().max(1) {
        let search = effect.search(variant, &scale);
        for probe in search.probes {
            let mut own = Applied {
                effect,
                variant,
                parameters: probe,
            };
            let mut cosine = alike(&own);
            // A strength of the other sign leaves the opposite, where there may be one.
            let strength = search.limits[0];
            if cosine < 0.0 && strength.low < 0.0 && !strength.held {
                cosine = -cosine;
                own.parameters[0] = -own.parameters[0];
            }
            if best.as_ref().is_none_or(|best| cosine > best.cosine) {
                best = Some(Best {
                    cosine,
                    own,
                    limits: search.limits.clone(),
                    falls: search.absent == f64::INFINITY,
                });
            }
        }
    }
    best
}

/// The strength at which the own form leaves as much.
fn matched(case: &Case, best: &Best, d: f64) -> Option<f64> {
    let strength = best.limits[0];
    if strength.held {
        return None;
    }
    let range = Range {
        start: best.own.parameters[0],
        low: strength.low,
        high: strength.high,
        falls: best.falls,
    };
    let with = |strength: f64| {
        let mut moved = best.own.clone();
        moved.parameters[0] = strength;
        Some(responses(case, &[moved]))
    };
    reach(case, d, range, with).map(|(strength, _)| strength)
}
