//! What `cargo package` packs builds in an empty folder: no file of a package puts one of another folder into the program. And a
//! program says what it is built from.

use std::path::{Component, Path, PathBuf};

use super::architecture::rust_files;

/// Folders of the packages of the workspace.
fn packages() -> Vec<PathBuf> {
    let house = Path::new(env!("CARGO_MANIFEST_DIR"));
    let crates = std::fs::read_dir(house.join("crates")).unwrap();
    let crates = crates.map(|entry| entry.unwrap().path());
    let top = ["src", "migrations", "templates"].map(|name| house.join(name));
    crates.chain(top).collect()
}

/// Packed are no tests (`[workspace.package] exclude`).
fn is_packed(file: &Path, package: &Path) -> bool {
    let inside = file.strip_prefix(package).unwrap();
    let name = inside.to_str().unwrap();
    let folders = ["examples", "tests"];
    let is_left_out = |part: Component<'_>| folders.iter().any(|folder| part.as_os_str() == *folder);
    !inside.components().any(is_left_out) && !name.ends_with("tests.rs")
}

/// How many folders up a path leads from the one that it begins in.
fn steps_up(path: &str) -> usize {
    Path::new(path)
        .components()
        .filter(|part| matches!(part, Component::ParentDir))
        .count()
}

#[test]
fn no_package_embeds_a_file_of_another_folder() {
    let mut embedded = 0;
    for package in packages() {
        // `src` of the top package is a folder in it.
        let above = usize::from(package.ends_with("src"));
        for file in rust_files(&package) {
            if !is_packed(&file, &package) {
                continue;
            }
            let text = std::fs::read_to_string(&file).unwrap();
            let depth = file.strip_prefix(&package).unwrap().components().count() - 1 + above;
            for call in ["include_str!(", "include_bytes!(", "include!(", "include_dir!("] {
                for (at, _) in text.match_indices(call) {
                    let path = text[at..].split('"').nth(1).unwrap();
                    embedded += 1;
                    assert!(steps_up(path) <= depth, "{} embeds {path}", file.display());
                }
            }
        }
    }
    assert!(embedded > 30, "{embedded} embedded files were seen");
}

#[test]
fn the_program_says_which_commit_it_is_built_from() {
    let said = |option: &str| {
        let ended = std::process::Command::new(env!("CARGO_BIN_EXE_ieap"))
            .arg(option)
            .output()
            .unwrap();
        String::from_utf8(ended.stdout).unwrap()
    };
    assert_eq!(said("-V").lines().count(), 1);
    let long = said("--version");
    let commit = long.trim_end().rsplit_once("\nbuilt from ").unwrap().1;
    let commit = commit.strip_suffix("+modified").unwrap_or(commit);
    let is_hash = commit.len() == 12 && commit.chars().all(|digit| digit.is_ascii_hexdigit());
    assert!(is_hash || commit == "unknown", "{long}");
}
