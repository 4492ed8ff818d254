//! The parameters that models identify, each said once: key, symbols, words, and how numbers are shown. Lists of models, tables,
//! pages and sentences have them from here.

use crate::unit_of_key::{printed_unit, unit_of_key};

/// Another unit than the stored one, in which people read numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplayUnit {
    /// Unit in which tables and figures show it.
    pub unit: &'static str,
    /// Shown number per stored number.
    pub factor: f64,
}

/// How one parameter is named and shown. Its key ends in the unit in which values are kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterInfo {
    /// Stored key, `rss_ohm_cm2`.
    pub key: &'static str,
    /// Symbol in ASCII, as documents and terminals spell it: `R_ss`.
    pub ascii: &'static str,
    /// Symbol, with plain subscripts: `Rₛₛ`.
    pub symbol: &'static str,
    /// What it is, in words.
    pub name: &'static str,
    /// In which unit tables and figures show it; none: as it is stored.
    pub display: Option<DisplayUnit>,
    /// Whether values of one material differ by orders of magnitude, so that an axis must be logarithmic.
    pub spans_decades: bool,
}

/// Unit of large resistances.
const KILO_OHM: DisplayUnit = DisplayUnit {
    unit: "kΩ cm²",
    factor: 1e-3,
};

/// Unit of the capacitance across a laminate, as in the thesis's table 3.
const MILLI_FARAD: DisplayUnit = DisplayUnit {
    unit: "mF cm⁻²",
    factor: 1e3,
};

/// Every parameter of the lumped model, the thesis's table 5 first, then the two sums of its figure 26.
pub const PARAMETERS: [ParameterInfo; 9] = [R1, C1, R2, C2, RSS, ALPHA, LAMBDA, C_TOTAL, R_PARALLEL];

/// What the distributed model, lumped models of more branches, fits of bending alone and rival laws of bending add to them.
pub const FURTHER: [ParameterInfo; 29] = [
    RE,
    RC,
    C,
    MU,
    TAU,
    RE_PER_RC,
    RE_PER_RSS,
    TAU1,
    TAU2,
    R3,
    C3,
    TAU3,
    R4,
    C4,
    TAU4,
    CURVATURE1,
    CURVATURE2,
    CURVATURE_TOTAL,
    K1,
    K2,
    TRANSPORT,
    KEPT,
    ALPHA_FIRST,
    ALPHA_FINAL,
    RETARDATION,
    FLOW,
    E1_PER_E0,
    E2_PER_E0,
    STIFFENING,
];

const fn shown(
    key: &'static str,
    ascii: &'static str,
    symbol: &'static str,
    name: &'static str,
) -> ParameterInfo {
    ParameterInfo {
        key,
        ascii,
        symbol,
        name,
        display: None,
        spans_decades: false,
    }
}

