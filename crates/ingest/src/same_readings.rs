//! Whether two records hold the same readings: one measurement that was exported twice, in another format or with fewer
//! digits, or a part of it.
//!
//! Bytes and even numbers differ between exports: of delimiters, units and rounding. Numbers are held against each other
//! within the last digit that either export prints.

mod alike;

use std::collections::BTreeSet;

use ieap_domain::{Channel, Quantity};

pub use alike::Alike;

/// Version of the rule that marks are made by; another one makes stored marks out of date.
pub const VERSION: u32 = 1;
/// Marks of each of the two kinds: a part that holds a tenth of a record shares about six of them with it.
const MARKS: usize = 64;
/// Marks of one kind that two records must share to be looked at.
const SHARED: usize = 3;
/// Digits of values that go into a mark: no export prints fewer. Those of times go on in step with the rows.
const VALUE_DIGITS: i32 = 3;
const TIME_DIGITS: i32 = 4;
/// Most digits of a number that are not the noise of a conversion.
const MOST_DIGITS: i32 = 12;
/// Numbers that the digits of a channel are told from.
const LOOKED_AT: usize = 2000;
/// Readings that must step by more than the printed digits: a record that rests, or is printed with two digits, is like
/// many others.
const TELLING: usize = 8;
/// Readings of a part by which its place in the whole is found.
const ANCHOR: usize = 3;
/// Places that are tried.
const PLACES: usize = 16;

/// The marks of a record: hashes of some of its readings, chosen by their value alone, so that two records of the same
/// readings choose the same. Those of the two kinds differ in their lowest bit.
pub fn marks(channels: &[Channel]) -> Vec<u64> {
    let (mut by_time, mut by_order) = (BTreeSet::new(), BTreeSet::new());
    for channel in responses(channels) {
        let seed = channel
            .quantity
            .key()
            .bytes()
            .fold(channel.position_mm.map_or(0, f64::to_bits), |seed, byte| {
                mixed(seed ^ u64::from(byte))
            });
        let value = |at: usize| rounded(channel.values[at], VALUE_DIGITS);
        for at in (0..channel.len()).filter(|&at| channel.values[at] != 0.0 && channel.values[at].is_finite())
        {
            let time = rounded(channel.time_s[at], TIME_DIGITS);
            keep(&mut by_time, mixed(mixed(seed ^ time) ^ value(at)) & !1);
            let follows = at + 2 < channel.len();
            if follows && value(at) != value(at + 1) {
                let order = (0..3).fold(seed, |hash, step| mixed(hash ^ value(at + step)));
                keep(&mut by_order, order | 1);
            }
        }
    }
    by_time.into_iter().chain(by_order).collect()
}

/// Keeps the smallest hashes.
fn keep(marks: &mut BTreeSet<u64>, mark: u64) {
    if marks.len() < MARKS || marks.last().is_some_and(|last| mark < *last) {
        marks.insert(mark);
        if marks.len() > MARKS {
            marks.pop_last();
        }
    }
}

