//! The surroundings, and what the run itself does to the strip: factors on resistances and on the relaxation rate.
//! t is clock time, counted from the first edge and 0 before it; T is that of the last reading.
//!
//! - `resistance-drift`: R_1, R_2 times `1 + e t/T`.
//! - `ambient-temperature`: R_1, R_2 divided by `1 + e t/T`, lambda multiplied by it.
//! - `water-exchange`: R_1, R_2 times `1 + c (1 - exp(-t/tau))`.
//! - `joule-heating`: `theta' = i u - theta/tau`, i the whole current per cm2 and u the terminal voltage; R_1, R_2
//!   times `exp(-h theta)`.
//! - `water-redistribution`: `w' = i - w/tau`; R_1, R_2 times `1 + c w`, lambda times `1 + c w`, or both.
//! - `electrolytic-drying`: R_1, R_2 times `1 + k INT |u/R_ss| dt` over the time in which |u| is above the onset.
//! - `piezoresistive-electrode`: R_1, R_2 times `1 + g kappa`, kappa the strip's curvature (not the camera's).
//! - `moisture-bending`: curvature gains `k (1 - exp(-t/tau))`.
//! - `threshold-relaxation`: lambda times `1 + c max(0, |v|/V_th - 1)`, v the source's voltage now; while the circuit
//!   is open the strip's own.
//! - `x-limit-cycle`: R_1, R_2 times `1 + a z/2`, z of van der Pol's `z'' = w (1 - z^2) z' - w^2 z` from z = 1, w = 2 pi/P.
//!
//! A factor never falls below 0.05. theta, w and the passed leak charge are 0 at the first edge, whatever the baseline.

use super::effects::Effects;
use super::states::States;

const LEAST: f64 = 0.05;

/// What multiplies the base model's parameters at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Factors {
    /// On R_1 and R_2.
    pub resistance: f64,
    /// On R_ss.
    pub steady_resistance: f64,
    /// On C_1 and C_2.
    pub capacitance: f64,
    /// On lambda.
    pub relaxation: f64,
    /// On curvature per strain.
    pub coupling: f64,
}

impl Factors {
    pub const ONE: Factors = Factors {
        resistance: 1.0,
        steady_resistance: 1.0,
        capacitance: 1.0,
        relaxation: 1.0,
        coupling: 1.0,
    };
}

/// The electrical side of an instant that the surroundings respond to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Passing {
    /// Current, A/cm2.
    pub current: f64,
    /// Voltage between the terminals, V.
    pub terminal_v: f64,
    /// Conductance of R_ss now, S/cm2.
    pub steady: f64,
}

/// A state with a gain and a time constant.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Slow {
    state: usize,
    gain: f64,
    time_s: f64,
}

/// Effects of the surroundings.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Environment {
    run_s: f64,
    drift: f64,
    warming: f64,
    exchange: (f64, f64),
    bending: (f64, f64),
    threshold: Option<(f64, f64)>,
    pub gauge_cm: f64,
    heat: Option<Slow>,
    water: Option<(Slow, bool, bool)>,
    /// State, growth, onset voltage.
    drying: Option<(usize, f64, f64)>,
    /// First of two states, modulation, angular frequency.
    cycle: Option<(usize, f64, f64)>,
}