/// Resistance of the fast branch.
pub const R1: ParameterInfo = shown("r1_ohm_cm2", "R1", "R₁", "resistance of the fast branch");
/// Capacitance of the fast branch.
pub const C1: ParameterInfo = shown("c1_f_per_cm2", "C1", "C₁", "capacitance of the fast branch");
/// Resistance of the slow branch.
pub const R2: ParameterInfo = shown("r2_ohm_cm2", "R2", "R₂", "resistance of the slow branch");
/// Capacitance of the slow branch.
pub const C2: ParameterInfo = shown("c2_f_per_cm2", "C2", "C₂", "capacitance of the slow branch");
/// Steady-state resistance.
pub const RSS: ParameterInfo = ParameterInfo {
    display: Some(KILO_OHM),
    spans_decades: true,
    ..shown("rss_ohm_cm2", "R_ss", "Rₛₛ", "steady-state resistance")
};
/// Charge-to-curvature coupling.
pub const ALPHA: ParameterInfo = shown("alpha_per_c_cm", "alpha", "α", "charge-to-curvature coupling");
/// Back-relaxation rate.
pub const LAMBDA: ParameterInfo = ParameterInfo {
    spans_decades: true,
    ..shown("lambda_per_s", "lambda", "λ", "back-relaxation rate")
};
/// Total capacitance.
pub const C_TOTAL: ParameterInfo = shown("c_total_f_per_cm2", "C1+C2", "C₁ + C₂", "total capacitance");
/// Charging resistance.
pub const R_PARALLEL: ParameterInfo = shown("r_parallel_ohm_cm2", "R1||R2", "R₁ ∥ R₂", "charging resistance");
/// Resistance of the electrodes along the strip.
pub const RE: ParameterInfo = shown(
    "re_ohm_per_sq",
    "R_e",
    "Rₑ",
    "resistance of the electrodes along the strip",
);
/// Resistance across the laminate.
pub const RC: ParameterInfo = shown("rc_ohm_cm2", "R_c", "R꜀", "resistance across the laminate");
/// Capacitance across the laminate.
pub const C: ParameterInfo = ParameterInfo {
    display: Some(MILLI_FARAD),
    ..shown("c_f_per_cm2", "C", "C", "capacitance across the laminate")
};
/// Curvature per line charge.
pub const MU: ParameterInfo = shown("mu_per_c", "mu", "μ", "curvature per line charge");
/// Time constant of a place along the strip.
pub const TAU: ParameterInfo = shown("tau_s", "tau", "τ", "time constant of a place along the strip");
/// Electrodes over the length against the charging chain.
pub const RE_PER_RC: ParameterInfo = shown(
    "re_l2_per_rc",
    "Re L2/Rc",
    "RₑL²/R꜀",
    "electrodes over the length against the charging chain",
);
/// Electrodes over the length against the steady-state resistance.
pub const RE_PER_RSS: ParameterInfo = shown(
    "re_l2_per_rss",
    "Re L2/Rss",
    "RₑL²/Rₛₛ",
    "electrodes over the length against the steady-state resistance",
);
/// Time constant of the fast branch.
pub const TAU1: ParameterInfo = shown("tau1_s", "tau1", "τ₁", "time constant of the fast branch");
/// Time constant of the slow branch.
pub const TAU2: ParameterInfo = shown("tau2_s", "tau2", "τ₂", "time constant of the slow branch");
/// Resistance of the third branch.
pub const R3: ParameterInfo = shown("r3_ohm_cm2", "R3", "R₃", "resistance of the third branch");
/// Capacitance of the third branch.
pub const C3: ParameterInfo = shown("c3_f_per_cm2", "C3", "C₃", "capacitance of the third branch");
/// Time constant of the third branch.
pub const TAU3: ParameterInfo = shown("tau3_s", "tau3", "τ₃", "time constant of the third branch");
/// Resistance of the fourth branch.
pub const R4: ParameterInfo = shown("r4_ohm_cm2", "R4", "R₄", "resistance of the fourth branch");
/// Capacitance of the fourth branch.
pub const C4: ParameterInfo = shown("c4_f_per_cm2", "C4", "C₄", "capacitance of the fourth branch");
/// Time constant of the fourth branch.
pub const TAU4: ParameterInfo = shown("tau4_s", "tau4", "τ₄", "time constant of the fourth branch");
/// Curvature per volt by the fast branch, before it relaxes.
pub const CURVATURE1: ParameterInfo = shown(
    "curvature1_per_cm_v",
    "kappa1/V",
    "κ₁/V",
    "curvature per volt by the fast branch, before it relaxes",
);
/// Curvature per volt by the slow branch, before it relaxes.
pub const CURVATURE2: ParameterInfo = shown(
    "curvature2_per_cm_v",
    "kappa2/V",
    "κ₂/V",
    "curvature per volt by the slow branch, before it relaxes",
);
/// Curvature per volt by all branches, before it relaxes.
pub const CURVATURE_TOTAL: ParameterInfo = shown(
    "curvature_total_per_cm_v",
    "kappa/V",
    "κ/V",
    "curvature per volt by all branches, before it relaxes",
);
/// Curvature per charge of the forward bending.
pub const K1: ParameterInfo = shown(
    "k1_per_c_cm",
    "K1",
    "K₁",
    "curvature per charge of the forward bending",
);
/// Curvature per charge in equilibrium.
pub const K2: ParameterInfo = shown("k2_per_c_cm", "K2", "K₂", "curvature per charge in equilibrium");
/// Time constant of what flows back (tau_2 of equation 2).
pub const TRANSPORT: ParameterInfo = shown(
    "transport_s",
    "tau_back",
    "τ_back",
    "time constant of what flows back (tau_2 of equation 2)",
);
/// Part of the forward bending that stays in the end.
pub const KEPT: ParameterInfo = shown(
    "kept_part",
    "K2/K1",
    "K₂/K₁",
    "part of the forward bending that stays in the end",
);
/// Curvature per charge at once.
pub const ALPHA_FIRST: ParameterInfo = shown(
    "alpha_first_per_c_cm",
    "alpha_0",
    "α₀",
    "curvature per charge at once",
);
/// Curvature per charge in the end.
pub const ALPHA_FINAL: ParameterInfo = shown(
    "alpha_final_per_c_cm",
    "alpha_inf",
    "α_∞",
    "curvature per charge in the end",
);
/// Time constant with which the strip creeps to its final bending.
pub const RETARDATION: ParameterInfo = shown(
    "retardation_s",
    "tau_ret",
    "τ_ret",
    "time constant with which the strip creeps to its final bending",
);
/// Rate at which the strip flows on, per bending at once.
pub const FLOW: ParameterInfo = shown(
    "flow_rate_per_s",
    "E/eta",
    "E/η",
    "rate at which the strip flows on, per bending at once",
);
/// Growth of the modulus after the step, per final modulus.
pub const E1_PER_E0: ParameterInfo = shown(
    "e1_per_e0_per_s",
    "E1/E0",
    "E₁/E₀",
    "growth of the modulus after the step, per final modulus",
);
/// What the modulus has beyond the final one at the step, per final modulus.
pub const E2_PER_E0: ParameterInfo = shown(
    "e2_per_e0",
    "E2/E0",
    "E₂/E₀",
    "what the modulus has beyond the final one at the step, per final modulus",
);
/// Rate at which the change of the modulus dies away (lambda of equation 1).
pub const STIFFENING: ParameterInfo = shown(
    "stiffening_rate_per_s",
    "lambda_E",
    "λ_E",
    "rate at which the change of the modulus dies away (lambda of equation 1)",
);

