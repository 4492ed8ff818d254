//! What one run had of the climate logs: statistics, tags, curves to draw, and what to know of it.

use super::gather::{Around, around, groups};
use super::probe::probe_of;
use super::shelf::Shelf;
use crate::analysis::climate::humid_air::{absolute_humidity_g_per_m3, dew_point_c, vapour_pressure_pa};
use crate::analysis::climate::join::{NoClimate, duration, interpolated, readings_in};
use crate::analysis::climate::sensors::accuracy;
use crate::analysis::climate::{Window, speaks_for, statistics};
use crate::domain::tag::keys;
use crate::domain::{ClimateCurve, ClimateQuantity, ClimateRules, Issue, RunClimate, Tag, TagSource};
use crate::pipeline::{Context, PipelineError};

/// Points of a drawn curve, at most about.
const DRAWN: usize = 360;
/// Least time drawn before and after a run, s.
const SURROUNDINGS_S: f64 = 3600.0;

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

/// A sensor that covers the run.
struct Covering {
    sensor: String,
    place: String,
    series: Around,
    found: RunClimate,
}

/// Joins a run with the logs; `surroundings` are its environment and sample.
///
/// # Errors
/// The database cannot be read.
pub fn climate_of(
    context: &Context,
    shelf: &Shelf,
    window: Option<Window>,
    surroundings: (Option<&str>, Option<&str>),
) -> Result<OfRun, PipelineError> {
    let mut of_run = OfRun::default();
    if shelf.series.is_empty() {
        return Ok(of_run);
    }
    (of_run.tags, of_run.issues) = probe_of(context, shelf, window, surroundings.1)?;
    if shelf.series.iter().all(|series| series.quantity.is_of_probe()) {
        return Ok(of_run);
    }
    let Some(window) = window else {
        let message = "there are climate logs, but nothing says when the run started";
        let mend = "tag the run with started_at = \"2026-11-20T10:00:00+02:00\"";
        of_run.issues.push(
            Issue::note("climate-no-start", message)
                .at(keys::STARTED_AT)
                .mend(mend),
        );
        return Ok(of_run);
    };
    let mut drawn: Vec<ClimateCurve> = Vec::new();
    for quantity in ClimateQuantity::MEASURED {
        let covering = covering(context, shelf, window, surroundings, quantity, &mut of_run.issues)?;
        let Some(chosen) = covering.first() else { continue };
        let rules = &context.campaign.climate;
        of_run.tags.extend(tag(&chosen.found));
        of_run
            .issues
            .extend(left_tolerance(&chosen.found, &chosen.series, window, rules));
        of_run
            .issues
            .extend(above_limit(&chosen.found, &chosen.series, window, rules));
        of_run.issues.extend(differs(chosen, &covering[1..], rules));
        drawn.push(curve(chosen, window));
        of_run
            .climate
            .extend(covering.into_iter().map(|covering| covering.found));
    }
    let measured = of_run.climate.len();
    of_run
        .climate
        .extend(moisture(context, shelf, window, &of_run.climate)?);
    // The chosen ones first, then what follows from them, then the other sensors.
    let mut order: Vec<(usize, RunClimate)> = of_run.climate.drain(..).enumerate().collect();
    order.sort_by_key(|(at, found)| (!found.chosen, *at >= measured, *at));
    of_run.climate = order.into_iter().map(|(_, found)| found).collect();
    of_run.curves = drawn;
    Ok(of_run)
}

