//! `ieap verify` finds what is lost or damaged, and says how to mend it.

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;

use ieap::store::{How, LEFT_OUT, ResultKind, Store};
use serde_json::Value;

use crate::campaign::{CampaignFolder, forge, forge_results, run_table};

fn campaign() -> CampaignFolder {
    let folder = CampaignFolder::new();
    for (name, seed) in [("a", 1), ("b", 2)] {
        folder.write(&format!("runs/{name}.csv"), run_table(seed));
    }
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    folder.ieap(&["tag", "runs/a.csv", "note=by hand"]).expect(0);
    folder
}

/// Codes of all errors that are found, each of which says how to mend it, and the exit status.
fn found(folder: &CampaignFolder, options: &[&str]) -> (i32, Vec<String>) {
    let ended = folder.ieap(&[&["verify", "--json"], options].concat());
    let parts = ended.json()["verify"]["parts"].as_array().unwrap().clone();
    let findings = parts
        .iter()
        .flat_map(|part| part["findings"].as_array().unwrap().clone());
    let errors: Vec<Value> = findings.filter(|found| found["severity"] == "error").collect();
    for error in &errors {
        let says = |field: &str| error[field].as_str().unwrap().contains("ieap ");
        assert!(says("mend") || says("message"), "{error}");
    }
    let codes = errors
        .iter()
        .map(|error| error["code"].as_str().unwrap().to_owned());
    (ended.status, codes.collect())
}

fn is_sound(folder: &CampaignFolder) {
    assert_eq!(found(folder, &[]), (0, Vec::new()));
}

fn blob(folder: &CampaignFolder, seed: u32) -> PathBuf {
    let hash = blake3::hash(run_table(seed).as_bytes()).to_hex().to_string();
    folder.join(&format!("archive/{}/{hash}.csv", &hash[..2]))
}

fn change(folder: &CampaignFolder, sql: &str) {
    rusqlite::Connection::open(folder.join("campaign.db"))
        .unwrap()
        .execute_batch(sql)
        .unwrap();
}

#[test]
fn a_raw_file_that_is_lost_or_changed_is_found_and_the_original_mends_it() {
    let folder = campaign();
    is_sound(&folder);
    let (path, whole) = (blob(&folder, 1), run_table(1).into_bytes());
    let mut flipped = whole.clone();
    flipped[200] ^= 1;
    for left in [None, Some(&flipped)] {
        let _ = fs::remove_file(&path);
        if let Some(bytes) = left {
            fs::write(&path, bytes).unwrap();
        }
        assert_eq!(found(&folder, &[]), (4, vec!["raw-file-lost".to_owned()]));
        folder.write("runs/a.csv", &whole);
        folder.ieap(&["run", "--no-diagnose"]).expect(0);
        is_sound(&folder);
    }
}

#[test]
fn a_number_that_changed_is_found_and_a_rebuilding_mends_it() {
    let folder = campaign();
    change(
        &folder,
        "UPDATE result SET document = replace(document, '\"value\":', '\"value\":1')",
    );
    let (status, codes) = found(&folder, &[]);
    assert_eq!((status, codes[0].as_str()), (4, "database-damaged"));
    folder.ieap(&["rebuild"]).expect(0);
    is_sound(&folder);
    fs::write(
        folder.join("campaign.db"),
        "no database at all, only some text that is long enough",
    )
    .unwrap();
    let (status, codes) = found(&folder, &[]);
    assert_eq!((status, codes[0].as_str()), (4, "database-not-opened"));
}

#[test]
fn what_is_sealed_and_wrong_is_found_by_deriving_it_again() {
    let is_found = |folder: &CampaignFolder, code: &str| {
        folder.ieap(&["report"]).expect(0);
        let (status, codes) = found(folder, &["--deep"]);
        assert_eq!(status, 4);
        assert!(codes.iter().any(|found| found == code), "{codes:?}");
    };
    let folder = campaign();
    assert_eq!(found(&folder, &["--deep"]), (0, Vec::new()));
    forge_results(folder.path(), "fit", |document| {
        let value = &mut document["found"]["parameters"][0]["estimate"]["value"];
        *value = (value.as_f64().unwrap() * 1.0000001).into();
    });
    is_found(&folder, "result-differs");
    let folder = campaign();
    forge(
        folder.path(),
        "UPDATE run SET reading = replace(reading, (SELECT hash FROM run_file WHERE path = 'runs/a.csv'),
             (SELECT hash FROM run_file WHERE path = 'runs/b.csv')) WHERE path = 'runs/a.csv'",
    );
    is_found(&folder, "readings-differ");
    let folder = campaign();
    forge(
        folder.path(),
        "UPDATE content SET archive_path = archive_path || 'x' WHERE id = 1",
    );
    is_found(&folder, "table-differs");
}

