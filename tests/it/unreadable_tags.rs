//! Tag files that cannot be read: their runs wait, or keep the tags that they had, and it is said.

use serde_json::{Value, json};

use crate::campaign::{CampaignFolder, run_table};

/// A second sample of other dimensions, which the sidecar means.
const SECOND_SAMPLE: &str = "
[[sample]]
id = \"S2\"
material = \"CNaf\"
length_mm = 10.0
width_mm = 4.0
";

fn with_two_samples() -> CampaignFolder {
    let folder = CampaignFolder::new();
    let toml = std::fs::read_to_string(folder.join("campaign.toml")).unwrap();
    folder.write("campaign.toml", toml + SECOND_SAMPLE);
    folder.write("runs/a.csv", run_table(1));
    folder.write("runs/b.csv", run_table(2));
    folder
}

fn fits(folder: &CampaignFolder, status: i32) -> Value {
    folder.ieap(&["fit", "--json"]).expect(status).json()
}

fn sample_of<'a>(document: &'a Value, run: &str) -> Option<&'a str> {
    let mut fits = document["fits"].as_array().unwrap().iter();
    fits.find(|fit| fit["run"] == run)
        .and_then(|fit| fit["sample"].as_str())
}

fn unreadable_in_status(folder: &CampaignFolder) -> Value {
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    status["status"]["unreadable_tags"].clone()
}

#[test]
fn a_run_whose_sidecar_is_broken_waits_and_is_fitted_when_it_is_mended() {
    let folder = with_two_samples();
    folder.write("runs/a.csv.toml", "sample = \"S2\n");
    let document = fits(&folder, 3);
    assert_eq!(sample_of(&document, "runs/a.csv"), None, "{document:#}");
    assert_eq!(sample_of(&document, "runs/b.csv"), Some("S1"));
    let told = unreadable_in_status(&folder);
    let place = told[0]["issue"]["place"].as_str().unwrap();
    assert!(place.starts_with("runs/a.csv.toml, line 1, column "), "{place}");
    assert_eq!(told[0]["runs"], 1);
    let text = folder.ieap(&["status"]).expect(0).stdout;
    assert!(text.contains("1 statement of tags cannot be read"), "{text}");
    // Asked again, the same.
    let ended = folder.ieap(&["run", "--no-diagnose"]).expect(3);
    assert!(ended.stderr.contains("runs/a.csv.toml"), "{}", ended.stderr);

    folder.write("runs/a.csv.toml", "sample = \"S2\"\n");
    let document = fits(&folder, 0);
    assert_eq!(sample_of(&document, "runs/a.csv"), Some("S2"));
    assert_eq!(unreadable_in_status(&folder), json!([]));
}

#[test]
fn a_tagged_run_keeps_its_tags_while_its_sidecar_is_broken() {
    let folder = with_two_samples();
    folder.write("runs/a.csv.toml", "sample = \"S2\"\n");
    let before = fits(&folder, 0);
    folder.write("runs/a.csv.toml", "sample = \"S2\n");
    let during = fits(&folder, 3);
    assert_eq!(sample_of(&during, "runs/a.csv"), Some("S2"));
    let of_a = &during["fits"][0];
    assert!(of_a["issues"].to_string().contains("keeps the tags"), "{of_a:#}");
    assert_eq!(unreadable_in_status(&folder)[0]["runs"], 1);
    // What somebody says meanwhile holds at once, with all that follows from it, and may be taken back.
    for (said, sample) in [("sample=S1", "S1"), ("sample=", "S2")] {
        folder.ieap(&["tag", "runs/a.csv", said]).expect(3);
        let found = fits(&folder, 3);
        assert_eq!(sample_of(&found, "runs/a.csv"), Some(sample), "{found:#}");
        assert_eq!(
            found["fits"][0]["parameters"] == of_a["parameters"],
            sample == "S2"
        );
    }
    // Mended to what it said before: nothing is tagged or fitted anew.
    folder.write("runs/a.csv.toml", "sample = \"S2\"\n");
    let summary = folder.run_json();
    assert_eq!(summary["ingest"]["retagged"], json!([]), "{summary:#}");
    assert_eq!(summary["fit"]["fitted"], 0);
    assert_eq!(fits(&folder, 0), before);
}

#[test]
fn every_kind_of_tag_file_and_of_damage_is_told_with_the_runs_that_it_speaks_for() {
    for (file, content, runs) in [
        ("runs/tags.toml", &b"sample = \"S1\"\nenvironment = air\n"[..], 2),
        ("tags.toml", b"note = \"caf\xe9\"\n", 2),
        ("runs/b.csv.toml", b"[tags]\nsample = \"S2\"\n", 1),
    ] {
        let folder = with_two_samples();
        folder.write(file, content);
        let document = fits(&folder, 3);
        assert_eq!(document["fits"].as_array().unwrap().len(), 2 - runs, "{file}");
        let told = unreadable_in_status(&folder);
        assert!(
            told[0]["issue"]["place"].as_str().unwrap().starts_with(file),
            "{told:#}"
        );
        assert_eq!(told[0]["runs"], runs, "{told:#}");
    }
    // A folder in place of the sidecar cannot be read at all.
    let folder = with_two_samples();
    std::fs::create_dir(folder.join("runs/b.csv.toml")).unwrap();
    assert_eq!(sample_of(&fits(&folder, 3), "runs/b.csv"), None);
}

#[test]
fn a_new_run_waits_while_a_sheet_that_may_plan_it_cannot_be_read() {
    let folder = with_two_samples();
    let sheet = "planned,file,sample\nP01,b,S2\n";
    folder.write("runs/bench.run-sheet.csv", format!("{sheet}P02\n"));
    let document = fits(&folder, 3);
    assert_eq!(sample_of(&document, "runs/b.csv"), None, "{document:#}");
    assert!(
        document["not_fitted"]
            .to_string()
            .contains("runs/bench.run-sheet.csv")
    );
    folder.write("runs/bench.run-sheet.csv", sheet);
    // The sheet and tags.toml contradict each other: the run waits for an answer.
    let document = fits(&folder, 0);
    assert_eq!(
        document["set_aside"][0]["reason"],
        "runs/b.csv: tags.toml says sample S1, the run sheet S2; its readings do not tell which is right"
    );
}

/// No file beside it can be called as it is and `.toml` more: there is none then, and the folder's tags hold.
#[test]
fn a_file_with_the_longest_name_that_there_is_has_tags() {
    let folder = CampaignFolder::new();
    let name = format!("runs/{}.csv", "n".repeat(251));
    folder.write(&name, run_table(1));
    let fitted = fits(&folder, 0);
    assert_eq!(sample_of(&fitted, &name), Some("S1"), "{fitted:#}");
    assert_eq!(unreadable_in_status(&folder), json!([]));
    folder
        .ieap(&["tag", &name, "relative_humidity_percent=40"])
        .expect(0);
    let runs = folder
        .ieap(&["table", "runs", "--format", "csv"])
        .expect(0)
        .stdout;
    assert!(runs.contains("40"), "{runs}");
}
