//! Foreign forms: each another law than its effect's own, in limits that are derived by hand; and causes outside of any
//! library that keep a memory.

use super::super::catalogue::{KNOWN, known};
use super::super::forms::{drifted, reached, unsaturated};
use super::listed::hidden;
use super::*;

/// Begun at another voltage than 2 V, with both polarities, an open circuit and a short.
fn varied() -> Drive {
    let levels = [
        (0.0, Some(-1.5)),
        (200.0, Some(0.0)),
        (260.0, Some(2.0)),
        (400.0, None),
        (480.0, Some(1.0)),
    ];
    drive(0.0, &levels)
}

/// Charged within seconds, so that motion and source have something to follow.
fn brisk(effects: Vec<HiddenEffect>) -> Truth {
    let mut sample = truth();
    sample.effects = effects;
    for (branch, resistance) in sample.branches.iter_mut().zip([30.0, 120.0]) {
        branch.resistance_ohm_cm2 = resistance;
    }
    sample
}

/// Larger of the differences of the channels, against the largest that there is.
fn differ(one: &TruthResponses, other: &TruthResponses) -> f64 {
    let current = apart(&one.current_a, &other.current_a);
    current.max(apart(&one.curvature_per_cm, &other.curvature_per_cm))
}

#[test]
fn every_foreign_form_has_another_course_than_every_own_form_and_every_other() {
    for entry in KNOWN.iter().filter(|entry| !entry.forms.is_empty()) {
        let of = |variant: Option<&str>| {
            let sample = brisk(vec![hidden(entry, variant, 1.0)]);
            respond(&sample, &varied(), &times())
        };
        let own = entry.variants.iter().map(|variant| Some(*variant));
        let own: Vec<Option<&str>> = own.chain(entry.variants.is_empty().then_some(None)).collect();
        let mut courses: Vec<(&str, TruthResponses)> = own
            .into_iter()
            .map(|variant| (variant.unwrap_or("its own law"), of(variant)))
            .collect();
        courses.push(("nothing", respond(&brisk(Vec::new()), &varied(), &times())));
        for form in entry.forms {
            let found = of(Some(&format!("/{form}")));
            for (name, other) in &courses {
                let by = differ(&found, other);
                assert!(by > 1e-4, "{} {form} from {name}: {by:e}", entry.id);
            }
            courses.push((form, found));
        }
    }
}

#[test]
fn a_form_keeps_the_variant() {
    let entry = known("coupling-saturation").unwrap();
    let of = |variant: &str| respond(&with(hidden(entry, Some(variant), 1.0)), &varied(), &times());
    assert_eq!(of("/tanh"), of("drive/tanh"));
    assert!(differ(&of("gain/tanh"), &of("drive/tanh")) > 1e-3);
}

#[test]
fn laws_of_saturation_begin_at_one_and_fall_to_what_saturates() {
    for law in ["tanh", "langevin", "hard", ""] {
        assert!((unsaturated(law, 1e-6) - 1.0).abs() < 2e-6, "{law}");
        // The charge times what is left of it: 1, and 3 of the dipoles'.
        let most = if law == "langevin" { 3.0 } else { 1.0 };
        assert!((1e4 * unsaturated(law, 1e4) / most - 1.0).abs() < 1e-3, "{law}");
    }
    for law in ["tanh", "langevin"] {
        let (series, whole) = (unsaturated(law, 0.999e-3), unsaturated(law, 1.001e-3));
        assert!((series - whole).abs() < 1e-8, "{law}: {series} {whole}");
    }
    assert_eq!([0.5, 2.0].map(|z| unsaturated("hard", z)), [1.0, 0.5]);
}

#[test]
fn laws_of_time_go_from_none_to_all() {
    for law in ["", "hyperbolic", "stretched", "late"] {
        assert_eq!(reached(law, 0.0), 0.0, "{law}");
        assert!((reached(law, 1e4) - 1.0).abs() < 1e-3, "{law}");
    }
    assert_eq!(
        ["", "root", "cubic"].map(|law| drifted(law, 0.25)),
        [0.25, 0.5, 0.015_625]
    );
    assert!(drifted("wave", 0.5).abs() < 1e-12);
}

#[test]
fn a_late_series_resistance_is_none_at_first_and_whole_at_last() {
    let late = |form: &str| {
        let ohm = [("series_resistance_ohm_cm2", 40.0)];
        let sample = with(effect("series-resistance", Some(form), &ohm));
        respond(&sample, &Drive::step(2.0), &[0.0, 1e5]).current_a
    };
    let across: f64 = 1.0 / 521.4 + 1.0 / 1000.0 + 1.0 / 5660.0;
    let at_last = 0.1 * 2.0 / 5700.0;
    assert!(apart(&late("/late"), &[0.1 * 2.0 * across, at_last]) < 1e-7);
    let half = 0.1 * 2.0 / (20.0 + 1.0 / across);
    assert!(apart(&late("/partly-late"), &[half, at_last]) < 1e-7);
}

