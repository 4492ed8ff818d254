//! Effects on the current, where the answer can be derived by hand.

use super::*;
use ieap_model::coupling::{ActiveArea, CurvaturePerArealCharge};
use ieap_model::distributed::Laminate;

/// The sample without a leak and without relaxation, with one branch.
fn one_branch() -> Truth {
    let mut sample = truth();
    sample.branches.truncate(1);
    sample.steady_state_resistance_ohm_cm2 = f64::INFINITY;
    sample.relaxation_rate_per_s = 0.0;
    sample
}

fn hiding(mut sample: Truth, effect: HiddenEffect) -> Truth {
    sample.effects.push(effect);
    sample
}

#[track_caller]
fn assert_current(sample: &Truth, drive: &Drive, expected: impl Fn(f64) -> f64, within: f64) {
    let time_s: Vec<f64> = (0..300).map(|k| 2.0 * f64::from(k)).collect();
    let found = respond(sample, drive, &time_s).current_a;
    let expected: Vec<f64> = time_s.iter().map(|&t| sample.area_cm2 * expected(t)).collect();
    let apart = apart(&found, &expected);
    assert!(apart < within, "{apart:e}");
}

#[test]
fn a_series_resistance_takes_part_of_the_voltage_at_once() {
    let sample = with(effect(
        "series-resistance",
        None,
        &[("series_resistance_ohm_cm2", 40.0)],
    ));
    let across: f64 = 1.0 / 521.4 + 1.0 / 1000.0 + 1.0 / 5660.0;
    let found = respond(&sample, &Drive::step(2.0), &[0.0, 1e5]).current_a;
    let expected = [0.1 * 2.0 / (40.0 + 1.0 / across), 0.1 * 2.0 / 5700.0];
    assert!(apart(&found, &expected) < 1e-7, "{found:?} {expected:?}");
}

#[test]
fn a_third_branch_is_the_closed_form_with_three() {
    for (name, c, tau) in [("slow", 0.06, 900.0), ("fast", 0.02, 0.8)] {
        let (c_key, tau_key) = (
            format!("{name}_capacitance_f_per_cm2"),
            format!("{name}_time_constant_s"),
        );
        let sample = with(effect(
            &format!("{name}-branch"),
            None,
            &[(&c_key, c), (&tau_key, tau)],
        ));
        let mut closed = model(&sample);
        closed.branches.push(Branch {
            resistance_ohm_cm2: tau / c,
            capacitance_f_per_cm2: c,
        });
        let drive = drive(0.0, &[(0.0, Some(2.0)), (150.0, None), (300.0, Some(0.0))]);
        let found = respond(&sample, &drive, &times());
        assert!(apart(&found.current_a, &closed.current_a(&drive, 0.1, &times())) < 1e-6);
        assert!(
            apart(
                &found.curvature_per_cm,
                &closed.curvature_per_cm(&drive, 0.1, &times())
            ) < 1e-6
        );
    }
}

#[test]
fn dispersion_is_the_mean_over_a_normal_spread_of_ln_tau() {
    let sample = hiding(
        one_branch(),
        effect("dispersion", Some("branch-1"), &[("log_spread", 0.6)]),
    );
    let (r, c) = (521.4, 0.098);
    let fine = |t: f64| {
        let (mut sum, mut whole) = (0.0, 0.0);
        for k in -300..=300 {
            let z = 0.02 * f64::from(k);
            let (weight, tau) = ((-0.5 * z * z).exp(), r * c * (0.6 * z).exp());
            sum += weight * 2.0 * c / tau * (-t / tau).exp();
            whole += weight;
        }
        sum / whole
    };
    assert_current(&sample, &Drive::step(2.0), fine, 1e-3);
}

