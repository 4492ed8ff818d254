//! The surroundings, and what the run itself does to the strip: factors on resistances and on the relaxation rate.
//! t is clock time, counted from the first edge and 0 before it; T is that of the last reading.
//!
//! - `resistance-drift`: R_1, R_2 times `1 + e t/T`; "root", "cubic": [`drifted`].
//! - `ambient-temperature`: R_1, R_2 divided by `1 + e t/T`, lambda multiplied by it; "root", "wave": [`drifted`].
//! - `water-exchange`: R_1, R_2 times `1 + c (1 - exp(-t/tau))`; "hyperbolic", "stretched", "late": [`reached`].
//! - `joule-heating`: `theta' = i u - theta/tau`, i the whole current per cm2 and u the terminal voltage; R_1, R_2
//!   times `exp(-h theta)`. "inverse": `1/(1 + h theta)`; "square": heated by `i^2` times 25 Ohm cm2.
//! - `water-redistribution`: `w' = i - w/tau`; R_1, R_2 times `1 + c w`, lambda times `1 + c w`, or both.
//!   "exponential": `exp(c w)`; "even": `1 + c |w|`.
//! - `electrolytic-drying`: R_1, R_2 times `1 + k INT |u/R_ss| dt` over the time in which |u| is above the onset.
//!   "excess": what is above the onset in place of |u|; "healing": forgotten with 100 s.
//! - `piezoresistive-electrode`: R_1, R_2 times `1 + g kappa`, kappa the strip's curvature (not the camera's).
//!   "exponential": `exp(g kappa)`; "even": `1 + g |kappa|`.
//! - `moisture-bending`: curvature gains `k (1 - exp(-t/tau))`; forms as of `water-exchange`.
//! - `threshold-relaxation`: lambda times `1 + c max(0, |v|/V_th - 1)`, v the source's voltage now; while the circuit
//!   is open the strip's own. "one-sided": v in place of |v|; "late": the addition follows with 5 s.
//! - `x-limit-cycle`: R_1, R_2 times `1 + a z/2`, z of van der Pol's `z'' = w (1 - z^2) z' - w^2 z` from z = 1, w = 2 pi/P.
//! - `x-even-answer`: `z' = (u^2 - z)/tau`, u the terminal voltage; curvature gains `k z`.
//! - `x-wandering`: R_1, R_2 ("resistance"), lambda or the coupling times `1 + a z(t)`, z like a walk and another one in
//!   every run: see [`wandered`].
//!
//! A factor never falls below 0.05. theta, w and the passed leak charge are 0 at the first edge, whatever the baseline.

use super::effects::Effects;
use super::forms::{drifted, reached};
use super::states::States;

const LEAST: f64 = 0.05;
/// Resistance that heats where the square of the current does, Ohm cm2.
const HEATING_OHM_CM2: f64 = 25.0;
/// Time in which dried electrodes take up water again, s.
const HEALING_S: f64 = 100.0;
/// Time in which relaxation follows the voltage late, s.
const LATE_S: f64 = 5.0;

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
    law: &'static str,
}

/// What approaches its end with time.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Approach {
    gain: f64,
    time_s: f64,
    law: &'static str,
}

impl Approach {
    fn at(&self, clock_s: f64) -> f64 {
        if self.gain == 0.0 {
            return 0.0;
        }
        self.gain * reached(self.law, clock_s / self.time_s)
    }
}

/// Relaxation that a voltage hastens.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Threshold {
    steepness: f64,
    threshold_v: f64,
    one_sided: bool,
    /// State of what follows late.
    late: Option<usize>,
}

impl Threshold {
    fn added(&self, v: f64) -> f64 {
        let size = if self.one_sided { v } else { v.abs() };
        self.steepness * (size / self.threshold_v - 1.0).max(0.0)
    }
}

/// What wanders.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Wandering {
    modulation: f64,
    /// Names the walk.
    seed: f64,
    resistance: bool,
    relaxation: bool,
}

