//! The models a run can be fitted with: the one list of their ids, parameters and units.

/// What is known of a parameter before any fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ParameterDescription {
    /// Stored key with the unit in it, `r1_ohm_cm2`.
    pub key: &'static str,
    /// The thesis's symbol.
    pub symbol: &'static str,
    /// Unit as printed.
    pub unit: &'static str,
    /// What it is, in one line.
    pub meaning: &'static str,
    /// Whether it follows from other parameters of the list.
    pub derived: bool,
    /// The law of the model that it is, `resistance`; empty where none.
    pub law: &'static str,
}

/// A model that runs can be fitted with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FitModel {
    /// Stored id, `lumped-2`.
    pub id: &'static str,
    /// Version of the equations and of their identification; a change makes earlier fits out of date.
    pub version: u32,
    /// Number of R-C branches.
    pub branches: usize,
    /// What it describes, in one line.
    pub description: &'static str,
    /// Parameters in the order of a fit, derived ones last.
    pub parameters: &'static [ParameterDescription],
}

const fn fitted(
    key: &'static str,
    symbol: &'static str,
    unit: &'static str,
    meaning: &'static str,
) -> ParameterDescription {
    ParameterDescription {
        key,
        symbol,
        unit,
        meaning,
        derived: false,
        law: "",
    }
}

const fn of_law(law: &'static str, mut description: ParameterDescription) -> ParameterDescription {
    description.law = law;
    description
}

const fn resistance(key: &'static str, symbol: &'static str, meaning: &'static str) -> ParameterDescription {
    of_law("resistance", fitted(key, symbol, "Ohm cm2", meaning))
}

const fn capacitance(key: &'static str, symbol: &'static str, meaning: &'static str) -> ParameterDescription {
    of_law("capacitance", fitted(key, symbol, "F/cm2", meaning))
}

const fn time(key: &'static str, symbol: &'static str, meaning: &'static str) -> ParameterDescription {
    derived(fitted(key, symbol, "s", meaning))
}

const fn derived(mut description: ParameterDescription) -> ParameterDescription {
    description.derived = true;
    description
}

const R1: ParameterDescription = resistance("r1_ohm_cm2", "R1", "resistance of the fastest branch");
const C1: ParameterDescription = capacitance("c1_f_per_cm2", "C1", "capacitance of the fastest branch");
const R2: ParameterDescription = resistance("r2_ohm_cm2", "R2", "resistance of the slower branch");
const C2: ParameterDescription = capacitance("c2_f_per_cm2", "C2", "capacitance of the slower branch");
const R3: ParameterDescription = resistance("r3_ohm_cm2", "R3", "resistance of the third branch");
const C3: ParameterDescription = capacitance("c3_f_per_cm2", "C3", "capacitance of the third branch");
const R4: ParameterDescription = resistance("r4_ohm_cm2", "R4", "resistance of the fourth branch");
const C4: ParameterDescription = capacitance("c4_f_per_cm2", "C4", "capacitance of the fourth branch");
const RSS: ParameterDescription = of_law(
    "leak",
    fitted(
        "rss_ohm_cm2",
        "R_ss",
        "Ohm cm2",
        "steady-state resistance: carries the current that never decays",
    ),
);
const ALPHA: ParameterDescription = of_law(
    "coupling",
    fitted(
        "alpha_per_c_cm",
        "alpha",
        "1/(C cm)",
        "curvature per charge of the whole sample",
    ),
);
const LAMBDA: ParameterDescription = of_law(
    "relaxation",
    fitted("lambda_per_s", "lambda", "1/s", "rate of back-relaxation"),
);
const C_TOTAL: ParameterDescription = derived(fitted(
    "c_total_f_per_cm2",
    "C1+C2",
    "F/cm2",
    "total capacitance: sets the final charge",
));
const R_PARALLEL: ParameterDescription = derived(fitted(
    "r_parallel_ohm_cm2",
    "R1||R2",
    "Ohm cm2",
    "branch resistances in parallel: set the first charging current",
));

const RE: ParameterDescription = fitted(
    "re_ohm_per_sq",
    "R_e",
    "Ohm/sq",
    "resistance of both electrodes along the strip",
);
const RC: ParameterDescription =
    resistance("rc_ohm_cm2", "R_c", "resistance of the chain across the laminate");
