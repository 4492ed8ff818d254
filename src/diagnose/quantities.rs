//! What a user predicts: peak, time of the peak, plateau, charge, end current; measured and by a model.

use super::group::GroupRun;

/// Readings that are averaged where a single one would be noise.
const TOGETHER: usize = 5;
/// Part of the record that counts as its end.
const END: f64 = 0.05;

/// Names of the quantities, in the order of [`Predicted::relative_errors`].
pub(super) const NAMES: [&str; 5] = [
    "peak_curvature",
    "time_of_peak_curvature",
    "end_curvature",
    "charge",
    "end_current",
];

/// How well a model predicted a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Predicted {
    /// Deviation of each quantity over what was measured; none where that is not measured or next to nothing.
    pub(super) relative_errors: [Option<f64>; 5],
}

/// Compares a run's readings with the currents and curvatures of a model at their times.
pub(super) fn predicted(run: &GroupRun, fitted: [&[f64]; 2]) -> Predicted {
    let measured: [Option<&[f64]>; 2] =
        std::array::from_fn(|k| run.channels[k].as_ref().map(|channel| &**channel.values()));
    let of_curvature = |of: fn(&[f64], &[f64]) -> Option<f64>| {
        error(of(run.times(1), measured[1]?), of(run.times(1), fitted[1]))
    };
    let of_current = |of: fn(&[f64], &[f64]) -> Option<f64>| {
        error(of(run.times(0), measured[0]?), of(run.times(0), fitted[0]))
    };
    Predicted {
        relative_errors: [
            of_curvature(|t, v| peak(t, v).map(|(_, value)| value)),
            of_curvature(|t, v| peak(t, v).map(|(time_s, _)| time_s)),
            of_curvature(|_, v| end(v)),
            of_current(charge),
            of_current(|_, v| end(v)),
        ],
    }
}

fn error(measured: Option<f64>, fitted: Option<f64>) -> Option<f64> {
    let (measured, fitted) = (measured?, fitted?);
    let relative = (fitted - measured).abs() / measured.abs();
    relative.is_finite().then_some(relative)
}

/// Time and value of the largest mean of neighbouring readings, by size.
fn peak(time_s: &[f64], values: &[f64]) -> Option<(f64, f64)> {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let means = values.windows(TOGETHER).zip(time_s.windows(TOGETHER));
    means
        .map(|(values, times)| (mean(times), mean(values)))
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
}

/// Mean of the last readings.
fn end(values: &[f64]) -> Option<f64> {
    let count = ((values.len() as f64 * END) as usize).max(TOGETHER);
    let last = values.get(values.len().checked_sub(count)?..)?;
    Some(last.iter().sum::<f64>() / count as f64)
}

/// Integral of the current, C.
fn charge(time_s: &[f64], current_a: &[f64]) -> Option<f64> {
    let pairs = time_s.windows(2).zip(current_a.windows(2));
    let sum: f64 = pairs.map(|(t, i)| (t[1] - t[0]) * (i[0] + i[1]) / 2.0).sum();
    (current_a.len() > TOGETHER).then_some(sum)
}

/// Root mean square of each quantity's deviation over all runs, percent; none where no run tells.
pub(super) fn percent(parts: &[Predicted], quantity: usize) -> Option<f64> {
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
    fn errors_are_pooled_as_root_mean_squares() {
        let part = |error: Option<f64>| Predicted {
            relative_errors: [error, None, None, None, None],
        };
        let parts = [part(Some(0.03)), part(Some(0.04)), part(None)];
        assert!((percent(&parts, 0).unwrap() - 3.5355).abs() < 1e-3);
        assert_eq!(percent(&parts, 1), None);
    }
}
