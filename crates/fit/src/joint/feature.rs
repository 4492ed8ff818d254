//! Numbers that a fit reports, as functions of the local parameters of a run.

use ieap_domain::key_named;

use crate::search::MOST_BRANCHES;

use super::layout::Layout;

/// A reported number. Positive ones are looked at by their logarithm, in which intervals are near to even.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Feature {
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

/// How far the lower and the upper end of an interval lie from the value, in half-widths of the covariance's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ends {
    pub(crate) feature: Feature,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Feature {
    /// The feature of that name for a circuit of `branches` branches: its key, or what begins no other (`r1`).
    pub(crate) fn named(name: &str, branches: usize) -> Option<Feature> {
        let keys = Feature::all(branches)
            .filter_map(Feature::key)
            .collect::<Vec<_>>();
        Feature::of_key(key_named(name, keys.into_iter())?, branches)
    }

    /// The feature stored under `key` for a circuit of `branches` branches.
    pub(crate) fn of_key(key: &str, branches: usize) -> Option<Feature> {
        Feature::all(branches).find(|feature| feature.key() == Some(key))
    }

    /// Every feature of a circuit of `branches` branches: of each branch, of all of them, and of the bending.
    pub(crate) fn all(branches: usize) -> impl Iterator<Item = Feature> {
        let of_branch = |k: usize| {
            [
                Feature::Resistance(k),
                Feature::Capacitance(k),
                Feature::TimeConstant(k),
            ]
        };
        (0..branches).flat_map(of_branch).chain([
            Feature::TotalCapacitance,
            Feature::ParallelResistance,
            Feature::Steady,
            Feature::Coupling,
            Feature::Rate,
        ])
    }

    /// Its stored key; none for branches beyond those of any model.
    pub(crate) fn key(self) -> Option<&'static str> {
        const RESISTANCES: [&str; MOST_BRANCHES] = ["r1_ohm_cm2", "r2_ohm_cm2", "r3_ohm_cm2", "r4_ohm_cm2"];
        const CAPACITANCES: [&str; MOST_BRANCHES] =
            ["c1_f_per_cm2", "c2_f_per_cm2", "c3_f_per_cm2", "c4_f_per_cm2"];
        const TIME_CONSTANTS: [&str; MOST_BRANCHES] = ["tau1_s", "tau2_s", "tau3_s", "tau4_s"];
        match self {
            Feature::Resistance(k) => RESISTANCES.get(k).copied(),
            Feature::Capacitance(k) => CAPACITANCES.get(k).copied(),
            Feature::TimeConstant(k) => TIME_CONSTANTS.get(k).copied(),
            Feature::Steady => Some("rss_ohm_cm2"),
            Feature::TotalCapacitance => Some("c_total_f_per_cm2"),
            Feature::ParallelResistance => Some("r_parallel_ohm_cm2"),
            Feature::Coupling => Some("alpha_per_c_cm"),
            Feature::Rate => Some("lambda_per_s"),
        }
    }

    /// The branch it belongs to.
    pub(crate) fn branch(self) -> Option<usize> {
        match self {
            Feature::Resistance(k) | Feature::Capacitance(k) | Feature::TimeConstant(k) => Some(k),
            _ => None,
        }
    }

    /// Whether the current decides it.
    pub(crate) fn is_electrical(self) -> bool {
        !matches!(self, Feature::Coupling | Feature::Rate)
    }

    /// Whether it is a logarithm.
    pub(crate) fn is_logarithm(self) -> bool {
        !matches!(self, Feature::Steady | Feature::Coupling | Feature::Rate)
    }

    /// What is stated under its key where it has that value.
    pub(crate) fn stated(self, value: f64) -> f64 {
        match self {
            Feature::Steady => value.recip(),
            _ if self.is_logarithm() => value.exp(),
            _ => value,
        }
    }

    /// Where it stands among the local parameters; none of what follows from several.
    pub(crate) fn place(self, layout: Layout) -> Option<usize> {
        match self {
            Feature::Resistance(k) => Some(layout.resistance(k)),
            Feature::Capacitance(k) => Some(layout.capacitance(k)),
            Feature::Steady => Some(layout.steady()),
            Feature::Coupling => Some(layout.coupling()),
            Feature::Rate => Some(layout.rate()),
            Feature::TimeConstant(_) | Feature::TotalCapacitance | Feature::ParallelResistance => None,
        }
    }

    /// Its value for the local parameters of a run.
    pub(crate) fn of(self, layout: Layout, local: &[f64]) -> f64 {
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

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_model::fit_models;

    #[test]
    fn every_parameter_of_a_lumped_model_is_a_feature() {
        for model in fit_models().iter().filter(|model| model.id.starts_with("lumped")) {
            let keys: Vec<_> = Feature::all(model.branches)
                .map(|feature| feature.key().unwrap())
                .collect();
            assert_eq!(keys.len(), model.parameters.len());
            for parameter in model.parameters {
                assert!(keys.contains(&parameter.key), "{} {}", model.id, parameter.key);
            }
        }
    }
}
