//! `ieap status`.

use std::collections::BTreeSet;

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
use super::sections::Sections;
use crate::domain::file_story::FileStory;
use crate::domain::pairs::HalfKind;
use crate::domain::{Alarm, Fault, Issue};
use crate::pipeline::TakenBack;
use crate::pipeline::documents::diagnosis::group_title;
use crate::pipeline::infra::mends::Reasoned;
use crate::pipeline::intake::files::{lone, stories, view};
use crate::pipeline::upkeep::status::{Status, WAITS, status};

/// Count runs; list what was refused, lacks or is due
///
/// Files refused come with their reasons, gaps with their conditions.
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
    let context = args.campaign.open_to_show(output)?;
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
    let mut told = Sections::default();
    alarms(status, &mut told);
    told.print(output);
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

fn alarms(status: &Status, told: &mut Sections) {
    let (known, new): (Vec<_>, Vec<_>) = status.alarms.iter().partition(|alarm| alarm.acknowledged);
    for (alarms, title) in [(new, "of monitoring"), (known, "of monitoring that is known")] {
        let lines: Vec<String> = alarms
            .iter()
            .map(|alarm| format!("{} {}", alarm.id, alarm.message))
            .collect();
        told.list("alarm", title, &lines);
    }
    let taken_back: Vec<String> = status
        .alarms_taken_back
        .iter()
        .map(|one| format!("{} {} But {}", one.id, one.message, one.set_aside.reason))
        .collect();
    let title = "that was told and is taken back, for its run is set aside";
    told.list("alarm", title, &taken_back);
}

fn print(status: &Status, output: &Output) {
    let mut told = Sections::default();
    collect(status, &mut told);
    told.print(output);
    ingest::pattern(output, status.proposed_pattern.as_ref());
}

fn collect(status: &Status, told: &mut Sections) {
    let faults: Vec<String> = status.faults.iter().map(Fault::sentence).collect();
    let title = "of the report that a fault of the program left out; report it with the files of the runs";
    told.list("part", title, &faults);
    let states: Vec<String> = status
        .runs_by_state
        .iter()
        .map(|(state, count)| match (*state, *count) {
            ("copy", 2..) => format!("{count} copies"),
            _ => format!("{count} {}", state.replace('_', " ")),
        })
        .collect();
    told.say(&format!(
        "{}: {} ({})",
        status.campaign,
        counted(status.runs, "run"),
        states.join(", ")
    ));
    if !status.campaign_file.is_empty() {
        told.say("campaign.toml:");
        let odd = status.campaign_file.iter();
        odd.for_each(|found| told.issue(found));
    }
    if !status.modulus_logs_by_state.is_empty() {
        let states = status.modulus_logs_by_state.iter();
        let states: Vec<String> = states
            .map(|(state, count)| format!("{count} {}", state.replace('_', " ")))
            .collect();
        told.say(&format!("modulus logs: {}", states.join(", ")));
    }
    if status.spectra > 0 {
        told.say(&format!("impedance spectra: {}", status.spectra));
    }
    questions(status, told);
    set_aside(status, told);
    halves(status, told);
    told.section("file", "refused", &status.refused);
    told.section("file", ingest::NOT_READ, &status.unread);
    unreadable_tags(status, told);
    let waiting = "waiting (empty, header only, still growing, or tags of no run)";
    told.section("file", waiting, &status.pending);
    told.section("raw file", "lost from the archive", &status.raw_files_lost);
    words_missed(status, told);
    let untagged = "without the tags to be fitted";
    told.section("run", untagged, &status.untagged);
    let no_steps = "whose voltage does not go in steps (a sweep, or another technique): kept, not fitted";
    told.section("run", no_steps, &status.no_steps);
    let lacking = "fitted without a response that the file holds";
    told.section("run", lacking, &status.fitted_without_response);
    let dry = "without a humidity, where others state one: laws of it are told from those \
               (`ieap tag \"PATTERN\" relative_humidity_percent=0`, or once under [[environment]] in campaign.toml)";
    told.list("run", dry, &status.without_humidity);
    let left_out = "with readings that are no numbers: these are left out";
    told.section("run", left_out, &status.readings_left_out);
    undeclared_tags(status, told);
    let waits = |run: &&Reasoned| run.issues.iter().any(|issue| issue.code == WAITS);
    let failed = status.not_fitted.iter().filter(|run| !waits(run)).cloned();
    told.section("run", "that could not be fitted", &failed.collect::<Vec<_>>());
    let waiting = status.not_fitted.iter().filter(waits);
    let waiting: Vec<String> = waiting.map(|run| run.path.clone()).collect();
    let title = "waiting for a fit (`ieap run` makes it)";
    told.list("run", title, &waiting);
    let contradict = "under several names that are tagged differently";
    told.section("run", contradict, &status.names_contradict);
    let logs = &status.modulus_logs_not_analysed;
    told.section("modulus log", "not analysed", logs);
    let spectra = &status.spectra_untagged;
    told.section("spectrum", "without a sample", spectra);
    aliases(status, told);
    let missing = "no longer in the folder; the runs stay (`ieap drop --deleted --why ...` takes them out of all results)";
    told.list("file", missing, &status.missing_files);
    let gaps: Vec<String> = status
        .gaps
        .iter()
        .map(|gap| format!("{} in {} at {} V", gap.material, gap.environment, gap.voltage_v))
        .collect();
    told.list("condition", "without a run", &gaps);
    lumped_or_distributed(status, told);
    planned(status, told);
    climate(status, told);
    alarms(status, told);
    let older = "fitted by another version of ieap";
    told.list("run", older, &status.fitted_by_older_program);
    let titles = |groups: &[String]| groups.iter().map(|name| group_title(name)).collect::<Vec<_>>();
    told.list(
        "group",
        "not diagnosed yet",
        &titles(&status.groups_not_diagnosed),
    );
    let outdated = "with a finding that is out of date (`ieap diagnose` makes it anew)";
    told.list("group", outdated, &titles(&status.findings_out_of_date));
    if let Some(refused) = &status.report_refused {
        told.say(&format!("report that cannot be written anew:\n  {refused}"));
    }
}