/// The sensors that cover the run, the chosen one first; where none does, an issue says why.
fn covering(
    context: &Context,
    shelf: &Shelf,
    window: Window,
    (environment, sample): (Option<&str>, Option<&str>),
    quantity: ClimateQuantity,
    issues: &mut Vec<Issue>,
) -> Result<Vec<Covering>, PipelineError> {
    let campaign = &context.campaign;
    let longest_gap_s = campaign.climate.longest_gap_s;
    let near = shelf.near(window, longest_gap_s + SURROUNDINGS_S);
    let groups = groups(
        shelf,
        campaign,
        near.filter(|&at| shelf.series[at].quantity == quantity),
    );
    let mut found: Vec<Covering> = Vec::new();
    let mut reasons: Vec<String> = Vec::new();
    for numbers in groups.values() {
        let identity = shelf.identity(campaign, numbers[0]);
        let sensor = &identity.sensor;
        if !speaks_for(identity.statement, quantity, environment, sample) {
            continue;
        }
        let margin_s = margin(window).max(longest_gap_s);
        let Some(series) = around(&context.store, campaign, shelf, numbers, (window, margin_s))? else {
            reasons.push(format!("{sensor}: nothing states the time zone of its clock"));
            continue;
        };
        match statistics(
            (&series.times_s, &series.values),
            window,
            series.interval_s,
            longest_gap_s,
        ) {
            Ok(statistics) => {
                let accuracy = accuracy(identity.statement, quantity);
                found.push(Covering {
                    found: statistics.of_run(sensor, quantity, found.is_empty(), accuracy),
                    sensor: sensor.clone(),
                    place: identity.place.clone(),
                    series,
                });
            }
            Err(NoClimate::Empty) => {}
            Err(reason) => reasons.push(format!("the log of {sensor} {}", reason.words(longest_gap_s))),
        }
    }
    if found.is_empty() && !reasons.is_empty() {
        let message = format!(
            "no log covers the {} during the run: {}",
            quantity.label().to_lowercase(),
            reasons.join("; ")
        );
        let mend = "copy the log that covers the run into ambient/; nothing is extrapolated";
        issues.push(
            Issue::note("climate-not-covered", message)
                .at(quantity.key())
                .mend(mend),
        );
    }
    Ok(found)
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
    let mut detail = match found.readings {
        0 => format!(
            "sensor {}, between the readings before and after the run",
            found.sensor
        ),
        1 => format!("sensor {}, one reading", found.sensor),
        n => format!("sensor {}, mean of {n} readings", found.sensor),
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
        source: TagSource::Ambient,
        detail,
    })
}

/// A number of messages: hundredths of the air; pressures and traces, which span decades, to their digits.
fn shown(quantity: ClimateQuantity, value: f64) -> String {
    if quantity.is_of_air() {
        format!("{value:.2}")
    } else {
        five_digits(value).to_string()
    }
}

/// A number to five digits: more than a gauge or a probe has.
pub(super) fn five_digits(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    let scale = 10f64.powi(4 - value.abs().log10().floor() as i32);
    (value * scale).round() / scale
}

fn left_tolerance(
    found: &RunClimate,
    series: &Around,
    window: Window,
    rules: &ClimateRules,
) -> Option<Issue> {
    let tolerance = tolerance(found.quantity, rules, found.mean);
    if found.largest_deviation <= tolerance {
        return None;
    }
    let (first, end) = readings_in(&series.times_s, window);
    let outside = |at: &usize| (series.values[*at] - found.mean).abs() > tolerance;
    let at = (first..end).find(outside)?;
    let count = (first..end).filter(outside).count();
    let unit = found.quantity.unit();
    let message = format!(
        "the {} left the tolerance of ±{} {unit} while the run went on: {} {unit} from its mean of {} \
         {unit} at most, {count} of {} readings outside, the first {} after the start (sensor {})",
        found.quantity.label().to_lowercase(),
        five_digits(tolerance),
        shown(found.quantity, found.largest_deviation),
        shown(found.quantity, found.mean),
        found.readings,
        duration(series.times_s[at] - window.from_s),
        found.sensor
    );
    let mend = "repeat the run in a steady climate, or state the tolerance under [climate] in campaign.toml";
    Some(
        Issue::warning("climate-left-tolerance", message)
            .at(found.quantity.key())
            .mend(mend),
    )
}

