//! Alarms of long-term monitoring: found from the current fits, each told once.

use std::process::{Command, Stdio};

use super::context::now;
use super::fault::step;
use super::{Context, Observer, PipelineError, standing};
use crate::analysis::laws::CampaignLaws;
use crate::analysis::laws::facts::facts;
use crate::analysis::monitoring::{Monitoring, monitor};
use crate::domain::{Alarm, AlarmSign, Campaign};

/// The verb that `run` and `watch` end with.
#[derive(Debug, Clone, Copy, Default)]
pub struct RaiseAlarms;

/// What was told.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize)]
pub struct AlarmSummary {
    /// Messages of alarms that are new.
    pub new: Vec<String>,
    /// Alarms that stand and are not acknowledged, new ones counted.
    pub standing: usize,
    /// Commands that could not be run or ended badly, with the reason.
    pub failed_commands: Vec<String>,
}

/// Monitoring of a campaign as it is now, without what only questions across all runs can say.
///
/// # Errors
/// The database cannot be read, or a fault of the program stops it.
pub fn monitoring(context: &Context) -> Result<Monitoring, PipelineError> {
    let runs = standing::speaking(context)?;
    // The charge that passed is one axis among several and no alarm depends on it.
    let laws = || CampaignLaws {
        facts: facts(&runs, &context.campaign, &vec![None; runs.len()]),
        ..CampaignLaws::default()
    };
    step("monitoring", || Ok(monitor(&runs, &context.campaign, &laws())))
}

impl RaiseAlarms {
    /// Records every alarm that is new and then runs the campaign's command for it. A command that fails is told and
    /// not run again.
    ///
    /// # Errors
    /// The database fails.
    pub fn run(self, context: &mut Context, observer: &dyn Observer) -> Result<AlarmSummary, PipelineError> {
        let alarms = monitoring(context)?.alarms;
        let told = context.store.told_alarms()?;
        let standing: Vec<Alarm> = alarms.into_iter().filter(|alarm| !alarm.acknowledged).collect();
        let mut summary = AlarmSummary {
            standing: standing.len(),
            ..AlarmSummary::default()
        };
        // A change is told once, whichever of its signs came first then.
        let is_new = |alarm: &&Alarm| !alarm.shown_by.iter().any(|sign| told.contains(&sign.id));
        for alarm in standing.iter().filter(is_new) {
            context.store.save_alarm(&now(), alarm)?;
            observer.warn(&format!("alarm: {}", alarm.message));
            summary.new.push(alarm.message.clone());
            let Some(status) = tell(&context.campaign, &context.folder, alarm) else {
                continue;
            };
            if status != DONE {
                observer.warn(&format!("the command of [monitoring] {status}"));
                summary.failed_commands.push(status.clone());
            }
            context.store.save_alarm_command(&now(), &alarm.id, &status)?;
        }
        Ok(summary)
    }
}

/// A command that ended well.
const DONE: &str = "ended with 0";

/// Runs the campaign's command in its folder, and says how it ended; none where there is no command. Of its
/// output only stderr is shown: stdout is for results.
fn tell(campaign: &Campaign, folder: &std::path::Path, alarm: &Alarm) -> Option<String> {
    let (program, arguments) = campaign.monitoring.command.split_first()?;
    let listed = |of: fn(&AlarmSign) -> &String| {
        let mut names: Vec<&str> = Vec::new();
        for sign in &alarm.shown_by {
            if !names.contains(&of(sign).as_str()) {
                names.push(of(sign));
            }
        }
        names.join(" ")
    };
    let ended = Command::new(program)
        .args(arguments)
        .current_dir(folder)
        .env("IEAP_CAMPAIGN", &campaign.id)
        .env("IEAP_ALARM_ID", &alarm.id)
        .env("IEAP_ALARM_SAMPLE", &alarm.sample)
        .env("IEAP_ALARM_PARAMETER", &alarm.parameter)
        .env("IEAP_ALARM_CHART", &alarm.chart)
        .env("IEAP_ALARM_PARAMETERS", listed(|sign| &sign.parameter))
        .env("IEAP_ALARM_CHARTS", listed(|sign| &sign.chart))
        .env("IEAP_ALARM_RUN", &alarm.run)
        .env("IEAP_ALARM_MESSAGE", &alarm.message)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .status();
    Some(match ended {
        Ok(status) => match status.code() {
            Some(0) => DONE.to_owned(),
            Some(code) => format!("ended with {code}"),
            None => "was ended by a signal".to_owned(),
        },
        Err(error) => format!("could not be run ({program}: {error})"),
    })
}
