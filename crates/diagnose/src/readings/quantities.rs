//! What a user predicts: peak, time of the peak, plateau, charge, end current; measured and by a model.

use crate::readings::charges::passed;
use crate::readings::group::GroupRun;
use crate::readings::policy::{END_PART, KNOWN_FROM_SIGMAS, READINGS_TOGETHER};
use ieap_fit::WhitenedChannel;
use ieap_numerics::sums::mean;

/// Names of the quantities, in the order of [`Predicted::relative_errors`].
pub(crate) const NAMES: [&str; 5] = [
    "peak_curvature",
    "time_of_peak_curvature",
    "end_curvature",
    "charge",
    "end_current",
];

/// How well a model predicted a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Predicted {
    /// Deviation of each quantity over what was measured; none where that is not measured or next to nothing.
    pub(crate) relative_errors: [Option<f64>; 5],
}

/// Compares a run's readings with the currents and curvatures of a model at their times.
pub(crate) fn predicted(run: &GroupRun, fitted: [&[f64]; 2]) -> Predicted {
    let measured: [Option<&[f64]>; 2] =
        std::array::from_fn(|k| run.channels[k].as_ref().map(|channel| &**channel.values()));
    let of = |k: usize, of: fn(&[f64], &[f64]) -> Option<f64>, least: f64| {
        error(
            of(run.times(k), measured[k]?)?,
            of(run.times(k), fitted[k])?,
            least,
        )
    };
    let least = |k: usize, count: fn(usize) -> usize| {
        let channel = run.channels[k].as_ref();
        channel.map_or(0.0, |channel| {
            KNOWN_FROM_SIGMAS * standard_error(channel, count(channel.len()))
        })
    };
    let peak_value = |t: &[f64], v: &[f64]| peak(t, v).map(|(_, value)| value);
    Predicted {
        relative_errors: [
            of(1, peak_value, least(1, |_| READINGS_TOGETHER)),
            of(1, |t, v| peak(t, v).map(|(time_s, _)| time_s), 0.0),
            of(1, |_, v| end(v), least(1, at_end)),
            of(0, charge, 0.0),
            of(0, |_, v| end(v), least(0, at_end)),
        ],
    }
}

/// Deviation over what was measured; none where that is below `least`.
fn error(measured: f64, fitted: f64, least: f64) -> Option<f64> {
    let relative = (fitted - measured).abs() / measured.abs();
    (measured.abs() >= least && relative.is_finite()).then_some(relative)
}

/// Standard error of a mean of so many neighbouring readings.
fn standard_error(channel: &WhitenedChannel, count: usize) -> f64 {
    let single = mean(channel.standard_deviation());
    let independent = count as f64 / channel.readings_per_independent();
    single / independent.max(1.0).sqrt()
}

/// Readings that make up the end of so many.
fn at_end(readings: usize) -> usize {
    ((readings as f64 * END_PART) as usize).max(READINGS_TOGETHER)
}

/// Time and value of the largest mean of neighbouring readings, by size.
fn peak(time_s: &[f64], values: &[f64]) -> Option<(f64, f64)> {
    let means = values
        .windows(READINGS_TOGETHER)
        .zip(time_s.windows(READINGS_TOGETHER));
    means
        .map(|(values, times)| (mean(times), mean(values)))
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
}

/// Mean of the last readings.
fn end(values: &[f64]) -> Option<f64> {
    let count = at_end(values.len());
    let last = values.get(values.len().checked_sub(count)?..)?;
    Some(mean(last))
}

/// Integral of the current, C.
fn charge(time_s: &[f64], current_a: &[f64]) -> Option<f64> {
    let whole = || passed(time_s, current_a).last();
    (current_a.len() > READINGS_TOGETHER).then(whole)?
}

/// Root mean square of each quantity's deviation over all runs, percent; none where no run tells.
pub(crate) fn percent(parts: &[Predicted], quantity: usize) -> Option<f64> {
    let errors: Vec<f64> = parts
        .iter()
        .filter_map(|part| part.relative_errors[quantity])
        .collect();
    let square: f64 = errors.iter().map(|error| error * error).sum();
    (!errors.is_empty()).then(|| 100.0 * (square / errors.len() as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peak_end_and_charge_of_a_known_curve() {
        let time_s: Vec<f64> = (0..=100).map(f64::from).collect();
        let bump: Vec<f64> = time_s
            .iter()
            .map(|t| -(1.0 - ((t - 40.0) / 40.0).powi(2)))
            .collect();
        let (at_s, value) = peak(&time_s, &bump).unwrap();
        assert!((at_s - 100.0).abs() < 3.0 || (at_s - 40.0).abs() < 1.0, "{at_s}");
        assert!(value.abs() > 0.99);
        assert_eq!(charge(&time_s, &vec![2.0; 101]), Some(200.0));
        assert_eq!(end(&time_s), Some(98.0));
        assert_eq!(end(&[1.0, 2.0]), None);
    }

    #[test]
    fn what_is_next_to_nothing_has_no_relative_error() {
        assert_eq!(error(0.02, 0.05, 0.03), None);
        assert_eq!(error(0.0, 0.05, 0.0), None);
        assert!((error(-0.04, -0.05, 0.03).unwrap() - 0.25).abs() < 1e-12);
    }

    #[test]
    fn errors_are_pooled_as_root_mean_squares() {
        let part = |error: Option<f64>| Predicted {
            relative_errors: [error, None, None, None, None],
        };
        let parts = [part(Some(0.03)), part(Some(0.04)), part(None)];
        assert!((percent(&parts, 0).unwrap() - 3.5355).abs() < 1e-3);
        assert_eq!(percent(&parts, 1), None);
    }
}
