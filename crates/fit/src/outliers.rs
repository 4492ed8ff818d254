//! Single readings far off their neighbours: a fault of the reading, which no model answers for. Fits and diagnoses leave out
//! the same ones, by this one rule.
//!
//! A reading is off where it stands out of *both* of its neighbours to the same side, far beyond what readings around it
//! differ by. A rise or a fall, however steep, stands out of none; nor does the peak of a course that is sampled so that it is
//! seen. Where it is not, beside an edge of the drive, nothing is judged.

mod policy;
#[cfg(test)]
mod tests;

use std::ops::Range;
use std::sync::Arc;

use ieap_domain::number::to_digits;
use ieap_domain::{Channel, Drive, Issue, Quantity};
use ieap_numerics::robust::sd_around;
use ieap_numerics::sums::peak;

use crate::options::FitInput;

use policy::{BESIDE, FINEST_PART, MOST_TOLD, NEIGHBOURS, OUTLIER_SPREADS};
pub use policy::{FEWEST_FOR_SPREAD, READINGS_AFTER_EDGE, READINGS_BEFORE_EDGE, READINGS_OF_SURROUNDINGS};

/// Channels of a run, their outliers among the excluded readings.
#[derive(Debug, Clone, PartialEq)]
pub struct Cleaned {
    /// All channels in their order.
    pub channels: Vec<Channel>,
    /// Times of the readings that were found off in each, s.
    pub left_out_s: Vec<Vec<f64>>,
}

/// The channels that a fit takes, with readings excluded that stand far off their neighbours; none of what was cleaned before.
///
/// Readings beside edges of `drive` stay, and all of a voltage that moves all the time.
pub fn without_outliers(channels: &[Channel], drive: &Drive) -> Cleaned {
    let moves = drive.moves();
    let clean = |channel: &Channel| {
        if is_fitted(channel) && !moves {
            cleaned(channel, drive)
        } else {
            (channel.clone(), Vec::new())
        }
    };
    let (channels, left_out_s) = channels.iter().map(clean).unzip();
    Cleaned { channels, left_out_s }
}

/// What is said of readings of a channel, by what it is called, that were left out.
pub fn left_out_in_words(name: &str, left_out_s: &[f64]) -> String {
    let times: Vec<String> = left_out_s.iter().take(MOST_TOLD).map(|t| seconds(*t)).collect();
    let more = match left_out_s.len().saturating_sub(MOST_TOLD) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let (readings, verbs) = match left_out_s.len() {
        1 => ("reading", ["stands", "its", "is"]),
        _ => ("readings", ["stand", "their", "are"]),
    };
    format!(
        "{} {readings} of the {name} {} far off {} neighbours and {} left out: {} s{more}",
        left_out_s.len(),
        verbs[0],
        verbs[1],
        verbs[2],
        times.join(", ")
    )
}

impl Cleaned {
    pub(crate) fn of(input: &FitInput) -> Cleaned {
        without_outliers(input.channels, input.drive)
    }

    /// What the run gives to a fit, without them.
    pub(crate) fn input<'a>(&'a self, input: &FitInput<'a>) -> FitInput<'a> {
        FitInput {
            channels: &self.channels,
            ..*input
        }
    }

    /// What a reader of a fit must know of it, of the channels that it takes.
    pub(crate) fn issues(&self, takes: impl Fn(&Channel) -> bool) -> Vec<Issue> {
        let each = self.channels.iter().zip(&self.left_out_s);
        each.filter(|(channel, left_out_s)| !left_out_s.is_empty() && takes(channel))
            .map(|(channel, left_out_s)| {
                let quantity = channel.quantity;
                let words = left_out_in_words(name(quantity), left_out_s);
                let place = match channel.position_mm {
                    Some(mm) => format!("column {}@{mm}", quantity.column()),
                    None => format!("column {}", quantity.column()),
                };
                Issue::note("outliers-left-out", words).at(place)
            })
            .collect()
    }

    /// The same of a fit of the strip as a whole, which takes the first channel of each response.
    pub(crate) fn issues_of_whole(&self) -> Vec<Issue> {
        self.issues(|channel| {
            let first = self
                .channels
                .iter()
                .find(|other| other.quantity == channel.quantity);
            channel.quantity != Quantity::Voltage && first.is_some_and(|first| std::ptr::eq(first, channel))
        })
    }
}

