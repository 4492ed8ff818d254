//! Noise that grows from run to run with the voltage, as bubbles at an electrode give.

use ieap_domain::number::significant;
use ieap_domain::{Channel, Drive};
use ieap_numerics::robust::sd_on_a_slope;

use crate::readings::group::{QUANTITIES, RunGroup, channel_name};
use crate::readings::policy::{FEWEST_FOR_LOUDER, FEWEST_FOR_NOISE, LOUDER_FACTOR, LOUDER_SIGMAS};

/// A sentence for every channel whose noise rises with the voltage over the runs.
pub(crate) fn remarks(group: &RunGroup) -> Vec<String> {
    (0..2).filter_map(|channel| remark(group, channel)).collect()
}

fn remark(group: &RunGroup, channel: usize) -> Option<String> {
    let mut found: Vec<(f64, f64)> = Vec::new();
    for run in &group.runs {
        let drive = run.drive();
        let own = run.given.input.channels.iter();
        let mut of_quantity = own.filter(|own| own.is_whole(QUANTITIES[channel]));
        let noise = of_quantity.next().and_then(|own| fast_noise(own, drive));
        found.extend(noise.map(|noise| (drive.nominal_step_v(), noise)));
    }
    found.sort_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
    let (quiet, loud) = (found.first()?, found.last()?);
    let are_enough = found.len() >= FEWEST_FOR_LOUDER;
    (are_enough && loud.1 > LOUDER_FACTOR * quiet.1 && kendall(&found) > LOUDER_SIGMAS).then(|| {
        format!(
            "the noise of the {} grows with the voltage: from {} {unit} at {} V to {} {unit} at {} V; bubbles at an \
             electrode do that, and an instrument that changes to a coarser range",
            channel_name(channel),
            significant(quiet.1, 2),
            quiet.0,
            significant(loud.1, 2),
            loud.0,
            unit = QUANTITIES[channel].unit()
        )
    })
}

/// Standard deviation of what differs from one reading to the next in the last half of a run, where little else changes:
/// the middle of the second differences, so that a few jumps count nothing.
fn fast_noise(channel: &Channel, drive: &Drive) -> Option<f64> {
    let (time_s, values) = channel.included();
    let last_edge_s = drive.edges_s().last().copied().unwrap_or(0.0);
    let end_s = *time_s.last()?;
    let first = time_s.partition_point(|t| *t < 0.5 * (last_edge_s + end_s));
    let late = values
        .get(first..)
        .filter(|late| late.len() >= FEWEST_FOR_NOISE)?;
    let sd = sd_on_a_slope(late);
    (sd > 0.0).then_some(sd)
}

/// Kendall's count of pairs in order less pairs out of order, in its standard deviations; pairs are (voltage, noise).
fn kendall(found: &[(f64, f64)]) -> f64 {
    let n = found.len() as f64;
    let mut count = 0.0;
    for (k, a) in found.iter().enumerate() {
        for b in &found[k + 1..] {
            let order = (b.0.abs() - a.0.abs()) * (b.1 - a.1);
            count += if order > 0.0 {
                1.0
            } else if order < 0.0 {
                -1.0
            } else {
                0.0
            };
        }
    }
    count / (n * (n - 1.0) * (2.0 * n + 5.0) / 18.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_counts_in_standard_deviations_of_chance() {
        let rising: Vec<(f64, f64)> = (0..8).map(|k| (-0.1 * f64::from(k), f64::from(k + 1))).collect();
        let falling: Vec<(f64, f64)> = rising.iter().map(|(v, s)| (*v, -s)).collect();
        // 28 pairs over sqrt(8 * 7 * 21 / 18).
        assert!((kendall(&rising) - 28.0 / 65.333_333_f64.sqrt()).abs() < 1e-6);
        assert_eq!(kendall(&rising), -kendall(&falling));
    }
}
