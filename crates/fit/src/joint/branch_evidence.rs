//! How many branches the current of one run shows.

use crate::electrical::Electrical;
use crate::joint::policy::RULED_OUT_RISE;
use crate::policy::{BRANCH_DOUBT, BRANCH_EVIDENCE};

use ieap_numerics::least_squares::{Bounds, Levenberg, Local, Minimum, Problem};
use ieap_numerics::sums::dot;

use super::layout::Layout;
use super::minimum::{electrical_starts, excess, minimum};
use super::problem::JointProblem;
use super::readings::RunReadings;

/// Step of the difference quotients, in logarithms.
const STEP: f64 = 1e-4;

/// What the current says of the number of branches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Branches {
    /// One fewer is enough; where that is one, no second one of a noticeable size could hide.
    Fewer,
    /// One is enough, but a second one could hide in the noise.
    OneOrHidden,
    /// The last one may be there or may be chance.
    Doubtful,
    /// All that were weighed.
    All,
}

/// The choice with its evidence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Evidence {
    pub(crate) branches: Branches,
    /// Number of branches that was weighed against one fewer.
    pub(crate) weighed: usize,
    /// Fall of the weighted sum of squares (twice the log likelihood ratio) by the last branch.
    pub(crate) gain: f64,
    /// What BIC asks of two further parameters.
    pub(crate) penalty: f64,
    /// Readings that carry as much as independent ones.
    pub(crate) effective_readings: f64,
}

/// Weighs the branches of `full` against one fewer.
pub(super) fn evidence(
    current: &RunReadings,
    electrical: &Electrical,
    full: &(JointProblem, Minimum),
) -> Evidence {
    let weighed = full.0.layout.branches;
    let effective_readings = current
        .current
        .as_ref()
        .map_or(1.0, |response| response.effective_readings());
    let penalty = 2.0 * effective_readings.max(2.0).ln();
    let mut evidence = Evidence {
        branches: Branches::All,
        weighed,
        gain: f64::INFINITY,
        penalty,
        effective_readings,
    };
    if weighed < 2 {
        return evidence;
    }
    let Some((fewer, bottom)) = minimum(current, &electrical_starts(current, electrical, weighed - 1)) else {
        return evidence;
    };
    let scale = excess(&full.0, &full.1).powi(2);
    evidence.gain = ((bottom.local.square - full.1.local.square) / scale).max(0.0);
    evidence.branches = if evidence.gain > BRANCH_EVIDENCE {
        Branches::All
    } else if evidence.gain > BRANCH_DOUBT {
        Branches::Doubtful
    } else if weighed > 2 || hidden_rise(&fewer, &bottom) / scale > RULED_OUT_RISE {
        Branches::Fewer
    } else {
        Branches::OneOrHidden
    };
    evidence
}

/// How far the sum of squares must rise above that of one branch to make room for a second one that would
/// matter: a tenth of the conductance where it is the fast one, a twentieth where it is the slow one, and a time
/// constant three times apart, from a tenth of the sampling interval to the length of the record.
fn hidden_rise(one: &JointProblem, bottom: &Minimum) -> f64 {
    let local = one.of_run(0, &bottom.at);
    let layout = Layout { branches: 2 };
    let Some(response) = &one.runs[0].current else {
        return 0.0;
    };
    let (shortest_s, longest_s) = response.sampled.time_scales_s();
    let tau = local[0] + local[1];
    let unit = one.units[one.layout.steady()];
    let steady = local[one.layout.steady()] / unit;
    let offset = local[one.layout.current_offset()];
    // ln conductance, share of the fast branch, ln of the fast and ratio of the time constants, steady, offset.
    let low = [-local[0] - 5.0, 0.1, (shortest_s / 10.0).ln(), 3.0_f64.ln(), 0.0];
    let high = [
        -local[0] + 5.0,
        0.95,
        longest_s.ln() - 3.0_f64.ln(),
        1e3_f64.ln(),
        1e4,
    ];
    if low[2] >= high[2] {
        return 0.0;
    }
    let model_at = |at: &[f64]| {
        let mut full = vec![0.0; layout.len()];
        let shares = [at[1], 1.0 - at[1]];
        let log_tau = [at[2], (at[2] + at[3]).min(longest_s.ln())];
        for k in 0..2 {
            full[layout.resistance(k)] = -(at[0] + shares[k].ln());
            full[layout.capacitance(k)] = log_tau[k] - full[layout.resistance(k)];
        }
        full[layout.steady()] = at[4].max(0.0) * unit;
        full[layout.current_offset()] = offset;
        full
    };
    let two = JointProblem {
        layout,
        ..one.clone()
    };
    let residuals = |at: &[f64]| {
        let local = model_at(at);
        let mut out = Vec::new();
        two.runs[0].condensed(&two.model(&local), two.offsets(&local), &mut out);
        out
    };
    let hidden = Hidden {
        bounds: Bounds {
            low: low.to_vec(),
            high: high.to_vec(),
        },
        residuals,
    };
    let method = Levenberg::by_diagonal(60, 1e-3);
    let third = 3.0_f64.ln();
    let starts = [
        [-local[0], 0.95, tau, third],
        [-local[0], 0.1, tau - third, third],
        [-local[0], 0.5, tau - third / 2.0, third],
        [-local[0], 0.95, tau, 3.0 * third],
        [-local[0], 0.1, tau - 2.0 * third, 2.0 * third],
        [-local[0], 0.3, low[2], tau - low[2]],
    ];
    let found = starts.iter().map(|start| {
        let at = [start[0], start[1], start[2], start[3], steady];
        method.search(&hidden, &at).local.square
    });
    found.fold(f64::INFINITY, f64::min) - bottom.local.square
}

/// Residuals of a model, with forward differences for derivatives.
struct Hidden<R> {
    bounds: Bounds,
    residuals: R,
}

impl<R: Fn(&[f64]) -> Vec<f64>> Problem for Hidden<R> {
    fn bounds(&self) -> Bounds {
        self.bounds.clone()
    }

    fn local(&self, at: &[f64], most: f64) -> Local {
        let here = (self.residuals)(at);
        let square = dot(&here, &here);
        if square > most {
            return Local::refused(square, at.len());
        }
        let column = |k: usize| -> Vec<f64> {
            let mut moved = at.to_vec();
            moved[k] += STEP;
            let there = (self.residuals)(&moved);
            here.iter().zip(there).map(|(h, m)| (h - m) / STEP).collect()
        };
        let columns: Vec<Vec<f64>> = (0..at.len()).map(column).collect();
        Local::of(&here, &columns)
    }
}
