//! Bending that follows the size of the voltage, not its sign.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{Coefficients, Law, Now, RunContext, System};

/// See the module.
pub(super) struct EvenBending;

static ABOUT: About = About {
    id: "even-bending",
    code: "K10",
    summary: "even in the voltage, with a lag of its own",
    equation: "kappa -> kappa + a y; square: tau y' = v^2 - y, magnitude: tau y' = |v| 1 V - y, v the voltage across the strip",
    variants: &["square", "magnitude"],
    parameters: &[
        EffectParameter {
            key: "bending_per_v2_cm",
            symbol: "a",
            unit: "1/(V2 cm)",
            meaning: "curvature in the end, at 1 V",
        },
        EffectParameter {
            key: "lag_s",
            symbol: "tau",
            unit: "s",
            meaning: "time in which it follows the voltage",
        },
    ],
    vanishes: "a = 0",
    signature: "a bending that does not change its sign with the voltage, and follows it at its own pace",
    twins: &[
        "quadratic-coupling",
        "polarity-coupling",
        "moisture-bending",
        "creep",
    ],
    separated_by: "reversed polarity; an open circuit: what is even in the charge stays, this goes with the voltage",
    sources: "electrostriction and attraction of the electrodes; heat of the current on one side",
};

struct Even {
    variant: usize,
    per_v2_cm: f64,
    lag_s: f64,
}

impl Law for Even {
    fn memory_time_s(&self) -> Option<f64> {
        Some(self.lag_s)
    }
    fn memory_input(&self, now: &Now) -> f64 {
        let v = now.terminal_v;
        let size = if self.variant == 0 { v * v } else { v.abs() };
        size / self.lag_s
    }
    fn act(&self, _now: &Now, memory: f64, c: &mut Coefficients) {
        c.added_curvature_per_cm += self.per_v2_cm * memory;
    }
}

impl Equation for EvenBending {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        let volts = scale.voltage_v;
        if volts == 0.0 {
            return Search::none();
        }
        let size = if variant == 0 { volts * volts } else { volts };
        let most = scale.curvature_per_cm / size;
        let longest_s = scale.longest_s();
        let low_s = (0.3 * scale.shortest_s).min(longest_s / 100.0);
        let limits = vec![
            Limits::linear(-0.7 * most, 0.7 * most),
            Limits::logarithmic(low_s, 3.0 * longest_s),
        ];
        let lags_s = if variant == 0 {
            scale.times_s(0.005, 0.3, 3)
        } else {
            scale.times_s(0.02, 0.2, 2)
        };
        Search::over(0.01 * most, limits, &[lags_s])
    }

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        system.laws.push(Box::new(Even {
            variant,
            per_v2_cm: parameters[0],
            lag_s: parameters[1],
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn both_polarities_bend_it_alike_and_a_rest_lets_it_go() {
        let (a, lag) = (0.02, 15.0);
        let times = [0.0, 10.0, 99.0, 110.0];
        for (variant, size) in [4.0, 2.0].into_iter().enumerate() {
            for volts in [2.0, -2.0] {
                let levels = [(0.0, Some(volts)), (100.0, Some(0.0))];
                let with = respond(&[("even-bending", variant, &[a, lag])], &levels, &[], &times);
                let own = respond(&[], &levels, &[], &times);
                let risen = |t: f64| -(-t / lag).exp_m1();
                for (k, &t) in times.iter().enumerate() {
                    let way = if t < 100.0 {
                        risen(t)
                    } else {
                        risen(100.0) * (-(t - 100.0) / lag).exp()
                    };
                    let more = with.curvature_per_cm[k] - own.curvature_per_cm[k];
                    assert!(
                        (more - a * size * way).abs() < 1e-9,
                        "{variant} {volts} {t}: {more}"
                    );
                }
            }
        }
    }
}
