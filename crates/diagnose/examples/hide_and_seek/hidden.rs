//! Effects with a strength that leaves so many standard deviations after the base parameters are refitted.

use std::sync::LazyLock;

use ieap_diagnose::sigmas_after_refit;
use ieap_model::effects::{ALL, Applied, Effect, Scale};
use ieap_truth::catalogue::{Bounds, known};
use rand::RngExt;

use crate::case::{AREA, Case, LENGTH, responses};

/// Effects of the library that the truth simulator hides, in the library's order: seeds go by places here.
pub static HIDEABLE: LazyLock<Vec<&'static dyn Effect>> = LazyLock::new(|| {
    let all = ALL.iter().copied();
    all.filter(|effect| known(effect.about().id).is_some()).collect()
});

/// Forms of an effect that the truth simulator hides: the first ones of the library's. None where it hides no such effect.
pub fn hidden_variants(effect: &dyn Effect) -> Option<usize> {
    Some(known(effect.about().id)?.variants.len().max(1))
}

/// Parameters of a random form of the effect, with a strength that gives about `d` sigmas after refit.
pub fn hidden(case: &mut Case, effect: &'static dyn Effect, d: f64) -> Option<(Applied, f64)> {
    let scale = scale(case);
    let variants = hidden_variants(effect)?;
    let variant = case.generator.random_range(0..variants);
    let search = effect.search(variant, &scale);
    if search.probes.is_empty() {
        return None;
    }
    let probe = search.probes[case.generator.random_range(0..search.probes.len())].clone();
    let mut applied = Applied {
        effect,
        variant,
        parameters: probe.clone(),
    };
    let at = |case: &Case, applied: &Applied| {
        sigmas_after_refit(
            &case.base,
            &case.design,
            &responses(case, std::slice::from_ref(applied)),
            case.noise,
        )
    };
    let limits = search.limits[0];
    if limits.held {
        // A law without free strength: the noise is made to fit instead.
        applied.parameters[0] = 1.0;
        let factor = at(case, &applied) / d;
        case.noise.current_a *= factor;
        case.noise.curvature_per_cm *= factor;
        return (factor > 0.0).then_some((applied, d));
    }
    for _ in 0..8 {
        let now = at(case, &applied);
        if now <= 0.0 {
            return None;
        }
        let wanted = applied.parameters[0] * (d / now).clamp(0.2, 30.0);
        applied.parameters[0] = wanted.clamp(limits.low, limits.high);
    }
    let reached = at(case, &applied);
    ((reached / d - 1.0).abs() < 0.15).then_some((applied, reached))
}

/// Sizes of the case, from which limits of effects follow.
pub fn scale(case: &Case) -> Scale {
    let plain = responses(case, &[]);
    let peak = |values: &[f64]| values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let mut scale = Scale {
        base: case.base.clone(),
        area_cm2: AREA,
        length_cm: Some(LENGTH),
        durations_s: vec![case.lasting_s(); case.design.len()],
        shortest_s: case.plan.rate_hz.recip(),
        voltage_v: 2.0,
        current_a: plain.iter().map(|r| peak(&r.current_a)).fold(0.0, f64::max),
        curvature_per_cm: plain
            .iter()
            .map(|r| peak(&r.curvature_per_cm))
            .fold(0.0, f64::max),
        charge_c: 0.0,
        edges: 1,
        logged: Vec::new(),
    };
    scale.charge_c = scale.capacitance_f_per_cm2() * 2.0 * AREA;
    scale
}

/// Id, key of the strength, first strength to try, and another parameter.
pub type Outside = (&'static str, &'static str, f64, Option<(&'static str, f64)>);

/// Causes that no library holds.
pub const OUTSIDE: [Outside; 10] = [
    (
        "x-current-oscillation",
        "amplitude_a",
        1e-5,
        Some(("period_s", 50.0)),
    ),
    ("x-charge-hysteresis", "width_c_per_cm2", 1e-3, None),
    ("x-dead-time", "dead_time_s", 0.5, None),
    ("x-limit-cycle", "modulation", 0.05, Some(("period_s", 80.0))),
    ("x-staircase", "step_per_cm", 2e-3, Some(("tread_s", 70.0))),
    ("x-event", "share", 0.1, Some(("event_time_s", 150.0))),
    ("x-wandering", "modulation", 0.02, Some(("seed", 1.0))),
    ("x-polarity-coupling", "ratio_change", 0.02, None),
    (
        "x-even-answer",
        "bending_per_cm_v2",
        2e-3,
        Some(("time_constant_s", 20.0)),
    ),
    ("x-polarity-memory", "change", 0.02, None),
];

/// Which strengths the truth simulator takes.
pub fn strength_bounds(id: &str) -> Bounds {
    known(id).map_or(Bounds::Real, |entry| entry.parameters[0].bounds)
}
