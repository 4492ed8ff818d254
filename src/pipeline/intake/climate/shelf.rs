//! The series of the campaign's logs, read when they are needed; a bounded number of readings stays in memory.

use std::cell::RefCell;
use std::rc::Rc;

use jiff::tz::TimeZone;

use crate::analysis::climate::sensors::{Identity, correction, identity};
use crate::analysis::climate::{Clock, Window, on_utc};
use crate::domain::{Campaign, InputHash, Issue, LogSeries};
use crate::ingest::formats::climate::moments::offset_s;
use crate::pipeline::PipelineError;
use crate::store::Store;

/// Readings that stay in memory: eight years of minutes.
const MOST_READINGS: usize = 1 << 22;
/// A clock may be off UTC by that much, s: what a log covers is known to a day before it is read.
const CLOCK_MARGIN_S: f64 = 86_400.0;

/// Readings of a series on UTC, corrected.
#[derive(Debug)]
pub struct Loaded {
    /// Time of each reading, s since 1970 UTC, increasing.
    pub times_s: Vec<f64>,
    /// Readings with the stated correction.
    pub values: Vec<f64>,
    /// What the clock was taken for.
    pub clock: String,
    /// What to know of the clock.
    pub issues: Vec<Issue>,
}

/// The series of all current logs.
pub struct Shelf {
    /// Series, by path and order in the file.
    pub series: Vec<LogSeries>,
    loaded: RefCell<Vec<(usize, Rc<Loaded>)>>,
}

impl Shelf {
    /// Lists the series; nothing is read yet.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn open(store: &Store) -> Result<Shelf, PipelineError> {
        Ok(Shelf {
            series: store.log_series()?,
            loaded: RefCell::new(Vec::new()),
        })
    }

    /// Numbers of the series that may hold readings within `margin_s` of a window.
    pub fn near(&self, window: Window, margin_s: f64) -> impl Iterator<Item = usize> + '_ {
        let reach = margin_s + CLOCK_MARGIN_S;
        let overlaps = move |series: &LogSeries| {
            let start = series.clock_start_s + series.first_s;
            start <= window.to_s + reach && start + series.length_s >= window.from_s - reach
        };
        (0..self.series.len()).filter(move |&at| overlaps(&self.series[at]))
    }

    /// The sensor of a series.
    pub fn identity<'a>(&self, campaign: &'a Campaign, at: usize) -> Identity<'a> {
        identity(campaign, &self.series[at])
    }

    /// Readings of a series on UTC; none where its clock's zone is not known.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn load(
        &self,
        store: &Store,
        campaign: &Campaign,
        at: usize,
    ) -> Result<Option<Rc<Loaded>>, PipelineError> {
        let mut loaded = self.loaded.borrow_mut();
        if let Some(found) = loaded.iter().position(|(number, _)| *number == at) {
            let entry = loaded.remove(found);
            let readings = entry.1.clone();
            loaded.push(entry);
            return Ok(Some(readings));
        }
        let Some(fresh) = read(store, campaign, &self.series[at])? else {
            return Ok(None);
        };
        let fresh = Rc::new(fresh);
        loaded.push((at, fresh.clone()));
        let held =
            |loaded: &[(usize, Rc<Loaded>)]| loaded.iter().map(|(_, one)| one.values.len()).sum::<usize>();
        while loaded.len() > 1 && held(&loaded) > MOST_READINGS {
            loaded.remove(0);
        }
        Ok(Some(fresh))
    }

    /// A digest of the logs that may say something of a run, and whether there are any logs at all.
    pub fn digest(&self, window: Option<Window>) -> String {
        let mut hash = InputHash::new();
        hash.flag(self.series.is_empty()).flag(window.is_some());
        if let Some(window) = window {
            hash.number(window.from_s).number(window.to_s);
            let mut near: Vec<&LogSeries> = self
                .near(window, 2.0 * CLOCK_MARGIN_S)
                .map(|at| &self.series[at])
                .filter(|series| !series.quantity.is_of_probe())
                // A probe's readings speak for runs between them, however far.
                .chain(self.series.iter().filter(|series| series.quantity.is_of_probe()))
                .collect();
            near.sort_by_key(|series| (&series.path, series.ordinal));
            for series in near {
                hash.text(&series.path)
                    .text(&series.data_hash)
                    .whole(series.ordinal.into())
                    .flag(series.not_used.is_some());
            }
        }
        hash.finished()
    }
}

/// What is known of a series' clock.
pub fn clock_of(campaign: &Campaign, series: &LogSeries) -> Clock {
    let fixed = |offset: Option<&str>, stated_in| {
        let offset_s = offset_s(offset?)? as f64;
        Some(Clock::Fixed { offset_s, stated_in })
    };
    let statement = identity(campaign, series).statement;
    let zone = || {
        let zone = TimeZone::get(campaign.timezone.as_deref()?).ok()?;
        Some(Clock::Zone(zone))
    };
    // A sensor's statement is there to put a wrong clock right, so it stands above the file.
    fixed(
        statement.and_then(|stated| stated.utc_offset.as_deref()),
        "campaign.toml",
    )
    .or_else(|| fixed(series.clock_offset.as_deref(), "the file"))
    .or_else(zone)
    .unwrap_or(Clock::Unknown)
}

fn read(store: &Store, campaign: &Campaign, series: &LogSeries) -> Result<Option<Loaded>, PipelineError> {
    let clock = clock_of(campaign, series);
    if clock == Clock::Unknown {
        return Ok(None);
    }
    let readings = store.log_readings(series)?;
    let Some(on_utc) = on_utc(series, &readings.elapsed_s, &clock) else {
        return Ok(None);
    };
    let added = correction(identity(campaign, series).statement, series.quantity).unwrap_or(0.0);
    let (mut times_s, mut values) = (
        Vec::with_capacity(readings.values.len()),
        Vec::with_capacity(readings.values.len()),
    );
    let mut latest = f64::NEG_INFINITY;
    for (time, value) in on_utc.times_s.iter().zip(&readings.values) {
        // NaN marks what was left out; a clock that was set right may go back.
        if *time > latest {
            latest = *time;
            times_s.push(*time);
            values.push(value + added);
        }
    }
    Ok(Some(Loaded {
        times_s,
        values,
        clock: on_utc.words,
        issues: on_utc.issues,
    }))
}
