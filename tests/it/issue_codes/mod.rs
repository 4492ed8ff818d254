//! Every code of an issue, with one small input that brings it about, or the test that asserts it: a code that is new has
//! no row here, and a test says so. Codes of the Python package alone are not among them.

mod rows;
mod sources;

use std::collections::BTreeSet;
use std::path::PathBuf;

use ieap::store::Store;

use crate::campaign::{CampaignFolder, run_table};
use rows::Shown::{By, Campaign, Format, Open};
use rows::{OPEN, ROWS, cut, format_file};
use sources::{GIVEN, codes, spelled};

fn house() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Codes of what is told of the campaign in words, and of its runs and their fits.
fn told(folder: &CampaignFolder) -> BTreeSet<String> {
    let mut told = BTreeSet::new();
    for verb in [["ingest", "--json"], ["fit", "--json"], ["status", "--json"]] {
        codes_in(&folder.ieap(&verb).json(), &mut told);
    }
    let store = Store::open_read_only(folder.path()).unwrap().unwrap();
    for run in store.runs().unwrap() {
        let of_fit = run.fit.iter().flat_map(|fit| &fit.issues);
        told.extend(run.issues.iter().chain(of_fit).map(|issue| issue.code.clone()));
    }
    told
}

/// Every text under a key `code`, at any depth.
fn codes_in(value: &serde_json::Value, into: &mut BTreeSet<String>) {
    match value {
        serde_json::Value::Object(map) => {
            into.extend(map.get("code").and_then(|code| code.as_str()).map(str::to_owned));
            map.values().for_each(|value| codes_in(value, into));
        }
        serde_json::Value::Array(values) => values.iter().for_each(|value| codes_in(value, into)),
        _ => {}
    }
}

#[test]
fn every_code_has_a_row() {
    let (mut codes, unknown) = codes();
    let given: BTreeSet<String> = GIVEN
        .iter()
        .map(|(file, what, ..)| format!("{file}: {what}"))
        .collect();
    assert_eq!(unknown, given, "say in GIVEN where these codes come from");
    for (file, _, from, to) in GIVEN {
        let text = std::fs::read_to_string(house().join(file)).unwrap();
        let part = text.split_once(from).unwrap().1.split(to).next().unwrap();
        let words = part.split('"').skip(1).step_by(2);
        let is_code = |word: &&str| word.contains('-') && !word.contains(' ');
        codes.extend(words.filter(is_code).map(str::to_owned));
    }
    codes.extend(["sidecar", "ambiguous-dates"].map(str::to_owned));
    let rows: BTreeSet<String> = ROWS.iter().map(|(code, _)| (*code).to_owned()).collect();
    assert_eq!(rows.len(), ROWS.len(), "a code has two rows");
    let without: Vec<_> = codes.difference(&rows).collect();
    let gone: Vec<_> = rows.difference(&codes).collect();
    assert!(
        without.is_empty() && gone.is_empty(),
        "without a row: {without:?}; gone: {gone:?}"
    );
    let open = ROWS.iter().filter_map(|(code, shown)| match shown {
        Open(needs) => Some(format!("{code}: {needs}")),
        _ => None,
    });
    let open: Vec<_> = open.collect();
    assert_eq!(open.len(), OPEN, "{open:#?}");
}

#[test]
fn the_inputs_bring_their_codes_about() {
    for (code, shown) in ROWS {
        if let Campaign(write) = shown {
            let folder = CampaignFolder::new();
            write(&folder);
            let told = told(&folder);
            assert!(told.contains(*code), "{code} is not among {told:?}");
        }
    }
}

#[test]
fn the_files_and_tests_that_rows_name_have_their_codes() {
    for (code, shown) in ROWS {
        match shown {
            Format(file) => {
                let expected = format_file(&format!("{file}.expected.json"));
                let expected = String::from_utf8(expected).unwrap();
                assert!(expected.contains(&format!("\"{code}\"")), "{code}: {file}");
            }
            By(file, test) => {
                let text = std::fs::read_to_string(house().join(file)).unwrap();
                let (_, body) = text
                    .split_once(&format!("fn {test}("))
                    .unwrap_or_else(|| panic!("{code}: {file} has no {test}"));
                // To the next function at the same depth.
                let body = body.split("#[test]").next().unwrap_or_default();
                let names = |name: &String| body.contains(name.as_str());
                assert!(
                    spelled(code).iter().any(names),
                    "{code} is not in {test} of {file}"
                );
            }
            Campaign(_) | Open(_) => {}
        }
    }
}

#[test]
fn what_inspect_says() {
    let folder = CampaignFolder::new();
    folder.write("runs/b.frames/1.png", b"\x89PNG\r\n\x1a\n");
    folder.write(
        "runs/next.run-sheet.csv",
        "planned,file,sample,environment,voltage_v\nP01,P01-S1,S1,air,1.2\n",
    );
    for (name, code) in [
        ("runs/b.frames", "folder"),
        ("runs/b.frames/1.png", "frame"),
        ("runs/next.run-sheet.csv", "run-sheet"),
    ] {
        let mut codes = BTreeSet::new();
        codes_in(&folder.ieap(&["inspect", name, "--json"]).json(), &mut codes);
        assert_eq!(codes, BTreeSet::from([code.to_owned()]), "{name}");
    }
}

#[test]
fn what_verify_notes() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let noted = |options: &[&str]| {
        let mut codes = BTreeSet::new();
        codes_in(
            &folder.ieap(&[&["verify", "--json"], options].concat()).json(),
            &mut codes,
        );
        codes
    };
    // The diagnosis was left out.
    assert_eq!(noted(&["--deep"]), BTreeSet::from(["result-waits".to_owned()]));
    folder.ieap(&["tag", "runs/a.csv", "leave_out=10-12"]).expect(0);
    assert!(noted(&[]).contains("report-out-of-date"));
    assert!(noted(&["--deep"]).contains("result-out-of-date"));
    let journal = folder.join("archive/journal.jsonl");
    let whole = std::fs::read_to_string(&journal).unwrap();
    std::fs::write(&journal, format!("{whole}{{\"n\":9,\"at\":\"20")).unwrap();
    assert!(noted(&[]).contains("journal-torn"));
    std::fs::write(&journal, &whole).unwrap();
    let bytes = b"bytes of no run";
    let hash = blake3::hash(bytes).to_hex();
    folder.write(&format!("archive/{}/{hash}.csv", &hash[..2]), bytes);
    assert!(noted(&[]).contains("raw-file-of-no-run"));
}

#[test]
fn what_a_group_leaves_out() {
    let folder = CampaignFolder::new();
    folder.write("runs/long.csv", run_table(1));
    folder.write("runs/short.csv", cut(&run_table(2), 26));
    folder.write("runs/alone.csv", cut(&run_table(3), 26));
    folder.write("runs/alone.csv.toml", "environment = \"vacuum\"\n");
    folder.ieap(&["ingest"]).expect(0);
    let mut codes = BTreeSet::new();
    let fitted = folder.ieap(&["fit", "--group", "--json"]).json();
    codes_in(&fitted, &mut codes);
    assert!(
        codes.contains("not-in-group") && codes.contains("group-not-fitted"),
        "{fitted:#}"
    );
}