#[test]
fn a_film_of_any_form_takes_up_its_whole_charge() {
    for (form, bends) in [("", 1.0), ("/widening", 1.0), ("/silent", 0.0)] {
        let film = [
            ("diffusion_capacitance_f_per_cm2", 0.03),
            ("diffusion_time_s", 200.0),
        ];
        let mut sample = with(effect(
            "warburg",
            Some(form).filter(|form| !form.is_empty()),
            &film,
        ));
        sample.relaxation_rate_per_s = 0.0;
        let bent = respond(&sample, &Drive::step(2.0), &[2e4]).curvature_per_cm;
        let charge = 0.1 * 2.0 * (0.098 + 0.13 + 0.03 * bends);
        assert!(apart(&bent, &[13.88 * charge]) < 1e-6, "{form}: {bent:?}");
    }
}

#[test]
fn a_crack_parts_a_strip_in_two() {
    // With electrodes that all but break behind the first third, the last two are charged late.
    let ohm = [("electrode_resistance_ohm_per_sq", 1e5)];
    let sample = with(effect("lengthwise-resistance", Some("/crack"), &ohm));
    let found = respond(&sample, &Drive::step(2.0), &[0.0]).current_a[0];
    let whole = respond(&truth(), &Drive::step(2.0), &[0.0]).current_a[0];
    let share = found / whole;
    assert!((0.25..0.45).contains(&share), "{share}");
}

#[test]
fn staircase_and_event_stand_where_they_are_put() {
    let time_s = times();
    let plain = respond(&truth(), &varied(), &time_s);
    let stairs = with(effect(
        "x-staircase",
        None,
        &[("step_per_cm", 0.02), ("tread_s", 70.0)],
    ));
    let found = respond(&stairs, &varied(), &time_s).curvature_per_cm;
    for ((t, found), plain) in time_s.iter().zip(&found).zip(&plain.curvature_per_cm) {
        let steps = (t / 70.0).floor().max(0.0);
        assert!((found - plain - 0.02 * steps).abs() < 1e-12, "{t}");
    }
    let event = [("share", 0.3), ("event_time_s", 150.0), ("recovery_s", 30.0)];
    let bumped = with(effect("x-event", Some("current"), &event));
    let found = respond(&bumped, &varied(), &time_s).current_a;
    for ((t, found), plain) in time_s.iter().zip(&found).zip(&plain.current_a) {
        let share = if *t < 150.0 {
            0.0
        } else {
            0.3 * (-(t - 150.0) / 30.0).exp()
        };
        assert!((found - plain * (1.0 + share)).abs() < 1e-15, "{t}");
    }
}

#[test]
fn only_negative_charge_bends_otherwise() {
    let sample = with(effect("x-polarity-coupling", None, &[("ratio_change", 0.3)]));
    let (forth, back) = (drive(0.0, &[(0.0, Some(1.0))]), drive(0.0, &[(0.0, Some(-1.0))]));
    let of = |drive| respond(&sample, drive, &times()).curvature_per_cm;
    let plain = respond(&truth(), &forth, &times()).curvature_per_cm;
    assert!(apart(&of(&forth), &plain) < 1e-9);
    let turned: Vec<f64> = plain.iter().map(|k| -1.3 * k).collect();
    assert!(apart(&of(&back), &turned) < 1e-6);
}

#[test]
fn an_even_answer_is_alike_for_both_polarities() {
    let answer = [("bending_per_cm_v2", 0.02), ("time_constant_s", 20.0)];
    let sample = with(effect("x-even-answer", None, &answer));
    let time_s = times();
    let of = |v: f64| respond(&sample, &Drive::step(v), &time_s).curvature_per_cm;
    let (forth, back) = (of(1.5), of(-1.5));
    let even: Vec<f64> = forth.iter().zip(&back).map(|(a, b)| 0.5 * (a + b)).collect();
    let exact = |t: &f64| 0.02 * 2.25 * -(-t.max(0.0) / 20.0).exp_m1();
    assert!(apart(&even, &time_s.iter().map(exact).collect::<Vec<_>>()) < 1e-5);
}

#[test]
fn the_polarity_before_is_remembered_through_zeros() {
    let sample = with(effect("x-polarity-memory", None, &[("change", 0.2)]));
    let edge = |levels: &[(f64, Option<f64>)]| {
        let at = [levels[levels.len() - 1].0];
        let whole = drive(0.0, levels);
        let of = |truth: &Truth| respond(truth, &whole, &at).current_a[0];
        // The jump at the edge goes as the conductance, R_ss apart.
        let before = 0.1 * levels[levels.len() - 1].1.unwrap() / 5660.0;
        (of(&sample) - before) / (of(&truth()) - before)
    };
    // Slow states have no time to tell: 3000 s at 0 V empty the strip.
    let apart = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-4, "{found} {expected}");
    apart(edge(&[(0.0, Some(2.0))]), 1.0);
    apart(
        edge(&[(0.0, Some(2.0)), (50.0, Some(0.0)), (3050.0, Some(1.0))]),
        1.0 / 1.2,
    );
    apart(
        edge(&[(0.0, Some(2.0)), (50.0, Some(0.0)), (3050.0, Some(-1.0))]),
        1.0 / 0.8,
    );
}

#[test]
fn a_walk_differs_from_run_to_run() {
    let walk = [("modulation", 0.2), ("seed", 3.0)];
    let sample = with(effect("x-wandering", Some("relaxation"), &walk));
    let of = |run| simulate(&sample, &Drive::step(2.0), &times(), &times(), run).unwrap();
    assert_eq!(of(0), of(0));
    assert!(apart(&of(0).curvature_per_cm, &of(1).curvature_per_cm) > 1e-2);
}
