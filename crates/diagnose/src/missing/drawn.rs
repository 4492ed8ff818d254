//! A law as a curve with its band.

use ieap_domain::quantiles::NORMAL_95;
use ieap_domain::{Drive, LawCurve, range_of};
use ieap_model::effects::place_of_form;
use ieap_model::effects::smooth_laws::{Drawn, SmoothLaw, WEIGHTS, smooth_law};
use ieap_model::extended::RunContext;
use ieap_numerics::sums::peak;
use ieap_numerics::symmetric::Symmetric;

use super::policy::{FEWEST_PLACES, PLACES, STEADY_AFTER, STEADY_PLACES, TOLD_PART};
use crate::fitting::fitted::Fitted;
use crate::fitting::problem::ExtendedProblem;

/// The last law of a model where the readings tell it; none where they do not, or where it is no function of one variable.
///
/// What the base's parameters take up as well is not told. A leak over the voltage is therefore drawn as the whole steady
/// current. A level (a factor of all resistances) is left out: the law is drawn as its change from one of its places.
pub(super) fn drawn(fitted: &Fitted) -> Option<LawCurve> {
    let last = fitted.problem.effects.last()?;
    let id = last.effect.about().id;
    let law = smooth_law(id);
    let place = law
        .map(|law| law.place)
        .or_else(|| place_of_form(id, last.variant))?;
    if (place.law, place.variable) == ("leak", "voltage_v") {
        return steady_current(fitted);
    }
    Added::of(fitted, law?)?.told()
}

/// What a law adds over its variable, and what is known of it.
struct Added {
    drawn: Drawn,
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
            band: Band {
                slopes: slopes?,
                before: Symmetric::from_fn(fitted.at.len(), before),
                after: slope.normal.inverse(1e-12),
            },
        })
    }

    /// Where the readings tell it; none where they tell too little of it.
    fn told(&self) -> Option<LawCurve> {
        let (from, kept) = self.band.told();
        let level = from.map_or(0.0, |from| self.drawn.y[from]);
        let y = |place: usize| self.drawn.y[place] - level;
        let half =
            |place: usize| NORMAL_95 * self.band.variance(&self.band.after, place, from).max(0.0).sqrt();
        // What is multiplied has no sign to lose.
        let least = if self.drawn.unit == "1" && from.is_none() {
            -1.0
        } else {
            f64::NEG_INFINITY
        };
        let each = |of: &dyn Fn(usize) -> f64| kept.iter().map(|&place| of(place)).collect::<Vec<f64>>();
        (kept.len() >= FEWEST_PLACES).then(|| LawCurve {
            x: each(&|place| self.drawn.x[place]),
            y: each(&y),
            low_95: each(&|place| (y(place) - half(place)).max(least)),
            high_95: each(&|place| y(place) + half(place)),
            unit: self.drawn.unit.to_owned(),
            without: Vec::new(),
        })
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
        self.variance(after, place, from) < TOLD_PART * TOLD_PART * self.variance(before, place, from)
    }
}

/// The steady current of a model over the voltages of its runs, A/cm2, with what the least conductance on the way would carry:
/// what a long run at that voltage ends at. None of one voltage, or where too little of it is known.
fn steady_current(fitted: &Fitted) -> Option<LawCurve> {
    let group = fitted.problem.group;
    let volts: Vec<f64> = group
        .runs
        .iter()
        .map(|run| run.drive().nominal_step_v())
        .collect();
    let sign = volts.first()?.signum();
    let (low, high) = range_of(volts.iter().map(|v| v.abs()));
    let place = |k: usize| sign * (low + (high - low) * k as f64 / (STEADY_PLACES - 1) as f64);
    let x: Vec<f64> = (0..STEADY_PLACES).map(place).collect();
    let y = steady_at(fitted, &fitted.at, &x)?;
    let (slope, _) = fitted.problem.slope(&fitted.at);
    // What even this model leaves beyond the noise is an error of what is drawn as well.
    let left = (fitted.square / group.rows() as f64).max(1.0);
    let covariance = slope.normal.inverse(1e-12);
    let by = |k: usize| -> Option<Vec<f64>> {
        let mut there = fitted.at.clone();
        there[k] += ExtendedProblem::STEP;
        let moved = steady_at(fitted, &there, &x)?;
        let each = moved.iter().zip(&y);
        Some(
            each.map(|(there, here)| (there - here) / ExtendedProblem::STEP)
                .collect(),
        )
    };
    let slopes: Vec<Vec<f64>> = (0..fitted.at.len()).map(by).collect::<Option<_>>()?;
    let half = |place: usize| {
        let own: Vec<f64> = slopes.iter().map(|slope| slope[place]).collect();
        NORMAL_95 * (left * covariance.form(&own, &own).max(0.0)).sqrt()
    };
    let halves: Vec<f64> = (0..STEADY_PLACES).map(half).collect();
    let most = peak(&y);
    let kept: Vec<usize> = (0..STEADY_PLACES)
        .filter(|&k| halves[k] < TOLD_PART * most)
        .collect();
    let ratios = kept.iter().map(|&k| y[k] / x[k]).filter(|own| own.is_finite());
    let conductance = ratios.fold(f64::INFINITY, f64::min).max(0.0);
    let each = |of: &dyn Fn(usize) -> f64| kept.iter().map(|&k| of(k)).collect::<Vec<f64>>();
    (high > low && kept.len() >= FEWEST_PLACES).then(|| LawCurve {
        x: each(&|k| x[k]),
        y: each(&|k| y[k]),
        low_95: each(&|k| y[k] - halves[k]),
        high_95: each(&|k| y[k] + halves[k]),
        unit: "A/cm2".to_owned(),
        without: each(&|k| conductance * x[k]),
    })
}

/// What a long run ends at under each of these voltages, A/cm2; none where it is no number.
fn steady_at(fitted: &Fitted, at: &[f64], volts: &[f64]) -> Option<Vec<f64>> {
    let model = fitted.problem.model(at);
    let run = fitted.problem.group.runs.first()?;
    let slowest_s = model.base.branches.iter().map(|own| own.time_constant_s());
    let end_s = slowest_s.fold(run.duration_s, |most, own| most.max(STEADY_AFTER * own));
    let of = |v: &f64| {
        let drive = Drive::step(*v);
        let context = RunContext {
            drive: &drive,
            duration_s: end_s,
            ..run.context(0, None)
        };
        let found = model.responses(&context, &[end_s], &[]).current_a;
        found
            .first()
            .map(|current_a| current_a / run.given.input.area_cm2)
    };
    let found: Option<Vec<f64>> = volts.iter().map(of).collect();
    found.filter(|all| all.iter().all(|v| v.is_finite()))
}
