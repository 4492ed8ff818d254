//! Laws that are missing: told as deep as the readings tell, and not where nothing is missing.

use super::*;

const HEAT: Hidden = (
    "joule-heating",
    None,
    &[("softening_cm2_per_j", 2.0), ("cooling_time_s", 20.0)],
);

#[test]
fn a_law_is_told_with_its_variable_and_its_curve_and_the_account_adds_up() {
    let found = Runs::with(Some(HEAT), FOUR, 31).diagnosed();
    assert_eq!(
        found.verdict,
        Verdict::Law,
        "{} {:#?}",
        found.sentence,
        found.posterior
    );
    let law = &found.missing[0];
    assert_eq!(
        (law.place.as_str(), law.law.as_deref(), law.variable.as_deref()),
        ("current", Some("resistance"), Some("heat")),
        "{law:?}"
    );
    let curve = law.curve.as_ref().unwrap();
    for k in 0..curve.x.len() {
        assert!(curve.low_95[k] <= curve.y[k] && curve.y[k] <= curve.high_95[k]);
    }
    let account = found.account.unwrap();
    let whole: f64 = account.parts().iter().map(|(_, part)| part).sum();
    assert!((whole - 100.0).abs() < 1e-6, "{account:?}");
    assert!(account.share(account.within_runs) > 80.0, "{account:?}");
    let errors = (
        &law.held_out.error_percent_before,
        &law.held_out.error_percent_after,
    );
    assert!(errors.1.unwrap() < errors.0.unwrap(), "{law:?}");
    assert!(
        found.sentence.contains("resistance changes with the heat"),
        "{}",
        found.sentence
    );
}

/// The same misfit where the campaign tolerates more: right, and asked nothing more.
#[test]
fn a_misfit_below_what_is_tolerated_is_right() {
    let runs = Runs::with(Some(HEAT), FOUR, 31);
    let options = DiagnoseOptions {
        tolerance_percent: 100.0,
        ..DiagnoseOptions::default()
    };
    let found = diagnose_group("group", &runs.inputs(), &options);
    assert_eq!(found.verdict, Verdict::Right, "{}", found.sentence);
    assert!(found.p_misfit.unwrap() < 0.01 && found.missing.is_empty());
    assert!(
        found.sentence.starts_with("The simulation is right to "),
        "{}",
        found.sentence
    );
}

/// Steps to four voltages of a strip that leaks above 1.2 V.
fn leaky() -> Runs {
    let leak: Hidden = (
        "faradaic-leak",
        None,
        &[
            ("leak_current_a_per_cm2", 2e-6),
            ("onset_v", 1.2),
            ("slope_v", 0.15),
        ],
    );
    let drives: &[Levels] = &[&[(0.0, 0.8)], &[(0.0, 1.2)], &[(0.0, 1.6)], &[(0.0, 2.0)]];
    let base = sample([30.0, 0.02, 300.0, 0.03], 9000.0, 120.0, 0.002);
    Runs::beside(&base, &[leak], drives, 31)
}

/// Steps to four voltages tell nothing of a leak below the lowest and nothing of one below zero: there no curve is drawn.
#[test]
fn a_law_is_drawn_where_readings_tell_it() {
    let found = leaky().diagnosed();
    let curve = found.missing[0]
        .curve
        .as_ref()
        .expect("a law by voltage is drawn");
    let (first, last) = (curve.x[0], *curve.x.last().unwrap());
    assert!(
        (0.6..=0.8).contains(&first) && (last - 2.0).abs() < 1e-9,
        "{curve:?}"
    );
    // The whole steady current: what leaks beside the resistance.
    let steady_a_per_cm2 = |v: f64| v / 9000.0 + 2e-6 * ((v - 1.2) / 0.15_f64).exp_m1();
    assert_eq!(curve.unit, "A/cm2");
    let at = |v: f64| curve.x.iter().position(|x| (x - v).abs() < 1e-9).unwrap();
    let (found, hidden) = (
        curve.y[at(2.0)] - curve.y[at(1.6)],
        steady_a_per_cm2(2.0) - steady_a_per_cm2(1.6),
    );
    assert!((found / hidden - 1.0).abs() < 0.15, "{found} {hidden}");
    for k in 0..curve.x.len() {
        assert!(
            curve.without[k] <= 1.001 * curve.y[k],
            "the law takes current away: {curve:?}"
        );
    }
}

/// A thousandth of the first peak of the current is less than is tolerated; a third of the charge is more.
#[test]
fn a_leak_far_below_the_first_peak_is_told_by_its_charge() {
    let runs = leaky();
    let found = diagnose_group("group", &runs.inputs(), &DiagnoseOptions::default());
    let misfit = &found.misfit_percent;
    assert!(
        misfit.current.unwrap() < 1.0 && misfit.charge.unwrap() > 10.0,
        "{misfit:?}"
    );
    assert_eq!(found.verdict, Verdict::Law, "{}", found.sentence);
    // Of three voltages an equation is not told from every other curve, and hardly from a leak by the charge.
    assert_eq!(found.missing[0].place, "current");
    let leads = &found.posterior[0];
    let is_leak = leads.effect.as_deref() == Some("faradaic-leak");
    assert!(is_leak && leads.mass > 0.8, "{:?}", found.posterior);
}
