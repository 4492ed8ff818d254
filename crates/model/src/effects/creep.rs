//! Slow set of the polymer that does not come back.

use super::acting::read_as;
use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct Creep;

static ABOUT: About = About {
    id: "creep",
    code: "M9",
    summary: "logarithmic, not recovered",
    equation: "kappa -> kappa + c ln(1 + t/t_0), of power: kappa + 3 c ((1 + t/t_0)^(1/3) - 1), times the sign of the first voltage in the odd forms",
    variants: &["even", "odd", "power-even", "power-odd"],
    parameters: &[
        EffectParameter {
            key: "creep_per_cm",
            symbol: "c",
            unit: "1/cm",
            meaning: "curvature per e-fold of time, of power at first",
        },
        EffectParameter {
            key: "onset_s",
            symbol: "t_0",
            unit: "s",
            meaning: "time at which it sets in",
        },
    ],
    vanishes: "c = 0",
    signature: "a drift of the bending that stays after the discharge",
    twins: &[
        "moisture-bending",
        "second-relaxation",
        "fractional-relaxation",
        "partial-relaxation",
    ],
    separated_by: "reversed polarity for the even form; a long recovery with pictures before and after",
    sources: "logarithmic creep of glassy polymers; the cube root of time (Andrade 1910)",
};

/// 1, -1, or 0 for no voltage.
fn sign(v: f64) -> f64 {
    if v == 0.0 { 0.0 } else { v.signum() }
}

impl Equation for Creep {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        let most = 0.2 * scale.curvature_per_cm;
        let limits = vec![
            Limits::linear(-most, most),
            Limits::logarithmic(0.1, scale.longest_s().max(1.0)),
        ];
        let onsets_s: &[f64] = if variant < 2 { &[0.3, 3.0, 30.0] } else { &[1.0] };
        let longest_s = scale.longest_s().max(1.0);
        let onsets_s = onsets_s.iter().copied().filter(|t| *t < longest_s);
        Search::over(0.01 * most, limits, &[onsets_s.collect()])
    }

    fn apply(&self, variant: usize, parameters: &[f64], run: &RunContext, system: &mut System) {
        let along = if variant.is_multiple_of(2) {
            1.0
        } else {
            sign(run.first_voltage_v())
        };
        let [creep, onset_s] = [along * parameters[0], parameters[1]];
        let crept = move |x: f64| match variant {
            0 | 1 => x.ln_1p(),
            _ => 3.0 * ((1.0 + x).cbrt() - 1.0),
        };
        system
            .observations
            .push(read_as(move |t, kappa| kappa + creep * crept(t / onset_s)));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn odd_creep_follows_the_first_voltage() {
        let t = 3.0 * 1.0_f64.exp_m1();
        let more = |variant, v| {
            let levels = [(0.0, Some(v))];
            let with = respond(&[("creep", variant, &[0.01, 3.0])], &levels, &[], &[t]);
            with.curvature_per_cm[0] - respond(&[], &levels, &[], &[t]).curvature_per_cm[0]
        };
        assert!((more(0, -2.0) - 0.01).abs() < 1e-12);
        assert!((more(1, -2.0) + 0.01).abs() < 1e-12);
        assert!(more(1, 0.0).abs() < 1e-12);
        let of_power = 0.03 * ((1.0_f64.exp()).cbrt() - 1.0);
        assert!((more(2, -2.0) - of_power).abs() < 1e-12);
        assert!((more(3, -2.0) + of_power).abs() < 1e-12);
    }
}
