//! The house rules that can be checked: which module may use which, and that every file says what it is.

use std::path::{Path, PathBuf};

/// What each module may use beside itself. `fit` stands for identification, `cli` for the command line.
const MAY_USE: [(&str, &[&str]); 12] = [
    ("domain", &[]),
    ("numerics", &["domain"]),
    ("model", &["domain", "numerics"]),
    ("fit", &["domain", "numerics", "model"]),
    ("diagnose", &["domain", "numerics", "model", "fit"]),
    ("store", &["domain"]),
    ("strip", &["numerics"]),
    ("ingest", &["domain", "store", "strip"]),
    ("analysis", &["domain", "numerics", "store"]),
    ("report", &["domain", "analysis", "store"]),
    (
        "pipeline",
        &[
            "domain", "numerics", "model", "fit", "diagnose", "store", "strip", "ingest", "analysis",
            "report",
        ],
    ),
    ("cli", &["domain", "pipeline", "model", "ingest", "strip"]),
];

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.sort();
    files
}

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// The module named after each `crate::` in a text, comments left out.
fn used(text: &str) -> Vec<String> {
    let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
    let code: String = code.collect::<Vec<_>>().join("\n");
    code.split("crate::")
        .skip(1)
        .map(|rest| {
            rest.chars()
                .take_while(|c| c.is_alphanumeric() || *c == '_')
                .collect()
        })
        .collect()
}

#[test]
fn modules_use_only_what_they_may() {
    let mut offences = Vec::new();
    for (module, may) in MAY_USE {
        for file in rust_files(&source().join(module)) {
            for other in used(&std::fs::read_to_string(&file).unwrap()) {
                if other != module && !other.is_empty() && !may.contains(&other.as_str()) {
                    offences.push(format!("{} uses {other}", file.display()));
                }
            }
        }
    }
    assert!(offences.is_empty(), "{offences:#?}");
}

#[test]
fn every_module_is_in_the_table() {
    for entry in std::fs::read_dir(source()).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let listed = MAY_USE.iter().any(|(module, _)| *module == name);
        assert!(listed || ["lib", "main"].contains(&name.as_str()), "{name}");
    }
}

#[test]
fn crates_stay_behind_their_doors() {
    let doors = [
        ("rusqlite", "store"),
        ("polars", "analysis"),
        // An independent writer of what the reader is tried with.
        ("polars", "ingest/formats/parquet/tests.rs"),
        ("parquet", "ingest/formats/parquet"),
        ("tera", "report"),
        ("plotters", "report"),
        ("notify", "ingest"),
        ("clap", "cli"),
        ("png", "strip"),
        ("png", "report/figures/cells.rs"),
        ("base64", "report"),
        ("zune_jpeg", "strip"),
        ("tiff", "strip"),
    ];
    for file in rust_files(&source()) {
        let text = std::fs::read_to_string(&file).unwrap();
        for (name, _) in doors {
            let uses = text.lines().any(|line| {
                line.starts_with(&format!("use {name}::")) || line.starts_with(&format!("use {name}_"))
            });
            let may = doors
                .iter()
                .any(|(other, place)| *other == name && file.starts_with(source().join(place)));
            assert!(!uses || may, "{} uses {name}", file.display());
        }
    }
}

/// What a file does apart from its tests.
fn without_tests(text: &str) -> &str {
    text.split("#[cfg(test)]").next().unwrap_or_default()
}

#[test]
fn results_and_files_go_through_one_door_each() {
    // Past them a result is lost without a word, or half a file is left.
    let doors: [(&str, &[&str]); 5] = [
        ("io::stdout()", &["cli/output.rs", "cli/mod.rs"]),
        ("println!", &[]),
        ("print!(", &[]),
        // The report and traced frames lie in folders that are exchanged whole.
        (
            "fs::write(",
            &[
                "pipeline/own_folder.rs",
                "pipeline/report.rs",
                "pipeline/trace",
                "report/render.rs",
            ],
        ),
        (" File::create(", &["analysis/disk_file.rs"]),
    ];
    for module in ["analysis", "cli", "pipeline", "report"] {
        for file in rust_files(&source().join(module)) {
            if file.ends_with("tests.rs") || file.to_string_lossy().contains("_tests") {
                continue;
            }
            let text = std::fs::read_to_string(&file).unwrap();
            let code = without_tests(&text)
                .lines()
                .filter(|line| !line.trim_start().starts_with("//"));
            for line in code {
                for (what, places) in doors {
                    let may = places.iter().any(|place| file.starts_with(source().join(place)));
                    assert!(may || !line.contains(what), "{}: {line}", file.display());
                }
            }
        }
    }
}

#[test]
fn every_file_begins_with_what_it_is() {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    for file in rust_files(&source()).into_iter().chain(rust_files(&tests)) {
        let text = std::fs::read_to_string(&file).unwrap();
        assert!(text.starts_with("//!"), "{} has no //! line", file.display());
    }
}

/// Runs are read from the database as they are by those only that make no results of them: the place that decides which of
/// them speak, and what tags and stores runs.
#[test]
fn results_are_made_from_runs_that_speak() {
    let may = [
        "standing.rs",
        "tag.rs",
        "ingest/retag.rs",
        // Exposure is what a strip went through, whatever became of the run.
        "climate/assess.rs",
    ];
    let pipeline = source().join("pipeline");
    for file in rust_files(&pipeline) {
        let text = std::fs::read_to_string(&file).unwrap();
        let reads = text.contains("store.runs()") || text.contains("store.runs_earlier(");
        let may = may.iter().any(|name| file == pipeline.join(name));
        assert!(!reads || may, "{} reads runs that may not speak", file.display());
    }
}
