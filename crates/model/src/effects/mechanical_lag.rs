//! The motion follows the bending force with a delay of first order: drag.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{Observation, RunContext, System};

/// See the module.
pub(super) struct MechanicalLag;

static ABOUT: About = About {
    id: "mechanical-lag",
    code: "M6",
    summary: "first-order lag of the motion",
    equation: "tau kappa' + kappa = kappa_q",
    variants: &[],
    parameters: &[EffectParameter {
        key: "lag_s",
        symbol: "tau",
        unit: "s",
        meaning: "time constant of the lag",
    }],
    vanishes: "tau = 0",
    signature: "curvature too small just after every edge",
    twins: &["camera-delay", "resonance"],
    separated_by: "a light on the same trigger in the camera's view gives the camera's delay by itself",
    sources: "viscous drag of a cantilever in air",
};

struct Lag {
    time_s: f64,
}

impl Observation for Lag {
    fn observe(&self, clock_s: &[f64], curvature_per_cm: &mut [f64]) {
        lag(self.time_s, clock_s, curvature_per_cm);
    }

    fn resolves_s(&self) -> f64 {
        self.time_s
    }
    /// What it changes is smaller than the curvature that it takes for straight.
    fn finer(&self) -> f64 {
        2.0
    }
}

/// What a lag of first order makes of a curvature: exact where it is a straight line between neighbouring times.
pub(super) fn lag(time_s: f64, clock_s: &[f64], curvature_per_cm: &mut [f64]) {
    let Some(&first) = curvature_per_cm.first() else {
        return;
    };
    let (mut lagged, mut before) = (first, first);
    for (times, kappa) in clock_s.windows(2).zip(&mut curvature_per_cm[1..]) {
        let x = (times[1] - times[0]) / time_s;
        let kept = (-x).exp();
        let ramp = if x > 1e-8 { (1.0 - kept) / x } else { 1.0 };
        let own = *kappa;
        lagged = lagged * kept + before * (ramp - kept) + own * (1.0 - ramp);
        before = own;
        *kappa = lagged;
    }
}

impl Equation for MechanicalLag {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        let (fastest_s, _) = scale.time_constants_s();
        let most = (5.0 * scale.shortest_s).max(2.0 * fastest_s).max(0.5);
        Search::over(0.05 * most, vec![Limits::linear(0.0, most)], &[])
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        if parameters[0] > 0.0 {
            system.observations.push(Box::new(Lag {
                time_s: parameters[0],
            }));
        }
    }
}
