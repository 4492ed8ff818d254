//! How large the statistics of a diagnosis become by chance: simulated, with the refit and with what the noise's
//! size is not known of.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{ChiSquared, Distribution, StandardNormal};

use ieap_numerics::interrupt;
use ieap_numerics::products::{gram, products};
use ieap_numerics::sums::{dot, mean};

use crate::fitting::tangent::Tangent;
use crate::misfit::calibration::Calibration;
use crate::misfit::mixture::Mixture;
use crate::misfit::policy::{LEAST_OF_BIN, NOISE_KNOWN_PART, RESOLVED_DRAWS, TAIL_PART, WEIGHTS};
use crate::misfit::residual_bins::{Kind, ResidualBin};
use crate::misfit::signature::Direction;
use crate::readings::group::RunGroup;

/// A direction whose part beyond those before it is smaller than this is drawn with them.
const DEPENDENT: f64 = 1e-3;

/// Statistics of residuals.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Statistics {
    /// Logarithm of the ratio of likelihoods with one of the candidates and with none.
    pub(crate) mixture: f64,
    /// Largest forecast gain of any candidate.
    pub(crate) candidate: f64,
    /// Largest square of a bin's mean, in its standard errors.
    pub(crate) bin: f64,
    /// Square of all bins together.
    pub(crate) together: f64,
    /// Sum of the squares of how much more or less than simulated each edge of a drive of many is answered, in standard
    /// errors: what wanders from edge to edge and leaves no mean.
    pub(crate) edge_responses: f64,
    /// Largest line in the periodogram of any channel, in units of its mean.
    pub(crate) line: f64,
}

impl Statistics {
    fn all(&self) -> [f64; 5] {
        [
            self.mixture,
            self.candidate,
            self.bin,
            self.together,
            self.edge_responses,
        ]
    }
}

/// Everything that the residuals are asked, and its distribution where nothing is wrong.
pub(crate) struct Null {
    mixture: Mixture,
    bin_units: Vec<Option<Vec<f64>>>,
    /// Number of units that are of bins; those of answers to edges follow.
    timed_bins: usize,
    /// Bins in the order in which they were found independent.
    pivots: Vec<usize>,
    /// Rows of the factor of the pivots among themselves.
    factor: Vec<Vec<f64>>,
    draws: Vec<Statistics>,
    tails: Vec<Tail>,
    lines: usize,
    smallest_p: Vec<f64>,
}

/// What one draw begins with.
struct Drawn {
    unit: Vec<f64>,
    sizes: Vec<f64>,
    line: f64,
}

