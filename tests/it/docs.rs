//! Every command and every file printed in README.md and docs/ works as it stands there, and what each command says is a line of
//! a snapshot. Without `IEAP_LONG=1` `run` leaves its diagnosis out, and `diagnose` draws less.

use std::path::{Path, PathBuf};

use crate::book::pages_in;
use crate::campaign::{CampaignFolder, Ended, counted, ieap, run_table};
use crate::frames::png_bytes;
use crate::rendered::Scene;

/// Behind a command in a block: why it is not run here.
const NOT_TRIED: &str = "# not tried: ";

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

/// Command lines of a page: those in blocks, and in its text what stands between back-ticks with more than a verb. What is marked
/// as not tried comes with its reason.
fn commands(page: &str, blocks: &[Block]) -> Vec<(String, Option<String>)> {
    let lines = blocks.iter().flat_map(|block| block.text.lines());
    let lines = lines
        .map(|line| (line, false))
        .chain(spans(page).map(|line| (line, true)));
    let mut found: Vec<(String, Option<String>)> = Vec::new();
    for (line, is_span) in lines {
        let line = line.trim().trim_start_matches("$ ");
        if !line.starts_with("ieap ") {
            continue;
        }
        let reason = line.split_once(NOT_TRIED).map(|(_, reason)| reason.to_owned());
        // What follows a # is said of the command, and what takes its output is another program.
        let line = line.split(" #").next().unwrap_or_default();
        let line = line.split(['|', '>']).next().unwrap_or_default().trim();
        let words = words(line);
        if words.len() > 1 || !is_span {
            let is_known = found.iter().any(|(known, _)| known == line);
            if !is_known && !words.iter().any(|word| is_pattern(word)) {
                found.push((line.to_owned(), reason));
            }
        }
    }
    found
}

/// What stands between back-ticks in the text of a page.
fn spans(page: &str) -> impl Iterator<Item = &str> {
    let lines = page.lines().filter(|line| !line.starts_with("    "));
    lines.flat_map(|line| line.split('`').skip(1).step_by(2))
}

/// Verbs that a page names by themselves: `ieap status`.
fn names(page: &str) -> Vec<&str> {
    let named = spans(page).filter_map(|span| span.strip_prefix("ieap "));
    named
        .filter(|verb| !verb.contains(' ') && !is_pattern(verb))
        .collect()
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
        std::fs::create_dir_all(root.join("impedance")).unwrap();
        std::fs::write(root.join("impedance/eis.csv"), spectrum()).unwrap();
        let tags = "sample = \"CNaf-1\"\nenvironment = \"air\"\n";
        std::fs::write(root.join("impedance/eis.csv.toml"), tags).unwrap();
        ieap(&root, &["run", "--no-diagnose"]).expect(0);
    }
    // Files of an instrument that are no campaign yet.
    copy(&thesis.join("runs/CNaf/air"), &folder.join("my-files"));
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

/// A spectrum of a resistor before a resistor beside a capacitor, from 10 mHz to 10 kHz.
fn spectrum() -> String {
    let mut text = "frequency_hz,impedance_real_ohm,impedance_imaginary_ohm\n".to_owned();
    for k in 0..31 {
        let frequency_hz = 10f64.powf(4.0 - 0.2 * f64::from(k));
        let product = 2.0 * std::f64::consts::PI * frequency_hz * 0.5;
        let share = 100.0 / (1.0 + product * product);
        text += &format!("{frequency_hz},{},{}\n", 20.0 + share, -share * product);
    }
    text
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
    let mut added: toml::Table = known.parse().unwrap();
    let before = added.clone();
    lay_over(&mut added, text.parse().unwrap());
    assert_ne!(added, before, "{page}:\n{text}");
    folder.write("my-campaign/campaign.toml", added.to_string());
    fine(folder.ieap(&["status", "my-campaign"]));
    if !has("[[sample]]") {
        folder.write("my-campaign/campaign.toml", known);
    }
}

