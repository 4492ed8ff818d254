//! Inertia of the strip: it overshoots and rings.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{Observation, RunContext, System};

/// See the module.
pub(super) struct Resonance;

static ABOUT: About = About {
    id: "resonance",
    code: "M5",
    summary: "inertia of the strip",
    equation: "kappa'' + 2 z w kappa' + w^2 kappa = w^2 kappa_q, w = 2 pi/T",
    variants: &[],
    parameters: &[
        EffectParameter {
            key: "period_s",
            symbol: "T",
            unit: "s",
            meaning: "period of the free strip without damping",
        },
        EffectParameter {
            key: "damping",
            symbol: "z",
            unit: "",
            meaning: "damping ratio 1/(2Q)",
        },
    ],
    vanishes: "T = 0",
    signature: "ringing after every edge",
    twins: &["camera-delay", "mechanical-lag"],
    separated_by: "ten frames per period at the edge",
    sources: "first mode of a cantilever",
};

struct Oscillator {
    period_s: f64,
    damping: f64,
}

impl Oscillator {
    /// Rows of the matrix exponential of the free oscillator over `h` seconds.
    fn free(&self, h: f64) -> [[f64; 2]; 2] {
        let w = 2.0 * std::f64::consts::PI / self.period_s;
        let decay = self.damping * w;
        let square = w * w * (1.0 - self.damping * self.damping);
        let turn = square.abs().sqrt() * h;
        // Cosine, and sine over the frequency, both with the decay.
        let (cosine, sine) = if turn < 1e-5 {
            let kept = (-decay * h).exp();
            (kept, kept * h)
        } else if square > 0.0 {
            let kept = (-decay * h).exp();
            (kept * turn.cos(), kept * turn.sin() * h / turn)
        } else {
            let (slow, fast) = ((turn - decay * h).exp(), (-turn - decay * h).exp());
            ((slow + fast) / 2.0, (slow - fast) / 2.0 * h / turn)
        };
        [
            [cosine + decay * sine, sine],
            [-w * w * sine, cosine - decay * sine],
        ]
    }
}

impl Observation for Oscillator {
    /// Exact where the curvature is a straight line between neighbouring times.
    fn observe(&self, clock_s: &[f64], curvature_per_cm: &mut [f64]) {
        let Some(&first) = curvature_per_cm.first() else {
            return;
        };
        let lag_s = self.damping * self.period_s / std::f64::consts::PI;
        let (mut place, mut rate, mut before) = (first, 0.0, first);
        for (times, kappa) in clock_s.windows(2).zip(&mut curvature_per_cm[1..]) {
            let h = times[1] - times[0];
            let slope = (*kappa - before) / h;
            // Away from the motion that would follow the line for ever.
            let away = [place - before + lag_s * slope, rate - slope];
            let free = self.free(h);
            place = *kappa - lag_s * slope + free[0][0] * away[0] + free[0][1] * away[1];
            rate = slope + free[1][0] * away[0] + free[1][1] * away[1];
            before = *kappa;
            *kappa = place;
        }
    }

    fn resolves_s(&self) -> f64 {
        self.period_s
    }
    /// What it changes is far smaller than the curvature that it takes for straight.
    fn finer(&self) -> f64 {
        8.0
    }
}

impl Equation for Resonance {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        let most = 2.0;
        if scale.shortest_s > 5.0 * most {
            return Search::none();
        }
        let small = (0.5 * scale.shortest_s).clamp(0.25, 0.4 * most);
        let limits = vec![Limits::linear(0.0, most), Limits::logarithmic(0.005, 3.0)];
        Search::over(small, limits, &[vec![0.03, 0.1, 0.4, 1.5]])
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        if parameters[0] > 0.0 {
            system.observations.push(Box::new(Oscillator {
                period_s: parameters[0],
                damping: parameters[1].max(0.0),
            }));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Observation, Oscillator};

    fn jumped(damping: f64, times: &[f64]) -> Vec<f64> {
        let mut kappa: Vec<f64> = times.iter().map(|&t| if t > 0.0 { 1.0 } else { 0.0 }).collect();
        Oscillator {
            period_s: 1.0,
            damping,
        }
        .observe(times, &mut kappa);
        kappa
    }

    #[test]
    fn a_jump_rings_with_the_textbook_overshoot() {
        let damping = 0.2_f64;
        let root = (1.0 - damping * damping).sqrt();
        let found = jumped(damping, &[0.0, 1e-9, 0.5 / root]);
        let overshoot = 1.0 + (-std::f64::consts::PI * damping / root).exp();
        assert!((found[2] - overshoot).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn damping_passes_through_the_critical_one_smoothly() {
        let at = |damping| jumped(damping, &[0.0, 1e-9, 0.3])[2];
        assert!((at(0.999_999) - at(1.000_001)).abs() < 1e-5);
        assert!((at(1.0) - at(1.000_001)).abs() < 1e-5);
    }
}
