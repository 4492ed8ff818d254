//! The classical viscoelastic models of thesis figure 9, driven from outside: Kelvin-Voigt, Maxwell, standard
//! linear solid.
//!
//! They are here for comparison. Under a load that is held their strain never falls, so none of them both bends
//! and relaxes back; the thesis's model differs by having its drive inside, in series with the dashpot (14).

/// A classical viscoelastic model of springs (12) and dashpots (13).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ClassicalModel {
    /// Spring and dashpot side by side: `sigma = E eps + eta eps'`.
    KelvinVoigt {
        /// Modulus E of the spring, MPa; positive.
        modulus_mpa: f64,
        /// Viscosity eta of the dashpot, MPa s; positive.
        viscosity_mpa_s: f64,
    },
    /// Spring and dashpot in a row: `eps' = sigma'/E + sigma/eta`.
    Maxwell {
        /// Modulus E of the spring, MPa; positive.
        modulus_mpa: f64,
        /// Viscosity eta of the dashpot, MPa s; positive.
        viscosity_mpa_s: f64,
    },
    /// A spring beside a Maxwell arm: `sigma + (eta/E2) sigma' = E1 eps + eta (1 + E1/E2) eps'`.
    StandardLinearSolid {
        /// Modulus E1 of the lone spring, MPa; positive.
        equilibrium_modulus_mpa: f64,
        /// Modulus E2 of the arm's spring, MPa; positive.
        arm_modulus_mpa: f64,
        /// Viscosity eta of the arm's dashpot, MPa s; positive.
        viscosity_mpa_s: f64,
    },
}

/// A change of the load at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadStep {
    /// When, s.
    pub start_s: f64,
    /// By how much: stress in MPa, or strain.
    pub change: f64,
}

/// Storage and loss modulus under a sinusoidal strain, MPa.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ComplexModulus {
    /// Storage modulus E', MPa.
    pub storage_modulus_mpa: f64,
    /// Loss modulus E'', MPa.
    pub loss_modulus_mpa: f64,
}

impl ComplexModulus {
    /// Loss factor tan delta.
    pub fn loss_factor(&self) -> f64 {
        self.loss_modulus_mpa / self.storage_modulus_mpa
    }
}

impl ClassicalModel {
    /// Strain per stress, 1/MPa, at `elapsed_s` after a stress was put on that is then held (creep).
    pub fn creep_compliance_per_mpa(&self, elapsed_s: f64) -> f64 {
        if elapsed_s < 0.0 {
            return 0.0;
        }
        match *self {
            ClassicalModel::KelvinVoigt {
                modulus_mpa,
                viscosity_mpa_s,
            } => -(-elapsed_s * modulus_mpa / viscosity_mpa_s).exp_m1() / modulus_mpa,
            ClassicalModel::Maxwell {
                modulus_mpa,
                viscosity_mpa_s,
            } => 1.0 / modulus_mpa + elapsed_s / viscosity_mpa_s,
            ClassicalModel::StandardLinearSolid {
                equilibrium_modulus_mpa: e1,
                arm_modulus_mpa: e2,
                viscosity_mpa_s,
            } => {
                let rate = e1 * e2 / ((e1 + e2) * viscosity_mpa_s);
                1.0 / (e1 + e2) - (-rate * elapsed_s).exp_m1() * (e2 / (e1 * (e1 + e2)))
            }
        }
    }

    /// Stress per strain, MPa, at `elapsed_s` after a strain was put on that is then held (stress relaxation).
    ///
    /// The Kelvin-Voigt model answers the jump itself with an impulse (eta times the strain, MPa s), which has no
    /// value at any instant and is not contained.
    pub fn relaxation_modulus_mpa(&self, elapsed_s: f64) -> f64 {
        if elapsed_s < 0.0 {
            return 0.0;
        }
        match *self {
            ClassicalModel::KelvinVoigt { modulus_mpa, .. } => modulus_mpa,
            ClassicalModel::Maxwell {
                modulus_mpa,
                viscosity_mpa_s,
            } => modulus_mpa * (-elapsed_s * modulus_mpa / viscosity_mpa_s).exp(),
            ClassicalModel::StandardLinearSolid {
                equilibrium_modulus_mpa,
                arm_modulus_mpa,
                viscosity_mpa_s,
            } => {
                let rate = arm_modulus_mpa / viscosity_mpa_s;
                equilibrium_modulus_mpa + arm_modulus_mpa * (-rate * elapsed_s).exp()
            }
        }
    }

    /// Strain at each time (s) under stress that changes by steps (MPa), by superposition.
    pub fn strain(&self, stress: &[LoadStep], time_s: &[f64]) -> Vec<f64> {
        superposed(stress, time_s, |elapsed_s| {
            self.creep_compliance_per_mpa(elapsed_s)
        })
    }