/// Files that are no runs, for their bytes are those of a run's file, by that run.
fn aliases(status: &Status, told: &mut Sections) {
    let found = &status.alias_files;
    if found.is_empty() {
        return;
    }
    told.say(&format!(
        "{} with the bytes of a run's file:",
        counted(found.len(), "file")
    ));
    let runs: BTreeSet<&str> = found.iter().map(|alias| alias.run.as_str()).collect();
    for run in runs {
        let own = found.iter().filter(|alias| alias.run == run);
        let files: Vec<&str> = own.map(|alias| alias.path.as_str()).collect();
        told.entry(
            vec![run.to_owned()],
            vec![format!("also as {}", files.join(", "))],
        );
    }
}

/// Runs in two files, and halves whose partner is not there.
fn halves(status: &Status, told: &mut Sections) {
    if !status.pairs.is_empty() {
        let runs = counted(status.pairs.len(), "run");
        told.say(&format!(
            "{runs} in two files (`ieap status --files` shows the pairs)"
        ));
    }
    if status.lone_halves.is_empty() {
        return;
    }
    let files = counted(status.lone_halves.len(), "file");
    told.say(&format!("{files} with half of a run alone:"));
    for kind in [HalfKind::Electrical, HalfKind::Bending] {
        let of_kind = status.lone_halves.iter().filter(|half| half.holds == kind);
        let names: Vec<String> = of_kind.clone().map(|half| half.path.clone()).collect();
        if let Some(first) = of_kind.into_iter().next() {
            // One answer settles all of them.
            let issue = lone(first);
            let message = match names.len() {
                1 => issue.message,
                _ => format!("of the first: {}", issue.message),
            };
            told.entry(names, vec![message, format!("-> {}", issue.mend)]);
        }
    }
}

/// Words that may be lost since a rebuilding, and words that hold of nothing.
fn words_missed(status: &Status, told: &mut Sections) {
    for words in &status.words_of_no_run {
        told.issue(words);
    }
    if status.words_missed.is_empty() {
        return;
    }
    told.say("words that may be lost:");
    for missed in &status.words_missed {
        told.issue(missed);
    }
}

/// Tag files that cannot be read, and for how many runs each speaks.
fn unreadable_tags(status: &Status, told: &mut Sections) {
    let found = &status.unreadable_tags;
    if found.is_empty() {
        return;
    }
    told.say(&format!(
        "{} of tags cannot be read; the runs that they speak for keep the tags that they had, or wait:",
        counted(found.len(), "statement")
    ));
    for tags in found {
        told.issue(&tags.issue);
        let runs = counted(tags.runs, "run");
        told.entry(Vec::new(), vec![format!("it speaks for {runs}")]);
    }
}

