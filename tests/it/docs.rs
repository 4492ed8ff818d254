//! Every command and every file printed in README.md and docs/ works as it stands there. `IEAP_LONG=1` also runs what takes
//! long; without it those are held against the command line alone.

use std::path::{Path, PathBuf};

use crate::book::pages_in;
use crate::campaign::{CampaignFolder, Ended, counted, ieap, run_table};
use crate::frames::png_bytes;
use crate::rendered::Scene;

/// What is in commands that are not run to their end, with the reason; whether a long test runs them.
const HELD_BACK: [(&str, &str, bool); 15] = [
    (
        "ieap watch",
        "runs until it is stopped; tests/it/watch.rs starts it",
        false,
    ),
    (
        "ieap serve",
        "runs until it is stopped; tests/it/serve.rs starts it",
        false,
    ),
    (
        "curvature-map",
        "needs runs along a strip; tests/it/along.rs draws it",
        false,
    ),
    (
        "--rh 45",
        "needs a law across runs; tests/it/brought.rs has one",
        false,
    ),
    (
        "figure laws",
        "needs a law across runs; tests/it/hidden_across.rs draws it",
        false,
    ),
    (
        "explain cycles",
        "needs a run of many cycles; the unit tests of cycles have them",
        false,
    ),
    ("explain model-free", "names a run of the reader's own", false),
    ("explain energy", "names a run of the reader's own", false),
    (
        "figure frequency",
        "needs runs under a sine; tests/it/moving_voltage.rs draws it",
        false,
    ),
    (
        "--what crate",
        "needs a licence and an author; tests/it/published.rs states them",
        false,
    ),
    (
        "--install",
        "writes into the home folder; tests/it/terminal.rs gives it another",
        false,
    ),
    ("ieap diagnose", "searches for minutes", true),
    ("ieap run campaigns/", "fits and searches for minutes", true),
    ("--bootstrap", "fits some hundred times", true),
    ("--profile", "fits some hundred times", true),
];
/// Words in capitals that stand for something: `ieap inspect FILE` is a pattern and no command.
fn is_pattern(word: &str) -> bool {
    let word = word.split('=').next_back().unwrap_or_default();
    word.len() > 1
        && word.chars().all(|c| c.is_ascii_uppercase() || c == '.')
        && word.starts_with(char::is_alphabetic)
}

/// A piece of code on a page.
struct Block {
    language: String,
    text: String,
}

/// Blocks between fences, and those indented by four.
fn blocks(page: &str) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    let (mut fenced, mut indented) = (false, false);
    for line in page.lines() {
        match (line.strip_prefix("```"), line.strip_prefix("    ")) {
            (Some(language), _) => {
                fenced = !fenced;
                if fenced {
                    blocks.push(Block {
                        language: language.trim().to_owned(),
                        text: String::new(),
                    });
                }
                indented = false;
            }
            (None, _) if fenced => blocks.last_mut().unwrap().text += &format!("{line}\n"),
            (None, Some(code)) => {
                if !indented {
                    blocks.push(Block {
                        language: String::new(),
                        text: String::new(),
                    });
                }
                indented = true;
                blocks.last_mut().unwrap().text += &format!("{code}\n");
            }
            // An empty line does not end an indented block.
            (None, None) if indented && line.is_empty() => blocks.last_mut().unwrap().text += "\n",
            (None, None) => indented = false,
        }
    }
    blocks
}

/// Command lines of a page: in blocks, and between back-ticks in its text.
fn commands(page: &str, blocks: &[Block]) -> Vec<String> {
    let lines = blocks.iter().flat_map(|block| block.text.lines());
    let spans = page.lines().filter(|line| !line.starts_with("    "));
    let spans = spans.flat_map(|line| line.split('`').skip(1).step_by(2));
    let all = lines
        .chain(spans)
        .map(|line| line.trim().trim_start_matches("$ "));
    let mut found: Vec<String> = Vec::new();
    for line in all.filter(|line| line.starts_with("ieap ")) {
        // What follows a # is said of the command.
        let line = line.split(" #").next().unwrap_or_default();
        // What takes its output is another program.
        let line = line
            .split(['|', '>'])
            .next()
            .unwrap_or_default()
            .trim()
            .to_owned();
        if !found.contains(&line) && !words(&line).iter().any(|word| is_pattern(word)) {
            found.push(line);
        }
    }
    found
}

/// The words of a command line after the program's name, as a shell would part them.
fn words(line: &str) -> Vec<String> {
    let mut words = Vec::new();
    for (k, part) in line.split('"').enumerate() {
        match k % 2 {
            1 => words.push(part.to_owned()),
            _ => words.extend(part.split_whitespace().map(str::to_owned)),
        }
    }
    words.remove(0);
    words
}

