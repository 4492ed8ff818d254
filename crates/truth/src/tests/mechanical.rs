//! Effects on the curvature, where the answer can be derived by hand.

use statrs::function::erf::erfc;

use super::*;

/// The sample with one branch that is charged in half a millisecond, so that a step of voltage is one of charge.
fn fast() -> Truth {
    let mut sample = truth();
    sample.branches = vec![Branch {
        resistance_ohm_cm2: 0.005,
        capacitance_f_per_cm2: 0.1,
    }];
    sample
}

/// Curvature of the fast sample's charge at 2 V without relaxation, 1/cm.
const CHARGED: f64 = 13.88 * 0.1 * 2.0 * 0.1;

fn hiding(mut sample: Truth, effect: HiddenEffect) -> Truth {
    sample.effects.push(effect);
    sample
}

#[track_caller]
fn assert_curvature(sample: &Truth, drive: &Drive, expected: impl Fn(f64) -> f64, within: f64) {
    let time_s: Vec<f64> = (1..300).map(|k| 2.0 * f64::from(k)).collect();
    let found = respond(sample, drive, &time_s).curvature_per_cm;
    let expected: Vec<f64> = time_s.iter().map(|&t| expected(t)).collect();
    let apart = apart(&found, &expected);
    assert!(apart < within, "{apart:e}");
}

/// The closed form's curvature of the sample's base model.
fn closed(sample: &Truth, drive: &Drive, t: f64) -> f64 {
    model(sample).curvature_per_cm(drive, sample.area_cm2, &[t])[0]
}

fn charge_c(drive: &Drive, t: f64) -> f64 {
    model(&truth()).charge_c(drive, 0.1, &[t])[0]
}

fn reversed() -> Drive {
    drive(0.0, &[(0.0, Some(2.0)), (200.0, Some(-2.0))])
}

#[test]
fn partial_relaxation_leaves_a_plateau() {
    let sample = with(effect("partial-relaxation", None, &[("fraction", 0.3)]));
    let plateau = respond(&sample, &Drive::step(2.0), &[1e5]).curvature_per_cm[0];
    assert!((plateau / (0.3 * 13.88 * 0.1 * 2.0 * 0.228) - 1.0).abs() < 1e-6);
}

#[test]
fn two_rates_are_the_mean_of_two_relaxations() {
    let sample = with(effect(
        "second-relaxation",
        None,
        &[("weight", 0.3), ("rate_ratio", 8.0)],
    ));
    let mut faster = truth();
    faster.relaxation_rate_per_s *= 8.0;
    let exact = |t| 0.7 * closed(&truth(), &reversed(), t) + 0.3 * closed(&faster, &reversed(), t);
    assert_curvature(&sample, &reversed(), exact, 1e-6);
}

#[test]
fn fractional_relaxation_of_half_order_is_a_complementary_error_function() {
    let half = effect("fractional-relaxation", None, &[("order_shortfall", 0.5)]);
    let exact = |t: f64| {
        let z = (4e-3 * t).sqrt();
        CHARGED * (z * z).exp() * erfc(z)
    };
    assert_curvature(&hiding(fast(), half), &Drive::step(2.0), exact, 2e-4);
}

#[test]
fn fractional_relaxation_near_order_one_is_nearly_the_base_model() {
    let near = with(effect(
        "fractional-relaxation",
        None,
        &[("order_shortfall", 0.001)],
    ));
    assert_curvature(&near, &reversed(), |t| closed(&truth(), &reversed(), t), 5e-3);
}

#[test]
fn modulus_and_softening_are_functions_of_the_curvature_alone() {
    let drift = effect(
        "modulus-drift",
        None,
        &[("softening", 0.25), ("time_constant_s", 90.0)],
    );
    let drifted = |t: f64| closed(&truth(), &reversed(), t) / (1.0 + 0.25 * (-t / 90.0_f64).exp_m1());
    assert_curvature(&with(drift), &reversed(), drifted, 1e-6);
    for b in [2.0, -0.5] {
        let sample = with(effect("softening", None, &[("cubic_cm2", b)]));
        let time_s = times();
        let found = respond(&sample, &reversed(), &time_s).curvature_per_cm;
        let back: Vec<f64> = found.iter().map(|k| k * (1.0 + b * k * k)).collect();
        let base: Vec<f64> = time_s.iter().map(|&t| closed(&truth(), &reversed(), t)).collect();
        assert!(apart(&back, &base) < 1e-6);
    }
}