/// A hash in which every bit counts (splitmix64).
fn mixed(mut state: u64) -> u64 {
    state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    state = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    state = (state ^ (state >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    state ^ (state >> 31)
}

/// The number to so many digits, as one.
fn rounded(value: f64, digits: i32) -> u64 {
    if value == 0.0 || !value.is_finite() {
        return 0;
    }
    let decade = exponent(value);
    // What rounds up to the next decade is its first number.
    let mantissa = (value * 10f64.powi(digits - 1 - decade)).round();
    let (mantissa, decade) = match mantissa.abs() >= 10f64.powi(digits) {
        true => (mantissa / 10.0, decade + 1),
        false => (mantissa, decade),
    };
    (mantissa as i64)
        .cast_unsigned()
        .wrapping_mul(4096)
        .wrapping_add(i64::from(decade).cast_unsigned())
}

fn exponent(value: f64) -> i32 {
    value.abs().log10().floor() as i32
}

/// Whether every response of `part` stands in `whole` too, at the same times or all later or earlier by the same time.
pub fn stands_in(part: &[Channel], whole: &[Channel]) -> bool {
    let mut any = false;
    for channel in responses(part) {
        let same =
            |other: &&Channel| other.quantity == channel.quantity && other.position_mm == channel.position_mm;
        let Some(other) = responses(whole).find(same) else {
            return false;
        };
        if !channel_stands_in(channel, other) {
            return false;
        }
        any = true;
    }
    any
}

fn responses(channels: &[Channel]) -> impl Iterator<Item = &Channel> {
    channels
        .iter()
        .filter(|channel| channel.is_response() && channel.quantity != Quantity::Other)
}

fn channel_stands_in(part: &Channel, whole: &Channel) -> bool {
    if part.len() > whole.len() {
        return false;
    }
    let values = Digits::of(&part.values).coarser(Digits::of(&whole.values));
    let times = Digits::of(&part.time_s).coarser(Digits::of(&whole.time_s));
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
        .take(TELLING)
        .count()
        == TELLING
}

/// Times by which the part may be later than the whole, s: from where the whole begins as the part does.
fn shifts(part: &Channel, whole: &Channel, digits: Digits) -> Vec<f64> {
    // Readings at rest are like each other; the first that steps is a place to look for.
    let first = (0..part.len().saturating_sub(ANCHOR))
        .find(|&at| !digits.are_equal(part.values[at], part.values[at + 1]))
        .unwrap_or(0);
    let anchor = &part.values[first..(first + ANCHOR).min(part.len())];
    let windows = whole.values.windows(anchor.len().max(1)).enumerate();
    windows
        .filter(|(_, window)| {
            window
                .iter()
                .zip(anchor)
                .all(|(&one, &other)| digits.are_equal(one, other))
        })
        .map(|(place, _)| part.time_s[first] - whole.time_s[place])
        .take(PLACES)
        .collect()
}

/// How finely numbers are printed: by a step that all have, by a number of digits, or both.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Digits {
    step: f64,
    most: i32,
}

impl Digits {
    fn of(values: &[f64]) -> Digits {
        let every = values.len().div_ceil(LOOKED_AT).max(1);
        let mut digits = Digits {
            step: f64::INFINITY,
            most: 1,
        };
        for value in values
            .iter()
            .step_by(every)
            .filter(|value| **value != 0.0 && value.is_finite())
        {
            let printed = format!("{value:.*e}", MOST_DIGITS as usize - 1);
            let (mantissa, decade) = printed.split_once('e').unwrap_or((&printed, "0"));
            let shown = mantissa
                .trim_start_matches('-')
                .trim_end_matches('0')
                .trim_end_matches('.');
            let count = shown.chars().filter(char::is_ascii_digit).count() as i32;
            let decade: i32 = decade.parse().unwrap_or(0);
            digits.most = digits.most.max(count);
            digits.step = digits.step.min(10f64.powi(decade - count + 1));
        }
        digits
    }

    fn coarser(self, other: Digits) -> Digits {
        Digits {
            step: self.step.max(other.step),
            most: self.most.min(other.most),
        }
    }

    /// What the last printed digit of a number stands for: exports round or cut off.
    fn last(self, value: f64) -> f64 {
        let own = match value == 0.0 {
            true => 0.0,
            false => 10f64.powi(exponent(value) - self.most + 1),
        };
        let step = if self.step.is_finite() { self.step } else { 0.0 };
        1.001 * step.max(own)
    }

    fn are_equal(self, one: f64, other: f64) -> bool {
        (one - other).abs() <= self.last(one).max(self.last(other))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::sync::Arc;

    use super::*;

    /// Whether their marks lead from one record to another.
    fn may_be_same(one: &[u64], other: &[u64]) -> bool {
        let all = BTreeMap::from([(1, one.to_vec()), (2, other.to_vec())]);
        !Alike::of(&all).to(1, one).is_empty()
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
