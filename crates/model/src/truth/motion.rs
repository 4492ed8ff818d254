//! From the curvature that charge wants (kappa_lin) to that of the strip. In this order:
//!
//! - `modulus-drift`: divided by `1 - e (1 - exp(-t/tau))`, t the clock time.
//! - `softening`: `kappa (1 + b kappa^2) = kappa_in`, the branch through 0. For b < 0 it ends at
//!   |kappa| = 1/sqrt(-3 b); beyond, the strip stays there.
//! - `mechanical-lag`: `tau kappa' + kappa = kappa_in`.
//! - `resonance`: `kappa'' + 2 z w kappa' + w^2 kappa = w^2 kappa_in`, w = 2 pi/period.
//! - `friction`: play of half width w, centred at 0 at the start.
//! - `creep`: gains `c ln(1 + t/t_0)`; "odd": times the sign of the first voltage held.

use super::coupling::Play;
use super::effects::Effects;
use super::states::States;

/// The mechanical chain.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Motion {
    modulus: (f64, f64),
    cubic_cm2: f64,
    lag: Option<(usize, f64)>,
    resonance: Option<(usize, f64, f64)>,
    friction: Option<Play>,
    creep: (f64, f64),
}

impl Motion {
    pub fn new(effects: &Effects, states: &mut States, step_v: f64) -> Motion {
        let modulus = effects.get("modulus-drift");
        let creep = effects.get("creep");
        let sign = if step_v == 0.0 { 0.0 } else { step_v.signum() };
        Motion {
            modulus: modulus.map_or((0.0, 1.0), |e| (e.value("softening"), e.value("time_constant_s"))),
            cubic_cm2: effects.value("softening", "cubic_cm2"),
            lag: effects
                .get("mechanical-lag")
                .map(|e| (states.add(0.0), e.value("lag_s"))),
            resonance: effects.get("resonance").map(|e| {
                let state = states.add(0.0);
                states.add(0.0);
                (
                    state,
                    std::f64::consts::TAU / e.value("period_s"),
                    e.value("damping"),
                )
            }),
            friction: effects
                .get("friction")
                .map(|e| Play::new(e.value("width_per_cm"), 0.0)),
            creep: creep.map_or((0.0, 1.0), |e| {
                let sign = if e.is("odd") { sign } else { 1.0 };
                (sign * e.value("creep_per_cm"), e.value("onset_s"))
            }),
        }
    }

    /// Static part: modulus and softening.
    fn elastic(&self, clock_s: f64, wanted: f64) -> f64 {
        let (softening, time_s) = self.modulus;
        let modulus = 1.0 + softening * (-clock_s / time_s).exp_m1();
        softened(wanted / modulus, self.cubic_cm2)
    }

    /// Curvature before friction.
    fn before_friction(&self, clock_s: f64, wanted: f64, y: &[f64]) -> f64 {
        match (self.resonance, self.lag) {
            (Some((state, ..)), _) | (None, Some((state, _))) => y[state],
            (None, None) => self.elastic(clock_s, wanted),
        }
    }

    /// Curvature of the strip, 1/cm, where charge wants `wanted`.
    pub fn curvature(&self, clock_s: f64, wanted: f64, y: &[f64]) -> f64 {
        let moved = self.before_friction(clock_s, wanted, y);
        let held = self.friction.map_or(moved, |play| play.output(moved));
        let (creep, onset_s) = self.creep;
        if creep == 0.0 {
            return held;
        }
        held + creep * (clock_s / onset_s).ln_1p()
    }

    /// Rates of the own states.
    pub fn rates(&self, clock_s: f64, wanted: f64, y: &[f64], out: &mut [f64]) {
        let mut input = self.elastic(clock_s, wanted);
        if let Some((state, lag_s)) = self.lag {
            out[state] = (input - y[state]) / lag_s;
            input = y[state];
        }
        if let Some((state, turning, damping)) = self.resonance {
            out[state] = y[state + 1];
            out[state + 1] = turning * turning * (input - y[state]) - 2.0 * damping * turning * y[state + 1];
        }
    }

    /// Moves the memory of friction at a step's end.
    pub fn follow(&mut self, clock_s: f64, wanted: f64, y: &[f64]) {
        let moved = self.before_friction(clock_s, wanted, y);
        if let Some(play) = &mut self.friction {
            play.follow(moved);
        }
    }
}

/// Solves `kappa (1 + b kappa^2) = wanted` on the branch through 0 by bisection and Newton's method.
fn softened(wanted: f64, b: f64) -> f64 {
    if b == 0.0 || wanted == 0.0 {
        return wanted;
    }
    let size = wanted.abs();
    let mut high = if b > 0.0 { size } else { (-3.0 * b).sqrt().recip() };
    if b < 0.0 && high * (1.0 + b * high * high) <= size {
        return high.copysign(wanted);
    }
    let mut low = 0.0;
    let mut kappa = if b > 0.0 { size } else { size.min(high) };
    for _ in 0..100 {
        let over = kappa * (1.0 + b * kappa * kappa) - size;
        if over > 0.0 {
            high = kappa;
        } else {
            low = kappa;
        }
        let newton = kappa - over / (1.0 + 3.0 * b * kappa * kappa);
        let next = if newton > low && newton < high {
            newton
        } else {
            0.5 * (low + high)
        };
        if (next - kappa).abs() <= 1e-16 * (1.0 + kappa) {
            return next.copysign(wanted);
        }
        kappa = next;
    }
    kappa.copysign(wanted)
}