const C: ParameterDescription =
    capacitance("c_f_per_cm2", "C", "capacitance of the chain across the laminate");
const MU: ParameterDescription = fitted(
    "mu_per_c",
    "mu",
    "1/C",
    "curvature per charge of unit length of the strip",
);
const ALPHA_OF_MU: ParameterDescription = derived(ALPHA);
const TAU_ALONG: ParameterDescription = time(
    "tau_s",
    "tau",
    "time constant Rc C of a place whose voltage is held",
);
const RE_PER_RC: ParameterDescription = derived(fitted(
    "re_l2_per_rc",
    "Re L2/Rc",
    "",
    "resistance of the electrodes over the length against that of the chain across the laminate",
));
const RE_PER_RSS: ParameterDescription = derived(fitted(
    "re_l2_per_rss",
    "Re L2/Rss",
    "",
    "resistance of the electrodes over the length against the steady-state one across the laminate",
));

const TAU1: ParameterDescription = time("tau1_s", "tau1", "time constant R1 C1 of the fastest branch");
const TAU2: ParameterDescription = time("tau2_s", "tau2", "time constant R2 C2 of the slower branch");

const TAU3: ParameterDescription = time("tau3_s", "tau3", "time constant R3 C3 of the third branch");
const TAU4: ParameterDescription = time("tau4_s", "tau4", "time constant R4 C4 of the fourth branch");

const K1: ParameterDescription = fitted(
    "k1_per_c_cm",
    "K1",
    "1/(C cm)",
    "curvature per charge of the forward bending",
);
const K2: ParameterDescription = fitted(
    "k2_per_c_cm",
    "K2",
    "1/(C cm)",
    "curvature per charge in equilibrium",
);
const TRANSPORT: ParameterDescription = fitted(
    "transport_s",
    "tau_back",
    "s",
    "time constant of what flows back (tau_2 of equation 2)",
);
const KEPT: ParameterDescription = derived(fitted(
    "kept_part",
    "K2/K1",
    "",
    "part of the forward bending that stays in the end",
));
const ALPHA_FIRST: ParameterDescription = fitted(
    "alpha_first_per_c_cm",
    "alpha_0",
    "1/(C cm)",
    "curvature per charge at once",
);
const ALPHA_FINAL: ParameterDescription = fitted(
    "alpha_final_per_c_cm",
    "alpha_inf",
    "1/(C cm)",
    "curvature per charge in the end",
);
const RETARDATION: ParameterDescription = fitted(
    "retardation_s",
    "tau_ret",
    "s",
    "time constant with which the strip creeps to its final bending",
);
const FLOW: ParameterDescription = fitted(
    "flow_rate_per_s",
    "E/eta",
    "1/s",
    "rate at which the strip flows on, per bending at once",
);
const E1_PER_E0: ParameterDescription = fitted(
    "e1_per_e0_per_s",
    "E1/E0",
    "1/s",
    "growth of the modulus after the step, per final modulus",
);
const E2_PER_E0: ParameterDescription = fitted(
    "e2_per_e0",
    "E2/E0",
    "",
    "what the modulus has beyond the final one at the step, per final modulus",
);
const STIFFENING: ParameterDescription = fitted(
    "stiffening_rate_per_s",
    "lambda_E",
    "1/s",
    "rate at which the change of the modulus dies away (lambda of equation 1)",
);

