//! Numbers that a fit reports, as functions of the local parameters of a run.

use super::problem::Layout;

/// A reported number. Positive ones are looked at by their logarithm, in which intervals are near to even.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::fit) enum Feature {
    /// ln R_k.
    Resistance(usize),
    /// ln C_k.
    Capacitance(usize),
    /// ln tau_k.
    TimeConstant(usize),
    /// ln (C_1 + C_2 ..).
    TotalCapacitance,
    /// ln (R_1 || R_2 ..).
    ParallelResistance,
    /// 1/R_ss, S/cm2.
    Steady,
    /// alpha, 1/(C cm).
    Coupling,
    /// lambda, 1/s.
    Rate,
}

impl Feature {
    /// The feature stored under `key` for a circuit of `branches` branches.
    pub(in crate::fit) fn of_key(key: &str, branches: usize) -> Option<Feature> {
        let feature = match key {
            "r1_ohm_cm2" => Feature::Resistance(0),
            "c1_f_per_cm2" => Feature::Capacitance(0),
            "tau1_s" => Feature::TimeConstant(0),
            "r2_ohm_cm2" => Feature::Resistance(1),
            "c2_f_per_cm2" => Feature::Capacitance(1),
            "tau2_s" => Feature::TimeConstant(1),
            "rss_ohm_cm2" => Feature::Steady,
            "c_total_f_per_cm2" => Feature::TotalCapacitance,
            "r_parallel_ohm_cm2" => Feature::ParallelResistance,
            "alpha_per_c_cm" => Feature::Coupling,
            "lambda_per_s" => Feature::Rate,
            _ => return None,
        };
        feature.branch().is_none_or(|k| k < branches).then_some(feature)
    }

    /// Its stored key; none for branches beyond the second.
    pub(in crate::fit) fn key(self) -> Option<&'static str> {
        Some(match self {
            Feature::Resistance(0) => "r1_ohm_cm2",
            Feature::Capacitance(0) => "c1_f_per_cm2",
            Feature::TimeConstant(0) => "tau1_s",
            Feature::Resistance(1) => "r2_ohm_cm2",
            Feature::Capacitance(1) => "c2_f_per_cm2",
            Feature::TimeConstant(1) => "tau2_s",
            Feature::Steady => "rss_ohm_cm2",
            Feature::TotalCapacitance => "c_total_f_per_cm2",
            Feature::ParallelResistance => "r_parallel_ohm_cm2",
            Feature::Coupling => "alpha_per_c_cm",
            Feature::Rate => "lambda_per_s",
            Feature::Resistance(_) | Feature::Capacitance(_) | Feature::TimeConstant(_) => return None,
        })
    }

    /// The branch it belongs to.
    pub(in crate::fit) fn branch(self) -> Option<usize> {
        match self {
            Feature::Resistance(k) | Feature::Capacitance(k) | Feature::TimeConstant(k) => Some(k),
            _ => None,
        }
    }

    /// Whether the current decides it.
    pub(in crate::fit) fn is_electrical(self) -> bool {
        !matches!(self, Feature::Coupling | Feature::Rate)
    }

    /// Whether it is a logarithm.
    pub(in crate::fit) fn is_logarithm(self) -> bool {
        !matches!(self, Feature::Steady | Feature::Coupling | Feature::Rate)
    }

    /// Its value for the local parameters of a run.
    pub(in crate::fit) fn of(self, layout: Layout, local: &[f64]) -> f64 {
        let tau = |k: usize| local[layout.resistance(k)] + local[layout.capacitance(k)];
        let sum = |terms: &dyn Fn(usize) -> f64| (0..layout.branches).map(terms).sum::<f64>();
        match self {
            Feature::Resistance(k) => local[layout.resistance(k)],
            Feature::Capacitance(k) => local[layout.capacitance(k)],
            Feature::TimeConstant(k) => tau(k),
            Feature::TotalCapacitance => sum(&|k| local[layout.capacitance(k)].exp()).ln(),
            Feature::ParallelResistance => -sum(&|k| (-local[layout.resistance(k)]).exp()).ln(),
            Feature::Steady => local[layout.steady()],
            Feature::Coupling => local[layout.coupling()],
            Feature::Rate => local[layout.rate()],
        }
    }
}
