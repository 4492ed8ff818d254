//! Whether the covariance tells the 95 % intervals, or how far the sum of squares bends away from its parabola.

use ieap_domain::Drive;
use ieap_numerics::gram::{CAPACITY, Gram};
use ieap_numerics::least_squares::Local;
use ieap_numerics::symmetric::Symmetric;

use super::bending::Bending;
use super::circuit::Circuit;
use super::electrical::Electrical;
use super::joint::feature::{Ends, Feature};
use super::sampled::Sampled;
use crate::policy::{BENT_PART, BRANCH_CLEAR, LOST_BELOW, NARROW_PART, WIDE_PART};

/// Whether the covariance may tell the intervals: the branches are there without doubt and none lies at a limit.
/// Where one branch is found and more are allowed, a second one may hide, which must be looked at.
pub(super) fn is_settled(electrical: &Electrical, bending: Option<&Bending>, branches: usize) -> bool {
    let n = electrical.conductances_a_per_v.len();
    let bends = |bending: &Bending| {
        let error = bending.covariance.error(0);
        bending.residuals.quantile * error <= NARROW_PART * bending.coupling_per_c_cm.abs()
    };
    (n == branches || n >= 2)
        && !electrical.in_doubt
        && electrical.at_bound.iter().all(Option::is_none)
        && bending.is_none_or(|bending| !bending.shown.is_response() || bends(bending))
}

/// Whether every interval of a conductance or a time constant is so narrow that the covariance tells it.
pub(super) fn is_narrow(electrical: &Electrical) -> bool {
    widest(electrical) <= NARROW_PART
}

fn widest(electrical: &Electrical) -> f64 {
    let n = electrical.conductances_a_per_v.len();
    let half = |k: usize| electrical.residuals.quantile * electrical.covariance.error(k);
    (0..n).map(|k| half(k).max(half(n + 1 + k))).fold(0.0, f64::max)
}

/// Ends of the intervals that are not narrow, from the rise of the sum of squares there; none where it bends too
/// far, and the likelihood must be followed.
pub(super) fn ends(drive: &Drive, sampled: &Sampled, electrical: &Electrical) -> Option<Vec<Ends>> {
    // A branch that was only just taken is coloured by having been taken.
    let clear =
        electrical.conductances_a_per_v.len() < 2 || electrical.gain.is_some_and(|gain| gain >= BRANCH_CLEAR);
    if widest(electrical) > WIDE_PART || !clear || electrical.steady_a_per_v <= 0.0 {
        return None;
    }
    Bowl::of(drive, sampled, electrical)?.ends(electrical)
}

/// The sum of squares of the current about its minimum, over what stands for the readings.
struct Bowl<'a> {
    drive: &'a Drive,
    compressed: Sampled,
    /// Conductances, steady conductance, logarithms of the time constants, offset where one is fitted.
    bottom: Vec<f64>,
    branches: usize,
    there: Local,
    inverse: Symmetric,
}