#[test]
fn diffusion_into_a_sealed_film_is_the_sum_over_its_modes() {
    let (c, tau) = (0.03, 200.0);
    let mut sample = hiding(
        one_branch(),
        effect(
            "warburg",
            None,
            &[("diffusion_capacitance_f_per_cm2", c), ("diffusion_time_s", tau)],
        ),
    );
    sample.branches[0].capacitance_f_per_cm2 = 1e-9;
    let series = |t: f64| {
        let mode = |n: i32| (-(f64::from(n) - 0.5).powi(2) * std::f64::consts::PI.powi(2) * t / tau).exp();
        2.0 * 2.0 * c / tau * (1..200).map(mode).sum::<f64>()
    };
    let time_s: Vec<f64> = (1..200).map(f64::from).collect();
    let found = respond(&sample, &Drive::step(2.0), &time_s);
    for (k, &t) in time_s.iter().enumerate() {
        assert!((found.current_a[k] / (0.1 * series(t)) - 1.0).abs() < 2e-3, "{t}");
    }
    let filled = respond(&sample, &Drive::step(2.0), &[1e5]).curvature_per_cm[0];
    assert!((filled / (13.88 * 0.1 * 2.0 * c) - 1.0).abs() < 1e-6);
}

#[test]
fn capacitance_that_follows_the_voltage_stores_its_integral() {
    let stored = |sample: Truth, v: f64| {
        let found = respond(&sample, &Drive::step(v), &[1e5]).curvature_per_cm[0];
        found / (13.88 * 0.1)
    };
    let even = effect(
        "voltage-dependent-capacitance",
        None,
        &[("quadratic_per_v2", 0.2)],
    );
    let odd = effect("asymmetric-capacitance", None, &[("linear_per_v", 0.2)]);
    let c = 0.098;
    for v in [2.0, -2.0] {
        let expected = [c * (v + 0.2 * v * v * v / 3.0), c * (v + 0.2 * v * v / 2.0)];
        let found = [
            stored(hiding(one_branch(), even.clone()), v),
            stored(hiding(one_branch(), odd.clone()), v),
        ];
        assert!(apart(&found, &expected) < 1e-6, "{found:?} {expected:?}");
    }
    // From 1.9 V on the capacitance stays at 5 %.
    let floor = effect("asymmetric-capacitance", None, &[("linear_per_v", -0.5)]);
    let expected = c * (1.9 - 0.5 * 1.9 * 1.9 / 2.0 + 0.05 * 0.6);
    assert!((stored(hiding(one_branch(), floor), 2.5) / expected - 1.0).abs() < 1e-6);
}

#[test]
fn a_redox_peak_adds_its_charge_when_its_potential_is_passed() {
    let peak = effect(
        "redox-peak",
        None,
        &[("redox_charge_c_per_cm2", 0.05), ("redox_potential_v", 0.8)],
    );
    let mut sample = with(peak);
    sample.relaxation_rate_per_s = 0.0;
    let charge = |v: f64| respond(&sample, &Drive::step(v), &[1e5]).curvature_per_cm[0] / (13.88 * 0.1);
    assert!((charge(1.5) - 1.5 * 0.228 - 0.05).abs() < 1e-6);
    assert!((charge(0.4) - 0.4 * 0.228).abs() < 1e-6);
    assert!((charge(0.8) - 0.8 * 0.228 - 0.025).abs() < 1e-6);
    assert!((charge(-1.5) + 1.5 * 0.228).abs() < 1e-6);
}

#[test]
fn a_faradaic_leak_flows_steadily_above_its_onset_and_does_not_bend() {
    let law = [
        ("leak_current_a_per_cm2", 1e-5),
        ("onset_v", 1.2),
        ("slope_v", 0.2),
    ];
    for variant in ["terminal", "capacitor"] {
        let sample = with(effect("faradaic-leak", Some(variant), &law));
        for (v, leak) in [
            (2.0, 4.0_f64.exp_m1()),
            (-2.0, -4.0_f64.exp_m1()),
            (1.0, 0.0),
            // 19 slopes above the onset: along the tangent from 16 on.
            (5.0, 4.0 * 16.0_f64.exp() - 1.0),
        ] {
            let found = respond(&sample, &Drive::step(v), &[1e5]);
            let expected = 0.1 * (v / 5660.0 + 1e-5 * leak);
            assert!(
                (found.current_a[0] / expected - 1.0).abs() < 1e-6,
                "{variant} {v}"
            );
        }
        let drive = Drive::step(2.0);
        let base = respond(&truth(), &drive, &times()).curvature_per_cm;
        assert!(apart(&respond(&sample, &drive, &times()).curvature_per_cm, &base) < 1e-6);
    }
    // By the terminals it flows at once, by the capacitor only when that is charged.
    let at_once = |variant| {
        respond(
            &with(effect("faradaic-leak", Some(variant), &law)),
            &Drive::step(2.0),
            &[0.0],
        )
    };
    let more = at_once("terminal").current_a[0] - at_once("capacitor").current_a[0];
    assert!((more / (0.1 * 1e-5 * 4.0_f64.exp_m1()) - 1.0).abs() < 1e-9);
}

