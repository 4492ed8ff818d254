//! What a series shows of its sensor: a humidity that is a copy of the temperature, a sensor that is stuck or at the
//! end of its range, readings that cannot be.

use super::policy::{
    BETWEEN_ENDS, COPY_SHARE, END_SHARE, FEWEST_AT_END, FEWEST_READINGS, MOVED, POSSIBLE_C, STUCK_HUMIDITY_S,
    STUCK_TEMPERATURE_S,
};
use ieap_domain::number::seconds::duration;
use ieap_domain::range_of;
use ieap_domain::{ClimateQuantity, Issue};

/// A series to be checked.
#[derive(Debug, Clone, Copy)]
pub struct Checked<'a> {
    /// The sensor, for the message.
    pub sensor: &'a str,
    /// Name of the column.
    pub column: &'a str,
    /// What is measured.
    pub quantity: ClimateQuantity,
    /// Times of the readings, s.
    pub times_s: &'a [f64],
    /// Readings.
    pub values: &'a [f64],
}

/// What to know of `series`, and why its readings are not used where they are none; `other` is the other quantity of
/// the same sensor.
pub fn check(series: Checked<'_>, other: Option<Checked<'_>>) -> (Vec<Issue>, Option<String>) {
    let mut issues = Vec::new();
    if !series.quantity.is_of_air() {
        return (issues, None);
    }
    if let Some(not_used) = other.and_then(|other| copy(series, other)) {
        let mend = "export the log again with the humidity in its column, or leave the column away";
        issues.push(
            Issue::error("humidity-is-temperature", format!("{not_used}; it is not used"))
                .at(place(series))
                .mend(mend),
        );
        return (issues, Some(not_used));
    }
    issues.extend(impossible(series));
    let stuck = stuck(series, other);
    let at_end = at_end(series);
    issues.extend(at_end.or(stuck));
    (issues, None)
}

fn place(series: Checked<'_>) -> String {
    format!("column {}", series.column)
}

/// Why the humidity is none: it repeats the temperature.
fn copy(series: Checked<'_>, other: Checked<'_>) -> Option<String> {
    let is_pair = series.quantity == ClimateQuantity::RelativeHumidity
        && other.quantity == ClimateQuantity::Temperature;
    if !is_pair || series.values.len() < FEWEST_READINGS {
        return None;
    }
    let mut common = 0usize;
    let mut equal = 0usize;
    let mut at = 0;
    for (time, value) in series.times_s.iter().zip(series.values) {
        while other.times_s.get(at).is_some_and(|t| t < time) {
            at += 1;
        }
        if other.times_s.get(at) == Some(time) {
            common += 1;
            equal += usize::from((other.values[at] - value).abs() < 1e-9);
        }
    }
    let varies = series.values.iter().any(|v| (v - series.values[0]).abs() > 1e-9);
    (common >= FEWEST_READINGS && varies && equal as f64 >= COPY_SHARE * common as f64).then(|| {
        format!(
            "the humidity of {} equals its temperature in {equal} of {common} readings: column {} is a copy of {}",
            series.sensor, series.column, other.column
        )
    })
}

fn impossible(series: Checked<'_>) -> Option<Issue> {
    let (possible, code, unit) = match series.quantity {
        ClimateQuantity::RelativeHumidity => (0.0..=100.0, "humidity-out-of-range", "%"),
        ClimateQuantity::Temperature => (POSSIBLE_C, "temperature-out-of-range", "°C"),
        _ => return None,
    };
    let outside = series.values.iter().filter(|value| !possible.contains(value));
    let (count, least, most) = outside
        .fold((0usize, f64::INFINITY, f64::NEG_INFINITY), |(n, low, high), v| {
            (n + 1, low.min(*v), high.max(*v))
        });
    let (low, high) = (possible.start(), possible.end());
    (count > 0).then(|| {
        let message = format!(
            "{count} of {} readings of {} lie outside of {low} to {high} {unit}: {} to {} {unit}; nothing was changed",
            series.values.len(),
            series.sensor,
            rounded(least),
            rounded(most)
        );
        Issue::warning(code, message)
            .at(place(series))
            .mend("check the sensor's calibration; state a correction under [[sensor]] in campaign.toml")
    })
}

/// The longest stretch of one number, where it is longer than air stays the same.
fn stuck(series: Checked<'_>, other: Option<Checked<'_>>) -> Option<Issue> {
    let longest_s = match series.quantity {
        ClimateQuantity::RelativeHumidity => STUCK_HUMIDITY_S,
        _ => STUCK_TEMPERATURE_S,
    };
    let (mut start, mut best) = (0, (0, 0));
    let lasts = |(from, to): (usize, usize)| series.times_s[to] - series.times_s[from];
    for at in 0..series.values.len() {
        if series.values[at] != series.values[start] {
            start = at;
        }
        if lasts((start, at)) > lasts(best) {
            best = (start, at);
        }
    }
    if series.values.is_empty() || lasts(best) < longest_s || best.1 - best.0 < FEWEST_READINGS {
        return None;
    }
    let (from_s, to_s) = (series.times_s[best.0], series.times_s[best.1]);
    if !other.is_some_and(|other| moved(other, from_s, to_s)) {
        return None;
    }
    let message = format!(
        "{} shows {} for {} while its other quantity moved: the sensor is stuck, at the end of its range, or in an \
         unusually steady climate",
        series.sensor,
        rounded(series.values[best.0]),
        duration(lasts(best))
    );
    let mend = "compare it with another sensor";
    Some(
        Issue::warning("sensor-stuck", message)
            .at(place(series))
            .mend(mend),
    )
}

