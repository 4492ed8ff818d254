//! A resistance, a capacitance or the coupling jumps at one instant: cracked foil, slipping clip.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{Coefficients, Law, Now, RunContext, System};

/// See the module.
pub(super) struct ContactBreak;

static ABOUT: About = About {
    id: "contact-break",
    code: "E18",
    summary: "R, capacitance or coupling jumps at one instant (cracked gold foil, slipping clip)",
    equation: "X -> X (1 + j) from t_c on, in one run; X all resistances, all capacitances, or alpha",
    variants: &["resistance", "capacitance", "coupling"],
    parameters: &[
        EffectParameter {
            key: "factor_change",
            symbol: "j",
            unit: "",
            meaning: "relative jump",
        },
        EffectParameter {
            key: "break_time_s",
            symbol: "t_c",
            unit: "s",
            meaning: "instant, from the start of the drive",
        },
        EffectParameter {
            key: "run",
            symbol: "r",
            unit: "",
            meaning: "the run in which it happens, counted from 0 in the group",
        },
    ],
    vanishes: "j = 0",
    signature: "a step in the current with a transient of its own, at one instant of one run",
    twins: &["water-exchange", "resistance-drift"],
    separated_by: "the instant itself is the evidence; a second run after it",
    sources: "crack growth over cycles in electrodes of ionic polymer actuators",
};

/// Instants looked at in every run.
const INSTANTS: usize = 7;

struct Break {
    variant: usize,
    factor: f64,
    at_s: f64,
}

impl Law for Break {
    fn act(&self, now: &Now, _memory: f64, c: &mut Coefficients) {
        if now.clock_s < self.at_s {
            return;
        }
        match self.variant {
            0 => {
                c.resistance_ohm_cm2.iter_mut().for_each(|r| *r *= self.factor);
                c.steady_s_per_cm2 /= self.factor;
            }
            1 => c.capacitance_f_per_cm2.iter_mut().for_each(|c| *c *= self.factor),
            _ => c.coupling_factor *= self.factor,
        }
    }

    fn jumps_at_s(&self) -> Option<f64> {
        Some(self.at_s)
    }
}

impl Equation for ContactBreak {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        if variant == 2 && scale.curvature_per_cm == 0.0 {
            return Search::none();
        }
        let limits = vec![
            Limits::linear(-0.6, 1.5),
            Limits::linear(0.0, scale.longest_s()),
            Limits::held(),
        ];
        let of_run = |(run, &duration_s): (usize, &f64)| {
            let instant = move |k: usize| duration_s * (k as f64 + 0.5) / INSTANTS as f64;
            (0..INSTANTS).map(move |k| vec![0.02, instant(k), run as f64])
        };
        Search {
            limits,
            probes: scale.durations_s.iter().enumerate().flat_map(of_run).collect(),
            absent: 0.0,
        }
    }

    fn acts_in(&self, parameters: &[f64], run: usize) -> bool {
        parameters[2].round() as usize == run
    }

    fn apply(&self, variant: usize, parameters: &[f64], run: &RunContext, system: &mut System) {
        if self.acts_in(parameters, run.index) {
            system.laws.push(Box::new(Break {
                variant,
                factor: 1.0 + parameters[0],
                at_s: parameters[1],
            }));
        }
    }
}