/// How many runs need the distributed model; those that do not are counted only.
fn lumped_or_distributed(status: &Status, told: &mut Sections) {
    let decided = &status.lumped_or_distributed;
    let counts = ["distributed", "lumped", "open", "cannot be told"].map(|verdict| {
        let count = decided.iter().filter(|entry| entry.verdict == verdict).count();
        (count > 0).then(|| format!("{count} {verdict}"))
    });
    let counts: Vec<String> = counts.into_iter().flatten().collect();
    if counts.is_empty() {
        return;
    }
    told.say(&format!("lumped or distributed: {}", counts.join(", ")));
    for entry in decided.iter().filter(|entry| entry.verdict != "lumped") {
        let mends = entry.mend.iter().map(|mend| format!("-> {mend}"));
        let lines = std::iter::once(entry.sentence.clone()).chain(mends);
        told.entry(vec![entry.run.clone()], lines.collect());
    }
}

/// Run sheets: how many of their runs have been made, and which have not.
fn planned(status: &Status, told: &mut Sections) {
    let planned = &status.planned;
    if planned.sheets.is_empty() && planned.damaged_sheets.is_empty() {
        return;
    }
    told.say(&format!(
        "planned runs: {} done, {} open on {}",
        planned.done.len(),
        planned.open.len(),
        counted(planned.sheets.len(), "run sheet")
    ));
    for row in &planned.open {
        let passed = if row.passed_over { ", passed over" } else { "" };
        let row = &row.row;
        let sample = row.sample.as_deref().unwrap_or("");
        told.say(&format!(
            "  {} {sample}: {}, to be saved as {} ({}{passed})",
            row.planned, row.drive, row.file, row.sheet
        ));
    }
    told.list("run sheet", "that cannot be used", &planned.damaged_sheets);
}

/// Climate logs: how many, which runs they cover, what is wrong with them.
fn climate(status: &Status, told: &mut Sections) {
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
    told.say(&format!(
        "climate: {} of {} in ambient/, covering {} of {}",
        counted(climate.logs, "log"),
        counted(sensors.len(), "sensor"),
        climate.runs_covered,
        counted(status.runs, "run")
    ));
    told.list(
        "run",
        "whose climate left the tolerance",
        &climate.runs_left_tolerance,
    );
    told.list(
        "run",
        "whose label differs from the measured climate",
        &climate.runs_label_differs,
    );
    told.list("run", "without a log that covers them", &climate.runs_not_covered);
    told.list(
        "run",
        "that no log can be held against, for no start of them is known with its time (`ieap tag RUN started_at=...`)",
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
    told.list(
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
        told.say(&format!(
            "{} of climate logs:",
            counted(problems.len(), "problem")
        ));
        problems.iter().for_each(|problem| told.issue(problem));
    }
}

/// Statements about runs that contradict each other, and how to say which is right.
fn questions(status: &Status, told: &mut Sections) {
    if status.questions.is_empty() {
        return;
    }
    told.say("which is right?");
    for asked in &status.questions {
        let answers = asked.answers.iter().map(|answer| format!("-> {answer}"));
        let until = std::iter::once(format!("{}:", asked.until));
        told.entry(vec![asked.question.clone()], until.chain(answers).collect());
    }
}

/// Runs that no result is made from, with the reason and the way back; what is asked of stands above.
fn set_aside(status: &Status, told: &mut Sections) {
    let runs = status.set_aside.iter();
    let runs: Vec<_> = runs.filter(|run| run.standing != "contradicted").collect();
    if runs.is_empty() {
        return;
    }
    told.say(&format!(
        "{} set aside, in no result:",
        counted(runs.len(), "run")
    ));
    for run in runs {
        let lines = vec![
            format!("{}: {}", run.standing, run.reason),
            format!("-> {}", run.mend),
        ];
        told.entry(vec![run.run.clone()], lines);
    }
}

/// Tag keys that are neither known nor declared, with the runs that have them.
fn undeclared_tags(status: &Status, told: &mut Sections) {
    let tags = &status.undeclared_tags;
    if tags.is_empty() {
        return;
    }
    told.say(&format!(
        "{} that nothing is asked of:",
        counted(tags.len(), "tag key")
    ));
    told.alike(tags);
}
