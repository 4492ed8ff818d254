//! In the rooms that store, scan and copy an error never becomes an empty value: what could not be read would be taken for
//! what is not there. What is left of it is listed here with the reason why nothing is lost by it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Rooms that are looked at.
const ROOMS: [&str; 6] = [
    "crates/store/src",
    "crates/system/src",
    "crates/ingest/src/scan",
    "crates/ingest/src/archive",
    "src/pipeline/upkeep",
    "src/pipeline/campaign",
];

/// What asks the disk or the database.
const ASKS: [&str; 10] = [
    "fs::",
    "File::open",
    "read_dir(",
    "metadata(",
    "canonicalize(",
    "query_row(",
    "query_map(",
    "prepare(",
    "prepare_cached(",
    "row.get(",
];

/// What makes an empty value of an error.
const EMPTIES: [&str; 4] = [".ok()", ".unwrap_or_default()", ".flatten()", ".unwrap_or(false)"];

/// Files in which it is done, how often, and why nothing is lost.
const ALLOWED: &[(&str, usize, &str)] = &[
    (
        "crates/store/src/lists.rs",
        1,
        "a row whose list is no text does not match its hash, and is told",
    ),
    (
        "crates/system/src/lib.rs",
        1,
        "of the program itself: without it pages are made again",
    ),
    (
        "crates/ingest/src/scan/walk.rs",
        1,
        "a folder that is not known to be there counts as not read, never as gone",
    ),
    (
        "crates/ingest/src/archive/durability.rs",
        1,
        "then each file is waited for by itself",
    ),
    (
        "src/pipeline/upkeep/backup/making.rs",
        1,
        "what a killed program left is removed the next time",
    ),
    (
        "src/pipeline/upkeep/backup/blobs.rs",
        1,
        "asks each folder above one that is still to be made",
    ),
    (
        "src/pipeline/upkeep/verify/weekly.rs",
        1,
        "a look whose time cannot be read is due",
    ),
];

fn sources(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, into);
        } else if path.extension().is_some_and(|e| e == "rs") && !path.to_string_lossy().contains("tests") {
            into.push(path);
        }
    }
}

/// Statements that ask for something and take an error for nothing.
fn emptied(text: &str) -> Vec<String> {
    let code = text.split("#[cfg(test)]").next().unwrap_or_default();
    let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
    let code = lines
        .map(str::trim)
        .collect::<Vec<_>>()
        .join(" ")
        .replace(" .", ".");
    let statements = code.split([';', '{', '}']).map(str::trim);
    let takes = |statement: &&str| {
        let asked = ASKS.iter().filter_map(|asks| statement.find(asks)).min();
        let after = asked.map_or("", |at| &statement[at..]);
        EMPTIES.iter().any(|empties| {
            let mut found = after.match_indices(empties);
            // After `?` it is an option, and no error any more.
            found.any(|(at, _)| !after[..at].contains('?'))
        })
    };
    statements.filter(takes).map(str::to_owned).collect()
}

#[test]
fn an_error_never_becomes_an_empty_value() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    ROOMS
        .iter()
        .for_each(|room| sources(&root.join(room), &mut files));
    assert!(files.len() > 80, "{}", files.len());
    let mut found: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for file in files {
        let statements = emptied(&std::fs::read_to_string(&file).unwrap());
        if !statements.is_empty() {
            let name = file.strip_prefix(root).unwrap().to_string_lossy().into_owned();
            found.insert(name, statements);
        }
    }
    let allowed: BTreeMap<&str, usize> = ALLOWED.iter().map(|(file, times, _)| (*file, *times)).collect();
    for (file, statements) in &found {
        assert_eq!(
            statements.len(),
            allowed.get(file.as_str()).copied().unwrap_or(0),
            "{file}: an error becomes an empty value: {statements:#?}"
        );
    }
    for (file, _, why) in ALLOWED {
        assert!(
            found.contains_key(*file),
            "{file} is listed ({why}) and does so no more"
        );
    }
}

#[test]
fn what_is_looked_for_is_found() {
    assert_eq!(emptied("let a = fs::read(path).unwrap_or_default();").len(), 1);
    assert_eq!(
        emptied("for e in fs::read_dir(p)\n    .into_iter()\n    .flatten() { }").len(),
        1
    );
    assert_eq!(
        emptied("let a = fs::read(path)?; let b = c.unwrap_or_default();").len(),
        0
    );
    assert_eq!(
        emptied("let a: Option<i64> = row.get(0)?; a.unwrap_or_default()").len(),
        0
    );
    assert_eq!(
        emptied("let a = journal(fs::read(path)?).unwrap_or_default();").len(),
        0
    );
}
