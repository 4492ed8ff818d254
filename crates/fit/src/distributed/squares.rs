//! Least squares over all series at once, with derivatives by differences: the series is cheap and smooth.

use ieap_numerics::least_squares::{Bounds, Levenberg, Local, Problem, Stop};
use ieap_numerics::sums::{dot, square};
use ieap_numerics::symmetric::Symmetric;

use super::described::Described;
use super::input::{DistributedInput, Probed};
use super::left_out::{Columns, LeftOut};
use super::policy::{HALF_BOX_LOG, LEAST_REACH};
use super::readings::{Kind, Readings, SeriesGroup};
use super::residual_noise::ResidualNoise;
use super::response;
use crate::policy::LOST_BELOW;

/// Step of the differences in a logarithm: the error of second order is then about a part in 10^9.
const STEP: f64 = 3e-5;
/// Evaluations of one search.
const LIMIT: u64 = 80;
/// A search ends where a step would lower the sum of squares by less than this part of it: a resistance that is too
/// small to be noticed is not followed to nothing.
const SETTLED: f64 = 1e-9;
/// Where R_e stands among the parameters.
const RESISTANCE: usize = 3;

/// A minimum with what its uncertainty needs.
#[derive(Debug, Clone)]
pub(super) struct Fitted {
    /// Parameters at the minimum.
    pub at: Vec<f64>,
    /// Sum of squared residuals, each over its noise.
    pub square: f64,
    /// Covariance of the parameters; correlation of the residuals in time and between places, and misfit, allowed for.
    pub covariance: Symmetric,
    /// Variance of each parameter in units of what independent residuals of the noise's size would give.
    pub inflation: Vec<f64>,
    /// Degrees of freedom.
    pub freedom: f64,
    /// Why the search stopped.
    pub stop: Stop,
    /// Evaluations that it took.
    pub evaluations: u64,
}

impl Fitted {
    /// The same for the parameters of these indices only.
    pub fn part(&self, indices: &[usize]) -> Fitted {
        Fitted {
            at: indices.iter().map(|&k| self.at[k]).collect(),
            covariance: self.covariance.part(indices),
            inflation: indices.iter().map(|&k| self.inflation[k]).collect(),
            ..self.clone()
        }
    }
}

/// What parameters say of the strip.
type Describe<'a> = Box<dyn Fn(&[f64]) -> Described + 'a>;

/// A least-squares problem: groups of series, and what parameters say of the strip.
pub(super) struct StripProblem<'a> {
    /// The groups.
    pub groups: Vec<&'a SeriesGroup>,
    input: &'a DistributedInput<'a>,
    parameters: usize,
    /// Whether the first parameters are the electrical ones.
    fits_electrodes: bool,
    /// What a probe read of the fourth parameter.
    probed: Option<Probed>,
    describe: Describe<'a>,
}

