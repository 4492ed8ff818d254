//! Sets of measurements that share parameters, some of which scatter from one set to the next.
//!
//! Of every set a quadratic form says how its sum of squares rises about its own best place. What is shared, and by how much
//! each parameter scatters, then follows in closed form: the sets' own deviations are integrated out, and so is what is
//! shared (restricted maximum likelihood, Patterson and Thompson 1971).

use crate::least_squares::Local;
use crate::sums::dot;
use crate::symmetric::Symmetric;

/// What one set of measurements says of its parameters: how its sum of squares, in variances of the noise, goes with them.
#[derive(Debug, Clone)]
pub struct Form {
    /// J'J.
    pub precision: Symmetric,
    /// Precision times the best place.
    pub pull: Vec<f64>,
    /// Sum of squares at the origin of the coordinates, as this form has it.
    pub at_origin: f64,
}

impl Form {
    /// From the slope of half of the sum of squares at a place.
    pub fn of(at: &[f64], slope: &Local) -> Form {
        let bend = slope.normal.times(at);
        Form {
            at_origin: slope.square + dot(&bend, at) + 2.0 * dot(&slope.descent, at),
            pull: bend.iter().zip(&slope.descent).map(|(b, d)| b + d).collect(),
            precision: slope.normal.clone(),
        }
    }

    /// The most likely deviations of the set from the origin, where parameters scatter about it by these standard deviations.
    pub fn deviations(&self, spreads: &[f64]) -> Vec<f64> {
        let known = Symmetric::from_fn(spreads.len(), |a, b| {
            spreads[a] * spreads[b] * self.precision.get(a, b) + f64::from(u8::from(a == b))
        });
        let pull: Vec<f64> = self
            .pull
            .iter()
            .zip(spreads)
            .map(|(pull, spread)| pull * spread)
            .collect();
        let units = known.solve(&pull, 1e-14);
        units
            .iter()
            .zip(spreads)
            .map(|(unit, spread)| unit * spread)
            .collect()
    }
}

/// What all sets say of the parameters that they share, the deviations of each integrated out.
#[derive(Debug, Clone)]
pub struct Shared {
    /// J'J of what is shared.
    pub precision: Symmetric,
    /// Precision times the best place.
    pub pull: Vec<f64>,
    /// Sum of squares at the origin.
    pub square: f64,
    /// What the deviations' widths cost: the logarithms of their determinants.
    pub log_widths: f64,
}

impl Shared {
    /// Of sets whose parameters scatter by these standard deviations: places of parameters, each with its own. Others do not.
    pub fn of(forms: &[Form], scatter: &[(usize, f64)]) -> Shared {
        let n = forms.first().map_or(0, |form| form.pull.len());
        let mut shared = Shared {
            precision: Symmetric::zero(n),
            pull: vec![0.0; n],
            square: 0.0,
            log_widths: 0.0,
        };
        forms.iter().for_each(|form| shared.add(form, scatter));
        shared
    }

    fn add(&mut self, form: &Form, scatter: &[(usize, f64)]) {
        let own = Symmetric::from_fn(scatter.len(), |a, b| {
            let ((k, of_k), (l, of_l)) = (scatter[a], scatter[b]);
            of_k * of_l * form.precision.get(k, l) + f64::from(u8::from(a == b))
        });
        self.log_widths += own.log_determinant();
        let inverse = own.inverse(1e-14);
        // What deviations that go with `right` take of it.
        let taken = |right: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let scaled: Vec<f64> = scatter.iter().map(|&(l, of_l)| of_l * right(l)).collect();
            let parts = inverse.times(&scaled).into_iter().zip(scatter);
            parts.map(|(part, (_, of_k))| of_k * part).collect()
        };
        let back = |right: &dyn Fn(usize) -> f64, taken: &[f64]| -> f64 {
            scatter.iter().zip(taken).map(|(&(k, _), x)| right(k) * x).sum()
        };
        self.square += form.at_origin - back(&|k| form.pull[k], &taken(&|l| form.pull[l]));
        for column in 0..self.pull.len() {
            let of_column = taken(&|l| form.precision.get(l, column));
            self.pull[column] += form.pull[column] - back(&|k| form.pull[k], &of_column);
            for row in 0..self.pull.len() {
                let left =
                    form.precision.get(row, column) - back(&|k| form.precision.get(k, row), &of_column);
                self.precision.add(row, column, left);
            }
        }
    }

    /// Least sum of squares.
    pub fn least(&self) -> f64 {
        self.square - dot(&self.precision.solve(&self.pull, 1e-14), &self.pull)
    }

    /// Logarithm of the evidence, but for a constant: what is shared is known to `known_before`, a precision, and integrated
    /// out.
    pub fn log_evidence(mut self, known_before: f64) -> f64 {
        for k in 0..self.pull.len() {
            self.precision.add(k, k, known_before);
        }
        -0.5 * self.least() - 0.5 * self.precision.log_determinant() - 0.5 * self.log_widths
    }
}

