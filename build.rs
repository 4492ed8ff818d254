//! Says which commit the program is built from: a build of a version is not every build of it.

use std::path::Path;
use std::process::Command;

/// What is compiled into the program.
const COMPILED: [&str; 8] = [
    "Cargo.lock",
    "Cargo.toml",
    "build.rs",
    "crates",
    "migrations",
    "schemas",
    "src",
    "templates",
];

fn main() {
    let house = std::env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
    let house = Path::new(&house);
    // Where a path is not there cargo would run this every time.
    let mut read: Vec<_> = COMPILED.map(|name| house.join(name)).into();
    let commit = if house.join(".git").exists() {
        // Each commit, and each going to another, is a line of this file.
        read.extend(git(house, &["rev-parse", "--git-path", "logs/HEAD"]).map(|path| house.join(path)));
        of_tree(house)
    } else {
        of_package(house)
    };
    for path in read.iter().filter(|path| path.exists()) {
        println!("cargo::rerun-if-changed={}", path.display());
    }
    let commit = commit.unwrap_or_else(|| "unknown".to_owned());
    println!("cargo::rustc-env=IEAP_BUILT_FROM={commit}");
}

/// The commit of a tree under git, and whether what is compiled is as it is there.
fn of_tree(house: &Path) -> Option<String> {
    let commit = git(house, &["rev-parse", "--short=12", "HEAD"])?;
    let changed = git(house, &[&["status", "--porcelain", "--"], &COMPILED[..]].concat())?;
    Some(if changed.is_empty() {
        commit
    } else {
        format!("{commit}+modified")
    })
}

/// The commit that `cargo package` packed.
fn of_package(house: &Path) -> Option<String> {
    let told = std::fs::read_to_string(house.join(".cargo_vcs_info.json")).ok()?;
    let commit = told
        .split("\"sha1\":")
        .nth(1)?
        .split('"')
        .nth(1)?
        .get(..12)?
        .to_owned();
    Some(
        if told.contains("\"dirty\":true") || told.contains("\"dirty\": true") {
            format!("{commit}+modified")
        } else {
            commit
        },
    )
}

fn git(house: &Path, arguments: &[&str]) -> Option<String> {
    let ended = Command::new("git")
        .current_dir(house)
        .args(arguments)
        .output()
        .ok()?;
    let said = String::from_utf8(ended.stdout).ok()?;
    ended.status.success().then(|| said.trim().to_owned())
}
