//! The competitor without a name: any linear memory of the voltage, learnt from some runs and asked of others.
//!
//! A cause that is named must predict held-out readings better than a smooth answer to every step of the voltage that
//! nobody gave a name. Where it does not, the readings show that something is missing, not what.

use ieap_domain::{Drive, Level};
use ieap_numerics::sums::dot;

use crate::cause::policy::{NAMELESS_KNOTS, PREDICTED_FROM};
use crate::cause::proof::held_out::{self, Part};
use crate::cause::proof::predictive::{kept, normal};
use crate::fitting::fitted::Fitted;
use crate::readings::group::RunGroup;

/// The fall of the deviance on every held-out part, from what the base leaves there (`before`). Base parameters and the
/// answer are found to first order about the base fitted to all; what the base to first order leaves is no place to
/// count from, for it predicts otherwise than in full.
pub(crate) fn falls(base: &Fitted, group: &RunGroup, before: &[Part]) -> Vec<f64> {
    let residuals = base.residuals();
    let (_, mut columns) = base.problem.slope(&base.at);
    let searched = columns.len();
    columns.extend(shapes(group));
    let size = dot(&residuals, &residuals);
    // A knot may explain as much as is there to explain; parameters of the base are known before as they always are.
    let known: Vec<f64> = columns
        .iter()
        .enumerate()
        .map(|(k, column)| {
            if k < searched {
                PREDICTED_FROM
            } else {
                dot(column, column) / size.max(f64::MIN_POSITIVE)
            }
        })
        .collect();
    let answer = Answer {
        residuals,
        columns,
        known,
    };
    let (whole, information) = answer.least(&[]);
    let deviance = |out: &[bool]| {
        let (others, without) = answer.least(out);
        whole - others + information - without
    };
    let parts = before.iter().zip(held_out::rows(group));
    parts.map(|(part, out)| part.deviance - deviance(&out)).collect()
}

/// Residuals of the base, and what base parameters and the answer's knots add to them.
struct Answer {
    residuals: Vec<f64>,
    columns: Vec<Vec<f64>>,
    /// Precision of each column's coefficient before any reading.
    known: Vec<f64>,
}

impl Answer {
    /// Least sum of squares over the rows that are not `out`, and what they tell of the coefficients.
    fn least(&self, out: &[bool]) -> (f64, f64) {
        let right = kept(&self.residuals, out);
        let descent: Vec<f64> = self
            .columns
            .iter()
            .map(|column| dot(&kept(column, out), &right))
            .collect();
        let mut normal = normal(&self.columns, out);
        for (k, known) in self.known.iter().enumerate() {
            normal.add(k, k, *known);
        }
        let coefficients = normal.solve(&descent, 1e-14);
        (
            dot(&right, &right) - dot(&coefficients, &descent),
            normal.log_determinant(),
        )
    }
}

/// Whitened answers of current and curvature to the steps of every drive, a column for each knot of each.
fn shapes(group: &RunGroup) -> Vec<Vec<f64>> {
    let longest_s = group.runs.iter().map(|run| run.duration_s).fold(0.0, f64::max);
    let times = group.blocks.iter().flat_map(|block| {
        let times = group.runs[block.run].times(block.channel);
        times.windows(2).map(|pair| pair[1] - pair[0])
    });
    let shortest_s = times.filter(|gap| *gap > 0.0).fold(longest_s, f64::min);
    let mut columns = vec![vec![0.0; group.rows()]; 2 * NAMELESS_KNOTS];
    for block in &group.blocks {
        let run = &group.runs[block.run];
        let Some(channel) = group.channel(block) else {
            continue;
        };
        let steps = steps(run.drive());
        for knot in 0..NAMELESS_KNOTS {
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
            columns[block.channel * NAMELESS_KNOTS + knot][block.first..block.end].copy_from_slice(&series);
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
                found.push((segment.start_s(), v - before_v));
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
    let place = (elapsed_s.max(shortest_s) / shortest_s).ln() / span * (NAMELESS_KNOTS - 1) as f64;
    (1.0 - (place - knot as f64).abs()).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hats_add_up_to_one_after_the_step_and_to_nothing_before_it() {
        for elapsed_s in [0.0, 0.5, 1.0, 3.0, 77.0, 600.0] {
            let sum: f64 = (0..NAMELESS_KNOTS)
                .map(|knot| hat(knot, elapsed_s, 1.0, 600.0))
                .sum();
            assert!((sum - 1.0).abs() < 1e-12, "{elapsed_s}: {sum}");
        }
        assert_eq!(hat(0, -0.1, 1.0, 600.0), 0.0);
    }

    /// A shape that explains everything lowers the least sum on any rows, and what is known of it grows with them.
    #[test]
    fn what_is_learnt_of_a_shape_grows_with_the_rows() {
        let column: Vec<f64> = (0..40).map(|k| f64::from(k).sin()).collect();
        let answer = Answer {
            residuals: column.iter().map(|v| 30.0 * v).collect(),
            columns: vec![column],
            known: vec![1e-3],
        };
        let out: Vec<bool> = (0..40).map(|k| k >= 30).collect();
        let ((whole, of_all), (others, of_some)) = (answer.least(&[]), answer.least(&out));
        assert!(
            whole < 1.0 && others < whole && of_some < of_all,
            "{whole} {others}"
        );
    }
}
