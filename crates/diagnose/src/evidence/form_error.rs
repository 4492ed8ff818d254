//! How wrong an effect's own equation may be: its trace times a smooth factor that is not quite one.

use super::policy::{FORM_ERRORS, log_sum};
use super::smooth::{Column, Knots, Process, longest_s};
use crate::group::Group;
use crate::tangent::Tangent;

/// Knots of the factor over the clock, where a run has several edges.
const BY_CLOCK: usize = 6;

/// What errors of the form do to the evidence for an effect.
pub(super) struct FormError {
    /// Logarithm of the evidence with the mixture of errors over that with none.
    pub(super) gain: f64,
    /// Probability of the largest error.
    pub(super) of_largest: f64,
}

/// Of an effect whose trace after the refit is `trace`, from what is left of the readings beside it.
pub(super) fn form_error(group: &Group, tangent: &Tangent, trace: &[f64], left: &[f64]) -> FormError {
    let process = Process::of(&columns(group, trace), tangent, left);
    let parts: Vec<f64> = FORM_ERRORS
        .iter()
        .map(|(size, prior)| prior.ln() + process.log_evidence(*size))
        .collect();
    let gain = log_sum(&parts);
    let last = parts.last().copied().unwrap_or(f64::NEG_INFINITY);
    FormError {
        gain,
        of_largest: (last - gain).exp(),
    }
}

/// The trace times each knot: half of the error shared by all runs, half of each run's own; of runs of several edges half of
/// that by the time since the edge, half by the clock. Current and curvature err apart.
fn columns(group: &Group, trace: &[f64]) -> Vec<Column> {
    let longest_s = longest_s(group);
    let half = 0.5_f64.sqrt();
    let mut columns = Vec::new();
    for channel in 0..2 {
        let mut shared: Vec<Vec<(usize, Vec<f64>)>> = Vec::new();
        for (place, block) in group.blocks.iter().enumerate() {
            if block.channel != channel {
                continue;
            }
            let own = &trace[block.first..block.end];
            let modulated = |weights: &Vec<f64>, size: f64| -> (usize, Vec<f64>) {
                let each = weights.iter().zip(own);
                (block.first, each.map(|(w, g)| size * w * g).collect())
            };
            let has_several = group.runs[block.run].given.input.drive.segments.len() > 1;
            let by_edge = if has_several { half } else { 1.0 };
            let edges = Knots::since_edge(group, place, longest_s).weights;
            shared.resize_with(edges.len().max(shared.len()), Vec::new);
            for (sharing, weights) in shared.iter_mut().zip(&edges) {
                sharing.push(modulated(weights, half * by_edge));
                columns.push(Column::of(vec![modulated(weights, half * by_edge)]));
            }
            if has_several {
                let clock = Knots::by_clock(group, place, BY_CLOCK).weights;
                columns.extend(clock.iter().map(|w| Column::of(vec![modulated(w, half)])));
            }
        }
        columns.extend(shared.into_iter().map(Column::of));
    }
    columns
}
