//! The relaxation of the modulus after a humidity step, and when it is over.

use super::exponentials::{Points, Trial};
use super::policy::REMAINDER;
use ieap_domain::Edge;
use ieap_domain::Estimate;
use ieap_domain::number::seconds::duration;
use ieap_domain::quantiles::NORMAL_95;
use ieap_numerics::line::halved;
use ieap_numerics::student::quantile_95;

/// A fitted relaxation: `asymptote + SUM amplitude e^(-(t - start)/tau)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Relaxation {
    start_s: f64,
    asymptote: f64,
    /// Amplitude at the start, and time constant, s.
    terms: Vec<(f64, f64)>,
    /// Time from the step to equilibrium within [`REMAINDER`], s.
    pub equilibrium_time_s: Estimate,
    /// Value in equilibrium, unit of the channel.
    pub equilibrium: Estimate,
}

impl Relaxation {
    /// The fitted value at a time, s.
    pub fn at(&self, time_s: f64) -> f64 {
        let since_s = time_s - self.start_s;
        let term = |(amplitude, tau_s): &(f64, f64)| amplitude * (-since_s / tau_s).exp();
        self.asymptote + self.terms.iter().map(term).sum::<f64>()
    }
}

/// What is fitted.
#[derive(Debug, Clone, Copy)]
pub struct Stretch<'a> {
    /// Times, s, rising.
    pub time_s: &'a [f64],
    /// Values at these times.
    pub values: &'a [f64],
    /// Last reading before the humidity leaves its level, s.
    pub start_s: f64,
    /// When the humidity leaves its level: times count from the middle of where that may be.
    pub(crate) begun: Edge,
    /// When it has reached the next, s: from there the relaxation is fitted.
    pub settled_s: f64,
    /// End of the stretch, s.
    pub end_s: f64,
    /// Value before the step.
    pub before: f64,
    /// Standard error of the value before.
    pub before_error: f64,
}

/// Fits one exponential, or two where they describe the readings better, to a stretch after a step.
///
/// The intervals are those of the profile likelihood over the time constants, widened for noise that remembers and
/// for what the amplitudes and the value before leave open.
///
/// # Errors
/// Why nothing can be fitted.
pub fn fit(stretch: &Stretch<'_>) -> Result<Relaxation, String> {
    let points = Points::of(stretch)?;
    let chosen = points.fitted().ok_or("no exponential fits")?;
    let noise = chosen.fit.noise();
    let parameters = 2.0 * chosen.taus_s.len() as f64 + 1.0;
    let freedom = (noise.effective_readings(points.values.len() as f64) - parameters).max(1.0);
    let (quantile, variance) = (quantile_95(freedom), noise.long_run_variance());
    let (least, allowed) = (chosen.fit.square(), quantile * quantile * variance);
    let value_s = time_to_equilibrium(&chosen, &points, stretch.before);
    let asymptote = chosen.fit.coefficients[0];
    let (mut asymptotes, mut times) = (Range::at(asymptote), Range::at(value_s));
    let mut is_open = false;
    for other in points.allowed(&chosen, least + allowed) {
        is_open |= points.is_slowest(&other);
        let time_s = time_to_equilibrium(&other, &points, stretch.before);
        times.widen(time_s, time_s);
        // The likelihood is exactly quadratic in the asymptote at given time constants.
        let left = (allowed - (other.fit.square() - least)).max(0.0);
        let half = (left * other.fit.inverse_diagonal(0)).sqrt();
        let centre = other.fit.coefficients[0];
        asymptotes.widen(centre - half, centre + half);
    }
    let of_fit = quantile * conditional_error(&chosen, &points, stretch, variance);
    times.add_in_quadrature(
        value_s,
        of_fit.hypot(NORMAL_95 * stretch.begun.standard_deviation_s()),
    );
    Ok(Relaxation {
        start_s: stretch.begun.middle_s(),
        asymptote,
        terms: points.terms(&chosen),
        equilibrium_time_s: equilibrium_time(stretch, value_s, times, is_open, quantile),
        equilibrium: equilibrium(asymptote, asymptotes, is_open, quantile),
    })
}

