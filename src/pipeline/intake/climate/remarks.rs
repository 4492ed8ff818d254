//! What is to be known of the climate of one run: that it moved, rose above a limit, or that sensors differ.

use super::asked::Start;
use super::covering::{Covering, Place};
use super::gather::Around;
use super::numbers::{five_digits, shown};
use crate::analysis::climate::Window;
use crate::analysis::climate::join::readings_in;
use crate::domain::climate::sensor_words;
use crate::domain::number::seconds::duration;
use crate::domain::tag::keys;
use crate::domain::{ClimateQuantity, ClimateRules, Issue, RunClimate};

/// Why no log can be held against a run whose start is not known, where logs hold what it did not measure itself.
pub(super) fn no_start(start: Start) -> Option<Issue> {
    let why = match start {
        Start::Known => return None,
        Start::Day => "the start of the run is a day without a time",
        Start::NotUsable => "the start that is stated for the run cannot be used",
        Start::NotStated => "nothing says when the run started",
    };
    Some(
        Issue::note("climate-no-start", format!("there are climate logs, but {why}"))
            .at(keys::STARTED_AT)
            .mend("tag the run with started_at = \"2026-11-20T10:00:00+02:00\""),
    )
}

/// A reading within the run that lies farther from its mean than the tolerance.
pub(super) fn left_tolerance(
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
         {unit} at most, {count} of {} readings outside, the first {} after the start ({})",
        found.quantity.label().to_lowercase(),
        five_digits(tolerance),
        shown(found.quantity, found.largest_deviation),
        shown(found.quantity, found.mean),
        found.readings,
        duration(series.times_s[at] - window.from_s),
        sensor_words(&found.sensor)
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
pub(super) fn above_limit(
    found: &RunClimate,
    series: &Around,
    window: Window,
    rules: &ClimateRules,
) -> Option<Issue> {
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
            "the {} in the gas reached {} {unit} while the run went on, above the limit of {limit} {unit} ({})",
            found.quantity.label().to_lowercase(),
            shown(found.quantity, most),
            sensor_words(&found.sensor)
        );
        Issue::warning("climate-above-limit", message)
            .at(found.quantity.key())
            .mend("repeat the run in a drier, purer gas, or state the limit under [climate] in campaign.toml")
    })
}

/// Sensors of one place that say other things of the run than the chosen one.
pub(super) fn differs(chosen: &Covering, others: &[Covering], rules: &ClimateRules) -> Option<Issue> {
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
    let mend = if chosen.place == Place::Own {
        "state in the run's tags what holds"
    } else {
        "state under [[sensor]] in campaign.toml which one stands beside the sample, or its correction"
    };
    let message = format!(
        "two sensors differ during the run: {} shows {} {unit} and {} {} {unit}{more}; the first is used",
        chosen.found.sensor,
        shown(chosen.found.quantity, chosen.found.mean),
        worst.found.sensor,
        shown(chosen.found.quantity, worst.found.mean)
    );
    Some(
        Issue::warning("climate-sensors-differ", message)
            .at(chosen.found.quantity.key())
            .mend(mend),
    )
}