/// Standard deviation by which a parameter scatters, with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// The most likely one; 0 where none is.
    pub best: f64,
    /// Ends of the profile likelihood's interval; the lower one is 0 where none is as likely, and the upper one is the most
    /// that was looked at where more is.
    pub low: f64,
    /// As `low`.
    pub high: f64,
}

/// A spread below this part of a coordinate is none.
const LEAST: f64 = 1e-4;
/// Where a search begins.
const BEGUN_AT: f64 = 1e-2;
/// Factors by which a search moves, the coarse ones first.
const MOVES: [f64; 4] = [8.0, 2.0, 1.3, 1.05];
/// Rounds with one factor at most.
const ROUNDS: usize = 12;
/// Factor between the places at which a profile is asked.
const PROFILED: f64 = 1.5;
/// Fall of the logarithm of the likelihood at the ends of a 95 % interval: half of the 95 % point of chi squared.
const FALL: f64 = 1.92;

/// The spreads, each at most `most`, that make the forms most likely, where what each family of sets shares is known to
/// `known_before`; and the rise of the logarithm of the likelihood over that of no scatter.
pub fn most_likely(families: &[Vec<Form>], known_before: f64, most: f64) -> (Vec<f64>, f64) {
    let likelihood = Likelihood {
        families,
        known_before,
        most,
    };
    let parameters = parameters(families);
    let none = likelihood.at(&vec![0.0; parameters]);
    let (best, top) = likelihood.climbed(vec![BEGUN_AT.min(most); parameters], None, &MOVES);
    (best.into_iter().map(told).collect(), top - none)
}

/// The same with an interval of each.
pub fn spreads(families: &[Vec<Form>], known_before: f64, most: f64) -> Vec<Spread> {
    let likelihood = Likelihood {
        families,
        known_before,
        most,
    };
    let parameters = parameters(families);
    let (best, top) = likelihood.climbed(vec![BEGUN_AT.min(most); parameters], None, &MOVES);
    let each = (0..parameters).map(|k| Spread {
        best: told(best[k]),
        low: told(likelihood.end(&best, top, k, PROFILED.recip())),
        high: likelihood.end(&best, top, k, PROFILED),
    });
    each.collect()
}

/// Logarithm of the likelihood of those spreads, but for a constant.
pub fn log_likelihood(families: &[Vec<Form>], known_before: f64, spreads: &[f64]) -> f64 {
    let likelihood = Likelihood {
        families,
        known_before,
        most: f64::INFINITY,
    };
    likelihood.at(spreads)
}

fn parameters(families: &[Vec<Form>]) -> usize {
    let first = families.iter().flatten().next();
    first.map_or(0, |form| form.pull.len())
}

fn told(spread: f64) -> f64 {
    if spread > LEAST { spread } else { 0.0 }
}

struct Likelihood<'a> {
    families: &'a [Vec<Form>],
    known_before: f64,
    most: f64,
}

