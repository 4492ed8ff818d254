//! The codes as the sources have them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::house;

/// Rust files of the crates and of the program, each cut off where its tests begin.
pub fn sources() -> BTreeMap<PathBuf, String> {
    fn walk(folder: &Path, found: &mut BTreeMap<PathBuf, String>) {
        for path in std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().path())
        {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.is_dir() && !["tests", "examples", "target"].contains(&&*name) {
                walk(&path, found);
            } else if name.ends_with(".rs") && !name.ends_with("tests.rs") {
                let text = std::fs::read_to_string(&path).unwrap();
                let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
                found.insert(path, code.to_owned());
            }
        }
    }
    let mut found = BTreeMap::new();
    ["src", "crates"]
        .iter()
        .for_each(|folder| walk(&house().join(folder), &mut found));
    found
}

/// The codes that issues are made with, as literals and as constants; and, as file and argument, where it is neither.
pub fn codes() -> (BTreeSet<String>, BTreeSet<String>) {
    let sources = sources();
    let constant = |text: &str, name: &str| {
        let (_, value) = text.split_once(&format!("const {name}: &str = \""))?;
        Some(value.split('"').next()?.to_owned())
    };
    let (mut found, mut unknown) = (BTreeSet::new(), BTreeSet::new());
    for (path, text) in &sources {
        for severity in ["error", "fault", "warning", "note"] {
            for call in text.split(&format!("Issue::{severity}(")).skip(1) {
                let first = call.split(',').next().unwrap_or_default().trim();
                if let Some(literal) = first.strip_prefix('"') {
                    found.insert(literal.trim_end_matches('"').to_owned());
                    continue;
                }
                let name = first.rsplit("::").next().unwrap_or_default();
                let is_near = |other: &Path| room(other) == room(path);
                let near = || {
                    sources
                        .iter()
                        .filter(|(other, _)| is_near(other))
                        .find_map(|(_, t)| constant(t, name))
                };
                let anywhere = || sources.values().find_map(|text| constant(text, name));
                match constant(text, name).or_else(near).or_else(anywhere) {
                    Some(code) => found.insert(code),
                    None => unknown.insert(format!("{}: {first}", relative(path))),
                };
            }
        }
    }
    (found, unknown)
}

fn relative(path: &Path) -> String {
    path.strip_prefix(house()).unwrap().display().to_string()
}

/// `crates/fit`, `src/pipeline`.
fn room(path: &Path) -> PathBuf {
    path.strip_prefix(house()).unwrap().components().take(2).collect()
}

/// Where the code is a variable or what a function gives: file, argument, and where the part begins and ends in which
/// every word in quotes with a hyphen is a code.
pub const GIVEN: [(&str, &str, &str, &str); 4] = [
    (
        "crates/ingest/src/formats/error.rs",
        "self.code()",
        "pub fn code(",
        "\n    }\n",
    ),
    (
        "crates/analysis/src/climate/checks.rs",
        "code",
        "let (possible, code, unit)",
        "};",
    ),
    (
        "crates/fit/src/outcome/issues.rs",
        "code",
        "let (code, what)",
        "};",
    ),
    (
        "src/pipeline/upkeep/agreement.rs",
        "code",
        "let agreed =",
        "\n}\n",
    ),
];

/// How a test may name a code: itself, the constant that holds it, or the error that has it.
pub fn spelled(code: &str) -> Vec<String> {
    let mut names = vec![format!("\"{code}\"")];
    for text in sources().values() {
        for (before, _) in text
            .match_indices(&format!("\"{code}\""))
            .map(|(at, _)| text.split_at(at))
        {
            let line = before.lines().last().unwrap_or_default();
            let constant = line
                .split_once("const ")
                .and_then(|(_, rest)| rest.split_once(": &str = "));
            names.extend(constant.map(|(name, _)| name.to_owned()));
            let variants = line.split("ReadError::").skip(1);
            let name = |variant: &str| variant.split(' ').next().map(str::to_owned);
            names.extend(variants.filter_map(name));
        }
    }
    names
}