/// What a channel is called in sentences.
fn name(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Current => "current",
        Quantity::Curvature => "curvature",
        _ => "voltage along the strip",
    }
}

/// A time to six digits, s.
fn seconds(time_s: f64) -> String {
    to_digits(time_s, 6).to_string()
}

/// Whether any model is fitted to that channel.
fn is_fitted(channel: &Channel) -> bool {
    match channel.quantity {
        Quantity::Current | Quantity::Curvature => true,
        quantity => quantity == Quantity::Voltage && channel.position_mm.is_some(),
    }
}

/// The channel with its outliers excluded, and when they were read, s.
fn cleaned(channel: &Channel, drive: &Drive) -> (Channel, Vec<f64>) {
    let is_usable = |k: &usize| {
        let finite = channel.values[*k].is_finite() && channel.time_s[*k].is_finite();
        finite && channel.excluded.binary_search(&(*k as u32)).is_err()
    };
    let mut kept: Vec<usize> = (0..channel.len()).filter(is_usable).collect();
    let mut off: Vec<usize> = Vec::new();
    // Without the farthest ones others are seen; in the end there are none.
    loop {
        let time_s: Vec<f64> = kept.iter().map(|&k| channel.time_s[k]).collect();
        let values: Vec<f64> = kept.iter().map(|&k| channel.values[k]).collect();
        let mut found = outliers(&values);
        if !found.is_empty() {
            let edges = beside_edges(&time_s, drive);
            found.retain(|k| !edges.iter().any(|beside| beside.contains(k)));
        }
        if found.is_empty() {
            break;
        }
        off.extend(found.iter().map(|&k| kept[k]));
        let mut places = 0..;
        kept.retain(|_| {
            places
                .next()
                .is_some_and(|place| found.binary_search(&place).is_err())
        });
    }
    if off.is_empty() {
        return (channel.clone(), Vec::new());
    }
    off.sort_unstable();
    let left_out_s = off.iter().map(|&k| channel.time_s[k]).collect();
    let mut excluded: Vec<u32> = off.iter().map(|&k| k as u32).collect();
    excluded.extend(channel.excluded.iter());
    excluded.sort_unstable();
    let excluded = Arc::from(excluded);
    (
        Channel {
            excluded,
            ..channel.clone()
        },
        left_out_s,
    )
}

/// Readings, by place, that are so near to an edge of the drive, or to where it may be, that they may answer to it.
fn beside_edges(time_s: &[f64], drive: &Drive) -> Vec<Range<usize>> {
    let beside = |edge: &ieap_domain::Edge| {
        let before = edge.readings_before(time_s).min(edge.first_behind(time_s));
        before.saturating_sub(READINGS_BEFORE_EDGE)..edge.first_behind(time_s) + READINGS_AFTER_EDGE
    };
    drive
        .segments
        .iter()
        .map(|segment| beside(&segment.edge))
        .collect()
}

/// Places of the values that are far off both of their neighbours.
fn outliers(values: &[f64]) -> Vec<usize> {
    if values.len() < FEWEST_FOR_SPREAD {
        return Vec::new();
    }
    let steps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let sizes: Vec<f64> = steps.iter().map(|step| step.abs()).collect();
    // Values that are rounded, or computed without noise, differ by their last digit or not at all.
    let digit = sizes
        .iter()
        .copied()
        .filter(|size| *size > 0.0)
        .fold(f64::INFINITY, f64::min);
    let finest = digit.max(FINEST_PART * peak(values));
    let spread = sd_around(&steps, READINGS_OF_SURROUNDINGS);
    let is_off = |k: &usize| {
        let (before, after) = (steps[k - 1], -steps[*k]);
        let height = before.abs().min(after.abs());
        let beside = NEIGHBOURS.min(k - 1);
        let around = sizes[k - 1 - beside..k - 1]
            .iter()
            .chain(sizes[k + 1..].iter().take(NEIGHBOURS));
        (before > 0.0) == (after > 0.0)
            && height > OUTLIER_SPREADS * spread[*k].max(finest)
            && height > BESIDE * around.copied().fold(0.0, f64::max)
    };
    (1..values.len() - 1).filter(is_off).collect()
}