impl Null {
    /// Draws `count` sets of statistics.
    pub(crate) fn new(
        group: &RunGroup,
        tangent: &Tangent,
        directions: &[Direction],
        bins: &[ResidualBin],
        count: usize,
        seed: u64,
    ) -> Null {
        let bin_units: Vec<Option<Vec<f64>>> = bins
            .iter()
            .map(|bin| unit_of(bin, group.rows(), tangent))
            .collect();
        let mut columns: Vec<&[f64]> = bin_units.iter().flatten().map(Vec::as_slice).collect();
        let whole = columns.len();
        let is_edge_response = |(bin, unit): &(&ResidualBin, &Option<Vec<f64>>)| {
            unit.is_some() && bin.kind == Kind::EdgeResponse
        };
        let timed_bins = whole - bins.iter().zip(&bin_units).filter(is_edge_response).count();
        columns.extend(directions.iter().map(|direction| direction.unit.as_slice()));
        let (factor, pivots, from_bins) = pivoted(&columns, timed_bins);
        let shares: Vec<Vec<f64>> = columns.iter().map(|column| shares(group, column)).collect();
        let freedoms: Vec<f64> = group
            .blocks
            .iter()
            .map(|block| {
                group
                    .channel(block)
                    .map_or(1e6, |channel| NOISE_KNOWN_PART * channel.freedom())
            })
            .collect();
        let lines: usize = group
            .blocks
            .iter()
            .map(|block| frequencies(block.end - block.first).count())
            .sum();
        let mixture = Mixture::of(directions);
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        let mut gains = vec![0.0; directions.len()];
        // The same numbers in the same order whatever is made of them.
        let drawn: Vec<Drawn> = (0..count)
            .map(|_| Drawn {
                unit: pivots
                    .iter()
                    .map(|_| StandardNormal.sample(&mut generator))
                    .collect(),
                sizes: freedoms
                    .iter()
                    .map(|&nu| size_factor(nu, &mut generator))
                    .collect(),
                line: chance_line(lines, &mut generator),
            })
            .collect();
        let rows: Vec<&[f64]> = factor.iter().map(Vec::as_slice).collect();
        let units: Vec<&[f64]> = drawn.iter().map(|own| own.unit.as_slice()).collect();
        let scores = products(&units, &rows);
        let draws = drawn
            .iter()
            .zip(&scores)
            .map(|(Drawn { unit, sizes, line }, scores)| {
                interrupt::check();
                let square = |k: usize| (scores[k], scores[k] * scores[k] * dot(&shares[k], sizes));
                let mut found = Statistics::default();
                for k in 0..timed_bins {
                    found.bin = found.bin.max(square(k).1);
                }
                found.edge_responses = (timed_bins..whole).map(|k| square(k).1).sum();
                for (k, (direction, own)) in directions.iter().zip(&mut gains).enumerate() {
                    let (z, gain) = square(whole + k);
                    *own = if z > 0.0 || !direction.one_sided {
                        gain
                    } else {
                        0.0
                    };
                }
                found.candidate = largest(&gains);
                found.mixture = mixture.log_ratio(&gains);
                let of_pivot = |(&pivot, x): (&usize, &f64)| x * x * dot(&shares[pivot], sizes);
                found.together = pivots[..from_bins].iter().zip(unit).map(of_pivot).sum();
                found.line = *line;
                found
            })
            .collect::<Vec<Statistics>>();
        let rows = pivots[..from_bins]
            .iter()
            .map(|&pivot| factor[pivot].clone())
            .collect();
        let mut null = Null {
            mixture,
            bin_units,
            timed_bins,
            pivots: pivots[..from_bins].to_vec(),
            factor: rows,
            tails: (0..5)
                .map(|k| Tail::of(draws.iter().map(|draw| draw.all()[k]).collect()))
                .collect(),
            draws,
            lines,
            smallest_p: Vec::new(),
        };
        null.smallest_p = null.draws.iter().map(|draw| null.weighted_p(draw)).collect();
        null.smallest_p.sort_unstable_by(f64::total_cmp);
        null
    }

    /// Statistics of refitted residuals.
    pub(crate) fn observe(
        &self,
        group: &RunGroup,
        residuals: &[f64],
        directions: &[Direction],
    ) -> Statistics {
        let means: Vec<f64> = self
            .bin_units
            .iter()
            .flatten()
            .map(|unit| dot(unit, residuals))
            .collect();
        let gains: Vec<f64> = directions
            .iter()
            .map(|direction| direction.gain(residuals))
            .collect();
        let line = group
            .blocks
            .iter()
            .map(|b| largest_line(&residuals[b.first..b.end]))
            .fold(0.0, f64::max);
        self.statistics(&means, &gains, line)
    }

    /// From the means of the bins that are used, in their standard errors, and the gain of every direction.
    fn statistics(&self, means: &[f64], gains: &[f64], line: f64) -> Statistics {
        let mut solved: Vec<f64> = Vec::with_capacity(self.pivots.len());
        for (&pivot, row) in self.pivots.iter().zip(&self.factor) {
            let known = dot(&row[..solved.len()], &solved);
            solved.push((means[pivot] - known) / row[solved.len()]);
        }
        let (bins, edge_responses) = means.split_at(self.timed_bins);
        Statistics {
            mixture: self.mixture.log_ratio(gains),
            candidate: largest(gains),
            bin: bins.iter().map(|z| z * z).fold(0.0, f64::max),
            together: dot(&solved, &solved),
            edge_responses: dot(edge_responses, edge_responses),
            line,
        }
    }

