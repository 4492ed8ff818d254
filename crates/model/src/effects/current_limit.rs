//! A source that gives no more than so much current, or a meter that shows no more.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct CurrentLimit;

static ABOUT: About = About {
    id: "current-limit",
    code: "E13",
    summary: "the source clips, or its meter",
    equation: "source: |I| <= I_max, while more is asked for the voltage across the strip falls; meter: |I| <= I_max in what is written down alone",
    variants: &["source", "meter"],
    parameters: &[EffectParameter {
        key: "limit_a",
        symbol: "I_max",
        unit: "A",
        meaning: "largest current of the source, or of the meter's range",
    }],
    vanishes: "I_max above the largest current",
    signature: "a flat top at every edge, then a longer tail where it is the source",
    twins: &["source-rise", "series-resistance"],
    separated_by: "half the voltage: the limit is not reached; +V straight to -V",
    sources: "potentiostat manuals on current ranges",
};

impl Equation for CurrentLimit {
    const ABOUT: &'static About = &ABOUT;

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

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let limit_a = parameters[0].max(f64::MIN_POSITIVE);
        if variant == 0 {
            system.current_limit_a = system.current_limit_a.min(limit_a);
        } else {
            let written = move |_, current: f64| current.clamp(-limit_a, limit_a);
            system.written_current.push(Box::new(written));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn a_meter_hides_what_flows_and_changes_nothing_else() {
        let (levels, times) = ([(0.0, Some(-2.0))], [0.0, 0.1, 1.0, 20.0]);
        let found = respond(&[("current-limit", 1, &[0.05])], &levels, &times, &times);
        let own = respond(&[], &levels, &times, &times);
        assert_eq!(found.curvature_per_cm, own.curvature_per_cm);
        let clipped: Vec<f64> = own.current_a.iter().map(|i| i.max(-0.05)).collect();
        assert!(own.current_a[0] < -0.07);
        assert_eq!(found.current_a, clipped);
    }

    #[test]
    fn current_is_flat_at_the_limit() {
        let times: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k)).collect();
        let found = respond(&[("current-limit", 0, &[0.05])], &[(0.0, Some(2.0))], &times, &[]);
        assert!((found.current_a[0] - 0.05).abs() < 1e-12);
        assert!((found.current_a[10] - 0.05).abs() < 1e-9);
        assert!(found.current_a.iter().all(|i| *i < 0.05 + 1e-9) && found.current_a[199] < 0.04);
    }
}
