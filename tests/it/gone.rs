//! Runs whose files are not there any more keep what is known of them: a disk that is not mounted shows an empty folder.

use std::fs;

use serde_json::json;

use crate::campaign::{CampaignFolder, run_table};
use crate::rebuild::comes_back;

/// Runs with tags of every kind of file: tags.toml, a sidecar, and a row of a run sheet.
fn tagged() -> CampaignFolder {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.write("runs/set/b.csv", run_table(2));
    folder.write("runs/set/b.csv.toml", "relative_humidity_percent = 40\n");
    folder.write("runs/c.csv", run_table(3));
    folder.write("runs/plan.run-sheet.csv", "planned,file,cycle\nP01,c,7\n");
    let made = folder.run_json();
    assert_eq!(made["fit"]["fitted"], 3, "{made:#}");
    folder
}

/// State and tags of every run.
fn known(folder: &CampaignFolder) -> String {
    for what in ["runs", "tags"] {
        let file = format!("{what}.known.csv");
        folder
            .ieap(&["export", "--what", what, "-o", &file, "--overwrite"])
            .expect(0);
    }
    let text = |what| fs::read_to_string(folder.join(&format!("{what}.known.csv"))).unwrap();
    text("runs") + &text("tags")
}

#[test]
fn an_empty_folder_in_place_of_a_full_one_takes_no_tags_and_no_fits() {
    let folder = tagged();
    let before = known(&folder);
    fs::rename(folder.join("runs"), folder.join("elsewhere")).unwrap();
    fs::create_dir(folder.join("runs")).unwrap();
    let made = folder.run_json();
    assert_eq!(made["ingest"]["untagged"], json!([]), "{made:#}");
    assert_eq!(made["ingest"]["retagged"], json!([]), "{made:#}");
    assert_eq!(made["fit"]["up_to_date"], 3, "{made:#}");
    assert_eq!(made["ingest"]["gone"].as_array().unwrap().len(), 3);
    assert_eq!(known(&folder), before);
    comes_back(&folder);
    assert_eq!(known(&folder), before);
    // What a person says still counts.
    folder
        .ieap(&["tag", "runs/c.csv", "relative_humidity_percent=55"])
        .expect(0);
    assert_ne!(known(&folder), before);
    folder
        .ieap(&["tag", "runs/c.csv", "relative_humidity_percent="])
        .expect(0);
    // The disk comes back.
    fs::remove_dir(folder.join("runs")).unwrap();
    fs::rename(folder.join("elsewhere"), folder.join("runs")).unwrap();
    let made = folder.run_json();
    assert_eq!(made["ingest"]["new"], json!([]), "{made:#}");
    assert_eq!(known(&folder), before);
}

#[test]
fn a_tag_file_that_is_taken_from_a_run_that_is_there_takes_its_tags_along() {
    let folder = tagged();
    fs::remove_file(folder.join("runs/tags.toml")).unwrap();
    let made = folder.run_json();
    assert_eq!(
        made["ingest"]["untagged"].as_array().unwrap().len(),
        3,
        "{made:#}"
    );
}
