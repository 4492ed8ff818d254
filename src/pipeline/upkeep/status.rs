//! Counts: runs by state, refused files with reasons, gaps in the condition matrix, what is out of date.

use std::collections::{BTreeMap, BTreeSet};

use schemars::JsonSchema;
use serde::Serialize;

use super::verify;
use super::verify::archive::raw_files_lost;
use crate::analysis::conditions::is_too_short;
use crate::analysis::witnesses;
use crate::domain::pairs::{LoneHalf, Pair};
use crate::domain::tag::keys;
use crate::domain::{
    Alarm, ClimateAssessment, Contradiction, Fault, FileState, Issue, RunRecord, RunState, Severity,
};
use crate::ingest::campaign_file::{NOT_READ, UNKNOWN_KEY};
use crate::ingest::formats::columns::{NOT_FINITE, TEXT_AMONG_NUMBERS};
use crate::ingest::name_pattern::ProposedPattern;
use crate::ingest::tags::NAMES_CONTRADICT;
use crate::pipeline::campaign::context::CODE_VERSION;
use crate::pipeline::campaign::planned::{Planned, planned};
use crate::pipeline::campaign::standing::{self, Runs, SetAside};
use crate::pipeline::documents::lengthwise::LumpedOrDistributedEntry;
use crate::pipeline::findings::alarms::{self, TakenBack};
use crate::pipeline::findings::current::findings_among;
use crate::pipeline::findings::diagnose;
use crate::pipeline::fits::outcome::is_of_failed_fit;
use crate::pipeline::infra::fault::or_nothing;
use crate::pipeline::infra::mends::{Reasoned, Together};
use crate::pipeline::intake::climate::assess;
use crate::pipeline::intake::ingest::pairs::paired;
use crate::pipeline::intake::ingest::unread::RESPONSE_MISSING;
use crate::pipeline::intake::ingest::waiting::{proposed_pattern, undeclared_tags};
use crate::pipeline::intake::ingest::{UnreadableTags, unreadable_tags};
use crate::pipeline::show::report::{not_ours, report_faults};
use crate::pipeline::{Context, PipelineError};

