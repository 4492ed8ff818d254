//! When a limit is reached, with the date where the life of a sample is told in time.

use super::series::Reaches;
use super::{Monitoring, Watched, words};
use crate::laws::Covariate;
use crate::laws::words::symbol;
use crate::monitoring::fitted::Interval;
use crate::zone::{Zone, seconds};
use ieap_domain::number::significant;
use ieap_domain::tag::keys;
use ieap_domain::{Campaign, RunRecord};

/// A limit of a watched parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Forecast {
    /// `α of CNaf-1`.
    pub what: String,
    /// `below 0.8`.
    pub limit: String,
    /// `12 Mar 2027`, `age 530 h`, `already beyond it`, `cannot be told`.
    pub when: String,
    /// 95 % interval of that, or why it cannot be told.
    pub interval: String,
    /// Whether it is beyond or a date is known.
    pub is_told: bool,
    /// By which forecasts are put in order.
    order: f64,
}

impl Forecast {
    /// `α of CNaf-1, limit below 0.8: 12 Mar 2027 (3 Feb 2027 to 8 Jun 2027)`.
    pub fn sentence(&self) -> String {
        let within = if self.interval.is_empty() {
            String::new()
        } else {
            format!(" ({})", self.interval)
        };
        format!("{}, limit {}: {}{within}", self.what, self.limit, self.when)
    }
}

/// The clocks by which places on the axes of a campaign's samples are told.
#[derive(Debug, Clone)]
pub struct Dates<'a> {
    runs: &'a [RunRecord],
    zone: Zone,
}

/// Every limit, those that lie behind first, then those reached soonest.
pub fn forecasts(monitoring: &Monitoring, dates: &Dates) -> Vec<Forecast> {
    let watched = monitoring.watched.iter();
    let mut all: Vec<Forecast> = watched.filter_map(|watched| forecast(dates, watched)).collect();
    all.sort_by(|a, b| a.order.total_cmp(&b.order));
    all
}

fn forecast(dates: &Dates, watched: &Watched) -> Option<Forecast> {
    let (limit, reaches) = watched.limit.as_ref()?;
    let number = limit.below.or(limit.above)?;
    let side = if limit.below.is_some() { "below" } else { "above" };
    let (when, interval, is_told, order) = match reaches {
        Reaches::Beyond => (
            "already beyond it".to_owned(),
            String::new(),
            true,
            f64::NEG_INFINITY,
        ),
        Reaches::At(at) => (
            dates.moment(watched, at.value),
            dates.interval(watched, *at),
            true,
            at.value,
        ),
        Reaches::Unknown(why) => ("cannot be told".to_owned(), why.clone(), false, f64::INFINITY),
    };
    Some(Forecast {
        what: format!("{} of {}", symbol(&watched.parameter), watched.sample),
        limit: format!("{side} {}", significant(number, 3)),
        when,
        interval,
        is_told,
        order,
    })
}

impl<'a> Dates<'a> {
    /// Those of a campaign with these runs.
    pub fn of(campaign: &Campaign, runs: &'a [RunRecord]) -> Dates<'a> {
        let zone = Zone::of(campaign);
        Dates { runs, zone }
    }

    fn interval(&self, watched: &Watched, at: Interval) -> String {
        let said = |end: f64| self.moment(watched, end);
        match (at.low_95, at.high_95) {
            (Some(low), Some(high)) => format!("{} to {}", said(low), said(high)),
            (Some(low), None) => format!("{} or later", said(low)),
            (None, Some(high)) => format!("{} or earlier", said(high)),
            (None, None) => "not known".to_owned(),
        }
    }

    /// A place on the axis as a date, where the axis is time and the runs state when they started.
    pub fn moment(&self, watched: &Watched, at: f64) -> String {
        self.date(watched, at)
            .unwrap_or_else(|| words::place(watched, at))
    }

    fn date(&self, watched: &Watched, at: f64) -> Option<String> {
        let (first, x) = (watched.runs.first()?, watched.series.x.first()?);
        if watched.axis != Covariate::Age {
            return None;
        }
        let start_s = seconds(self.runs[*first].tag(keys::STARTED_AT)?)?;
        self.zone.day_of(start_s + 3600.0 * (at - x))
    }

    /// The day on which a run was started, after its name.
    pub fn run_and_day(&self, run: usize, campaign: &Campaign) -> String {
        let run = &self.runs[run];
        let day = run.tag(keys::STARTED_AT).map(|start| self.zone.day(start));
        let name = campaign.run_name(&run.path);
        day.map_or_else(|| name.to_owned(), |day| format!("{name}, {day}"))
    }
}
