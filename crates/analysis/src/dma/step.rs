//! What the modulus does at one humidity step.

use super::humidity_steps::HumidityStep;
use super::level::{Level, at_end};
use super::moduli::Moduli;
use super::relaxation::{self, Relaxation, Stretch};
use ieap_domain::modulus::step_keys;
use ieap_domain::number::fixed;
use ieap_domain::number::seconds::duration;
use ieap_domain::{Estimate, Issue, ModulusStep, Parameter};

/// What a log holds over time.
#[derive(Debug, Clone, Copy)]
pub struct Series<'a> {
    /// Moduli and loss factor.
    pub moduli: &'a Moduli,
    /// Times, s, and humidity, percent, where there is such a channel.
    pub humidity: Option<(&'a [f64], &'a [f64])>,
}

/// A step with what later conclusions need of it.
#[derive(Debug, Clone)]
pub struct MeasuredStep {
    /// As it is stored.
    pub step: ModulusStep,
    /// |E*| when the step begins, or why it is not known.
    pub before: Result<Level, String>,
    /// |E*| at the end of the stretch after it.
    pub after: Result<Level, String>,
    /// Humidity before and after, percent.
    pub humidity_percent: (f64, f64),
    /// The relaxation fitted to the stretch.
    pub relaxation: Option<Relaxation>,
}

/// Measures one step.
pub fn measure(series: &Series<'_>, step: HumidityStep, issues: &mut Vec<Issue>) -> MeasuredStep {
    let moduli = series.moduli;
    let (begin_s, end_s) = (step.held_from_s, step.held_until_s);
    let level = |values: &[f64], from_s, until_s| at_end(&moduli.time_s, values, from_s, until_s);
    let before = level(&moduli.complex_mpa, begin_s, step.start_s);
    let after = level(&moduli.complex_mpa, step.settled_s, end_s);
    let relaxation = relax(moduli, &step, end_s, &before, &after);
    let place = format!("step at {} s", fixed(step.start_s, 0));
    issues.extend(unsettled(&relaxation, &step, end_s).map(|issue| issue.at(place)));
    let factor = |from_s, until_s| match &moduli.loss_factor {
        Some(values) => of_level(&level(values, from_s, until_s)),
        None => Estimate::not_determined("the log gives neither a loss factor nor what it follows from"),
    };
    let humidity = |from_s, until_s, level| match series.humidity {
        Some((time_s, percent)) => at_end(time_s, percent, from_s, until_s).map_or_else(
            |reason| Estimate {
                value: Some(level),
                ..Estimate::not_determined(reason)
            },
            |found| found.estimate(),
        ),
        None => Estimate::not_determined("no humidity channel"),
    };
    let of_relaxation = |pick: fn(&Relaxation) -> &Estimate| match &relaxation {
        Ok(relaxation) => pick(relaxation).clone(),
        Err(reason) => Estimate::not_determined(reason.as_str()),
    };
    let estimates = [
        (
            step_keys::HUMIDITY_BEFORE,
            humidity(begin_s, step.start_s, step.before_percent),
        ),
        (
            step_keys::HUMIDITY_AFTER,
            humidity(step.settled_s, end_s, step.after_percent),
        ),
        (step_keys::MODULUS_BEFORE, of_level(&before)),
        (step_keys::MODULUS_AFTER, of_level(&after)),
        (step_keys::RELATIVE_CHANGE, relative_change(&before, &after)),
        (
            step_keys::EQUILIBRIUM_TIME,
            of_relaxation(|found| &found.equilibrium_time_s),
        ),
        (
            step_keys::MODULUS_EQUILIBRIUM,
            of_relaxation(|found| &found.equilibrium),
        ),
        (step_keys::LOSS_FACTOR_BEFORE, factor(begin_s, step.start_s)),
        (step_keys::LOSS_FACTOR_AFTER, factor(step.settled_s, end_s)),
    ];
    let parameter = |(key, estimate): (&str, Estimate)| Parameter {
        key: key.to_owned(),
        estimate,
    };
    MeasuredStep {
        step: ModulusStep {
            start_s: step.start_s,
            settled_s: step.settled_s,
            end_s,
            estimates: estimates.into_iter().map(parameter).collect(),
        },
        before,
        after,
        humidity_percent: (step.before_percent, step.after_percent),
        relaxation: relaxation.ok(),
    }
}

fn of_level(level: &Result<Level, String>) -> Estimate {
    match level {
        Ok(level) => level.estimate(),
        Err(reason) => Estimate::not_determined(reason.as_str()),
    }
}

/// 100 (after / before - 1), percent.
fn relative_change(before: &Result<Level, String>, after: &Result<Level, String>) -> Estimate {
    let (before, after) = match (before, after) {
        (Ok(before), Ok(after)) => (before, after),
        (Err(reason), _) => return Estimate::not_determined(format!("no value before: {reason}")),
        (_, Err(reason)) => return Estimate::not_determined(format!("no value after: {reason}")),
    };
    if before.value <= 3.0 * before.half_width() {
        return Estimate::not_determined("the modulus before does not stand out from its uncertainty");
    }
    let ratio = after.value / before.value;
    let (of_before, of_after) = (
        100.0 * ratio * before.standard_error / before.value,
        100.0 * after.standard_error / before.value,
    );
    determined(
        100.0 * (ratio - 1.0),
        &[(of_before, before.freedom), (of_after, after.freedom)],
    )
}

/// A value from independent parts: standard error and degrees of freedom of each (Welch and Satterthwaite).
pub fn determined(value: f64, parts: &[(f64, f64)]) -> Estimate {
    let variance: f64 = parts.iter().map(|(error, _)| error * error).sum();
    let spread: f64 = parts.iter().map(|(error, freedom)| error.powi(4) / freedom).sum();
    let freedom = if spread > 0.0 {
        variance * variance / spread
    } else {
        f64::INFINITY
    };
    let level = Level {
        value,
        standard_error: variance.sqrt(),
        freedom,
    };
    level.estimate()
}

fn relax(
    moduli: &Moduli,
    step: &HumidityStep,
    end_s: f64,
    before: &Result<Level, String>,
    after: &Result<Level, String>,
) -> Result<Relaxation, String> {
    let (before, after) = match (before, after) {
        (Ok(before), Ok(after)) => (before, after),
        (Err(reason), _) | (_, Err(reason)) => return Err(reason.clone()),
    };
    if (after.value - before.value).abs() <= before.half_width().hypot(after.half_width()) {
        return Err("the modulus does not change by more than its uncertainty".to_owned());
    }
    relaxation::fit(&Stretch {
        time_s: &moduli.time_s,
        values: &moduli.complex_mpa,
        start_s: step.start_s,
        begun: step.begun,
        settled_s: step.settled_s,
        end_s,
        before: before.value,
        before_error: before.standard_error,
    })
}

/// Says that the plateau was not reached.
fn unsettled(relaxation: &Result<Relaxation, String>, step: &HumidityStep, end_s: f64) -> Option<Issue> {
    let time = &relaxation.as_ref().ok()?.equilibrium_time_s;
    if time.value.is_some() || time.high_95.is_some() {
        return None;
    }
    let message = format!(
        "the modulus has not come to rest within {} after the humidity went from {} to {} %: what is \
         stated is its value at the end of that time, not in equilibrium",
        duration(end_s - step.start_s),
        fixed(step.before_percent, 0),
        fixed(step.after_percent, 0)
    );
    Some(Issue::warning("plateau-not-reached", message).mend("hold the humidity for longer"))
}