/// The state of a campaign.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Status {
    /// Campaign id.
    pub campaign: String,
    /// What is odd in campaign.toml: keys that are not known, which a slip makes of others.
    pub campaign_file: Vec<Issue>,
    /// Number of current runs.
    pub runs: usize,
    /// What only a person can answer: statements about runs that contradict each other.
    pub questions: Vec<Contradiction>,
    /// Current runs by state; fitted ones counted as `fitted`, those that no result is made from as `dropped`, `condemned`,
    /// `contradicted` or `copy`.
    pub runs_by_state: BTreeMap<&'static str, usize>,
    /// Current modulus logs by state; analysed ones counted as `analysed`.
    pub modulus_logs_by_state: BTreeMap<&'static str, usize>,
    /// Runs and modulus logs that no result is made from, with the reason.
    pub set_aside: Vec<SetAside>,
    /// Modulus logs that are not analysed, with the reason.
    pub modulus_logs_not_analysed: Vec<Reasoned>,
    /// Impedance spectra that speak.
    pub spectra: usize,
    /// Those of them of which no sample is known.
    pub spectra_untagged: Vec<Reasoned>,
    /// Runs in two files, by what they were paired.
    pub pairs: Vec<Pair>,
    /// Files that hold half of a run and whose partner is not there.
    pub lone_halves: Vec<LoneHalf>,
    /// Runs that wait for tags, with what is missing.
    pub untagged: Vec<Reasoned>,
    /// The name pattern that would tag the most of them; none where none would tag two.
    pub proposed_pattern: Option<ProposedPattern>,
    /// Runs that are tagged and have no fit: those that could not be fitted, with the reason, and those that wait.
    pub not_fitted: Vec<Reasoned>,
    /// Runs whose voltage does not go in steps, such as sweeps: kept, not fitted, waiting for nothing.
    pub no_steps: Vec<Reasoned>,
    /// Tag keys that are neither known nor declared, with the runs that have them and the mend.
    pub undeclared_tags: Vec<Together>,
    /// Fitted runs whose files hold a response that was not read, with the reason.
    pub fitted_without_response: Vec<Reasoned>,
    /// Fitted runs that state no humidity where others do: laws of the humidity are told without them.
    pub without_humidity: Vec<String>,
    /// Runs, modulus logs and spectra with cells that hold no number in columns that are read: these readings are left out.
    pub readings_left_out: Vec<Reasoned>,
    /// Runs whose readings lie under several names that are tagged differently.
    pub names_contradict: Vec<Reasoned>,
    /// Files that were refused.
    pub refused: Vec<Reasoned>,
    /// Files that the system could not give when they were last tried.
    pub unread: Vec<Reasoned>,
    /// What cannot be read of tag files: the runs that they speak for wait.
    pub unreadable_tags: Vec<UnreadableTags>,
    /// Files that wait: empty, header only, still growing.
    pub pending: Vec<Reasoned>,
    /// Raw files that the archive lacks or holds with another size, by a file of the run or log that they are of.
    pub raw_files_lost: Vec<Reasoned>,
    /// Words that may be lost since a rebuilding, until a person answers.
    pub words_missed: Vec<Issue>,
    /// What was said of measurements whose bytes lie under no name any more, as where another was saved under theirs.
    pub words_of_no_run: Vec<Issue>,
    /// Number of files that hold the same bytes as a run's file.
    pub aliases: usize,
    /// These files, each with the run.
    pub alias_files: Vec<AliasFile>,
    /// Files of runs and logs whose bytes no file of the folder holds any more.
    pub missing_files: Vec<String>,
    /// Conditions without a run, among all combinations of the materials, environments and voltages measured.
    pub gaps: Vec<Gap>,
    /// Runs whose fit an older program made.
    pub fitted_by_older_program: Vec<String>,
    /// Groups that were never diagnosed.
    pub groups_not_diagnosed: Vec<String>,
    /// Groups whose finding is out of date: runs, tags, base model or the library of effects changed since.
    pub findings_out_of_date: Vec<String>,
    /// Climate logs and what they come to.
    pub climate: ClimateStatus,
    /// Rows of run sheets, made and not.
    pub planned: Planned,
    /// Whether fitted runs need the distributed model, as far as their fits say.
    pub lumped_or_distributed: Vec<LumpedOrDistributedEntry>,
    /// Alarms of long-term monitoring.
    pub alarms: Vec<Alarm>,
    /// Alarms that were told of runs that were set aside later.
    pub alarms_taken_back: Vec<TakenBack>,
    /// Why nothing is watched; none where something is.
    pub monitoring: Option<String>,
    /// Why the report cannot be written anew: its folder holds what the program did not write.
    pub report_refused: Option<String>,
    /// What a fault of the program left out: of the report that stands, and of what is said here.
    pub faults: Vec<Fault>,
}

impl Status {
    /// Whether campaign.toml says something that is not understood: what somebody wanted is not done.
    pub fn has_slip(&self) -> bool {
        let is_slip = |issue: &Issue| [NOT_READ, UNKNOWN_KEY].contains(&&*issue.code);
        self.campaign_file.iter().any(is_slip)
    }
}

/// Climate logs and what they come to.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct ClimateStatus {
    /// Files that hold a log.
    pub logs: usize,
    /// Sensors with their quantities, comparisons, exposure of samples, problems found. Curves are left out.
    pub assessment: ClimateAssessment,
    /// Runs that a log covers.
    pub runs_covered: usize,
    /// Runs whose climate left the tolerance while they ran.
    pub runs_left_tolerance: Vec<String>,
    /// Runs whose label differs from what was measured.
    pub runs_label_differs: Vec<String>,
    /// Runs that no log covers although there are logs.
    pub runs_not_covered: Vec<String>,
    /// Runs of which no start, or only its day, is known: no log can be held against them.
    pub runs_without_start: Vec<String>,
}