    /// Stress, MPa, at each time (s) under strain that changes by steps, by superposition; see
    /// [`ClassicalModel::relaxation_modulus_mpa`] for the impulses of the Kelvin-Voigt model.
    pub fn stress_mpa(&self, strain: &[LoadStep], time_s: &[f64]) -> Vec<f64> {
        superposed(strain, time_s, |elapsed_s| self.relaxation_modulus_mpa(elapsed_s))
    }

    /// Complex modulus at an angular frequency (2 pi f), 1/s: what dynamic mechanical analysis measures.
    pub fn complex_modulus(&self, angular_frequency_per_s: f64) -> ComplexModulus {
        let w = angular_frequency_per_s;
        match *self {
            ClassicalModel::KelvinVoigt {
                modulus_mpa,
                viscosity_mpa_s,
            } => ComplexModulus {
                storage_modulus_mpa: modulus_mpa,
                loss_modulus_mpa: w * viscosity_mpa_s,
            },
            ClassicalModel::Maxwell {
                modulus_mpa,
                viscosity_mpa_s,
            } => maxwell_arm(modulus_mpa, viscosity_mpa_s, w),
            ClassicalModel::StandardLinearSolid {
                equilibrium_modulus_mpa,
                arm_modulus_mpa,
                viscosity_mpa_s,
            } => {
                let mut modulus = maxwell_arm(arm_modulus_mpa, viscosity_mpa_s, w);
                modulus.storage_modulus_mpa += equilibrium_modulus_mpa;
                modulus
            }
        }
    }
}

fn maxwell_arm(modulus_mpa: f64, viscosity_mpa_s: f64, w: f64) -> ComplexModulus {
    let turn = w * viscosity_mpa_s / modulus_mpa;
    let out_of_phase = modulus_mpa * turn / (1.0 + turn * turn);
    ComplexModulus {
        storage_modulus_mpa: turn * out_of_phase,
        loss_modulus_mpa: out_of_phase,
    }
}

