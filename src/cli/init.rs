//! `ieap init`.

use crate::domain::words::counted;
use std::collections::BTreeMap;
use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::exit::{CliError, DONE};
use super::output::Output;
use crate::domain::pairs::LoneHalf;
use crate::domain::safe_text::one_line;
use crate::domain::tag::keys;
use crate::pipeline::init;
use crate::pipeline::{InitFrom, PlannedFile, Proposed, Taken};

/// Make a folder a campaign, of the files of --from
///
/// Writes a commented campaign.toml and the folders runs/, dma/ and ambient/. With --from it looks at the files
/// of another folder and shows the campaign that they would make; with --yes it makes it, with copies of the
/// files.
#[derive(Debug, Args)]
pub struct InitArgs {
    /// Folder to make a campaign; made where it is not there
    #[arg(value_name = "FOLDER", default_value = ".")]
    folder: PathBuf,
    /// Folder with files of instruments to make the campaign of; they are copied, never changed
    #[arg(long, value_name = "FILES")]
    from: Option<PathBuf>,
    /// Make the campaign that --from shows
    #[arg(long, requires = "from")]
    yes: bool,
}

pub fn run(args: &InitArgs, output: &Output) -> Result<u8, CliError> {
    if let Some(from) = &args.from {
        let verb = InitFrom {
            campaign: args.folder.clone(),
            from: from.clone(),
            write: args.yes,
        };
        let proposed = verb.run()?;
        print(args, &proposed, output);
        output.document(&json!({ "schema": "ieap/init-from/1", "proposed": proposed }))?;
        return Ok(DONE);
    }
    let made = init(&args.folder)?;
    made.iter()
        .for_each(|path| output.result(&format!("made {}", path.display())));
    let file = args.folder.join("campaign.toml");
    output.message(&format!(
        "Next: name your samples in {}, put instrument files into {}, then `ieap run {}`.",
        file.display(),
        args.folder.join("runs").display(),
        args.folder.display()
    ));
    let made: Vec<String> = made.iter().map(|path| path.display().to_string()).collect();
    output.document(&json!({ "schema": "ieap/init/1", "made": made }))?;
    Ok(DONE)
}

fn print(args: &InitArgs, proposed: &Proposed, output: &Output) {
    table(&proposed.files, &proposed.lone_halves, output);
    let kinds = [
        (Taken::Run, "run"),
        (Taken::NoSteps, "run without steps"),
        (Taken::RunSheet, "run sheet"),
        (Taken::Logger, "climate log"),
        (Taken::ModulusLog, "modulus log"),
        (Taken::Copy, "copy of a run's file"),
        (Taken::NotRead, "file not read"),
        (Taken::NoData, "file without data"),
        (Taken::LeftOut, "file left out"),
    ];
    let halves = proposed.pairs.len();
    let of = |taken: Taken| proposed.count(taken) - if taken == Taken::Run { halves } else { 0 };
    let counts = kinds.iter().map(|(taken, name)| (of(*taken), name));
    let counts: Vec<String> = counts
        .filter(|(count, _)| *count > 0)
        .map(|(count, name)| match (count, name.split_once(' ')) {
            (1, _) => format!("1 {name}"),
            (_, Some(("copy", rest))) => format!("{count} copies {rest}"),
            (_, Some((first @ ("run" | "file"), rest))) => format!("{count} {first}s {rest}"),
            _ => counted(count, name),
        })
        .collect();
    output.result(&format!("\n{}", counts.join(", ")));
    if halves > 0 {
        let runs = counted(halves, "run");
        output.result(&format!(
            "{runs} in two files each: each half stands above with its partner"
        ));
    }
    if let Some(pattern) = &proposed.name_pattern {
        let (text, explains, names) = (&pattern.pattern, pattern.explains, pattern.names);
        output.result(&format!(
            "name_pattern = \"{text}\" explains {explains} of {names} names"
        ));
    }
    let beside = proposed
        .files
        .iter()
        .filter(|file| !file.beside.is_empty())
        .count();
    if beside > 0 {
        let files = counted(beside, "file");
        output.result(&format!(
            "{files} with tags of the name that the pattern does not give: written beside the copy"
        ));
    }
    for profile in proposed.profiles.iter().filter(|profile| profile.open.is_empty()) {
        output.result(&format!(
            "profiles/{}.toml reads {}",
            profile.id,
            one_line(&profile.files.join(", "))
        ));
    }
    output.result("to fill in:");
    proposed
        .fill_in
        .iter()
        .for_each(|open| output.result(&format!("  {}", one_line(open))));
    let folder = args.folder.display();
    if proposed.written {
        output.message(&format!(
            "Made {folder}. Next: fill in what is listed, then `ieap run {folder}`."
        ))
    } else {
        output.message(
            "Nothing was written. The same command with --yes makes the campaign, with copies of the files.",
        )
    }
}

