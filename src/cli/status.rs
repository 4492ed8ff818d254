//! `ieap status`.

use crate::domain::number::fixed;
use crate::domain::words::counted;
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::json;

use super::allow_command::say_what_is_not_allowed;
use super::campaign::{CampaignArg, say_what_is_not_understood, say_what_opening_found};
use super::exit::{self, ALARM, CliError, DONE};
use super::ingest;
use super::output::Output;
use crate::domain::file_story::FileStory;
use crate::domain::{Alarm, Fault, Issue};
use crate::pipeline::infra::mends::Reasoned;
use crate::pipeline::infra::mends::together;
use crate::pipeline::intake::files::{lone, stories, view};
use crate::pipeline::upkeep::status::{Status, WAITS, status};
use crate::pipeline::{Context, TakenBack};

/// Count runs by state; list refused files with reasons, gaps in the condition matrix, and what is out of date
#[derive(Debug, Args)]
pub struct StatusArgs {
    #[command(flatten)]
    campaign: CampaignArg,
    /// Only the alarms of long-term monitoring; ends with status 5 where one stands that is not acknowledged
    #[arg(long)]
    alarms: bool,
    /// Every file, what became of it and why, the words of its name and where its tags come from
    #[arg(long, conflicts_with = "alarms")]
    files: bool,
}

/// Every file, and what became of it.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct FilesDocument {
    /// The files by path.
    files: Vec<FileStory>,
}

pub fn run(args: &StatusArgs, output: &Output) -> Result<u8, CliError> {
    // What is odd in campaign.toml is part of the answer.
    let context = Context::open_read_only(&args.campaign.folder()?)?;
    if args.files {
        say_what_is_not_understood(&context, output);
        let files = stories(&context)?;
        let shown = view(&files);
        output.show("ieap/files/1", &FilesDocument { files }, &shown)?;
        return Ok(DONE);
    }
    let status = status(&context)?;
    say_what_is_not_allowed(&context, output);
    if args.alarms {
        say_what_is_not_understood(&context, output);
        return alarms_only(&status, output);
    }
    say_what_opening_found(&context, output);
    print(&status, output);
    output.document(&json!({ "schema": "ieap/status/2", "status": status }))?;
    Ok(exit::after(
        false,
        !status.has_slip() && status.words_missed.is_empty(),
    ))
}

/// The alarms of long-term monitoring alone.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct AlarmsDocument<'a> {
    schema: &'static str,
    /// Alarms of long-term monitoring.
    alarms: &'a [Alarm],
    /// Alarms that were told of runs that were set aside later.
    taken_back: &'a [TakenBack],
    /// Why nothing is watched; none where something is.
    not_watched: Option<&'a str>,
}

/// The alarms alone, with an exit status that scripts can act on.
fn alarms_only(status: &Status, output: &Output) -> Result<u8, CliError> {
    alarms(status, output);
    if status.alarms.is_empty() {
        output.result(&match &status.monitoring {
            Some(reason) => format!("nothing is watched: {reason}"),
            None => "no alarm".to_owned(),
        });
    }
    output.document(&AlarmsDocument {
        schema: "ieap/alarms/2",
        alarms: &status.alarms,
        taken_back: &status.alarms_taken_back,
        not_watched: status.monitoring.as_deref(),
    })?;
    Ok(if status.alarms.iter().any(|alarm| !alarm.acknowledged) {
        ALARM
    } else {
        DONE
    })
}

fn alarms(status: &Status, output: &Output) {
    let (known, new): (Vec<_>, Vec<_>) = status.alarms.iter().partition(|alarm| alarm.acknowledged);
    for (alarms, title) in [(new, "of monitoring"), (known, "of monitoring that is known")] {
        let lines: Vec<String> = alarms
            .iter()
            .map(|alarm| format!("{} {}", alarm.id, alarm.message))
            .collect();
        list(output, "alarm", title, &lines);
    }
    let taken_back: Vec<String> = status
        .alarms_taken_back
        .iter()
        .map(|one| format!("{} {} But {}", one.id, one.message, one.set_aside.reason))
        .collect();
    let title = "that was told and is taken back, for its run is set aside";
    list(output, "alarm", title, &taken_back);
}

