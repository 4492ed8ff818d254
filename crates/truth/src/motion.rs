//! From the curvature that charge wants (kappa_lin) to that of the strip. In this order:
//!
//! - `modulus-drift`: divided by `1 - e (1 - exp(-t/tau))`, t the clock time; "hyperbolic", "stretched", "late":
//!   [`reached`].
//! - `softening`: `kappa (1 + b kappa^2) = kappa_in`, the branch through 0. For b < 0 it ends at
//!   |kappa| = 1/sqrt(-3 b); beyond, the strip stays there. "asinh": `asinh(c kappa_in)/c`, c^2 = 6 b (sinh, c^2 = -6 b
//!   for b < 0); "stop": as it comes up to 0.3/cm, beyond at the slope 1/(1 + b) (1 - b for b < 0).
//! - `mechanical-lag`: `tau kappa' + kappa = kappa_in`. With d = kappa_in - kappa and k = 0.2/cm: "slew":
//!   `tau kappa' = k tanh(d/k)`; "creeping": `tau kappa' = d |d|/k`.
//! - `resonance`: `kappa'' + 2 z w kappa' + w^2 kappa = w^2 kappa_in`, w = 2 pi/period. "stiffening": w^2 d (1 + (d/k)^2);
//!   "air": z + the square's `z |kappa'|/(w k)` in place of z, here with z = 0.02 in the first.
//! - `friction`: play of half width w, centred at 0 at the start. "soft": the mean of three plays of w/4, w and 2 w;
//!   "growing": of `w |kappa|/(0.3/cm)`.
//! - `creep`: gains `c ln(1 + t/t_0)`; "odd": times the sign of the first voltage held. "power": `c ((1 + t/t_0)^0.3 - 1)`;
//!   "since-edge": t since the last edge.

use super::coupling::Play;
use super::effects::Effects;
use super::forms::reached;
use super::states::States;

/// Curvature that is much for a lagging or swinging strip, 1/cm.
const MUCH_PER_CM: f64 = 0.2;
/// Curvature beyond which a stop bears, and that at which growing friction is as wide as plain one, 1/cm.
const STOP_PER_CM: f64 = 0.3;
/// Damping of a strip that air brakes at no speed.
const LEAST_DAMPING: f64 = 0.02;

/// The mechanical chain.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Motion {
    modulus: (f64, f64, &'static str),
    cubic_cm2: f64,
    cubic_law: &'static str,
    lag: Option<(usize, f64)>,
    lag_law: &'static str,
    resonance: Option<(usize, f64, f64)>,
    resonance_law: &'static str,
    /// Plays whose mean the strip follows; none: it is free.
    friction: Vec<Play>,
    friction_grows: bool,
    creep: (f64, f64),
    creep_law: &'static str,
}

/// When it is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Now {
    /// Clock time, s.
    pub clock_s: f64,
    /// Time since the last edge, s.
    pub since_edge_s: f64,
}

impl Motion {
    pub fn new(effects: &Effects, states: &mut States, step_v: f64) -> Motion {
        let modulus = effects.get("modulus-drift");
        let creep = effects.get("creep");
        let sign = if step_v == 0.0 { 0.0 } else { step_v.signum() };
        Motion {
            modulus: modulus.map_or((0.0, 1.0, ""), |e| {
                (e.value("softening"), e.value("time_constant_s"), e.law())
            }),
            cubic_cm2: effects.value("softening", "cubic_cm2"),
            cubic_law: effects.law("softening"),
            lag_law: effects.law("mechanical-lag"),
            resonance_law: effects.law("resonance"),
            friction_grows: effects.law("friction") == "growing",
            creep_law: effects.law("creep"),
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
            friction: effects.get("friction").map_or_else(Vec::new, |e| {
                let widths: &[f64] = if e.law() == "soft" {
                    &[0.25, 1.0, 2.0]
                } else {
                    &[1.0]
                };
                let play = |width: &f64| Play::new(width * e.value("width_per_cm"), 0.0);
                widths.iter().map(play).collect()
            }),
            creep: creep.map_or((0.0, 1.0), |e| {
                let sign = if e.is("odd") { sign } else { 1.0 };
                (sign * e.value("creep_per_cm"), e.value("onset_s"))
            }),
        }
    }

