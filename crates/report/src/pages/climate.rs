//! The climate page: logs over time, sensors and how they compare, exposure of the samples, problems found.

use ieap_domain::words::counted;
use std::collections::BTreeMap;

use serde::Serialize;

use super::Content;
use super::wording::{IssueText, RunLink};
use crate::error::ReportError;
use crate::figures::Ink;
use crate::figures::climate::{Drawn, overview};
use crate::site::Site;
use ieap_analysis::zone::Zone;
use ieap_domain::number::seconds::seconds;
use ieap_domain::number::{fixed, significant};
use ieap_domain::tag::keys;
use ieap_domain::{ClimateQuantity, Exposure, RunRecord, SensorPair, SensorSummary};

#[derive(Debug, Serialize)]
struct ClimatePage {
    /// Of all moments on the page.
    zone: String,
    summary: Vec<String>,
    figures: Vec<Overview>,
    sensors: Vec<SensorRow>,
    pairs: Vec<PairRow>,
    exposures: Vec<ExposureRow>,
    flagged: Vec<Flagged>,
    issues: Vec<IssueText>,
    rules: String,
}

#[derive(Debug, Serialize)]
struct Overview {
    heading: String,
    figure: String,
    legend: Vec<(String, String)>,
    more: String,
}

#[derive(Debug, Serialize)]
struct SensorRow {
    sensor: String,
    quantity: String,
    readings: String,
    span: String,
    interval: String,
    range: String,
    clock: String,
    stated: String,
    not_used: String,
}

#[derive(Debug, Serialize)]
struct PairRow {
    pair: String,
    quantity: String,
    hours: String,
    bias: String,
    standard_deviation: String,
    allowed: String,
    clock: String,
    beyond: bool,
}

#[derive(Debug, Serialize)]
struct ExposureRow {
    sample: String,
    span: String,
    sensor: String,
    above: String,
    covered: String,
    uncovered: String,
    elsewhere: String,
}

#[derive(Debug, Serialize)]
struct Flagged {
    link: RunLink,
    messages: Vec<String>,
}

/// Issues of runs that the page lists.
const RUN_ISSUES: [&str; 4] = [
    "climate-left-tolerance",
    "climate-above-limit",
    "climate-sensors-differ",
    "tag-disagreement",
];

/// Makes the page.
pub fn content(site: &Site) -> Result<Content, ReportError> {
    let climate = &site.input.climate;
    let mut figures = BTreeMap::new();
    let mut overviews = Vec::new();
    for quantity in ClimateQuantity::MEASURED {
        overviews.extend(drawn(site, quantity, &mut figures)?);
    }
    let rules = &site.input.campaign.climate;
    let zone = site.zone();
    let page = ClimatePage {
        zone: zone.name().to_owned(),
        summary: summary(site),
        figures: overviews,
        sensors: climate.sensors.iter().map(|one| sensor(one, &zone)).collect(),
        pairs: climate.pairs.iter().map(pair).collect(),
        exposures: climate.exposures.iter().map(|one| exposure(one, &zone)).collect(),
        flagged: flagged(site),
        issues: climate.issues.iter().map(IssueText::from).collect(),
        rules: format!(
            "A run is flagged where a reading lies more than {} % of humidity or {} °C from its mean; a run has a value \
             only where no two neighbouring readings lie more than {} min apart; hours above {} % count as exposure.",
            rules.relative_humidity_tolerance_percent,
            rules.temperature_tolerance_c,
            fixed(rules.longest_gap_s / 60.0, 0),
            rules.exposure_above_percent
        ) + &chamber_rules(site),
    };
    Content::new("climate.html", &page, figures)
}

/// The rules of what is measured in chambers, where anything is.
fn chamber_rules(site: &Site) -> String {
    let rules = &site.input.campaign.climate;
    let measured = |quantity| {
        site.input
            .climate
            .sensors
            .iter()
            .any(|one| one.quantity == quantity)
    };
    let mut said = String::new();
    if measured(ClimateQuantity::Pressure) {
        said += &format!(
            " Of a pressure {} % of its mean are allowed.",
            rules.pressure_tolerance_percent
        );
    }
    for (quantity, limit) in [
        (ClimateQuantity::Oxygen, rules.oxygen_limit_ppm),
        (ClimateQuantity::Water, rules.water_limit_ppm),
    ] {
        if measured(quantity) {
            said += &match limit {
                Some(limit) => format!(" {} may not rise above {limit} ppm.", quantity.label()),
                None => format!(" No limit of {} is stated.", quantity.label().to_lowercase()),
            };
        }
    }
    said
}

