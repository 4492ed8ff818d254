//! From bending charge to the curvature of charge and back-relaxation.
//!
//! The bending charge x (C/cm2) grows by `x' = SUM b_k q_k'`, b = 1, and is an absolute charge: at the first edge it
//! is that of the baseline (and of a residual charge), x_0. Its shape then is the zero of curvature. Q = A x.
//!
//! - `unequal-coupling`: b_2 = 1 + r; its forms stand in `charging`.
//! - `leak-coupling`: x' gains `u/R_ss`, times `coupled_fraction`. "threshold": what |u| has above 0.8 V in place of u;
//!   "one-sided": where u > 0 only.
//! - `coupling-saturation`: "drive": what relaxes is `p = x/(1 + |Q|/q_s)` in place of x; "gain": the curvature of the
//!   relaxed strain is divided by `1 + |Q|/q_s`. "tanh", "langevin", "hard": [`unsaturated`].
//! - `x-polarity-coupling`: p is multiplied by 1 + r where the bending charge is negative.
//! - `x-charge-hysteresis`: p follows x with play of half width w.
//! - `partial-relaxation`: `kappa = alpha A [(1-f) s + f (p - p_0)]`. "saturating": what stays is
//!   `f m/(1 + |m|/(0.3 C/cm2))`, m = p - p_0; "yield" stands in `relaxation`.
//! - `counter-flow`: `y' = (p - y)/tau`, `kappa = alpha A [s - f (y - p_0)]`. "two-times": half of y with tau/4, half
//!   with 4 tau; "stays": |y| never falls.
//! - `quadratic-coupling`: kappa gains `a (Q^2 - Q_0^2)` ("direct"), or what back-relaxation leaves of it ("relaxing").
//!   In place of Q^2: "quartic": `Q^4/(0.03 C)^2`; "late": what follows Q^2 with 60 s.
//!
//! The strain s is that of `relaxation`.

use super::effects::Effects;
use super::forms::unsaturated;
use super::relaxation::Relaxation;
use super::states::States;

/// Bending charge at which what does not relax is halved, C/cm2.
const STAYING_C_PER_CM2: f64 = 0.3;
/// Time in which a late even coupling follows, s.
const LATE_S: f64 = 60.0;
/// Charge at which the fourth power couples as much as the square, C.
const EVEN_C: f64 = 0.03;
/// Voltage above which a thresholded leak bends, V.
const LEAK_V: f64 = 0.8;

/// What flows back.
#[derive(Debug, Clone, Copy)]
struct Counter {
    fraction: f64,
    stays: bool,
    /// States with their time constants, s; equal shares.
    parts: [(usize, f64); 2],
}

/// The play operator: the output stays where it was until the input has moved it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Play {
    half_width: f64,
    /// Output at the last step's end.
    held: f64,
}

impl Play {
    pub fn new(half_width: f64, held: f64) -> Play {
        Play { half_width, held }
    }

    /// Output for this input, if the input has gone one way since the last step.
    pub fn output(&self, input: f64) -> f64 {
        self.held.clamp(input - self.half_width, input + self.half_width)
    }

    /// The same play, its width multiplied.
    pub fn widened(&self, factor: f64) -> Play {
        Play {
            half_width: factor * self.half_width,
            ..*self
        }
    }

    /// Moves the memory.
    pub fn follow(&mut self, input: f64) {
        self.held = self.output(input);
    }

    /// Sets the memory.
    pub fn hold(&mut self, output: f64) {
        self.held = output;
    }
}

/// Everything between x and the curvature.
#[derive(Debug, Clone)]
pub(super) struct Coupling {
    /// alpha A, cm per (C/cm2).
    gain: f64,
    area_cm2: f64,
    x: usize,
    p0: f64,
    q0: f64,
    leak: f64,
    leak_law: &'static str,
    partial: f64,
    partial_saturates: bool,
    counter: Option<Counter>,
    quadratic: f64,
    quartic: bool,
    /// State of what follows the square late.
    late: Option<usize>,
    relaxing: Option<usize>,
    inverse_charge: f64,
    saturation_law: &'static str,
    saturates_drive: bool,
    /// r of negative charge.
    polarity: f64,
    play: Option<Play>,
    relaxation: Relaxation,
}

