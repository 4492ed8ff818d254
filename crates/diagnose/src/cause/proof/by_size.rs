//! Whether a law predicts what it has not seen better, by the size of the error and beyond its doubt.

use super::held_out::{HeldOut, OF_TIME, Part, drives};
use super::later::later_parts;
use crate::cause::policy::BESIDE_PART;
use crate::fitting::fitted::Fitted;
use crate::readings::group::RunGroup;

/// Logarithm of the odds that what was held out is predicted better, beyond the doubt of both predictions where it is known.
fn log_odds(before: &[Part], after: &[Part]) -> f64 {
    let of_part = |(before, after): (&Part, &Part)| {
        if let (Some(before), Some(after)) = (&before.beyond_doubt, &after.beyond_doubt) {
            return after.log_odds(before);
        }
        let pairs = before.errors.iter().zip(&after.errors);
        pairs.map(|(before, after)| after.log_odds(before)).sum::<f64>()
    };
    before.iter().zip(after).map(of_part).sum()
}

impl HeldOut {
    /// Logarithm of the odds of a law of that variable: on the drives that others lie on both sides of, or, where there are none,
    /// on the later part of every run. Beyond what the others measured no law is known, and none is judged there.
    pub(crate) fn log_odds(
        &self,
        group: &RunGroup,
        variable: Option<&str>,
        before: &Fitted,
        after: &Fitted,
    ) -> f64 {
        if group.runs.len() < 2 {
            return log_odds(&self.before, &self.after);
        }
        self.log_odds_between(&between(group, variable))
            .unwrap_or_else(|| log_odds(&later_parts(before, group), &later_parts(after, group)))
    }

    /// The same on the drives alone that others lie on both sides of; none where there are none.
    pub(crate) fn log_odds_between(&self, between: &[bool]) -> Option<f64> {
        let kept = self.only(between, true);
        (!kept.after.is_empty()).then(|| log_odds(&kept.before, &kept.after))
    }

    /// The parts of which it is so that others lie on both sides of them, or not.
    pub(crate) fn only(&self, between: &[bool], is_so: bool) -> HeldOut {
        let kept = |parts: &[Part]| {
            let each = parts.iter().zip(between);
            let kept = each.filter(|(_, is_between)| **is_between == is_so);
            kept.map(|(part, _)| part.clone()).collect()
        };
        HeldOut {
            before: kept(&self.before),
            after: kept(&self.after),
        }
    }
}

/// Of everything that is held out, whether others lie beyond it in the variable: in time by their length, in all else by their
/// voltage, and of a law of the voltage on its other side too. Times of a single run are all within it.
pub(crate) fn between(group: &RunGroup, variable: Option<&str>) -> Vec<bool> {
    let reach = |run: usize| match variable {
        Some("time_s" | "time_since_edge_s" | "time_constant_s" | "edges") => group.runs[run].duration_s,
        _ => group.runs[run].drive().largest_v().abs(),
    };
    let of_drive = |out: &Vec<usize>| {
        let own = out.iter().map(|&run| reach(run)).fold(0.0, f64::max);
        let mut others = (0..group.runs.len()).filter(|run| !out.contains(run)).map(reach);
        let is_below = others.clone().any(|other| own <= (1.0 + BESIDE_PART) * other);
        is_below && (variable != Some("voltage_v") || others.any(|other| own >= (1.0 - BESIDE_PART) * other))
    };
    if group.runs.len() < 2 {
        return vec![true; OF_TIME.len()];
    }
    drives(group).iter().map(of_drive).collect()
}
