//! A source that gives no more than so much current.

use super::{About, Class, Effect, EffectParameter, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct CurrentLimit;

static ABOUT: About = About {
    id: "current-limit",
    code: "E13",
    class: Class::Source,
    summary: "the source clips",
    equation: "|I| <= I_max: while more is asked for, the voltage across the strip falls",
    variants: &[],
    parameters: &[EffectParameter {
        key: "limit_a",
        symbol: "I_max",
        unit: "A",
        meaning: "largest current of the source",
    }],
    vanishes: "I_max above the largest current",
    signature: "a flat top at every edge, then a longer tail",
    twins: &["source-rise", "series-resistance"],
    separated_by: "half the voltage: the limit is not reached; +V straight to -V",
    sources: "potentiostat manuals on current ranges",
};

impl Effect for CurrentLimit {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        if scale.current_a <= 0.0 {
            return Search::none();
        }
        let parts = |part: &f64| vec![part * scale.current_a];
        Search {
            limits: vec![Limits::linear(0.2 * scale.current_a, scale.current_a)],
            probes: [0.95, 0.8, 0.6].iter().map(parts).collect(),
            absent: f64::INFINITY,
        }
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        system.current_limit_a = system.current_limit_a.min(parameters[0].max(f64::MIN_POSITIVE));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn current_is_flat_at_the_limit() {
        let times: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k)).collect();
        let found = respond(&[("current-limit", 0, &[0.05])], &[(0.0, Some(2.0))], &times, &[]);
        assert!((found.current_a[0] - 0.05).abs() < 1e-12);
        assert!((found.current_a[10] - 0.05).abs() < 1e-9);
        assert!(found.current_a.iter().all(|i| *i < 0.05 + 1e-9) && found.current_a[199] < 0.04);
    }
}