/// Lays what a page states over a campaign.toml: tables are joined, and lists of tables go on.
fn lay_over(known: &mut toml::Table, page: toml::Table) {
    for (key, value) in page {
        match (known.get_mut(&key), value) {
            (Some(toml::Value::Table(own)), toml::Value::Table(of_page)) => lay_over(own, of_page),
            (Some(toml::Value::Array(own)), toml::Value::Array(of_page)) => own.extend(of_page),
            (_, value) => drop(known.insert(key, value)),
        }
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

/// Runs a command line and gives what it said, shortened. What is not tried is held against the command line alone.
fn obey(folder: &CampaignFolder, page: &str, line: &str, reason: Option<&str>) -> String {
    let mut words = words(line);
    let is_long = counted(0, 1) == 1;
    match words[0].as_str() {
        _ if reason.is_some() => words.push("--help".to_owned()),
        "run" if words.contains(&"--only".to_owned()) => {}
        "run" if !is_long && !words.contains(&"--no-diagnose".to_owned()) => {
            words.push("--no-diagnose".to_owned());
        }
        "diagnose" if !is_long => words.extend(["--draws", "99"].map(str::to_owned)),
        "init" => {
            words.retain(|word| word != "my-campaign");
            words.insert(1, "made".to_owned());
            let _ = std::fs::remove_dir_all(folder.join("made"));
        }
        _ => {}
    }
    // How long work takes is no part of what a page says.
    if words[0] != "help" {
        words.push("--no-progress".to_owned());
    }
    let arguments: Vec<&str> = words.iter().map(String::as_str).collect();
    let ended = folder.ieap(&arguments);
    assert!([0, 3, 5].contains(&ended.status), "{page}: `{line}`: {ended:#?}");
    assert!(!ended.stderr.contains("panicked"), "{page}: `{line}`: {ended:#?}");
    let said = match reason {
        Some(reason) => format!("  not tried: {reason}\n"),
        None => outline(&ended, &folder.path().to_string_lossy()),
    };
    assert!(!said.is_empty(), "{page}: `{line}` says nothing: {ended:#?}");
    format!("$ {line}\n{said}")
}

/// The first lines that a command said, without its numbers: enough to see that it did what the page says.
fn outline(ended: &Ended, folder: &str) -> String {
    let mut said = String::new();
    for (stream, mark) in [(&ended.stdout, "  "), (&ended.stderr, "! ")] {
        let lines = stream.lines().filter(|line| !line.trim().is_empty());
        for line in lines.take(3) {
            // Parquet on stdout is no text.
            let is_text = line
                .chars()
                .all(|c| c == '\t' || !(c.is_control() || c == '\u{fffd}'));
            let line = line.replace(folder, "FOLDER");
            let line: String = line.chars().take(100).collect();
            if !is_text {
                said += &format!("{mark}(bytes)\n");
                break;
            }
            let words = line.split(' ').map(|word| {
                if is_hash(word) {
                    "HASH".to_owned()
                } else {
                    without_numbers(word)
                }
            });
            said += &format!("{mark}{}\n", words.collect::<Vec<_>>().join(" "));
        }
    }
    match ended.status {
        0 => said,
        status => format!("{said}= {status}\n"),
    }
}

/// Whether a word is a hash, which changes with the program; in brackets the beginning of one.
fn is_hash(word: &str) -> bool {
    let digits = word.chars().filter(char::is_ascii_hexdigit).count();
    let inner = word.trim_matches(['"', ',', '(', ')']);
    digits == inner.len() && (digits >= 16 || digits >= 8 && word.starts_with('('))
}

/// Runs of digits, and what stands in numbers, as one `#`.
fn without_numbers(line: &str) -> String {
    let mut text = String::new();
    for c in line.chars() {
        match (c.is_ascii_digit(), text.ends_with('#')) {
            (true, true) => {}
            (true, false) => text.push('#'),
            (false, true) if ".,-+:".contains(c) => {}
            (false, _) => text.push(c),
        }
    }
    text
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

/// Every verb that a list of the program shows, in its order.
fn listed_verbs() -> Vec<String> {
    let [help, rare] = [&["help"][..], &["list"]].map(|words| ieap(Path::new("."), words).expect(0).stdout);
    let (_, day) = help.split_once("day's work:\n").unwrap();
    let (day, _) = day.split_once("\n\n").unwrap();
    let (_, rare) = rare.split_once("rarely:\n").unwrap();
    let lines = day.lines().chain(rare.lines());
    lines
        .map(|line| line.split_whitespace().next().unwrap().to_owned())
        .collect()
}

/// A page of the examples with which the help of the verbs, and of the steps of `run`, begins.
fn examples(verbs: &[String]) -> String {
    let steps = ["ingest", "fit", "dma", "impedance", "report"].map(str::to_owned);
    let mut page = String::new();
    for verb in verbs.iter().chain(&steps) {
        let help = ieap(Path::new("."), &["help", verb]).expect(0).stdout;
        let example = help.lines().next().unwrap();
        assert!(example.starts_with("    ieap "), "{verb}: {help}");
        let reason = match verb.as_str() {
            "watch" | "serve" => format!("  {NOT_TRIED}goes on until it is stopped"),
            "import-fits" => format!("  {NOT_TRIED}takes the files of a cluster"),
            _ => String::new(),
        };
        page += &format!("{example}{reason}\n");
    }
    page
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn every_command_and_every_file_on_a_page_works() {
    let whole = world();
    let verbs = listed_verbs();
    let (mut ran, mut read) = (0, 0);
    let mut said = String::new();
    let mut faults = Vec::new();
    // All faults of all pages are told at once.
    let mut tried = |what: &dyn Fn() -> String| {
        let done = std::panic::catch_unwind(std::panic::AssertUnwindSafe(what));
        done.unwrap_or_else(|fault| {
            faults.push(fault.downcast_ref::<String>().cloned().unwrap_or_default());
            String::new()
        })
    };
    let examples = ("ieap help VERB".to_owned(), examples(&verbs));
    for (name, page) in pages().into_iter().chain([examples]) {
        for verb in names(&page) {
            let is_listed = verbs.iter().any(|known| known == verb) || verb == "help";
            tried(&|| {
                assert!(is_listed, "{name}: there is no verb `{verb}`");
                String::new()
            });
        }
        let blocks = blocks(&page);
        let commands = commands(&page, &blocks);
        let is_file = |block: &Block| is_toml(block) || is_table(block);
        if commands.is_empty() && !blocks.iter().any(is_file) {
            continue;
        }
        let folder = CampaignFolder::new();
        copy_all(whole.path(), folder.path());
        for block in blocks.iter().filter(|block| is_toml(block)) {
            tried(&|| {
                read_toml(&folder, &name, &block.text);
                String::new()
            });
            read += 1;
        }
        for block in blocks.iter().filter(|block| !is_toml(block) && is_table(block)) {
            tried(&|| {
                read_table(&folder, &name, &block.text);
                String::new()
            });
            read += 1;
        }
        said += &format!("{name}\n");
        for (line, reason) in commands {
            said += &tried(&|| obey(&folder, &name, &line, reason.as_deref()));
            ran += 1;
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n\n"));
    // The pages are read: a change of their form must not leave the test without commands.
    assert!(ran > 60 && read > 10, "{ran} commands, {read} files");
    if counted(0, 1) == 0 {
        insta::assert_snapshot!("commands_of_pages", said);
    }
}

/// A command of cargo on a page names a target and tests that are there.
#[test]
fn every_test_and_example_that_a_page_names_is_there() {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut sources = String::new();
    for folder in ["crates", "src", "tests", "examples", "benches"] {
        collect(&repository.join(folder), &mut sources);
    }
    let mut faults = Vec::new();
    let mut count = 0;
    for (name, page) in pages() {
        let blocks = blocks(&page);
        let lines = blocks.iter().flat_map(|block| block.text.lines());
        for line in lines.chain(spans(&page)).filter(|line| line.contains("cargo ")) {
            let words: Vec<&str> = line.split_whitespace().collect();
            for pair in words.windows(2) {
                let is_named = match pair[0] {
                    "--example" | "--bench" | "--test" => sources.contains(&format!("\nfile {}\n", pair[1])),
                    "it" | "unit" if !pair[1].starts_with('-') => {
                        let part = pair[1]
                            .trim_end_matches("::")
                            .rsplit("::")
                            .next()
                            .unwrap_or_default();
                        is_pattern(part) || sources.contains(part)
                    }
                    _ => continue,
                };
                count += 1;
                if !is_named {
                    faults.push(format!("{name}: `{line}`: no {}", pair[1]));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(count > 40, "{count}");
}

/// Names of files, modules and functions of a folder, each in a line.
fn collect(folder: &Path, found: &mut String) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            let name = path.file_name().unwrap().to_string_lossy();
            *found += &format!("\nfile {name}\n");
            collect(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            *found += &format!("\nfile {}\n", path.file_stem().unwrap().to_string_lossy());
            let text = std::fs::read_to_string(&path).unwrap();
            let named = text
                .lines()
                .filter(|line| line.contains("fn ") || line.contains("mod "));
            named.for_each(|line| *found += &format!("{line}\n"));
        }
    }
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
