//! What is not known of the edges, in the intervals of a fit: how far its parameters go where the edges go.

use ieap_domain::quantiles::NORMAL_95;
use ieap_domain::{Drive, Estimate, Fit, Issue, Parameter};

use crate::interval_rule::is_narrow_enough;
use crate::policy::WIDENED_FROM_PART;
use crate::settled_edges::Settled;

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
/// with another drive, in the simplest way.
pub(crate) fn widen(fit: &mut Fit, settled: &Settled, plain: impl Fn(&Drive) -> Option<Vec<Parameter>>) {
    let with_shifts = |by_s: &[f64]| Some(values(&plain(&settled.edges.shifted(by_s))?));
    let still = vec![0.0; settled.edges.shifts().len()];
    let Some(here) = with_shifts(&still) else { return };
    let moved: Vec<Values> = settled.open.iter().filter_map(|by_s| with_shifts(by_s)).collect();
    widen_by(fit, settled, &here, &moved);
}

/// The same where it is known how far the parameters go from `here` in each of the open ways.
pub(crate) fn widen_by(fit: &mut Fit, settled: &Settled, here: &Values, moved: &[Values]) {
    let mut widened = 0;
    for parameter in &mut fit.parameters {
        let of = |all: &Values| {
            let own = all.iter().find(|(key, _)| *key == parameter.key);
            own.map(|(_, value)| *value)
        };
        let Some(value) = of(here) else { continue };
        let apart = moved.iter().filter_map(|there| Some(of(there)? / value - 1.0));
        let relative = apart.map(|part| part * part).sum::<f64>().sqrt();
        widened += usize::from(wider(&mut parameter.estimate, relative));
    }
    if widened > 0 && settled.edges.is_open() {
        fit.issues
            .push(Issue::note("edges-between-readings", words(settled)));
    }
}

/// Whether an estimate was widened for a further relative error.
fn wider(estimate: &mut Estimate, relative: f64) -> bool {
    let (Some(value), Some(low), Some(high)) = (estimate.value, estimate.low_95, estimate.high_95) else {
        return false;
    };
    let added = NORMAL_95 * relative;
    let is_logarithm = low > 0.0;
    let half = |end: f64| {
        if is_logarithm {
            (end / value).ln().abs()
        } else {
            ((end - value) / value).abs()
        }
    };
    let [down, up] = [low, high].map(|end| half(end).hypot(added));
    if down.max(up) <= (1.0 + WIDENED_FROM_PART) * half(low).max(half(high)) {
        return false;
    }
    if !is_narrow_enough(down.max(up)) {
        *estimate = Estimate::not_determined(TOO_WIDE);
        return true;
    }
    let error = estimate
        .standard_error
        .map(|error| error.hypot(relative * value.abs()));
    (estimate.low_95, estimate.high_95) = if is_logarithm {
        (Some(value * (-down).exp()), Some(value * up.exp()))
    } else {
        (Some(value - down * value.abs()), Some(value + up * value.abs()))
    };
    estimate.standard_error = error;
    true
}

fn words(settled: &Settled) -> String {
    let drive = settled.edges.drive();
    let between = drive.segments.iter().filter(|segment| !segment.edge.is_stated());
    let count = between.clone().count();
    let first = between.map(|segment| segment.start_s()).next().unwrap_or(0.0);
    let largest_s = settled
        .open
        .iter()
        .map(|by_s| by_s.iter().map(|s| s * s).sum::<f64>().sqrt())
        .fold(0.0, f64::max);
    format!(
        "{} between two readings of the voltage: the first is taken at {first:.4} s, and what is left open (up to {largest_s:.2} s, \
         one standard deviation) widens the intervals",
        if count == 1 {
            "the edge of the voltage lies".to_owned()
        } else {
            format!("{count} edges of the voltage lie")
        }
    )
}
