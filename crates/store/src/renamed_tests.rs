//! A run whose file has another name now: all that names the file follows.

use crate::testing::new_run;
use crate::{FileRow, Moves, Store};
use ieap_domain::{FileState, RunKind};

#[test]
fn files_and_clocks_of_all_revisions_follow_the_new_name_and_other_runs_keep_theirs() {
    let mut store = Store::in_memory().unwrap();
    for (path, readings) in [
        ("runs/a.csv", [1.0, 2.0]),
        ("runs/a.csv", [1.0, 3.0]),
        ("runs/other.csv", [1.0, 4.0]),
    ] {
        let run = new_run(path, RunKind::Actuation, &readings);
        store.save_runs("2026-01-01T00:00:00Z", &[], &[run]).unwrap();
    }
    let [old, file] = ["runs/a.csv", "runs/b.csv"]
        .map(|path| FileRow::unseen(path.to_owned(), FileState::Run, String::new()));
    store.record_files("2026-01-01T00:00:00Z", &[old]).unwrap();
    let moves = Moves {
        files: [("runs/a.csv".to_owned(), file.clone())].into(),
        runs: vec![("runs/a.csv".to_owned(), "runs/b.csv".to_owned())],
    };
    store.move_files("2026-01-02T00:00:00Z", &moves).unwrap();
    let mut runs = store.runs().unwrap();
    runs.extend(store.superseded_runs().unwrap());
    let named: Vec<[&str; 3]> = runs
        .iter()
        .map(|run| [&*run.path, &*run.files[0].path, &*run.origin.clocks[0].file])
        .collect();
    assert_eq!(
        named,
        [["runs/b.csv"; 3], ["runs/other.csv"; 3], ["runs/b.csv"; 3]]
    );
    // In the same step: no file is left whose run has another name.
    assert_eq!(store.files().unwrap(), [file]);
    assert_eq!(store.check_all().unwrap(), Vec::<String>::new());
}
