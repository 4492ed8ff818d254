//! The competitor without a name: any linear memory of the voltage, learnt from some runs and asked of others.
//!
//! A cause that is named must predict held-out readings better than a smooth answer to every step of the voltage that
//! nobody gave a name. Where it does not, the readings show that something is missing, not what.

use crate::domain::{Drive, Level};
use crate::numerics::dense::Slope;
use crate::numerics::sums::dot;

use super::fitted::Fitted;
use super::group::Group;
use super::held_out::{self, Part};

/// Knots of the answer to a step, evenly in the logarithm of the time since it.
const KNOTS: usize = 8;
/// Part of a column's own square that is added to it: knots that the readings do not reach stay at zero.
const RIDGE: f64 = 1e-9;

/// The fall of the sum of squares on every held-out part, from what the base refitted without it leaves there
/// (`before`). Base parameters and the answer are found from the other rows, to first order about the base fitted to
/// all; what the base to first order leaves is no place to count from, for it predicts otherwise than in full.
pub(super) fn falls(base: &Fitted, group: &Group, before: &[Part]) -> Vec<f64> {
    let residuals = base.residuals();
    let (_, jacobian) = base.problem.slope(&base.at, &[]);
    let shapes = shapes(group);
    let both: Vec<&Vec<f64>> = jacobian.iter().chain(&shapes).collect();
    let left = |out: &Vec<bool>| held_out_square(&residuals, &both, out);
    let parts = before.iter().zip(held_out::rows(group));
    parts.map(|(part, out)| part.square - left(&out)).collect()
}

/// Sum of squares on the rows that are `out`, with the columns' coefficients found from the others.
fn held_out_square(residuals: &[f64], columns: &[&Vec<f64>], out: &[bool]) -> f64 {
    let kept = |column: &[f64]| -> Vec<f64> {
        column
            .iter()
            .zip(out)
            .filter(|(_, out)| !**out)
            .map(|(v, _)| *v)
            .collect()
    };
    let known: Vec<Vec<f64>> = columns.iter().map(|column| kept(column)).collect();
    let right = kept(residuals);
    let mut slope = Slope::zero(columns.len());
    for (a, left) in known.iter().enumerate() {
        slope.descent[a] = dot(left, &right);
        for (b, other) in known[..=a].iter().enumerate() {
            let product = dot(left, other);
            slope.normal.add(a, b, product);
            if a != b {
                slope.normal.add(b, a, product);
            }
        }
        slope
            .normal
            .add(a, a, RIDGE * dot(columns[a], columns[a]).max(f64::MIN_POSITIVE));
    }
    let coefficients = slope.normal.solve(&slope.descent, 1e-12);
    let rows = out.iter().enumerate().filter(|(_, out)| **out);
    rows.map(|(row, _)| {
        let fitted: f64 = columns
            .iter()
            .zip(&coefficients)
            .map(|(column, c)| c * column[row])
            .sum();
        (residuals[row] - fitted).powi(2)
    })
    .sum()
}

/// Whitened answers of current and curvature to the steps of every drive, a column for each knot of each.
fn shapes(group: &Group) -> Vec<Vec<f64>> {
    let longest_s = group.runs.iter().map(|run| run.duration_s).fold(0.0, f64::max);
    let times = group.blocks.iter().flat_map(|block| {
        let times = group.runs[block.run].times(block.channel);
        times.windows(2).map(|pair| pair[1] - pair[0])
    });
    let shortest_s = times.filter(|gap| *gap > 0.0).fold(longest_s, f64::min);
    let mut columns = vec![vec![0.0; group.rows()]; 2 * KNOTS];
    for block in &group.blocks {
        let run = &group.runs[block.run];
        let Some(channel) = group.channel(block) else {
            continue;
        };
        let steps = steps(run.given.input.drive);
        for knot in 0..KNOTS {
            let answer = |t: &f64| -> f64 {
                let of_step = |(start_s, change_v): &(f64, f64)| {
                    change_v * hat(knot, t - start_s, shortest_s, longest_s)
                };
                steps.iter().map(of_step).sum()
            };
            let mut series: Vec<f64> = run.times(block.channel).iter().map(answer).collect();
            let sd = channel.standard_deviation();
            let mean = sd.iter().sum::<f64>() / sd.len().max(1) as f64;
            // In units of the noise at first, so that columns are of a size.
            series.iter_mut().for_each(|v| *v *= mean);
            channel.whiten(&mut series);
            columns[block.channel * KNOTS + knot][block.first..block.end].copy_from_slice(&series);
        }
    }
    columns.retain(|column| column.iter().any(|v| *v != 0.0));
    columns
}

/// Times and sizes of the changes of the voltage.
fn steps(drive: &Drive) -> Vec<(f64, f64)> {
    let mut before_v = drive.baseline_v;
    let mut found = Vec::new();
    for segment in &drive.segments {
        if let Level::Voltage(v) = segment.level {
            if v != before_v {
                found.push((segment.start_s, v - before_v));
            }
            before_v = v;
        }
    }
    found
}

/// Piecewise linear in the logarithm of the time: 1 at its knot, 0 at the next ones.
fn hat(knot: usize, elapsed_s: f64, shortest_s: f64, longest_s: f64) -> f64 {
    if elapsed_s < 0.0 {
        return 0.0;
    }
    let span = (longest_s / shortest_s).max(2.0).ln();
    let place = (elapsed_s.max(shortest_s) / shortest_s).ln() / span * (KNOTS - 1) as f64;
    (1.0 - (place - knot as f64).abs()).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hats_add_up_to_one_after_the_step_and_to_nothing_before_it() {
        for elapsed_s in [0.0, 0.5, 1.0, 3.0, 77.0, 600.0] {
            let sum: f64 = (0..KNOTS).map(|knot| hat(knot, elapsed_s, 1.0, 600.0)).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{elapsed_s}: {sum}");
        }
        assert_eq!(hat(0, -0.1, 1.0, 600.0), 0.0);
    }

    #[test]
    fn what_is_learnt_on_some_rows_is_asked_of_the_others() {
        let column: Vec<f64> = (0..40).map(|k| f64::from(k).sin()).collect();
        let residuals: Vec<f64> = column.iter().map(|v| 3.0 * v).collect();
        let out: Vec<bool> = (0..40).map(|k| k >= 30).collect();
        let without = held_out_square(&residuals, &[], &out);
        let with = held_out_square(&residuals, &[&column], &out);
        assert!(
            without > 1.0 && with < 1e-12 * without.max(1.0),
            "{without} {with}"
        );
    }
}
