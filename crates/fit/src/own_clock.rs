//! Bending that another instrument timed: its clock is off from that of the voltage by a time that nobody stated.
//!
//! The onset of the bending and its course tell that time, given the circuit that the current tells. The readings are moved by
//! it, and what is left open of it stands in the intervals.

use std::sync::Arc;

use ieap_domain::number::fixed;
use ieap_domain::quantiles::{CHI_SQUARE_95_OF_ONE, NORMAL_95};
use ieap_domain::{Channel, Drive, Fit, Issue, Nuisance, Quantity};
use ieap_numerics::line::Line;
use ieap_numerics::robust::median_step;
use ieap_numerics::sums;

use crate::bending;
use crate::electrical::Electrical;
use crate::nuisances;
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
    /// How far the offset goes with what is left open of the edges, one standard deviation, s.
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
        let [best, half] = [self.ahead_s[0], NORMAL_95 * self.error_s()];
        let (low, high) = (best - half, best + half);
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

/// The channels of a run whose bending has a clock of its own, on one clock; none where there is no such bending.
///
/// # Errors
/// What a reader must know where nothing tells the offset: the bending is then fitted on its own clock.
pub fn aligned(input: &FitInput, options: &FitOptions) -> Result<Option<Aligned>, Issue> {
    let is_bending = |channel: &&Channel| channel.quantity == Quantity::Curvature;
    let is_own = |channel: &Channel| channel.own_clock && !channel.is_empty();
    if !input.channels.iter().find(is_bending).is_some_and(is_own) {
        return Ok(None);
    }
    let cleaned = Cleaned::of(input);
    let input = &cleaned.input(input);
    let bending = input.channels.iter().find(is_bending);
    let offset = bending.map(|bending| against_current(input, options, bending));
    offset.transpose().map_err(|why| open(&why))
}

/// What is said of a clock whose offset nothing tells.
fn open(why: &str) -> Issue {
    let words = format!(
        "the bending has a clock of its own, and nothing tells how far it is off: {why}; its readings are taken at the \
         times of their own clock"
    );
    Issue::warning("bending-clock-open", words).mend("state clock_offset_s, 0 where both clocks agree")
}

/// The offset that the onset and the course of the bending tell.
fn against_current(input: &FitInput, options: &FitOptions, bending: &Channel) -> Result<Aligned, String> {
    if input.drive.moves() {
        return Err("the voltage moves all the time".to_owned());
    }
    let (settled, _) = settled(input, options).map_err(|error| error.to_string())?;
    let edges = &settled.edges;
    let placed = FitInput {
        drive: edges.drive(),
        ..*input
    };
    let circuit = |there: &FitInput| -> Result<Electrical, String> {
        let readings = Readings::new(there).map_err(|error| error.to_string())?;
        identify(there, options, readings, None)
            .current
            .map(|(_, own)| own)
    };
    let electrical = circuit(&placed)?;
    if electrical.conductances_a_per_v.is_empty() {
        return Err("the current shows no charge that could bend the strip".to_owned());
    }
    let found =
        offset(bending, edges.drive(), &electrical).ok_or("no offset fits better than its neighbours")?;
    // Where the edges are moves the circuit, and with both the offset.
    let moved = |by_s: &Vec<f64>, sign: f64| {
        let whole: Vec<f64> = by_s.iter().map(|by_s| sign * by_s).collect();
        let part = edges.part_of(&whole);
        let within: Vec<f64> = whole.iter().map(|by_s| part * by_s).collect();
        let drive = edges.shifted(&within);
        let there = FitInput {
            drive: &drive,
            ..*input
        };
        let ahead_s = offset(bending, &drive, &circuit(&there).ok()?)?.best;
        (part > 0.0).then(|| (ahead_s - found.best) / part)
    };
    // An edge that cannot go one way is asked the other; where no end can be fitted nothing tells how far the offset goes with it.
    let of_way = |by_s: &Vec<f64>| {
        let ends = [-1.0, 1.0].into_iter().filter_map(|sign| moved(by_s, sign));
        ends.map(f64::abs).reduce(f64::max)
    };
    let ways: Option<Vec<f64>> = settled.open.iter().map(of_way).collect();
    let ways = ways.ok_or("where the edges are moves it, and no fit tells how far")?;
    let edge_error_s = ways.iter().map(|way_s| way_s.powi(2)).sum::<f64>().sqrt();
    Ok(Aligned {
        channels: later(input.channels, -found.best),
        drive: edges.drive().clone(),
        edge_error_s,
        ahead_s: [found.best, found.low, found.high],
    })
}

/// How far the clock of the bending is ahead of the drive's, given the circuit: where what is left of the bending is least.
fn offset(bending: &Channel, drive: &Drive, electrical: &Electrical) -> Option<Line> {
    let bent = |ahead_s: f64| {
        let drive = drive.later(ahead_s);
        let sampled = Sampled::new(bending, &drive, true);
        let found = bending::identify(&drive, electrical, &sampled, Search::default());
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
    Line::of(
        &tried,
        |by_s| bent(by_s).0,
        |by_s| CHI_SQUARE_95_OF_ONE * bent(by_s).1,
    )
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
        let channels = later(input.channels, -ahead_s);
        let fitted = plain(&FitInput {
            channels: &channels,
            drive: &aligned.drive,
            ..*input
        });
        fitted.map_or_else(Default::default, |fitted| {
            (values(&fitted.parameters), fitted.nuisances)
        })
    };
    let [(here, zeros), (low, zeros_low), (high, zeros_high)]: [(Values, Vec<Nuisance>); 3] =
        aligned.ahead_s.map(with);
    for nuisance in &mut fit.nuisances {
        let of = |all: &[Nuisance]| all.iter().find(|own| own.key == nuisance.key)?.estimate.value;
        if let (Some(here), Some(low), Some(high)) = (of(&zeros), of(&zeros_low), of(&zeros_high)) {
            nuisances::widen(
                &mut nuisance.estimate,
                (low - here).abs().max((high - here).abs()),
            );
        }
    }
    let end = |there| Some(End { part: 1.0, there });
    widen_by(&mut fit.parameters, &here, &[[end(low), end(high)]]);
    fit.nuisances
        .push(nuisances::clock(aligned.ahead_s[0], aligned.error_s()));
    fit.issues.push(aligned.issue());
}

/// The channels with the bending later, s.
pub(crate) fn later(channels: &[Channel], by_s: f64) -> Vec<Channel> {
    let mut moved = channels.to_vec();
    for channel in moved
        .iter_mut()
        .filter(|channel| channel.quantity == Quantity::Curvature && channel.own_clock)
    {
        channel.time_s = channel.time_s.iter().map(|t| t + by_s).collect::<Arc<[f64]>>();
    }
    moved
}
