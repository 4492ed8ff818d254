//! The first hour of a laboratory that nobody prepared: its files as its instruments write them, in its own language and
//! layout, from folder to report in a few commands and edits, held against the truth that they were simulated from.

mod chinese;
mod estonian;
mod french;
mod japanese;
mod own_clocks;
mod truth;

use std::cell::RefCell;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use tempfile::TempDir;

use crate::campaign::{Ended, command};
use truth::Truth;

/// Most commands and edits that a report may take.
const MOST_COMMANDS: usize = 8;
const MOST_EDITS: usize = 3;

/// A person before a computer: what is typed and edited is counted.
struct Person {
    root: TempDir,
    zone: &'static str,
    commands: RefCell<Vec<String>>,
    edits: RefCell<Vec<String>>,
}

impl Person {
    fn new(zone: &'static str) -> Person {
        Person {
            root: tempfile::tempdir().unwrap(),
            zone,
            commands: RefCell::default(),
            edits: RefCell::default(),
        }
    }

    fn path(&self, relative: &str) -> PathBuf {
        self.root.path().join(relative)
    }

    /// Has a file in a folder, in an encoding that holds all of its letters.
    fn puts(&self, folder: &str, name: &str, encoding: &'static encoding_rs::Encoding, text: &str) {
        let (bytes, _, lacks) = encoding.encode(text);
        assert!(!lacks, "{name} in {}", encoding.name());
        let path = self.path(folder).join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }

    /// Types a command.
    fn types(&self, arguments: &[&str]) -> Ended {
        self.commands.borrow_mut().push(arguments.join(" "));
        self.looks(arguments)
    }

    /// Makes a campaign of a folder: is shown what its files are, takes them, and says how large the strips are.
    fn makes(
        &self,
        campaign: &str,
        folder: &str,
        told: &[&str],
        (length_mm, width_mm): (f64, f64),
    ) -> String {
        let from = ["init", campaign, "--from", folder, "--yes"];
        let shown = self.types(&from[..4]).expect(0).stdout;
        for told in told {
            assert!(shown.contains(told), "{told} in {shown}");
        }
        self.types(&from).expect(0);
        let length = format!("length_mm = {length_mm:?}");
        let width = format!("width_mm = {width_mm:?}");
        let size = [
            ("# length_mm = 0.0", length.as_str()),
            ("# width_mm = 0.0", &width),
        ];
        self.edits(&format!("{campaign}/campaign.toml"), &size);
        shown
    }

    /// Looks closer than a person would have to: a command that is not counted.
    fn looks(&self, arguments: &[&str]) -> Ended {
        let output = command(self.root.path(), arguments)
            .env("TZ", self.zone)
            .output()
            .unwrap();
        Ended {
            status: output.status.code().unwrap_or(-1),
            stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }

    /// Edits a file: every `from` becomes `to`.
    fn edits(&self, relative: &str, changes: &[(&str, &str)]) {
        let path = self.path(relative);
        let mut text = fs::read_to_string(&path).unwrap();
        for (from, to) in changes {
            assert!(text.contains(from), "{from} in {text}");
            text = text.replace(from, to);
        }
        fs::write(&path, text).unwrap();
        self.edits.borrow_mut().push(relative.to_owned());
    }

    /// Nothing more was needed than the issue of this test allows, and no script wrote sidecars.
    fn was_quick(&self, campaign: &str) {
        let (commands, edits) = (self.commands.borrow(), self.edits.borrow());
        assert!(commands.len() <= MOST_COMMANDS, "{commands:#?}");
        assert!(edits.len() <= MOST_EDITS, "{edits:#?}");
        let sidecars: Vec<PathBuf> = files_below(&self.path(campaign).join("runs"))
            .into_iter()
            .filter(|path| path.to_string_lossy().ends_with(".toml"))
            .collect();
        assert!(sidecars.is_empty(), "{sidecars:#?}");
    }

    /// What became of the files, by path.
    fn stories(&self, campaign: &str) -> Vec<Value> {
        let told = self
            .looks(&["status", "--files", "--json", campaign])
            .expect(0)
            .json();
        told["files"].as_array().unwrap().clone()
    }
}

fn files_below(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files_below(&path));
        } else {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn story<'s>(stories: &'s [Value], path: &str) -> &'s Value {
    let found = stories.iter().find(|story| story["path"] == path);
    found.unwrap_or_else(|| panic!("{path} in {stories:#?}"))
}

/// Every file of the folder is told of, each that is not used with its cause.
fn nothing_is_lost(stories: &[Value], folder: &Path) {
    for path in files_below(folder) {
        let shown = path
            .strip_prefix(folder)
            .unwrap()
            .to_string_lossy()
            .replace('\\', "/");
        let told = stories
            .iter()
            .find(|story| story["path"].as_str().unwrap().ends_with(&shown));
        let told = told.unwrap_or_else(|| panic!("nothing is said of {shown}"));
        let became = told["became"].as_str().unwrap();
        let is_used = [
            "run",
            "half of a run",
            "climate log",
            "modulus log",
            "run sheet",
            "copy of a file",
        ]
        .contains(&became);
        assert!(
            is_used || told["why"].as_array().is_some_and(|why| !why.is_empty()),
            "{told:#}"
        );
    }
}

/// The fits of the campaign are those of the truth: every run that should be there, under its tags, with its parameters, and
/// `others` that tell less.
fn is_true<Word>(person: &Person, campaign: &str, (truths, others): (&[(Word, Truth)], &[&str])) {
    let fits = person.looks(&["fit", "--json", campaign]).json();
    let fits = fits["fits"].as_array().unwrap();
    let found: Vec<&str> = fits.iter().map(|fit| fit["run"].as_str().unwrap()).collect();
    let mut expected: Vec<&str> = truths.iter().map(|(_, truth)| truth.run.as_str()).collect();
    expected.extend(others);
    expected.sort_unstable();
    let mut sorted = found.clone();
    sorted.sort_unstable();
    assert_eq!(sorted, expected);
    for (_, truth) in truths {
        let fit = fits.iter().find(|fit| fit["run"] == truth.run.as_str()).unwrap();
        assert_eq!(fit["sample"], truth.sample.as_str(), "{}", truth.run);
        assert_eq!(fit["environment"], truth.environment, "{}", truth.run);
        assert_eq!(fit["voltage_v"], truth.voltage_v, "{}", truth.run);
        let humidity = fit["relative_humidity_percent"].as_f64();
        let stated = humidity.unwrap_or_else(|| panic!("{} has no humidity", truth.run));
        assert!(
            (stated - truth.humidity_percent).abs() < 3.0,
            "{}: {stated}",
            truth.run
        );
        for (key, value) in truth.told() {
            let parameter = &fit["parameters"][key];
            let (low, high) = (parameter["low_95"].as_f64(), parameter["high_95"].as_f64());
            let (Some(low), Some(high)) = (low, high) else {
                panic!("{key} of {}: {parameter:#}", truth.run);
            };
            // Of some hundred intervals a few miss by chance: a half more of the interval on each side misses none.
            let room = 0.5 * (high - low);
            assert!(
                low - room <= value && value <= high + room,
                "{key} of {}: {value} in {low} .. {high}",
                truth.run
            );
        }
    }
}
