//! How uncertain a prediction is beside the noise: by its parameters, and by the error that the model leaves of what it was fitted
//! to.

use ieap_domain::range_of;
use ieap_numerics::sums::dot;
use ieap_numerics::symmetric::Symmetric;

use super::predictive::Predictive;
use crate::fitting::problem::ExtendedProblem;
use crate::readings::group::{Block, RunGroup};

/// What is not known of a prediction by a model that lies at a place.
pub(crate) struct Doubt {
    covariance: Symmetric,
    /// Mean square that the model leaves beyond the noise of current and curvature, in parts of the square of a run's range.
    left: [f64; 2],
}

impl Doubt {
    /// Of a model that was fitted to the rows that are not `out`, and lies at `at`.
    pub(crate) fn of(problem: &ExtendedProblem, predictive: &Predictive, at: &[f64], out: &[bool]) -> Doubt {
        let group = problem.group;
        let mut residuals = Vec::new();
        problem.residuals(at, &mut residuals);
        let kept: Vec<f64> = (residuals.iter().zip(out))
            .filter(|(_, is_out)| !**is_out)
            .map(|(v, _)| *v)
            .collect();
        let wider = (dot(&kept, &kept) / kept.len().max(1) as f64).max(1.0);
        let covariance = predictive.normal_without(out).inverse(1e-12);
        let model = problem.model(at);
        let mut left: [Vec<f64>; 2] = [Vec::new(), Vec::new()];
        for (run, group_run) in group.runs.iter().enumerate() {
            let found = group_run.fitted(&model, &group_run.context(run, None));
            for block in group.blocks.iter().filter(|block| block.run == run) {
                left[block.channel].extend(beyond_noise(group, block, &found[block.channel], out));
            }
        }
        let mean = |of: &Vec<f64>| of.iter().sum::<f64>() / of.len().max(1) as f64;
        Doubt {
            covariance: Symmetric::from_fn(at.len(), |a, b| wider * covariance.get(a, b)),
            left: left.each_ref().map(mean),
        }
    }

    /// Variance of what is predicted of each reading of a run, current and curvature, without their noise.
    pub(crate) fn variances(&self, problem: &ExtendedProblem, at: &[f64], run: usize) -> [Vec<f64>; 2] {
        let group_run = &problem.group.runs[run];
        let context = group_run.context(run, None);
        let here = group_run.fitted(&problem.model(at), &context);
        let slopes: Vec<[Vec<f64>; 2]> = (0..at.len())
            .map(|k| {
                let mut there = at.to_vec();
                there[k] += ExtendedProblem::STEP;
                group_run.fitted(&problem.model(&there), &context)
            })
            .collect();
        std::array::from_fn(|channel| {
            let range = group_run.channels[channel]
                .as_ref()
                .map_or(0.0, |own| span(own.values()));
            let of = |k: usize| {
                let own: Vec<f64> = (slopes.iter())
                    .map(|slope| (slope[channel][k] - here[channel][k]) / ExtendedProblem::STEP)
                    .collect();
                self.covariance.form(&own, &own).max(0.0) + self.left[channel] * range * range
            };
            (0..here[channel].len()).map(of).collect()
        })
    }
}

/// Mean square of what a model leaves of a block's rows that are not `out` beyond their noise, in parts of the square of its
/// range; none where all are out.
fn beyond_noise(group: &RunGroup, block: &Block, fitted: &[f64], out: &[bool]) -> Option<f64> {
    let channel = group.channel(block)?;
    let readings = channel
        .values()
        .iter()
        .zip(channel.standard_deviation())
        .zip(fitted);
    let kept = readings
        .zip(&out[block.first..block.end])
        .filter(|(_, is_out)| !**is_out);
    let each: Vec<f64> = kept.map(|(((y, sd), f), _)| (y - f).powi(2) - sd * sd).collect();
    let range = span(channel.values());
    let mean = each.iter().sum::<f64>() / each.len() as f64;
    (!each.is_empty() && range > 0.0).then(|| mean.max(0.0) / (range * range))
}

fn span(values: &[f64]) -> f64 {
    let (low, high) = range_of(values.iter().copied());
    high - low
}
