//! The house rules that can be checked and that the compiler does not hold: which crate may use which, behind which door a
//! library of others stands, and that every file says what it is.

use std::path::{Path, PathBuf};

use super::imports::{Imports, Module};

/// What each crate of the house may use beside itself. Its Cargo.toml is what the compiler holds it to; this is what
/// ARCHITECTURE.md promises of it.
const MAY_USE: [(&str, &[&str]); 13] = [
    ("domain", &[]),
    ("system", &[]),
    ("numerics", &["domain"]),
    ("model", &["domain", "numerics"]),
    ("truth", &["domain", "numerics"]),
    ("fit", &["domain", "numerics", "model"]),
    ("diagnose", &["domain", "numerics", "model", "fit"]),
    ("store", &["domain", "migrations", "system"]),
    ("strip", &["domain", "numerics"]),
    ("ingest", &["domain", "numerics", "strip", "system"]),
    ("show", &["domain"]),
    ("analysis", &["domain", "numerics", "show"]),
    ("report", &["domain", "show", "analysis", "system", "templates"]),
];

pub fn rust_files(folder: &Path) -> Vec<PathBuf> {
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

fn house() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Sources of the program: of its crates, and of the package at the top.
fn all_sources() -> Vec<PathBuf> {
    let crates = MAY_USE
        .iter()
        .map(|(name, _)| house().join("crates").join(name).join("src"));
    crates
        .chain([house().join("src")])
        .flat_map(|folder| rust_files(&folder))
        .collect()
}

#[test]
fn crates_use_only_what_they_may() {
    let mut found: Vec<String> = std::fs::read_dir(house().join("crates"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    found.sort();
    let mut listed: Vec<&str> = MAY_USE.iter().map(|(name, _)| *name).collect();
    listed.sort_unstable();
    assert_eq!(found, listed, "crates of the folder, and of the table here");
    for (name, may) in MAY_USE {
        let path = house().join("crates").join(name).join("Cargo.toml");
        let manifest: toml::Table = std::fs::read_to_string(&path).unwrap().parse().unwrap();
        let used = manifest["dependencies"].as_table().unwrap().keys();
        let offences: Vec<&str> = used
            .filter_map(|key| key.strip_prefix("ieap-"))
            .filter(|other| !may.contains(other))
            .collect();
        assert!(offences.is_empty(), "{name} uses {offences:?}");
    }
}

/// Imports of a crate, or of the package at the top, which is `src`.
fn imports_of(name: &str) -> Imports {
    let folder = match name {
        "src" => house().join(name),
        name => house().join("crates").join(name).join("src"),
    };
    Imports::of_folder(&folder)
}

/// Two files that need each other can be read as one; of more nobody finds the beginning.
#[test]
fn no_more_than_two_files_import_each_other() {
    let names = MAY_USE.iter().map(|(name, _)| *name).chain(["src"]);
    let mut read = 0;
    let mut circles: Vec<(&str, Vec<String>)> = Vec::new();
    for name in names {
        let imports = imports_of(name);
        read += imports.of.len();
        let long = imports.circles().into_iter().filter(|circle| circle.len() > 2);
        let names = |circle: Vec<Module>| circle.iter().map(|module| module.join("::")).collect();
        circles.extend(long.map(|circle| (name, names(circle))));
    }
    assert!(read > 1000, "{read} files were read");
    assert!(circles.is_empty(), "files import each other: {circles:#?}");
}

/// Folders in the order in which data go through them: each uses those before it.
const STAGES: [(&str, &[&str], &[&str]); 2] = [
    (
        "diagnose",
        &[],
        &[
            "readings", "fitting", "misfit", "cause", "missing", "extended", "outcome",
        ],
    ),
    (
        "src",
        &["pipeline"],
        &[
            "infra",
            "campaign",
            "intake",
            "fits",
            "findings",
            "documents",
            "standalone",
            "show",
            "upkeep",
            "run",
            "watch",
        ],
    ),
];

#[test]
fn the_stages_follow_each_other() {
    for (name, within, stages) in STAGES {
        let imports = imports_of(name);
        let within: Module = within.iter().map(|&part| part.to_owned()).collect();
        let stage = |module: &Module| {
            let own = module.strip_prefix(within.as_slice())?.first()?;
            stages.iter().position(|stage| stage == own)
        };
        let mut arrows = 0;
        for (module, others) in &imports.of {
            for other in others {
                let (Some(from), Some(to)) = (stage(module), stage(other)) else {
                    continue;
                };
                arrows += usize::from(from != to);
                assert!(to <= from, "{} uses {}", module.join("::"), other.join("::"));
            }
        }
        assert!(arrows > 50, "{name}: {arrows} arrows between stages were seen");
    }
}

#[test]
fn the_command_line_calculates_nothing() {
    for file in rust_files(&house().join("src/cli")) {
        let text = std::fs::read_to_string(&file).unwrap();
        for other in ["numerics", "fit", "diagnose", "store", "analysis", "report"] {
            let uses =
                text.contains(&format!("crate::{other}::")) || text.contains(&format!("ieap_{other}::"));
            assert!(!uses, "{} uses {other}", file.display());
        }
    }
}

#[test]
fn crates_stay_behind_their_doors() {
    let doors = [
        ("rusqlite", "crates/store"),
        ("polars", "crates/analysis"),
        // An independent writer of what the reader is tried with.
        ("polars", "crates/ingest/src/formats/parquet/tests.rs"),
        // The words of Arrow's schema, which polars-arrow-format has for all of its family.
        ("polars", "crates/ingest/src/formats/parquet/arrow_schema.rs"),
        ("parquet", "crates/ingest/src/formats/parquet"),
        ("parquet", "crates/ingest/src/parquet_rows.rs"),
        ("tera", "crates/report"),
        ("plotters", "crates/report"),
        ("notify", "crates/ingest"),
        ("clap", "src/cli"),
        ("png", "crates/strip"),
        ("png", "crates/report/src/figures/cells.rs"),
        ("base64", "crates/report"),
        ("base64", "crates/ingest/src/formats/parquet/arrow_schema.rs"),
        ("zune_jpeg", "crates/strip"),
        ("tiff", "crates/strip"),
    ];
    for file in all_sources() {
        let text = std::fs::read_to_string(&file).unwrap();
        for (name, _) in doors {
            let uses = text.lines().any(|line| {
                line.starts_with(&format!("use {name}::")) || line.starts_with(&format!("use {name}_"))
            });
            let may = doors
                .iter()
                .any(|(other, place)| *other == name && file.starts_with(house().join(place)));
            assert!(!uses || may, "{} uses {name}", file.display());
        }
    }
}

/// What a file does apart from its tests.
fn without_tests(text: &str) -> &str {
    text.split("#[cfg(test)]").next().unwrap_or_default()
}

/// What a stranger packed is opened where it is counted, and nowhere else.
#[test]
fn a_container_is_opened_through_one_door() {
    let doors: [(&str, &[&str]); 12] = [
        ("calamine", &["formats/sheet_cells.rs"]),
        (
            "zip",
            &["formats/workbook_parts.rs", "src/pipeline/show/research_crate.rs"],
        ),
        // What is written packed is our own.
        (
            "flate2",
            &[
                "formats/unpacking.rs",
                "print_figures/pdf.rs",
                "report/src/readings_file.rs",
            ],
        ),
        ("SerializedFileReader", &["formats/parquet/mod.rs"]),
        ("png::Decoder", &["strip/src/decode.rs"]),
        ("tiff", &["strip/src/decode.rs"]),
        ("zune_jpeg", &["strip/src/decode.rs"]),
        ("zstd", &["crates/store/src"]),
        ("quick_xml", &[]),
        ("cfb", &[]),
        ("lz4", &[]),
        ("snap", &[]),
    ];
    let is_of_tests = |file: &Path| {
        let name = file.to_string_lossy();
        name.ends_with("tests.rs") || name.ends_with("sheet_writer.rs")
    };
    for file in all_sources().into_iter().filter(|file| !is_of_tests(file)) {
        let text = std::fs::read_to_string(&file).unwrap();
        for (library, places) in doors {
            let is_word = |before: &str| !before.ends_with(|c: char| c.is_alphanumeric() || c == '_');
            let call = format!("{library}::");
            let mut uses = without_tests(&text).match_indices(&call);
            let uses = uses.any(|(at, _)| is_word(&text[..at]));
            let may = places.iter().any(|place| file.to_string_lossy().contains(place));
            assert!(!uses || may, "{} opens by {library}", file.display());
        }
    }
}

#[test]
fn results_and_files_go_through_one_door_each() {
    // Past them a result is lost without a word, or half a file is left.
    let doors: [(&str, &[&str]); 5] = [
        ("io::stdout()", &["src/cli/output.rs", "src/cli/mod.rs"]),
        ("println!", &[]),
        ("print!(", &[]),
        // The report and traced frames lie in folders that are exchanged whole.
        (
            "fs::write(",
            &[
                "src/pipeline/infra/own_folder.rs",
                "src/pipeline/show/report.rs",
                "src/pipeline/intake/trace",
                "crates/report/src/page_writer.rs",
            ],
        ),
        (" File::create(", &["crates/analysis/src/disk_file.rs"]),
    ];
    for folder in [
        "crates/analysis/src",
        "src/cli",
        "src/pipeline",
        "crates/report/src",
    ] {
        for file in rust_files(&house().join(folder)) {
            if file.ends_with("tests.rs") || file.to_string_lossy().contains("_tests") {
                continue;
            }
            let text = std::fs::read_to_string(&file).unwrap();
            let code = without_tests(&text)
                .lines()
                .filter(|line| !line.trim_start().starts_with("//"));
            for line in code {
                for (what, places) in doors {
                    let may = places.iter().any(|place| file.starts_with(house().join(place)));
                    assert!(may || !line.contains(what), "{}: {line}", file.display());
                }
            }
        }
    }
}

/// Whether a line has a placeholder with a precision or an exponent: `{:.3e}`, `{x:>7.2}`, `{:.*}`, `{:e}`.
fn formats_a_number(line: &str) -> bool {
    let is_word = |text: &str| text.chars().all(|c| c.is_alphanumeric() || c == '_');
    // No number has more digits than that; `{opacity:.75}` is of a style sheet.
    let is_count = |text: &str| text.parse().is_ok_and(|count: usize| count < 20);
    let is_precision =
        |text: &str| text == "*" || is_count(text) || text.strip_suffix('$').is_some_and(is_word);
    line.split('{').skip(1).any(|after| {
        let inner = after.split('}').next().unwrap_or_default();
        let Some((_, layout)) = inner.split_once(':').filter(|(name, _)| is_word(name)) else {
            return false;
        };
        let plain = layout.trim_end_matches('?').trim_end_matches('e');
        match plain.split_once('.') {
            Some((_, precision)) => is_precision(precision),
            None => layout.ends_with('e') && plain.chars().all(|c| "<>^+".contains(c) || c.is_ascii_digit()),
        }
    })
}

/// A number that is rounded by one rule in a table and by another in a sentence reads as two numbers.
#[test]
fn numbers_are_written_by_one_module() {
    for seen in [
        "{:.3e}",
        "{x:>7.2}",
        "a {:.*} b",
        "{:+.1}",
        "{value:.digits$}",
        "{:e}",
        "{:.4?}",
    ] {
        assert!(formats_a_number(seen), "{seen}");
    }
    for passed in ["{:>7}", "{x}", "{:?}", "small{opacity:.75}", "use a::{some::e}"] {
        assert!(!formats_a_number(passed), "{passed}");
    }
    let may = ["crates/domain/src/number", "crates/domain/src/number.rs"];
    for file in all_sources() {
        let of_tests =
            file.to_string_lossy().contains("/tests/") || file.to_string_lossy().ends_with("tests.rs");
        let mut passed = may.iter();
        if of_tests || passed.any(|place| file.starts_with(house().join(place))) {
            continue;
        }
        let text = std::fs::read_to_string(&file).unwrap();
        let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
        for line in code.lines().filter(|line| !line.trim_start().starts_with("//")) {
            assert!(
                !formats_a_number(line),
                "{}: use ieap_domain::number: {line}",
                file.display()
            );
        }
    }
}

/// Past it the worlds of `tests/it/world` do not see what the program does.
#[test]
fn what_is_kept_of_a_campaign_goes_through_one_seam() {
    // They read what lies outside of campaigns, or write what no campaign is made of yet.
    let beside = [
        "standalone/init",
        "standalone/simulate",
        "serve",
        "infra/command.rs",
    ];
    let pipeline = house().join("src/pipeline");
    let folders = [
        house().join("crates/store/src"),
        house().join("crates/ingest/src"),
        pipeline.clone(),
    ];
    for file in folders.iter().flat_map(|folder| rust_files(folder)) {
        let is_beside = beside.iter().any(|name| file.starts_with(pipeline.join(name)));
        if is_beside || file.ends_with("tests.rs") || file.to_string_lossy().contains("_tests") {
            continue;
        }
        let text = std::fs::read_to_string(&file).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        let code = code.split("#[cfg(all(test").next().unwrap_or_default();
        let is_code = |line: &&str| !line.trim_start().starts_with("//");
        for line in code.lines().filter(is_code) {
            let other = line.replace("std::os::unix::fs", "");
            let past = [
                "std::fs",
                "File::create(",
                "tempfile_in",
                "SystemTime::now",
                "Timestamp::now",
            ];
            assert!(
                !past.iter().any(|past| other.contains(past)),
                "{}: {line}",
                file.display()
            );
        }
    }
}

/// Past these a pipe in the place of a file is waited for for ever, and a link leads to a file of somebody else.
#[test]
fn what_a_campaign_consists_of_is_opened_only_where_a_regular_file_is() {
    // They read what a user names, or write where a user says: there a pipe or a device may be meant.
    let named_by_a_user = [
        "standalone/in_memory/read.rs",
        "standalone/forward/drive_file.rs",
        "upkeep/import_fits/rows.rs",
        "standalone/inspect.rs",
        "standalone/profile.rs",
        "show/research_crate.rs",
        "infra/whole_file.rs",
        // Its own temporary file.
        "show/export.rs",
    ];
    // They open folders, to bring names to the disk.
    let of_folders = ["own_folder.rs", "backup/restore.rs", "archive/durability.rs"];
    let pipeline = house().join("src/pipeline");
    let folders = [
        house().join("crates/store/src"),
        house().join("crates/ingest/src"),
        house().join("crates/report/src"),
        pipeline.clone(),
    ];
    let beside = [
        "standalone/init",
        "standalone/simulate",
        "serve",
        "infra/command.rs",
    ];
    for file in folders.iter().flat_map(|folder| rust_files(folder)) {
        let is_beside = beside.iter().any(|name| file.starts_with(pipeline.join(name)));
        if is_beside || file.ends_with("tests.rs") || file.to_string_lossy().contains("_tests") {
            continue;
        }
        let may_be_named = named_by_a_user.iter().any(|name| file == pipeline.join(name));
        let is_of_folders = of_folders.iter().any(|name| file.ends_with(name));
        let text = std::fs::read_to_string(&file).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        let code = code.split("#[cfg(all(test").next().unwrap_or_default();
        for line in code.lines().filter(|line| !line.trim_start().starts_with("//")) {
            let anything = ["fs::read(", "fs::read_text(", "OpenOptions::new("];
            let past = !may_be_named && anything.iter().any(|past| line.contains(past))
                || !is_of_folders && line.contains("File::open(");
            assert!(!past, "{}: {line}", file.display());
        }
    }
}

#[test]
fn every_file_begins_with_what_it_is() {
    let tests = rust_files(&house().join("tests"));
    for file in all_sources().into_iter().chain(tests) {
        let text = std::fs::read_to_string(&file).unwrap();
        assert!(text.starts_with("//!"), "{} has no //! line", file.display());
    }
}

/// Runs are read from the database as they are by those only that make no results of them: the place that decides which of
/// them speak, and what tags and stores runs.
#[test]
fn results_are_made_from_runs_that_speak() {
    let may = [
        "campaign/standing.rs",
        "upkeep/tag.rs",
        "intake/ingest/retag.rs",
        // Exposure is what a strip went through, whatever became of the run.
        "intake/climate/assess.rs",
        // Whether readings are as they were is asked of every run.
        "upkeep/verify/deep.rs",
    ];
    let pipeline = house().join("src/pipeline");
    for file in rust_files(&pipeline) {
        let text = std::fs::read_to_string(&file).unwrap();
        let reads = text.contains("store.runs()") || text.contains("store.runs_earlier(");
        let may = may.iter().any(|name| file == pipeline.join(name));
        assert!(!reads || may, "{} reads runs that may not speak", file.display());
    }
}

/// Its folder is a workspace of its own, and profiles hold for one workspace.
#[test]
fn the_python_package_is_built_as_the_program_is() {
    let manifest = |path: &str| std::fs::read_to_string(house().join(path)).unwrap();
    let profiles = |text: &str| text[text.find("# The release profile").unwrap()..].to_owned();
    let (own, python) = (manifest("Cargo.toml"), manifest("python/Cargo.toml"));
    assert_eq!(
        profiles(&python),
        profiles(&own),
        "copy the profiles of Cargo.toml"
    );
    let version = concat!("version = \"", env!("CARGO_PKG_VERSION"), "\"");
    assert!(python.contains(version), "python/Cargo.toml has another version");
}

/// What the workspace says that packages leave out holds of each crate.
#[test]
fn packages_carry_no_tests() {
    for (name, _) in MAY_USE {
        let path = house().join("crates").join(name).join("Cargo.toml");
        let manifest: toml::Table = std::fs::read_to_string(&path).unwrap().parse().unwrap();
        let excluded = manifest["package"]
            .get("exclude")
            .and_then(|own| own.get("workspace"));
        assert_eq!(
            excluded,
            Some(&toml::Value::Boolean(true)),
            "{name}: `exclude.workspace = true`"
        );
    }
}

/// The wheel is built with --locked: what a crate begins to need has to be in both lists of versions.
#[test]
fn the_python_package_locks_what_the_crates_need() {
    let lock = std::fs::read_to_string(house().join("python/Cargo.lock")).unwrap();
    let mut needed = 0;
    for (name, _) in MAY_USE {
        let manifest = std::fs::read_to_string(house().join(format!("crates/{name}/Cargo.toml"))).unwrap();
        let section = manifest.split("[dependencies]\n").nth(1).unwrap_or_default();
        let own = section.split("\n[").next().unwrap_or_default().lines();
        let locked = lock
            .split("[[package]]\n")
            .find(|package| package.starts_with(&format!("name = \"ieap-{name}\"\n")))
            .unwrap_or_else(|| panic!("ieap-{name} is not in python/Cargo.lock"));
        for line in own.filter(|line| !line.starts_with(['#', ' ']) && line.contains('=')) {
            let need = line.split(['.', ' ', '=']).next().unwrap_or_default();
            needed += 1;
            assert!(
                locked.contains(&format!("\"{need}\"")) || locked.contains(&format!("\"{need} ")),
                "ieap-{name} needs {need}: run `cargo metadata --manifest-path python/Cargo.toml`"
            );
        }
    }
    assert!(needed > 40, "{needed}");
}