fn superposed(steps: &[LoadStep], time_s: &[f64], after: impl Fn(f64) -> f64) -> Vec<f64> {
    let at = |t: &f64| {
        let answers = steps.iter().map(|step| step.change * after(t - step.start_s));
        answers.sum()
    };
    time_s.iter().map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::relaxation::spring_response;
    use ieap_numerics::ode::integrate;

    const MODELS: [ClassicalModel; 3] = [
        ClassicalModel::KelvinVoigt {
            modulus_mpa: 70.0,
            viscosity_mpa_s: 900.0,
        },
        ClassicalModel::Maxwell {
            modulus_mpa: 70.0,
            viscosity_mpa_s: 900.0,
        },
        ClassicalModel::StandardLinearSolid {
            equilibrium_modulus_mpa: 55.0,
            arm_modulus_mpa: 15.0,
            viscosity_mpa_s: 400.0,
        },
    ];

    /// Springs and dashpots themselves: the extension of the model's dashpot is the state. Gives its rate and the
    /// strain under a stress.
    fn under_stress(model: &ClassicalModel, stress: f64, dashpot: f64) -> (f64, f64) {
        match *model {
            ClassicalModel::KelvinVoigt {
                modulus_mpa,
                viscosity_mpa_s,
            } => ((stress - modulus_mpa * dashpot) / viscosity_mpa_s, dashpot),
            ClassicalModel::Maxwell {
                modulus_mpa,
                viscosity_mpa_s,
            } => (stress / viscosity_mpa_s, stress / modulus_mpa + dashpot),
            ClassicalModel::StandardLinearSolid {
                equilibrium_modulus_mpa: e1,
                arm_modulus_mpa: e2,
                viscosity_mpa_s,
            } => {
                let strain = (stress + e2 * dashpot) / (e1 + e2);
                (e2 * (strain - dashpot) / viscosity_mpa_s, strain)
            }
        }
    }

    /// The same under a strain: rate of the dashpot and stress; not for the Kelvin-Voigt model, whose dashpot
    /// takes the strain itself.
    fn under_strain(model: &ClassicalModel, strain: f64, dashpot: f64) -> (f64, f64) {
        match *model {
            ClassicalModel::KelvinVoigt { modulus_mpa, .. } => (0.0, modulus_mpa * strain),
            ClassicalModel::Maxwell {
                modulus_mpa,
                viscosity_mpa_s,
            } => {
                let stress = modulus_mpa * (strain - dashpot);
                (stress / viscosity_mpa_s, stress)
            }
            ClassicalModel::StandardLinearSolid {
                equilibrium_modulus_mpa,
                arm_modulus_mpa,
                viscosity_mpa_s,
            } => {
                let arm = arm_modulus_mpa * (strain - dashpot);
                (arm / viscosity_mpa_s, equilibrium_modulus_mpa * strain + arm)
            }
        }
    }

    /// Response at each time to the stepped load, by integrating the dashpot.
    fn integrated(law: impl Fn(f64, f64) -> (f64, f64), steps: &[LoadStep], time_s: &[f64]) -> Vec<f64> {
        let (mut dashpot, mut now, mut load) = ([0.0], 0.0, 0.0);
        let mut upcoming = steps.iter().peekable();
        let mut answers = Vec::new();
        for &t in time_s {
            while let Some(step) = upcoming.next_if(|step| step.start_s <= t) {
                integrate(
                    |_, d, out| out[0] = law(load, d[0]).0,
                    now,
                    step.start_s,
                    &mut dashpot,
                    1e-12,
                    1e-18,
                );
                (now, load) = (step.start_s, load + step.change);
            }
            integrate(
                |_, d, out| out[0] = law(load, d[0]).0,
                now,
                t,
                &mut dashpot,
                1e-12,
                1e-18,
            );
            now = t;
            answers.push(law(load, dashpot[0]).1);
        }
        answers
    }

    fn loads() -> Vec<LoadStep> {
        [(1.0, 0.4), (20.0, -0.7), (45.0, 0.3)]
            .map(|(start_s, change)| LoadStep { start_s, change })
            .to_vec()
    }

    #[test]
    fn closed_forms_are_the_springs_and_dashpots_under_any_stepped_load() {
        let time_s: Vec<f64> = (0..200).map(|k| 0.5 * f64::from(k)).collect();
        for model in MODELS {
            let pairs = [
                (
                    model.strain(&loads(), &time_s),
                    integrated(|s, d| under_stress(&model, s, d), &loads(), &time_s),
                ),
                (
                    model.stress_mpa(&loads(), &time_s),
                    integrated(|s, d| under_strain(&model, s, d), &loads(), &time_s),
                ),
            ];
            for (closed, stepped) in pairs {
                let scale = closed.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
                assert!(scale > 0.0);
                for (a, b) in closed.iter().zip(stepped) {
                    assert!((a - b).abs() < 1e-9 * scale, "{model:?}: {a} {b}");
                }
            }
        }
    }

    #[test]
    fn complex_modulus_is_the_answer_to_a_sinusoidal_strain() {
        let w = 0.3;
        let period = std::f64::consts::TAU / w;
        for model in MODELS {
            let found = model.complex_modulus(w);
            // The Kelvin-Voigt dashpot feels the strain's rate directly; the others through their state.
            let direct = match model {
                ClassicalModel::KelvinVoigt { viscosity_mpa_s, .. } => viscosity_mpa_s,
                _ => 0.0,
            };
            let start = 40.0 * period;
            let rate = |t: f64, y: &[f64], out: &mut [f64]| {
                let (dashpot, stress) = under_strain(&model, (w * t).sin(), y[0]);
                let stress = stress + direct * w * (w * t).cos();
                let weight = if t >= start { 2.0 / period } else { 0.0 };
                out.copy_from_slice(&[
                    dashpot,
                    weight * stress * (w * t).sin(),
                    weight * stress * (w * t).cos(),
                ]);
            };
            let mut state = [0.0; 3];
            integrate(rate, 0.0, start, &mut state, 1e-10, 1e-14);
            (state[1], state[2]) = (0.0, 0.0);
            integrate(rate, start, start + period, &mut state, 1e-10, 1e-14);
            assert!(
                (found.storage_modulus_mpa / state[1] - 1.0).abs() < 1e-7,
                "{model:?} {found:?} {state:?}"
            );
            assert!(
                (found.loss_modulus_mpa / state[2] - 1.0).abs() < 1e-7,
                "{model:?} {found:?} {state:?}"
            );
            assert!((found.loss_factor() / (state[2] / state[1]) - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn none_of_them_bends_and_relaxes_back_under_a_held_drive() {
        let time_s: Vec<f64> = (0..2000).map(|k| 0.1 * f64::from(k)).collect();
        let held = [LoadStep {
            start_s: 0.0,
            change: 1.0,
        }];
        for model in MODELS {
            let strain = model.strain(&held, &time_s);
            assert!(strain.windows(2).all(|pair| pair[1] >= pair[0]), "{model:?}");
            let stress = model.stress_mpa(&held, &time_s);
            assert!(stress.windows(2).all(|pair| pair[1] <= pair[0]), "{model:?}");
        }
        let internal: Vec<f64> = time_s.iter().map(|&t| spring_response(t, 0.5, 0.05)).collect();
        let rises = internal.windows(2).any(|pair| pair[1] > pair[0]);
        let falls = internal.windows(2).any(|pair| pair[1] < pair[0]);
        assert!(rises && falls);
    }
}