/// Tables and columns of the database, with the type of each.
fn columns(connection: &rusqlite::Connection) -> Vec<(String, String, String)> {
    let sql = "SELECT tables.name, info.name, info.type FROM sqlite_schema AS tables, pragma_table_info(tables.name) AS info
               WHERE tables.type = 'table' AND tables.name NOT LIKE 'sqlite_%'";
    let mut statement = connection.prepare(sql).unwrap();
    let rows = statement.query_map([], |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?)));
    rows.unwrap().map(Result::unwrap).collect()
}

/// Of every table: one value in a current row becomes another.
#[test]
fn a_value_that_changed_is_told_with_table_row_and_column_whatever_the_table() {
    let folder = campaign();
    folder.write("dma/tags.toml", "sample = \"S1\"\n");
    folder.write("dma/d.csv", crate::dma::plain_log(1));
    let log = "Time,Temperature (°C),Relative Humidity (%)\n2026-01-10 08:00:00,21.0,40.0\n2026-01-10 08:01:00,21.5,41.0\n";
    folder.write("ambient/bench.csv", log);
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let whole = Store::open_read_only(folder.path()).unwrap().unwrap();
    let kinds = [ResultKind::Fit, ResultKind::Modulus];
    let all = columns(&rusqlite::Connection::open(folder.join("campaign.db")).unwrap());
    let is_left_out = |table: &str, column: &str| {
        let of = |(of, what, _): &(&str, &str, &str)| {
            (*of == table || *of == "*") && (*what == column || *what == "*")
        };
        LEFT_OUT.iter().any(of)
    };
    let mut tables = BTreeSet::new();
    for (table, column, of_type) in all {
        // Row ids are others in every database.
        if is_left_out(&table, &column) || (column == "id" && table != "identity") {
            continue;
        }
        let place = tempfile::tempdir().unwrap();
        let changed = whole.copy_in(place.path()).unwrap();
        let connection = rusqlite::Connection::open(place.path().join("campaign.db")).unwrap();
        let which = match table.as_str() {
            "result" => "kind = 'modulus'",
            "source_file" => "state = 'run'",
            _ => "1",
        };
        let other = match of_type.as_str() {
            "INTEGER" => format!("coalesce({column}, 0) + 1000"),
            "BLOB" => "x'00'".to_owned(),
            _ => format!("coalesce({column}, '') || 'x'"),
        };
        let sql = format!(
            "PRAGMA foreign_keys = OFF; PRAGMA ignore_check_constraints = ON;
             UPDATE {table} SET {column} = {other} WHERE rowid = (SELECT min(rowid) FROM {table} WHERE {which})"
        );
        connection.execute_batch(&sql).unwrap();
        assert_eq!(connection.changes(), 1, "{table}.{column}");
        let (found, _) = changed.table_by_table(&whole, &kinds).unwrap();
        let told = found.iter().any(|differs| {
            differs.table == table
                && match &differs.how {
                    How::Columns(columns) => columns.contains(&column),
                    How::OnlyHere | How::OnlyThere => true,
                }
        });
        assert!(told, "{table}.{column}: {found:?}");
        tables.insert(table);
    }
    assert!(tables.len() > 9, "{tables:?}");
    assert_eq!(whole.table_by_table(&whole, &kinds).unwrap().0, []);
}

#[test]
fn a_journal_that_is_gone_damaged_or_says_something_else_is_found() {
    let folder = campaign();
    let path = folder.join("archive/journal.jsonl");
    let whole = fs::read_to_string(&path).unwrap();
    let lines: Vec<&str> = whole.split_inclusive('\n').collect();
    fs::remove_file(&path).unwrap();
    assert_eq!(found(&folder, &[]).1, ["no-journal"]);
    fs::write(&path, whole.replacen("by hand", "by haNd", 1)).unwrap();
    assert_eq!(found(&folder, &[]).1, ["journal-damaged", "journal-lags"]);
    fs::write(&path, lines[1..].concat()).unwrap();
    assert_eq!(found(&folder, &[]).1, ["journal-lines-missing", "journal-lags"]);
    // Half a line is a program that was killed.
    fs::write(&path, whole.clone() + "{\"n\":9").unwrap();
    is_sound(&folder);
    fs::write(&path, &whole).unwrap();
    is_sound(&folder);
    // What is damaged is made anew from the database, as the finding says.
    fs::write(&path, "\n").unwrap();
    assert_eq!(found(&folder, &[]).0, 4);
    fs::remove_file(&path).unwrap();
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    is_sound(&folder);
}

