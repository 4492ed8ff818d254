//! The identified parameters of the lumped model as tables and figures name them.

use ieap_domain::{Estimate, Fit, RunRecord};
use ieap_show::Quantity;

/// How one parameter is named and shown. The stored key carries the unit in which values are kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterInfo {
    /// Stored key, `rss_ohm_cm2`.
    pub key: &'static str,
    /// Symbol, `R_ss`, with plain subscripts: `Rₛₛ`.
    pub symbol: &'static str,
    /// What it is, in words.
    pub name: &'static str,
    /// Unit of the stored value.
    pub unit: &'static str,
    /// Unit in which tables and figures show it.
    pub shown_unit: &'static str,
    /// Shown number per stored number.
    pub shown_factor: f64,
    /// Whether values of one material differ by orders of magnitude, so that an axis must be logarithmic.
    pub spans_decades: bool,
    /// Which response the parameter is identified from: its absence explains a missing value.
    pub needs_curvature: bool,
}

/// Every parameter of the lumped model, the thesis's table 5 first, then the two sums of its figure 26.
pub const PARAMETERS: [ParameterInfo; 9] = [
    electrical("r1_ohm_cm2", "R₁", "resistance of the fast branch", "Ω cm²"),
    electrical("c1_f_per_cm2", "C₁", "capacitance of the fast branch", "F cm⁻²"),
    electrical("r2_ohm_cm2", "R₂", "resistance of the slow branch", "Ω cm²"),
    electrical("c2_f_per_cm2", "C₂", "capacitance of the slow branch", "F cm⁻²"),
    ParameterInfo {
        shown_unit: "kΩ cm²",
        shown_factor: 1e-3,
        spans_decades: true,
        ..electrical("rss_ohm_cm2", "Rₛₛ", "steady-state resistance", "Ω cm²")
    },
    ParameterInfo {
        needs_curvature: true,
        ..electrical("alpha_per_c_cm", "α", "charge-to-curvature coupling", "C⁻¹ cm⁻¹")
    },
    ParameterInfo {
        needs_curvature: true,
        spans_decades: true,
        ..electrical("lambda_per_s", "λ", "back-relaxation rate", "s⁻¹")
    },
    electrical("c_total_f_per_cm2", "C₁ + C₂", "total capacitance", "F cm⁻²"),
    electrical("r_parallel_ohm_cm2", "R₁ ∥ R₂", "charging resistance", "Ω cm²"),
];

/// What the distributed model, lumped models of more branches and fits of bending alone add to them: named on the run's page.
pub const FURTHER: [ParameterInfo; 18] = [
    electrical(
        "re_ohm_per_sq",
        "Rₑ",
        "resistance of the electrodes along the strip",
        "Ω/sq",
    ),
    electrical("rc_ohm_cm2", "R꜀", "resistance across the laminate", "Ω cm²"),
    electrical("c_f_per_cm2", "C", "capacitance across the laminate", "F cm⁻²"),
    ParameterInfo {
        needs_curvature: true,
        ..electrical("mu_per_c", "μ", "curvature per line charge", "C⁻¹")
    },
    electrical("tau_s", "τ", "time constant of a place along the strip", "s"),
    electrical(
        "re_l2_per_rc",
        "RₑL²/R꜀",
        "electrodes over the length against the charging chain",
        "",
    ),
    electrical(
        "re_l2_per_rss",
        "RₑL²/Rₛₛ",
        "electrodes over the length against the steady-state resistance",
        "",
    ),
    electrical("tau1_s", "τ₁", "time constant of the fast branch", "s"),
    electrical("tau2_s", "τ₂", "time constant of the slow branch", "s"),
    electrical("r3_ohm_cm2", "R₃", "resistance of the third branch", "Ω cm²"),
    electrical("c3_f_per_cm2", "C₃", "capacitance of the third branch", "F cm⁻²"),
    electrical("tau3_s", "τ₃", "time constant of the third branch", "s"),
    electrical("r4_ohm_cm2", "R₄", "resistance of the fourth branch", "Ω cm²"),
    electrical("c4_f_per_cm2", "C₄", "capacitance of the fourth branch", "F cm⁻²"),
    electrical("tau4_s", "τ₄", "time constant of the fourth branch", "s"),
    ParameterInfo {
        needs_curvature: true,
        ..electrical(
            "curvature1_per_cm_v",
            "κ₁/V",
            "curvature per volt by the fast branch, before it relaxes",
            "cm⁻¹ V⁻¹",
        )
    },
    ParameterInfo {
        needs_curvature: true,
        ..electrical(
            "curvature2_per_cm_v",
            "κ₂/V",
            "curvature per volt by the slow branch, before it relaxes",
            "cm⁻¹ V⁻¹",
        )
    },
    ParameterInfo {
        needs_curvature: true,
        ..electrical(
            "curvature_total_per_cm_v",
            "κ/V",
            "curvature per volt by all branches, before it relaxes",
            "cm⁻¹ V⁻¹",
        )
    },
];

