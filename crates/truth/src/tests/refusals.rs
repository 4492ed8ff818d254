//! What cannot be simulated is refused with what could be.

use super::*;

fn refused(truth: &Truth) -> String {
    let error = simulate(truth, &Drive::step(2.0), &[1.0], &[1.0], 0).unwrap_err();
    error.to_string()
}

#[test]
fn names_and_values_that_are_not_known_are_refused_with_those_that_are() {
    let unknown = refused(&with(effect("seriesresistance", None, &[])));
    assert!(unknown.starts_with("effect \"seriesresistance\" is not known; known are series-resistance, "));
    let variant = with(effect("faradaic-leak", Some("anode"), &[]));
    assert_eq!(
        refused(&variant),
        "effect faradaic-leak: variant \"anode\" is not known; known are terminal, capacitor"
    );
    let none = with(effect("softening", Some("cubic"), &[("cubic_cm2", 1.0)]));
    assert!(refused(&none).ends_with("known are none: the effect has no variants"));
    let form = with(effect("softening", Some("/langevin"), &[("cubic_cm2", 1.0)]));
    assert_eq!(
        refused(&form),
        "effect softening: form \"langevin\" is not known; known are asinh, stop"
    );
    let formless = with(effect("camera-zero", Some("/tanh"), &[("offset_per_cm", 1.0)]));
    assert!(refused(&formless).ends_with("known are none: the effect has one law"));
    let both = with(effect("softening", Some("cubic/stop"), &[("cubic_cm2", 1.0)]));
    assert!(refused(&both).contains("variant \"cubic\" is not known"));
    let key = with(effect("softening", None, &[("cubic", 1.0)]));
    assert_eq!(
        refused(&key),
        "effect softening: parameter \"cubic\" is not known; known are cubic_cm2"
    );
    let missing = with(effect(
        "warburg",
        None,
        &[("diffusion_capacitance_f_per_cm2", 0.1)],
    ));
    assert_eq!(
        refused(&missing),
        "effect warburg: parameter diffusion_time_s is missing; it needs a number above 0, such as 200"
    );
    let bad = with(effect("current-limit", None, &[("limit_a", 0.0)]));
    assert_eq!(
        refused(&bad),
        "effect current-limit: limit_a: found 0, needed a number above 0"
    );
}

#[test]
fn an_effect_twice_in_a_run_is_refused() {
    let mut sample = with(effect("camera-zero", None, &[("offset_per_cm", 0.1)]));
    sample.effects.push(sample.effects[0].clone());
    assert_eq!(
        refused(&sample),
        "effect camera-zero is named twice for one run; name it once"
    );
}

#[test]
fn what_the_sample_lacks_is_asked_for() {
    let mut sample = with(effect("tip-formula", None, &[]));
    sample.length_cm = None;
    assert!(refused(&sample).ends_with("needs the free length of the sample; give length_cm"));
    let mut one = with(effect("unequal-coupling", None, &[("ratio_change", 0.4)]));
    one.branches.truncate(1);
    assert!(refused(&one).contains("acts on branch 2, and the sample has 1 branch"));
    let mut none = truth();
    none.branches.clear();
    assert!(refused(&none).starts_with("branches: found 0"));
}

#[test]
fn a_drive_without_segments_is_refused() {
    let empty = Drive {
        baseline_v: 0.0,
        segments: Vec::new(),
    };
    let error = simulate(&truth(), &empty, &[1.0], &[], 0).unwrap_err();
    assert!(
        error.to_string().starts_with("drive: found 0 segments"),
        "{error}"
    );
}
