//! Edges of the current where the stated drive has none: the strip probably saw another voltage than was stated.

use crate::drive::policy::{
    ANSWERS_WITHIN, AT_REST_BELOW, BESIDE_EDGE, DEPARTURE_OVER_NOISE, EDGE_LONGEST_STEP, EDGE_OF_RANGE,
    EDGE_OVER_BESIDE, EDGE_OVER_NOISE, EDGE_STAYS, FEWEST_AT_REST,
};
use ieap_domain::number::fixed;
use ieap_domain::range_of;
use ieap_domain::{Channel, Drive, Edge, Issue, Quantity};
use ieap_numerics::robust::{sd_on_a_slope, upper_median};

/// Version of what counts as such an edge: raised when the same readings would give another.
pub const VERSION: u32 = 1;

/// Time and height of an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Jump {
    time_s: f64,
    ampere: f64,
}

/// The largest change between two neighbouring readings of a current that was at rest before.
///
/// # Errors
/// It was not at rest, or shows no jump.
pub fn from_rest(current: &Channel) -> Result<Edge, String> {
    let (time_s, values) = current.included();
    let changes: Vec<f64> = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    let largest = (0..changes.len()).max_by(|&a, &b| changes[a].total_cmp(&changes[b]));
    let at = largest
        .filter(|&at| at + 1 >= FEWEST_AT_REST)
        .ok_or("the current is not at rest before its first jump")?;
    let (low, high) = range_of(values[..=at].iter().copied());
    let noise = sd_on_a_slope(&values);
    if high - low > (AT_REST_BELOW * changes[at]).max(2.0 * DEPARTURE_OVER_NOISE * noise) {
        return Err("the current is not at rest before its first jump".to_owned());
    }
    if changes[at] <= DEPARTURE_OVER_NOISE * noise || changes[at] == 0.0 {
        return Err("the current shows no jump".to_owned());
    }
    Ok(Edge::between(time_s[at], time_s[at + 1]))
}

/// Points out jumps of the current that no edge of the drive explains.
pub fn unexplained(channels: &[Channel], drive: &Drive) -> Option<Issue> {
    let current = channels
        .iter()
        .find(|channel| channel.is_whole(Quantity::Current))?;
    let (time_s, values) = current.included();
    let edges: Vec<f64> = drive.segments.iter().map(|segment| segment.start_s()).collect();
    let jumps = jumps(&time_s, &values, &edges);
    let first = *jumps.first()?;
    let largest = jumps.iter().fold(first, |most, next| {
        if next.ampere.abs() > most.ampere.abs() {
            *next
        } else {
            most
        }
    });
    let times = match jumps.len() {
        1 => format!(
            "jumps by {} mA at {} s",
            fixed(1e3 * largest.ampere, 4),
            first.time_s
        ),
        many => format!(
            "jumps {many} times by up to {} mA, first at {} s",
            fixed(1e3 * largest.ampere.abs(), 4),
            first.time_s
        ),
    };
    let message = format!(
        "the current {times} where the stated voltage has no edge: the strip probably did not see the stated drive"
    );
    Some(
        Issue::warning("current-jumps", message)
            .at(format!("column {}", current.raw_name))
            .mend(
                "record the voltage across the strip, or mend the drive that is stated; the tag leave_out takes a stretch \
                 out of fits",
            ),
    )
}

fn jumps(time_s: &[f64], values: &[f64], edges: &[f64]) -> Vec<Jump> {
    let changes: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let (low, high) = range_of(values.iter().copied());
    let least = EDGE_OF_RANGE * (high - low);
    let is_jump = |&k: &usize| {
        let height = changes[k];
        let beyond = (values[k + 2] - values[k]) / height;
        let (before, after) = (&changes[k - BESIDE_EDGE..k], &changes[k + 1..=k + BESIDE_EDGE]);
        let before_it = before.iter().fold(0.0_f64, |most, change| most.max(change.abs()));
        let along_it = |most: f64, change: &f64| most.max(change * height.signum());
        let after_it = after.iter().fold(0.0_f64, along_it);
        let answers = ANSWERS_WITHIN * (time_s[k + 1] - time_s[k]);
        let is_pause = time_s[k + 1] - time_s[k] > EDGE_LONGEST_STEP * (time_s[k] - time_s[k - 1]);
        let near = |edge: &f64| (time_s[k] - answers..=time_s[k + 1] + answers).contains(edge);
        height.abs() > least
            && !is_pause
            && beyond > EDGE_STAYS
            && height.abs() > EDGE_OVER_BESIDE * before_it.max(after_it)
            && height.abs() > EDGE_OVER_NOISE * median_size(before)
            && !edges.iter().any(near)
    };
    (BESIDE_EDGE..changes.len().saturating_sub(BESIDE_EDGE))
        .filter(|&k| changes[k].abs() > least)
        .filter(is_jump)
        .map(|k| Jump {
            time_s: time_s[k + 1],
            ampere: changes[k],
        })
        .collect()
}

