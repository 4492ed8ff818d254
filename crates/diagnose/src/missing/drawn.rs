//! A law as a curve with its band.

use ieap_domain::LawCurve;
use ieap_domain::quantiles::NORMAL_95;
use ieap_model::effects::smooth_laws::{WEIGHTS, smooth_law};
use ieap_numerics::symmetric::Symmetric;

use super::policy::{FEWEST_PLACES, PLACES, TOLD_PART};
use crate::fitting::fitted::Fitted;

/// The last law of a model where the readings tell it; none where it is no function of one variable.
///
/// A level that the base's parameters take up as well (a conductance beside R_ss, a factor of all resistances) is not told: the
/// law is then drawn as its change from one of its places.
pub(super) fn drawn(fitted: &Fitted) -> Option<LawCurve> {
    let free_effect = fitted.problem.effects.last()?;
    let law = smooth_law(free_effect.effect.about().id)?;
    let parameters = fitted.effect_values().pop()?;
    let found = law.drawn(&parameters, PLACES)?;
    let free = free_effect.free();
    let bells: Vec<Vec<f64>> = (0..free)
        .filter_map(|k| {
            let mut one = parameters.clone();
            one[..WEIGHTS].fill(0.0);
            one[k] = free_effect.slope(k, parameters[k]);
            Some(law.drawn(&one, PLACES)?.y)
        })
        .collect();
    let (slope, _) = fitted.problem.slope(&fitted.at);
    let inverse = slope.normal.inverse(1e-12);
    let first = fitted.at.len() - free;
    // Before: weights of one size, that of those which the readings see. Each one's own may be any where nothing sees it.
    let known = |k: usize| free_effect.known.get(k).copied().unwrap_or_default();
    let by_readings = |k: usize| slope.normal.get(first + k, first + k) - known(k);
    let squares = (0..free).map(|k| by_readings(k) * fitted.at[first + k].powi(2));
    let size_squared = squares.sum::<f64>() / (0..free).map(by_readings).sum::<f64>();
    let band = Band {
        bells: &bells,
        after: Symmetric::from_fn(free, |a, b| inverse.get(first + a, first + b)),
        before: Symmetric::from_fn(free, |a, b| if a == b { size_squared } else { 0.0 }),
    };
    let (from, told) = band.told();
    let level = from.map_or(0.0, |from| found.y[from]);
    let kept = if told.len() < FEWEST_PLACES {
        (0..PLACES).collect()
    } else {
        told
    };
    let y = |place: usize| found.y[place] - level;
    let half = |place: usize| NORMAL_95 * band.variance(&band.after, place, from).max(0.0).sqrt();
    let each = |of: &dyn Fn(usize) -> f64| kept.iter().map(|&place| of(place)).collect::<Vec<f64>>();
    Some(LawCurve {
        x: each(&|place| found.x[place]),
        y: each(&y),
        low_95: each(&|place| y(place) - half(place)),
        high_95: each(&|place| y(place) + half(place)),
        unit: found.unit.to_owned(),
    })
}

/// What is known of a law at each place, after the readings and before.
struct Band<'a> {
    bells: &'a [Vec<f64>],
    after: Symmetric,
    before: Symmetric,
}

impl Band<'_> {
    /// Variance at a place, or of the change from another one.
    fn variance(&self, covariance: &Symmetric, place: usize, from: Option<usize>) -> f64 {
        let own: Vec<f64> = (self.bells.iter())
            .map(|bell| bell[place] - from.map_or(0.0, |from| bell[from]))
            .collect();
        own.iter().zip(covariance.times(&own)).map(|(a, b)| a * b).sum()
    }

    /// The places that the readings tell, as they are or as changes from one of them, whichever are more.
    fn told(&self) -> (Option<usize>, Vec<usize>) {
        let of = |from: Option<usize>| -> Vec<usize> {
            (0..PLACES).filter(|&place| self.is_told(place, from)).collect()
        };
        let mut best = (None, of(None));
        for from in 0..PLACES {
            let told = of(Some(from));
            if told.len() > best.1.len() {
                best = (Some(from), told);
            }
        }
        best
    }

    /// Whether the readings tell more of a place than was known before.
    fn is_told(&self, place: usize, from: Option<usize>) -> bool {
        let (after, before) = (&self.after, &self.before);
        self.variance(after, place, from) <= TOLD_PART * TOLD_PART * self.variance(before, place, from)
    }
}