fn moved(other: Checked<'_>, from_s: f64, to_s: f64) -> bool {
    let first = other.times_s.partition_point(|&t| t < from_s);
    let end = other.times_s.partition_point(|&t| t <= to_s);
    let mut seen: Vec<f64> = Vec::new();
    for value in &other.values[first..end] {
        if !seen.contains(value) {
            seen.push(*value);
        }
        if seen.len() >= MOVED {
            return true;
        }
    }
    false
}

/// A humidity whose least or greatest number is most of its readings: the end of the sensor's range.
fn at_end(series: Checked<'_>) -> Option<Issue> {
    if series.quantity != ClimateQuantity::RelativeHumidity {
        return None;
    }
    let extremes = range_of(series.values.iter().copied());
    let ends = [(extremes.0, "least"), (extremes.1, "greatest")];
    let (end, word, count) = ends
        .into_iter()
        .map(|(end, word)| (end, word, series.values.iter().filter(|v| **v == end).count()))
        .max_by_key(|(_, _, count)| *count)?;
    let is_end = extremes.0 < extremes.1
        && !BETWEEN_ENDS.contains(&end)
        && count >= FEWEST_AT_END
        && count as f64 >= END_SHARE * series.values.len() as f64;
    is_end.then(|| {
        let message = format!(
            "{} shows exactly {} %, the {word} of its readings, in {count} of {}: the end of the sensor's range, so the \
             humidity may lie beyond",
            series.sensor,
            rounded(end),
            series.values.len()
        );
        Issue::warning("sensor-at-end", message)
            .at(place(series))
            .mend("take a sensor for that range, or compare it with another one")
    })
}

fn rounded(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series<'a>(quantity: ClimateQuantity, times_s: &'a [f64], values: &'a [f64]) -> Checked<'a> {
        Checked {
            sensor: "S",
            column: quantity.key(),
            quantity,
            times_s,
            values,
        }
    }

    fn codes(of: (Vec<Issue>, Option<String>)) -> (Vec<String>, bool) {
        (of.0.into_iter().map(|issue| issue.code).collect(), of.1.is_some())
    }

    #[test]
    fn each_fault_is_named_and_a_good_sensor_has_none() {
        use ClimateQuantity::{RelativeHumidity, Temperature};
        let times: Vec<f64> = (0..1000).map(|k| f64::from(k) * 600.0).collect();
        let wave = |k: f64, base: f64| (k / 7.0).sin() * 2.0 + base;
        let temperature: Vec<f64> = (0..1000).map(|k| wave(f64::from(k), 21.0)).collect();
        let humidity: Vec<f64> = (0..1000).map(|k| wave(f64::from(k), 45.0)).collect();
        let with = |values: &[f64]| {
            let other = series(Temperature, &times, &temperature);
            codes(check(series(RelativeHumidity, &times, values), Some(other)))
        };
        assert_eq!(with(&humidity), (vec![], false));
        assert_eq!(
            with(&temperature),
            (vec!["humidity-is-temperature".to_owned()], true)
        );
        let mut stuck = humidity.clone();
        stuck[200..400].fill(44.4);
        assert_eq!(with(&stuck).0, ["sensor-stuck"]);
        let floor: Vec<f64> = humidity.iter().map(|v| v.max(45.0) - 41.5).collect();
        assert_eq!(with(&floor).0, ["sensor-at-end"]);
        let mut beyond = humidity.clone();
        beyond[5] = 102.9;
        assert_eq!(with(&beyond).0, ["humidity-out-of-range"]);
        // A temperature column of a copy is a temperature still.
        let other = series(RelativeHumidity, &times, &temperature);
        assert_eq!(
            codes(check(series(Temperature, &times, &temperature), Some(other))),
            (vec![], false)
        );
    }

    #[test]
    fn a_sensor_is_stuck_where_the_other_quantity_took_five_numbers_meanwhile() {
        let times: Vec<f64> = (0..200).map(|k| f64::from(k) * 600.0).collect();
        let still = vec![44.4; 200];
        let found = |numbers: u32| {
            let other: Vec<f64> = (0..200).map(|k| 21.0 + 0.1 * f64::from(k % numbers)).collect();
            let other = series(ClimateQuantity::Temperature, &times, &other);
            let humidity = series(ClimateQuantity::RelativeHumidity, &times, &still);
            codes(check(humidity, Some(other))).0
        };
        assert_eq!((found(4), found(5)), (vec![], vec!["sensor-stuck".to_owned()]));
    }

    #[test]
    fn the_end_of_a_range_is_told_from_a_hundred_readings_on() {
        let found = |count: u32| {
            let every_other = |k: u32| {
                if k.is_multiple_of(2) {
                    3.5
                } else {
                    10.0 + f64::from(k) / 100.0
                }
            };
            let values: Vec<f64> = (0..2 * count).map(every_other).collect();
            let times: Vec<f64> = (0..2 * count).map(|k| f64::from(k) * 600.0).collect();
            codes(check(
                series(ClimateQuantity::RelativeHumidity, &times, &values),
                None,
            ))
            .0
        };
        assert_eq!(
            (found(99), found(100)),
            (vec![], vec!["sensor-at-end".to_owned()])
        );
    }
}