impl<'a> StripProblem<'a> {
    /// A problem of the groups whose kind is among `kinds`.
    pub fn new(
        input: &'a DistributedInput<'a>,
        readings: &'a Readings,
        kinds: &[Kind],
        parameters: usize,
        describe: impl Fn(&[f64]) -> Described + 'a,
    ) -> StripProblem<'a> {
        let groups = readings.groups.iter();
        let groups = groups.filter(|group| kinds.contains(&group.kind)).collect();
        StripProblem::of_groups(input, groups, parameters, describe)
    }

    /// A problem of these groups.
    pub fn of_groups(
        input: &'a DistributedInput<'a>,
        groups: Vec<&'a SeriesGroup>,
        parameters: usize,
        describe: impl Fn(&[f64]) -> Described + 'a,
    ) -> StripProblem<'a> {
        StripProblem {
            groups,
            input,
            parameters,
            fits_electrodes: parameters > 3,
            probed: input.strip.probed().filter(|_| parameters > 3),
            describe: Box::new(describe),
        }
    }

    /// Number of parameters.
    pub fn parameters(&self) -> usize {
        self.parameters
    }

    /// Sum of squares at a place.
    pub fn square(&self, at: &[f64]) -> f64 {
        let residuals = self.residuals(at);
        product(&residuals, &residuals) + self.off_the_probe(at).powi(2)
    }

    /// By how many of its errors R_e lies off what a probe read; nothing where none did.
    fn off_the_probe(&self, at: &[f64]) -> f64 {
        self.probed.map_or(0.0, |probed| {
            (probed.log_ohm_per_cm - at[RESISTANCE]) / probed.error
        })
    }

    /// What the probe's reading tells of each pair of parameters, counted `weight` times.
    fn told_by_probe(&self, weight: f64) -> Symmetric {
        let told = self.probed.map_or(0.0, |probed| weight * probed.error.powi(-2));
        Symmetric::from_fn(self.parameters, |row, column| {
            if row == RESISTANCE && column == RESISTANCE {
                told
            } else {
                0.0
            }
        })
    }

    /// What the place says of every group, one series after the other.
    pub fn predicted(&self, at: &[f64]) -> Vec<Vec<f64>> {
        let described = (self.describe)(at);
        let of = |group: &&SeriesGroup| response::predicted(&described, self.input.drive, group);
        self.groups.iter().map(of).collect()
    }

    /// The factor on what a place predicts that fits best, and the sum of squares with it.
    pub fn best_scale(&self, at: &[f64]) -> (f64, f64) {
        let (mut cross, mut own, mut all) = (0.0, 0.0, 0.0);
        for (group, predicted) in self.groups.iter().zip(&self.predicted(at)) {
            for (place, row) in predicted.chunks_exact(group.time_s.len()).enumerate() {
                let weight = group.noise[place].powi(-2);
                cross += weight * dot(row, &group.values[place]);
                own += weight * square(row);
                all += weight * square(&group.values[place]);
            }
        }
        let scale = if own > 0.0 { cross / own } else { 0.0 };
        (scale, all - scale * cross)
    }

    /// Residuals of every group over the noise.
    pub fn residuals(&self, at: &[f64]) -> Vec<Vec<f64>> {
        let mut all = self.predicted(at);
        for (residuals, group) in all.iter_mut().zip(&self.groups) {
            for (place, row) in residuals.chunks_exact_mut(group.time_s.len()).enumerate() {
                let noise = group.noise[place];
                row.iter_mut()
                    .zip(group.values[place].iter())
                    .for_each(|(r, v)| *r = (v - *r) / noise);
            }
        }
        all
    }

    /// Derivatives of the predictions over the noise by parameter and group, by central differences.
    pub fn slopes(&self, at: &[f64]) -> Vec<Vec<Vec<f64>>> {
        (0..self.parameters).map(|k| self.slope(at, k)).collect()
    }

    /// Derivatives by parameter `k`, by group.
    pub fn slope(&self, at: &[f64], k: usize) -> Vec<Vec<f64>> {
        let moved = |by: f64| {
            let mut place = at.to_vec();
            place[k] += by;
            self.residuals(&place)
        };
        let (mut up, down) = (moved(STEP), moved(-STEP));
        for (up, down) in up.iter_mut().zip(&down) {
            up.iter_mut()
                .zip(down)
                .for_each(|(up, down)| *up = (down - *up) / (2.0 * STEP));
        }
        up
    }

    /// Searches from `start` and forms the covariance at the minimum.
    pub fn search(&self, start: &[f64]) -> Fitted {
        self.search_within(start, &self.limits(start))
    }

    /// A wide box around a start. A fitted R_e stays above what could be noticed, where its logarithm still moves
    /// something.
    pub fn limits(&self, start: &[f64]) -> Bounds {
        let mut bounds = Bounds::about(start, HALF_BOX_LOG);
        let strip = &self.input.strip;
        if strip.electrode_resistance_ohm_per_sq.is_none() && self.fits_electrodes {
            bounds.low[RESISTANCE] = (LEAST_REACH / strip.length_cm.powi(2)).ln() + start[0];
        }
        bounds
    }

    /// The same within a box.
    ///
    /// Readings that err alike tell less than as many independent ones would. Beside what a probe read they are to count
    /// for what they tell, so that the probe's reading counts more by as much, once that is known.
    pub fn search_within(&self, start: &[f64], bounds: &Bounds) -> Fitted {
        let first = self.search_weighed(start, bounds, 1.0);
        let Some(alike) = self.probed.map(|_| self.err_alike(&first.at)) else {
            return first;
        };
        let found = self.search_weighed(&first.at, bounds, alike);
        Fitted {
            evaluations: first.evaluations + found.evaluations,
            ..found
        }
    }

    /// Variance of R_e by the readings alone, in units of what independent readings would give; 1 at least.
    fn err_alike(&self, at: &[f64]) -> f64 {
        let (noise, slopes) = (self.noise(&self.residuals(at)), self.slopes(at));
        let scattered: Vec<Vec<Vec<f64>>> = slopes.iter().map(|slope| scatter(&noise, slope)).collect();
        let inverse = self.inverse_normal(&slopes);
        let middle = Symmetric::from_fn(slopes.len(), |row, column| {
            product(&slopes[row], &scattered[column])
        });
        let alone = inverse.get(RESISTANCE, RESISTANCE);
        let ratio = inverse.sandwich(&middle).get(RESISTANCE, RESISTANCE) / alone;
        if ratio.is_finite() { ratio.max(1.0) } else { 1.0 }
    }

    /// The minimum with a probe's reading that counts `weight` times, and its covariance.
    fn search_weighed(&self, start: &[f64], bounds: &Bounds, weight: f64) -> Fitted {
        let n = self.parameters;
        let weighed = Weighed {
            problem: self,
            weight,
        };
        let found = Levenberg::by_region(LIMIT, SETTLED, 0.0).search_within(&weighed, bounds, start);
        let at = found.at;
        let (residuals, slopes) = (self.residuals(&at), self.slopes(&at));
        let noise = self.noise(&residuals);
        let scattered: Vec<Vec<Vec<f64>>> = slopes.iter().map(|slope| scatter(&noise, slope)).collect();
        // The probe errs by what it states: what counts twice as much errs twice as much with it.
        let told = self.told_by_probe(weight * weight);
        let middle = Symmetric::from_fn(n, |row, column| {
            product(&slopes[row], &scattered[column]) + told.get(row, column)
        });
        let inverse = found.local.normal.floored_inverse(LOST_BELOW);
        let covariance = inverse.sandwich(&middle);
        let mut freedom = slopes
            .iter()
            .zip(&scattered)
            .map(|(slope, scattered)| freedom(&noise, slope, scattered, n))
            .fold(f64::INFINITY, f64::min);
        let columns = Columns {
            groups: &self.groups,
            residuals: &residuals,
            slopes: &slopes,
        };
        let places: Vec<f64> = noise.iter().map(ResidualNoise::independent_places).collect();
        let covariance = match columns.left_out(&found.local.normal, &places, LOST_BELOW) {
            Some(left_out) => widened(&covariance, &left_out, &mut freedom),
            None => covariance,
        };
        Fitted {
            square: self.square(&at),
            at,
            inflation: (0..n)
                .map(|k| covariance.get(k, k) / inverse.get(k, k).max(f64::MIN_POSITIVE))
                .collect(),
            covariance,
            freedom,
            stop: found.stop,
            evaluations: found.evaluations,
        }
    }

    /// By how much each group's part in the parameters varies more than independent readings of its noise would let it,
    /// the parameters taken alike; 1 at least.
    pub fn excess(&self, at: &[f64]) -> Vec<f64> {
        let (noise, slopes) = (self.noise(&self.residuals(at)), self.slopes(at));
        let of = |(g, noise): (usize, &ResidualNoise)| {
            let (mut varies, mut would) = (0.0, 0.0);
            for slope in &slopes {
                let all = product(slope, slope).max(f64::MIN_POSITIVE);
                varies += dot(&slope[g], &noise.times(&slope[g])) / all;
                would += square(&slope[g]) / all;
            }
            let excess = varies / would;
            if excess.is_finite() { excess.max(1.0) } else { 1.0 }
        };
        noise.iter().enumerate().map(of).collect()
    }

    /// Noise of every group, as residuals over the noise show it.
    pub fn noise(&self, residuals: &[Vec<f64>]) -> Vec<ResidualNoise> {
        let series: usize = self.groups.iter().map(|group| group.values.len()).sum();
        let terms = self.parameters as f64 / series.max(1) as f64;
        let groups = self.groups.iter().zip(residuals);
        groups
            .map(|(group, residuals)| ResidualNoise::of(residuals, group.time_s.len(), terms))
            .collect()
    }

    /// Derivatives at a place divided by their normal equations: how the minimum moves with the readings.
    pub fn inverse_normal(&self, slopes: &[Vec<Vec<f64>>]) -> Symmetric {
        let entry = |row: usize, column: usize| product(&slopes[row], &slopes[column]);
        Symmetric::from_fn(slopes.len(), entry).floored_inverse(LOST_BELOW)
    }
}

