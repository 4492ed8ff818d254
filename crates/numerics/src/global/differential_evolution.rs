//! Differential evolution (Storn and Price 1997), the method of the thesis: a population of places, each
//! challenged by a mixture of others. It uses sums of squares only, no derivatives.

use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{Effort, Landscape, Method};
use crate::interrupt;
use crate::least_squares::{Bounds, Minimum, Stop};

/// Strategy `rand/1/bin` with dither: the mixing factor is drawn anew for every generation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DifferentialEvolution {
    /// Places per coordinate.
    pub places_per_coordinate: usize,
    /// Least and largest mixing factor.
    pub mixing: (f64, f64),
    /// Probability that a coordinate is taken from the mixture.
    pub crossover: f64,
    /// Generations allowed.
    pub generations: u64,
}

impl DifferentialEvolution {
    /// Settings for the one or two coordinates of a fit.
    pub const STANDARD: DifferentialEvolution = DifferentialEvolution {
        places_per_coordinate: 12,
        mixing: (0.4, 0.9),
        crossover: 0.9,
        generations: 400,
    };
}

/// A place with its sum of squares.
#[derive(Debug, Clone)]
struct Member {
    at: Vec<f64>,
    square: f64,
}

impl Method for DifferentialEvolution {
    fn id(&self) -> &'static str {
        "differential-evolution"
    }

    fn name(&self) -> &'static str {
        "differential evolution"
    }

    fn description(&self) -> &'static str {
        "population search without derivatives (rand/1/bin, seeded), linear parameters eliminated; the thesis's method"
    }

    fn is_random(&self) -> bool {
        true
    }

    fn minimise(&self, landscape: &dyn Landscape, effort: Effort) -> Minimum {
        let bounds = landscape.bounds();
        let mut random = ChaCha8Rng::seed_from_u64(effort.seed);
        let mut evaluations = 0;
        let mut judge = |at: Vec<f64>| {
            interrupt::check();
            evaluations += 1;
            let square = landscape.square(&at);
            let square = if square.is_finite() { square } else { f64::INFINITY };
            Member { at, square }
        };
        let count = (self.places_per_coordinate * bounds.count()).max(5);
        let mut population: Vec<Member> = (spread(&bounds, count, &mut random).into_iter())
            .map(&mut judge)
            .collect();
        let mut stop = Stop::EvaluationLimit;
        for _ in 0..self.generations {
            if settled(&population, effort.settle, landscape.size()) {
                stop = Stop::Converged;
                break;
            }
            let factor = random.random_range(self.mixing.0..=self.mixing.1);
            let challengers: Vec<Vec<f64>> = (0..count)
                .map(|k| self.challenger(&population, k, factor, &bounds, &mut random))
                .collect();
            for (member, at) in population.iter_mut().zip(challengers) {
                let challenger = judge(at);
                if challenger.square <= member.square {
                    *member = challenger;
                }
            }
        }
        let best = population
            .into_iter()
            .min_by(|a, b| a.square.total_cmp(&b.square));
        let at = best.map_or_else(|| bounds.middle(), |best| best.at);
        let local = landscape.local(&at, f64::INFINITY);
        if !local.square.is_finite() {
            stop = Stop::NotFinite;
        }
        Minimum {
            at,
            local,
            evaluations: evaluations + 1,
            stop,
        }
    }
}

impl DifferentialEvolution {
    /// A mixture of three other members, crossed with member `k`.
    fn challenger(
        &self,
        population: &[Member],
        k: usize,
        factor: f64,
        bounds: &Bounds,
        random: &mut impl Rng,
    ) -> Vec<f64> {
        let mut others = [k; 4];
        for chosen in 1..4 {
            others[chosen] = loop {
                let other = random.random_range(0..population.len());
                if !others[..chosen].contains(&other) {
                    break other;
                }
            };
        }
        let [_, base, plus, minus] = others.map(|other| &population[other].at);
        let always = random.random_range(0..bounds.count());
        let mut at = population[k].at.clone();
        for c in 0..bounds.count() {
            if c != always && !random.random_bool(self.crossover) {
                continue;
            }
            let mixed = base[c] + factor * (plus[c] - minus[c]);
            // A mixture outside goes half way from its base to the limit, so that no limit attracts.
            at[c] = if mixed < bounds.low[c] {
                0.5 * (base[c] + bounds.low[c])
            } else if mixed > bounds.high[c] {
                0.5 * (base[c] + bounds.high[c])
            } else {
                mixed
            };
        }
        at
    }
}

/// Places spread over the box so that each coordinate has one in every slice (Latin hypercube).
fn spread(bounds: &Bounds, count: usize, random: &mut impl Rng) -> Vec<Vec<f64>> {
    let mut places = vec![vec![0.0; bounds.count()]; count];
    for (c, (low, high)) in bounds.low.iter().zip(&bounds.high).enumerate() {
        let mut slices: Vec<usize> = (0..count).collect();
        for k in (1..count).rev() {
            slices.swap(k, random.random_range(0..=k));
        }
        for (place, slice) in places.iter_mut().zip(slices) {
            let part = (slice as f64 + random.random::<f64>()) / count as f64;
            place[c] = low + (high - low) * part;
        }
    }
    places
}

/// Whether all members have the same sum of squares up to the part `settle` of the least, or up to the rounding
/// that residuals of measured values of that size leave.
fn settled(population: &[Member], settle: f64, size: f64) -> bool {
    let squares = population.iter().map(|member| member.square);
    let least = squares.clone().fold(f64::INFINITY, f64::min);
    let largest = squares.fold(f64::NEG_INFINITY, f64::max);
    let rounding = 4.0 * f64::EPSILON * ((least * size).sqrt() + f64::EPSILON * size);
    largest - least <= (settle * least).max(rounding) || least == f64::INFINITY
}