fn print(status: &Status, output: &Output) {
    let faults: Vec<String> = status.faults.iter().map(Fault::sentence).collect();
    let title = "of the report that a fault of the program left out; report it with the files of the runs";
    list(output, "part", title, &faults);
    let states: Vec<String> = status
        .runs_by_state
        .iter()
        .map(|(state, count)| match (*state, *count) {
            ("copy", 2..) => format!("{count} copies"),
            _ => format!("{count} {}", state.replace('_', " ")),
        })
        .collect();
    output.result(&format!(
        "{}: {} ({})",
        status.campaign,
        counted(status.runs, "run"),
        states.join(", ")
    ));
    if !status.campaign_file.is_empty() {
        output.result("campaign.toml:");
        let odd = status.campaign_file.iter();
        odd.for_each(|found| issue(output, "  ", found));
    }
    if !status.modulus_logs_by_state.is_empty() {
        let states = status.modulus_logs_by_state.iter();
        let states: Vec<String> = states
            .map(|(state, count)| format!("{count} {}", state.replace('_', " ")))
            .collect();
        output.result(&format!("modulus logs: {}", states.join(", ")));
    }
    if status.spectra > 0 {
        output.result(&format!("impedance spectra: {}", status.spectra));
    }
    set_aside(status, output);
    halves(status, output);
    section(output, "file", "refused", &status.refused);
    section(output, "file", ingest::NOT_READ, &status.unread);
    unreadable_tags(status, output);
    let waiting = "waiting (empty, header only, or still growing)";
    section(output, "file", waiting, &status.pending);
    section(
        output,
        "raw file",
        "lost from the archive",
        &status.raw_files_lost,
    );
    words_missed(status, output);
    let untagged = "without the tags to be fitted";
    section(output, "run", untagged, &status.untagged);
    ingest::pattern(output, status.proposed_pattern.as_ref());
    let no_steps = "whose voltage does not go in steps (a sweep, or another technique): kept, not fitted";
    section(output, "run", no_steps, &status.no_steps);
    let lacking = "fitted without a response that the file holds";
    section(output, "run", lacking, &status.fitted_without_response);
    let dry = "without a humidity, where others state one: laws of it are told from those \
               (`ieap tag \"PATTERN\" relative_humidity_percent=0`, or once under [[environment]] in campaign.toml)";
    list(output, "run", dry, &status.without_humidity);
    let left_out = "with readings that are no numbers: these are left out";
    section(output, "run", left_out, &status.readings_left_out);
    undeclared_tags(status, output);
    let waits = |run: &&Reasoned| run.issues.iter().any(|issue| issue.code == WAITS);
    let failed = status.not_fitted.iter().filter(|run| !waits(run)).cloned();
    section(
        output,
        "run",
        "that could not be fitted",
        &failed.collect::<Vec<_>>(),
    );
    let waiting = status.not_fitted.iter().filter(waits);
    let waiting: Vec<String> = waiting.map(|run| run.path.clone()).collect();
    let title = "waiting for a fit (`ieap fit` or `ieap run` makes it)";
    list(output, "run", title, &waiting);
    let contradict = "under several names that are tagged differently";
    section(output, "run", contradict, &status.names_contradict);
    let logs = &status.modulus_logs_not_analysed;
    section(output, "modulus log", "not analysed", logs);
    let spectra = &status.spectra_untagged;
    section(output, "spectrum", "without a sample", spectra);
    let aliases: Vec<String> = status
        .alias_files
        .iter()
        .map(|alias| format!("{} (of {})", alias.path, alias.run))
        .collect();
    list(output, "file", "with the bytes of a run's file", &aliases);
    let missing = "no longer in the folder; the runs stay (`ieap drop --deleted --why ...` takes them out of all results)";
    list(output, "file", missing, &status.missing_files);
    let gaps: Vec<String> = status
        .gaps
        .iter()
        .map(|gap| format!("{} in {} at {} V", gap.material, gap.environment, gap.voltage_v))
        .collect();
    list(output, "condition", "without a run", &gaps);
    lumped_or_distributed(status, output);
    planned(status, output);
    climate(status, output);
    alarms(status, output);
    let older = "fitted by another version of ieap";
    list(output, "run", older, &status.fitted_by_older_program);
    list(output, "group", "not diagnosed yet", &status.groups_not_diagnosed);
    let outdated = "with a finding that is out of date (`ieap diagnose` makes it anew)";
    list(output, "group", outdated, &status.findings_out_of_date);
    if let Some(refused) = &status.report_refused {
        output.result(&format!("report that cannot be written anew:\n  {refused}"));
    }
}

