//! What campaign.toml says of long-term monitoring.

use super::check::Checker;
use super::error::CampaignFileError as Error;
use super::raw;
use ieap_domain::{Limit, MonitoringRules};

/// Fewest runs between false alarms that a chart can be set to.
const FEWEST_FALSE_ALARM_RUNS: f64 = 10.0;

impl Checker<'_> {
    /// The rules, with their defaults.
    pub(super) fn monitoring(&self, raw: raw::Monitoring) -> Result<MonitoringRules, Error> {
        let place = "[monitoring]";
        self.holds(
            raw.false_alarm_runs,
            place,
            "false_alarm_runs",
            "a number from 10 to 100000",
            |runs| (FEWEST_FALSE_ALARM_RUNS..=100_000.0).contains(&runs),
        )?;
        self.holds(
            raw.command_time_limit_s,
            place,
            "command_time_limit_s",
            "a number of seconds from 0.1 to 3600",
            |seconds| (0.1..=3600.0).contains(&seconds),
        )?;
        let limits: Result<Vec<Limit>, Error> =
            raw.limit.into_iter().map(|limit| self.limit(limit)).collect();
        let defaults = MonitoringRules::default();
        Ok(MonitoringRules {
            reference: raw
                .reference
                .into_iter()
                .map(|(key, value)| (key, value.text()))
                .collect(),
            false_alarm_runs: raw.false_alarm_runs.unwrap_or(defaults.false_alarm_runs),
            limits: limits?,
            command: raw.command,
            command_time_limit_s: raw.command_time_limit_s.unwrap_or(defaults.command_time_limit_s),
            acknowledged: raw.acknowledged,
        })
    }

    fn limit(&self, raw: raw::Limit) -> Result<Limit, Error> {
        let place = "[[monitoring.limit]]";
        let parameter = self.filled(raw.parameter, place, "parameter")?;
        let place = format!("{place} \"{parameter}\"");
        let finite = |value: f64| value.is_finite();
        self.holds(raw.below, &place, "below", "a number", finite)?;
        self.holds(raw.above, &place, "above", "a number", finite)?;
        if raw.below.is_some() == raw.above.is_some() {
            return Err(Error::BadLimit {
                path: self.path.into(),
                place,
                found: match raw.below {
                    Some(_) => "both below and above",
                    None => "neither below nor above",
                },
            });
        }
        Ok(Limit {
            parameter,
            material: raw.material,
            below: raw.below,
            above: raw.above,
        })
    }
}