/// A problem whose probe's reading counts `weight` times.
struct Weighed<'p, 'a> {
    problem: &'p StripProblem<'a>,
    weight: f64,
}

impl Problem for Weighed<'_, '_> {
    /// None of its own: they follow from where a search begins.
    fn bounds(&self) -> Bounds {
        Bounds::even(self.problem.parameters, f64::NEG_INFINITY, f64::INFINITY)
    }

    fn local(&self, at: &[f64], most: f64) -> Local {
        let problem = self.problem;
        let (residuals, off) = (problem.residuals(at), problem.off_the_probe(at));
        let square = product(&residuals, &residuals) + self.weight * off * off;
        if square > most {
            return Local::refused(square, at.len());
        }
        let (slopes, told) = (problem.slopes(at), problem.told_by_probe(self.weight));
        let mut descent: Vec<f64> = slopes.iter().map(|slope| product(slope, &residuals)).collect();
        if let Some(probed) = problem.probed {
            descent[RESISTANCE] += self.weight * off / probed.error;
        }
        Local {
            square,
            descent,
            normal: Symmetric::from_fn(at.len(), |row, column| {
                product(&slopes[row], &slopes[column]) + told.get(row, column)
            }),
        }
    }
}

/// Inner product of two columns that stand by group.
pub(super) fn product(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| dot(a, b)).sum()
}