#[test]
fn a_diffusion_limited_leak_falls_with_the_root_of_time_since_the_edge() {
    let leak = effect(
        "diffusion-limited-leak",
        None,
        &[("leak_a_sqrt_s_per_v_cm2", 1e-3)],
    );
    let drive = drive(0.0, &[(0.0, Some(2.0)), (100.0, Some(-1.0))]);
    let closed = model(&truth());
    let added = |t: f64| {
        let (v, since) = if t < 100.0 { (2.0, t) } else { (-1.0, t - 100.0) };
        closed.current_a(&drive, 1.0, &[t])[0] + 1e-3 * v / (since + 0.05_f64).sqrt()
    };
    assert_current(&with(leak), &drive, added, 1e-6);
}

#[test]
fn self_discharge_ends_in_a_steady_current_and_a_lower_charge() {
    let g = 2e-4;
    let mut sample = with(effect(
        "self-discharge",
        None,
        &[("internal_conductance_s_per_cm2", g)],
    ));
    sample.relaxation_rate_per_s = 0.0;
    let found = respond(&sample, &Drive::step(2.0), &[1e5]);
    let expected = 0.1 * 2.0 * (1.0 / 5660.0 + 1.0 / (1000.0 + 1.0 / g));
    assert!((found.current_a[0] / expected - 1.0).abs() < 1e-6);
    let charge = 2.0 * (0.098 + 0.13 / (1.0 + g * 1000.0));
    assert!((found.curvature_per_cm[0] / (13.88 * 0.1 * charge) - 1.0).abs() < 1e-6);
    // It rests at the baseline as it ends at the step.
    let rest = respond(&sample, &drive(2.0, &[(0.0, Some(2.0))]), &[-1.0, 500.0]);
    assert!((rest.current_a[0] / expected - 1.0).abs() < 1e-9);
    assert!((rest.current_a[1] / expected - 1.0).abs() < 1e-9 && rest.curvature_per_cm[1].abs() < 1e-9);
}

#[test]
fn residual_charge_lowers_the_first_current() {
    let charged = |variant| {
        with(effect(
            "residual-charge",
            Some(variant),
            &[("residual_fraction", 0.2)],
        ))
    };
    let first = |variant| respond(&charged(variant), &Drive::step(2.0), &[-1.0, 0.0]);
    let (second, both) = (first("branch-2"), first("both"));
    let of = |f1: f64| 0.2 * ((1.0 - f1) / 521.4 + 0.8 / 1000.0 + 1.0 / 5660.0);
    assert!(apart(&second.current_a, &[0.0, of(0.0)]) < 1e-9);
    assert!(apart(&both.current_a, &[0.0, of(0.2)]) < 1e-9);
    assert_eq!(second.curvature_per_cm, [0.0, 0.0]);
}

#[test]
fn a_resistance_that_drifts_charges_by_a_power_of_time() {
    let sample = hiding(
        one_branch(),
        effect("resistance-drift", None, &[("drift_per_run", 0.3)]),
    );
    let (tau, a) = (521.4 * 0.098, 0.3 / 598.0);
    let exact = |t: f64| 2.0 * (1.0 + a * t).powf(-1.0 / (a * tau)) / (521.4 * (1.0 + a * t));
    assert_current(&sample, &Drive::step(2.0), exact, 1e-6);
}

#[test]
fn a_current_limit_charges_evenly_until_the_voltage_is_reached() {
    let sample = hiding(one_branch(), effect("current-limit", None, &[("limit_a", 2e-4)]));
    // 2 mA/cm2 of a first 3.8: e grows evenly until 2 V - 2 mA/cm2 R is left.
    let (r, c) = (521.4, 0.098);
    let until = c * (2.0 - 2e-3 * r) / 2e-3;
    let exact = |t: f64| 2e-3 * (-(t - until).max(0.0) / (r * c)).exp();
    assert_current(&sample, &Drive::step(2.0), exact, 1e-6);
    assert_current(&sample, &Drive::step(-2.0), |t| -exact(t), 1e-6);
}

