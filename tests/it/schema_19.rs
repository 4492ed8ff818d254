//! A campaign of schema 19, where a result could come under the name of no run.

use crate::between::strays;
use crate::campaign::{CampaignFolder, run_table};

/// The table of results as schema 19 had it, with a fit under the name that its run had once.
const WITH_A_STRAY: &str = "
    ALTER TABLE result RENAME TO newer;
    CREATE TABLE result (
        id INTEGER NOT NULL PRIMARY KEY, kind TEXT NOT NULL, name TEXT NOT NULL, key TEXT NOT NULL, version TEXT NOT NULL,
        made_at TEXT NOT NULL, superseded_at TEXT, row_hash BLOB NOT NULL DEFAULT x'', document TEXT NOT NULL, drawn BLOB
    ) STRICT;
    INSERT INTO result SELECT newer.id, newer.kind, coalesce(name, path), key, version, made_at, newer.superseded_at,
        newer.row_hash, document, drawn FROM newer LEFT JOIN run ON run.id = run_id;
    UPDATE result SET name = 'runs/a.csv' WHERE kind = 'fit' AND name = 'runs/b.csv';
    DROP TABLE newer;
    PRAGMA user_version = 19;";

#[test]
fn stray_results_are_gone_after_it_was_made_anew_and_it_is_said() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    std::fs::rename(folder.join("runs/a.csv"), folder.join("runs/b.csv")).unwrap();
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let database = rusqlite::Connection::open(folder.join("campaign.db")).unwrap();
    let views = "SELECT group_concat('DROP VIEW ' || name, ';') FROM sqlite_schema WHERE type = 'view'";
    let views: String = database.query_row(views, [], |row| row.get(0)).unwrap();
    database
        .execute_batch(&format!("{views}; {WITH_A_STRAY}"))
        .unwrap();
    drop(database);
    // The run takes back the name of the stray, which ended every `run` before.
    std::fs::rename(folder.join("runs/b.csv"), folder.join("runs/a.csv")).unwrap();
    let healed = folder.ieap(&["run", "--no-diagnose"]).expect(0);
    assert!(healed.stderr.contains("schema 19"), "{healed:#?}");
    assert!(
        healed.stderr.contains("fits and findings are made again"),
        "{healed:#?}"
    );
    let fits = folder.ieap(&["fit", "--json"]).expect(0).json();
    let runs: Vec<&str> = fits["fits"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(|fit| fit["run"].as_str())
        .collect();
    assert_eq!(runs, ["runs/a.csv"]);
    assert_eq!(strays(folder.path()), 0);
    folder.ieap(&["verify", "--deep"]).expect(0);
}
