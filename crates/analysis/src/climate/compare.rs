//! Two sensors of one place: bias and scatter of their difference, and a clock that is off by hours.
//!
//! Readings are averaged over bins of equal length on UTC, so that loggers of any interval can be compared and memory
//! grows with the time measured, not with readings. The clocks are compared by shifting one series by up to half a day
//! in steps of half an hour: where the scatter of the difference falls to less than half, and well below the variation
//! of the air, at another shift than none, the clocks differ by that.

use super::policy::{
    BIN_S, FEWEST_COMMON, FEWEST_FOR_CLOCKS, LARGEST_SHIFT, MOST_FOR_CLOCKS, OF_VARIATION, SCATTER_LEFT,
};
use ieap_domain::number::fixed;
use ieap_domain::number::seconds::duration;
use ieap_domain::{ClimateQuantity, Issue, SensorPair};

/// Bins in half an hour.
const BINS_PER_STEP: i64 = 3;

/// Means of a series over bins.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Bins {
    /// Number of the first bin since 1970.
    first: i64,
    sums: Vec<f64>,
    counts: Vec<u32>,
}

/// More bins than any log has: a hundred years.
const MOST_BINS: i64 = 100 * 52_596;

impl Bins {
    /// Adds readings, whose times increase and lie after those added before.
    pub fn add(&mut self, times_s: &[f64], values: &[f64]) {
        for (time, value) in times_s.iter().zip(values) {
            let bin = (time / BIN_S).floor() as i64;
            if self.sums.is_empty() {
                self.first = bin;
            }
            let at = bin - self.first;
            if !(0..MOST_BINS).contains(&at) {
                continue;
            }
            let at = at as usize;
            if at >= self.sums.len() {
                self.sums.resize(at + 1, 0.0);
                self.counts.resize(at + 1, 0);
            }
            self.sums[at] += value;
            self.counts[at] += 1;
        }
    }

    /// Mean in a bin.
    fn get(&self, bin: i64) -> Option<f64> {
        let at = usize::try_from(bin - self.first).ok()?;
        let count = *self.counts.get(at)?;
        (count > 0).then(|| self.sums[at] / f64::from(count))
    }

    /// Numbers of the first bin and one past the last.
    fn range(&self) -> (i64, i64) {
        (self.first, self.first + self.sums.len() as i64)
    }

    /// Readings thinned for drawing: least and greatest of each of `buckets` stretches, in the order of time.
    pub fn drawn(&self, buckets: usize) -> (Vec<f64>, Vec<f64>) {
        let per = self.sums.len().div_ceil(buckets.max(1)).max(1);
        let (mut times_s, mut values) = (Vec::new(), Vec::new());
        for start in (0..self.sums.len()).step_by(per) {
            let bins = start..(start + per).min(self.sums.len());
            let means = bins
                .filter(|&k| self.counts[k] > 0)
                .map(|k| (k, self.sums[k] / f64::from(self.counts[k])));
            let means: Vec<(usize, f64)> = means.collect();
            let least = means.iter().min_by(|a, b| a.1.total_cmp(&b.1));
            let most = means.iter().max_by(|a, b| a.1.total_cmp(&b.1));
            let mut kept: Vec<(usize, f64)> = least.into_iter().chain(most).copied().collect();
            kept.sort_by_key(|(at, _)| *at);
            kept.dedup();
            for (at, value) in kept {
                times_s.push((self.first + at as i64) as f64 * BIN_S + 0.5 * BIN_S);
                // More digits than a sensor has would only fill the page.
                values.push((value * 1000.0).round() / 1000.0);
            }
        }
        (times_s, values)
    }
}

/// A sensor to be compared.
#[derive(Debug, Clone, Copy)]
pub struct Compared<'a> {
    /// The sensor.
    pub sensor: &'a str,
    /// Its readings.
    pub bins: &'a Bins,
    /// Its stated accuracy.
    pub accuracy: Option<f64>,
}

/// Compares two sensors of one place; none where they did not measure together. `tolerance` stands in for accuracies
/// that are not stated.
pub fn pair(
    a: Compared<'_>,
    b: Compared<'_>,
    quantity: ClimateQuantity,
    tolerance: f64,
) -> Option<SensorPair> {
    let differences = differences(a.bins, b.bins, 0, usize::MAX);
    if differences.len() < FEWEST_COMMON {
        return None;
    }
    let (bias, standard_deviation) = mean_and_deviation(&differences);
    let allowed = match (a.accuracy, b.accuracy) {
        (Some(a), Some(b)) => a.hypot(b),
        _ => tolerance,
    };
    let ahead = clock_ahead(a.bins, b.bins);
    let put_right =
        ahead.map(|bins| mean_and_deviation(&self::differences(a.bins, b.bins, bins, usize::MAX)));
    Some(SensorPair {
        first: a.sensor.to_owned(),
        second: b.sensor.to_owned(),
        quantity,
        hours: differences.len() as f64 * BIN_S / 3600.0,
        bias,
        standard_deviation,
        allowed,
        accuracies_are_stated: a.accuracy.is_some() && b.accuracy.is_some(),
        clock_ahead_h: ahead.map(|bins| bins as f64 * BIN_S / 3600.0),
        put_right,
    })
}