#[test]
fn a_slow_source_is_convolved_with_its_rise() {
    let sample = hiding(one_branch(), effect("source-rise", None, &[("rise_time_s", 5.0)]));
    let tau = 521.4 * 0.098;
    let exact = |t: f64| 2.0 * 0.098 * ((-t / tau).exp() - (-t / 5.0).exp()) / (tau - 5.0);
    assert_current(&sample, &Drive::step(2.0), exact, 1e-6);
}

#[test]
fn a_contact_breaks_at_one_instant_of_one_run() {
    let of = |variant| {
        let keys = [("factor_change", 1.0), ("break_time_s", 100.0), ("run", 2.0)];
        with(effect("contact-break", Some(variant), &keys))
    };
    let time_s = [99.9, 100.0, 100.1];
    let base = respond(&truth(), &Drive::step(2.0), &time_s);
    let broken = |variant| simulate(&of(variant), &Drive::step(2.0), &time_s, &time_s, 2).unwrap();
    let resistance = broken("resistance");
    assert!((resistance.current_a[1] / base.current_a[1] - 0.5).abs() < 1e-6);
    assert!((resistance.curvature_per_cm[1] / base.curvature_per_cm[1] - 1.0).abs() < 1e-6);
    let coupling = broken("coupling");
    assert!((coupling.curvature_per_cm[1] / base.curvature_per_cm[1] - 2.0).abs() < 1e-6);
    assert!(apart(&coupling.current_a, &base.current_a) < 1e-6);
    let capacitance = broken("capacitance");
    assert!((capacitance.current_a[1] / base.current_a[1] - 1.0).abs() < 1e-6);
    assert!((capacitance.curvature_per_cm[1] / base.curvature_per_cm[1] - 1.0).abs() < 1e-6);
    assert!(capacitance.current_a[2] > base.current_a[2]);
    assert_eq!(respond(&of("resistance"), &Drive::step(2.0), &time_s), base);
}

#[test]
fn feedback_of_the_motion_acts_like_a_resistance_of_opposite_sign() {
    let gain = 5.0 * 13.88 * 0.1;
    let sample = hiding(
        one_branch(),
        effect("sensing-feedback", None, &[("emf_v_s_cm", 5.0)]),
    );
    let exact = |t: f64| 2.0 / (521.4 - gain) * (-t / ((521.4 - gain) * 0.098)).exp();
    assert_current(&sample, &Drive::step(2.0), exact, 1e-6);
}

#[test]
fn resistance_along_the_strip_is_the_distributed_model() {
    let mut sample = one_branch();
    sample.steady_state_resistance_ohm_cm2 = 5660.0;
    sample.relaxation_rate_per_s = 4e-3;
    (sample.length_cm, sample.width_cm) = (Some(2.0), Some(0.25));
    sample.area_cm2 = 0.5;
    let laminate = Laminate {
        electrode_resistance_ohm_per_sq: 300.0,
        branch: sample.branches[0],
        steady_state_resistance_ohm_cm2: 5660.0,
        coupling: CurvaturePerArealCharge(13.88 * 0.5),
        relaxation_rate_per_s: 4e-3,
    };
    let strip = laminate.strip(&ActiveArea {
        length_cm: 2.0,
        width_cm: 0.25,
    });
    let sample = hiding(
        sample,
        effect(
            "lengthwise-resistance",
            None,
            &[("electrode_resistance_ohm_per_sq", 300.0)],
        ),
    );
    let time_s: Vec<f64> = (1..100).map(|k| 3.0 * f64::from(k)).collect();
    let found = respond(&sample, &Drive::step(1.5), &time_s);
    let current = strip.clamp_current_a(1.5, &time_s);
    // The mean of the local curvatures is the tip's angle over the length.
    let mean: Vec<f64> = strip
        .tip_angle_rad(1.5, &time_s)
        .iter()
        .map(|angle| angle / 2.0)
        .collect();
    let (i, k) = (
        apart(&found.current_a, &current),
        apart(&found.curvature_per_cm, &mean),
    );
    assert!(i < 1e-3 && k < 1e-3, "{i:e} {k:e}");
}