    /// Whether each bin is used; a refit takes up the others.
    pub(crate) fn uses_bin(&self) -> impl Iterator<Item = bool> {
        self.bin_units.iter().map(Option::is_some)
    }

    /// The p of simulated readings: means of the used bins, and the gain of every direction. Lines of the
    /// periodogram do not depend on what is found of the noise, and are drawn.
    pub(crate) fn p_of_simulated(&self, means: &[f64], gains: &[f64], generator: &mut ChaCha8Rng) -> f64 {
        let line = chance_line(self.lines, generator);
        self.unbounded_p(&self.statistics(means, gains, line))
    }

    /// Mean of every bin in its standard errors, 0 where a refit takes it up.
    pub(crate) fn bin_scores(&self, residuals: &[f64]) -> Vec<f64> {
        let score = |unit: &Option<Vec<f64>>| unit.as_ref().map_or(0.0, |unit| dot(unit, residuals));
        self.bin_units.iter().map(score).collect()
    }

    /// Probability of residuals at least as bad by chance, by the smallest weighted p of the statistics, read as the
    /// calibration says. It is never smaller than the draws can tell.
    pub(crate) fn p_misfit(&self, observed: &Statistics, calibration: Option<&Calibration>) -> f64 {
        let read = self.p_beyond_draws(observed, calibration);
        read.max(1.0 / (1 + self.draws.len()) as f64)
    }

    /// The same going on below what the draws can tell as the statistics' own tails do: for where several p are taken
    /// together.
    pub(crate) fn p_beyond_draws(&self, observed: &Statistics, calibration: Option<&Calibration>) -> f64 {
        let own = self.unbounded_p(observed);
        let read = calibration.map_or(own, |calibration| calibration.calibrated(own));
        read.clamp(0.0, 1.0)
    }

    /// The same before it is calibrated, going on below what the draws can tell as the statistics' own tails do.
    pub(crate) fn unbounded_p(&self, observed: &Statistics) -> f64 {
        let own = self.weighted_p(observed);
        let below = self.smallest_p.partition_point(|p| *p <= own);
        let all = self.smallest_p.len();
        if below >= RESOLVED_DRAWS.min(all) {
            return (1 + below) as f64 / (1 + all) as f64;
        }
        let from = self.smallest_p[RESOLVED_DRAWS.min(all) - 1];
        (1 + RESOLVED_DRAWS) as f64 / (1 + all) as f64 * (own / from).min(1.0)
    }

    fn weighted_p(&self, of: &Statistics) -> f64 {
        let by_draws = self.tails.iter().zip(of.all()).map(|(tail, own)| tail.p(own));
        let by_line = 1.0 - (1.0 - (-of.line).exp()).powi(self.lines as i32);
        let weighted = by_draws
            .chain([by_line])
            .zip(WEIGHTS)
            .map(|(p, weight)| p / weight);
        weighted.fold(f64::INFINITY, f64::min)
    }
}

/// Distribution of a statistic: by its draws, and beyond most of them by their exponential tail.
struct Tail {
    sorted: Vec<f64>,
    from: f64,
    mean_excess: f64,
}

impl Tail {
    fn of(mut draws: Vec<f64>) -> Tail {
        draws.sort_unstable_by(f64::total_cmp);
        let first = draws.len() - (draws.len() as f64 * TAIL_PART) as usize;
        let from = draws.get(first.saturating_sub(1)).copied().unwrap_or(0.0);
        let excess: Vec<f64> = draws[first..].iter().map(|x| x - from).collect();
        Tail {
            sorted: draws,
            from,
            mean_excess: mean(&excess).max(f64::MIN_POSITIVE),
        }
    }

    fn p(&self, value: f64) -> f64 {
        if value > self.from {
            return TAIL_PART * (-(value - self.from) / self.mean_excess).exp();
        }
        let above = self.sorted.len() - self.sorted.partition_point(|x| *x < value);
        (1 + above) as f64 / (1 + self.sorted.len()) as f64
    }
}

