//! Whether two records hold the same readings: one measurement that was exported twice, in another format or with fewer
//! digits, or a part of it.
//!
//! Bytes and even numbers differ between exports: of delimiters, units and rounding. Numbers are held against each other
//! within the last digit that either export prints.

mod alike;
mod digits;
mod marks;
mod policy;

use crate::same_readings::policy::{ANCHOR_READINGS, FEWEST_TELLING, MOST_PLACES};
use ieap_domain::Channel;

pub use alike::Alike;
pub use marks::{VERSION, marks};

use digits::Digits;
use marks::responses;

/// The responses of a record, made ready to be held against those of others.
#[derive(Debug)]
pub struct Record {
    responses: Vec<Response>,
}

/// A response with how finely its values and its times are printed.
#[derive(Debug)]
struct Response {
    channel: Channel,
    values: Digits,
    times: Digits,
}

impl Record {
    /// Of the channels of a run.
    pub fn of(channels: &[Channel]) -> Record {
        let response = |channel: &Channel| Response {
            channel: channel.clone(),
            values: Digits::of(&channel.values),
            times: Digits::of(&channel.time_s),
        };
        Record {
            responses: responses(channels).map(response).collect(),
        }
    }

    /// Number of its readings.
    pub fn len(&self) -> usize {
        self.responses.iter().map(|response| response.channel.len()).sum()
    }

    /// Whether it has none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether every response of this record stands in `whole` too, at the same times or all later or earlier by the same
    /// time.
    pub fn stands_in(&self, whole: &Record) -> bool {
        let stands = |part: &Response| {
            let (quantity, position_mm) = (part.channel.quantity, part.channel.position_mm);
            let mut others = whole.responses.iter();
            let other = others
                .find(|other| other.channel.quantity == quantity && other.channel.position_mm == position_mm);
            other.is_some_and(|other| channel_stands_in(part, other))
        };
        !self.responses.is_empty() && self.responses.iter().all(stands)
    }
}

fn channel_stands_in(part: &Response, whole: &Response) -> bool {
    let values = part.values.coarser(whole.values);
    let times = part.times.coarser(whole.times);
    let (part, whole) = (&part.channel, &whole.channel);
    if part.len() > whole.len() {
        return false;
    }
    let is_equal = |shift_s: f64| {
        let mut from = 0;
        (0..part.len()).all(|at| {
            let time_s = part.time_s[at] - shift_s;
            let off_s = times.last(part.time_s[at]).max(times.last(time_s));
            while from < whole.len() && whole.time_s[from] < time_s - off_s {
                from += 1;
            }
            let near = (from..whole.len()).take_while(|&place| whole.time_s[place] <= time_s + off_s);
            let mut near = near.filter(|&place| values.are_equal(part.values[at], whole.values[place]));
            near.next().is_some()
        })
    };
    if !tells(part, values) {
        let exactly = |one: f64, other: f64| (one - other).abs() <= 1e-9 * one.abs().max(other.abs());
        let pairs = part.values.iter().zip(whole.values.iter());
        return part.len() == whole.len()
            && pairs.into_iter().all(|(&one, &other)| exactly(one, other))
            && is_equal(0.0);
    }
    is_equal(0.0) || shifts(part, whole, values).into_iter().any(is_equal)
}

/// Whether its readings step so often by more than the printed digits that no other record has them by chance.
fn tells(channel: &Channel, digits: Digits) -> bool {
    let steps = channel.values.windows(2);
    steps
        .filter(|pair| !digits.are_equal(pair[0], pair[1]))
        .take(FEWEST_TELLING)
        .count()
        == FEWEST_TELLING
}

