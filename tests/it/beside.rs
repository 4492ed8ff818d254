//! What may be done beside a program that works on the campaign, and with databases that are not as they should be.

use ieap::store::InstanceLock;

use crate::campaign::{CampaignFolder, run_table};

fn fitted_campaign() -> CampaignFolder {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    folder
}

fn database(folder: &CampaignFolder) -> rusqlite::Connection {
    rusqlite::Connection::open(folder.join("campaign.db")).unwrap()
}

fn version(folder: &CampaignFolder) -> i64 {
    let database = database(folder);
    database
        .pragma_query_value(None, "user_version", |row| row.get(0))
        .unwrap()
}

#[test]
fn fits_are_told_beside_a_working_program_where_nothing_is_to_be_done() {
    let folder = fitted_campaign();
    let alone = folder.ieap(&["fit", "--json"]).expect(0).json();
    let lock = InstanceLock::take(folder.path()).unwrap();
    assert_eq!(folder.ieap(&["fit", "--json"]).expect(0).json(), alone);
    folder.write("runs/b.csv", run_table(2));
    let refused = folder.ieap(&["fit", "--json"]).expect(4);
    assert!(
        refused.stderr.contains("another ieap works") && refused.stderr.contains("1 file to take in"),
        "{refused:#?}"
    );
    drop(lock);
    folder.ieap(&["ingest"]).expect(0);
    let _lock = InstanceLock::take(folder.path()).unwrap();
    let refused = folder.ieap(&["fit", "--json"]).expect(4);
    // The first is to be fitted again: now another run tells of its instrument's noise.
    assert!(refused.stderr.contains("2 runs to fit"), "{refused:#?}");
}

#[test]
fn whoever_reads_does_not_bring_a_database_up_to_date() {
    let folder = fitted_campaign();
    let newest = version(&folder);
    database(&folder)
        .pragma_update(None, "user_version", newest - 1)
        .unwrap();
    let lock = InstanceLock::take(folder.path()).unwrap();
    for arguments in [
        &["status"][..],
        &["table", "table5"],
        &["export", "--what", "all", "-o", "out"],
    ] {
        let refused = folder.ieap(arguments).expect(4);
        assert!(
            refused.stderr.contains("`ieap run` makes a new one"),
            "{refused:#?}"
        );
    }
    // Neither does a second writer while another holds the lock.
    let refused = folder.ieap(&["tag", "runs/a.csv", "note=x"]).expect(4);
    assert!(refused.stderr.contains("another ieap works"), "{refused:#?}");
    assert_eq!(version(&folder), newest - 1);
    let names = std::fs::read_dir(folder.path()).unwrap();
    let mut names = names.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert!(names.all(|name| !name.contains("set-aside")));
    drop(lock);
}

#[test]
fn a_database_that_forgot_its_version_is_not_taken_for_an_empty_one() {
    let folder = fitted_campaign();
    database(&folder).pragma_update(None, "user_version", 0).unwrap();
    for arguments in [&["status"][..], &["run", "--no-diagnose"]] {
        let refused = folder.ieap(arguments).expect(4);
        assert!(refused.stderr.contains("user_version is 0"), "{refused:#?}");
        assert!(!refused.stderr.contains("CREATE TABLE"), "{refused:#?}");
    }
}
