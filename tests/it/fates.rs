//! Every file of the folders has a fate: it is a run, waits, was refused, or is read with one, and what nothing reads is said.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::campaign::{CAMPAIGN_TOML, CampaignFolder, chosen_tag, counted, run_table};
use crate::rebuild::comes_back;

/// Seed of the folders that are drawn.
const SEED: u64 = 20_261_128;

#[test]
fn a_statement_is_for_its_file_however_both_names_are_written() {
    let composed = "runs/S\u{f6}.csv";
    for (file, statement) in [
        ("runs/b.csv", "runs/b.csv.toml"),
        ("runs/b.csv", "runs/b.csv.TOML"),
        ("runs/A.csv", "runs/a.csv.toml"),
        (composed, "runs/So\u{308}.csv.toml"),
        ("runs/So\u{308}.csv", "runs/S\u{f6}.CSV.toml"),
        ("runs/b.csv", "runs/Tags.TOML"),
    ] {
        let folder = CampaignFolder::new();
        std::fs::remove_file(folder.join("runs/tags.toml")).unwrap();
        folder.write("tags.toml", "sample = \"S1\"\nenvironment = \"air\"\n");
        folder.write(file, run_table(1));
        folder.write(statement, "cycle = 3\n");
        folder.ieap(&["ingest"]).expect(0);
        let cycle = || chosen_tag(folder.path(), file, "cycle");
        assert_eq!(cycle().as_deref(), Some("3"), "{statement}");
        folder.write(statement, "cycle = 4\n");
        folder.ieap(&["ingest"]).expect(0);
        assert_eq!(cycle().as_deref(), Some("4"), "{statement}");
        // With its readings gone, what it stated stays, though it goes too.
        std::fs::remove_file(folder.join(file)).unwrap();
        std::fs::remove_file(folder.join(statement)).unwrap();
        folder.ieap(&["ingest"]).expect(0);
        assert_eq!(cycle().as_deref(), Some("4"), "{statement}");
        folder.ieap(&["run", "--no-diagnose"]).expect(0);
        comes_back(&folder);
    }
}

/// One that has its own file is for that one alone.
#[cfg(target_os = "linux")]
#[test]
fn a_statement_of_one_file_is_not_that_of_another_whose_name_differs_by_case() {
    let folder = CampaignFolder::new();
    folder.write("runs/A.csv", run_table(1));
    folder.write("runs/a.csv", run_table(2));
    folder.write("runs/a.csv.toml", "cycle = 3\n");
    folder.ieap(&["ingest"]).expect(0);
    assert_eq!(
        chosen_tag(folder.path(), "runs/a.csv", "cycle").as_deref(),
        Some("3")
    );
    assert_eq!(chosen_tag(folder.path(), "runs/A.csv", "cycle"), None);
}

#[test]
fn a_statement_of_no_run_is_said_wherever_one_looks() {
    let folder = CampaignFolder::new();
    folder.write("runs/b.csv", run_table(1));
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    folder.write("runs/bb.csv.toml", "cycle = 3\n");
    let found = folder.ieap(&["run", "--no-diagnose"]).expect(3);
    assert!(found.stderr.contains("runs/bb.csv.toml"), "{found:#?}");
    assert!(found.stderr.contains("rename it to \"b.csv.toml\""), "{found:#?}");
    let status = folder.ieap(&["status"]).expect(0);
    assert!(
        status.stdout.contains("there is no file \"bb.csv\" beside it"),
        "{status:#?}"
    );
    assert_eq!(fates(&folder)["runs/bb.csv.toml"], "waiting");
    let files = folder.ieap(&["status", "--files", "--json"]).expect(0);
    assert!(files.stdout.contains("statement-unread"), "{files:#?}");
    assert!(folder.report("files.html").contains("bb.csv.toml"));
    comes_back(&folder);
    // Its file comes.
    folder.write("runs/bb.csv", run_table(2));
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    assert_eq!(fates(&folder)["runs/bb.csv.toml"], "tags");
    assert_eq!(
        chosen_tag(folder.path(), "runs/bb.csv", "cycle").as_deref(),
        Some("3")
    );
    std::fs::remove_file(folder.join("runs/bb.csv.toml")).unwrap();
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    assert!(!fates(&folder).contains_key("runs/bb.csv.toml"));
}

