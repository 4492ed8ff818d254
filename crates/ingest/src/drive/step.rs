//! From which change on a voltage makes a step.

use super::levels::{NoLevels, Stretch, change_noise_v, levels};
use crate::drive::policy::{
    ANSWERS_WITHIN, DEPARTURE_OVER_NOISE, LEAST_STEP_NOISE, LEAST_STEP_SHARE, LEAST_STEP_V,
};
use ieap_domain::number::fixed;
use ieap_domain::{Channel, Issue, Quantity, range_of};
use ieap_numerics::robust::sd_on_a_slope;

/// Code of the note on a measured voltage that changes while the current does not answer.
pub const UNANSWERED: &str = "voltage-change-unanswered";

/// Least change of the voltage that counts as a step, V.
pub(super) fn step_threshold(values: &[f64], closed: &[usize], noise_v: f64) -> f64 {
    let (low, high) = range_of(closed.iter().map(|&i| values[i]));
    LEAST_STEP_V
        .max(LEAST_STEP_SHARE * (high - low))
        .max(LEAST_STEP_NOISE * noise_v)
}

/// The levels of a voltage. A change that is small beside the voltage itself is a step where somebody stated it or the current
/// answers it: a voltmeter alone may change its range, and a record that holds one voltage has no larger change to measure by.
pub(super) fn told_levels(
    voltage: &Channel,
    closed: &[usize],
    channels: &[Channel],
) -> Result<(Vec<Stretch>, Option<Issue>), NoLevels> {
    let (time_s, values) = voltage.included();
    let least_v = step_threshold(&values, closed, change_noise_v(&values, closed));
    let fine = levels(&time_s, &values, closed, least_v)?;
    let farthest_v = closed.iter().fold(0.0_f64, |most, &i| most.max(values[i].abs()));
    let small_v = least_v.max(LEAST_STEP_SHARE * farthest_v);
    let unanswered = fine.windows(2).find(|pair| {
        (pair[1].level_v - pair[0].level_v).abs() < small_v && !current_answers(pair[0], pair[1], channels)
    });
    match unanswered {
        Some(pair) if voltage.quantity != Quantity::ControlVoltage => {
            let issue = not_answered(pair[0], pair[1]);
            Ok((levels(&time_s, &values, closed, small_v)?, Some(issue)))
        }
        _ => Ok((fine, None)),
    }
}

/// Whether the current jumps the way the voltage does, beside the change and by more than its noise.
fn current_answers(before: Stretch, after: Stretch, channels: &[Channel]) -> bool {
    let is_current = |quantity: Quantity| channels.iter().find(|channel| channel.is_whole(quantity));
    let Some(current) = is_current(Quantity::Current).or_else(|| is_current(Quantity::CurrentDensity)) else {
        return false;
    };
    let (time_s, values) = current.included();
    let reach_s = ANSWERS_WITHIN * (after.start_s - after.last_before_s);
    let from = time_s.partition_point(|&t| t < after.last_before_s - reach_s);
    let to = time_s.partition_point(|&t| t <= after.start_s + reach_s);
    let direction = (after.level_v - before.level_v).signum();
    let least = DEPARTURE_OVER_NOISE * sd_on_a_slope(&values);
    values[from..to]
        .windows(2)
        .any(|pair| (pair[1] - pair[0]) * direction > least)
}

fn not_answered(before: Stretch, after: Stretch) -> Issue {
    let message = format!(
        "the measured voltage goes from {} V to {} V at {} s and the current does not answer: taken as held",
        fixed(before.level_v, 4),
        fixed(after.level_v, 4),
        fixed(after.start_s, 4)
    );
    Issue::note(UNANSWERED, message)
        .at("column voltage_v")
        .mend("state the drive in a sidecar if it did change")
}