impl ParameterInfo {
    /// The parameter stored under `key`; none for one of an effect.
    pub fn of(key: &str) -> Option<&'static ParameterInfo> {
        ParameterInfo::all().find(|parameter| parameter.key == key)
    }

    /// Every parameter of a model.
    pub fn all() -> impl Iterator<Item = &'static ParameterInfo> {
        PARAMETERS.iter().chain(&FURTHER)
    }

    /// Unit of the stored value in ASCII, as documents have it; empty of a pure number.
    pub fn ascii_unit(&self) -> &'static str {
        unit_of_key(self.key).unwrap_or_default()
    }

    /// Unit of the stored value, as pages and tables write it.
    pub fn unit(&self) -> &'static str {
        printed_unit(self.ascii_unit())
    }

    /// Unit in which tables and figures show it.
    pub fn shown_unit(&self) -> &'static str {
        self.display.map_or_else(|| self.unit(), |own| own.unit)
    }

    /// Shown number per stored number.
    pub fn shown_factor(&self) -> f64 {
        self.display.map_or(1.0, |own| own.factor)
    }

    /// Whether a person means it: by its key, the beginning of its key, or its symbol.
    pub fn is_called(&self, asked: &str) -> bool {
        [self.symbol, self.ascii].contains(&asked) || begins_key(self.key, asked)
    }
}

/// Whether `asked` is a key, or its beginning up to a unit: `lambda` of `lambda_per_s`.
pub fn begins_key(key: &str, asked: &str) -> bool {
    key.strip_prefix(asked)
        .is_some_and(|rest| rest.is_empty() || rest.starts_with('_'))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn no_parameter_is_listed_twice() {
        let names: [fn(&'static ParameterInfo) -> &'static str; 3] =
            [|own| own.key, |own| own.ascii, |own| own.symbol];
        for name in names {
            let different: BTreeSet<&str> = ParameterInfo::all().map(name).collect();
            assert_eq!(different.len(), ParameterInfo::all().count(), "{different:?}");
        }
    }

    #[test]
    fn a_parameter_is_in_the_unit_that_its_key_ends_in() {
        let rss = ParameterInfo::of("rss_ohm_cm2").unwrap();
        assert_eq!(
            (rss.ascii_unit(), rss.unit(), rss.shown_unit()),
            ("Ohm cm2", "Ω cm²", "kΩ cm²")
        );
        let pure: Vec<&str> = ParameterInfo::all()
            .filter(|own| own.unit().is_empty())
            .map(|own| own.key)
            .collect();
        assert_eq!(pure, ["re_l2_per_rc", "re_l2_per_rss", "kept_part", "e2_per_e0"]);
    }

    #[test]
    fn a_parameter_is_called_by_key_and_symbol() {
        let lambda = ParameterInfo::of("lambda_per_s").unwrap();
        for name in ["lambda_per_s", "lambda", "λ"] {
            assert!(lambda.is_called(name), "{name}");
        }
        assert!(!lambda.is_called("lamb"));
    }
}
