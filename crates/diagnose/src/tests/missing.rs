//! Laws without equations: told as deep as the readings tell, and not where nothing is missing.

use super::*;
use ieap_model::effects::Site;

fn looked(hidden: Option<Hidden>) -> Looked {
    look(
        &Runs::with(hidden, FOUR, 31).inputs(),
        &DiagnoseOptions::default(),
    )
}

#[test]
fn nothing_is_told_where_nothing_is_missing() {
    let found = looked(None);
    assert_eq!((found.verdict, found.told), ("right", Told::default()));
}

#[test]
fn a_law_is_told_with_its_variable_and_the_account_adds_up() {
    let heat: Hidden = (
        "joule-heating",
        None,
        &[("softening_cm2_per_j", 3.0), ("cooling_time_s", 20.0)],
    );
    let found = looked(Some(heat));
    let place = found.told.place.unwrap();
    assert_eq!(found.verdict, "law", "{found:?}");
    assert_eq!(
        (place.site, place.law, place.variable),
        (Site::Current, "resistance", "heat"),
        "{found:?}"
    );
    let [noise, between, within, unexplained] = found.account;
    assert!((noise + between + within + unexplained - 100.0).abs() < 1e-9);
    assert!(within > between + unexplained, "{found:?}");
}