/// Effects of the surroundings.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Environment {
    run_s: f64,
    drift: (f64, &'static str),
    warming: (f64, &'static str),
    exchange: Approach,
    bending: Approach,
    threshold: Option<Threshold>,
    pub gauge_cm: f64,
    gauge_law: &'static str,
    heat: Option<Slow>,
    water: Option<(Slow, bool, bool)>,
    /// State, growth, onset voltage.
    drying: Option<(usize, f64, f64)>,
    drying_law: &'static str,
    even: Option<Slow>,
    wandering: Option<Wandering>,
    /// First of two states, modulation, angular frequency.
    cycle: Option<(usize, f64, f64)>,
}

impl Environment {
    /// `run_s`: clock time of the last reading, s.
    pub fn new(effects: &Effects, states: &mut States, run_s: f64) -> Environment {
        let approach = |id: &str, gain: &str| Approach {
            gain: effects.value(id, gain),
            time_s: effects.value(id, "time_constant_s"),
            law: effects.law(id),
        };
        let mut slow = |id: &str, gain: &str, time: &str| {
            effects.get(id).map(|effect| Slow {
                state: states.add(0.0),
                gain: effect.value(gain),
                time_s: effect.value(time),
                law: effect.law(),
            })
        };
        let even = slow("x-even-answer", "bending_per_cm_v2", "time_constant_s");
        let water = slow("water-redistribution", "change_cm2_per_c", "return_time_s");
        let heat = slow("joule-heating", "softening_cm2_per_j", "cooling_time_s");
        let moved = effects.get("water-redistribution");
        let on = |variant: &str| moved.is_some_and(|effect| effect.is(variant) || effect.is("both"));
        Environment {
            run_s: run_s.max(f64::MIN_POSITIVE),
            drift: drift(effects, "resistance-drift"),
            warming: drift(effects, "ambient-temperature"),
            exchange: approach("water-exchange", "change"),
            bending: approach("moisture-bending", "bending_per_cm"),
            threshold: effects.get("threshold-relaxation").map(|effect| Threshold {
                steepness: effect.value("steepness"),
                threshold_v: effect.value("threshold_v"),
                one_sided: effect.law() == "one-sided",
                late: (effect.law() == "late").then(|| states.add(0.0)),
            }),
            gauge_cm: effects.value("piezoresistive-electrode", "gauge_cm"),
            gauge_law: effects.law("piezoresistive-electrode"),
            drying_law: effects.law("electrolytic-drying"),
            even,
            wandering: effects.get("x-wandering").map(|effect| Wandering {
                modulation: effect.value("modulation"),
                seed: 31.0 * effect.value("seed") + effects.run_index as f64,
                resistance: effect.is("resistance"),
                relaxation: effect.is("relaxation"),
            }),
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
        let drifting = |(gain, law): (f64, &str)| (1.0 + gain * drifted(law, share)).max(LEAST);
        factors.resistance *= drifting(self.drift);
        let warmth = drifting(self.warming);
        factors.resistance /= warmth;
        factors.relaxation *= warmth;
        factors.resistance *= (1.0 + self.exchange.at(clock_s)).max(LEAST);
        if let Some(heat) = self.heat {
            let warm = heat.gain * y[heat.state];
            let factor = match heat.law {
                "inverse" => (1.0 + warm).max(LEAST).recip(),
                _ => (-warm).exp(),
            };
            factors.resistance *= factor.max(LEAST);
        }
        if let Some((water, resistance, relaxation)) = self.water {
            let factor = changed(water.law, water.gain, y[water.state]);
            factors.resistance *= if resistance { factor } else { 1.0 };
            factors.relaxation *= if relaxation { factor } else { 1.0 };
        }
        if let Some((state, growth, _)) = self.drying {
            factors.resistance *= (1.0 + growth * y[state]).max(LEAST);
        }
        if let Some((state, modulation, _)) = self.cycle {
            factors.resistance *= (1.0 + 0.5 * modulation * y[state]).max(LEAST);
        }
        if let Some(wandering) = self.wandering {
            let factor = (1.0 + wandering.modulation * wandered(wandering.seed, clock_s)).max(LEAST);
            if wandering.resistance {
                factors.resistance *= factor;
            } else if wandering.relaxation {
                factors.relaxation *= factor;
            } else {
                factors.coupling *= factor;
            }
        }
        factors
    }

    /// Factor of the curvature on R_1 and R_2.
    pub fn by_curvature(&self, curvature_per_cm: f64) -> f64 {
        changed(self.gauge_law, self.gauge_cm, curvature_per_cm)
    }

    /// Factor of the source's voltage on lambda.
    pub fn by_voltage(&self, v: f64, y: &[f64]) -> f64 {
        self.threshold.map_or(1.0, |threshold| {
            1.0 + threshold
                .late
                .map_or_else(|| threshold.added(v), |state| y[state])
        })
    }

    /// Curvature that moisture and an even answer add, 1/cm.
    pub fn added_per_cm(&self, clock_s: f64, y: &[f64]) -> f64 {
        let even = self.even.map_or(0.0, |even| even.gain * y[even.state]);
        self.bending.at(clock_s) + even
    }

    /// Rates of the own states.
    pub fn rates(&self, passing: &Passing, y: &[f64], out: &mut [f64]) {
        if let Some(heat) = self.heat {
            let heated = match heat.law {
                "square" => HEATING_OHM_CM2 * passing.current * passing.current,
                _ => passing.current * passing.terminal_v,
            };
            out[heat.state] = heated - y[heat.state] / heat.time_s;
        }
        if let Some((water, ..)) = self.water {
            out[water.state] = passing.current - y[water.state] / water.time_s;
        }
        if let Some((state, _, onset_v)) = self.drying {
            let u = passing.terminal_v.abs();
            let drying_v = match self.drying_law {
                "excess" => u - onset_v,
                _ => u,
            };
            out[state] = if u > onset_v {
                drying_v * passing.steady
            } else {
                0.0
            };
            if self.drying_law == "healing" {
                out[state] -= y[state] / HEALING_S;
            }
        }
        if let Some((threshold, state)) = self.threshold.and_then(|own| Some((own, own.late?))) {
            out[state] = (threshold.added(passing.terminal_v) - y[state]) / LATE_S;
        }
        if let Some(even) = self.even {
            out[even.state] = (passing.terminal_v.powi(2) - y[even.state]) / even.time_s;
        }
        if let Some((state, _, turning)) = self.cycle {
            let (z, speed) = (y[state], y[state + 1]);
            out[state] = speed;
            out[state + 1] = turning * (1.0 - z * z) * speed - turning * turning * z;
        }
    }
}

fn drift(effects: &Effects, id: &str) -> (f64, &'static str) {
    (effects.value(id, "drift_per_run"), effects.law(id))
}

/// Factor that follows what has changed.
fn changed(law: &str, gain: f64, by: f64) -> f64 {
    let factor = match law {
        "exponential" => (gain * by).min(10.0).exp(),
        "even" => 1.0 + gain * by.abs(),
        _ => 1.0 + gain * by,
    };
    factor.max(LEAST)
}

/// A smooth walk of about unit size: eight waves of up to 900 s, each as large as it is long, at phases that irrational
/// numbers scatter.
fn wandered(seed: f64, clock_s: f64) -> f64 {
    let wave = |k: i32| {
        let k = f64::from(k);
        let phase = (seed + 1.0) * (0.618_034 * k * k + 0.414_214 * k);
        (std::f64::consts::TAU * (k * clock_s / 900.0 + phase.fract())).sin() / k
    };
    (1..=8).map(wave).sum()
}
