//! Alarms of long-term monitoring: found from the current fits, each told once, and none because of readings that the
//! diagnosis of their group is about to condemn.

use std::collections::BTreeSet;
use std::path::Path;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::current::{CurrentFindings, findings_among};
use super::diagnose::condemned_ahead;
use crate::analysis::laws::doubt::{Doubts, Findings};
use crate::analysis::laws::facts::facts;
use crate::analysis::monitoring::{Evidence, Monitoring, monitor};
use crate::domain::tag::keys;
use crate::domain::{Alarm, AlarmSign, Campaign, InputHash, RunRecord};
use crate::numerics::interrupt;
use crate::pipeline::campaign::context::{CODE_VERSION, PROGRAM, now};
use crate::pipeline::campaign::standing::{self, Runs, SetAside};
use crate::pipeline::infra::allowed::AllowedCommands;
use crate::pipeline::infra::command::{self, Ended};
use crate::pipeline::infra::fault::step;
use crate::pipeline::{Context, DiagnoseChoice, Observer, PipelineError};
use crate::store::{NewResult, ResultDocument, ResultKind, StoredResult, Subject};

/// The verb that `run` and `watch` end with.
#[derive(Debug, Clone, Default)]
pub struct RaiseAlarms {
    /// The diagnosis that follows, if one does: a new alarm waits until it is known which runs of its series that will
    /// condemn, and for no more of it.
    pub diagnosis: Option<DiagnoseChoice>,
    /// Which commands may be run here; another one is said not to have been.
    pub commands: AllowedCommands,
}

/// What was told.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
pub struct AlarmSummary {
    /// Messages of alarms that are new.
    pub new: Vec<String>,
    /// Alarms that stand and are not acknowledged, new ones counted.
    pub standing: usize,
    /// Commands that were not or could not be run or ended badly, with the reason.
    pub failed_commands: Vec<String>,
}

/// What monitoring of these runs, which speak, comes to.
pub(crate) fn watched(
    context: &Context,
    runs: &[RunRecord],
    doubts: &Doubts,
) -> Result<Monitoring, PipelineError> {
    let facts = || facts(runs, &context.campaign);
    let found = || {
        monitor(Evidence {
            runs,
            campaign: &context.campaign,
            facts: &facts(),
            doubts,
        })
    };
    step("monitoring", || Ok(found()))
}

/// What the current findings say against the fits of these runs.
fn doubts(found: &CurrentFindings, runs: &[RunRecord]) -> Doubts {
    let findings = Findings {
        groups: &found.groups,
        runs: &found.runs,
    };
    Doubts::new(findings, runs)
}

/// The alarms of a campaign. They are stored with what they depend on, for who only asks for them.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Alarms {
    /// All of them, whether known or not.
    pub alarms: Vec<Alarm>,
    /// Why nothing is watched; none where something is.
    pub not_watched: Option<String>,
}

impl ResultDocument for Alarms {}

impl From<Monitoring> for Alarms {
    fn from(found: Monitoring) -> Alarms {
        Alarms {
            alarms: found.alarms,
            not_watched: found.reference.is_none().then_some(found.why_not),
        }
    }
}

/// Version of how alarms are found: 2 brings seasons by what the runs of a strip tell, and holds what findings say of fits; 3 hangs
/// on the tags that are read alone.
const VERSION: &str = "alarms/3";
/// Name of the one result of this kind.
const OF: &str = "the campaign";

/// The alarms of these runs, which speak and of which a diagnosis found this: as they are stored, or found anew where that was
/// made of something else.
///
/// # Errors
/// The database cannot be read, or a fault of the program stops the monitoring.
pub fn alarms(
    context: &Context,
    runs: &[RunRecord],
    found: &CurrentFindings,
) -> Result<Alarms, PipelineError> {
    alarms_in_doubt(context, runs, &doubts(found, runs))
}

