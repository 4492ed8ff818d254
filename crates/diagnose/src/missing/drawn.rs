//! A law as a curve with its band.

use ieap_domain::LawCurve;
use ieap_domain::quantiles::NORMAL_95;
use ieap_model::effects::smooth_laws::{Drawn, SmoothLaw, WEIGHTS, smooth_law};
use ieap_numerics::symmetric::Symmetric;

use super::policy::{FEWEST_PLACES, PLACES, TOLD_PART};
use crate::fitting::fitted::Fitted;
use crate::fitting::problem::ExtendedProblem;

/// The last law of a model where the readings tell it; none where it is no function of one variable.
///
/// What the base's parameters take up as well is not told. A leak over the voltage is therefore drawn as the whole steady
/// current, V / R_ss with what the law adds. A level (a factor of all resistances) is left out: the law is drawn as its change from
/// one of its places.
pub(super) fn drawn(fitted: &Fitted) -> Option<LawCurve> {
    let law = smooth_law(fitted.problem.effects.last()?.effect.about().id)?;
    let as_added = Added::of(fitted, law)?;
    if law.place.law == "leak" && law.place.variable == "voltage_v" {
        return Some(as_added.with_steady_current(fitted).told(false));
    }
    Some(as_added.told(true))
}

/// What a law adds over its variable, and what is known of it.
struct Added {
    drawn: Drawn,
    /// Whether the whole steady current is drawn, and not the law alone.
    is_whole: bool,
    band: Band,
}

impl Added {
    fn of(fitted: &Fitted, law: &SmoothLaw) -> Option<Added> {
        let free_effect = fitted.problem.effects.last()?;
        let parameters = fitted.effect_values().pop()?;
        let found = law.drawn(&parameters, PLACES)?;
        let free = free_effect.free();
        let first = fitted.at.len() - free;
        let of_weight = |k: usize| {
            let mut one = parameters.clone();
            one[..WEIGHTS].fill(0.0);
            one[k] = free_effect.slope(k, parameters[k]);
            Some(law.drawn(&one, PLACES)?.y)
        };
        let of_base = (0..first).map(|_| Some(vec![0.0; PLACES]));
        let slopes: Option<Vec<Vec<f64>>> = of_base.chain((0..free).map(of_weight)).collect();
        let (slope, _) = fitted.problem.slope(&fitted.at);
        // Before: weights of one size, that of those which the readings see. Each one's own may be any where nothing sees it.
        let known = |k: usize| free_effect.known.get(k).copied().unwrap_or_default();
        let by_readings = |k: usize| slope.normal.get(first + k, first + k) - known(k);
        let squares = (0..free).map(|k| by_readings(k) * fitted.at[first + k].powi(2));
        let size_squared = squares.sum::<f64>() / (0..free).map(by_readings).sum::<f64>();
        let before = |a: usize, b: usize| if a == b && a >= first { size_squared } else { 0.0 };
        Some(Added {
            drawn: found,
            is_whole: false,
            band: Band {
                slopes: slopes?,
                before: Symmetric::from_fn(fitted.at.len(), before),
                after: slope.normal.inverse(1e-12),
            },
        })
    }

    /// The steady current, A/cm2: that of R_ss with what the conductance of the law adds.
    fn with_steady_current(mut self, fitted: &Fitted) -> Added {
        let conductance = |at: &[f64]| {
            fitted
                .problem
                .model(at)
                .base
                .steady_state_resistance_ohm_cm2
                .recip()
        };
        let here = conductance(&fitted.at);
        for (k, slope) in self.band.slopes.iter_mut().enumerate() {
            let mut there = fitted.at.clone();
            there[k] += ExtendedProblem::STEP;
            let by_base = (conductance(&there) - here) / ExtendedProblem::STEP;
            let each = slope.iter_mut().zip(&self.drawn.x);
            each.for_each(|(slope, v)| *slope = v * (*slope + by_base));
        }
        let each = self.drawn.y.iter_mut().zip(&self.drawn.x);
        each.for_each(|(y, v)| *y = v * (*y + here));
        (self.drawn.unit, self.is_whole) = ("A/cm2", true);
        self
    }

    /// Where the readings tell it; else whole. `levelled` where its level is one that the base takes up.
    fn told(&self, levelled: bool) -> LawCurve {
        let (from, told) = self.band.told(levelled);
        let level = from.map_or(0.0, |from| self.drawn.y[from]);
        let kept = if told.len() < FEWEST_PLACES {
            (0..PLACES).collect()
        } else {
            told
        };
        let y = |place: usize| self.drawn.y[place] - level;
        let half =
            |place: usize| NORMAL_95 * self.band.variance(&self.band.after, place, from).max(0.0).sqrt();
        // What is multiplied has no sign to lose.
        let least = if self.drawn.unit == "1" && from.is_none() {
            -1.0
        } else {
            f64::NEG_INFINITY
        };
        // R_ss and the law share a conductance: the law is what goes beyond the least one, so that it takes no current away.
        let ratios = kept
            .iter()
            .map(|&place| self.drawn.y[place] / self.drawn.x[place]);
        let conductance = ratios
            .filter(|own| own.is_finite())
            .fold(f64::INFINITY, f64::min)
            .max(0.0);
        let each = |of: &dyn Fn(usize) -> f64| kept.iter().map(|&place| of(place)).collect::<Vec<f64>>();
        LawCurve {
            x: each(&|place| self.drawn.x[place]),
            y: each(&y),
            low_95: each(&|place| (y(place) - half(place)).max(least)),
            high_95: each(&|place| y(place) + half(place)),
            unit: self.drawn.unit.to_owned(),
            without: if self.is_whole {
                each(&|place| conductance * self.drawn.x[place])
            } else {
                Vec::new()
            },
        }
    }
}

/// What is known of a law at each place, after the readings and before.
struct Band {
    /// Of every coordinate, what it changes at each place.
    slopes: Vec<Vec<f64>>,
    after: Symmetric,
    before: Symmetric,
}

impl Band {
    /// Variance at a place, or of the change from another one.
    fn variance(&self, covariance: &Symmetric, place: usize, from: Option<usize>) -> f64 {
        let own: Vec<f64> = (self.slopes.iter())
            .map(|slope| slope[place] - from.map_or(0.0, |from| slope[from]))
            .collect();
        covariance.form(&own, &own)
    }

    /// The places that the readings tell, as they are or, where that is asked, as changes from one of them, whichever are more.
    fn told(&self, levelled: bool) -> (Option<usize>, Vec<usize>) {
        let of = |from: Option<usize>| -> Vec<usize> {
            (0..PLACES).filter(|&place| self.is_told(place, from)).collect()
        };
        let mut best = (None, of(None));
        for from in (0..PLACES).filter(|_| levelled) {
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
        self.variance(after, place, from) < TOLD_PART * TOLD_PART * self.variance(before, place, from)
    }
}
