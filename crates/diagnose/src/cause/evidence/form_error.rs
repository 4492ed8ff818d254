//! How wrong an effect's own equation may be: its trace times a smooth factor that is not quite one.

use super::policy::{FORM_ERRORS, FORM_KNOTS_BY_CLOCK, log_sum};
use super::smooth::{Column, Knots, Process, blocks_of, longest_s, shared_since_edge};
use crate::fitting::tangent::Tangent;
use crate::readings::group::RunGroup;

/// What errors of the form do to the evidence for an effect.
pub(super) struct FormError {
    /// Logarithm of the evidence with the mixture of errors over that with none.
    pub(super) gain: f64,
    /// Probability of the largest error.
    pub(super) of_largest: f64,
}

/// Of an effect whose trace after the refit is `trace`, from what is left of the readings beside it.
pub(super) fn form_error(group: &RunGroup, tangent: &Tangent, trace: &[f64], left: &[f64]) -> FormError {
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
fn columns(group: &RunGroup, trace: &[f64]) -> Vec<Column> {
    let longest_s = longest_s(group);
    let half = 0.5_f64.sqrt();
    let modulated = |place: usize, weights: &[f64], size: f64| -> (usize, Vec<f64>) {
        let block = &group.blocks[place];
        let each = weights.iter().zip(&trace[block.first..block.end]);
        (block.first, each.map(|(w, g)| size * w * g).collect())
    };
    let has_several = |place: usize| {
        let run = &group.runs[group.blocks[place].run];
        run.drive().segments.len() > 1
    };
    let by_edge = |place: usize| if has_several(place) { half * half } else { half };
    let mut columns = Vec::new();
    for channel in 0..2 {
        columns.extend(shared_since_edge(group, channel, |place, weights| {
            modulated(place, weights, by_edge(place))
        }));
        for (place, _) in blocks_of(group, channel) {
            let own = |weights: &Vec<f64>, size: f64| Column::of(vec![modulated(place, weights, size)]);
            let edges = Knots::since_edge(group, place, longest_s).weights;
            columns.extend(edges.iter().map(|weights| own(weights, by_edge(place))));
            if has_several(place) {
                let clock = Knots::by_clock(group, place, FORM_KNOTS_BY_CLOCK).weights;
                columns.extend(clock.iter().map(|weights| own(weights, half)));
            }
        }
    }
    columns
}
