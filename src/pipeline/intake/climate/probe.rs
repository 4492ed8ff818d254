//! The readings of a four-point probe, by sample, and what a run had of them.

use std::collections::BTreeMap;

use super::numbers::five_digits;
use super::shelf::Shelf;
use crate::analysis::climate::Window;
use crate::analysis::probe::{Course, ProbeReading, ProbeSeries, at_run, course};
use crate::domain::tag::keys;
use crate::domain::{ClimateQuantity, Issue, Tag, TagSource};
use crate::pipeline::{Context, PipelineError};

/// Tags and issues of a run.
pub type OfProbe = (Vec<Tag>, Vec<Issue>);

/// The course of every sample's electrodes. Nothing of it is stored: it follows from the readings whenever it is read.
///
/// # Errors
/// The database cannot be read.
pub fn electrode_courses(context: &Context) -> Result<Vec<Course>, PipelineError> {
    let shelf = Shelf::open(&context.store)?;
    let all = probe_series(context, &shelf)?;
    Ok(all
        .into_iter()
        .filter(|series| !series.readings.is_empty())
        .map(course)
        .collect())
}

/// The readings of every sample that a probe table names, by sample and date. A table whose clock's zone is not
/// known says nothing.
///
/// # Errors
/// The database cannot be read.
fn probe_series(context: &Context, shelf: &Shelf) -> Result<Vec<ProbeSeries>, PipelineError> {
    let of_samples = |at: &usize| shelf.series[*at].quantity == ClimateQuantity::ElectrodeResistance;
    let mut samples: BTreeMap<&str, Vec<ProbeReading>> = BTreeMap::new();
    for at in (0..shelf.series.len()).filter(of_samples) {
        let sample = shelf.series[at].sensor.as_str();
        let own = readings(context, shelf, at)?;
        samples.entry(sample).or_default().extend(own);
    }
    let series = samples.into_iter().map(|(sample, mut readings)| {
        readings.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
        // Of two files with one moment the first holds.
        readings.dedup_by(|a, b| a.at_s == b.at_s);
        ProbeSeries {
            sample: sample.to_owned(),
            readings,
        }
    });
    Ok(series.collect())
}

/// The readings of one series of resistances, with what its file says beside them.
fn readings(context: &Context, shelf: &Shelf, at: usize) -> Result<Vec<ProbeReading>, PipelineError> {
    let own = &shelf.series[at];
    let Some(resistance) = shelf.load(&context.store, &context.campaign, at)? else {
        return Ok(Vec::new());
    };
    let beside = |quantity: ClimateQuantity| -> Result<BTreeMap<i64, f64>, PipelineError> {
        let found = (0..shelf.series.len()).find(|&other| {
            let series = &shelf.series[other];
            (series.log_id, series.quantity) == (own.log_id, quantity) && series.sensor == own.sensor
        });
        let loaded = match found {
            Some(at) => shelf.load(&context.store, &context.campaign, at)?,
            None => None,
        };
        let pairs = loaded
            .iter()
            .flat_map(|loaded| loaded.times_s.iter().zip(&loaded.values));
        Ok(pairs.map(|(time, value)| (*time as i64, *value)).collect())
    };
    let errors = beside(ClimateQuantity::ElectrodeResistanceError)?;
    let flexings = beside(ClimateQuantity::Flexings)?;
    let humidities = beside(ClimateQuantity::ProbeHumidity)?;
    let reading = |(time, value): (&f64, &f64)| {
        let moment = *time as i64;
        ProbeReading {
            at_s: *time,
            ohm_per_sq: *value,
            error_ohm_per_sq: errors.get(&moment).copied(),
            flexings: flexings.get(&moment).copied(),
            humidity_percent: humidities.get(&moment).copied(),
        }
    };
    Ok(resistance
        .times_s
        .iter()
        .zip(&resistance.values)
        .map(reading)
        .collect())
}

/// What a run of that sample had, as tags.
///
/// # Errors
/// The database cannot be read.
pub fn probe_of(
    context: &Context,
    shelf: &Shelf,
    window: Option<Window>,
    sample: Option<&str>,
) -> Result<OfProbe, PipelineError> {
    let is_of_sample = |own: &crate::domain::LogSeries| {
        own.quantity == ClimateQuantity::ElectrodeResistance && Some(own.sensor.as_str()) == sample
    };
    if !shelf.series.iter().any(is_of_sample) {
        return Ok((Vec::new(), Vec::new()));
    }
    let all = probe_series(context, shelf)?;
    let Some(series) = all.iter().find(|series| Some(series.sample.as_str()) == sample) else {
        return Ok((Vec::new(), Vec::new()));
    };
    let not_covered = |why: String, mend: &str| {
        let issue = Issue::note(
            "probe-not-covered",
            format!("the electrode resistance is not known here: {why}"),
        );
        (Vec::new(), vec![issue.at(keys::ELECTRODE_RESISTANCE).mend(mend)])
    };
    let Some(window) = window else {
        return Ok(not_covered(
            "there are readings of the probe, but nothing says at what time the run started".to_owned(),
            "tag the run with started_at = \"2026-11-20T10:00:00+02:00\"",
        ));
    };
    Ok(match at_run(&series.readings, window.from_s) {
        Err(why) => not_covered(
            why,
            "measure the electrodes before and after the run, and add the rows to the table in probe/",
        ),
        Ok(found) => {
            let tag = |key: &str, value: f64| Tag {
                key: key.to_owned(),
                value: five_digits(value).to_string(),
                source: TagSource::Probe,
                detail: found.rests_on.clone(),
            };
            let more = [
                (keys::ELECTRODE_RESISTANCE_ERROR, found.error_ohm_per_sq),
                (keys::FLEXINGS, found.flexings),
            ];
            let more = more.into_iter().filter_map(|(key, value)| Some(tag(key, value?)));
            let tags = std::iter::once(tag(keys::ELECTRODE_RESISTANCE, found.ohm_per_sq)).chain(more);
            (tags.collect(), Vec::new())
        }
    })
}
