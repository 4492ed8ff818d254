//! Results come back as they were stored, and whatever changed of them is told.

use super::*;
use crate::testing::new_run;
use crate::{FileRow, Moves};
use ieap_domain::testing::{fit, known};
use ieap_domain::{FileState, Fit, MadeBy, Quantity, RunCurve, RunKind};

const NOW: &str = "2026-01-01T00:00:00Z";

/// A fit with numbers whose shortest decimals a careless reader misses by the last bit.
fn made() -> Fit {
    let hard = vec![0.1 + 0.2, 1.0 / 3.0, 5e-324, 123456789.12345679];
    let mut made = fit(&[("r1_ohm_cm2", known(hard[1], hard[0]))]);
    made.curves = vec![RunCurve {
        quantity: Quantity::Current,
        time_s: hard.clone(),
        measured: hard.clone(),
        fitted: hard,
        residual_sigma: vec![],
        readings: 4,
    }];
    made
}

/// A store with one run.
fn with_run() -> Store {
    let mut store = Store::in_memory().unwrap();
    let run = new_run("runs/a.csv", RunKind::Actuation, &[1.0, 2.0]);
    store.save_runs(NOW, &[], &[run]).unwrap();
    store
}

fn with(found: Result<&Fit, &Issue>) -> Store {
    let mut store = with_run();
    keep(&mut store, "k", found);
    store
}

fn keep(store: &mut Store, key: &str, found: Result<&Fit, &Issue>) {
    let run_id = only_run(store);
    let result = NewResult {
        of: Subject::Run(run_id),
        made_from: &[run_id],
        key,
        made_by: &MadeBy::new("1.0", ""),
        found,
    };
    assert_eq!(
        store.keep_results(NOW, ResultKind::Fit, &[result]).unwrap(),
        [true]
    );
}

fn only_run(store: &Store) -> i64 {
    *store.readings_hashes().unwrap().first_key_value().unwrap().0
}

fn wrong(store: &Store) -> Vec<String> {
    store.check_all().unwrap()
}

fn read_back(store: &Store) -> Result<Option<StoredResult<Fit>>, StoreError> {
    store.result(ResultKind::Fit, "runs/a.csv")
}

#[test]
fn a_result_comes_back_to_the_bit_and_its_curves_when_they_are_asked_for() {
    let made = made();
    let store = with(Ok(&made));
    let stored = read_back(&store).unwrap().unwrap();
    let found = stored.found.unwrap();
    assert_eq!((&found.parameters, found.curves.len()), (&made.parameters, 0));
    assert_eq!(store.fit_curves("runs/a.csv").unwrap().curves, made.curves);
    let issue = Issue::warning("not-fitted", "too few readings");
    let failed = with(Err(&issue));
    assert_eq!(read_back(&failed).unwrap().unwrap().found, Err(issue));
    assert_eq!(failed.fit_curves("runs/a.csv").unwrap().curves, []);
    assert!(wrong(&store).is_empty() && wrong(&failed).is_empty());
}

#[test]
fn a_new_result_takes_the_place_of_the_one_before_and_a_retired_one_is_kept() {
    let made = made();
    let mut store = with(Ok(&made));
    keep(&mut store, "k2", Ok(&made));
    let keys = store.result_keys(ResultKind::Fit).unwrap();
    assert_eq!(
        keys.into_iter().collect::<Vec<_>>(),
        [("runs/a.csv".to_owned(), "k2".to_owned())]
    );
    let before: StoredResult<Fit> = store
        .result_then(ResultKind::Fit, "runs/a.csv", When::Before)
        .unwrap()
        .unwrap();
    assert_eq!(before.origin.key, "k");
    store
        .retire_results(NOW, ResultKind::Fit, &["runs/a.csv".to_owned()])
        .unwrap();
    assert!(read_back(&store).unwrap().is_none());
    assert!(wrong(&store).is_empty());
}

#[test]
fn whatever_changes_of_a_result_is_damage() {
    for tampering in [
        "UPDATE result SET document = replace(document, '0.3', '0.4')",
        "UPDATE result SET key = 'other'",
        "UPDATE result SET version = '1.1'",
        "UPDATE result SET made_at = '2026-01-02T00:00:00Z'",
        "UPDATE result SET document = substr(document, 2)",
        "UPDATE result SET document = ''",
        "UPDATE result SET row_hash = x''",
    ] {
        let store = with(Ok(&made()));
        store.connection.execute_batch(tampering).unwrap();
        let told = read_back(&store).unwrap_err();
        assert!(matches!(told, StoreError::Damaged { .. }), "{tampering}: {told}");
        assert!(told.to_string().contains("the fit of runs/a.csv"), "{told}");
        assert!(!wrong(&store).is_empty(), "{tampering}");
    }
    // Given to another run, it is damage there.
    let mut store = with(Ok(&made()));
    let other = new_run("runs/b.csv", RunKind::Actuation, &[3.0, 4.0]);
    store.save_runs(NOW, &[], &[other]).unwrap();
    let given = "UPDATE result SET run_id = (SELECT id FROM run WHERE path = 'runs/b.csv')";
    store.connection.execute_batch(given).unwrap();
    assert!(store.result::<Fit>(ResultKind::Fit, "runs/b.csv").is_err());
}