/// Files of one kind of which the same is said, from which on only the first are shown. Chosen: a screen has some forty lines.
const SHOWN_OF_A_KIND: usize = 3;

/// Rows, those of files of one kind together: of many alike the first, and how many more there are.
fn together(rows: Vec<[String; 7]>) -> Vec<[String; 7]> {
    const FEW: usize = 24;
    if rows.len() <= FEW {
        return rows;
    }
    let without_digits = |text: &str| -> String { text.chars().filter(|c| !c.is_ascii_digit()).collect() };
    // Names of partners differ from file to file, and so do lines and numbers in what is said.
    let kind = |row: &[String; 7]| {
        let folder = row[0]
            .rsplit_once('/')
            .map_or("", |(folder, _)| folder)
            .to_owned();
        let said = row[6].split("; ").map(|said| match said.split_once("with ") {
            Some(("", _)) => "with".to_owned(),
            _ => without_digits(said),
        });
        (folder, row[1].clone(), row[2].clone(), said.collect::<Vec<_>>())
    };
    let mut counts: BTreeMap<_, usize> = BTreeMap::new();
    rows.iter()
        .for_each(|row| *counts.entry(kind(row)).or_insert(0) += 1);
    let mut met: BTreeMap<_, usize> = BTreeMap::new();
    let mut shown = Vec::new();
    for row in rows {
        let own = kind(&row);
        let count = counts.get(&own).copied().unwrap_or(0);
        let met = met.entry(own).or_insert(0);
        *met += 1;
        if *met <= SHOWN_OF_A_KIND || count == SHOWN_OF_A_KIND + 1 {
            shown.push(row);
        } else if *met == count {
            let more = format!("... and {} more like it", count - SHOWN_OF_A_KIND);
            let mut said = std::array::from_fn(|_| String::new());
            said[0] = more;
            shown.push(said);
        }
    }
    shown
}

/// One line a file: what it is taken for, what its name says, and what is missing.
fn table(files: &[PlannedFile], lone_halves: &[LoneHalf], output: &Output) {
    let head = [
        "file",
        "taken for",
        "read by",
        "sample",
        "environment",
        "V",
        "to know",
    ]
    .map(str::to_owned);
    let mut rows = vec![head];
    for file in files {
        let tag = |key: &str| file.tags.get(key).cloned().unwrap_or_default();
        let voltage = match (tag(keys::VOLTAGE_V), file.seen.has_drive) {
            (stated, _) if !stated.is_empty() => stated,
            (_, true) => "in file".to_owned(),
            _ => String::new(),
        };
        let missing = file.missing.iter().map(|key| format!("{key} missing"));
        let issues = file.seen.issues.iter().map(|issue| issue.message.clone());
        let partner = file.partner.iter().map(|partner| format!("with {partner}"));
        let lone = lone_halves.iter().filter(|half| half.path == file.seen.path);
        let lone = lone.map(|half| format!("waits for {}", half.waits_for));
        let told: Vec<String> = partner.chain(lone).chain(missing).chain(issues).collect();
        let taken = match (&file.partner, file.seen.half) {
            (Some(_), Some(_)) => "half of a run",
            _ => file.seen.taken.words(),
        };
        rows.push([
            file.seen.path.clone(),
            taken.to_owned(),
            file.seen.format.clone(),
            tag(keys::SAMPLE),
            tag(keys::ENVIRONMENT),
            voltage,
            told.join("; "),
        ]);
    }
    let rows = together(rows);
    // A name of a file may hold anything.
    let rows: Vec<[String; 7]> = rows
        .into_iter()
        .map(|row| row.map(|cell| one_line(&cell)))
        .collect();
    let width = |column: usize| {
        rows.iter()
            .map(|row| row[column].chars().count())
            .max()
            .unwrap_or(0)
    };
    let widths: Vec<usize> = (0..rows[0].len()).map(width).collect();
    for row in &rows {
        let cells = row
            .iter()
            .zip(&widths)
            .map(|(cell, &width)| format!("{cell:width$}"));
        output.result(cells.collect::<Vec<_>>().join("  ").trim_end());
    }
    for file in files.iter().filter(|file| !file.seen.columns.is_empty()) {
        output.detail(&one_line(&format!(
            "{}: {}",
            file.seen.path,
            file.seen.columns.join(", ")
        )));
    }
}