fn median_size(changes: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = changes.iter().map(|change| change.abs()).collect();
    upper_median(&mut sizes).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use ieap_domain::{Level, Segment};

    fn step_at(start_s: f64) -> Drive {
        Drive {
            baseline_v: 0.0,
            segments: vec![Segment::at(start_s, Level::Voltage(2.0))],
        }
    }

    /// Noise of standard deviation about 1, the same each time.
    fn noise(k: usize) -> f64 {
        let hash = |k: usize| ((k.wrapping_mul(2_654_435_761) >> 7) % 1000) as f64 / 1000.0 - 0.5;
        2.0 * (hash(k) + hash(k + 7919) + hash(k + 104_729))
    }

    fn found(current_a: impl Fn(usize, f64) -> f64, drive: &Drive) -> Option<Issue> {
        let time_s: Arc<[f64]> = (0..400).map(|k| k as f64 * 0.5 - 10.0).collect();
        let values = time_s.iter().enumerate().map(|(k, &t)| current_a(k, t)).collect();
        unexplained(&[Channel::new(Quantity::Current, time_s, values)], drive)
    }

    /// A charging current of two time constants after a step at `from_s`.
    fn charging(t: f64, from_s: f64, height_a: f64) -> f64 {
        let since = t - from_s;
        if since < 0.0 {
            return 0.0;
        }
        height_a * (0.7 * (-since / 0.8).exp() + 0.2 * (-since / 30.0).exp() + 0.1)
    }

    #[test]
    fn the_answer_to_a_stated_step_is_no_jump() {
        for start_s in [0.0, 7.3, 50.0] {
            for noise_a in [0.0, 1e-6, 1e-4, 3e-3] {
                let current = |k: usize, t: f64| charging(t, start_s, 0.1) + noise_a * noise(k);
                assert_eq!(
                    found(current, &step_at(start_s)),
                    None,
                    "{start_s} s, {noise_a} A"
                );
            }
        }
    }

    #[test]
    fn noise_and_readings_that_go_astray_are_no_jumps() {
        assert_eq!(found(|k, _| 1e-3 + 1e-4 * noise(k), &step_at(0.0)), None);
        let astray = |k: usize, _: f64| if k == 200 { 0.11 } else { 1e-3 + 1e-5 * noise(k) };
        assert_eq!(found(astray, &step_at(0.0)), None);
        assert_eq!(found(|_, _| 0.0, &step_at(0.0)), None);
    }

    #[test]
    fn a_pause_of_the_record_is_no_edge() {
        let time_s: Arc<[f64]> = (0..60)
            .map(|k| if k < 30 { k as f64 * 0.1 } else { 3600.0 + k as f64 })
            .collect();
        let values = time_s.iter().map(|t| 0.1 * (-t / 900.0).exp()).collect();
        let current = Channel::new(Quantity::Current, time_s, values);
        assert_eq!(unexplained(&[current], &step_at(-1.0)), None);
    }

    #[test]
    fn an_edge_without_a_cause_is_told() {
        let twice = |k: usize, t: f64| {
            charging(t, 0.0, 0.1) + charging(t, 60.0, 0.11) - charging(t, 120.0, 0.11) + 1e-5 * noise(k)
        };
        let issue = found(twice, &step_at(0.0)).unwrap();
        assert_eq!(issue.code, "current-jumps");
        assert!(
            issue.message.contains("jumps 2 times by up to 11") && issue.message.contains("first at 60 s"),
            "{issue:?}"
        );
        let once = |k: usize, t: f64| charging(t, 40.0, 0.11) + 1e-5 * noise(k);
        assert!(found(once, &step_at(-10.0)).unwrap().message.contains("at 40 s"));
    }
}