impl Environment {
    /// `run_s`: clock time of the last reading, s.
    pub fn new(effects: &Effects, states: &mut States, run_s: f64) -> Environment {
        let saturating = |id: &str, gain: &str| {
            let gain = effects.value(id, gain);
            (gain, effects.value(id, "time_constant_s"))
        };
        let mut slow = |id: &str, gain: &str, time: &str| {
            effects.get(id).map(|effect| Slow {
                state: states.add(0.0),
                gain: effect.value(gain),
                time_s: effect.value(time),
            })
        };
        let water = slow("water-redistribution", "change_cm2_per_c", "return_time_s");
        let heat = slow("joule-heating", "softening_cm2_per_j", "cooling_time_s");
        let moved = effects.get("water-redistribution");
        let on = |variant: &str| moved.is_some_and(|effect| effect.is(variant) || effect.is("both"));
        Environment {
            run_s: run_s.max(f64::MIN_POSITIVE),
            drift: effects.value("resistance-drift", "drift_per_run"),
            warming: effects.value("ambient-temperature", "drift_per_run"),
            exchange: saturating("water-exchange", "change"),
            bending: saturating("moisture-bending", "bending_per_cm"),
            threshold: effects
                .get("threshold-relaxation")
                .map(|effect| (effect.value("steepness"), effect.value("threshold_v"))),
            gauge_cm: effects.value("piezoresistive-electrode", "gauge_cm"),
            heat,
            water: water.map(|water| (water, on("resistance"), on("relaxation"))),
            drying: effects.get("electrolytic-drying").map(|effect| {
                let growth = effect.value("growth_cm2_per_c");
                (states.add(0.0), growth, effect.value("onset_v"))
            }),
            cycle: effects.get("x-limit-cycle").map(|effect| {
                let state = states.add(1.0);
                states.add(0.0);
                let turning = std::f64::consts::TAU / effect.value("period_s");
                (state, effect.value("modulation"), turning)
            }),
        }
    }

    /// Factors at clock time `clock_s`, all but those of the curvature and of the source's voltage.
    pub fn factors(&self, clock_s: f64, y: &[f64]) -> Factors {
        let mut factors = Factors::ONE;
        let share = clock_s / self.run_s;
        factors.resistance *= (1.0 + self.drift * share).max(LEAST);
        let warmth = (1.0 + self.warming * share).max(LEAST);
        factors.resistance /= warmth;
        factors.relaxation *= warmth;
        factors.resistance *= (1.0 + saturated(self.exchange, clock_s)).max(LEAST);
        if let Some(heat) = self.heat {
            factors.resistance *= (-heat.gain * y[heat.state]).exp().max(LEAST);
        }
        if let Some((water, resistance, relaxation)) = self.water {
            let factor = (1.0 + water.gain * y[water.state]).max(LEAST);
            factors.resistance *= if resistance { factor } else { 1.0 };
            factors.relaxation *= if relaxation { factor } else { 1.0 };
        }
        if let Some((state, growth, _)) = self.drying {
            factors.resistance *= (1.0 + growth * y[state]).max(LEAST);
        }
        if let Some((state, modulation, _)) = self.cycle {
            factors.resistance *= (1.0 + 0.5 * modulation * y[state]).max(LEAST);
        }
        factors
    }

    /// Factor of the curvature on R_1 and R_2.
    pub fn by_curvature(&self, curvature_per_cm: f64) -> f64 {
        (1.0 + self.gauge_cm * curvature_per_cm).max(LEAST)
    }

    /// Factor of the source's voltage on lambda.
    pub fn by_voltage(&self, v: f64) -> f64 {
        self.threshold.map_or(1.0, |(steepness, threshold_v)| {
            1.0 + steepness * (v.abs() / threshold_v - 1.0).max(0.0)
        })
    }

    /// Curvature that moisture adds, 1/cm.
    pub fn added_per_cm(&self, clock_s: f64) -> f64 {
        saturated(self.bending, clock_s)
    }

    /// Rates of the own states.
    pub fn rates(&self, passing: &Passing, y: &[f64], out: &mut [f64]) {
        if let Some(heat) = self.heat {
            out[heat.state] = passing.current * passing.terminal_v - y[heat.state] / heat.time_s;
        }
        if let Some((water, ..)) = self.water {
            out[water.state] = passing.current - y[water.state] / water.time_s;
        }
        if let Some((state, _, onset_v)) = self.drying {
            let u = passing.terminal_v.abs();
            out[state] = if u > onset_v { u * passing.steady } else { 0.0 };
        }
        if let Some((state, _, turning)) = self.cycle {
            let (z, speed) = (y[state], y[state + 1]);
            out[state] = speed;
            out[state + 1] = turning * (1.0 - z * z) * speed - turning * turning * z;
        }
    }
}

fn saturated((gain, time_s): (f64, f64), clock_s: f64) -> f64 {
    if gain == 0.0 {
        return 0.0;
    }
    -gain * (-clock_s / time_s).exp_m1()
}
