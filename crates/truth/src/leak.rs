//! Currents that charge nothing.
//!
//! - R_ss of the base model: `u/R_ss`.
//! - `faradaic-leak`: `sign(w) i0 (exp((|w| - onset)/slope) - 1)` where |w| is above the onset, else 0; beyond an
//!   exponent of 16 along the tangent there, and beyond 40 no more. It is drawn at the terminals of a cell; w is the voltage
//!   there ("terminal") or that of branch 2's capacitor ("capacitor"; the mean over its shares by capacitance where it is
//!   dispersed). "soft": no threshold, `2 i0 exp(-onset/slope) sinh(w/slope)`; "limited": divided by
//!   `1 + i/(50 i0)`, no more arrives; "passivating": divided by `1 + sqrt(t_edge/20 s)`.
//! - `diffusion-limited-leak`: `k u / sqrt(t_edge + 0.05 s)`, u the voltage now, also while the circuit is open.
//!   Before the first edge it has died away. "layer": it falls for 60 s only; "spent": with the clock time
//!   in place of t_edge, what has reacted does not come back.

use super::charging::Chain;
use super::effects::Effects;
use super::network::{Cell, Imposed, Network, Outer};

const STEEPEST_EXPONENT: f64 = 16.0;
const LARGEST_EXPONENT: f64 = 40.0;
/// Largest leak that transport allows, in units of i0.
const MOST_LEAK: f64 = 50.0;
/// Time from which on a passivating leak falls as the root of time, s.
const PASSIVATING_S: f64 = 20.0;
/// Time until which a diffusion layer grows, s.
const LAYER_S: f64 = 60.0;

/// The faradaic law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Faradaic {
    i0: f64,
    onset_v: f64,
    slope_v: f64,
    pub by_capacitor: bool,
    law: &'static str,
}

impl Faradaic {
    /// Current, A/cm2, and its derivative by the voltage, S/cm2.
    pub fn current(&self, w: f64) -> (f64, f64) {
        let exponent = (w.abs() - self.onset_v) / self.slope_v;
        match self.law {
            "soft" if exponent < STEEPEST_EXPONENT => {
                let (forth, back) = (exponent.exp(), (-(w.abs() + self.onset_v) / self.slope_v).exp());
                let current = self.i0 * (forth - back);
                (w.signum() * current, self.i0 * (forth + back) / self.slope_v)
            }
            "limited" => {
                let (current, slope) = self.by_exponent(w);
                let damped = 1.0 + current.abs() / (MOST_LEAK * self.i0);
                (current / damped, slope / (damped * damped))
            }
            _ => self.by_exponent(w),
        }
    }

    fn by_exponent(&self, w: f64) -> (f64, f64) {
        let above = w.abs() - self.onset_v;
        if above <= 0.0 {
            return (0.0, 0.0);
        }
        let exponent = above / self.slope_v;
        if exponent >= STEEPEST_EXPONENT {
            let steepest = self.i0 * STEEPEST_EXPONENT.exp();
            let beyond = exponent.min(LARGEST_EXPONENT) - STEEPEST_EXPONENT;
            let slope = if exponent < LARGEST_EXPONENT {
                steepest / self.slope_v
            } else {
                0.0
            };
            return (w.signum() * (steepest * (1.0 + beyond) - self.i0), slope);
        }
        let current = w.signum() * self.i0 * exponent.exp_m1();
        (current, self.i0 * exponent.exp() / self.slope_v)
    }
}

/// All leaks of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Leaks {
    /// 1/R_ss, S/cm2.
    pub steady: f64,
    faradaic: Option<Faradaic>,
    diffusion: f64,
    diffusion_law: &'static str,
}

impl Leaks {
    pub fn new(rss_ohm_cm2: f64, effects: &Effects) -> Leaks {
        Leaks {
            steady: 1.0 / rss_ohm_cm2,
            faradaic: effects.get("faradaic-leak").map(|effect| Faradaic {
                i0: effect.value("leak_current_a_per_cm2"),
                onset_v: effect.value("onset_v"),
                slope_v: effect.value("slope_v"),
                by_capacitor: effect.is("capacitor"),
                law: effect.law(),
            }),
            diffusion_law: effects.law("diffusion-limited-leak"),
            diffusion: effects.value("diffusion-limited-leak", "leak_a_sqrt_s_per_v_cm2"),
        }
    }

    /// The faradaic law that long after an edge.
    pub fn faradaic(&self, since_edge_s: f64) -> Option<Faradaic> {
        let mut law = self.faradaic?;
        if law.law == "passivating" {
            law.i0 /= 1.0 + (since_edge_s.max(0.0) / PASSIVATING_S).sqrt();
        }
        Some(law)
    }

    /// Conductance of the diffusion-limited leak, S/cm2, that long after an edge.
    pub fn diffusion_limited(&self, since_edge_s: f64, clock_s: f64) -> f64 {
        if self.diffusion == 0.0 {
            return 0.0;
        }
        let since_s = match self.diffusion_law {
            "layer" => since_edge_s.min(LAYER_S),
            "spent" => clock_s,
            _ => since_edge_s,
        };
        self.diffusion / (since_s.max(0.0) + 0.05).sqrt()
    }
}

/// The steady state at the baseline: leaves the cells' voltages in the network.
pub(super) fn rest(network: &mut Network, chains: &[Chain], leaks: &Leaks, baseline_v: f64) -> Outer {
    // Losses inside with a threshold are taken as at the whole baseline voltage, before a series resistance takes its part.
    let lost = |chain: &Chain| match baseline_v {
        0.0 => 0.0,
        u => chain.lost(chain.settled_v(u)) / u,
    };
    let long_after = f64::INFINITY;
    let conductance = leaks.steady + leaks.diffusion_limited(long_after, long_after);
    let cell = Cell {
        conductance: conductance + chains.iter().map(lost).sum::<f64>(),
        faradaic: leaks.faradaic(long_after),
    };
    let nothing = vec![0.0; network.cells];
    network.series += network.late_series;
    let outer = network.solve(Imposed::Voltage(baseline_v), &cell, &nothing);
    network.series -= network.late_series;
    outer
}
