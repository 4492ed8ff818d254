//! What the program did not write it neither deletes nor replaces.

use std::fs;

use crate::campaign::{CampaignFolder, run_table};

fn with_a_run() -> CampaignFolder {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder
}

const RUN: [&str; 2] = ["run", "--no-diagnose"];

#[test]
fn a_report_folder_of_somebody_else_is_left_alone_and_everything_else_is_done() {
    let folder = with_a_run();
    folder.write("report/chapter1/thesis.tex", "x");
    let refused = folder.ieap(&RUN).expect(4);
    assert!(
        refused
            .stderr
            .contains("report/chapter1/thesis.tex was not written by ieap"),
        "{refused:#?}"
    );
    assert!(refused.stdout.contains("fits: 1 new"), "{refused:#?}");
    assert_eq!(
        fs::read_to_string(folder.join("report/chapter1/thesis.tex")).unwrap(),
        "x"
    );
    assert!(!folder.join("report/index.html").exists());
    let status = folder.ieap(&["status"]).expect(0);
    assert!(
        status.stdout.contains("thesis.tex was not written by ieap"),
        "{status:#?}"
    );
    let again = folder.ieap(&["report", "--json"]).expect(4).json();
    assert_eq!(again["report"]["rendered"], false);
    // The way to mend it that the message names.
    fs::rename(folder.join("report"), folder.join("my-report")).unwrap();
    folder.ieap(&RUN).expect(0);
    assert!(folder.join("report/index.html").exists());
    assert!(folder.join("my-report/chapter1/thesis.tex").exists());
}

#[test]
fn a_file_put_into_the_report_is_noticed_and_stays() {
    let folder = with_a_run();
    folder.ieap(&RUN).expect(0);
    let before = folder.report("index.html");
    folder.write("report/runs/notes.html", "mine");
    folder.write("runs/b.csv", run_table(2));
    let refused = folder.ieap(&RUN).expect(4);
    assert!(refused.stderr.contains("report/runs/notes.html"), "{refused:#?}");
    assert_eq!(folder.report("runs/notes.html"), "mine");
    assert_eq!(folder.report("index.html"), before);
    let verified = folder.ieap(&["verify", "--json"]).json().to_string();
    assert!(verified.contains("report-foreign-file"), "{verified}");
    fs::remove_file(folder.join("report/runs/notes.html")).unwrap();
    folder.ieap(&RUN).expect(0);
    assert_ne!(folder.report("index.html"), before);
}

#[test]
fn folders_that_only_share_the_beginning_of_a_name_stay() {
    let folder = with_a_run();
    folder.write(".report-old/thesis.tex", "x");
    folder.write(".report-2026/thesis.tex", "x");
    let done = folder.ieap(&RUN).expect(0);
    assert!(done.stderr.contains(".report-2026"), "{done:#?}");
    for kept in [".report-old/thesis.tex", ".report-2026/thesis.tex"] {
        assert!(folder.join(kept).exists(), "{kept}");
    }
}

/// A report of an earlier version has no list of its files: it is exchanged where all of it looks like ours.
#[test]
fn a_report_of_an_earlier_version_is_exchanged_unless_something_else_lies_in_it() {
    let folder = with_a_run();
    folder.ieap(&RUN).expect(0);
    fs::remove_file(folder.join("report/.written")).unwrap();
    folder.ieap(&["report", "--again"]).expect(0);
    assert!(folder.join("report/.written").exists());
    for other in ["notes.html", "runs/notes.html", "data.csv", "figures/a.html"] {
        fs::remove_file(folder.join("report/.written")).unwrap();
        folder.write(&format!("report/{other}"), "<!DOCTYPE html><p>mine</p>");
        let refused = folder.ieap(&["report", "--again"]).expect(4);
        assert!(refused.stderr.contains("was not written by ieap"), "{refused:#?}");
        assert!(folder.join("report").join(other).exists());
        fs::remove_dir_all(folder.join("report")).unwrap();
        folder.ieap(&["report"]).expect(0);
    }
}
