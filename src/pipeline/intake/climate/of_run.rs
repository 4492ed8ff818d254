//! What one run had of the climate, by its own columns and by the logs: statistics, tags, curves to draw, and what to know of it.

use std::ops::Range;

use super::asked::{Asked, margin};
use super::covering::{Covering, of_logs, of_own_columns};
use super::moisture::moisture;
use super::numbers::{five_digits, shown};
use super::probe::probe_of;
use super::remarks::{above_limit, differs, left_tolerance, no_start};
use super::shelf::Shelf;
use crate::analysis::climate::Window;
use crate::domain::climate::sensor_words;
use crate::domain::tag::keys;
use crate::domain::{ClimateCurve, ClimateQuantity, Issue, RunClimate, Tag, TagSource};
use crate::pipeline::{Context, PipelineError};

/// Version of what is computed here: another one makes stored tags out of date.
pub const VERSION: u32 = 3;

/// Points of a drawn curve before, during and behind a run, at most about.
const DRAWN: usize = 360;

/// The climate of a run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct OfRun {
    /// Statistics: the chosen sensors first.
    pub climate: Vec<RunClimate>,
    /// Curves to draw.
    pub curves: Vec<ClimateCurve>,
    /// Means as tags.
    pub tags: Vec<Tag>,
    /// What to know.
    pub issues: Vec<Issue>,
}

/// The climate of a run: what its own columns measured, then what the logs say.
///
/// # Errors
/// The database cannot be read.
pub fn climate_of(context: &Context, shelf: &Shelf, asked: Asked<'_>) -> Result<OfRun, PipelineError> {
    let mut of_run = OfRun::default();
    (of_run.tags, of_run.issues) = probe_of(context, shelf, asked.window, asked.sample)?;
    let rules = &context.campaign.climate;
    // Without a start its own columns still tell, on its own clock.
    let on_own_clock = |(first_s, last_s): (f64, f64)| Window {
        from_s: 0.0,
        to_s: last_s - first_s,
    };
    let Some(span) = asked.window.or(asked.times.map(on_own_clock)) else {
        return Ok(of_run);
    };
    let measured = measured(context, shelf, &asked, span, &mut of_run)?;
    let is_of_logs = |quantity| {
        let lacks = measured.iter().all(|(own, _)| *own != quantity);
        lacks && shelf.series.iter().any(|series| series.quantity == quantity)
    };
    if asked.window.is_none() && ClimateQuantity::MEASURED.into_iter().any(is_of_logs) {
        of_run.issues.extend(no_start(asked.start));
    }
    for (_, covering) in &measured {
        let chosen = &covering[0];
        let (found, series) = (&chosen.found, &chosen.series);
        of_run.issues.extend(left_tolerance(found, series, span, rules));
        of_run.issues.extend(above_limit(found, series, span, rules));
        of_run.issues.extend(differs(chosen, &covering[1..], rules));
        of_run.curves.push(curve(chosen, span));
    }
    // The chosen ones first, then what follows from them, then the other sensors.
    let follows = moisture(&measured, span, rules.longest_gap_s);
    let all = measured.into_iter().flat_map(|(_, covering)| covering);
    let (chosen, others): (Vec<RunClimate>, Vec<RunClimate>) =
        all.map(|covering| covering.found).partition(|found| found.chosen);
    of_run.climate = [chosen, follows, others].concat();
    Ok(of_run)
}

/// What measured each quantity all through the run, the one that speaks for it first; their means as tags, and why nothing
/// did.
fn measured(
    context: &Context,
    shelf: &Shelf,
    asked: &Asked<'_>,
    span: Window,
    of_run: &mut OfRun,
) -> Result<Vec<(ClimateQuantity, Vec<Covering>)>, PipelineError> {
    let rules = &context.campaign.climate;
    let mut measured: Vec<(ClimateQuantity, Vec<Covering>)> = Vec::new();
    for quantity in ClimateQuantity::MEASURED {
        let mut reasons = Vec::new();
        let mut covering = of_own_columns(asked, span, quantity, rules, &mut reasons);
        of_run
            .tags
            .extend(covering.first().and_then(|own| tag(&own.found)));
        if let Some(window) = asked.window {
            let said = (&mut reasons, &mut of_run.issues);
            let of_logs = of_logs(context, shelf, window, asked, quantity, said)?;
            of_run
                .tags
                .extend(of_logs.first().and_then(|log| tag(&log.found)));
            covering.extend(of_logs);
        }
        covering
            .iter_mut()
            .enumerate()
            .for_each(|(at, one)| one.found.chosen = at == 0);
        if covering.is_empty() {
            of_run.issues.extend(not_covered(quantity, &reasons));
        } else {
            measured.push((quantity, covering));
        }
    }
    Ok(measured)
}

