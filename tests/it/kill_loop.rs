//! Killed at any moment, nothing is lost, doubled or half-done.

use std::process::Stdio;
use std::time::Duration;

use serde_json::Value;

use crate::campaign::{CampaignFolder, command, counted, run_table};
use crate::rebuild::comes_back;

/// Files added before each start.
const FILES_A_ROUND: u32 = 2;

fn kills() -> u32 {
    counted(15, 1000) as u32
}

/// What must hold of a database whatever was killed when.
fn check(folder: &CampaignFolder) {
    if !folder.join("campaign.db").exists() {
        return;
    }
    let database = rusqlite::Connection::open(folder.join("campaign.db")).unwrap();
    let one = |sql: &str| -> String {
        database
            .query_row(sql, [], |row| {
                row.get::<_, rusqlite::types::Value>(0).map(|v| format!("{v:?}"))
            })
            .unwrap()
    };
    if one("SELECT count(*) FROM sqlite_schema WHERE name = 'run'") == "Integer(0)" {
        return;
    }
    assert_eq!(one("PRAGMA integrity_check"), "Text(\"ok\")");
    assert_eq!(one("SELECT count(*) FROM pragma_foreign_key_check"), "Integer(0)");
    let doubled = "SELECT count(*) FROM (SELECT path FROM run WHERE superseded_at IS NULL GROUP BY path HAVING count(*) > 1)";
    assert_eq!(one(doubled), "Integer(0)");
    assert_eq!(one("SELECT count(*) FROM run WHERE revision > 1"), "Integer(0)");
    // Every content that the database names is in the archive, whole.
    let mut contents = database
        .prepare("SELECT hash, archive_path FROM content")
        .unwrap();
    let rows = contents
        .query_map([], |row| Ok((row.get::<_, String>(0)?, row.get::<_, String>(1)?)))
        .unwrap();
    for row in rows {
        let (hash, path) = row.unwrap();
        let bytes = std::fs::read(folder.join(&path)).unwrap_or_else(|error| panic!("{path}: {error}"));
        assert_eq!(blake3::hash(&bytes).to_hex().as_str(), hash, "{path}");
    }
    // A report that is there is whole: its index ends, and every page it links to is there.
    if let Ok(index) = std::fs::read_to_string(folder.join("report/index.html")) {
        assert!(index.trim_end().ends_with("</html>"));
        for link in index
            .split("href=\"runs/")
            .skip(1)
            .filter_map(|rest| rest.split(['"', '#']).next())
        {
            assert!(folder.join("report/runs").join(link).exists(), "{link}");
        }
    }
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn killed_at_any_moment_nothing_is_lost_doubled_or_half_done() {
    let folder = CampaignFolder::new();
    let mut state = 20_150_607u64;
    let mut random_ms = |below: u64| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % below
    };
    let (mut files, mut killed) = (0, 0);
    for _ in 0..kills() {
        for _ in 0..FILES_A_ROUND {
            folder.write(&format!("runs/{files}.csv"), run_table(files));
            files += 1;
        }
        let mut child = command(folder.path(), &["run", "--no-diagnose"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_millis(random_ms(60)));
        killed += u32::from(child.try_wait().unwrap().is_none());
        child.kill().unwrap();
        child.wait().unwrap();
        check(&folder);
    }
    let summary = folder.run_json();
    check(&folder);
    assert_eq!(summary["ingest"]["refused"], serde_json::json!([]));
    let document = folder.ieap(&["fit", "--json"]).expect(0).json();
    assert_eq!(document["fits"].as_array().unwrap().len(), files as usize);
    let leftovers: Vec<_> = std::fs::read_dir(folder.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .filter(|name| name.starts_with(".report"))
        .collect();
    assert!(leftovers.is_empty(), "{leftovers:?}");
    comes_back(&folder);
    eprintln!(
        "{killed} of {} kills met a working program; {files} files, all fitted",
        kills()
    );
}

/// Many files are stored in batches: a kill loses no more than the batch under way, which is read again.
#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn killed_while_many_files_come_in_nothing_is_lost_doubled_or_half_done() {
    const FILES: u32 = 400;
    let folder = CampaignFolder::new();
    let short = |seed: u32| run_table(seed).lines().take(40).collect::<Vec<_>>().join("\n") + "\n";
    (0..FILES).for_each(|seed| folder.write(&format!("runs/{seed}.csv"), short(seed)));
    folder.write("runs/bad.csv", "time_s;current_a\n0;1.5\n1;2,5\n");
    let (mut delay_ms, mut killed) = (10, 0);
    for _ in 0..kills() {
        let mut child = command(folder.path(), &["ingest"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_millis(delay_ms));
        delay_ms = delay_ms * 7 % 181 + 10;
        killed += u32::from(child.try_wait().unwrap().is_none());
        child.kill().unwrap();
        child.wait().unwrap();
        check(&folder);
    }
    // One that was being read at two kills may be what ended the program, and says how it is tried again.
    let refused = || {
        let summary = folder.ieap(&["ingest", "--json"]).expect(3).json();
        check(&folder);
        let (bad, ended): (Vec<Value>, Vec<Value>) = (summary["ingest"]["refused"].as_array().unwrap())
            .iter()
            .cloned()
            .partition(|refused| refused[0] == "runs/bad.csv");
        assert_eq!(bad.len(), 1, "{summary:#}");
        ended
    };
    for ended in refused() {
        assert_eq!(ended[1]["code"], "ended-program", "{ended:#}");
        let name = ended[0].as_str().unwrap();
        let file = std::fs::File::options().append(true).open(folder.join(name));
        file.unwrap().set_modified(std::time::SystemTime::now()).unwrap();
    }
    assert_eq!(refused(), Vec::<Value>::new());
    let database = rusqlite::Connection::open(folder.join("campaign.db")).unwrap();
    let count = |sql: &str| -> u32 { database.query_row(sql, [], |row| row.get(0)).unwrap() };
    assert_eq!(
        count("SELECT count(*) FROM run WHERE superseded_at IS NULL"),
        FILES
    );
    assert_eq!(count("SELECT count(*) FROM content"), FILES);
    let half: Vec<_> = std::fs::read_dir(folder.join("archive"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.is_dir())
        .flat_map(|folder| std::fs::read_dir(folder).unwrap())
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .filter(|name| name.starts_with(".part-"))
        .collect();
    assert!(half.is_empty(), "{half:?}");
    folder.ieap(&["verify"]).expect(0);
    eprintln!("{killed} of {} kills met a working program", kills());
}