/// Whether a block is a TOML file.
fn is_toml(block: &Block) -> bool {
    let is_table = block
        .text
        .parse::<toml::Table>()
        .is_ok_and(|table| !table.is_empty());
    block.language == "toml" || (block.language.is_empty() && is_table)
}

/// Whether a block is a table of readings or of planned runs: rows of numbers under a row of names.
fn is_table(block: &Block) -> bool {
    let fields = |line: &str| line.split([',', ';']).count();
    let lines: Vec<&str> = block.text.lines().collect();
    let numbers = |line: &str| {
        line.split([',', ';'])
            .filter(|field| field.trim().parse::<f64>().is_ok())
            .count()
    };
    let is_head = |pair: &[&str]| fields(pair[0]) > 2 && fields(pair[1]) >= fields(pair[0]);
    let is_row = |line: &&str| numbers(line) > 1 || line.starts_with("P0");
    lines.windows(2).any(is_head) && lines.last().is_some_and(is_row)
}

/// A folder to be in: a campaign that has been run, with `my-campaign/`, the campaigns of the repository, frames, a modulus
/// log and a table that no reader knows.
fn world() -> CampaignFolder {
    let folder = CampaignFolder::new();
    let repository = Path::new(env!("CARGO_MANIFEST_DIR"));
    for name in ["thesis", "strip"] {
        copy(
            &repository.join("campaigns").join(name),
            &folder.join(&format!("campaigns/{name}")),
        );
    }
    std::fs::remove_file(folder.join("runs/tags.toml")).unwrap();
    let thesis = folder.join("campaigns/thesis");
    for root in [folder.path().to_owned(), folder.join("my-campaign")] {
        std::fs::create_dir_all(root.join("runs")).unwrap();
        std::fs::create_dir_all(root.join("profiles")).unwrap();
        std::fs::copy(thesis.join("campaign.toml"), root.join("campaign.toml")).unwrap();
        copy(&thesis.join("runs/CNaf/air"), &root.join("runs/CNaf/air"));
        std::fs::write(root.join("runs/a.csv"), run_table(1)).unwrap();
        std::fs::create_dir_all(root.join("dma")).unwrap();
        for name in ["CNaf.csv", "CNaf.csv.toml"] {
            std::fs::copy(thesis.join("dma").join(name), root.join("dma").join(name)).unwrap();
        }
        ieap(&root, &["run", "--no-diagnose"]).expect(0);
    }
    for k in 0..3 {
        let frame = Scene::default().draw(200.0, |_| 4e-4 * f64::from(k));
        folder.write(&format!("frames/f{k:04}.png"), png_bytes(&frame));
    }
    folder.write(
        "runs/laser_0.csv",
        "sensor export\n\nEpoch time (ms);Distance1 (mm)\n1728937444032,000;12,50000\n1728937444033,000;12,51130\n",
    );
    folder
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let is_made = ["report", "archive"].contains(&name.as_str()) || name.starts_with("campaign.db");
        match path.is_dir() {
            _ if is_made => {}
            true => copy(&path, &to.join(name)),
            false => drop(std::fs::copy(&path, to.join(name)).unwrap()),
        }
    }
}

/// What a spec needs beside the runs that a page shows.
const SPEC_HEAD: &str = "[simulation]\nseed = 1\nfolder = \"runs\"\nstatement = [\"SIMULATED\"]\nbaseline_s = 1.0\n\
                         [noise]\ncurrent_a = 1e-6\ncurvature_per_cm = 2e-3\n";

/// Puts a TOML file of a page where it belongs, and has it read.
fn read_toml(folder: &CampaignFolder, page: &str, text: &str) {
    let has = |what: &str| text.lines().any(|line| line.trim_start().starts_with(what));
    let fine = |ended: Ended| {
        let said = ended.stderr.contains("campaign.toml");
        assert!(
            [0, 3].contains(&ended.status) && !said,
            "{page}:\n{text}\n{ended:#?}"
        );
    };
    if has("[simulation]") {
        return folder.write("my-campaign/simulation.toml", text);
    }
    if has("[[strip]]") || has("[[run]]") {
        let spec = format!("spec-{}", text.len());
        folder.write(&format!("{spec}/simulation.toml"), format!("{SPEC_HEAD}{text}"));
        return fine(folder.ieap(&["simulate", &format!("{spec}/simulation.toml")]));
    }
    if has("[profile]") {
        folder.write("profiles/example.toml", text);
        return fine(folder.ieap(&["status"]));
    }
    if has("px_per_mm") {
        folder.write("frames/frames.toml", text);
        return;
    }
    if !has("[") {
        // Statements about the files of a folder.
        folder.write("dma/tags.toml", text);
        return fine(folder.ieap(&["status"]));
    }
    let known = std::fs::read_to_string(folder.join("my-campaign/campaign.toml")).unwrap();
    let (first, others) = text.split_at(text.find("\n[").map_or(text.len(), |at| at + 1));
    let added = match first.strip_prefix("[campaign]\n") {
        Some(keys) => known.replacen("[campaign]\n", &format!("[campaign]\n{keys}"), 1) + "\n" + others,
        None => format!("{known}\n{text}"),
    };
    assert_ne!(added, known);
    folder.write("my-campaign/campaign.toml", added);
    fine(folder.ieap(&["status", "my-campaign"]));
    if !has("[[sample]]") {
        folder.write("my-campaign/campaign.toml", known);
    }
}

