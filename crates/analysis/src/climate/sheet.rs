//! Tables of sensors, of sensors beside each other, of the exposure of samples, and of what a run had.

use ieap_domain::number::seconds::seconds;
use ieap_domain::number::{fixed, significant};
use ieap_domain::words::counted;
use ieap_domain::{ClimateAssessment, ClimateQuantity, Exposure, RunClimate, SensorPair, SensorSummary};
use ieap_show::quantities::SAMPLE;
use ieap_show::{Quantity, Sheet, Table};

use crate::zone::Zone;

const SENSOR: Quantity = Quantity::plain("sensor", "Sensor", "sensor");
const QUANTITY: Quantity = Quantity::plain("quantity", "Quantity", "quantity");
const CLOCK: Quantity = Quantity::plain("clock", "Clock", "clock");

const fn words(key: &'static str, title: &'static str) -> Quantity {
    Quantity::plain(key, title, title)
}

/// What the logs hold.
pub fn sensors(climate: &ClimateAssessment, zone: &Zone) -> Table {
    // Of a sensor that is not used nothing else is told.
    let used = |sensor: &SensorSummary, text: &dyn Fn(&SensorSummary) -> String| {
        sensor.not_used.is_none().then(|| text(sensor))
    };
    Sheet::<&SensorSummary>::new("sensors", "Sensors", 2)
        .column(SENSOR, |one| one.sensor.clone())
        .column(QUANTITY, |one| one.quantity.label())
        .column(words("readings", "Readings"), |one| {
            format!("{} in {}", one.readings, counted(one.files, "file"))
        })
        .column(words("span", "From, to"), |one| {
            used(one, &|one| span(zone, &one.from, &one.to))
        })
        .column(words("interval", "Every"), |one| {
            used(one, &|one| format!("{} s", seconds(one.interval_s)))
        })
        .column(words("range", "Least … mean … greatest"), |one| {
            used(one, &range)
        })
        .column(CLOCK, |one| used(one, &|one| one.clock.clone()))
        .column(words("stated", "Stated in campaign.toml"), |one| {
            match &one.not_used {
                Some(why) => format!("not used: {why}"),
                None => stated(one),
            }
        })
        .over(&climate.sensors)
}

fn span(zone: &Zone, from: &str, to: &str) -> String {
    format!("{} to {}", zone.short(from), zone.short(to))
}

fn range(sensor: &SensorSummary) -> String {
    // Pressures and traces span decades.
    let number = |value: f64| {
        if sensor.quantity.is_of_air() {
            fixed(value, 1)
        } else {
            significant(value, 3)
        }
    };
    let [least, mean, most] = [sensor.least, sensor.mean, sensor.most].map(number);
    format!("{least} … {mean} … {most} {}", sensor.quantity.unit())
}

fn stated(sensor: &SensorSummary) -> String {
    let unit = sensor.quantity.unit();
    let place = (!sensor.place.is_empty()).then(|| format!("place {}", sensor.place));
    let accuracy = match sensor.accuracy {
        Some(accuracy) => format!("accuracy ±{accuracy} {unit}"),
        None => "no accuracy".to_owned(),
    };
    let correction = sensor
        .correction
        .map(|correction| format!("{correction} {unit} added"));
    let stated = [place, Some(accuracy), correction, sensor.calibration.clone()];
    stated.into_iter().flatten().collect::<Vec<_>>().join("; ")
}