/// Largest deviation that is allowed about a mean; traces of a gas have a limit and none.
fn tolerance(quantity: ClimateQuantity, rules: &ClimateRules, mean: f64) -> f64 {
    match quantity {
        ClimateQuantity::RelativeHumidity => rules.relative_humidity_tolerance_percent,
        ClimateQuantity::Pressure => rules.pressure_tolerance_percent / 100.0 * mean.abs(),
        ClimateQuantity::Oxygen | ClimateQuantity::Water => f64::INFINITY,
        _ => rules.temperature_tolerance_c,
    }
}

/// A trace of a gas above what campaign.toml allows while the run went on.
fn above_limit(found: &RunClimate, series: &Around, window: Window, rules: &ClimateRules) -> Option<Issue> {
    let limit = match found.quantity {
        ClimateQuantity::Oxygen => rules.oxygen_limit_ppm?,
        ClimateQuantity::Water => rules.water_limit_ppm?,
        _ => return None,
    };
    let (first, end) = readings_in(&series.times_s, window);
    let most = series.values[first..end]
        .iter()
        .copied()
        .fold(found.mean, f64::max);
    (most > limit).then(|| {
        let unit = found.quantity.unit();
        let message = format!(
            "the {} in the gas reached {} {unit} while the run went on, above the limit of {limit} {unit} (sensor {})",
            found.quantity.label().to_lowercase(),
            shown(found.quantity, most),
            found.sensor
        );
        Issue::warning("climate-above-limit", message)
            .at(found.quantity.key())
            .mend("repeat the run in a drier, purer gas, or state the limit under [climate] in campaign.toml")
    })
}

/// Sensors of one place that say other things of the run than the chosen one.
fn differs(chosen: &Covering, others: &[Covering], rules: &ClimateRules) -> Option<Issue> {
    let apart = |other: &Covering| (chosen.found.mean - other.found.mean).abs();
    let allowed = |other: &Covering| match (chosen.found.accuracy, other.found.accuracy) {
        (Some(a), Some(b)) => a.hypot(b),
        _ => tolerance(chosen.found.quantity, rules, chosen.found.mean),
    };
    let of_place = others.iter().filter(|other| other.place == chosen.place);
    let beyond: Vec<&Covering> = of_place.filter(|other| apart(other) > allowed(other)).collect();
    let worst = beyond.iter().max_by(|a, b| apart(a).total_cmp(&apart(b)))?;
    let unit = chosen.found.quantity.unit();
    let more = match beyond.len() {
        1 => String::new(),
        n => format!(" ({} more sensors differ)", n - 1),
    };
    let message = format!(
        "two sensors differ during the run: {} shows {} {unit} and {} {} {unit}{more}; the first is used",
        chosen.sensor,
        shown(chosen.found.quantity, chosen.found.mean),
        worst.sensor,
        shown(chosen.found.quantity, worst.found.mean)
    );
    Some(
        Issue::warning("climate-sensors-differ", message)
            .at(chosen.found.quantity.key())
            .mend("state under [[sensor]] in campaign.toml which one stands beside the sample, or its correction"),
    )
}