#[test]
fn a_strip_with_inertia_overshoots_after_half_a_period() {
    let mut sample = fast();
    sample.relaxation_rate_per_s = 0.0;
    let (period, z) = (20.0, 0.1_f64);
    let sample = hiding(
        sample,
        effect("resonance", None, &[("period_s", period), ("damping", z)]),
    );
    let damped = period / (1.0 - z * z).sqrt();
    let time_s = [0.5 * damped, damped, 300.0];
    let found = respond(&sample, &Drive::step(2.0), &time_s).curvature_per_cm;
    let over = (-std::f64::consts::PI * z / (1.0 - z * z).sqrt()).exp();
    let expected = [CHARGED * (1.0 + over), CHARGED * (1.0 - over * over), CHARGED];
    assert!(apart(&found, &expected) < 1e-3, "{found:?} {expected:?}");
}

#[test]
fn a_lag_is_an_exponential_approach() {
    let mut sample = fast();
    sample.relaxation_rate_per_s = 0.0;
    let sample = hiding(sample, effect("mechanical-lag", None, &[("lag_s", 8.0)]));
    let exact = |t: f64| CHARGED * (1.0 - 8.0 / (8.0 - 5e-4) * (-t / 8.0).exp());
    assert_curvature(&sample, &Drive::step(2.0), exact, 1e-6);
}

#[test]
fn friction_holds_the_strip_until_the_play_is_used_up() {
    let w = 0.02;
    let sample = with(effect("friction", None, &[("width_per_cm", w)]));
    let drive = Drive::step(2.0);
    let peak = (0..6000)
        .map(|k| closed(&truth(), &drive, 0.1 * f64::from(k)))
        .fold(0.0, f64::max);
    let exact = |t: f64| {
        let free = closed(&truth(), &drive, t);
        let rising = closed(&truth(), &drive, t + 0.01) > free;
        if rising {
            (free - w).max(0.0)
        } else {
            (free + w).min(peak - w)
        }
    };
    // The memory moves at the ends of steps, at each reading at least: up to kappa'' h^2/8 of the peak is missed,
    // 1.5e-5 of it for readings 2 s apart and rates of 1/130 s and 1/250 s.
    assert_curvature(&sample, &drive, exact, 2e-5);
}

#[test]
fn creep_and_moisture_add_functions_of_clock_time() {
    let both = |t: f64| 0.01 * (t / 5.0).ln_1p();
    for (variant, sign) in [("even", 1.0), ("odd", -1.0)] {
        let creep = effect(
            "creep",
            Some(variant),
            &[("creep_per_cm", 0.01), ("onset_s", 5.0)],
        );
        let exact = |t| closed(&truth(), &Drive::step(-2.0), t) + sign * both(t);
        assert_curvature(&with(creep), &Drive::step(-2.0), exact, 1e-6);
    }
    let moist = effect(
        "moisture-bending",
        None,
        &[("bending_per_cm", 0.05), ("time_constant_s", 100.0)],
    );
    let exact = |t: f64| closed(&truth(), &reversed(), t) - 0.05 * (-t / 100.0_f64).exp_m1();
    assert_curvature(&with(moist), &reversed(), exact, 1e-6);
}

#[test]
fn branches_that_bend_unequally_are_a_weighted_sum() {
    let only = |index: usize| {
        let mut sample = truth();
        sample.branches = vec![sample.branches[index]];
        sample
    };
    let sample = with(effect("unequal-coupling", None, &[("ratio_change", -0.4)]));
    let exact = |t| closed(&only(0), &reversed(), t) + 0.6 * closed(&only(1), &reversed(), t);
    assert_curvature(&sample, &reversed(), exact, 1e-6);
}

#[test]
fn counter_flow_at_the_relaxation_rate_is_partial_relaxation_of_opposite_sign() {
    let counter = with(effect(
        "counter-flow",
        None,
        &[("fraction", 0.3), ("time_constant_s", 250.0)],
    ));
    let partial = with(effect("partial-relaxation", None, &[("fraction", -0.3)]));
    let (one, other) = (
        respond(&counter, &reversed(), &times()).curvature_per_cm,
        respond(&partial, &reversed(), &times()).curvature_per_cm,
    );
    assert!(apart(&one, &other) < 1e-6);
}