/// Times by which the part may be later than the whole, s: from where the whole begins as the part does.
fn shifts(part: &Channel, whole: &Channel, digits: Digits) -> Vec<f64> {
    // Readings at rest are like each other; the first that steps is a place to look for.
    let first = (0..part.len().saturating_sub(ANCHOR_READINGS))
        .find(|&at| !digits.are_equal(part.values[at], part.values[at + 1]))
        .unwrap_or(0);
    let anchor = &part.values[first..(first + ANCHOR_READINGS).min(part.len())];
    let windows = whole.values.windows(anchor.len().max(1)).enumerate();
    windows
        .filter(|(_, window)| {
            window
                .iter()
                .zip(anchor)
                .all(|(&one, &other)| digits.are_equal(one, other))
        })
        .map(|(place, _)| part.time_s[first] - whole.time_s[place])
        .take(MOST_PLACES)
        .collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::sync::Arc;

    use super::*;
    use ieap_domain::Quantity;

    fn stands_in(part: &[Channel], whole: &[Channel]) -> bool {
        Record::of(part).stands_in(&Record::of(whole))
    }

    /// Whether their marks lead from one record to another.
    fn may_be_same(one: &[u64], other: &[u64]) -> bool {
        let all = BTreeMap::from([(1, one.to_vec()), (2, other.to_vec())]);
        !Alike::of(&all).to(1, one).is_empty()
    }

    /// A hash in which every bit counts (splitmix64).
    fn mixed(state: u64) -> u64 {
        marks::mixed(state)
    }

    /// A decaying current with noise of its own, as exported with so many digits, in a unit, from a row, every so many rows.
    fn record(
        seed: u64,
        digits: usize,
        unit: f64,
        rows: std::ops::Range<usize>,
        every: usize,
        shift_s: f64,
    ) -> Vec<Channel> {
        let mut state = seed;
        let all: Vec<(f64, f64)> = (0..400)
            .map(|row| {
                state = mixed(state);
                let noise = (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
                let time_s = 0.5 * f64::from(row);
                (time_s, 1e-3 * (-time_s / 40.0).exp() + 2e-5 * noise)
            })
            .collect();
        let printed = |value: f64| -> f64 {
            let text = format!("{:.*e}", digits - 1, value / unit);
            text.parse::<f64>().unwrap() * unit
        };
        let picked: Vec<&(f64, f64)> = all[rows].iter().step_by(every).collect();
        let times: Vec<f64> = picked.iter().map(|(time_s, _)| time_s + shift_s).collect();
        let values: Vec<f64> = picked.iter().map(|(_, value)| printed(*value)).collect();
        vec![Channel::new(
            Quantity::Current,
            Arc::from(times),
            Arc::from(values),
        )]
    }

    fn full(seed: u64) -> Vec<Channel> {
        record(seed, 7, 1.0, 0..400, 1, 0.0)
    }

    #[test]
    fn exports_of_one_measurement_are_the_same_and_parts_stand_in_it() {
        let whole = full(1);
        for other in [
            record(1, 7, 1e-3, 0..400, 1, 0.0),
            record(1, 4, 1e-6, 0..400, 1, 0.0),
            record(1, 7, 1.0, 0..400, 1, -30.0),
        ] {
            assert!(may_be_same(&marks(&other), &marks(&whole)));
            assert!(stands_in(&other, &whole) && stands_in(&whole, &other));
        }
        for part in [
            record(1, 7, 1.0, 0..250, 1, 0.0),
            record(1, 5, 1e-3, 100..300, 1, -50.0),
            record(1, 7, 1.0, 0..400, 5, 0.0),
        ] {
            assert!(may_be_same(&marks(&part), &marks(&whole)));
            assert!(stands_in(&part, &whole) && !stands_in(&whole, &part));
        }
    }

    #[test]
    fn repeats_are_measurements_of_their_own() {
        for digits in [3, 7] {
            let (one, other) = (
                record(1, digits, 1.0, 0..400, 1, 0.0),
                record(2, digits, 1.0, 0..400, 1, 0.0),
            );
            assert!(!stands_in(&one, &other) && !stands_in(&other, &one));
        }
        // A response that the other lacks makes it more.
        let mut both = full(1);
        let mut bending = full(3).remove(0);
        bending.quantity = Quantity::Curvature;
        both.push(bending);
        assert!(stands_in(&full(1), &both) && !stands_in(&both, &full(1)));
    }

    #[test]
    fn what_many_records_have_in_common_makes_none_the_same() {
        let flat = |value: f64| {
            let times: Vec<f64> = (0..50).map(f64::from).collect();
            vec![Channel::new(
                Quantity::Current,
                Arc::from(times),
                Arc::from(vec![value; 50]),
            )]
        };
        assert!(!stands_in(&flat(1.0), &flat(1.2)));
        assert!(stands_in(&flat(1.0), &flat(1.0)));
        let mut shorter = flat(1.0);
        shorter[0] = Channel::new(Quantity::Current, Arc::from([0.0, 1.0]), Arc::from([1.0, 1.0]));
        assert!(!stands_in(&shorter, &flat(1.0)));
        assert!(marks(&[]).is_empty() && !may_be_same(&[], &marks(&full(1))) && !stands_in(&[], &full(1)));
    }
}
