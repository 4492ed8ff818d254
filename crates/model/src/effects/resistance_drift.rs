//! Resistances that move with the clock.

use super::acting::{instant, scale_resistances};
use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct ResistanceDrift;

static ABOUT: About = About {
    id: "resistance-drift",
    code: "E11",
    summary: "R changes with clock time",
    equation: "R_k -> R_k (1 + e t/T), of root R_k (1 + e sqrt(t/T)), T the time of the last reading",
    variants: &["linear", "root"],
    parameters: &[EffectParameter {
        key: "drift_per_run",
        symbol: "e",
        unit: "",
        meaning: "relative change of the resistances over the run",
    }],
    vanishes: "e = 0",
    signature: "time constants that change with clock time, whatever the drive does",
    twins: &["water-exchange", "dispersion", "voltage-dependent-capacitance"],
    separated_by: "the same step after idle time, or a pulse train",
    sources: "drying and ageing of membranes",
};

impl Equation for ResistanceDrift {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, _scale: &Scale) -> Search {
        Search::over(0.03, vec![Limits::linear(-0.8, 2.0)], &[])
    }

    fn apply(&self, variant: usize, parameters: &[f64], run: &RunContext, system: &mut System) {
        let [change, end_s] = [parameters[0], run.duration_s.max(f64::MIN_POSITIVE)];
        let per_s = change / end_s;
        system.laws.push(instant(move |now, c| {
            let clock_s = now.clock_s.max(0.0);
            scale_resistances(
                c,
                match variant {
                    0 => 1.0 + per_s * clock_s,
                    _ => 1.0 + change * (clock_s / end_s).sqrt(),
                },
            )
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn a_late_step_meets_the_changed_resistance() {
        let late = [(0.0, Some(0.0)), (150.0, Some(2.0))];
        for (variant, way) in [0.5, 0.5_f64.sqrt()].into_iter().enumerate() {
            let found = respond(&[("resistance-drift", variant, &[0.4])], &late, &[150.0], &[]);
            let factor = 1.0 + 0.4 * way;
            let expected = 0.1 * 2.0 * ((1.0 / 3.0 + 1.0 / 15.0) / factor + 1.0 / 300.0);
            assert!((found.current_a[0] / expected - 1.0).abs() < 1e-12);
        }
    }
}