fn largest(gains: &[f64]) -> f64 {
    gains.iter().copied().fold(0.0, f64::max)
}

/// True variance over the one that was found, as far as the latter is uncertain.
fn size_factor(freedom: f64, generator: &mut ChaCha8Rng) -> f64 {
    let nu = freedom.max(4.0);
    ChiSquared::new(nu).map_or(1.0, |chi| nu / chi.sample(generator).max(1e-3 * nu))
}

/// Numbers of cycles over the record that are looked at: slower ones are trends, faster ones the noise's own.
fn frequencies(readings: usize) -> std::ops::Range<usize> {
    2..(readings / 4).clamp(2, 64)
}

/// Largest ordinate of the periodogram of white residuals, whose mean is 1 where nothing is wrong.
fn largest_line(residuals: &[f64]) -> f64 {
    let n = residuals.len();
    let ordinate = |cycles: usize| {
        let turn = std::f64::consts::TAU * cycles as f64 / n as f64;
        let (mut sine, mut cosine) = (0.0, 0.0);
        for (k, r) in residuals.iter().enumerate() {
            let (s, c) = (turn * k as f64).sin_cos();
            sine += r * s;
            cosine += r * c;
        }
        (sine * sine + cosine * cosine) / n as f64
    };
    frequencies(n).map(ordinate).fold(0.0, f64::max)
}

/// The largest of so many ordinates by chance: each is exponential.
fn chance_line(count: usize, generator: &mut ChaCha8Rng) -> f64 {
    let uniform: f64 = rand::RngExt::random_range(generator, 0.0..1.0);
    if count == 0 {
        0.0
    } else {
        -(-(uniform.ln() / count as f64).exp_m1()).ln()
    }
}

/// Share of a unit column's square in every block.
fn shares(group: &RunGroup, column: &[f64]) -> Vec<f64> {
    group
        .blocks
        .iter()
        .map(|block| dot(&column[block.first..block.end], &column[block.first..block.end]))
        .collect()
}

fn unit_of(bin: &ResidualBin, rows: usize, tangent: &Tangent) -> Option<Vec<f64>> {
    let mut unit = vec![0.0; rows];
    for (&row, weight) in bin.rows.iter().zip(&bin.weights) {
        unit[row] = *weight;
    }
    tangent.remove(&mut unit);
    let norm = dot(&unit, &unit).sqrt();
    (norm > LEAST_OF_BIN).then(|| {
        unit.iter_mut().for_each(|v| *v /= norm);
        unit
    })
}

/// Lower factor of the columns' products, row by row in the columns' order, by pivoted elimination: first among the
/// first `first` columns, then among the rest. Gives also the pivots and how many come from the first.
fn pivoted(columns: &[&[f64]], first: usize) -> (Vec<Vec<f64>>, Vec<usize>, usize) {
    let products = gram(columns);
    let mut factor: Vec<Vec<f64>> = vec![Vec::new(); columns.len()];
    let mut left: Vec<f64> = (0..columns.len()).map(|k| products[k][k]).collect();
    let mut pivots = Vec::new();
    let mut from_first = 0;
    for (range, is_first) in [(0..first, true), (first..columns.len(), false)] {
        while let Some(pivot) = range
            .clone()
            .max_by(|&a, &b| left[a].total_cmp(&left[b]))
            .filter(|&k| left[k] > DEPENDENT)
        {
            let root = left[pivot].sqrt();
            let rank = pivots.len();
            let row = factor[pivot].clone();
            for k in 0..columns.len() {
                let value = if pivots.contains(&k) {
                    0.0
                } else if k == pivot {
                    root
                } else {
                    (products[k][pivot] - dot(&factor[k][..rank], &row[..rank])) / root
                };
                factor[k].push(value);
                left[k] -= value * value;
            }
            left[pivot] = f64::NEG_INFINITY;
            pivots.push(pivot);
            from_first += usize::from(is_first);
        }
    }
    (factor, pivots, from_first)
}