/// Range of a quantity over every solution that the readings allow.
#[derive(Debug, Clone, Copy)]
struct Range {
    low: f64,
    high: f64,
}

impl Range {
    fn at(value: f64) -> Range {
        Range {
            low: value,
            high: value,
        }
    }

    fn widen(&mut self, low: f64, high: f64) {
        self.low = self.low.min(low);
        self.high = self.high.max(high);
    }

    /// Widens both sides about `value` by an independent half-width.
    fn add_in_quadrature(&mut self, value: f64, half: f64) {
        self.low = value - (value - self.low).hypot(half);
        self.high = value + (self.high - value).hypot(half);
    }
}

/// Standard error of the time to equilibrium at given time constants, s: that of the amplitudes, of the asymptote
/// and of the value before, by a small change of each.
fn conditional_error(chosen: &Trial, points: &Points, stretch: &Stretch<'_>, variance: f64) -> f64 {
    const PART: f64 = 0.1;
    let time_s = |trial: &Trial, before| time_to_equilibrium(trial, points, before);
    let value_s = time_s(chosen, stretch.before);
    let slope = |k: usize| {
        let step = PART * (variance * chosen.fit.inverse_diagonal(k)).sqrt();
        let mut moved = chosen.clone();
        moved.fit.coefficients[k] += step;
        let slope = (time_s(&moved, stretch.before) - value_s) / step;
        if slope.is_finite() { slope } else { 0.0 }
    };
    let slopes: Vec<f64> = (0..chosen.fit.coefficients.len()).map(slope).collect();
    let weights = chosen.fit.weights(&slopes);
    let of_fit = variance * weights.iter().map(|w| w * w).sum::<f64>();
    let moved_s = time_s(chosen, stretch.before + PART * stretch.before_error);
    let of_before = (moved_s - value_s) / PART;
    (of_fit + of_before * of_before).sqrt()
}

/// Time since the step from which the fitted value stays within [`REMAINDER`] of the whole change from its
/// asymptote, s.
fn time_to_equilibrium(trial: &Trial, points: &Points, before: f64) -> f64 {
    let asymptote = trial.fit.coefficients[0];
    let within = REMAINDER * (asymptote - before).abs();
    let left = |since_s: f64| points.rest(trial, since_s).abs();
    let slowest_s = trial.taus_s.iter().copied().fold(0.0, f64::max);
    // Terms of one sign fall steadily, so that halving finds the place, before the first point too.
    if left(0.0) <= within {
        return 0.0;
    }
    let far_s = points.since_s[0] + 40.0 * slowest_s;
    halved(0.0, far_s, 60, |since_s| left(since_s) > within).1
}

fn equilibrium_time(
    stretch: &Stretch<'_>,
    value_s: f64,
    times: Range,
    is_open: bool,
    quantile: f64,
) -> Estimate {
    let length_s = stretch.end_s - stretch.start_s;
    let settling_s = stretch.settled_s - stretch.begun.no_earlier_s;
    if times.high <= settling_s {
        let reason = format!(
            "equilibrium is reached before the humidity has settled, {} after the step began",
            duration(settling_s)
        );
        return Estimate::below(settling_s, reason);
    }
    if is_open || value_s > length_s {
        let reason = format!(
            "the plateau is not reached within the {} after the step",
            duration(length_s)
        );
        return Estimate::above(times.low.clamp(0.0, length_s), reason);
    }
    let error = (times.high - times.low) / (2.0 * quantile);
    Estimate::determined(value_s, error, times.low.max(0.0), times.high)
}

fn equilibrium(value: f64, range: Range, is_open: bool, quantile: f64) -> Estimate {
    if is_open {
        return Estimate::not_determined("the relaxation is too slow for the stretch to show where it ends");
    }
    let error = (range.high - range.low) / (2.0 * quantile);
    Estimate::determined(value, error, range.low, range.high)
}