/// Runs in two files, and halves whose partner is not there.
fn halves(status: &Status, output: &Output) {
    if !status.pairs.is_empty() {
        let runs = counted(status.pairs.len(), "run");
        output.result(&format!(
            "{runs} in two files (`ieap status --files` shows the pairs)"
        ));
    }
    let lone: Vec<Reasoned> = status
        .lone_halves
        .iter()
        .map(|half| Reasoned {
            path: half.path.clone(),
            issues: vec![Issue {
                place: String::new(),
                ..lone(half)
            }],
        })
        .collect();
    section(output, "file", "with half of a run alone", &lone);
}

/// Words that may be lost since a rebuilding.
fn words_missed(status: &Status, output: &Output) {
    if status.words_missed.is_empty() {
        return;
    }
    output.result("words that may be lost:");
    for missed in &status.words_missed {
        issue(output, "  ", missed);
    }
}

/// Tag files that cannot be read, and for how many runs each speaks.
fn unreadable_tags(status: &Status, output: &Output) {
    let found = &status.unreadable_tags;
    if found.is_empty() {
        return;
    }
    output.result(&format!(
        "{} of tags cannot be read; the runs that they speak for keep the tags that they had, or wait:",
        counted(found.len(), "statement")
    ));
    for tags in found {
        issue(output, "  ", &tags.issue);
        output.result(&format!("      it speaks for {}", counted(tags.runs, "run")));
    }
}

/// How many runs need the distributed model; those that do not are counted only.
fn lumped_or_distributed(status: &Status, output: &Output) {
    let told = &status.lumped_or_distributed;
    let counts = ["distributed", "lumped", "open", "cannot be told"].map(|verdict| {
        let count = told.iter().filter(|entry| entry.verdict == verdict).count();
        (count > 0).then(|| format!("{count} {verdict}"))
    });
    let counts: Vec<String> = counts.into_iter().flatten().collect();
    if counts.is_empty() {
        return;
    }
    output.result(&format!("lumped or distributed: {}", counts.join(", ")));
    for entry in told.iter().filter(|entry| entry.verdict != "lumped") {
        output.result(&format!("  {}: {}", entry.run, entry.sentence));
        entry
            .mend
            .iter()
            .for_each(|mend| output.result(&format!("      -> {mend}")));
    }
}

/// Run sheets: how many of their runs have been made, and which have not.
fn planned(status: &Status, output: &Output) {
    let planned = &status.planned;
    if planned.sheets.is_empty() && planned.damaged_sheets.is_empty() {
        return;
    }
    output.result(&format!(
        "planned runs: {} done, {} open on {}",
        planned.done.len(),
        planned.open.len(),
        counted(planned.sheets.len(), "run sheet")
    ));
    for row in &planned.open {
        let passed = if row.passed_over { ", passed over" } else { "" };
        let row = &row.row;
        let sample = row.sample.as_deref().unwrap_or("");
        output.result(&format!(
            "  {} {sample}: {}, to be saved as {} ({}{passed})",
            row.planned, row.drive, row.file, row.sheet
        ));
    }
    list(
        output,
        "run sheet",
        "that cannot be used",
        &planned.damaged_sheets,
    );
}

