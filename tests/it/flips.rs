//! Flipped bytes of a database: told, or without any effect.

use std::fs;
use std::path::Path;

use ieap::pipeline::documents::fits::fits_document;
use ieap::pipeline::show::export::{Export, written};
use ieap::pipeline::show::tables::{find_format, listed, table};
use ieap::pipeline::{
    Context, DiagnoseChoice, DiagnoseRuns, FitChoice, FitRuns, Ingest, PipelineError, Rebuild, Silent,
};
use ieap::store::{Content, Store};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::campaign::{CampaignFolder, counted, forge, run_table};

/// Of so many flips that are told, one is mended by a rebuilding.
const REBUILT: usize = 50;
/// Of the flips.
const SEED: u64 = 20_261_122;

/// A campaign with fits, tags by hand, and a finding.
fn campaign() -> CampaignFolder {
    let folder = CampaignFolder::new();
    for (name, seed) in [("a", 1), ("b", 2), ("c", 3)] {
        folder.write(&format!("runs/{name}.csv"), run_table(seed));
        folder.write(&format!("runs/{name}.csv.toml"), format!("cycle = {seed}\n"));
    }
    folder.write("runs/refused.csv", "no table\n");
    folder.ieap(&["run", "--no-diagnose"]).expect(3);
    folder.ieap(&["tag", "runs/a.csv", "note=by hand"]).expect(0);
    let mut context = Context::open(folder.path(), false).unwrap();
    let diagnosis = DiagnoseRuns {
        choice: DiagnoseChoice {
            draws: Some(20),
            ..DiagnoseChoice::default()
        },
        ..DiagnoseRuns::default()
    };
    diagnosis.run(&mut context, &Silent).unwrap();
    drop(context);
    folder
}

/// What `fit --json`, every table and every export say.
fn said(folder: &Path) -> Result<Vec<u8>, PipelineError> {
    let mut context = Context::open(folder, false)?;
    Ingest { ready: &mut |_| true }.run(&mut context, &Silent)?;
    FitRuns {
        choice: FitChoice::default(),
        again: false,
    }
    .run(&mut context, &Silent)?;
    let mut said = serde_json::to_vec(&fits_document(&context)?).unwrap();
    let json = find_format("json")?;
    for (name, _) in listed() {
        said.extend((json.write)(&table(&context, name)?).into_bytes());
    }
    for (table, _) in written() {
        let path = folder.join("exported.csv");
        Export {
            format: None,
            table,
            path: path.clone(),
            overwrite: true,
        }
        .run(&context)?;
        said.extend(fs::read(&path).unwrap());
    }
    Ok(said)
}

fn put(folder: &Path, database: &[u8]) {
    for companion in ["-wal", "-shm"] {
        let _ = fs::remove_file(folder.join(format!("campaign.db{companion}")));
    }
    fs::write(folder.join("campaign.db"), database).unwrap();
}

fn content(folder: &Path) -> Content {
    Store::open_read_only(folder).unwrap().unwrap().content().unwrap()
}

