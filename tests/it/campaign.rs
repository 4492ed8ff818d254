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

/// Changes the current results of a kind in the database, with hashes and a sum that are right for what they say then.
pub fn forge_results(folder: &Path, kind: &str, forge: impl Fn(&mut Value)) {
    let connection = rusqlite::Connection::open(folder.join("campaign.db")).unwrap();
    let sql = "SELECT id, kind, name, key, version, document, made_at FROM result
               WHERE kind = ?1 AND superseded_at IS NULL";
    let mut sum = [0; 16];
    let mut statement = connection.prepare(sql).unwrap();
    let mut rows = statement.query([kind]).unwrap();
    while let Some(row) = rows.next().unwrap() {
        let text = |column: &str| row.get::<_, String>(column).unwrap();
        let mut document: Value = serde_json::from_str(&text("document")).unwrap();
        forge(&mut document);
        let document = document.to_string();
        let mut hasher = blake3::Hasher::new();
        let [kind, name, key, version] = ["kind", "name", "key", "version"].map(text);
        for text in [&kind, &name, &key, &version, &document, &text("made_at")] {
            hasher.update(&(text.len() as u64).to_le_bytes());
            hasher.update(text.as_bytes());
        }
        let hash = hasher.finalize().as_bytes()[..16].to_vec();
        sum.iter_mut().zip(&hash).for_each(|(sum, hash)| *sum ^= hash);
        let id: i64 = row.get("id").unwrap();
        let sql = "UPDATE result SET document = ?2, hash = ?3 WHERE id = ?1";
        connection
            .execute(sql, rusqlite::params![id, document, hash])
            .unwrap();
    }
    let sql = "UPDATE result_sum SET sum = ?2 WHERE kind = ?1";
    connection.execute(sql, rusqlite::params![kind, sum]).unwrap();
}

/// Changes the database of a campaign behind the back of the program, with seals that are right for what it says then.
pub fn forge(folder: &Path, sql: &str) {
    let store = ieap::store::Store::open(folder).unwrap();
    let connection = rusqlite::Connection::open(folder.join("campaign.db")).unwrap();
    connection.execute_batch(sql).unwrap();
    store.seal_anew().unwrap();
}
