//! Currents that charge nothing.
//!
//! - R_ss of the base model: `u/R_ss`.
//! - `faradaic-leak`: `sign(w) i0 (exp((|w| - onset)/slope) - 1)` where |w| is above the onset, else 0; beyond an
//!   exponent of 16 along the tangent there, and beyond 40 no more. It is drawn at the terminals of a cell; w is the voltage
//!   there ("terminal") or that of branch 2's capacitor ("capacitor"; the mean over its shares by capacitance where it is
//!   dispersed).
//! - `diffusion-limited-leak`: `k u / sqrt(t_edge + 0.05 s)`, u the voltage now, also while the circuit is open.
//!   Before the first edge it has died away.

use super::effects::Effects;

const STEEPEST_EXPONENT: f64 = 16.0;
const LARGEST_EXPONENT: f64 = 40.0;

/// The faradaic law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Faradaic {
    i0: f64,
    onset_v: f64,
    slope_v: f64,
    pub by_capacitor: bool,
}

impl Faradaic {
    /// Current, A/cm2, and its derivative by the voltage, S/cm2.
    pub fn current(&self, w: f64) -> (f64, f64) {
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
    pub faradaic: Option<Faradaic>,
    diffusion: f64,
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
            }),
            diffusion: effects.value("diffusion-limited-leak", "leak_a_sqrt_s_per_v_cm2"),
        }
    }

    /// Conductance of the diffusion-limited leak, S/cm2, that long after an edge.
    pub fn diffusion_limited(&self, since_edge_s: f64) -> f64 {
        if self.diffusion == 0.0 {
            return 0.0;
        }
        self.diffusion / (since_edge_s.max(0.0) + 0.05).sqrt()
    }
}
