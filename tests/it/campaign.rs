//! A campaign in a folder of its own, and the command run on it.

use std::path::{Path, PathBuf};
use std::process::Command;

use assert_cmd::cargo::CommandCargoExt;
use serde_json::Value;
use tempfile::TempDir;

use crate::schemas;

/// campaign.toml of most tests: one sample of 5 mm x 2 mm.
pub const CAMPAIGN_TOML: &str = r#"
[campaign]
id = "test"
title = "A test"
timezone = "Europe/Tallinn"

[[sample]]
id = "S1"
material = "CNaf"
length_mm = 5.0
width_mm = 2.0
"#;

/// Tags for everything below runs/.
pub const TAGS_TOML: &str = "sample = \"S1\"\nenvironment = \"air\"\n";

/// A campaign folder that goes when it is dropped.
pub struct CampaignFolder {
    root: TempDir,
}

/// What a command printed and how it ended.
#[derive(Debug)]
pub struct Ended {
    /// Exit status.
    pub status: i32,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
}

impl Ended {
    /// The JSON document on stdout, held against its schema.
    pub fn json(&self) -> Value {
        let document = serde_json::from_str(&self.stdout).unwrap_or_else(|error| panic!("{error}\n{self:?}"));
        schemas::check(&document);
        document
    }

    /// Itself, after a check of the exit status.
    pub fn expect(self, status: i32) -> Ended {
        assert_eq!(self.status, status, "{self:#?}");
        self
    }
}

/// Runs `ieap` with `arguments` in `folder`.
#[must_use]
pub fn ieap(folder: &Path, arguments: &[&str]) -> Ended {
    let output = command(folder, arguments).output().unwrap();
    Ended {
        status: output.status.code().unwrap_or(-1),
        stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
        stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}

/// The command, not started yet.
pub fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::cargo_bin("ieap").unwrap();
    // What a test allows is not kept in the home of who tests.
    let state = concat!(env!("CARGO_TARGET_TMPDIR"), "/state");
    command
        .current_dir(folder)
        .args(arguments)
        .env("USER", "tester")
        .env("XDG_STATE_HOME", state);
    command
}

/// A run table of a decaying current and a rising curvature; `seed` makes its bytes its own.
pub fn run_table(seed: u32) -> String {
    let mut text = String::from("time_s,voltage_v,current_a,curvature_per_cm\n");
    let mut state = seed.wrapping_mul(2_654_435_761).wrapping_add(12345);
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1u32 << 24) - 0.5
    };
    for step in -20i32..300 {
        let t = f64::from(step);
        let on = f64::from(u8::from(step >= 0));
        let (tau_s, lambda_per_s) = (20.0, 0.002);
        let current_a = on * (1e-3 * (-t / tau_s).exp() + 2e-5) + 4e-6 * noise();
        let relaxed = ((-t / tau_s).exp() - (-lambda_per_s * t).exp()) / (tau_s * lambda_per_s - 1.0);
        let curvature = on * 0.4 * relaxed + 4e-3 * noise();
        text += &format!("{step},{},{current_a:.5e},{curvature:.5}\n", 2.0 * on);
    }
    text
}

/// How much a proof takes: little, so that an edit is tested within seconds, or as much as the statement deserves
/// where `IEAP_LONG` is set, as CI does.
pub fn counted(few: usize, many: usize) -> usize {
    match std::env::var_os("IEAP_LONG") {
        Some(_) => many,
        None => few,
    }
}

impl CampaignFolder {
    /// A campaign with [`CAMPAIGN_TOML`] and [`TAGS_TOML`] and no runs.
    pub fn new() -> CampaignFolder {
        let folder = CampaignFolder {
            root: tempfile::tempdir().unwrap(),
        };
        folder.write("campaign.toml", CAMPAIGN_TOML);
        folder.write("runs/tags.toml", TAGS_TOML);
        folder
    }

    /// Its folder.
    pub fn path(&self) -> &Path {
        self.root.path()
    }

    /// A path in it.
    pub fn join(&self, relative: &str) -> PathBuf {
        self.root.path().join(relative)
    }

    /// Writes a file, with its folders.
    pub fn write(&self, relative: &str, content: impl AsRef<[u8]>) {
        let path = self.join(relative);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, content).unwrap();
    }

    /// Runs `ieap` on it.
    #[must_use]
    pub fn ieap(&self, arguments: &[&str]) -> Ended {
        ieap(self.path(), arguments)
    }

    /// Runs `ieap run --json`, the diagnosis left out, and gives the summary.
    pub fn run_json(&self) -> Value {
        let ended = self.ieap(&["run", "--json", "--no-diagnose"]);
        assert!([0, 3].contains(&ended.status), "{ended:#?}");
        ended.json()["run"].clone()
    }

    /// A file of the report.
    pub fn report(&self, relative: &str) -> String {
        std::fs::read_to_string(self.join("report").join(relative)).unwrap()
    }
}

/// Changes the current results of a kind in the database, with hashes that are right for what they say then.
pub fn forge_results(folder: &Path, kind: &str, forge: impl Fn(&mut Value)) {
    let connection = rusqlite::Connection::open(folder.join("campaign.db")).unwrap();
    let sql = "SELECT id, document FROM result WHERE kind = ?1 AND superseded_at IS NULL";
    let mut statement = connection.prepare(sql).unwrap();
    let rows = statement.query_map([kind], |row| {
        Ok((row.get::<_, i64>(0)?, row.get::<_, String>(1)?))
    });
    let found: Vec<(i64, String)> = rows.unwrap().map(Result::unwrap).collect();
    for (id, document) in found {
        let mut document: Value = serde_json::from_str(&document).unwrap();
        forge(&mut document);
        let sql = "UPDATE result SET document = ?2 WHERE id = ?1";
        connection
            .execute(sql, rusqlite::params![id, document.to_string()])
            .unwrap();
    }
    self::forge(folder, "");
}

/// Changes the database of a campaign behind the back of the program, with hashes that are right for what it says then.
pub fn forge(folder: &Path, sql: &str) {
    let store = ieap::store::Store::open(folder).unwrap();
    let connection = rusqlite::Connection::open(folder.join("campaign.db")).unwrap();
    connection.execute_batch(sql).unwrap();
    store.hash_anew().unwrap();
}

/// The value of a tag that holds for the current run of that name.
pub fn chosen_tag(folder: &Path, run: &str, key: &str) -> Option<String> {
    let sql = "SELECT value FROM tags_view WHERE run = ?1 AND key = ?2 AND chosen = 1";
    let database = rusqlite::Connection::open(folder.join("campaign.db")).unwrap();
    database.query_row(sql, [run, key], |row| row.get(0)).ok()
}

/// Current runs with an issue of that code, each with what it says.
pub fn run_issues(folder: &Path, code: &str) -> Vec<(String, String)> {
    let store = ieap::store::Store::open_read_only(folder).unwrap().unwrap();
    let found = store.issues_of_code(code).unwrap().into_iter();
    found
        .map(|(run, issue)| (run, issue.message.to_string()))
        .collect()
}