fn alarms_in_doubt(context: &Context, runs: &[RunRecord], doubts: &Doubts) -> Result<Alarms, PipelineError> {
    let stored = context.store.result::<Alarms>(ResultKind::Alarms, OF)?;
    let key = key(context, runs, doubts)?;
    match stored.filter(|stored| stored.origin.key == key) {
        Some(StoredResult { found: Ok(found), .. }) => Ok(found),
        _ => Ok(watched(context, runs, doubts)?.into()),
    }
}

/// Hash of everything that alarms of these runs depend on: their fits, which carry hashes already, what findings say against
/// these, the facts of each run, and those of its tags that choose the reference condition or say when it was made.
fn key(context: &Context, runs: &[RunRecord], doubts: &Doubts) -> Result<String, PipelineError> {
    let campaign = &context.campaign;
    let mut hash = InputHash::new();
    hash.text(VERSION)
        .text(CODE_VERSION)
        .text(&context.campaign_digest);
    hash.text(&context.store.state_of_all_fits()?);
    let reference = campaign.monitoring.reference.iter().map(|(key, _)| key.as_str());
    let read: Vec<&str> = reference.chain([keys::STARTED_AT]).collect();
    for run in runs {
        hash.text(&run.path).text(&format!("{:?}", doubts.of(&run.path)));
        for key in &read {
            hash.text_or_none(run.tag(key));
        }
    }
    for fact in facts(runs, campaign) {
        hash.text(&format!("{fact:?}"));
    }
    Ok(hash.finished())
}

/// An alarm that was told and is taken back, because its run was set aside later.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
pub struct TakenBack {
    /// Id of the alarm.
    pub id: String,
    /// What it said.
    pub message: String,
    /// Its run, and why no result is made from that.
    pub set_aside: SetAside,
}

/// The alarms that were told of runs that are among `set_aside` now.
///
/// # Errors
/// The database cannot be read.
pub fn taken_back(context: &Context, set_aside: &[RunRecord]) -> Result<Vec<TakenBack>, PipelineError> {
    let told = context.store.told_of_runs()?.into_iter();
    let of_one = |[id, run, message]: [String; 3]| {
        let run = set_aside.iter().find(|aside| aside.path == run)?;
        let set_aside = SetAside::of(run);
        Some(TakenBack {
            id,
            message,
            set_aside,
        })
    };
    Ok(told.filter_map(of_one).collect())
}

impl RaiseAlarms {
    /// Records every alarm that is new and then runs the campaign's command for it, where that was allowed. A command that
    /// fails or was not allowed is told and not run later.
    ///
    /// # Errors
    /// The database fails.
    pub fn run(&self, context: &mut Context, observer: &dyn Observer) -> Result<AlarmSummary, PipelineError> {
        let told = context.store.told_alarms()?;
        // A change is told once, whichever of its signs came first then.
        let is_new = |alarm: &&Alarm| !alarm.shown_by.iter().any(|sign| told.contains(&sign.id));
        let (runs, doubts, found) = self.watched(context, &is_new)?;
        keep(context, &key(context, &runs, &doubts)?, &found)?;
        let open = |alarm: &&Alarm| !alarm.acknowledged;
        let standing: Vec<&Alarm> = found.alarms.iter().filter(open).collect();
        let mut summary = AlarmSummary {
            standing: standing.len(),
            ..AlarmSummary::default()
        };
        for alarm in standing.into_iter().filter(is_new) {
            context.store.save_alarm(&now(), alarm)?;
            observer.warn(&format!("alarm: {}", alarm.message));
            summary.new.push(alarm.message.clone());
            let Some(ended) = tell(&context.campaign, &context.folder, alarm, &self.commands) else {
                continue;
            };
            let words = ended.words(&context.campaign.monitoring.command);
            if !ended.is_well() {
                observer.warn(&format!("the command of [monitoring] {words}"));
                summary.failed_commands.push(words.clone());
            }
            context.store.save_alarm_command(&now(), &alarm.id, &words)?;
            interrupt::check();
        }
        Ok(summary)
    }