#[test]
fn a_quadratic_coupling_adds_the_square_of_the_charge() {
    let direct = effect(
        "quadratic-coupling",
        Some("direct"),
        &[("quadratic_cm_per_c2", 60.0)],
    );
    let exact = |t| closed(&truth(), &reversed(), t) + 60.0 * charge_c(&reversed(), t).powi(2);
    assert_curvature(&with(direct), &reversed(), exact, 1e-6);
    let relaxing = effect(
        "quadratic-coupling",
        Some("relaxing"),
        &[("quadratic_cm_per_c2", 60.0)],
    );
    let square = 60.0 * (0.1_f64 * 2.0 * 0.1).powi(2);
    let relaxed = |t: f64| (CHARGED + square) * (-4e-3 * t).exp();
    assert_curvature(&hiding(fast(), relaxing), &Drive::step(2.0), relaxed, 2e-3);
    // A discharge starts from the square of the charge that it had.
    let direct = effect("quadratic-coupling", None, &[("quadratic_cm_per_c2", 60.0)]);
    let shorted = drive(2.0, &[(0.0, Some(0.0))]);
    let start = 60.0 * (2.0_f64 * 0.0228).powi(2);
    let exact = |t| closed(&truth(), &shorted, t) + 60.0 * charge_c(&shorted, t).powi(2) - start;
    assert_curvature(&with(direct), &shorted, exact, 1e-6);
}

#[test]
fn a_leak_that_bends_leaves_a_relaxing_plateau() {
    let sample = with(effect("leak-coupling", None, &[]));
    let plateau = respond(&sample, &Drive::step(2.0), &[1e4]).curvature_per_cm[0];
    assert!((plateau / (13.88 * 0.1 * 2.0 / 5660.0 / 4e-3) - 1.0).abs() < 1e-6);
}

#[test]
fn saturation_acts_before_or_after_relaxation() {
    let of = |variant| {
        effect(
            "coupling-saturation",
            Some(variant),
            &[("inverse_charge_per_c", 10.0)],
        )
    };
    let after = |t: f64| closed(&truth(), &reversed(), t) / (1.0 + 10.0 * charge_c(&reversed(), t).abs());
    assert_curvature(&with(of("gain")), &reversed(), after, 1e-6);
    let before = |t: f64| CHARGED / (1.0 + 10.0 * 0.02) * (-4e-3 * t).exp();
    assert_curvature(&hiding(fast(), of("drive")), &Drive::step(2.0), before, 1e-3);
}

#[test]
fn above_a_threshold_the_strain_relaxes_faster() {
    let keys = [("steepness", 1.5), ("threshold_v", 1.0)];
    let sample = with(effect("threshold-relaxation", None, &keys));
    let mut faster = truth();
    faster.relaxation_rate_per_s *= 2.5;
    assert_curvature(
        &sample,
        &Drive::step(-2.0),
        |t| closed(&faster, &Drive::step(-2.0), t),
        1e-6,
    );
    assert_curvature(
        &sample,
        &Drive::step(0.9),
        |t| closed(&truth(), &Drive::step(0.9), t),
        1e-6,
    );
}

#[test]
fn constants_stand_before_the_step_too() {
    for id in ["precurvature", "camera-zero"] {
        let sample = with(effect(id, None, &[("offset_per_cm", 0.07)]));
        let found = respond(&sample, &Drive::step(2.0), &[-5.0, 30.0]).curvature_per_cm;
        let expected = [0.07, closed(&truth(), &Drive::step(2.0), 30.0) + 0.07];
        assert!(apart(&found, &expected) < 1e-6);
    }
}

#[test]
fn a_late_camera_and_a_wrong_clock_show_another_instant() {
    let late = with(effect("camera-delay", None, &[("delay_s", 3.0)]));
    assert_curvature(
        &late,
        &reversed(),
        |t| closed(&truth(), &reversed(), t - 3.0),
        1e-6,
    );
    let early = with(effect("camera-delay", None, &[("delay_s", -3.0)]));
    assert_curvature(
        &early,
        &reversed(),
        |t| closed(&truth(), &reversed(), t + 3.0),
        1e-6,
    );
    let fast = with(effect("clock-rate", None, &[("rate_error", 0.02)]));
    assert_curvature(
        &fast,
        &reversed(),
        |t| closed(&truth(), &reversed(), 1.02 * t),
        1e-6,
    );
}