impl Coupling {
    /// `x` is the place of the bending charge, `x0` its value at the first edge.
    pub fn new(
        effects: &Effects,
        states: &mut States,
        relaxation: Relaxation,
        (gain, area_cm2): (f64, f64),
        (x, x0): (usize, f64),
    ) -> Coupling {
        let saturation = effects.get("coupling-saturation");
        let hysteresis = effects.get("x-charge-hysteresis");
        let quadratic = effects.get("quadratic-coupling");
        let mut coupling = Coupling {
            gain,
            area_cm2,
            x,
            p0: 0.0,
            q0: area_cm2 * x0,
            leak: effects.value("leak-coupling", "coupled_fraction"),
            leak_law: effects.law("leak-coupling"),
            partial: match effects.law("partial-relaxation") {
                "yield" => 0.0,
                _ => effects.value("partial-relaxation", "fraction"),
            },
            partial_saturates: effects.law("partial-relaxation") == "saturating",
            counter: None,
            quadratic: effects.value("quadratic-coupling", "quadratic_cm_per_c2"),
            quartic: effects.law("quadratic-coupling") == "quartic",
            late: (effects.law("quadratic-coupling") == "late").then(|| states.add(0.0)),
            relaxing: quadratic.filter(|e| e.is("relaxing")).map(|_| states.add(0.0)),
            inverse_charge: saturation.map_or(0.0, |e| e.value("inverse_charge_per_c")),
            saturation_law: effects.law("coupling-saturation"),
            saturates_drive: saturation.is_some_and(|e| e.is("drive")),
            polarity: effects.value("x-polarity-coupling", "ratio_change"),
            play: None,
            relaxation,
        };
        coupling.p0 = coupling.saturated(x0);
        coupling.play = hysteresis.map(|e| Play::new(e.value("width_c_per_cm2"), coupling.p0));
        coupling.counter = effects.get("counter-flow").map(|e| {
            let ratios = if e.law() == "two-times" {
                [0.25, 4.0]
            } else {
                [1.0, 1.0]
            };
            Counter {
                fraction: e.value("fraction"),
                stays: e.law() == "stays",
                parts: ratios.map(|ratio| (states.add(coupling.p0), ratio * e.value("time_constant_s"))),
            }
        });
        coupling
    }

    /// What is left of a bending by the charge of `x`.
    fn left(&self, x: f64) -> f64 {
        unsaturated(
            self.saturation_law,
            (self.area_cm2 * x).abs() * self.inverse_charge,
        )
    }

    fn saturated(&self, x: f64) -> f64 {
        let p = if x < 0.0 { x * (1.0 + self.polarity) } else { x };
        if self.saturates_drive { p * self.left(x) } else { p }
    }

    /// Current of the leak that bends, A/cm2, at the voltage `u` over the conductance `steady`.
    pub fn leaking(&self, steady: f64, u: f64) -> f64 {
        let bending_v = match self.leak_law {
            "threshold" => (u.abs() - LEAK_V).max(0.0).copysign(u),
            "one-sided" => u.max(0.0),
            _ => u,
        };
        self.leak * steady * bending_v
    }

    /// What relaxes, C/cm2.
    fn drive(&self, y: &[f64]) -> f64 {
        let p = self.saturated(y[self.x]);
        self.play.map_or(p, |play| play.output(p))
    }

    /// Moves the memory of the hysteresis at a step's end.
    pub fn follow(&mut self, y: &[f64]) {
        let p = self.saturated(y[self.x]);
        if let Some(play) = &mut self.play {
            play.follow(p);
        }
    }

    fn square(&self, y: &[f64]) -> f64 {
        self.late.map_or_else(|| self.square_now(y), |state| y[state])
    }

    fn square_now(&self, y: &[f64]) -> f64 {
        let even = |charge: f64| {
            if self.quartic {
                charge.powi(4) / (EVEN_C * EVEN_C)
            } else {
                charge * charge
            }
        };
        even(self.area_cm2 * y[self.x]) - even(self.q0)
    }

    /// Curvature, 1/cm; `factor` multiplies the coupling.
    pub fn curvature(&self, factor: f64, y: &[f64]) -> f64 {
        let moved = self.drive(y) - self.p0;
        let strain = self.relaxation.strain(moved, y);
        let staying = if self.partial_saturates {
            moved / (1.0 + moved.abs() / STAYING_C_PER_CM2)
        } else {
            moved
        };
        let mut whole = (1.0 - self.partial) * strain + self.partial * staying;
        if let Some(counter) = self.counter {
            let flowed = counter.parts.map(|(state, _)| 0.5 * (y[state] - self.p0));
            whole -= counter.fraction * (flowed[0] + flowed[1]);
        }
        let mut curvature = factor * self.gain * whole;
        if !self.saturates_drive && self.inverse_charge > 0.0 {
            curvature *= self.left(y[self.x]);
        }
        if self.quadratic != 0.0 {
            curvature += self.quadratic * (self.square(y) + self.relaxing.map_or(0.0, |state| y[state]));
        }
        curvature
    }

    /// Rate of `alpha A s` while x changes at `x_rate`, 1/(cm s); lambda is multiplied by `relaxation`.
    pub fn strain_rate(&self, x_rate: f64, relaxation: f64, y: &[f64]) -> f64 {
        let moved = self.drive(y) - self.p0;
        self.gain * (x_rate + self.relaxation.loss(moved, relaxation, y))
    }

    /// Rates of the own states; lambda is multiplied by `relaxation`.
    pub fn rates(&self, relaxation: f64, y: &[f64], out: &mut [f64]) {
        let p = self.drive(y);
        self.relaxation.rates(p - self.p0, relaxation, y, out);
        if let Some(counter) = self.counter {
            for (state, time_s) in counter.parts {
                let rate = (p - y[state]) / time_s;
                let falls = rate * y[state] < 0.0;
                out[state] = if counter.stays && falls { 0.0 } else { rate };
            }
        }
        if let Some(state) = self.late {
            out[state] = (self.square_now(y) - y[state]) / LATE_S;
        }
        if let Some(state) = self.relaxing {
            out[state] = -self.relaxation.rate_per_s * relaxation * (self.square(y) + y[state]);
        }
    }
}