#[test]
fn heat_is_even_in_the_voltage_and_water_is_odd() {
    let heat = with(effect(
        "joule-heating",
        None,
        &[("softening_cm2_per_j", 3.0), ("cooling_time_s", 30.0)],
    ));
    let water = with(effect(
        "water-redistribution",
        None,
        &[("change_cm2_per_c", 1.0), ("return_time_s", 200.0)],
    ));
    let t = [20.0];
    let base = respond(&truth(), &Drive::step(2.0), &t).current_a[0];
    let of = |sample: &Truth, v: f64| respond(sample, &Drive::step(v), &t).current_a[0] / v.signum() - base;
    assert!(of(&heat, 2.0) > 1e-3 * base && (of(&heat, -2.0) / of(&heat, 2.0) - 1.0).abs() < 1e-5);
    assert!(of(&water, 2.0) < -1e-3 * base && of(&water, -2.0) > 1e-3 * base);
}

#[test]
fn drying_needs_a_voltage_above_the_onset() {
    let drying = |onset| {
        let keys = [("growth_cm2_per_c", 3.0), ("onset_v", onset)];
        with(effect("electrolytic-drying", None, &keys))
    };
    let t: Vec<f64> = (0..100).map(f64::from).collect();
    let base = respond(&truth(), &Drive::step(2.0), &t).current_a;
    assert!(apart(&respond(&drying(2.1), &Drive::step(2.0), &t).current_a, &base) < 1e-7);
    let dried = respond(&drying(1.0), &Drive::step(2.0), &t).current_a;
    assert!(dried[30] < base[30] * (1.0 - 1e-4));
    // Just after a new edge the capacitors stand: the current says R_1 and R_2, grown by the charge that has leaked.
    let again = drive(0.0, &[(0.0, Some(2.0)), (100.0, Some(0.0))]);
    let jump = |sample: &Truth| {
        let found = respond(sample, &again, &[100.0 - 1e-9, 100.0]).current_a;
        found[0] - found[1] - 0.1 * 2.0 / 5660.0
    };
    let ratio = jump(&truth()) / jump(&drying(1.0));
    assert!(
        (ratio - (1.0 + 3.0 * 100.0 * 2.0 / 5660.0)).abs() < 1e-5,
        "{ratio}"
    );
}

#[test]
fn water_from_the_air_ends_in_another_resistance() {
    let sample = with(effect(
        "water-exchange",
        None,
        &[("change", 0.25), ("time_constant_s", 20.0)],
    ));
    let again = drive(0.0, &[(0.0, Some(2.0)), (400.0, Some(0.0))]);
    let jump = |sample: &Truth| {
        let found = respond(sample, &again, &[400.0 - 1e-9, 400.0]).current_a;
        found[0] - found[1] - 0.1 * 2.0 / 5660.0
    };
    assert!((jump(&truth()) / jump(&sample) - 1.25).abs() < 1e-6);
}

#[test]
fn warmth_makes_time_run_faster() {
    let mut sample = with(effect("ambient-temperature", None, &[("drift_per_run", 0.4)]));
    sample.steady_state_resistance_ohm_cm2 = f64::INFINITY;
    let time_s: Vec<f64> = (0..=600).map(f64::from).collect();
    let warped: Vec<f64> = time_s.iter().map(|t| t + 0.4 * t * t / 1200.0).collect();
    let found = respond(&sample, &Drive::step(2.0), &time_s).curvature_per_cm;
    let closed = model(&sample).curvature_per_cm(&Drive::step(2.0), 0.1, &warped);
    assert!(apart(&found, &closed) < 1e-6);
}

#[test]
fn an_electrode_that_bends_resists_by_its_curvature() {
    let sample = with(effect("piezoresistive-electrode", None, &[("gauge_cm", 0.3)]));
    let again = drive(0.0, &[(0.0, Some(2.0)), (100.0, Some(0.0))]);
    let found = respond(&sample, &again, &[100.0 - 1e-9, 100.0]);
    let base = respond(&truth(), &again, &[100.0 - 1e-9, 100.0]);
    let jump = |r: &TruthResponses| r.current_a[0] - r.current_a[1] - 0.1 * 2.0 / 5660.0;
    let expected = 1.0 + 0.3 * found.curvature_per_cm[1];
    assert!((jump(&base) / jump(&found) / expected - 1.0).abs() < 1e-6);
}