/// Keys of the parameters that figure 26 of the thesis compares, in this report's order: what bends first.
pub const COMPARED: [&str; 5] = [
    "alpha_per_c_cm",
    "lambda_per_s",
    "c_total_f_per_cm2",
    "r_parallel_ohm_cm2",
    "rss_ohm_cm2",
];

/// Whether `asked` is a key, or its beginning up to a unit: `lambda` of `lambda_per_s`.
pub fn begins_key(key: &str, asked: &str) -> bool {
    key.strip_prefix(asked)
        .is_some_and(|rest| rest.is_empty() || rest.starts_with('_'))
}

impl ParameterInfo {
    /// The parameter stored under `key`; none for a parameter of another model.
    pub fn of(key: &str) -> Option<&'static ParameterInfo> {
        ParameterInfo::all().find(|parameter| parameter.key == key)
    }

    /// Every parameter that has a place in comparisons.
    pub fn all() -> impl Iterator<Item = &'static ParameterInfo> {
        PARAMETERS.iter().chain(&FURTHER)
    }

    /// Whether a person means it: by its key, the beginning of its key, or its symbol.
    pub fn is_called(&self, asked: &str) -> bool {
        self.symbol == asked || begins_key(self.key, asked)
    }

    /// As tables show it.
    pub fn quantity(&self) -> Quantity {
        let stored = Quantity::new(self.key, self.symbol, self.name, self.unit);
        let column = match self.key {
            "rss_ohm_cm2" => "rss_kohm_cm2",
            _ => self.key,
        };
        stored.shown_in(column, self.shown_unit, self.shown_factor)
    }

    /// Unit and shown number per stored number in a list of the parameters of a fit. The distributed model's resistances
    /// are a few Ω cm², also the steady-state one, and stand in one unit as in the thesis's table 3.
    pub fn shown_in(&self, fit: &Fit) -> (&'static str, f64) {
        match fit.parameter("rc_ohm_cm2") {
            Some(_) if self.unit == "Ω cm²" => (self.unit, 1.0),
            _ => (self.shown_unit, self.shown_factor),
        }
    }
}

/// The estimate of a converged fit: what comparisons use. A fit that did not converge says nothing.
pub fn usable<'a>(run: &'a RunRecord, key: &str) -> Option<&'a Estimate> {
    run.fit.as_ref().filter(|fit| fit.converged)?.parameter(key)
}

const fn electrical(
    key: &'static str,
    symbol: &'static str,
    name: &'static str,
    unit: &'static str,
) -> ParameterInfo {
    ParameterInfo {
        key,
        symbol,
        name,
        unit,
        shown_unit: unit,
        shown_factor: 1.0,
        spans_decades: false,
        needs_curvature: false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_compared_parameter_is_known() {
        for key in COMPARED {
            assert!(ParameterInfo::of(key).is_some(), "{key}");
        }
        assert!(ParameterInfo::of("mu_cm_per_c").is_none());
    }

    #[test]
    fn no_parameter_is_listed_twice() {
        let keys = || PARAMETERS.iter().chain(&FURTHER).map(|parameter| parameter.key);
        let different: std::collections::BTreeSet<&str> = keys().collect();
        assert_eq!(different.len(), keys().count());
    }
}
