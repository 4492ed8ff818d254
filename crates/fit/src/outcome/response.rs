//! One response of a fit: its noise, and the curve to draw.

use crate::joint::noise::Noise;
use crate::joint::whitening::{Autocorrelation, longest_s};
use crate::options::FitOptions;
use crate::policy::{ENOUGH_FOR_NOISE, FOLLOWED_PART};
use crate::sampled::Sampled;
use crate::uncertainty::Residuals;
use ieap_domain::number::fixed;
use ieap_domain::thinning::drawn_indices;
use ieap_domain::{ChannelNoise, NoiseCharacter, Quantity, RunCurve};
use ieap_numerics::correlation::lag_one;
use ieap_numerics::sums;

/// Stretches of time in which the drawn readings are chosen.
const DRAWN_STRETCHES: usize = 120;
/// The same of a voltage that moves all the time: as fine as a figure is wide.
const DRAWN_MOVING: usize = 600;

/// What is made of a response beside its estimates.
#[derive(Clone, Copy)]
pub(super) struct Wanted {
    /// Whether memory, growth and steps of its noise are described.
    pub(super) describes_noise: bool,
    pub(super) curve: Drawn,
}

/// Which readings the curve of a response has.
#[derive(Clone, Copy)]
pub(super) enum Drawn {
    None,
    /// As many as a figure shows.
    Thinned,
    All,
}

impl Wanted {
    /// Its noise, and the curve as it is drawn.
    pub(super) const NOISE: Wanted = Wanted {
        describes_noise: true,
        curve: Drawn::Thinned,
    };
    /// Nothing: of a fit that is made for its estimates.
    pub(super) const ESTIMATES: Wanted = Wanted {
        describes_noise: false,
        curve: Drawn::None,
    };

    pub(super) fn of(options: &FitOptions) -> Wanted {
        Wanted {
            describes_noise: options.describes_noise,
            curve: if options.whole_curves {
                Drawn::All
            } else {
                Drawn::Thinned
            },
        }
    }
}

/// One response with its noise and the curve to draw.
pub(super) struct Response {
    pub(super) noise: ChannelNoise,
    pub(super) curve: RunCurve,
}

impl Response {
    pub(super) fn new(
        quantity: Quantity,
        sampled: &Sampled,
        residuals: Option<&Residuals>,
        step_s: f64,
        wanted: Wanted,
    ) -> Response {
        let (standard_deviation, basis) = noise(sampled, residuals);
        let rms = residuals.map_or(0.0, |r| (r.square / sampled.len().max(1) as f64).sqrt());
        // Noise of exactly zero (a channel that was computed) cannot be a unit; the residual then is its own.
        let unit = [standard_deviation, rms]
            .into_iter()
            .find(|unit| *unit > 0.0)
            .unwrap_or(1.0);
        let left: &[f64] = residuals.map_or(&[], |r| &r.residuals);
        let fitted: &[f64] = residuals.map_or(&[], |r| &r.fitted);
        let series: &[&[f64]] = if left.is_empty() {
            &[&sampled.values]
        } else {
            &[&sampled.values, left]
        };
        let stretches = if sampled.moves {
            DRAWN_MOVING
        } else {
            DRAWN_STRETCHES
        };
        let drawn = match wanted.curve {
            Drawn::None => Vec::new(),
            Drawn::Thinned => drawn_indices(&sampled.time_s, series, step_s, stretches),
            Drawn::All => (0..sampled.len()).collect(),
        };
        let at =
            |column: &[f64]| -> Vec<f64> { drawn.iter().filter_map(|&k| column.get(k).copied()).collect() };
        Response {
            noise: ChannelNoise {
                quantity,
                standard_deviation,
                basis,
                character: match (wanted.describes_noise, sampled.moves) {
                    (false, _) => NoiseCharacter::default(),
                    (true, false) => character(sampled, left),
                    // No sum of exponentials follows a voltage that moves: what no fit was subtracted from says nothing.
                    (true, true) if left.is_empty() => NoiseCharacter::default(),
                    (true, true) => character(&sampled.rest(left), &[]),
                },
                residual_autocorrelation: lag_one(left),
                residual_rms: rms,
                readings: if residuals.is_some() { sampled.len() } else { 0 },
                r_squared: residuals.and_then(|r| r_squared(sampled, &r.residuals)),
            },
            curve: RunCurve {
                quantity,
                time_s: at(&sampled.time_s),
                measured: at(&sampled.values),
                fitted: at(fitted),
                residual_sigma: at(left).iter().map(|r| r / unit).collect(),
                readings: sampled.len(),
            },
        }
    }
}

