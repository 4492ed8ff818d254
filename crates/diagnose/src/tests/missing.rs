//! Laws that are missing: told as deep as the readings tell, and not where nothing is missing.

use super::*;

const HEAT: Hidden = (
    "joule-heating",
    None,
    &[("softening_cm2_per_j", 3.0), ("cooling_time_s", 20.0)],
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
        found.sentence.contains("resistance changes with"),
        "{}",
        found.sentence
    );
}

/// The same misfit where the campaign tolerates more: right, and what is left is told all the same.
#[test]
fn a_misfit_below_what_is_tolerated_is_right() {
    let runs = Runs::with(Some(HEAT), FOUR, 31);
    let options = DiagnoseOptions {
        tolerance_percent: 100.0,
        ..DiagnoseOptions::default()
    };
    let found = diagnose_group("group", &runs.inputs(), &options);
    assert_eq!(found.verdict, Verdict::Right, "{}", found.sentence);
    assert!(found.p_misfit.unwrap() < 0.01 && found.missing.len() == 1);
    assert!(
        found.sentence.starts_with("The simulation is right to "),
        "{}",
        found.sentence
    );
}