    /// Runs that are watched, and their alarms. Where one is new they are without the runs that diagnoses will condemn.
    fn watched(
        &self,
        context: &Context,
        is_new: &dyn Fn(&&Alarm) -> bool,
    ) -> Result<(Vec<RunRecord>, Doubts, Alarms), PipelineError> {
        let all = standing::all(context)?;
        let findings = findings_among(context, &all)?;
        let runs = Runs::of(all).speaking;
        let doubted = doubts(&findings, &runs);
        let found = alarms_in_doubt(context, &runs, &doubted)?;
        let open = |alarm: &&Alarm| !alarm.acknowledged;
        let new = found.alarms.iter().filter(open).filter(is_new);
        let samples: BTreeSet<&str> = new.map(|alarm| alarm.sample.as_str()).collect();
        if let Some(choice) = self.diagnosis.as_ref().filter(|_| !samples.is_empty()) {
            let watched = watched(context, &runs, &doubted)?.watched.into_iter();
            let of_new = watched.filter(|one| samples.contains(one.sample.as_str()));
            let asked = of_new.flat_map(|one| one.runs).map(|run| runs[run].path.clone());
            let ahead = condemned_ahead(context, choice, &asked.collect())?;
            if !ahead.is_empty() {
                let runs = standing::speaking_without(context, ahead)?;
                let doubted = doubts(&findings, &runs);
                let found = alarms_in_doubt(context, &runs, &doubted)?;
                return Ok((runs, doubted, found));
            }
        }
        Ok((runs, doubted, found))
    }
}

/// Stores alarms, where they are not stored as made of that.
fn keep(context: &mut Context, key: &str, found: &Alarms) -> Result<(), PipelineError> {
    if context
        .store
        .result_keys(ResultKind::Alarms)?
        .get(OF)
        .is_some_and(|known| known == key)
    {
        return Ok(());
    }
    let result = NewResult {
        of: Subject::Named(OF),
        // Which runs are watched is in the key, by which they are looked at again.
        made_from: &[],
        key,
        made_by: &PROGRAM,
        found: Ok(found),
    };
    context
        .store
        .keep_results(&now(), ResultKind::Alarms, &[result])?;
    Ok(())
}

/// Runs the campaign's command in its folder, where it was allowed, and says how it ended; none where there is no command.
fn tell(campaign: &Campaign, folder: &Path, alarm: &Alarm, commands: &AllowedCommands) -> Option<Ended> {
    let rules = &campaign.monitoring;
    if rules.command.is_empty() {
        return None;
    }
    match commands.has(folder, &rules.command) {
        Ok(true) => {}
        Ok(false) => return Some(Ended::NotAllowed),
        Err(error) => {
            return Some(Ended::NotRun(format!(
                "whether it is allowed cannot be read: {error}"
            )));
        }
    }
    let listed = |of: fn(&AlarmSign) -> &String| {
        let mut names: Vec<&str> = Vec::new();
        for sign in &alarm.shown_by {
            if !names.contains(&of(sign).as_str()) {
                names.push(of(sign));
            }
        }
        names.join(" ")
    };
    let (parameters, charts) = (listed(|sign| &sign.parameter), listed(|sign| &sign.chart));
    let variables = [
        ("IEAP_CAMPAIGN", campaign.id.as_str()),
        ("IEAP_ALARM_ID", alarm.id.as_str()),
        ("IEAP_ALARM_SAMPLE", alarm.sample.as_str()),
        ("IEAP_ALARM_PARAMETER", alarm.parameter.as_str()),
        ("IEAP_ALARM_CHART", alarm.chart.as_str()),
        ("IEAP_ALARM_PARAMETERS", parameters.as_str()),
        ("IEAP_ALARM_CHARTS", charts.as_str()),
        ("IEAP_ALARM_RUN", alarm.run.as_str()),
        ("IEAP_ALARM_MESSAGE", alarm.message.as_str()),
    ];
    let limit = Duration::from_secs_f64(rules.command_time_limit_s);
    Some(command::run(&rules.command, folder, &variables, limit))
}
