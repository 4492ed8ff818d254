//! A command that campaign.toml names is run where the user allowed it, and nowhere else.

use crate::campaign::{CAMPAIGN_TOML, CampaignFolder, command, run_table};

/// Runs 1 to 4 of a sample raise an alarm, of which the command writes a line.
fn campaign(file: &str) -> CampaignFolder {
    let folder = CampaignFolder::new();
    names(&folder, file);
    for run in 1..5 {
        folder.write(&format!("runs/{run}.csv.toml"), format!("cycle = {run}\n"));
        folder.write(&format!("runs/{run}.csv"), run_table(run));
    }
    folder
}

/// The command writes into that file.
fn names(folder: &CampaignFolder, file: &str) {
    let monitoring = format!(
        "[monitoring]\ncommand = [\"sh\", \"-c\", \"echo told >> {file}\"]\n\
         [[monitoring.limit]]\nparameter = \"c_total_f_per_cm2\"\nbelow = 1e6\n"
    );
    folder.write("campaign.toml", format!("{CAMPAIGN_TOML}{monitoring}"));
}

/// Alarms that a run tells when it has no memory of having told them.
fn again(folder: &CampaignFolder) {
    for name in ["campaign.db", "archive", "report"] {
        let path = folder.join(name);
        let gone = if path.is_dir() {
            std::fs::remove_dir_all(&path)
        } else {
            std::fs::remove_file(&path)
        };
        gone.unwrap();
    }
}

const COMMAND: &str = "[\"sh\", \"-c\", \"echo told >> told.txt\"]";

#[test]
fn a_command_that_nobody_allowed_is_not_run_and_that_is_said() {
    let folder = campaign("told.txt");
    let run = folder.ieap(&["run", "--no-diagnose"]).expect(0);
    assert!(!folder.join("told.txt").exists(), "{run:#?}");
    for said in [
        "warning: alarm: ",
        "warning: the command of [monitoring] was not run: ",
        COMMAND,
        "--allow-command",
    ] {
        assert!(run.stderr.contains(said), "{said}: {run:#?}");
    }
    // The alarm stands as any other, and its command is known not to have been run.
    let status = folder.ieap(&["status", "--alarms"]).expect(5);
    assert!(
        status.stderr.contains("is not run for alarms") && status.stderr.contains(COMMAND),
        "{status:#?}"
    );
    let journal = std::fs::read_to_string(folder.join("archive/journal.jsonl")).unwrap();
    assert!(journal.contains("was not run: "), "{journal}");
}

#[test]
fn what_is_allowed_is_one_command_of_one_campaign() {
    let folder = campaign("told.txt");
    let run = folder
        .ieap(&["run", "--no-diagnose", "--allow-command"])
        .expect(0);
    assert!(
        run.stderr.contains("Allowed to be run") && run.stderr.contains(COMMAND),
        "{run:#?}"
    );
    let told = || std::fs::read_to_string(folder.join("told.txt")).unwrap_or_default();
    let once = told();
    assert!(!once.is_empty(), "{run:#?}");
    // From now on without being asked.
    again(&folder);
    let run = folder.ieap(&["run", "--no-diagnose"]).expect(0);
    assert!(
        told().len() > once.len() && !run.stderr.contains("not allowed"),
        "{run:#?}"
    );
    assert_eq!(folder.ieap(&["status", "--alarms"]).expect(5).stderr, "");
    // Another command has to be allowed by itself.
    names(&folder, "other.txt");
    again(&folder);
    let run = folder.ieap(&["run", "--no-diagnose", "--json"]).expect(0);
    assert!(!folder.join("other.txt").exists(), "{run:#?}");
    let failed = run.json()["run"]["alarms"]["failed_commands"][0].to_string();
    assert!(failed.contains("was not run"), "{failed}");
    // And so has the same one of another campaign.
    let other = campaign("told.txt");
    let _ = other.ieap(&["run", "--no-diagnose"]).expect(0);
    assert!(!other.join("told.txt").exists());
}

#[test]
fn what_cannot_be_allowed_is_said() {
    let folder = CampaignFolder::new();
    let run = folder
        .ieap(&["run", "--no-diagnose", "--allow-command"])
        .expect(0);
    assert!(run.stderr.contains("nothing to allow"), "{run:#?}");
    names(&folder, "told.txt");
    // A file stands where the folder would have to be.
    let ended = command(folder.path(), &["run", "--no-diagnose", "--allow-command"])
        .env("XDG_STATE_HOME", folder.join("campaign.toml"))
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&ended.stderr).into_owned();
    assert_eq!(ended.status.code(), Some(4), "{said}");
    assert!(
        said.contains("making the folder for what you allow failed"),
        "{said}"
    );
}
