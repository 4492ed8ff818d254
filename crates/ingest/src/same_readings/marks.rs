//! The marks of a record, by which records of the same readings are found without being held against all others.
//!
//! A mark is a hash of a reading and its time, or of three readings in a row, with its numbers rounded: exports of one
//! measurement print different digits. Numbers rounded to three digits are the same in most repeats of a quiet measurement,
//! so that records that print five digits or more have fine marks, too, and two such records are held against each other
//! by these alone.

use std::collections::BTreeSet;

use ieap_domain::{Channel, Quantity};

use super::digits::{Digits, exponent};
use crate::same_readings::policy::{COARSE_DIGITS, FINE_DIGITS, MARKS, TIME_DIGITS};

/// Version of the rule that marks are made by; another one makes stored marks out of date.
pub const VERSION: u32 = 2;

/// Bit of a mark that says that it is of readings in order, and not of a reading at its time.
const BY_ORDER: u64 = 1;
/// Bit of a mark that says that it is fine.
const FINE: u64 = 2;
/// Kinds of marks.
pub(super) const KINDS: usize = 4;

/// The kind of a mark: its two lowest bits.
pub(super) fn kind(mark: u64) -> usize {
    (mark & (BY_ORDER | FINE)) as usize
}

/// Whether marks of a kind are fine.
pub(super) fn is_fine(kind: usize) -> bool {
    kind as u64 & FINE != 0
}

/// The marks of a record: hashes of some of its readings, chosen by their value alone, so that two records of the same
/// readings choose the same. Each stands there once.
pub fn marks(channels: &[Channel]) -> Vec<u64> {
    let mut kept: [BTreeSet<u64>; KINDS] = Default::default();
    for channel in responses(channels) {
        add(channel, COARSE_DIGITS, 0, &mut kept);
        if is_printed_finely(channel) {
            add(channel, FINE_DIGITS, FINE, &mut kept);
        }
    }
    kept.into_iter().flatten().collect()
}

/// The channels whose readings count: what a strip answers.
pub(super) fn responses(channels: &[Channel]) -> impl Iterator<Item = &Channel> {
    channels
        .iter()
        .filter(|channel| channel.is_response() && channel.quantity != Quantity::Other)
}

/// Whether at least half of the readings that are not zero are printed with as many digits as a fine mark has.
fn is_printed_finely(channel: &Channel) -> bool {
    let digits = Digits::of(&channel.values);
    if digits.most < FINE_DIGITS || !digits.step.is_finite() {
        return false;
    }
    let smallest = digits.step * 10f64.powi(FINE_DIGITS - 1) * 0.999;
    let readings = || {
        channel
            .values
            .iter()
            .filter(|value| **value != 0.0 && value.is_finite())
    };
    2 * readings().filter(|value| value.abs() >= smallest).count() >= readings().count()
}

fn add(channel: &Channel, digits: i32, fine: u64, kept: &mut [BTreeSet<u64>; KINDS]) {
    let seed = channel
        .quantity
        .key()
        .bytes()
        .fold(channel.position_mm.map_or(0, f64::to_bits), |seed, byte| {
            mixed(seed ^ u64::from(byte))
        });
    let value = |at: usize| rounded(channel.values[at], digits);
    let mut keep = |hash: u64, bits: u64| {
        let mark = hash & !(BY_ORDER | FINE) | bits;
        smallest(&mut kept[kind(mark)], mark);
    };
    for at in (0..channel.len()).filter(|&at| channel.values[at] != 0.0 && channel.values[at].is_finite()) {
        let time = rounded(channel.time_s[at], TIME_DIGITS);
        keep(mixed(mixed(seed ^ time) ^ value(at)), fine);
        let follows = at + 2 < channel.len();
        if follows && value(at) != value(at + 1) {
            let order = (0..3).fold(seed, |hash, step| mixed(hash ^ value(at + step)));
            keep(order, fine | BY_ORDER);
        }
    }
}

/// Keeps the smallest hashes.
fn smallest(marks: &mut BTreeSet<u64>, mark: u64) {
    if marks.len() < MARKS || marks.last().is_some_and(|last| mark < *last) {
        marks.insert(mark);
        if marks.len() > MARKS {
            marks.pop_last();
        }
    }
}

/// A hash in which every bit counts (splitmix64).
pub(super) fn mixed(mut state: u64) -> u64 {
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
    let (mantissa, decade) = if mantissa.abs() >= 10f64.powi(digits) {
        (mantissa / 10.0, decade + 1)
    } else {
        (mantissa, decade)
    };
    (mantissa as i64)
        .cast_unsigned()
        .wrapping_mul(4096)
        .wrapping_add(i64::from(decade).cast_unsigned())
}