/// What to know of all pairs: one issue for two clocks that differ, one for each quantity in which sensors disagree.
pub fn pair_issues(pairs: &[SensorPair]) -> Vec<Issue> {
    let mut issues = clocks(pairs);
    for quantity in [ClimateQuantity::RelativeHumidity, ClimateQuantity::Temperature] {
        let of_quantity: Vec<&SensorPair> = pairs.iter().filter(|pair| pair.quantity == quantity).collect();
        issues.extend(disagreement(&of_quantity));
    }
    issues
}

/// Bias and standard deviation, with the clocks put right where they differ.
pub fn difference(pair: &SensorPair) -> (f64, f64) {
    pair.put_right.unwrap_or((pair.bias, pair.standard_deviation))
}

/// The logger of a sensor: its parts share a clock. A run's path is its own.
fn logger(sensor: &str) -> &str {
    if sensor.contains('.') {
        return sensor;
    }
    sensor.split_once('/').map_or(sensor, |(logger, _)| logger)
}

fn clocks(pairs: &[SensorPair]) -> Vec<Issue> {
    let mut found: Vec<((&str, &str, f64), &SensorPair, usize)> = Vec::new();
    for pair in pairs {
        let Some(ahead_h) = pair.clock_ahead_h else {
            continue;
        };
        let (first, second) = (logger(&pair.first), logger(&pair.second));
        let (late, early) = if ahead_h > 0.0 {
            (second, first)
        } else {
            (first, second)
        };
        let key = (late, early, ahead_h.abs());
        match found.iter_mut().find(|(other, ..)| *other == key) {
            None => found.push((key, pair, 1)),
            Some((_, best, count)) => {
                *count += 1;
                let left = |pair: &SensorPair| difference(pair).1 / pair.standard_deviation;
                if left(pair) < left(best) {
                    *best = pair;
                }
            }
        }
    }
    let issue = |((late, early, by), pair, count): ((&str, &str, f64), &SensorPair, usize)| {
        let (unit, name) = (pair.quantity.unit(), pair.quantity.label().to_lowercase());
        let message = format!(
            "the clock of {late} is {by} h ahead of that of {early}: with it put right the scatter between {} and {} \
             falls from {} to {} {unit} of {name} ({count} pairs of sensors show it). Nothing was changed",
            pair.first,
            pair.second,
            fixed(pair.standard_deviation, 2),
            fixed(difference(pair).1, 2)
        );
        Issue::warning("clock-offset", message)
            .at(format!("{late}, {early}"))
            .mend("find out which clock is wrong, and state utc_offset for that [[sensor]] in campaign.toml")
    };
    found.into_iter().map(issue).collect()
}

/// The pairs of one quantity that differ by more than their accuracies allow.
fn disagreement(pairs: &[&SensorPair]) -> Option<Issue> {
    let beyond = |pair: &&&SensorPair| difference(pair).0.abs() > pair.allowed;
    let worst = pairs.iter().filter(beyond).max_by(|a, b| {
        let excess = |pair: &SensorPair| difference(pair).0.abs() - pair.allowed;
        excess(a).total_cmp(&excess(b))
    })?;
    let (unit, name) = (worst.quantity.unit(), worst.quantity.label().to_lowercase());
    let (bias, deviation) = difference(worst);
    let against = if worst.accuracies_are_stated {
        "their stated accuracies"
    } else {
        "the campaign's tolerance, for accuracies are not stated"
    };
    let message = format!(
        "{} of {} pairs of sensors in one place differ in {name} by more than is allowed, the most: {} shows {} {unit} \
         {} than {} (standard deviation {} {unit}, over {}), and {} {unit} are allowed by {against}",
        pairs.iter().filter(beyond).count(),
        pairs.len(),
        worst.first,
        fixed(bias.abs(), 2),
        if bias > 0.0 { "more" } else { "less" },
        worst.second,
        fixed(deviation, 2),
        duration(worst.hours * 3600.0),
        fixed(worst.allowed, 2)
    );
    let mend = "calibrate them and state accuracies and corrections under [[sensor]] in campaign.toml, or their places \
                where they stand apart";
    Some(
        Issue::warning("sensors-disagree", message)
            .at(worst.quantity.key())
            .mend(mend),
    )
}