static MODELS: [FitModel; 10] = [
    FitModel {
        id: "lumped-1",
        version: 12,
        branches: 1,
        description: "one R-C branch beside the steady-state resistor, with back-relaxation (thin electrodes)",
        parameters: &[R1, C1, RSS, ALPHA, LAMBDA, C_TOTAL, R_PARALLEL, TAU1],
    },
    FitModel {
        id: "lumped-2",
        version: 12,
        branches: 2,
        description: "two R-C branches beside the steady-state resistor, with back-relaxation (thick electrodes)",
        parameters: &[
            R1, C1, R2, C2, RSS, ALPHA, LAMBDA, C_TOTAL, R_PARALLEL, TAU1, TAU2,
        ],
    },
    FitModel {
        id: "lumped-3",
        version: 10,
        branches: 3,
        description: "up to three R-C branches beside the steady-state resistor, with back-relaxation; as many as the current shows",
        parameters: &[
            R1, C1, R2, C2, R3, C3, RSS, ALPHA, LAMBDA, C_TOTAL, R_PARALLEL, TAU1, TAU2, TAU3,
        ],
    },
    FitModel {
        id: "lumped-4",
        version: 10,
        branches: 4,
        description: "up to four R-C branches beside the steady-state resistor, with back-relaxation; as many as the current shows",
        parameters: &[
            R1, C1, R2, C2, R3, C3, R4, C4, RSS, ALPHA, LAMBDA, C_TOTAL, R_PARALLEL, TAU1, TAU2, TAU3, TAU4,
        ],
    },
    FitModel {
        id: "distributed",
        version: 8,
        branches: 1,
        description: "one R-C branch beside R_ss between electrodes that resist along the strip; needs a current, or voltages or curvatures along it",
        parameters: &[
            RE,
            RC,
            C,
            RSS,
            MU,
            LAMBDA,
            ALPHA_OF_MU,
            TAU_ALONG,
            RE_PER_RC,
            RE_PER_RSS,
        ],
    },
    FitModel {
        id: "yagasaki-tamagawa",
        version: 7,
        branches: 2,
        description: "the circuit of lumped-2, and a strip whose modulus changes with the time since the step",
        parameters: &[
            R1,
            C1,
            R2,
            C2,
            RSS,
            ALPHA_FINAL,
            E1_PER_E0,
            E2_PER_E0,
            STIFFENING,
            C_TOTAL,
            R_PARALLEL,
            TAU1,
            TAU2,
        ],
    },
    FitModel {
        id: "bao-two-way",
        version: 7,
        branches: 2,
        description: "the circuit of lumped-2, and bending of which a part flows back and a part stays",
        parameters: &[
            R1, C1, R2, C2, RSS, K1, K2, TRANSPORT, C_TOTAL, R_PARALLEL, TAU1, TAU2, KEPT,
        ],
    },
    FitModel {
        id: "kelvin-voigt",
        version: 7,
        branches: 2,
        description: "the circuit of lumped-2, and a strip that follows its charge late (spring beside dashpot)",
        parameters: &[
            R1,
            C1,
            R2,
            C2,
            RSS,
            ALPHA_FINAL,
            RETARDATION,
            C_TOTAL,
            R_PARALLEL,
            TAU1,
            TAU2,
        ],
    },
    FitModel {
        id: "maxwell",
        version: 7,
        branches: 2,
        description: "the circuit of lumped-2, and a strip that flows on under its charge (spring and dashpot in a row)",
        parameters: &[
            R1,
            C1,
            R2,
            C2,
            RSS,
            ALPHA_FIRST,
            FLOW,
            C_TOTAL,
            R_PARALLEL,
            TAU1,
            TAU2,
        ],
    },
    FitModel {
        id: "standard-linear-solid",
        version: 7,
        branches: 2,
        description: "the circuit of lumped-2, and a strip that creeps on under its charge (spring beside a Maxwell arm)",
        parameters: &[
            R1,
            C1,
            R2,
            C2,
            RSS,
            ALPHA_FIRST,
            ALPHA_FINAL,
            RETARDATION,
            C_TOTAL,
            R_PARALLEL,
            TAU1,
            TAU2,
        ],
    },
];

/// Every model, in the order in which lists show them.
pub fn fit_models() -> &'static [FitModel] {
    &MODELS
}

/// The model of that id.
pub fn fit_model(id: &str) -> Option<&'static FitModel> {
    MODELS.iter().find(|model| model.id == id)
}

/// The law of the model that a parameter of that key is.
pub fn law_of_parameter(key: &str) -> Option<&'static str> {
    let mut all = MODELS.iter().flat_map(|model| model.parameters);
    all.find(|of| of.key == key).map(|of| of.law)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_and_keys_are_unique() {
        for (k, model) in fit_models().iter().enumerate() {
            assert!(fit_models()[..k].iter().all(|other| other.id != model.id));
            for (j, parameter) in model.parameters.iter().enumerate() {
                assert!(
                    model.parameters[..j]
                        .iter()
                        .all(|other| other.key != parameter.key)
                );
            }
            assert_eq!(fit_model(model.id), Some(model));
        }
    }
}
