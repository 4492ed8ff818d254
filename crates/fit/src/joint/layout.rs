//! Where the parameters of a run stand in a joint fit.

use ieap_model::{Branch, LumpedModel};

/// Where the local parameters of one run stand: `[ln R_k.., ln C_k.., 1/R_ss, alpha, lambda, offsets]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Layout {
    pub(crate) branches: usize,
}

impl Layout {
    pub(crate) fn resistance(self, k: usize) -> usize {
        k
    }
    pub(crate) fn capacitance(self, k: usize) -> usize {
        self.branches + k
    }
    pub(crate) fn steady(self) -> usize {
        2 * self.branches
    }
    pub(crate) fn coupling(self) -> usize {
        2 * self.branches + 1
    }
    pub(crate) fn rate(self) -> usize {
        2 * self.branches + 2
    }
    pub(crate) fn current_offset(self) -> usize {
        2 * self.branches + 3
    }
    pub(crate) fn curvature_offset(self) -> usize {
        2 * self.branches + 4
    }
    pub(crate) fn len(self) -> usize {
        2 * self.branches + 5
    }
    /// The model of these local parameters, in their own units.
    pub(crate) fn model(self, local: &[f64]) -> LumpedModel {
        let branch = |k: usize| Branch {
            resistance_ohm_cm2: local[self.resistance(k)].exp(),
            capacitance_f_per_cm2: local[self.capacitance(k)].exp(),
        };
        LumpedModel {
            branches: (0..self.branches).map(branch).collect(),
            steady_state_resistance_ohm_cm2: local[self.steady()].max(0.0).recip(),
            charge_to_curvature_per_c_cm: local[self.coupling()],
            relaxation_rate_per_s: local[self.rate()].max(0.0),
        }
    }
    /// Whether the parameter is stored as its logarithm.
    pub(crate) fn is_logarithm(self, local: usize) -> bool {
        local < 2 * self.branches
    }
}