/// Dew point, vapour pressure and absolute humidity, reading by reading, from one sensor that has both.
fn moisture(
    context: &Context,
    shelf: &Shelf,
    window: Window,
    measured: &[RunClimate],
) -> Result<Vec<RunClimate>, PipelineError> {
    let chosen = |quantity| {
        measured
            .iter()
            .find(|found| found.quantity == quantity && found.chosen)
    };
    let Some(humidity) = chosen(ClimateQuantity::RelativeHumidity) else {
        return Ok(Vec::new());
    };
    let own = |found: &&RunClimate| {
        found.quantity == ClimateQuantity::Temperature && found.sensor == humidity.sensor
    };
    let Some(temperature) = measured.iter().find(own).or(chosen(ClimateQuantity::Temperature)) else {
        return Ok(Vec::new());
    };
    let series = |found: &RunClimate| {
        let campaign = &context.campaign;
        let of_sensor = |at: &usize| {
            shelf.series[*at].quantity == found.quantity
                && shelf.identity(campaign, *at).sensor == found.sensor
        };
        let near = shelf
            .near(window, campaign.climate.longest_gap_s)
            .filter(of_sensor);
        let groups = groups(shelf, campaign, near);
        let numbers = groups.into_values().next().unwrap_or_default();
        let margin_s = campaign.climate.longest_gap_s;
        around(&context.store, campaign, shelf, &numbers, (window, margin_s))
    };
    let (Some(rh), Some(t)) = (series(humidity)?, series(temperature)?) else {
        return Ok(Vec::new());
    };
    let longest_gap_s = context.campaign.climate.longest_gap_s;
    let air: Vec<(f64, f64, f64)> = rh
        .times_s
        .iter()
        .zip(&rh.values)
        .filter_map(|(&time, &percent)| {
            let temperature_c = interpolated(&t.times_s, &t.values, time, longest_gap_s)?;
            Some((time, temperature_c, vapour_pressure_pa(temperature_c, percent)))
        })
        .collect();
    let times_s: Vec<f64> = air.iter().map(|(time, _, _)| *time).collect();
    let sensor = if temperature.sensor == humidity.sensor {
        humidity.sensor.clone()
    } else {
        format!(
            "{} with the temperature of {}",
            humidity.sensor, temperature.sensor
        )
    };
    let mut found = Vec::new();
    for quantity in [
        ClimateQuantity::DewPoint,
        ClimateQuantity::VapourPressure,
        ClimateQuantity::AbsoluteHumidity,
    ] {
        let value = |(_, temperature_c, vapour_pa): &(f64, f64, f64)| match quantity {
            ClimateQuantity::DewPoint => dew_point_c(*vapour_pa),
            ClimateQuantity::VapourPressure => Some(*vapour_pa),
            _ => Some(absolute_humidity_g_per_m3(*temperature_c, *vapour_pa)),
        };
        // Air without water vapour, as a sensor at 0 % shows it, has no dew point.
        let Some(values) = air.iter().map(value).collect::<Option<Vec<f64>>>() else {
            continue;
        };
        if let Ok(statistics) = statistics((&times_s, &values), window, rh.interval_s, longest_gap_s) {
            found.push(statistics.of_run(&sensor, quantity, true, None));
        }
    }
    Ok(found)
}

fn margin(window: Window) -> f64 {
    (0.5 * (window.to_s - window.from_s)).max(SURROUNDINGS_S)
}

/// Readings around the run, thinned: least and greatest of each stretch.
fn curve(covering: &Covering, window: Window) -> ClimateCurve {
    let series = &covering.series;
    let from = series
        .times_s
        .partition_point(|&t| t < window.from_s - margin(window));
    let to = series
        .times_s
        .partition_point(|&t| t <= window.to_s + margin(window));
    let per = (to - from).div_ceil(DRAWN / 2).max(1);
    let (mut time_s, mut values) = (Vec::new(), Vec::new());
    for start in (from..to).step_by(per) {
        let stretch = start..(start + per).min(to);
        let by_value = |a: &usize, b: &usize| series.values[*a].total_cmp(&series.values[*b]);
        let mut kept: Vec<usize> = [stretch.clone().min_by(by_value), stretch.max_by(by_value)]
            .into_iter()
            .flatten()
            .collect();
        kept.sort_unstable();
        kept.dedup();
        for at in kept {
            time_s.push(series.times_s[at] - window.from_s);
            values.push(series.values[at]);
        }
    }
    ClimateCurve {
        sensor: covering.sensor.clone(),
        quantity: covering.found.quantity,
        time_s,
        values,
    }
}
