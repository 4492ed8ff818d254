//! The models a run can be fitted with: the one list of their ids and parameters.

use ieap_domain::parameters;
use ieap_domain::{ParameterInfo, unit_of_key};

/// A parameter as it stands in a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ParameterDescription {
    /// Stored key with the unit in it, `r1_ohm_cm2`.
    pub key: &'static str,
    /// The thesis's symbol, in ASCII.
    pub symbol: &'static str,
    /// What it is, in one line.
    pub meaning: &'static str,
    /// Whether it follows from other parameters of the list.
    pub derived: bool,
    /// The law of the model that it is, `resistance`; empty where none.
    pub law: &'static str,
}

impl ParameterDescription {
    /// Unit as documents print it; empty of a pure number.
    pub fn unit(&self) -> &'static str {
        unit_of_key(self.key).unwrap_or_default()
    }
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

const fn fitted(info: ParameterInfo) -> ParameterDescription {
    of_law("", info)
}

const fn of_law(law: &'static str, info: ParameterInfo) -> ParameterDescription {
    ParameterDescription {
        key: info.key,
        symbol: info.ascii,
        meaning: info.name,
        derived: false,
        law,
    }
}

const fn derived(info: ParameterInfo) -> ParameterDescription {
    ParameterDescription {
        derived: true,
        ..of_law("", info)
    }
}

const R1: ParameterDescription = of_law("resistance", parameters::R1);
const C1: ParameterDescription = of_law("capacitance", parameters::C1);
const R2: ParameterDescription = of_law("resistance", parameters::R2);
const C2: ParameterDescription = of_law("capacitance", parameters::C2);
const R3: ParameterDescription = of_law("resistance", parameters::R3);
const C3: ParameterDescription = of_law("capacitance", parameters::C3);
const R4: ParameterDescription = of_law("resistance", parameters::R4);
const C4: ParameterDescription = of_law("capacitance", parameters::C4);
const RSS: ParameterDescription = of_law("leak", parameters::RSS);
const ALPHA: ParameterDescription = of_law("coupling", parameters::ALPHA);
const LAMBDA: ParameterDescription = of_law("relaxation", parameters::LAMBDA);
const C_TOTAL: ParameterDescription = derived(parameters::C_TOTAL);
const R_PARALLEL: ParameterDescription = derived(parameters::R_PARALLEL);
const TAU1: ParameterDescription = derived(parameters::TAU1);
const TAU2: ParameterDescription = derived(parameters::TAU2);
const TAU3: ParameterDescription = derived(parameters::TAU3);
const TAU4: ParameterDescription = derived(parameters::TAU4);

const RE: ParameterDescription = fitted(parameters::RE);
const RC: ParameterDescription = of_law("resistance", parameters::RC);
const C: ParameterDescription = of_law("capacitance", parameters::C);
const MU: ParameterDescription = fitted(parameters::MU);
const ALPHA_OF_MU: ParameterDescription = ParameterDescription {
    derived: true,
    ..ALPHA
};
const TAU_ALONG: ParameterDescription = derived(parameters::TAU);
const RE_PER_RC: ParameterDescription = derived(parameters::RE_PER_RC);
const RE_PER_RSS: ParameterDescription = derived(parameters::RE_PER_RSS);

const K1: ParameterDescription = fitted(parameters::K1);
const K2: ParameterDescription = fitted(parameters::K2);
const TRANSPORT: ParameterDescription = fitted(parameters::TRANSPORT);
const KEPT: ParameterDescription = derived(parameters::KEPT);
const ALPHA_FIRST: ParameterDescription = fitted(parameters::ALPHA_FIRST);
const ALPHA_FINAL: ParameterDescription = fitted(parameters::ALPHA_FINAL);
const RETARDATION: ParameterDescription = fitted(parameters::RETARDATION);
const FLOW: ParameterDescription = fitted(parameters::FLOW);
const E1_PER_E0: ParameterDescription = fitted(parameters::E1_PER_E0);
const E2_PER_E0: ParameterDescription = fitted(parameters::E2_PER_E0);
const STIFFENING: ParameterDescription = fitted(parameters::STIFFENING);

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