/// The covariance where leaving places out shows no larger one, else that, parameter by parameter; `freedom` is what the
/// variance is known from.
fn widened(covariance: &Symmetric, left_out: &LeftOut, freedom: &mut f64) -> Symmetric {
    let factor = |k: usize| {
        let (noise, shown) = (covariance.get(k, k), left_out.covariance.get(k, k));
        let factor = shown / noise;
        if factor.is_finite() && factor > 1.0 {
            factor
        } else {
            1.0
        }
    };
    let factors: Vec<f64> = (0..covariance.order()).map(factor).collect();
    for factor in &factors {
        let more = 1.0 - factor.recip();
        *freedom = ((1.0 - more).powi(2) / *freedom + more * more / left_out.freedom)
            .recip()
            .min(*freedom);
    }
    Symmetric::from_fn(covariance.order(), |i, j| {
        covariance.get(i, j) * (factors[i] * factors[j]).sqrt()
    })
}

/// Independent readings that the variance along a column is known from (Satterthwaite), of which a fit has taken
/// `parameters`; `scattered` is the covariance of the noise times the column.
pub(super) fn freedom(
    noise: &[ResidualNoise],
    column: &[Vec<f64>],
    scattered: &[Vec<f64>],
    parameters: usize,
) -> f64 {
    let independent: f64 = noise.iter().map(ResidualNoise::independent_readings).sum();
    let by_noise = (independent - parameters as f64).max(1.0);
    let all = product(column, scattered);
    let (mut common, mut known) = (0.0, 0.0);
    for (noise, part) in noise.iter().zip(column) {
        if let Some((scattered, freedom)) = noise.common(part) {
            let variance = dot(part, &scattered);
            common += variance;
            known += variance * variance / freedom;
        }
    }
    if all <= 0.0 {
        return by_noise;
    }
    ((all - common).powi(2) / by_noise + known).recip().min(f64::MAX) * all * all
}

/// The covariance of the noise times a column that stands by group.
pub(super) fn scatter(noise: &[ResidualNoise], column: &[Vec<f64>]) -> Vec<Vec<f64>> {
    noise
        .iter()
        .zip(column)
        .map(|(noise, part)| noise.times(part))
        .collect()
}