/// Memory, growth and steps of the noise.
fn character(sampled: &Sampled, left: &[f64]) -> NoiseCharacter {
    let peak = sums::peak(&sampled.values);
    let of_ends =
        |sampled: &Sampled| (sampled.len() > 2 * ENOUGH_FOR_NOISE).then(|| sampled.ends(ENOUGH_FOR_NOISE));
    let ends = of_ends(sampled);
    let left = match &ends {
        Some(_) if left.len() == sampled.len() => {
            let mut rest = sampled.clone();
            rest.values = left.into();
            of_ends(&rest).map_or(left.into(), |rest| rest.values)
        }
        _ => left.into(),
    };
    let noise = Noise::beside_fit(ends.as_ref().unwrap_or(sampled), &left, 1e-9 * peak);
    let (autoregression, correlation_time_s) = match noise.autocorrelation {
        Autocorrelation::Order(coefficients) => (coefficients, None),
        Autocorrelation::Time { correlation_time_s } => (Vec::new(), Some(correlation_time_s)),
        Autocorrelation::Slow(processes) => (Vec::new(), longest_s(&processes)),
    };
    NoiseCharacter {
        autoregression,
        correlation_time_s,
        proportional: noise.proportional,
        quantum: noise.quantum,
        runs_of_instrument: 0,
    }
}

/// Noise standard deviation, and how it was found: without the model, unless that leaves far less than the signal's own
/// bends do.
fn noise(sampled: &Sampled, residuals: Option<&Residuals>) -> (f64, String) {
    match &sampled.scatter {
        Some(scatter) if residuals.is_some_and(|r| are_below(r, scatter.standard_deviation)) => (
            residuals.map_or(0.0, |residuals| residuals.noise.variance.sqrt()),
            "residuals of the fit, for the readings are too far apart to show scatter".to_owned(),
        ),
        Some(scatter) => (
            scatter.standard_deviation,
            format!(
                "scatter of {} neighbouring readings about a smooth curve (correlation of neighbours {})",
                scatter.window,
                fixed(scatter.correlation, 2)
            ),
        ),
        None => {
            let differences = sampled
                .values
                .windows(3)
                .map(|three| three[2] - 2.0 * three[1] + three[0]);
            let (square, count) = differences.fold((0.0, 0.0), |(s, c), d| (s + d * d, c + 1.0));
            let variance = if count > 0.0 { square / count / 6.0 } else { 0.0 };
            (
                variance.sqrt(),
                "second differences, for want of longer stretches".to_owned(),
            )
        }
    }
}

/// Whether a fit leaves so little that a scatter of `standard_deviation` cannot be noise. Readings that are equal to the
/// last digit leave nothing and say nothing.
fn are_below(residuals: &Residuals, standard_deviation: f64) -> bool {
    let left = residuals.noise.variance;
    left > 0.0 && left < FOLLOWED_PART * standard_deviation.powi(2)
}

/// 1 - SUM r^2 / SUM (y - mean)^2 over the readings from the step on, as the thesis prints it; none where
/// those do not vary.
fn r_squared(sampled: &Sampled, residuals: &[f64]) -> Option<f64> {
    let start = sampled.before_step();
    let (values, residuals) = (&sampled.values[start..], &residuals[start..]);
    let total = sums::square_about(values, sums::sum(values) / values.len() as f64);
    let left = sums::square(residuals);
    (total > 0.0).then(|| 1.0 - left / total)
}