    /// Static part: modulus and softening.
    fn elastic(&self, clock_s: f64, wanted: f64) -> f64 {
        let (softening, time_s, law) = self.modulus;
        let modulus = 1.0 - softening * reached(law, clock_s / time_s);
        let (free, b) = (wanted / modulus, self.cubic_cm2);
        match self.cubic_law {
            "asinh" => {
                let c = (6.0 * b.abs()).sqrt();
                (if b < 0.0 {
                    (c * free).sinh()
                } else {
                    (c * free).asinh()
                }) / c
            }
            "stop" => {
                let beyond = (free.abs() - STOP_PER_CM).max(0.0);
                let slope = if b < 0.0 { 1.0 - b } else { (1.0 + b).recip() };
                (free.abs() - beyond + slope * beyond).copysign(free)
            }
            _ => softened(free, b),
        }
    }

    /// Curvature before friction.
    fn before_friction(&self, clock_s: f64, wanted: f64, y: &[f64]) -> f64 {
        match (self.resonance, self.lag) {
            (Some((state, ..)), _) | (None, Some((state, _))) => y[state],
            (None, None) => self.elastic(clock_s, wanted),
        }
    }

    /// Curvature of the strip, 1/cm, where charge wants `wanted`.
    pub fn curvature(&self, now: Now, wanted: f64, y: &[f64]) -> f64 {
        let moved = self.before_friction(now.clock_s, wanted, y);
        let share = 1.0 / self.friction.len().max(1) as f64;
        let held = match self.friction.as_slice() {
            [] => moved,
            plays => plays
                .iter()
                .map(|play| share * self.of(play, moved).output(moved))
                .sum(),
        };
        let (creep, onset_s) = self.creep;
        if creep == 0.0 {
            return held;
        }
        held + creep
            * match self.creep_law {
                "power" => (1.0 + now.clock_s / onset_s).powf(0.3) - 1.0,
                "since-edge" => (now.since_edge_s.max(0.0) / onset_s).ln_1p(),
                _ => (now.clock_s / onset_s).ln_1p(),
            }
    }

    /// The play at that curvature.
    fn of(&self, play: &Play, moved: f64) -> Play {
        if self.friction_grows {
            play.widened(moved.abs() / STOP_PER_CM)
        } else {
            *play
        }
    }

    /// Rates of the own states.
    pub fn rates(&self, clock_s: f64, wanted: f64, y: &[f64], out: &mut [f64]) {
        let mut input = self.elastic(clock_s, wanted);
        if let Some((state, lag_s)) = self.lag {
            let behind = input - y[state];
            out[state] = match self.lag_law {
                "slew" => MUCH_PER_CM * (behind / MUCH_PER_CM).tanh(),
                "creeping" => behind * behind.abs() / MUCH_PER_CM,
                _ => behind,
            } / lag_s;
            input = y[state];
        }
        if let Some((state, turning, damping)) = self.resonance {
            let (mut behind, speed) = (input - y[state], y[state + 1]);
            let mut damping = damping;
            match self.resonance_law {
                "stiffening" => behind *= 1.0 + (behind / MUCH_PER_CM).powi(2),
                "air" => damping = LEAST_DAMPING + damping * speed.abs() / (turning * MUCH_PER_CM),
                _ => {}
            }
            out[state] = speed;
            out[state + 1] = turning * turning * behind - 2.0 * damping * turning * speed;
        }
    }

    /// Moves the memory of friction at a step's end.
    pub fn follow(&mut self, clock_s: f64, wanted: f64, y: &[f64]) {
        let moved = self.before_friction(clock_s, wanted, y);
        for at in 0..self.friction.len() {
            let held = self.of(&self.friction[at], moved).output(moved);
            self.friction[at].hold(held);
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