/// Puts a table of a page into a file and has it read.
fn read_table(folder: &CampaignFolder, page: &str, text: &str) {
    if text.starts_with("planned,") {
        folder.write("runs/page.run-sheet.csv", text);
        let ended = folder.ieap(&["status"]).expect(0);
        assert!(!ended.stdout.contains("cannot be used"), "{page}: {ended:#?}");
        return;
    }
    folder.write("runs/page.csv", text);
    let ended = folder.ieap(&["inspect", "runs/page.csv"]);
    assert_eq!(ended.status, 0, "{page}:\n{text}\n{ended:#?}");
    std::fs::remove_file(folder.join("runs/page.csv")).unwrap();
}

/// Runs a command line, or holds it against the command line where it is held back.
fn obey(folder: &CampaignFolder, page: &str, line: &str) {
    let mut words = words(line);
    let held = HELD_BACK.iter().find(|(what, ..)| line.contains(what));
    let is_long = counted(0, 1) == 1;
    if held.is_some_and(|&(.., in_long)| !(in_long && is_long)) {
        words.push("--help".to_owned());
    } else if words[0] == "run" && !is_long {
        words.push("--no-diagnose".to_owned());
    }
    if words[0] == "init" {
        words.resize(2, "made".to_owned());
        let _ = std::fs::remove_dir_all(folder.join(&words[1]));
    }
    let arguments: Vec<&str> = words.iter().map(String::as_str).collect();
    let ended = folder.ieap(&arguments);
    // The verb alone names it: `ieap tag`.
    let is_name = words.len() == 1 && ended.stderr.contains("required arguments");
    let documented = [0, 3, 5].contains(&ended.status);
    assert!(documented || is_name, "{page}: `{line}`: {ended:#?}");
    assert!(!ended.stderr.contains("panicked"), "{page}: `{line}`: {ended:#?}");
}

/// README.md and the pages of docs/, by their path.
fn pages() -> Vec<(String, String)> {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut paths = pages_in(&repository.join("docs"));
    paths.push(repository.join("README.md"));
    let named = |path: PathBuf| {
        let name = path.strip_prefix(repository).unwrap().display().to_string();
        (name, std::fs::read_to_string(&path).unwrap())
    };
    paths.into_iter().map(named).collect()
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn every_command_and_every_file_on_a_page_works() {
    let whole = world();
    let (mut ran, mut read) = (0, 0);
    let mut faults = Vec::new();
    // All faults of all pages are told at once.
    let mut tried = |what: &dyn Fn()| {
        if let Err(fault) = std::panic::catch_unwind(std::panic::AssertUnwindSafe(what)) {
            faults.push(fault.downcast_ref::<String>().cloned().unwrap_or_default());
        }
    };
    for (name, page) in pages() {
        let blocks = blocks(&page);
        let commands = commands(&page, &blocks);
        let is_file = |block: &Block| is_toml(block) || is_table(block);
        if commands.is_empty() && !blocks.iter().any(is_file) {
            continue;
        }
        let folder = CampaignFolder::new();
        copy_all(whole.path(), folder.path());
        for block in blocks.iter().filter(|block| is_toml(block)) {
            tried(&|| read_toml(&folder, &name, &block.text));
            read += 1;
        }
        for block in blocks.iter().filter(|block| !is_toml(block) && is_table(block)) {
            tried(&|| read_table(&folder, &name, &block.text));
            read += 1;
        }
        for line in commands {
            tried(&|| obey(&folder, &name, &line));
            ran += 1;
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n\n"));
    // The pages are read: a change of their form must not leave the test without commands.
    assert!(ran > 60 && read > 10, "{ran} commands, {read} files");
}

/// A folder with everything in it, databases too.
fn copy_all(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy_all(&path, &target)
        } else {
            std::fs::copy(&path, target).unwrap();
        }
    }
}
