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

/// The same misfit where the campaign tolerates more: right, and what it misses is told all the same.
#[test]
fn a_misfit_below_what_is_tolerated_is_right() {
    let runs = Runs::with(Some(HEAT), FOUR, 31);
    let options = DiagnoseOptions {
        tolerance_percent: 100.0,
        ..DiagnoseOptions::default()
    };
    let found = diagnose_group("group", &runs.inputs(), &options);
    assert_eq!(found.verdict, Verdict::Right, "{}", found.sentence);
    assert!(found.p_misfit.unwrap() < 0.01);
    assert_eq!(
        found.missing[0].law.as_deref(),
        Some("resistance"),
        "{:#?}",
        found.missing
    );
    assert!(
        found.sentence.starts_with("The simulation is right to ")
            && found.sentence.contains("What it misses is"),
        "{}",
        found.sentence
    );
}

/// Steps of a strip that leaks above 1.2 V, to voltages of which others lie on both sides.
fn leaky() -> Runs {
    static VOLTS: [[(f64, f64); 1]; 6] = [
        [(0.0, 0.8)],
        [(0.0, 1.2)],
        [(0.0, 1.4)],
        [(0.0, 1.6)],
        [(0.0, 1.8)],
        [(0.0, 2.0)],
    ];
    of_leak(&VOLTS.each_ref().map(|own| own as Levels))
}

fn of_leak(drives: &[Levels]) -> Runs {
    let leak: Hidden = (
        "faradaic-leak",
        None,
        &[
            ("leak_current_a_per_cm2", 2e-6),
            ("onset_v", 1.2),
            ("slope_v", 0.15),
        ],
    );
    let base = sample([30.0, 0.02, 300.0, 0.03], 9000.0, 120.0, 0.002);
    Runs::beside(&base, &[leak], drives, 31)
}

/// Steps tell nothing of a leak below the lowest voltage and nothing of one below zero: there no curve is drawn.
#[test]
fn a_law_is_drawn_where_readings_tell_it() {
    let diagnosed = leaky().diagnosed();
    let curve = diagnosed.missing[0]
        .curve
        .as_ref()
        .expect("a law by voltage is drawn");
    let (first, last) = (curve.x[0], *curve.x.last().unwrap());
    assert!(
        (first - 0.8).abs() < 1e-9 && (last - 2.0).abs() < 1e-9,
        "{curve:?}"
    );
    // What is drawn is what is told and adopted: it carries the steady current of the model's own parameters.
    let adopted = diagnosed.effects.last().unwrap();
    let told = &diagnosed.missing[0];
    let is_named = told
        .name
        .iter()
        .chain(&told.names)
        .any(|name| *name == adopted.effect);
    assert!(
        is_named || adopted.effect.starts_with("law:leak"),
        "{adopted:?} {told:?}"
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
    assert_eq!(
        found.verdict,
        Verdict::Law,
        "{} {:#?}",
        found.sentence,
        found.posterior
    );
    assert_eq!(found.missing[0].place, "current");
    let leads = &found.posterior[0];
    let is_leak = leads.effect.as_deref() == Some("faradaic-leak");
    assert!(is_leak && leads.mass > 0.8, "{:?}", found.posterior);
}

/// Of one voltage above the onset no other is predicted by a law of the voltage, and none is told, whatever is probable; what
/// lies below it is predicted better by whatever leaves it alone, and that tells the place.
#[test]
fn a_law_that_predicts_nothing_is_none() {
    let found = of_leak(&[&[(0.0, 0.8)], &[(0.0, 1.2)], &[(0.0, 2.0)]]).diagnosed();
    let is_of_place =
        |own: &ieap_domain::MissingLaw| own.law.is_none() && own.variable.is_none() && own.place == "current";
    assert!(
        found.missing.iter().all(is_of_place) && found.verdict.is_misfit(),
        "{}",
        found.sentence
    );
}

/// Under voltages of one sign a function of the voltage and one of its size are one.
#[test]
fn laws_that_are_one_function_on_the_drives_are_one() {
    let found = leaky().diagnosed();
    let by_voltage = |own: &&ieap_domain::Hypothesis| {
        let id = own.effect.as_deref().unwrap_or_default();
        id.starts_with("law:leak") && id.ends_with("voltage")
    };
    assert!(
        !found.posterior.iter().any(|own| by_voltage(&own)),
        "{:#?}",
        found.posterior
    );
}
