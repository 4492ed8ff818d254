//! Sheets whose rows are each of a run.

use std::collections::BTreeMap;

use crate::conditions::{material, nominal_voltage_v};
use ieap_domain::Fit;
use ieap_domain::tag::keys;
use ieap_domain::{Campaign, RunRecord};
use ieap_show::quantities::{ENVIRONMENT, HUMIDITY, MATERIAL, Quantity, RUN, SAMPLE, VOLTAGE};
use ieap_show::{Printed, Sheet, Source, SourceOrigin, Value};

const TEMPERATURE: Quantity = Quantity::new("temperature_c", "T", "temperature", "°C");
const STARTED: Quantity = Quantity::plain("started_at", "Started", "start, in the campaign's time zone");

/// Runs of a campaign by row id: a table has a row or more of each.
pub struct ById<'a> {
    campaign: &'a Campaign,
    runs: BTreeMap<i64, &'a RunRecord>,
}

impl<'a> ById<'a> {
    /// These runs.
    pub fn new(campaign: &'a Campaign, runs: &'a [RunRecord]) -> ById<'a> {
        let runs = runs.iter().map(|run| (run.id, run)).collect();
        ById { campaign, runs }
    }

    /// The run of that row id.
    pub fn run(&self, id: i64, path: &'a str) -> OfRun<'a> {
        OfRun {
            campaign: Some(self.campaign),
            id,
            path,
            record: self.runs.get(&id).copied(),
        }
    }
}

/// The run that a row is of.
#[derive(Clone, Copy)]
pub struct OfRun<'a> {
    campaign: Option<&'a Campaign>,
    id: i64,
    path: &'a str,
    /// The run itself.
    pub record: Option<&'a RunRecord>,
}

impl<'a> OfRun<'a> {
    /// A run that is at hand.
    pub fn of(campaign: &'a Campaign, run: &'a RunRecord) -> OfRun<'a> {
        OfRun {
            campaign: Some(campaign),
            id: run.id,
            path: &run.path,
            record: Some(run),
        }
    }

    /// A run that no campaign holds.
    pub fn alone(path: &'a str) -> OfRun<'a> {
        OfRun {
            campaign: None,
            id: 0,
            path,
            record: None,
        }
    }

    /// Its path.
    pub fn path(&self) -> &'a str {
        self.path
    }

    /// It as the source of a row.
    pub fn sources(&self) -> Vec<Source> {
        vec![Source::of(SourceOrigin::Run(self.id), self.path)]
    }

    /// A tag as words.
    pub fn tag(&self, key: &str) -> Option<&'a str> {
        self.record.and_then(|run| run.tag(key))
    }

    /// A tag as a number.
    pub fn number(&self, key: &str) -> Option<f64> {
        self.record.and_then(|run| run.tag_number(key))
    }

    /// A measured tag: sensors are good to a few tenths at best, and a mean over a run has more digits than people need.
    pub fn measured(&self, key: &str) -> Option<Printed<f64>> {
        let number = self.number(key)?;
        Some(Printed(number, Value::Exact((10.0 * number).round() / 10.0)))
    }

    /// Its fit; none of a run that no result is made from, of which nothing is said.
    pub fn fit(&self) -> Option<&'a Fit> {
        let run = self.record.filter(|run| run.standing.speaks())?;
        run.fit.as_ref()
    }
}

/// Of a run, and what else a row is made from.
pub type Own<'a, X> = (OfRun<'a>, X);

/// A sheet whose first column names the run.
pub fn of_runs<'s, 'a: 's, X: 's>(
    name: &'static str,
    title: &'static str,
    stub: usize,
) -> Sheet<'s, Own<'a, X>> {
    Sheet::new(name, title, stub)
        .made_from(|(run, _): &Own<X>| run.sources())
        .column(RUN, |(run, _)| run.path)
}

/// The same with sample, material and environment.
pub fn of_runs_and_what<'s, 'a: 's, X: 's>(name: &'static str, title: &'static str) -> Sheet<'s, Own<'a, X>> {
    let material_of = |run: &OfRun<'a>| material(run.record?, run.campaign?);
    of_runs(name, title, 1)
        .column(SAMPLE, |(run, _)| run.tag(keys::SAMPLE))
        .column(MATERIAL, move |(run, _)| material_of(run))
        .column(ENVIRONMENT, |(run, _)| run.tag(keys::ENVIRONMENT))
}

/// The same with what the run was measured under.
pub fn of_runs_and_conditions<'s, 'a: 's, X: 's>(
    name: &'static str,
    title: &'static str,
    zone: Option<&'s str>,
) -> Sheet<'s, Own<'a, X>> {
    of_runs_and_what(name, title)
        .in_files(|sheet| sheet.plain("revision", |(run, _): &Own<X>| Some(run.record?.revision)))
        .column(HUMIDITY, |(run, _)| run.measured(keys::RELATIVE_HUMIDITY_PERCENT))
        .column(TEMPERATURE, |(run, _)| run.measured(keys::TEMPERATURE_C))
        .column(VOLTAGE, |(run, _)| nominal_voltage_v(run.record?))
        .column(STARTED, move |(run, _)| {
            let stated = run.tag(keys::STARTED_AT)?;
            Some(Printed(stated, Value::from(started(stated, zone))))
        })
}

/// `2026-03-02 10:00 +02:00` in the campaign's zone; a text that is no time stays as it is.
fn started(stated: &str, zone: Option<&str>) -> String {
    let Ok(moment) = stated.parse::<jiff::Timestamp>() else {
        return stated.to_owned();
    };
    let zone = zone.and_then(|name| jiff::tz::TimeZone::get(name).ok());
    let local = moment.to_zoned(zone.unwrap_or(jiff::tz::TimeZone::UTC));
    local.strftime("%Y-%m-%d %H:%M %:z").to_string()
}

#[cfg(test)]
mod tests {
    use super::started;

    #[test]
    fn a_start_is_shown_with_its_zone_on_both_sides_of_a_clock_change() {
        let tallinn = Some("Europe/Tallinn");
        assert_eq!(
            started("2026-03-02T08:00:00Z", tallinn),
            "2026-03-02 10:00 +02:00"
        );
        assert_eq!(
            started("2026-07-02T08:00:00Z", tallinn),
            "2026-07-02 11:00 +03:00"
        );
        assert_eq!(started("2026-07-02T08:00:00Z", None), "2026-07-02 08:00 +00:00");
        assert_eq!(started("yesterday", tallinn), "yesterday");
    }
}
