//! How parameters move when neighbouring places are left out (the jackknife).
//!
//! What a place gets wrong at all times alike does not average down over the times, and need not look like any noise: a
//! tracer rounds off a steep bend, and most so while the strip is charging. It differs from place to place, so that
//! leaving places out shows it. Neighbours err alike and are left out together.

use ieap_numerics::symmetric::Symmetric;

use super::policy::{FEWEST_BLOCKS, MOST_BLOCKS};
use super::readings::SeriesGroup;

/// Covariance of parameters as leaving places out shows it.
pub(super) struct LeftOut {
    /// The covariance.
    pub covariance: Symmetric,
    /// Independent moves that it is known from.
    pub freedom: f64,
}

/// Residuals and slopes by group, one series after the other.
pub(super) struct Columns<'a> {
    pub groups: &'a [&'a SeriesGroup],
    pub residuals: &'a [Vec<f64>],
    pub slopes: &'a [Vec<Vec<f64>>],
}

impl Columns<'_> {
    /// Leaves blocks of places out of every group that has enough of them; none where no group has.
    ///
    /// `normal` are the normal equations of all readings, `places` how many places of each group err independently.
    pub fn left_out(&self, normal: &Symmetric, places: &[f64], floor: f64) -> Option<LeftOut> {
        let order = normal.order();
        let mut covariance = Symmetric::zero(order);
        let mut freedom = 0.0;
        for (g, group) in self.groups.iter().enumerate() {
            let count = group.values.len();
            if count < FEWEST_BLOCKS {
                continue;
            }
            let blocks = (places[g].round() as usize).clamp(FEWEST_BLOCKS, MOST_BLOCKS.min(count));
            let weight = (blocks - 1) as f64 / blocks as f64;
            for block in 0..blocks {
                let (from, to) = (block * count / blocks, (block + 1) * count / blocks);
                let moved = self.without(g, from..to, normal, floor);
                covariance =
                    Symmetric::from_fn(order, |i, j| covariance.get(i, j) + weight * moved[i] * moved[j]);
            }
            freedom += (blocks - 1) as f64;
        }
        (freedom > 0.0).then_some(LeftOut { covariance, freedom })
    }

    /// How the minimum moves without those places of a group.
    fn without(
        &self,
        group: usize,
        places: std::ops::Range<usize>,
        normal: &Symmetric,
        floor: f64,
    ) -> Vec<f64> {
        let times = self.groups[group].time_s.len();
        let range = places.start * times..places.end * times;
        let part = |column: &[f64], other: &[f64]| -> f64 {
            ieap_numerics::sums::dot(&column[range.clone()], &other[range.clone()])
        };
        let order = normal.order();
        let slope = |k: usize| &self.slopes[k][group];
        let rest = Symmetric::from_fn(order, |i, j| normal.get(i, j) - part(slope(i), slope(j)));
        let gone: Vec<f64> = (0..order)
            .map(|k| -part(slope(k), &self.residuals[group]))
            .collect();
        rest.floored_inverse(floor).times(&gone)
    }
}
