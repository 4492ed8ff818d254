//! A charge that no reading of the current saw: a branch that charges between an edge and the first reading after it.
//!
//! It bends the strip all the same, at once and then relaxing, so that the curvature tells how much it is. What the current
//! alone leaves open of it stands in the capacitance, the resistance and the coupling.

use ieap_numerics::sums;

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
/// Halvings of the stretch that holds the best one.
const REFINED: usize = 14;
/// Distance of the parts from which the curvature of the sum of squares is taken.
const APART: f64 = 0.01;

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
        let search = options.search();
        *electrical = electrical::identify(
            input.drive,
            input.area_cm2,
            current,
            options.model.branches,
            search,
        );
    }
    let seen = electrical.without_too_fast();
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
        Ok((sampled, bending)) if bending.evident => parts.found(sampled),
        _ => None,
    };
    let Some(found) = found else {
        // Nothing but the current tells: what it does not show is not known.
        if !is_shown {
            electrical.unseen = Some(Unseen::NotKnown);
        }
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
        let square = |part: f64| self.bending(part, sampled).residuals.square;
        let mut tried = TRIED.map(|part| (part, square(part)));
        tried.sort_by(|a, b| a.1.total_cmp(&b.1));
        let near = TRIED.iter().position(|part| *part == tried[0].0)?;
        let (mut low, mut high) = (
            TRIED[near.saturating_sub(1)],
            TRIED[(near + 1).min(TRIED.len() - 1)],
        );
        for _ in 0..REFINED {
            let (a, b) = (low + 0.382 * (high - low), low + 0.618 * (high - low));
            if square(a) <= square(b) { high = b } else { low = a }
        }
        let part = 0.5 * (low + high);
        let mut bending = self.bending(part, sampled);
        let variance = bending.residuals.long_run_variance(sums::peak(&sampled.values));
        let beside = [-1.0, 1.0].map(|sign| self.bending((part + sign * APART).max(0.0), sampled));
        let apart = APART + part.min(APART);
        let rise = (beside[0].residuals.square + beside[1].residuals.square - 2.0 * bending.residuals.square)
            .max(f64::MIN_POSITIVE);
        let error = (2.0 * variance * (0.5 * apart).powi(2) / rise).sqrt();
        if part + error >= LARGEST || !bending.evident {
            return None;
        }
        let slopes = [
            (beside[1].coupling_per_c_cm - beside[0].coupling_per_c_cm) / apart,
            (beside[1].rate_per_s - beside[0].rate_per_s) / apart,
        ];
        bending.covariance = ieap_numerics::symmetric::Symmetric::from_fn(2, |a, b| {
            bending.covariance.get(a, b) + slopes[a] * slopes[b] * error * error
        });
        let fall = square(0.0) - bending.residuals.square;
        Some(Found {
            is_evident: fall > BRANCH_EVIDENCE * variance,
            part,
            error,
            bending,
        })
    }
}

impl Found {
    fn electrical(&self, seen: &Electrical, tau_s: f64) -> Electrical {
        let share = self.part / (1.0 - self.part);
        let relative = self.error / (self.part * (1.0 - self.part));
        Electrical {
            unseen: Some(Unseen::Told),
            ..seen.with_unseen(share, relative, tau_s)
        }
    }

    /// The largest share of the charge that was seen, at 95 %.
    fn most(&self) -> f64 {
        let most = (self.part + ieap_domain::quantiles::NORMAL_95 * self.error).min(LARGEST);
        most / (1.0 - most)
    }
}
