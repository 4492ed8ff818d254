//! What stays of a change when the humidity comes back: recovery and hysteresis.

use super::level::Level;
use super::policy::{CLEAR, SAME_HUMIDITY_PERCENT};
use super::step::{MeasuredStep, determined};
use ieap_domain::modulus::log_keys;
use ieap_domain::number::fixed;
use ieap_domain::{Estimate, Parameter};

/// A humidity that was held, with |E*| at its end.
struct Held<'a> {
    percent: f64,
    modulus: &'a Result<Level, String>,
}

/// Recovery, and the hysteresis at every humidity that was held on both ways.
pub fn estimates(steps: &[MeasuredStep]) -> Vec<Parameter> {
    let Some(first) = steps.first() else {
        return Vec::new();
    };
    let mut held = vec![Held {
        percent: first.humidity_percent.0,
        modulus: &first.before,
    }];
    held.extend(steps.iter().map(|step| Held {
        percent: step.humidity_percent.1,
        modulus: &step.after,
    }));
    let from_first = |held: &Held| (held.percent - first.humidity_percent.0).abs();
    let farthest = (0..held.len())
        .max_by(|&a, &b| {
            from_first(&held[a])
                .total_cmp(&from_first(&held[b]))
                .then(b.cmp(&a))
        })
        .unwrap_or(0);
    let parameter = |key: &str, estimate| Parameter {
        key: key.to_owned(),
        estimate,
    };
    let mut found = vec![parameter(log_keys::RECOVERY, recovery(&held, farthest))];
    let pairs = visited_twice(&held, farthest);
    if pairs.is_empty() {
        let reason = "no humidity is held both on the way out and on the way back";
        found.push(parameter(log_keys::HYSTERESIS, Estimate::not_determined(reason)));
    }
    for (out, back) in pairs {
        let percent = 0.5 * (out.percent + back.percent);
        let humidity = determined(
            percent,
            &[(0.5 * (out.percent - back.percent).abs(), f64::INFINITY)],
        );
        found.push(parameter(log_keys::HYSTERESIS_HUMIDITY, humidity));
        found.push(parameter(log_keys::HYSTERESIS, hysteresis(out, back)));
    }
    found
}

/// 100 (last - farthest) / (first - farthest), percent, where the last humidity is the first again.
fn recovery(held: &[Held<'_>], farthest: usize) -> Estimate {
    let (first, last) = (&held[0], &held[held.len() - 1]);
    if farthest + 1 >= held.len() || (first.percent - last.percent).abs() > SAME_HUMIDITY_PERCENT {
        return Estimate::not_determined(format!(
            "the humidity does not come back to the {} % at which it began",
            fixed(first.percent, 0)
        ));
    }
    let levels = [first.modulus, held[farthest].modulus, last.modulus];
    let [first, far, last] = match levels.map(|level| level.as_ref()) {
        [Ok(first), Ok(far), Ok(last)] => [first, far, last],
        [Err(reason), ..] | [_, Err(reason), _] | [.., Err(reason)] => {
            return Estimate::not_determined(reason.as_str());
        }
    };
    let change = first.value - far.value;
    if change.abs() < CLEAR * first.standard_error.hypot(far.standard_error) {
        return Estimate::not_determined(
            "the change is too small against its uncertainty to state a part of it",
        );
    }
    let part = (last.value - far.value) / change;
    determined(
        100.0 * part,
        &[
            (100.0 * part * first.standard_error / change, first.freedom),
            (100.0 * (part - 1.0) * far.standard_error / change, far.freedom),
            (100.0 * last.standard_error / change, last.freedom),
        ],
    )
}

/// Humidities held before and after the farthest, nearest to the beginning first.
fn visited_twice<'a, 'b>(held: &'a [Held<'b>], farthest: usize) -> Vec<(&'a Held<'b>, &'a Held<'b>)> {
    let pair = |out: &'a Held<'b>| {
        let back = held[farthest + 1..].iter();
        let nearest = back.min_by(|a, b| {
            (a.percent - out.percent)
                .abs()
                .total_cmp(&(b.percent - out.percent).abs())
        })?;
        ((nearest.percent - out.percent).abs() <= SAME_HUMIDITY_PERCENT).then_some((out, nearest))
    };
    held[..farthest].iter().filter_map(pair).collect()
}

/// 100 (back / out - 1), percent.
fn hysteresis(out: &Held<'_>, back: &Held<'_>) -> Estimate {
    match (out.modulus, back.modulus) {
        (Ok(out), Ok(back)) if out.value > 3.0 * out.half_width() => {
            let ratio = back.value / out.value;
            determined(
                100.0 * (ratio - 1.0),
                &[
                    (100.0 * ratio * out.standard_error / out.value, out.freedom),
                    (100.0 * back.standard_error / out.value, back.freedom),
                ],
            )
        }
        (Ok(_), Ok(_)) => Estimate::not_determined("the modulus does not stand out from its uncertainty"),
        (Err(reason), _) | (_, Err(reason)) => Estimate::not_determined(reason.as_str()),
    }
}