/// Code of what is said of a run that only waits for its fit.
pub const WAITS: &str = "not-fitted-yet";

/// A file that holds the bytes of a run's file.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct AliasFile {
    /// Path relative to the campaign.
    pub path: String,
    /// The run.
    pub run: String,
}

/// A condition that nothing was measured in.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Gap {
    /// Material id.
    pub material: String,
    /// Environment id.
    pub environment: String,
    /// Nominal voltage, V, as tagged.
    pub voltage_v: String,
}

/// Reads the state of a campaign.
///
/// # Errors
/// The database cannot be read.
pub fn status(context: &Context) -> Result<Status, PipelineError> {
    let _moment = context.store.snapshot()?;
    // Read once: of ten thousand runs every reading takes half a second.
    let all = standing::all(context)?;
    let planned = planned(context, &all)?;
    let questions = witnesses::questions(&all, &context.campaign);
    let waiting = diagnose::waiting(context, all.clone())?;
    let found = findings_among(context, &all)?;
    let Runs {
        speaking: runs,
        set_aside,
    } = Runs::of(all);
    let (logs, logs_aside) = standing::modulus_logs(context)?;
    let spectra = standing::spectra(context)?;
    let files = context.store.files()?;
    let file_list = |state: FileState| {
        let of_state = files
            .iter()
            .filter(move |file| file.state == state && file.missing_since.is_none());
        of_state
            .map(|file| Reasoned {
                path: file.path.clone(),
                issues: file.issue.iter().cloned().collect(),
            })
            .collect::<Vec<_>>()
    };
    let mut runs_by_state = BTreeMap::new();
    for run in &runs {
        let state = if run.fit.is_some() {
            "fitted"
        } else {
            run.state.key()
        };
        *runs_by_state.entry(state).or_insert(0) += 1;
    }
    for run in &set_aside {
        *runs_by_state.entry(run.standing.key()).or_insert(0) += 1;
    }
    let mut modulus_logs_by_state = BTreeMap::new();
    for log in &logs {
        let state = match (&log.analysis, log.run.state) {
            (Some(_), _) => "analysed",
            (None, RunState::Untagged) => "untagged",
            (None, _) => "not_analysed",
        };
        *modulus_logs_by_state.entry(state).or_insert(0) += 1;
    }
    let not_analysed = logs.iter().filter(|log| log.analysis.is_none());
    let modulus_logs_not_analysed = not_analysed
        .map(|log| Reasoned {
            path: log.run.path.clone(),
            issues: log.run.issues.clone(),
        })
        .collect();
    let mut faults = report_faults(&context.folder);
    let watched = or_nothing(alarms::alarms(context, &runs, &found), &mut faults)?;
    let paired = paired(context)?;
    let untagged = reasoned(&runs, |run| run.state == RunState::Untagged);
    Ok(Status {
        proposed_pattern: proposed_pattern(context, untagged.iter().map(|run| run.path.as_str())),
        pairs: paired.pairs,
        lone_halves: paired.lone,
        questions,
        campaign: context.campaign.id.clone(),
        campaign_file: context.warnings.clone(),
        runs: runs.len() + set_aside.len(),
        runs_by_state,
        modulus_logs_by_state,
        modulus_logs_not_analysed,
        spectra: spectra.speaking.len(),
        spectra_untagged: reasoned(&spectra.speaking, |run| run.state == RunState::Untagged),
        untagged,
        not_fitted: without_fit(&runs),
        no_steps: reasoned(&runs, |run| run.state == RunState::NoSteps),
        undeclared_tags: undeclared_tags(context)?,
        fitted_without_response: with_issues(runs.iter().filter(|run| run.fit.is_some()), |issue| {
            issue.code == RESPONSE_MISSING
        }),
        without_humidity: without_humidity(&runs),
        readings_left_out: with_issues(
            (runs.iter())
                .chain(logs.iter().map(|log| &log.run))
                .chain(&spectra.speaking),
            says_no_number,
        ),
        set_aside: (set_aside.iter())
            .chain(logs_aside.iter().map(|log| &log.run))
            .chain(&spectra.set_aside)
            .map(SetAside::of)
            .collect(),
        names_contradict: with_issues(&runs, |issue| issue.code == NAMES_CONTRADICT),
        refused: [refused_profiles(context), file_list(FileState::Refused)].concat(),
        unread: unread(context)?,
        unreadable_tags: unreadable_tags(context)?,
        pending: file_list(FileState::Pending),
        raw_files_lost: raw_files_lost(context)?,
        words_missed: verify::missed(context)?,
        words_of_no_run: words_of_no_run(context)?,
        aliases: file_list(FileState::Alias).len(),
        alias_files: (runs.iter().chain(&set_aside)).flat_map(aliases_of).collect(),
        missing_files: context.store.gone_files()?.into_iter().collect(),
        groups_not_diagnosed: waiting.missing,
        findings_out_of_date: waiting.outdated,
        climate: climate(context, &runs)?,
        monitoring: watched.not_watched,
        alarms: watched.alarms,
        alarms_taken_back: alarms::taken_back(context, &set_aside)?,
        report_refused: not_ours(&context.folder)?,
        faults,
        planned,
        lumped_or_distributed: runs.iter().filter_map(LumpedOrDistributedEntry::of).collect(),
        gaps: gaps(context, &runs),
        fitted_by_older_program: runs
            .iter()
            .filter(|run| (run.fit_made_by.as_ref()).is_some_and(|made_by| made_by.version != CODE_VERSION))
            .map(|run| run.path.clone())
            .collect(),
    })
}