/// Climate logs: how many, which runs they cover, what is wrong with them.
fn climate(status: &Status, output: &Output) {
    let climate = &status.climate;
    if climate.logs == 0 {
        return;
    }
    let mut sensors: Vec<&str> = climate
        .assessment
        .sensors
        .iter()
        .map(|s| s.sensor.as_str())
        .collect();
    sensors.sort_unstable();
    sensors.dedup();
    output.result(&format!(
        "climate: {} of {} in ambient/, covering {} of {}",
        counted(climate.logs, "log"),
        counted(sensors.len(), "sensor"),
        climate.runs_covered,
        counted(status.runs, "run")
    ));
    list(
        output,
        "run",
        "whose climate left the tolerance",
        &climate.runs_left_tolerance,
    );
    list(
        output,
        "run",
        "whose label differs from the measured climate",
        &climate.runs_label_differs,
    );
    list(
        output,
        "run",
        "without a log that covers them",
        &climate.runs_not_covered,
    );
    list(
        output,
        "run",
        "that no log can be held against, for no start of them is known (`ieap tag RUN started_at=...`)",
        &climate.runs_without_start,
    );
    let exposures: Vec<String> = climate
        .assessment
        .exposures
        .iter()
        .map(|exposure| match &exposure.reason {
            Some(reason) => format!("{}: not known, {reason}", exposure.sample),
            None => format!(
                "{}: {} h above {} % in {} h that logs cover ({} h not covered)",
                exposure.sample,
                fixed(exposure.above_h, 1),
                exposure.above_percent,
                fixed(exposure.covered_h, 1),
                fixed(exposure.uncovered_h, 1)
            ),
        })
        .collect();
    list(
        output,
        "sample",
        "with an exposure between the first and the last run",
        &exposures,
    );
    let problems: Vec<&Issue> = climate
        .assessment
        .issues
        .iter()
        .filter(|issue| issue.severity > crate::domain::Severity::Note)
        .collect();
    if !problems.is_empty() {
        output.result(&format!(
            "{} of climate logs:",
            counted(problems.len(), "problem")
        ));
        problems.iter().for_each(|problem| issue(output, "  ", problem));
    }
}

/// Runs that no result is made from, with the reason and the way back.
fn set_aside(status: &Status, output: &Output) {
    if status.set_aside.is_empty() {
        return;
    }
    let runs = counted(status.set_aside.len(), "run");
    output.result(&format!("{runs} set aside, in no result:"));
    for run in &status.set_aside {
        output.result(&format!("  {}", run.run));
        output.result(&format!("      {}: {}", run.standing, run.reason));
        output.result(&format!("      -> {}", run.mend));
    }
}

/// An issue with its place and the way to mend it.
fn issue(output: &Output, indent: &str, issue: &Issue) {
    let place = if issue.place.is_empty() {
        String::new()
    } else {
        format!("{}: ", issue.place)
    };
    output.result(&format!("{indent}{place}{}", issue.message));
    if !issue.mend.is_empty() {
        output.result(&format!("{indent}-> {}", issue.mend));
    }
}

fn section(output: &Output, thing: &str, title: &str, entries: &[Reasoned]) {
    if entries.is_empty() {
        return;
    }
    output.result(&format!("{} {title}:", counted(entries.len(), thing)));
    let worth = |entry: &Reasoned| -> Vec<Issue> {
        let issues = entry.issues.iter().cloned();
        issues
            .filter(|issue| issue.severity > crate::domain::Severity::Note)
            .collect()
    };
    for told in together(entries.iter().map(|entry| (entry.path.as_str(), worth(entry)))) {
        told.paths
            .iter()
            .for_each(|path| output.result(&format!("  {path}")));
        told.issues
            .iter()
            .for_each(|found| issue(output, "      ", found));
    }
}

/// Tag keys that are neither known nor declared, with the runs that have them.
fn undeclared_tags(status: &Status, output: &Output) {
    let tags = &status.undeclared_tags;
    if tags.is_empty() {
        return;
    }
    output.result(&format!(
        "{} that nothing is asked of:",
        counted(tags.len(), "tag key")
    ));
    for told in tags {
        told.paths
            .iter()
            .for_each(|path| output.result(&format!("  {path}")));
        told.issues
            .iter()
            .for_each(|found| issue(output, "      ", found));
    }
}

fn list(output: &Output, thing: &str, title: &str, entries: &[String]) {
    if !entries.is_empty() {
        output.result(&format!("{} {title}:", counted(entries.len(), thing)));
        entries
            .iter()
            .for_each(|entry| output.result(&format!("  {entry}")));
    }
}