/// A fit that is not there is no fit that was never made.
#[test]
fn a_result_that_is_gone_is_damage_of_the_list() {
    for tampering in [
        "DELETE FROM result",
        "UPDATE result SET superseded_at = '2026-01-02T00:00:00Z'",
        "UPDATE result SET kind = 'comparison'",
        "DELETE FROM list_sum",
    ] {
        let store = with(Ok(&made()));
        assert_eq!(store.results::<Fit>(ResultKind::Fit).unwrap().len(), 1);
        store.connection.execute_batch(tampering).unwrap();
        let told = store.results::<Fit>(ResultKind::Fit).unwrap_err();
        assert!(matches!(told, StoreError::Damaged { .. }), "{tampering}: {told}");
        assert!(!wrong(&store).is_empty(), "{tampering}");
    }
}

#[test]
fn curves_that_changed_are_damage_and_numbers_are_read_without_them() {
    let store = with(Ok(&made()));
    let tampering = "UPDATE result SET drawn = zeroblob(length(drawn))";
    store.connection.execute_batch(tampering).unwrap();
    assert!(read_back(&store).unwrap().is_some());
    assert!(matches!(
        store.fit_curves("runs/a.csv"),
        Err(StoreError::Damaged { .. })
    ));
    assert_eq!(wrong(&store).len(), 1);
}

/// The run of the tests as another one than it was: by its name, by a tag, by new bytes.
fn changed(store: &mut Store, how: &str) {
    let path = "runs/a.csv";
    let run_id = only_run(store);
    let mut run = new_run(path, RunKind::Actuation, &[1.0, 2.0]);
    match how {
        "renamed" => {
            let moves = Moves {
                files: [(path.to_owned(), file("runs/b.csv"))].into(),
                runs: vec![(path.to_owned(), "runs/b.csv".to_owned())],
            };
            store.move_files(NOW, &moves).unwrap();
        }
        "tagged" => {
            run.tagging.area_cm2 = Some(0.2);
            store.retag(NOW, run_id, &run.tagging).unwrap();
        }
        "replaced" => {
            let other = new_run(path, RunKind::Actuation, &[3.0, 4.0]);
            store.save_runs(NOW, &[], &[other]).unwrap();
        }
        _ => unreachable!("{how}"),
    }
}

fn file(path: &str) -> FileRow {
    FileRow {
        path: path.to_owned(),
        size_bytes: 1,
        modified_ns: 1,
        inode: 1,
        changed_ns: 1,
        hash: None,
        state: FileState::Run,
        reader: String::new(),
        issue: None,
        missing_since: None,
    }
}

/// What is made while its run gets another name or other tags is a result of that run, under the key of what it was made from;
/// of a revision that is no current one there is none.
#[test]
fn a_result_is_of_its_run_under_the_name_that_it_has_then() {
    let found = made();
    for (how, kept) in [
        ("renamed", Some("runs/b.csv")),
        ("tagged", Some("runs/a.csv")),
        ("replaced", None),
    ] {
        let mut store = with_run();
        let run_id = only_run(&store);
        changed(&mut store, how);
        let result = NewResult {
            of: Subject::Run(run_id),
            made_from: &[run_id],
            key: "k",
            made_by: &MadeBy::new("1.0", ""),
            found: Ok(&found),
        };
        let stored = store.keep_results(NOW, ResultKind::Fit, &[result]).unwrap();
        assert_eq!(stored, [kept.is_some()], "{how}");
        let stored = store.results::<Fit>(ResultKind::Fit).unwrap();
        let names: Vec<&str> = stored.iter().map(|stored| &*stored.origin.name).collect();
        assert_eq!(names, Vec::from_iter(kept), "{how}");
        assert!(wrong(&store).is_empty(), "{how}");
    }
}

#[test]
fn results_follow_a_run_to_its_new_name_and_end_with_its_revision() {
    let mut store = with(Ok(&made()));
    changed(&mut store, "renamed");
    assert!(read_back(&store).unwrap().is_none());
    assert!(
        store
            .result::<Fit>(ResultKind::Fit, "runs/b.csv")
            .unwrap()
            .is_some()
    );
    assert!(wrong(&store).is_empty());
    // A run of the old name has none of it, and the name is free for it.
    let other = new_run("runs/a.csv", RunKind::Actuation, &[3.0, 4.0]);
    store.save_runs(NOW, &[], &[other]).unwrap();
    assert!(read_back(&store).unwrap().is_none());
    let mut store = with(Ok(&made()));
    changed(&mut store, "replaced");
    assert!(store.results::<Fit>(ResultKind::Fit).unwrap().is_empty());
    assert!(wrong(&store).is_empty());
}

#[test]
fn a_result_of_a_run_that_is_no_more_is_told_as_stray() {
    let store = with(Ok(&made()));
    assert!(store.stray_results().unwrap().is_empty());
    let gone = "UPDATE run SET superseded_at = '2026-01-02T00:00:00Z'";
    store.connection.execute_batch(gone).unwrap();
    assert_eq!(store.stray_results().unwrap(), ["the fit of runs/a.csv"]);
}
