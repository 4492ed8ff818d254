//! A leak that the arrival of reactants limits.

use super::acting::instant;
use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct DiffusionLimitedLeak;

static ABOUT: About = About {
    id: "diffusion-limited-leak",
    code: "E9",
    summary: "leak ~ t^-1/2, not recovered on discharge",
    equation: "i = k u / sqrt(t + 0.05 s), t since the last edge of the drive",
    variants: &[],
    parameters: &[EffectParameter {
        key: "leak_a_sqrt_s_per_v_cm2",
        symbol: "k",
        unit: "A sqrt(s)/(V cm2)",
        meaning: "current per voltage at one second",
    }],
    vanishes: "k = 0",
    signature: "a tail of the current as t^-1/2 that does not come back on discharge",
    twins: &["slow-branch", "warburg"],
    separated_by: "a discharge: what went in less what comes out grows as the root of time",
    sources: "Cottrell's law",
};

/// No reactant reacts sooner: the current stays finite at the edge.
const SOONEST_S: f64 = 0.05;

impl Equation for DiffusionLimitedLeak {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        if scale.voltage_v == 0.0 {
            return Search::none();
        }
        let most = scale.current_a / (scale.area_cm2 * scale.voltage_v);
        Search::over(0.003 * most, vec![Limits::linear(0.0, most)], &[])
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let k = parameters[0];
        system.laws.push(instant(move |now, c| {
            c.leak_s_per_cm2 += k / (now.since_edge_s.max(0.0) + SOONEST_S).sqrt();
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn leak_falls_with_the_root_of_time() {
        let levels = [(0.0, Some(2.0))];
        let with = respond(&[("diffusion-limited-leak", 0, &[1e-3])], &levels, &[3.95], &[]);
        let without = respond(&[], &levels, &[3.95], &[]);
        let leak = with.current_a[0] - without.current_a[0];
        assert!((leak - 0.1 * 1e-3 * 2.0 / 2.0).abs() < 1e-12);
    }
}