#[test]
fn an_exposure_shows_the_mean() {
    let sample = with(effect("exposure-smoothing", None, &[("exposure_s", 4.0)]));
    let mean = |t: f64| {
        let at = |k: i32| closed(&truth(), &reversed(), t - 4.0 * (f64::from(k) + 0.5) / 4000.0);
        (0..4000).map(at).sum::<f64>() / 4000.0
    };
    assert_curvature(&sample, &reversed(), mean, 1e-6);
}

#[test]
fn formulas_of_the_shape_are_functions_of_the_curvature() {
    let measured = |id, variant, keys: &[(&str, f64)], formula: &dyn Fn(f64) -> f64| {
        let mut sample = with(effect(id, variant, keys));
        sample.length_cm = Some(1.2);
        assert_curvature(
            &sample,
            &reversed(),
            |t| formula(closed(&truth(), &reversed(), t)),
            1e-6,
        );
    };
    measured("tip-formula", Some("arc"), &[], &|k| {
        k * (1.0 - (1.2 * k).powi(2) / 3.0)
    });
    measured("tip-formula", Some("axis"), &[("applied", 1.0)], &|k| {
        k * (1.0 + (1.2 * k).powi(2) / 4.0)
    });
    measured("noncircular-shape", None, &[("bias_cm", -0.3)], &|k| {
        k * (1.0 - 0.3 * k.abs())
    });
}

#[test]
fn effects_outside_of_any_library_do_what_they_say() {
    let time_s = times();
    let base = |t: f64| model(&truth()).current_a(&reversed(), 0.1, &[t])[0];
    let swing = with(effect(
        "x-current-oscillation",
        None,
        &[("amplitude_a", 2e-5), ("period_s", 50.0)],
    ));
    let found = respond(&swing, &reversed(), &time_s).current_a;
    let expected: Vec<f64> = time_s
        .iter()
        .map(|&t| base(t) + 2e-5 * (std::f64::consts::TAU * t.max(0.0) / 50.0).sin())
        .collect();
    assert!(apart(&found, &expected) < 1e-6);
    let dead = with(effect("x-dead-time", None, &[("dead_time_s", 4.0)]));
    let found = respond(&dead, &reversed(), &time_s);
    let later: Vec<f64> = time_s.iter().map(|t| t - 4.0).collect();
    let base = respond(&truth(), &reversed(), &later);
    assert!(apart(&found.current_a, &base.current_a) < 1e-6);
    assert!(apart(&found.curvature_per_cm, &base.curvature_per_cm) < 1e-6);
}

#[test]
fn play_in_the_charge_relaxes_from_where_it_stops() {
    let mut sample = fast();
    sample.effects = vec![effect("x-charge-hysteresis", None, &[("width_c_per_cm2", 0.03)])];
    let there_and_back = drive(0.0, &[(0.0, Some(2.0)), (100.0, Some(0.0))]);
    let exact = |t: f64| {
        // 0.2 C/cm2 less the play; back by 0.2 less the play on both sides.
        let forth = 0.17 * (-4e-3 * t).exp();
        let back = if t > 100.0 {
            0.14 * (-4e-3 * (t - 100.0)).exp()
        } else {
            0.0
        };
        13.88 * 0.1 * (forth - back)
    };
    assert_curvature(&sample, &there_and_back, exact, 2e-3);
}

#[test]
fn a_limit_cycle_keeps_swinging() {
    let sample = with(effect(
        "x-limit-cycle",
        None,
        &[("modulation", 0.3), ("period_s", 60.0)],
    ));
    let mut sealed = truth();
    sealed.effects = sample.effects;
    // A slow branch makes the modulated current last.
    sealed.branches[1].capacitance_f_per_cm2 = 10.0;
    let time_s: Vec<f64> = (600..1200).map(f64::from).collect();
    let found = respond(&sealed, &Drive::step(2.0), &time_s).current_a;
    sealed.effects.clear();
    let base = respond(&sealed, &Drive::step(2.0), &time_s).current_a;
    let ratio: Vec<f64> = found.iter().zip(&base).map(|(a, b)| a / b - 1.0).collect();
    let crossings = ratio.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count();
    // Van der Pol's oscillator with mu = 1 has a period of 1.06 times the linear one: about 9.4 in 600 s.
    assert!((17..=20).contains(&crossings), "{crossings}");
}
