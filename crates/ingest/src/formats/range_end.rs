//! Readings that stand at the end of an instrument's range: they say how much there was at least, and are no readings.

use std::sync::Arc;

use super::error::quoted;
use super::policy::{CEILING_ABOVE_RESOLUTION, CEILING_READINGS, CEILING_SLOWS_DOWN};
use ieap_domain::number::fixed;
use ieap_domain::{Channel, Issue};

/// Code of the warning.
const CODE: &str = "range-exceeded";

/// Leaves readings out that a response holds exactly at its largest size and leaves on a slope: a smooth course that falls so
/// fast was not flat before.
pub(super) fn leave_out(channel: &mut Channel) -> Option<Issue> {
    let (values, held) = (&channel.values, at_range_end(&channel.values));
    let first = *held.first()?;
    let message = format!(
        "{} of {} readings of {} stand at exactly {} {}, the end of the instrument's range: there was at least as much; they are \
         left out",
        held.len(),
        values.len(),
        quoted(&channel.raw_name),
        fixed(values[first as usize], 6),
        channel.quantity.unit(),
    );
    let mut excluded: Vec<u32> = channel.excluded.iter().copied().chain(held).collect();
    excluded.sort_unstable();
    excluded.dedup();
    channel.excluded = Arc::from(excluded);
    let issue = Issue::warning(CODE, message).at(format!("{} s", channel.time_s[first as usize]));
    Some(issue.mend("choose a larger range of the instrument"))
}

/// Indices of the readings at the end of the range, ascending.
fn at_range_end(values: &[f64]) -> Vec<u32> {
    let most = values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let mut held = Vec::new();
    let mut from = 0;
    while from < values.len() {
        let same = values[from..].iter().take_while(|value| **value == values[from]);
        let next = from + same.count();
        let is_held = values[from].abs() == most && next - from >= CEILING_READINGS;
        if is_held && leaves_on_a_slope(values, next) {
            held.extend(from as u32..next as u32);
        }
        from = next;
    }
    held
}

/// Whether the course falls from the reading before `next` on by more than its resolution, and goes on falling: behind an edge of
/// the drive it falls once, or far more at first.
fn leaves_on_a_slope(values: &[f64], next: usize) -> bool {
    let Some([ceiling, first, second]) = values.get(next - 1..next + 2) else {
        return false;
    };
    let falls = [
        (ceiling - first) * ceiling.signum(),
        (first - second) * ceiling.signum(),
    ];
    let changes = values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let resolution = changes
        .filter(|change| *change > 0.0)
        .fold(f64::INFINITY, f64::min);
    let least = CEILING_ABOVE_RESOLUTION * resolution;
    falls[0] > least && falls[1] > least && falls[0] < CEILING_SLOWS_DOWN * falls[1]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A charging current read with a resolution, behind as many readings of rest; noise within one of these.
    fn charging(resolution: f64, ceiling: f64) -> Vec<f64> {
        let of = |k: i32| {
            let t = f64::from(k - 20) * 0.1;
            let current = if t < 0.0 {
                0.0
            } else {
                8.0 * (-t / 1.5).exp() + 1.4
            };
            let noise = resolution * f64::from((k * 7919) % 7 - 3) / 3.0;
            (((current + noise) / resolution).round() * resolution).min(ceiling)
        };
        (0..200).map(of).collect()
    }

    #[test]
    fn readings_at_the_end_of_the_range_are_left_out() {
        let values = charging(1e-3, 5.0);
        let at_end = values.iter().filter(|value| **value == 5.0).count();
        assert!(at_end > 5);
        assert_eq!(at_range_end(&values).len(), at_end);
        let below: Vec<f64> = values.iter().map(|value| -value).collect();
        assert_eq!(at_range_end(&below).len(), at_end);
    }

    #[test]
    fn a_peak_a_plateau_and_a_coarse_converter_are_readings() {
        for resolution in [1e-6, 1e-3, 0.05, 0.5] {
            assert_eq!(
                at_range_end(&charging(resolution, f64::INFINITY)),
                [0; 0],
                "{resolution}"
            );
        }
        // A plain resistance under pulses, exactly, and one whose lead is slow at the edges.
        let pulses: Vec<f64> = (0..200).map(|k| f64::from(k / 20 % 2)).collect();
        assert_eq!(at_range_end(&pulses), [0; 0]);
        let slow: Vec<f64> = pulses
            .windows(2)
            .map(|pair| 0.9 * pair[1] + 0.1 * pair[0])
            .collect();
        assert_eq!(at_range_end(&slow), [0; 0]);
    }
}