/// Macs write the marks above letters behind them.
#[test]
fn a_sample_is_the_same_however_its_letters_are_written() {
    let (one, other) = ("S\u{e4}", "Sa\u{308}");
    for (stated, tagged) in [(one, other), (other, one), (other, other)] {
        let folder = CampaignFolder::new();
        folder.write("campaign.toml", CAMPAIGN_TOML.replace("S1", stated));
        folder.write(
            "runs/tags.toml",
            format!("sample = \"{tagged}\"\nenvironment = \"air\"\n"),
        );
        folder.write("runs/b.csv", run_table(1));
        folder.ieap(&["run", "--no-diagnose"]).expect(0);
        assert_eq!(
            chosen_tag(folder.path(), "runs/b.csv", "sample").as_deref(),
            Some(one)
        );
        let by_hand = format!("sample={tagged}");
        folder.ieap(&["tag", "runs/b.csv", &by_hand]).expect(0);
    }
}

/// What became of each file.
fn fates(folder: &CampaignFolder) -> BTreeMap<String, String> {
    let document = folder.ieap(&["status", "--files", "--json"]).expect(0).json();
    let text = |value: &serde_json::Value| value.as_str().unwrap().to_owned();
    let files = document["files"].as_array().unwrap().iter();
    let fates: Vec<(String, String)> = files
        .map(|file| (text(&file["path"]), text(&file["became"])))
        .collect();
    let count = fates.len();
    let fates: BTreeMap<String, String> = fates.into_iter().collect();
    assert_eq!(fates.len(), count, "each once");
    fates
}

/// Files below a folder, relative to the campaign, but for hidden ones.
fn there(root: &Path, below: &str, found: &mut BTreeSet<String>) {
    let Ok(entries) = std::fs::read_dir(root.join(below)) else {
        return;
    };
    for entry in entries.map(Result::unwrap) {
        let name = entry.file_name().into_string().unwrap();
        let path = format!("{below}/{name}");
        if entry.file_type().unwrap().is_dir() {
            there(root, &path, found);
        } else if !name.starts_with('.') {
            found.insert(path);
        }
    }
}

const FOLDERS: [&str; 5] = ["runs", "runs/day 1", "runs/d/deep", "dma", "ambient"];
const NAMES: [&str; 8] = [
    "a.csv",
    "A.csv",
    "b.csv",
    "b.txt",
    "S\u{f6}.csv",
    "So\u{308}.csv",
    "run-sheet.csv",
    "x.log",
];

/// One file or statement more, or one less.
fn changed(folder: &CampaignFolder, rng: &mut ChaCha8Rng) {
    let (at, name) = (FOLDERS.choose(rng).unwrap(), NAMES.choose(rng).unwrap());
    let path = format!("{at}/{name}");
    match rng.random_range(0..9) {
        0 => folder.write(&path, run_table(rng.random_range(0..4))),
        1 => folder.write(&path, ""),
        2 => folder.write(&path, "time_s;current_a\n0;1.5\n1;2,5\n"),
        3 | 4 => folder.write(&format!("{path}.toml"), "cycle = 3\n"),
        5 => folder.write(&format!("{path}.TOML"), "cycle = 3\n"),
        6 => folder.write(&format!("{at}/tags.toml"), "environment = \"air\"\n"),
        7 => folder.write(
            &format!("{at}/{}.toml", name.split('.').next().unwrap()),
            "cycle = 3\n",
        ),
        _ => drop(std::fs::remove_file(folder.join(&path))),
    }
}

#[test]
fn the_fates_of_random_folders_are_as_many_as_their_files() {
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    for round in 0..counted(6, 200) {
        let folder = CampaignFolder::new();
        for turn in 0..4 {
            (0..rng.random_range(1..8)).for_each(|_| changed(&folder, &mut rng));
            let ended = folder.ieap(&["ingest"]);
            let fates = fates(&folder);
            let mut files = BTreeSet::new();
            for below in ["runs", "dma", "ambient"] {
                there(folder.path(), below, &mut files);
            }
            let told: BTreeSet<String> = (fates.iter())
                .filter(|(_, became)| *became != "gone from the folder")
                .map(|(path, _)| path.clone())
                .collect();
            assert_eq!(told, files, "{round} {turn} {ended:#?}");
            let unread = fates
                .iter()
                .any(|(path, became)| path.to_lowercase().ends_with(".toml") && became == "waiting");
            assert!(!unread || ended.status == 3, "{round} {turn}: {ended:#?}");
        }
        let ended = folder.ieap(&["run", "--no-diagnose"]);
        assert!([0, 3].contains(&ended.status), "{ended:#?}");
        comes_back(&folder);
    }
}