/// Sensors of one place beside each other.
pub fn pairs(climate: &ClimateAssessment) -> Table {
    let as_it_is = |pair: &SensorPair, now: f64, before: f64| {
        let now = format!("{} {}", fixed(now, 2), pair.quantity.unit());
        match pair.put_right {
            None => now,
            Some(_) => format!("{now} (clocks as they are: {})", fixed(before, 2)),
        }
    };
    let put_right = |pair: &SensorPair| pair.put_right.unwrap_or((pair.bias, pair.standard_deviation));
    Sheet::<&SensorPair>::new("sensors-compared", "Sensors compared", 2)
        .remarks("Means over 10 minutes in which both measured, sensors of one place. Where clocks differ, the numbers are those with the clocks put right.", "")
        .column(words("pair", "Difference"), |pair| format!("{} − {}", pair.first, pair.second))
        .column(QUANTITY, |pair| pair.quantity.label())
        .column(words("hours", "Hours"), |pair| fixed(pair.hours, 1))
        .column(words("bias", "Bias"), |pair| {
            let (bias, _) = put_right(pair);
            let beyond = if bias.abs() > pair.allowed { " (beyond)" } else { "" };
            as_it_is(pair, bias, pair.bias) + beyond
        })
        .column(words("standard_deviation", "Standard deviation"), |pair| {
            as_it_is(pair, put_right(pair).1, pair.standard_deviation)
        })
        .column(words("allowed", "Allowed"), |pair| {
            let by = if pair.accuracies_are_stated { "" } else { " (tolerance)" };
            format!("{} {}{by}", fixed(pair.allowed, 2), pair.quantity.unit())
        })
        .column(CLOCK, |pair| match pair.clock_ahead_h {
            Some(ahead_h) if ahead_h > 0.0 => format!("{} is {ahead_h} h ahead", pair.second),
            Some(ahead_h) => format!("{} is {} h ahead", pair.first, -ahead_h),
            None => String::new(),
        })
        .over(&climate.pairs)
}

/// Hours that samples have seen above a humidity.
pub fn exposures(climate: &ClimateAssessment, zone: &Zone) -> Table {
    let hours = |hours: f64| format!("{} h", fixed(hours, 1));
    Sheet::<&Exposure>::new("exposures", "Exposure of samples", 1)
        .column(SAMPLE, |one| one.sample.clone())
        .column(words("span", "First run to last run"), |one| {
            span(zone, &one.from, &one.to)
        })
        .column(words("exposure", "Exposure"), |one| match &one.reason {
            None => format!("{} above {} %", hours(one.above_h), one.above_percent),
            Some(reason) => format!("not known: {reason}"),
        })
        .column(SENSOR, |one| one.sensors.join(", "))
        .column(words("covered", "Covered"), |one| hours(one.covered_h))
        .column(words("uncovered", "Not covered"), |one| hours(one.uncovered_h))
        .column(words("elsewhere", "Elsewhere"), |one| hours(one.elsewhere_h))
        .over(&climate.exposures)
}

/// What a run had.
pub fn of_run(climate: &[RunClimate]) -> Table {
    let number = |found: &RunClimate, value: f64| match found.quantity {
        ClimateQuantity::VapourPressure => fixed(value, 0),
        // Pressures and traces span decades.
        ClimateQuantity::Pressure | ClimateQuantity::Oxygen | ClimateQuantity::Water => significant(value, 4),
        _ => fixed(value, 2),
    };
    let or_none = |found: &RunClimate, value: Option<f64>| value.map(|value| number(found, value));
    let table = Sheet::<&RunClimate>::new("climate", "By the sensors that speak for the run", 1)
        .column(QUANTITY, |found| {
            format!("{} ({})", found.quantity.label(), found.quantity.unit())
        })
        .column(words("mean", "Mean"), |found| number(found, found.mean))
        .column(words("standard_deviation", "Standard deviation"), |found| {
            or_none(found, found.standard_deviation)
        })
        .column(words("drift_per_h", "Drift per hour"), |found| {
            or_none(found, found.drift_per_h)
        })
        .column(words("largest_deviation", "Largest deviation"), |found| {
            number(found, found.largest_deviation)
        })
        .column(words("largest_gap", "Largest gap"), |found| {
            format!("{} s", fixed(found.largest_gap_s, 0))
        })
        .column(words("readings", "Readings"), |found| found.readings)
        .column(SENSOR, |found| {
            let not_used = if found.chosen { "" } else { " (not used)" };
            format!("{}{not_used}", found.sensor)
        })
        .column(words("accuracy", "Accuracy"), |found| match found.accuracy {
            Some(accuracy) => format!("±{accuracy}"),
            None => "not stated".to_owned(),
        })
        .over(climate);
    let is_interpolated = climate.iter().any(|found| found.readings == 0);
    let remark =
        "Where no reading lies within the run, the mean is interpolated between those before and after it.";
    Table {
        remarks: Vec::from_iter(is_interpolated.then(|| remark.to_owned())),
        ..table
    }
}