impl<'a> Bowl<'a> {
    fn of(drive: &'a Drive, sampled: &Sampled, electrical: &Electrical) -> Option<Bowl<'a>> {
        // The separable columns are the whole response only where the source never lets go.
        if super::coupled::is_coupled(drive) {
            return None;
        }
        let mut bottom: Vec<f64> = electrical.conductances_a_per_v.iter().map(|c| c.ln()).collect();
        bottom.push(electrical.steady_a_per_v);
        bottom.extend(electrical.time_constants_s.iter().map(|tau_s| tau_s.ln()));
        bottom.extend(electrical.offset_a);
        let mut bowl = Bowl {
            drive,
            compressed: sampled.compressed(),
            branches: electrical.conductances_a_per_v.len(),
            there: Local::zero(bottom.len()),
            inverse: Symmetric::zero(bottom.len()),
            bottom,
        };
        bowl.there = bowl.local(&bowl.bottom);
        bowl.inverse = bowl.there.normal.floored_inverse(LOST_BELOW);
        Some(bowl)
    }

    /// Sum of squares at a place, with its slope.
    fn local(&self, at: &[f64]) -> Local {
        let n = self.branches;
        let circuit = Circuit {
            drive: self.drive,
            sampled: &self.compressed,
            with_offset: at.len() > 2 * n + 1,
        };
        // Derivatives by the logarithm of a conductance and of its time constant are columns times the conductance.
        let mut scales = [1.0; CAPACITY];
        for k in 0..n {
            scales[k] = at[k].exp();
            scales[n + 1 + k] = scales[k];
        }
        let mut gram = Gram::new(at.len());
        circuit.each_block(&at[n + 1..=2 * n], |block, columns, values| {
            let mut left = *values;
            for (k, column) in columns.iter().enumerate() {
                let coefficient = match k {
                    _ if k < n => scales[k],
                    _ if k == n || k > 2 * n => at[k],
                    _ => continue,
                };
                for (left, value) in left.iter_mut().zip(column) {
                    *left -= coefficient * value;
                }
            }
            gram.add_first(block.len, columns, &left);
        });
        Local {
            square: gram.square,
            descent: (0..at.len()).map(|k| scales[k] * gram.right[k]).collect(),
            normal: Symmetric::from_fn(at.len(), |row, column| {
                scales[row] * scales[column] * gram.matrix.get(row, column)
            }),
        }
    }

    /// The ends of every interval that is not narrow.
    fn ends(&self, electrical: &Electrical) -> Option<Vec<Ends>> {
        let mut found = Vec::new();
        for feature in Feature::all(self.branches) {
            let Some(gradient) = self.gradient(feature) else {
                continue;
            };
            let error = electrical.covariance.error_along(&gradient);
            let half = electrical.residuals.quantile * error;
            if half > NARROW_PART {
                found.push(Ends {
                    feature,
                    low: self.stretch(&gradient, -half)?,
                    high: self.stretch(&gradient, half)?,
                });
            }
        }
        Some(found)
    }

    /// Derivatives of the logarithm of a feature of the branches.
    fn gradient(&self, feature: Feature) -> Option<[f64; CAPACITY]> {
        let n = self.branches;
        let mut gradient = [0.0; CAPACITY];
        let mut total = |part: &dyn Fn(usize) -> f64, sign: f64, with_time_constants: bool| {
            let sum: f64 = (0..n).map(part).sum();
            for k in 0..n {
                gradient[k] = sign * part(k) / sum;
                gradient[n + 1 + k] = if with_time_constants { gradient[k] } else { 0.0 };
            }
        };
        let conductance = |k: usize| self.bottom[k].exp();
        match feature {
            Feature::TotalCapacitance => {
                total(&|k| (self.bottom[k] + self.bottom[n + 1 + k]).exp(), 1.0, true)
            }
            Feature::ParallelResistance => total(&conductance, -1.0, false),
            Feature::Resistance(k) => gradient[k] = -1.0,
            Feature::TimeConstant(k) => gradient[n + 1 + k] = 1.0,
            Feature::Capacitance(k) => {
                gradient[k] = 1.0;
                gradient[n + 1 + k] = 1.0;
            }
            Feature::Steady | Feature::Coupling | Feature::Rate => return None,
        }
        Some(gradient)
    }

    /// The end of the interval in parts of `by`, where the parabola has it: there the least sum of squares with the
    /// parameter of that gradient held is looked at, and the root of its rise goes with the distance.
    ///
    /// The place looked at is where the parabola has its least; one further step along the constraint finds the
    /// least of the true sum. None where the sum bends by more than [`BENT_PART`].
    fn stretch(&self, gradient: &[f64; CAPACITY], by: f64) -> Option<f64> {
        let order = self.bottom.len();
        let along = self.inverse.times(gradient);
        let inner = |a: &[f64], b: &[f64]| (0..order).map(|k| a[k] * b[k]).sum::<f64>();
        let spread = inner(gradient, &along);
        let at: Vec<f64> = (0..order)
            .map(|k| self.bottom[k] + by / spread * along[k])
            .collect();
        if at[self.branches] <= 0.0 {
            return None;
        }
        let there = self.local(&at);
        let inverse = there.normal.floored_inverse(LOST_BELOW);
        let (down, across) = (inverse.times(&there.descent), inverse.times(gradient));
        let held = inner(gradient, &down).powi(2) / inner(gradient, &across);
        let least = there.square - (inner(&there.descent, &down) - held);
        let ratio = ((least - self.there.square).max(0.0) * spread / (by * by)).sqrt();
        ((ratio - 1.0).abs() <= BENT_PART).then(|| ratio.recip())
    }
}
