//! Bending that another instrument timed: its clock is off from that of the voltage by a time that nobody stated.
//!
//! The onset of the bending and its course tell that time, given the circuit that the current tells. The readings are moved by
//! it, and what is left open of it stands in the intervals.

use std::sync::Arc;

use ieap_domain::number::fixed;
use ieap_domain::quantiles::{CHI_SQUARE_95_OF_ONE, NORMAL_95};
use ieap_domain::{Channel, Drive, Fit, Issue, Quantity};
use ieap_numerics::robust::median_step;
use ieap_numerics::sums;

use crate::bending;
use crate::line::Line;
use crate::options::{FitInput, FitOptions};
use crate::outliers::Cleaned;
use crate::policy::LARGEST_OFFSET_S;
use crate::sampled::Sampled;
use crate::search::Search;
use crate::settled_edges::settled;
use crate::two_steps::{Readings, identify};
use crate::widened::{End, Values, values, widen_by};

/// Channels on one clock.
#[derive(Debug, Clone)]
pub struct Aligned {
    /// The channels with the bending moved to the clock of the voltage.
    pub channels: Vec<Channel>,
    /// The drive with its edges where the current has them.
    drive: Drive,
    /// How long the time is in which the first edge may be, s: both where it is and where it is taken to be lie anywhere in it.
    edge_error_s: f64,
    /// How far its own clock was ahead of that, s: the best value and the ends of its 95 % interval.
    pub ahead_s: [f64; 3],
}

impl Aligned {
    /// Standard error of the offset against the drive, s: that of its own, and of where the edges are that it counts from.
    pub fn error_s(&self) -> f64 {
        ((self.ahead_s[2] - self.ahead_s[1]) / (2.0 * NORMAL_95)).hypot(self.edge_error_s)
    }

    /// What a reader must know of it.
    pub(crate) fn issue(&self) -> Issue {
        let [best, low, high] = self.ahead_s;
        let words = format!(
            "the bending has a clock of its own, which shows {} s [{}, {}] more than that of the current; its \
             readings are moved by that, and what is left open of it is in the intervals",
            fixed(best, 3),
            fixed(low, 3),
            fixed(high, 3)
        );
        if high >= 0.0 {
            return Issue::note("bending-clock", words);
        }
        Issue::warning(
            "bending-clock",
            format!("the bending seems to move before the current: {words}"),
        )
        .mend("where both clocks are known to agree, or to differ by a known time, state clock_offset_s")
    }
}

/// The channels of a run whose bending has a clock of its own, on one clock; none where there is no such bending, or nothing
/// tells the offset.
pub fn aligned(input: &FitInput, options: &FitOptions) -> Option<Aligned> {
    let is_bending = |channel: &&Channel| channel.quantity == Quantity::Curvature;
    let is_own = |channel: &Channel| channel.own_clock && !channel.is_empty();
    if !input.channels.iter().find(is_bending).is_some_and(is_own) || input.drive.moves() {
        return None;
    }
    let cleaned = Cleaned::of(input);
    let input = &cleaned.input(input);
    let bending = input.channels.iter().find(is_bending)?;
    let edges = settled(input, options).ok()?.edges;
    let placed = FitInput {
        drive: edges.drive(),
        ..*input
    };
    let (_, electrical) = identify(&placed, options, Readings::new(&placed).ok()?)
        .current
        .ok()?;
    if electrical.conductances_a_per_v.is_empty() {
        return None;
    }
    let bent = |ahead_s: f64| {
        let drive = edges.drive().later(ahead_s);
        let sampled = Sampled::new(bending, &drive, true);
        let found = bending::identify(&drive, &electrical, &sampled, Search::default());
        (
            found.residuals.square,
            found.residuals.long_run_variance(sums::peak(&sampled.values)),
        )
    };
    let every_s = median_step(&bending.time_s)?;
    let most_s = LARGEST_OFFSET_S.min(0.5 * (bending.time_s.last()? - bending.time_s.first()?));
    let doubled = (-1..)
        .map(|k| every_s * 2_f64.powi(k))
        .take_while(|by_s| *by_s < most_s);
    let away: Vec<f64> = doubled.chain([most_s]).collect();
    let tried: Vec<f64> = (away.iter().rev().map(|by_s| -by_s))
        .chain([0.0])
        .chain(away.iter().copied())
        .collect();
    let line = Line::of(
        &tried,
        |by_s| bent(by_s).0,
        |by_s| CHI_SQUARE_95_OF_ONE * bent(by_s).1,
    )?;
    Some(Aligned {
        channels: moved(input.channels, -line.best),
        drive: edges.drive().clone(),
        edge_error_s: input.drive.segments[0].edge.open_s(),
        ahead_s: [line.best, line.low, line.high],
    })
}

/// Widens the intervals of a fit of aligned channels by what is left open of the offset, and says what it is; `plain` fits the
/// run, whose channels are as they were in `input`, in the simplest way.
pub(crate) fn widen(
    fit: &mut Fit,
    input: &FitInput,
    aligned: &Aligned,
    plain: impl Fn(&FitInput) -> Option<Fit>,
) {
    let with = |ahead_s: f64| {
        let channels = moved(input.channels, -ahead_s);
        let fitted = plain(&FitInput {
            channels: &channels,
            drive: &aligned.drive,
            ..*input
        });
        fitted.map_or_else(Values::new, |fitted| values(&fitted.parameters))
    };
    let [here, low, high] = aligned.ahead_s.map(with);
    let end = |there| Some(End { part: 1.0, there });
    widen_by(&mut fit.parameters, &here, &[[end(low), end(high)]]);
    fit.issues.push(aligned.issue());
}

/// The channels with the bending later, s.
pub(crate) fn moved(channels: &[Channel], by_s: f64) -> Vec<Channel> {
    let mut moved = channels.to_vec();
    for channel in moved
        .iter_mut()
        .filter(|channel| channel.quantity == Quantity::Curvature && channel.own_clock)
    {
        channel.time_s = channel.time_s.iter().map(|t| t + by_s).collect::<Arc<[f64]>>();
    }
    moved
}
