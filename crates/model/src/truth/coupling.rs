//! From bending charge to the curvature of charge and back-relaxation.
//!
//! The bending charge x (C/cm2) grows by `x' = SUM b_k q_k'`, b = 1, and is an absolute charge: at the first edge it
//! is that of the baseline (and of a residual charge), x_0. Its shape then is the zero of curvature. Q = A x.
//!
//! - `unequal-coupling`: b_2 = 1 + r.
//! - `leak-coupling`: x' gains `u/R_ss`, times `coupled_fraction`.
//! - `coupling-saturation`: "drive": what relaxes is `p = x/(1 + |Q|/q_s)` in place of x; "gain": the curvature of the
//!   relaxed strain is divided by `1 + |Q|/q_s`.
//! - `x-charge-hysteresis`: p follows x with play of half width w.
//! - `partial-relaxation`: `kappa = alpha A [(1-f) s + f (p - p_0)]`.
//! - `counter-flow`: `y' = (p - y)/tau`, `kappa = alpha A [s - f (y - p_0)]`.
//! - `quadratic-coupling`: kappa gains `a (Q^2 - Q_0^2)` ("direct"), or what back-relaxation leaves of it ("relaxing").
//!
//! The strain s is that of `relaxation`.

use super::effects::Effects;
use super::relaxation::Relaxation;
use super::states::States;

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

    /// Moves the memory.
    pub fn follow(&mut self, input: f64) {
        self.held = self.output(input);
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
    pub leak: f64,
    partial: f64,
    counter: Option<(usize, f64, f64)>,
    quadratic: f64,
    relaxing: Option<usize>,
    inverse_charge: f64,
    saturates_drive: bool,
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
            partial: effects.value("partial-relaxation", "fraction"),
            counter: None,
            quadratic: effects.value("quadratic-coupling", "quadratic_cm_per_c2"),
            relaxing: quadratic.filter(|e| e.is("relaxing")).map(|_| states.add(0.0)),
            inverse_charge: saturation.map_or(0.0, |e| e.value("inverse_charge_per_c")),
            saturates_drive: saturation.is_some_and(|e| e.is("drive")),
            play: None,
            relaxation,
        };
        coupling.p0 = coupling.saturated(x0);
        coupling.play = hysteresis.map(|e| Play::new(e.value("width_c_per_cm2"), coupling.p0));
        coupling.counter = effects.get("counter-flow").map(|e| {
            let state = states.add(coupling.p0);
            (state, e.value("fraction"), e.value("time_constant_s"))
        });
        coupling
    }

    fn saturated(&self, x: f64) -> f64 {
        if self.saturates_drive {
            x / (1.0 + (self.area_cm2 * x).abs() * self.inverse_charge)
        } else {
            x
        }
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
        (self.area_cm2 * y[self.x]).powi(2) - self.q0 * self.q0
    }

    /// Curvature, 1/cm; `factor` multiplies the coupling.
    pub fn curvature(&self, factor: f64, y: &[f64]) -> f64 {
        let moved = self.drive(y) - self.p0;
        let strain = self.relaxation.strain(moved, y);
        let mut whole = (1.0 - self.partial) * strain + self.partial * moved;
        if let Some((state, fraction, _)) = self.counter {
            whole -= fraction * (y[state] - self.p0);
        }
        let mut curvature = factor * self.gain * whole;
        if !self.saturates_drive && self.inverse_charge > 0.0 {
            curvature /= 1.0 + (self.area_cm2 * y[self.x]).abs() * self.inverse_charge;
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
        if let Some((state, _, time_s)) = self.counter {
            out[state] = (p - y[state]) / time_s;
        }
        if let Some(state) = self.relaxing {
            out[state] = -self.relaxation.rate_per_s * relaxation * (self.square(y) + y[state]);
        }
    }
}
