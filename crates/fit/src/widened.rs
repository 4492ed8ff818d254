//! What is not known of the edges, in the intervals of a fit: how far its parameters go where the edges go.

use ieap_domain::number::fixed;
use ieap_domain::quantiles::NORMAL_95;
use ieap_domain::{Drive, Estimate, Fit, Issue, Parameter};

use crate::edges::Settled;
use crate::interval_rule::is_narrow_enough;
use crate::policy::WIDENED_FROM_PART;

const TOO_WIDE: &str = "the edges of the voltage lie between readings, and where they lie moves it by more than its size: read \
                        faster, or state the drive";

/// Values of parameters by their keys.
pub(crate) type Values = Vec<(String, f64)>;

/// The values of those that have one.
pub(crate) fn values(parameters: &[Parameter]) -> Values {
    let of = |parameter: &Parameter| Some((parameter.key.clone(), parameter.estimate.value?));
    parameters.iter().filter_map(of).collect()
}

/// Widens the intervals of `fit`, which was made with the edges of `settled`, by what they leave open; `plain` fits the run
/// with another drive, in the simplest way, and has the parameters `here` where the edges are, if that is known. It is asked at both ends of where the edges are in 95 of 100 runs: a branch that
/// charges between two readings goes far from a straight line between them.
pub(crate) fn widen(
    fit: &mut Fit,
    settled: &Settled,
    here: Option<Values>,
    plain: impl Fn(&Drive) -> Option<Vec<Parameter>>,
) {
    let with_shifts = |by_s: &[f64]| {
        let fitted = plain(&settled.edges.shifted(by_s));
        fitted.map_or_else(Values::new, |fitted| values(&fitted))
    };
    let here = here.unwrap_or_else(|| with_shifts(&vec![0.0; settled.edges.shifts().len()]));
    let end = |by_s: &Vec<f64>, sign: f64| {
        let whole: Vec<f64> = by_s.iter().map(|by_s| sign * NORMAL_95 * by_s).collect();
        let part = settled.edges.part_of(&whole);
        let within: Vec<f64> = whole.iter().map(|by_s| part * by_s).collect();
        (part > LEAST_PART).then(|| End {
            part,
            there: with_shifts(&within),
        })
    };
    let ends: Vec<[Option<End>; 2]> = settled
        .open
        .iter()
        .map(|by_s| [-1.0, 1.0].map(|sign| end(by_s, sign)))
        .collect();
    if widen_by(&mut fit.parameters, &here, &ends) {
        fit.issues.push(issue(settled));
    }
}

/// Where parameters are, a part of the way to the end of what is open; an edge goes no farther than the readings beside it.
pub(crate) struct End {
    pub(crate) part: f64,
    pub(crate) there: Values,
}

/// Parts of a way below which the edges are at a reading already.
const LEAST_PART: f64 = 0.05;

/// Whether any interval is wider for that: the same where it is known where the parameters go from `here` to both ends of each of the open ways.
pub(crate) fn widen_by(parameters: &mut [Parameter], here: &Values, ends: &[[Option<End>; 2]]) -> bool {
    let mut widened = 0;
    for parameter in parameters {
        let of = |all: &Values| {
            let own = all.iter().find(|(key, _)| *key == parameter.key);
            own.map(|(_, value)| *value)
        };
        let Some(value) = of(here).filter(|value| *value != 0.0) else {
            continue;
        };
        // How far it goes down and up, squares over the ways; without end where it is lost on the way.
        let mut gone = [0.0_f64; 2];
        for way in ends {
            let moved = |end: &Option<End>| {
                let end = end.as_ref()?;
                Some(of(&end.there).map_or(f64::NAN, |there| distance(there / value) / end.part))
            };
            let moved = match way.each_ref().map(moved) {
                [Some(one), Some(other)] => [one, other],
                // At a reading already: as far to the other side as from it.
                [Some(one), None] | [None, Some(one)] => [one, -one],
                [None, None] => continue,
            };
            for (side, sign) in [-1.0, 1.0].into_iter().enumerate() {
                let farthest = moved.iter().fold(0.0_f64, |most, moved| {
                    most.max(if moved.is_nan() {
                        f64::INFINITY
                    } else {
                        sign * moved
                    })
                });
                gone[side] += farthest * farthest;
            }
        }
        widened += usize::from(wider(&mut parameter.estimate, gone.map(f64::sqrt)));
    }
    widened > 0
}

/// How far a part of a value is from the whole of it: as logarithms have it, where it has one.
fn distance(part: f64) -> f64 {
    if part > 0.0 { part.ln() } else { part - 1.0 }
}

/// Whether an estimate was widened by further half widths, down and up, in parts of it.
fn wider(estimate: &mut Estimate, added: [f64; 2]) -> bool {
    let (Some(value), Some(low), Some(high)) = (estimate.value, estimate.low_95, estimate.high_95) else {
        return false;
    };
    let is_logarithm = low > 0.0;
    let half = |end: f64| {
        if is_logarithm {
            (end / value).ln().abs()
        } else {
            ((end - value) / value).abs()
        }
    };
    let [down, up] = [half(low).hypot(added[0]), half(high).hypot(added[1])];
    if down.max(up) <= (1.0 + WIDENED_FROM_PART) * half(low).max(half(high)) {
        return false;
    }
    if !is_narrow_enough(down.max(up)) {
        *estimate = Estimate::not_determined(TOO_WIDE);
        return true;
    }
    let error = estimate
        .standard_error
        .map(|error| error.hypot(0.5 * (added[0] + added[1]) / NORMAL_95 * value.abs()));
    (estimate.low_95, estimate.high_95) = if is_logarithm {
        (Some(value * (-down).exp()), Some(value * up.exp()))
    } else {
        (Some(value - down * value.abs()), Some(value + up * value.abs()))
    };
    estimate.standard_error = error;
    true
}

/// What is said of edges that widen intervals.
pub(crate) fn issue(settled: &Settled) -> Issue {
    let drive = settled.edges.drive();
    let between = drive.segments.iter().filter(|segment| !segment.edge.is_stated());
    let count = between.clone().count();
    let first = between.map(|segment| segment.start_s()).next().unwrap_or(0.0);
    let largest_s = settled
        .open
        .iter()
        .map(|by_s| by_s.iter().map(|s| s * s).sum::<f64>().sqrt())
        .fold(0.0, f64::max);
    let message = format!(
        "{} between two readings of the voltage: the first is taken at {} s, and what is left open (up to {} s, \
         one standard deviation) widens the intervals",
        if count == 1 {
            "the edge of the voltage lies".to_owned()
        } else {
            format!("{count} edges of the voltage lie")
        },
        fixed(first, 4),
        fixed(largest_s, 2)
    );
    Issue::note("edges-between-readings", message)
}