fn summary(site: &Site) -> Vec<String> {
    let climate = &site.input.climate;
    if climate.sensors.is_empty() {
        return vec![
            "No climate log was found. Copy the files of humidity and temperature loggers, gauges and gas analysers into \
             ambient/."
                .to_owned(),
        ];
    }
    let runs = &site.input.runs;
    let covered = runs.iter().filter(|run| run.is_covered_by_log()).count();
    let flagged = |code: &str| {
        runs.iter()
            .filter(|run| run.issues.iter().any(|issue| issue.code == code))
            .count()
    };
    let mut sentences = vec![format!(
        "The logs cover {covered} of {}.",
        counted(runs.len(), "run")
    )];
    let left = flagged("climate-left-tolerance");
    if left > 0 {
        sentences.push(format!(
            "In {} the climate left the tolerance while the run went on.",
            counted(left, "run")
        ));
    }
    let above = flagged("climate-above-limit");
    if above > 0 {
        sentences.push(format!(
            "In {} oxygen or water rose above the stated limit.",
            counted(above, "run")
        ));
    }
    let labels = runs.iter().filter(|run| run.climate_label_differs()).count();
    if labels > 0 {
        sentences.push(format!(
            "In {} the label and the measured climate differ.",
            counted(labels, "run")
        ));
    }
    let clocks = climate
        .pairs
        .iter()
        .filter(|pair| pair.clock_ahead_h.is_some())
        .count();
    if clocks > 0 {
        sentences.push(format!(
            "{} of sensors show clocks that differ by hours; nothing was corrected.",
            counted(clocks, "pair")
        ));
    }
    sentences
}

fn is_climate(place: &str) -> bool {
    let keys = ClimateQuantity::MEASURED.map(ClimateQuantity::key);
    keys.contains(&place) || place == keys::RELATIVE_HUMIDITY_PERCENT
}

fn drawn(
    site: &Site,
    quantity: ClimateQuantity,
    figures: &mut BTreeMap<String, String>,
) -> Result<Option<Overview>, ReportError> {
    let sensors: Vec<&SensorSummary> = site
        .input
        .climate
        .sensors
        .iter()
        .filter(|sensor| sensor.quantity == quantity && sensor.not_used.is_none())
        .collect();
    let series: Vec<Drawn<'_>> = sensors
        .iter()
        .enumerate()
        .map(|(style, sensor)| Drawn {
            name: &sensor.sensor,
            times_s: &sensor.curve.0,
            values: &sensor.curve.1,
            style,
        })
        .collect();
    let id = format!("overview-{}", quantity.key().replace('_', "-"));
    let heading = quantity.label().to_owned();
    let title = format!("{heading} of all sensors over time");
    let desc = "Readings of each sensor as a line; black marks at the bottom are runs.";
    let drawn = overview(
        quantity,
        &series,
        &site.input.run_spans_s,
        &site.zone(),
        (&title, desc),
    );
    let svg = drawn.map_err(|reason| ReportError::Figure {
        figure: id.clone(),
        reason,
    })?;
    let Some(svg) = svg else { return Ok(None) };
    figures.insert(id.clone(), svg);
    let coloured = sensors.iter().take(Ink::SERIES.len()).enumerate();
    let more = sensors.len().saturating_sub(Ink::SERIES.len());
    Ok(Some(Overview {
        heading,
        figure: id,
        legend: coloured
            .map(|(at, sensor)| (format!("k-{}", at + 1), sensor.sensor.clone()))
            .collect(),
        more: match more {
            0 => String::new(),
            more => format!("{} more in grey", counted(more, "sensor")),
        },
    }))
}

