//! A charge that no reading of the current saw: a branch that charges between an edge and the first reading after it.
//!
//! It bends the strip all the same, at once and then relaxing, so that the curvature tells how much it is. What the current
//! alone leaves open of it stands in the capacitance, the resistance and the coupling.

use ieap_domain::quantiles::{CHI_SQUARE_95_OF_ONE, NORMAL_95};
use ieap_numerics::line::Line;
use ieap_numerics::sums;
use ieap_numerics::symmetric::Symmetric;

use crate::bending::{self, Bending};
use crate::electrical::{self, Electrical, Unseen};
use crate::options::{FitInput, FitOptions};
use crate::policy::{BRANCH_EVIDENCE, UNSEEN_FASTER};
use crate::sampled::Sampled;
use crate::search::Search;
use crate::two_steps::Identified;

/// Parts of the whole charge that are tried first, and the largest.
const TRIED: [f64; 7] = [0.0, 0.05, 0.2, 0.4, 0.6, 0.8, LARGEST];
const LARGEST: f64 = 0.9;

/// Looks for a charge that the current did not show, where there may be one, and allows for it.
pub(crate) fn look(input: &FitInput, options: &FitOptions, identified: &mut Identified) {
    let between = input
        .drive
        .segments
        .iter()
        .any(|segment| !segment.edge.is_stated());
    let Ok((current, electrical)) = &mut identified.current else {
        return;
    };
    if input.drive.moves() || !between {
        return;
    }
    let is_shown = electrical.is_too_fast();
    if is_shown {
        // One reading after each edge shows it, how much of it nobody knows: the others tell of the rest.
        *current = current.without_edges(1);
        *electrical = of_branches(input, options, current, options.model.branches);
    }
    let mut seen = electrical.without_too_fast();
    if is_shown && seen.conductances_a_per_v.len() < electrical.conductances_a_per_v.len() {
        // None of these readings shows it: beside it the covariance of the others would be lost.
        seen = of_branches(input, options, current, seen.conductances_a_per_v.len()).without_too_fast();
    }
    let is_shown = is_shown && seen.conductances_a_per_v.len() < options.model.branches;
    let fewer = seen.conductances_a_per_v.len() < options.model.branches;
    if seen.conductances_a_per_v.is_empty() || !fewer {
        return;
    }
    let (shortest_s, _) = current.time_scales_s();
    let parts = Parts {
        input,
        seen: &seen,
        tau_s: shortest_s / UNSEEN_FASTER,
    };
    let found = match &identified.curvature {
        Ok((sampled, bending)) if bending.shown.is_response() => parts.found(sampled),
        _ => None,
    };
    let Some(found) = found else {
        // Nothing but the current tells: what it does not show is not known.
        electrical.unseen = Some(Unseen::NotKnown);
        return;
    };
    if found.is_evident || is_shown {
        *electrical = found.electrical(&seen, parts.tau_s);
    } else {
        electrical.unseen = Some(Unseen::AtMost(found.most()));
    }
    if let Ok((_, bending)) = &mut identified.curvature {
        *bending = found.bending;
    }
}

/// The circuit of so many branches.
fn of_branches(input: &FitInput, options: &FitOptions, current: &Sampled, branches: usize) -> Electrical {
    electrical::identify(input.drive, input.area_cm2, current, branches, options.search())
}

/// Bending of a strip of whose charge a part was not seen.
struct Parts<'a> {
    input: &'a FitInput<'a>,
    seen: &'a Electrical,
    tau_s: f64,
}

/// The part that the curvature has best.
struct Found {
    part: f64,
    error: f64,
    most: f64,
    bending: Bending,
    is_evident: bool,
}

impl Parts<'_> {
    fn bending(&self, part: f64, sampled: &Sampled) -> Bending {
        let electrical = if part > 0.0 {
            self.seen.with_unseen(part / (1.0 - part), 0.0, self.tau_s)
        } else {
            self.seen.clone()
        };
        bending::identify(self.input.drive, &electrical, sampled, Search::default())
    }

    fn found(&self, sampled: &Sampled) -> Option<Found> {
        let at = |part: f64| self.bending(part, sampled);
        let variance = |of: &Bending| of.residuals.long_run_variance(sums::peak(&sampled.values));
        let line = Line::of(
            &TRIED,
            |part| at(part).residuals.square,
            |part| CHI_SQUARE_95_OF_ONE * variance(&at(part)),
        )?;
        let mut bending = at(line.best);
        if line.high >= LARGEST || !bending.shown.is_response() {
            return None;
        }
        let error = (line.high - line.low) / (2.0 * NORMAL_95);
        let ends = [at(line.low), at(line.high)];
        let moves = [
            ends[1].coupling_per_c_cm - ends[0].coupling_per_c_cm,
            ends[1].rate_per_s - ends[0].rate_per_s,
        ];
        let moves = moves.map(|by| by / (2.0 * NORMAL_95));
        bending.covariance = Symmetric::from_fn(2, |a, b| bending.covariance.get(a, b) + moves[a] * moves[b]);
        let fall = at(0.0).residuals.square - bending.residuals.square;
        Some(Found {
            is_evident: fall > BRANCH_EVIDENCE * variance(&bending),
            part: line.best,
            error,
            most: line.high,
            bending,
        })
    }
}

impl Found {
    fn electrical(&self, seen: &Electrical, tau_s: f64) -> Electrical {
        let share = self.part / (1.0 - self.part);
        let relative = self.error / (self.part * (1.0 - self.part));
        Electrical {
            unseen: Some(Unseen::Told {
                part: self.part,
                error: self.error,
            }),
            ..seen.with_unseen(share, relative, tau_s)
        }
    }

    /// The largest share of the charge that was seen, at 95 %.
    fn most(&self) -> f64 {
        self.most / (1.0 - self.most)
    }
}