/// Why nothing says what a run had of a quantity.
fn not_covered(quantity: ClimateQuantity, reasons: &[String]) -> Option<Issue> {
    let message = format!(
        "nothing covers the {} during the run: {}",
        quantity.label().to_lowercase(),
        reasons.join("; ")
    );
    let mend = "copy the log that covers the run into ambient/; nothing is extrapolated";
    let issue = Issue::note("climate-not-covered", message);
    (!reasons.is_empty()).then(|| issue.at(quantity.key()).mend(mend))
}

/// The mean as a tag, with what it rests on.
fn tag(found: &RunClimate) -> Option<Tag> {
    let key = match found.quantity {
        ClimateQuantity::RelativeHumidity => keys::RELATIVE_HUMIDITY_PERCENT,
        ClimateQuantity::Temperature => keys::TEMPERATURE_C,
        ClimateQuantity::Pressure => keys::PRESSURE_PA,
        ClimateQuantity::Oxygen => keys::OXYGEN_PPM,
        ClimateQuantity::Water => keys::WATER_PPM,
        _ => return None,
    };
    let unit = found.quantity.unit();
    let (source, sensor) = match found.own_name() {
        Some(column) => (TagSource::Column, column.to_owned()),
        None => (TagSource::Ambient, sensor_words(&found.sensor)),
    };
    let mut detail = match found.readings {
        0 => format!("{sensor}, between the readings before and after the run"),
        1 => format!("{sensor}, one reading"),
        n => format!("{sensor}, mean of {n} readings"),
    };
    if let Some(deviation) = found.standard_deviation {
        detail += &format!(", sd {} {unit}", shown(found.quantity, deviation));
    }
    if let Some(drift) = found.drift_per_h {
        let sign = if drift < 0.0 { "" } else { "+" };
        detail += &format!(", drift {sign}{} {unit}/h", shown(found.quantity, drift));
    }
    // The hundredth of a percent or a degree is beyond any sensor, as is the fifth digit of a gauge's reading.
    let value = if found.quantity.is_of_air() {
        (found.mean * 100.0).round() / 100.0
    } else {
        five_digits(found.mean)
    };
    Some(Tag {
        key: key.to_owned(),
        value: value.to_string(),
        source,
        detail,
    })
}

/// Readings around the run and, as closely, during it, thinned: least and greatest of each stretch. A diagnosis asks whether the strip
/// followed them.
fn curve(covering: &Covering, window: Window) -> ClimateCurve {
    let series = &covering.series;
    let from_s = |s: f64| series.times_s.partition_point(|&t| t < s);
    let begins = [
        from_s(window.from_s - margin(window)),
        from_s(window.from_s),
        from_s(window.to_s),
        series
            .times_s
            .partition_point(|&t| t <= window.to_s + margin(window)),
    ];
    let (mut time_s, mut values) = (Vec::new(), Vec::new());
    for part in begins.windows(2) {
        for at in thinned(&series.values, part[0]..part[1]) {
            time_s.push(series.times_s[at] - window.from_s);
            values.push(series.values[at]);
        }
    }
    ClimateCurve {
        sensor: covering.found.sensor.clone(),
        quantity: covering.found.quantity,
        time_s,
        values,
    }
}

/// Places of the least and the greatest value of each of at most half of [`DRAWN`] stretches.
fn thinned(values: &[f64], places: Range<usize>) -> Vec<usize> {
    let per = places.len().div_ceil(DRAWN / 2).max(1);
    let by_value = |a: &usize, b: &usize| values[*a].total_cmp(&values[*b]);
    let mut kept = Vec::new();
    for start in places.clone().step_by(per) {
        let stretch = start..(start + per).min(places.end);
        let mut ends: Vec<usize> = [stretch.clone().min_by(by_value), stretch.max_by(by_value)]
            .into_iter()
            .flatten()
            .collect();
        ends.sort_unstable();
        ends.dedup();
        kept.extend(ends);
    }
    kept
}