#[test]
fn a_page_of_the_report_that_is_gone_is_found() {
    let folder = campaign();
    folder.ieap(&["report"]).expect(0);
    is_sound(&folder);
    fs::remove_file(folder.join("report/index.html")).unwrap();
    assert_eq!(found(&folder, &[]), (4, vec!["report-file-missing".to_owned()]));
    folder.write("report/index.html", "another page");
    assert_eq!(found(&folder, &[]), (4, vec!["report-file-changed".to_owned()]));
    folder.ieap(&["report", "--again"]).expect(0);
    is_sound(&folder);
}

#[test]
fn raw_files_are_looked_for_after_a_disorderly_end() {
    let folder = campaign();
    fs::remove_file(blob(&folder, 2)).unwrap();
    let quiet = folder.ieap(&["report"]).expect(0);
    assert!(!quiet.stderr.contains("disorderly"), "{}", quiet.stderr);
    folder.write("campaign.db.lock", "process 1 on another\n");
    let told = folder.ieap(&["report"]).expect(0);
    assert!(
        told.stderr.contains("disorderly") && told.stderr.contains("it is not in the archive"),
        "{}",
        told.stderr
    );
}

/// The report is what people look at: a number in it that nobody computed is found, and made anew.
#[test]
fn a_report_that_was_changed_is_damage_and_is_made_anew() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let path = folder.join("report/fits-wide.csv");
    let sound = std::fs::read(&path).unwrap();
    let again = folder.ieap(&["report"]).expect(0);
    assert!(again.stdout.contains("(unchanged)"), "{again:#?}");
    let names = std::fs::read_to_string(folder.join("report/.written")).unwrap();
    assert!(names.lines().count() > 10, "{names}");
    let mut flips = 0;
    for name in names
        .lines()
        .map(|line| line.split_once("  ").unwrap().1)
        .chain([".written"])
    {
        let path = folder.join("report").join(name);
        let mut bytes = std::fs::read(&path).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        std::fs::write(&path, bytes).unwrap();
        let verified = folder.ieap(&["verify", "--json"]).expect(4).json();
        let report = &verified["verify"]["parts"]
            .as_array()
            .unwrap()
            .iter()
            .find(|part| part["part"] == "report")
            .unwrap()["findings"];
        assert_eq!(report[0]["severity"], "error", "{name}: {report}");
        if name != ".written" {
            assert_eq!(report[0]["place"], format!("report/{name}"));
        }
        let made = folder.ieap(&["report", "--json"]);
        let document = made.json();
        match made.status {
            0 => assert_eq!(document["report"]["rendered"], true),
            // A name in the list that is no name of a file: whose the file is nobody knows.
            _ => assert!(name == ".written" && document["report"]["refused"].is_string()),
        }
        flips += 1;
    }
    assert!(flips > 10);
    assert_eq!(std::fs::read(&path).unwrap(), sound);
}

#[test]
fn a_report_without_hashes_of_an_earlier_version_is_made_anew_once() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let list = folder.join("report/.written");
    let names = std::fs::read_to_string(&list).unwrap();
    let names: String = names
        .lines()
        .map(|line| format!("{}\n", line.split_once("  ").unwrap().1))
        .collect();
    std::fs::write(&list, names).unwrap();
    folder.ieap(&["verify"]).expect(0);
    assert!(!folder.ieap(&["report"]).expect(0).stdout.contains("(unchanged)"));
    assert!(folder.ieap(&["report"]).expect(0).stdout.contains("(unchanged)"));
}

#[test]
fn a_result_of_no_run_is_found_and_runs_that_wait_for_results_are_told_and_no_damage() {
    let folder = campaign();
    folder.write("runs/c.csv", run_table(3));
    folder.ieap(&["ingest"]).expect(0);
    let told = folder.ieap(&["verify", "--json"]).expect(0);
    assert!(told.stdout.contains("result-waits"), "{told:#?}");
    assert!(told.stdout.contains("runs/c.csv waits for the fit"), "{told:#?}");
    forge(
        folder.path(),
        "UPDATE run SET superseded_at = '2026-01-02T00:00:00Z' WHERE path = 'runs/a.csv'",
    );
    let (status, codes) = found(&folder, &[]);
    assert_eq!(status, 4);
    assert!(codes.contains(&"result-stray".to_owned()), "{codes:?}");
    folder.ieap(&["rebuild"]).expect(0);
    is_sound(&folder);
}