impl Likelihood<'_> {
    fn at(&self, spreads: &[f64]) -> f64 {
        let scatter = spreads.iter().copied().enumerate();
        let scatter: Vec<(usize, f64)> = scatter.filter(|(_, spread)| *spread > 0.0).collect();
        let of_family = |forms: &Vec<Form>| Shared::of(forms, &scatter).log_evidence(self.known_before);
        self.families.iter().map(of_family).sum()
    }

    /// The highest place that moves of one spread after the other reach; that of `held` stays.
    fn climbed(&self, mut at: Vec<f64>, held: Option<usize>, moves: &[f64]) -> (Vec<f64>, f64) {
        let mut top = self.at(&at);
        for factor in moves {
            for _ in 0..ROUNDS {
                let before = top;
                for k in (0..at.len()).filter(|k| Some(*k) != held) {
                    for by in [*factor, factor.recip()] {
                        let mut there = at.clone();
                        there[k] = (at[k] * by).clamp(LEAST.min(self.most), self.most);
                        let found = self.at(&there);
                        if there[k] != at[k] && found > top {
                            (at, top) = (there, found);
                            break;
                        }
                    }
                }
                if top - before < 1e-3 {
                    break;
                }
            }
        }
        (at, top)
    }

    /// Where the profile of spread `k` has fallen, going by `factor` from the best place.
    fn end(&self, best: &[f64], top: f64, k: usize, factor: f64) -> f64 {
        let (mut at, mut last) = (best.to_vec(), top);
        loop {
            let from = at[k];
            at[k] = (from * factor).clamp(LEAST.min(self.most), self.most);
            if at[k] == from {
                return from;
            }
            let found;
            (at, found) = self.climbed(at, Some(k), &MOVES[2..3]);
            if top - found > FALL {
                let part = (last - (top - FALL)) / (last - found);
                return from * (at[k] / from).powf(part.clamp(0.0, 1.0));
            }
            last = found;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn a_form_gives_back_its_sum_of_squares() {
        let mut normal = Symmetric::zero(2);
        for (a, b, value) in [(0, 0, 4.0), (0, 1, 1.0), (1, 0, 1.0), (1, 1, 9.0)] {
            normal.add(a, b, value);
        }
        let slope = Local {
            square: 7.0,
            descent: vec![0.0, -0.5],
            normal: normal.clone(),
        };
        let at = [0.3, -0.2];
        let form = Form::of(&at, &slope);
        let square = |x: [f64; 2]| {
            let (d0, d1) = (x[0] - at[0], x[1] - at[1]);
            7.0 + 1.0 * d1 + normal.form(&[d0, d1], &[d0, d1])
        };
        let by_form = |x: [f64; 2]| {
            let pull: f64 = form.pull.iter().zip(x).map(|(p, x)| p * x).sum();
            form.at_origin - 2.0 * pull + form.precision.form(&x, &x)
        };
        for x in [[0.0, 0.0], [0.3, -0.2], [1.0, 2.0]] {
            assert!((square(x) - by_form(x)).abs() < 1e-9, "{x:?}");
        }
    }

    #[test]
    fn deviations_are_drawn_to_the_origin_by_what_they_scatter_by() {
        let mut slope = Local::zero(2);
        slope.normal.add(0, 0, 0.1_f64.powi(-2));
        slope.normal.add(1, 1, 0.1_f64.powi(-2));
        let found = Form::of(&[0.3, 0.3], &slope).deviations(&[0.1, 0.0]);
        assert!((found[0] - 0.15).abs() < 1e-12 && found[1] == 0.0, "{found:?}");
    }

    /// Sets that know two parameters to `errors`, about 0 with these spreads.
    fn drawn(sets: usize, spreads: [f64; 2], errors: [f64; 2], generator: &mut ChaCha8Rng) -> Vec<Form> {
        let mut normal = |sd: f64| -> f64 {
            let unit: f64 = StandardNormal.sample(generator);
            sd * unit
        };
        let mut of_set = || {
            let at: Vec<f64> = (0..2).map(|k| normal(spreads[k]) + normal(errors[k])).collect();
            let mut slope = Local::zero(2);
            for (k, error) in errors.iter().enumerate() {
                slope.normal.add(k, k, error.powi(-2));
            }
            Form::of(&at, &slope)
        };
        (0..sets).map(|_| of_set()).collect()
    }

    #[test]
    fn intervals_of_spreads_hold_the_truth_and_none_is_found_where_none_is() {
        let mut generator = ChaCha8Rng::seed_from_u64(1);
        let (mut held, mut none, tries) = (0, 0, 200);
        for _ in 0..tries {
            let forms = drawn(6, [0.03, 0.0], [0.005, 0.01], &mut generator);
            let found = spreads(&[forms], 1e-4, 1.0);
            held += usize::from(found[0].low < 0.03 && 0.03 < found[0].high);
            none += usize::from(found[1].low == 0.0);
        }
        assert!((180..=198).contains(&held), "{held} of {tries} intervals hold");
        assert!(none >= 185, "{none} of {tries} allow none where none is");
    }

    #[test]
    fn more_than_the_most_is_seen_to_be_more() {
        let mut generator = ChaCha8Rng::seed_from_u64(2);
        let forms = drawn(5, [0.5, 0.0], [0.01, 0.01], &mut generator);
        let (capped, gain) = most_likely(std::slice::from_ref(&forms), 1e-4, 0.1);
        assert!((capped[0] - 0.1).abs() < 1e-9, "{capped:?}");
        assert!(most_likely(std::slice::from_ref(&forms), 1e-4, 3.0).1 > gain + 10.0);
    }
}