fn climate(context: &Context, runs: &[RunRecord]) -> Result<ClimateStatus, PipelineError> {
    let mut assessment = assess::stored(&context.store)?.unwrap_or_default();
    for sensor in &mut assessment.sensors {
        sensor.curve = Default::default();
    }
    let named = |wanted: &dyn Fn(&RunRecord) -> bool| -> Vec<String> {
        let found = runs.iter().filter(|run| wanted(run));
        found.map(|run| run.path.clone()).collect()
    };
    let with = |code: &str| named(&|run| run.issues.iter().any(|issue| issue.code == code));
    Ok(ClimateStatus {
        logs: context.store.logs()?.len(),
        assessment,
        runs_covered: named(&RunRecord::is_covered_by_log).len(),
        runs_left_tolerance: with("climate-left-tolerance"),
        runs_label_differs: named(&RunRecord::climate_label_differs),
        runs_not_covered: with("climate-not-covered"),
        runs_without_start: with("climate-no-start"),
    })
}

/// Fitted runs without a humidity, where other fitted runs state one.
fn without_humidity(runs: &[RunRecord]) -> Vec<String> {
    let fitted = runs.iter().filter(|run| run.fit.is_some());
    let (with, without): (Vec<&RunRecord>, Vec<&RunRecord>) =
        fitted.partition(|run| run.tag_number(keys::RELATIVE_HUMIDITY_PERCENT).is_some());
    if with.is_empty() {
        Vec::new()
    } else {
        without.into_iter().map(|run| run.path.clone()).collect()
    }
}

fn refused_profiles(context: &Context) -> Vec<Reasoned> {
    let refused = context.profiles.refused.iter();
    let reasoned = refused.map(|refused| Reasoned {
        path: refused.path.clone(),
        issues: vec![refused.issue()],
    });
    reasoned.collect()
}

fn unread(context: &Context) -> Result<Vec<Reasoned>, PipelineError> {
    let files = context.store.unread_files()?.into_iter();
    let reasoned = files.map(|(path, issue)| Reasoned {
        path,
        issues: vec![issue],
    });
    Ok(reasoned.collect())
}

fn reasoned(runs: &[RunRecord], wanted: impl Fn(&RunRecord) -> bool) -> Vec<Reasoned> {
    runs.iter()
        .filter(|run| wanted(run))
        .map(|run| Reasoned {
            path: run.path.clone(),
            issues: run.issues.clone(),
        })
        .collect()
}