/// The database is made anew, and says what the sound one said; findings are made by the next diagnosis. What the rebuilding
/// wrote into the journal (that words of the database may be lost) is no fault of the next flip.
fn comes_back(folder: &Path, sound: &Content) {
    let journal = folder.join("archive/journal.jsonl");
    let before = fs::read(&journal).unwrap();
    let rebuilt = Rebuild::default().run(folder, &Silent).unwrap();
    let mut differences = sound.differences(&content(folder));
    differences.retain(|(part, _)| *part != "diagnosis");
    assert_eq!(differences, []);
    fs::write(journal, before).unwrap();
    for companion in ["", "-wal", "-shm"] {
        if let Some(aside) = &rebuilt.set_aside {
            let _ = fs::remove_file(format!("{}{companion}", aside.display()));
        }
    }
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn a_flipped_byte_is_told_or_has_no_effect() {
    let folder = campaign();
    let whole = fs::read(folder.join("campaign.db")).unwrap();
    let expected = said(folder.path()).unwrap();
    put(folder.path(), &whole);
    assert!(
        said(folder.path()).unwrap() == expected,
        "asked again, it says the same"
    );
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let content = content(folder.path());
    let (mut told, mut harmless, mut silent) = (0, 0, Vec::new());
    for _ in 0..counted(200, 10_000) {
        let (at, flip) = (rng.random_range(0..whole.len()), rng.random_range(1..=255u8));
        let mut flipped = whole.clone();
        flipped[at] ^= flip;
        put(folder.path(), &flipped);
        match said(folder.path()) {
            Err(error) => {
                assert!(error.is_storage(), "byte {at} ^ {flip}: {error}");
                if told % REBUILT == 0 {
                    comes_back(folder.path(), &content);
                }
                told += 1;
            }
            Ok(said) if said == expected => harmless += 1,
            Ok(_) => silent.push((at, flip)),
        }
    }
    println!(
        "{} bytes; {told} told, {harmless} without effect, {} silent",
        whole.len(),
        silent.len()
    );
    assert_eq!(silent, []);
}

#[test]
fn a_number_that_changed_in_the_database_ends_with_status_4_and_a_way_to_mend() {
    for tampering in [
        "UPDATE result SET document = replace(document, '\"value\":', '\"value\":1')",
        "UPDATE result SET document = json_remove(document, '$.found.parameters[1]')",
        "UPDATE result SET row_hash = x'00'",
        "UPDATE run SET tagging = replace(tagging, 'environment', 'environmint')",
        "UPDATE run SET tagging = json_set(tagging, '$.area_cm2', 2)",
        "UPDATE run SET tagging = json_remove(tagging, '$.tags[0]')",
        "UPDATE run SET superseded_at = '2026-01-01T00:00:00Z'",
    ] {
        let folder = CampaignFolder::new();
        folder.write("runs/a.csv", run_table(1));
        folder.write("runs/b.csv", run_table(1) + "#\n");
        folder.ieap(&["run", "--no-diagnose"]).expect(0);
        rusqlite::Connection::open(folder.join("campaign.db"))
            .unwrap()
            .execute_batch(tampering)
            .unwrap();
        for verb in [
            &["fit", "--json"][..],
            &["table", "fits-wide"],
            &["run", "--no-diagnose"],
        ] {
            let refused = folder.ieap(verb).expect(4);
            assert!(refused.stderr.contains("checksum"), "{tampering} {refused:?}");
            assert!(
                refused.stderr.contains("--new-database"),
                "{tampering} {refused:?}"
            );
        }
        let store = Store::open_read_only(folder.path()).unwrap().unwrap();
        assert!(!store.check_all().unwrap().is_empty(), "{tampering}");
    }
}

#[test]
fn readings_are_held_against_their_hash() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    // The hashes of the rows are right, that of the readings is not.
    forge(
        folder.path(),
        "UPDATE channel SET value_blob = (SELECT value_blob FROM channel WHERE ordinal = 0) WHERE ordinal = 1",
    );
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let refused = folder.ieap(&["fit", "--again"]).expect(4);
    assert!(refused.stderr.contains("readings of run"), "{}", refused.stderr);
}

#[test]
fn the_structure_is_looked_at_after_a_disorderly_end() {
    let folder = campaign();
    // An index that nothing reads: the number of entries on its first page.
    let page: usize = rusqlite::Connection::open(folder.join("campaign.db"))
        .unwrap()
        .query_row(
            "SELECT rootpage FROM sqlite_schema WHERE name = 'result_run'",
            [],
            |row| Ok(row.get::<_, i64>(0)? as usize),
        )
        .unwrap();
    let mut database = fs::read(folder.join("campaign.db")).unwrap();
    database[(page - 1) * 4096 + 3] ^= 0x40;
    put(folder.path(), &database);
    folder.ieap(&["report"]).expect(0);
    put(folder.path(), &database);
    folder.write("campaign.db.lock", "process 1 on another\n");
    let refused = folder.ieap(&["report"]).expect(4);
    assert!(
        refused.stderr.contains("not a readable SQLite database"),
        "{}",
        refused.stderr
    );
}