/// `a` minus `b` in every bin that both have, `b` read `ahead` bins later; the last `most` of them.
fn differences(a: &Bins, b: &Bins, ahead: i64, most: usize) -> Vec<f64> {
    let ((a0, a1), (b0, b1)) = (a.range(), b.range());
    let (low, high) = (a0.max(b0 - ahead), a1.min(b1 - ahead));
    let low = low.max(high - i64::try_from(most).unwrap_or(i64::MAX).min(high - low));
    (low..high)
        .filter_map(|bin| Some(a.get(bin)? - b.get(bin + ahead)?))
        .collect()
}

/// Bins by which the clock of `b` is ahead of that of `a`, where the readings show it.
fn clock_ahead(a: &Bins, b: &Bins) -> Option<i64> {
    let as_it_is = differences(a, b, 0, MOST_FOR_CLOCKS);
    if as_it_is.len() < FEWEST_FOR_CLOCKS {
        return None;
    }
    let scatter = mean_and_deviation(&as_it_is).1;
    let shifted = |step: i64| {
        let differences = differences(a, b, step * BINS_PER_STEP, MOST_FOR_CLOCKS);
        let enough = differences.len() >= FEWEST_FOR_CLOCKS;
        enough.then(|| (mean_and_deviation(&differences).1, step))
    };
    let (least, step) = (-LARGEST_SHIFT..=LARGEST_SHIFT)
        .filter_map(shifted)
        .min_by(|x, y| x.0.total_cmp(&y.0).then(x.1.abs().cmp(&y.1.abs())))?;
    let (low, high) = a.range();
    let own: Vec<f64> = (low.max(high - MOST_FOR_CLOCKS as i64)..high)
        .filter_map(|bin| a.get(bin))
        .collect();
    let variation = mean_and_deviation(&own).1;
    (step != 0 && least <= SCATTER_LEFT * scatter && least <= OF_VARIATION * variation)
        .then_some(step * BINS_PER_STEP)
}

fn mean_and_deviation(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    (mean, (squares / (count - 1.0).max(1.0)).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two days of weather, read every minute, as a clock shows it that is `ahead_h` ahead.
    fn weather(ahead_h: f64, bias: f64) -> Bins {
        let mut bins = Bins::default();
        let times: Vec<f64> = (0..4000).map(|k| 1.7e9 + f64::from(k) * 60.0).collect();
        let air = |t: f64| 60.0 + 15.0 * (t / 13_751.0).sin() + 4.0 * (t / 3571.0).sin();
        let values: Vec<f64> = times.iter().map(|t| air(t - 3600.0 * ahead_h) + bias).collect();
        bins.add(&times, &values);
        bins
    }

    fn compared<'a>(sensor: &'a str, bins: &'a Bins) -> Compared<'a> {
        Compared {
            sensor,
            bins,
            accuracy: None,
        }
    }

    #[test]
    fn a_clock_ahead_is_found_with_its_sign() {
        let right = weather(0.0, 0.0);
        for ahead_h in [-5.5, -1.0, 2.0, 10.0] {
            let off = weather(ahead_h, 1.0);
            let found = pair(
                compared("a", &right),
                compared("b", &off),
                ClimateQuantity::RelativeHumidity,
                3.0,
            )
            .unwrap();
            assert_eq!(found.clock_ahead_h, Some(ahead_h), "{found:?}");
            let (bias, deviation) = found.put_right.unwrap();
            assert!((bias + 1.0).abs() < 0.05 && deviation < 0.2, "{found:?}");
            let issues = pair_issues(std::slice::from_ref(&found));
            assert_eq!(issues[0].code, "clock-offset");
            let expected = if ahead_h > 0.0 {
                "the clock of b"
            } else {
                "the clock of a"
            };
            assert!(issues[0].message.starts_with(expected), "{}", issues[0].message);
            assert_eq!(issues.len(), 1);
        }
    }

    #[test]
    fn sensors_that_agree_have_no_issue_and_a_bias_is_named() {
        let right = weather(0.0, 0.0);
        let same = pair(
            compared("a", &right),
            compared("b", &right),
            ClimateQuantity::RelativeHumidity,
            3.0,
        )
        .unwrap();
        assert_eq!((same.clock_ahead_h, same.bias), (None, 0.0));
        assert!(pair_issues(&[same]).is_empty());
        let high = weather(0.0, 4.0);
        let off = pair(
            compared("a", &high),
            compared("b", &right),
            ClimateQuantity::RelativeHumidity,
            3.0,
        )
        .unwrap();
        assert!((off.bias - 4.0).abs() < 1e-9);
        assert_eq!(pair_issues(&[off])[0].code, "sensors-disagree");
        // Two boxes that have nothing to do with each other are no clock that is off.
        let mut flat = Bins::default();
        let times: Vec<f64> = (0..4000).map(|k| 1.7e9 + f64::from(k) * 60.0).collect();
        flat.add(&times, &vec![50.0; 4000]);
        let found = pair(
            compared("a", &right),
            compared("b", &flat),
            ClimateQuantity::RelativeHumidity,
            3.0,
        )
        .unwrap();
        assert_eq!(found.clock_ahead_h, None);
    }
}