/// Runs with issues that are wanted, each with these alone.
fn with_issues<'a>(
    runs: impl IntoIterator<Item = &'a RunRecord>,
    wanted: impl Fn(&Issue) -> bool,
) -> Vec<Reasoned> {
    let of = |run: &RunRecord| {
        let issues = run.issues.iter().filter(|issue| wanted(issue));
        let issues: Vec<Issue> = issues.cloned().collect();
        (!issues.is_empty()).then(|| Reasoned {
            path: run.path.clone(),
            issues,
        })
    };
    runs.into_iter().filter_map(of).collect()
}

/// Whether an issue says that cells of a column that is read hold no number.
fn says_no_number(issue: &Issue) -> bool {
    issue.severity > Severity::Note && [NOT_FINITE, TEXT_AMONG_NUMBERS].contains(&issue.code.as_str())
}

fn aliases_of(run: &RunRecord) -> impl Iterator<Item = AliasFile> {
    let aliases = run.files.iter().flat_map(|file| &file.aliases);
    aliases.map(|path| AliasFile {
        path: path.clone(),
        run: run.path.clone(),
    })
}

/// Runs without a fit: those that cannot have one, and those that wait for it, as diagnoses need no fits of single runs.
fn without_fit(runs: &[RunRecord]) -> Vec<Reasoned> {
    let of = |run: &RunRecord| {
        let mut issues = run.issues.clone();
        if run.state == RunState::Ready && !issues.iter().any(is_of_failed_fit) {
            let waits = Issue::note(WAITS, "it waits for its fit");
            issues.push(waits.mend("`ieap run` makes it"));
        }
        Reasoned {
            path: run.path.clone(),
            issues,
        }
    };
    let is_set_apart = |run: &RunRecord| matches!(run.state, RunState::Untagged | RunState::NoSteps);
    let wanted = |run: &&RunRecord| !is_set_apart(run) && run.fit.is_none();
    runs.iter().filter(wanted).map(of).collect()
}

fn gaps(context: &Context, runs: &[RunRecord]) -> Vec<Gap> {
    let condition = |run: &RunRecord| {
        if is_too_short(run) {
            return None;
        }
        let material = context.campaign.sample(run.tag(keys::SAMPLE)?)?.material.clone();
        Some((
            material,
            run.tag(keys::ENVIRONMENT)?.to_owned(),
            run.tag(keys::VOLTAGE_V)?.to_owned(),
        ))
    };
    let measured: BTreeSet<_> = runs.iter().filter_map(condition).collect();
    let axis = |pick: fn(&(String, String, String)) -> &String| -> BTreeSet<String> {
        measured.iter().map(|condition| pick(condition).clone()).collect()
    };
    let (materials, environments, voltages) = (axis(|c| &c.0), axis(|c| &c.1), axis(|c| &c.2));
    let mut gaps = Vec::new();
    for material in &materials {
        for environment in &environments {
            for voltage_v in &voltages {
                let condition = (material.clone(), environment.clone(), voltage_v.clone());
                if !measured.contains(&condition) {
                    let (material, environment, voltage_v) = condition;
                    gaps.push(Gap {
                        material,
                        environment,
                        voltage_v,
                    });
                }
            }
        }
    }
    gaps
}

/// What was said of measurements that are no run now.
fn words_of_no_run(context: &Context) -> Result<Vec<Issue>, PipelineError> {
    let found = context.store.words_of_no_run()?.into_iter();
    let issue = |(name, said): (String, Vec<String>)| {
        let message = format!(
            "the bytes that this was said of lie under no name any more, so that it holds of nothing: {}",
            said.join("; ")
        );
        Issue::warning("words-of-no-run", message)
            .at(&name)
            .mend("if the file that has the name now is the same measurement, say it again; if it is another one, all is right")
    };
    Ok(found.map(issue).collect())
}