fn sensor(sensor: &SensorSummary, zone: &Zone) -> SensorRow {
    let unit = sensor.quantity.unit();
    let mut stated: Vec<String> = Vec::new();
    stated.extend(
        Some(&sensor.place)
            .filter(|place| !place.is_empty())
            .map(|place| format!("place {place}")),
    );
    stated.push(match sensor.accuracy {
        Some(accuracy) => format!("accuracy ±{accuracy} {unit}"),
        None => "no accuracy".to_owned(),
    });
    stated.extend(
        sensor
            .correction
            .map(|correction| format!("{correction} {unit} added")),
    );
    stated.extend(sensor.calibration.clone());
    let is_used = sensor.not_used.is_none();
    // Pressures and traces span decades.
    let number = |value: f64| {
        if sensor.quantity.is_of_air() {
            fixed(value, 1)
        } else {
            significant(value, 3)
        }
    };
    SensorRow {
        sensor: sensor.sensor.clone(),
        quantity: sensor.quantity.label().to_owned(),
        readings: format!("{} in {}", sensor.readings, counted(sensor.files, "file")),
        span: if is_used {
            format!("{} to {}", zone.short(&sensor.from), zone.short(&sensor.to))
        } else {
            String::new()
        },
        interval: format!("{} s", seconds(sensor.interval_s)),
        range: if is_used {
            format!(
                "{} … {} … {} {unit}",
                number(sensor.least),
                number(sensor.mean),
                number(sensor.most)
            )
        } else {
            String::new()
        },
        clock: sensor.clock.clone(),
        stated: stated.join("; "),
        not_used: sensor.not_used.clone().unwrap_or_default(),
    }
}

fn pair(pair: &SensorPair) -> PairRow {
    let unit = pair.quantity.unit();
    let (bias, deviation) = pair.put_right.unwrap_or((pair.bias, pair.standard_deviation));
    let as_it_is = |now: f64, before: f64| match pair.put_right {
        None => format!("{} {unit}", fixed(now, 2)),
        Some(_) => format!(
            "{} {unit} (clocks as they are: {})",
            fixed(now, 2),
            fixed(before, 2)
        ),
    };
    PairRow {
        pair: format!("{} − {}", pair.first, pair.second),
        quantity: pair.quantity.label().to_owned(),
        hours: fixed(pair.hours, 1),
        bias: as_it_is(bias, pair.bias),
        standard_deviation: as_it_is(deviation, pair.standard_deviation),
        allowed: if pair.accuracies_are_stated {
            format!("{} {unit}", fixed(pair.allowed, 2))
        } else {
            format!("{} {unit} (tolerance)", fixed(pair.allowed, 2))
        },
        clock: match pair.clock_ahead_h {
            Some(ahead_h) if ahead_h > 0.0 => format!("{} is {ahead_h} h ahead", pair.second),
            Some(ahead_h) => format!("{} is {} h ahead", pair.first, -ahead_h),
            None => String::new(),
        },
        beyond: bias.abs() > pair.allowed,
    }
}

fn exposure(exposure: &Exposure, zone: &Zone) -> ExposureRow {
    let hours = |hours: f64| format!("{} h", fixed(hours, 1));
    ExposureRow {
        sample: exposure.sample.clone(),
        span: format!("{} to {}", zone.short(&exposure.from), zone.short(&exposure.to)),
        sensor: exposure.sensors.join(", "),
        above: match &exposure.reason {
            None => format!("{} above {} %", hours(exposure.above_h), exposure.above_percent),
            Some(reason) => format!("not known: {reason}"),
        },
        covered: hours(exposure.covered_h),
        uncovered: hours(exposure.uncovered_h),
        elsewhere: hours(exposure.elsewhere_h),
    }
}

fn flagged(site: &Site) -> Vec<Flagged> {
    let wanted = |run: &RunRecord| -> Vec<String> {
        let of_climate = run
            .issues
            .iter()
            .filter(|issue| RUN_ISSUES.contains(&issue.code.as_str()) && is_climate(&issue.place));
        of_climate.map(|issue| issue.message.clone()).collect()
    };
    let flagged = |(at, run): (usize, &RunRecord)| {
        let messages = wanted(run);
        (!messages.is_empty()).then(|| Flagged {
            link: RunLink::to(site, at),
            messages,
        })
    };
    site.input.runs.iter().enumerate().filter_map(flagged).collect()
}
