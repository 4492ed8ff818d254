//! Modulus logs: what a humidity step does to the modulus. docs/dma.md says how each number is had.

pub mod charts;
pub mod exponentials;
pub mod humidity_steps;
pub mod level;
pub mod levels;
pub mod moduli;
pub mod policy;
pub mod relaxation;
pub mod round_trip;
pub mod sheet;
pub mod step;
pub mod table;
#[cfg(test)]
mod tests;
pub mod view;

use humidity_steps::HumiditySteps;
use ieap_domain::{Channel, Issue, ModulusAnalysis, Quantity, RunCurve};
use moduli::Moduli;
use step::Series;

/// Version of the analysis: raised when the same readings give other numbers.
pub const VERSION: u32 = 2;

/// Finds the humidity steps of a modulus log and what the modulus does at each.
///
/// # Errors
/// Why there is no complex modulus to analyse.
pub fn analyse(channels: &[Channel]) -> Result<ModulusAnalysis, Issue> {
    let mut moduli = moduli::moduli(channels)?;
    let mut issues = std::mem::take(&mut moduli.issues);
    let humidity = moduli::channel(channels, Quantity::RelativeHumidity).map(Channel::included);
    let found = match &humidity {
        Some((time_s, percent)) => humidity_steps::find(time_s, percent),
        None => {
            let issue = Issue::warning(
                "no-humidity",
                "the log has no humidity channel: no humidity step can be found in it",
            );
            let mend = "add the humidity logger's file as <name>.humidity.csv beside <name>.modulus.csv, or \
                        say which column it is, as in relative_humidity_column = \"RH\"";
            issues.push(issue.mend(mend));
            HumiditySteps::default()
        }
    };
    issues.extend(found.issue.clone());
    let series = Series {
        moduli: &moduli,
        humidity: humidity
            .as_ref()
            .map(|(time_s, percent)| (&time_s[..], &percent[..])),
    };
    let steps = found.steps.iter();
    let measured: Vec<step::MeasuredStep> = steps
        .map(|&step| step::measure(&series, step, &mut issues))
        .collect();
    let estimates = round_trip::estimates(&measured);
    let curves = curves(channels, &moduli, &measured);
    Ok(ModulusAnalysis {
        version: VERSION,
        modulus_source: moduli.source.clone(),
        frequency_hz: moduli.frequency_hz,
        temperature_c: moduli::channel(channels, Quantity::Temperature).and_then(range),
        readings: moduli.time_s.len(),
        steps: measured.into_iter().map(|measured| measured.step).collect(),
        estimates,
        issues,
        curves,
    })
}

/// Smallest and largest reading.
fn range(channel: &Channel) -> Option<(f64, f64)> {
    let (_, values) = channel.included();
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (low <= high).then_some((low, high))
}

/// Stretches of time that a drawn curve is thinned over.
const DRAWN_STRETCHES: usize = 200;

/// |E*| with the fitted relaxations, and the other channels as they are drawn.
fn curves(channels: &[Channel], moduli: &Moduli, steps: &[step::MeasuredStep]) -> Vec<RunCurve> {
    let origin_s = steps.first().map_or(0.0, |first| first.step.start_s);
    let drawn = |quantity, time_s: &[f64], values: &[f64]| {
        let kept = ieap_domain::thinning::drawn_indices(time_s, &[values], origin_s, DRAWN_STRETCHES);
        RunCurve {
            quantity,
            time_s: kept.iter().map(|&k| time_s[k]).collect(),
            measured: kept.iter().map(|&k| values[k]).collect(),
            fitted: Vec::new(),
            residual_sigma: Vec::new(),
            readings: values.len(),
        }
    };
    let mut complex = drawn(Quantity::ComplexModulus, &moduli.time_s, &moduli.complex_mpa);
    if steps.iter().any(|step| step.relaxation.is_some()) {
        complex.fitted = complex.time_s.iter().map(|&t| fitted_at(steps, t)).collect();
    }
    let mut curves = vec![complex];
    if let Some(loss_factor) = &moduli.loss_factor {
        curves.push(drawn(Quantity::LossFactor, &moduli.time_s, loss_factor));
    }
    let others = [
        Quantity::StorageModulus,
        Quantity::LossModulus,
        Quantity::RelativeHumidity,
        Quantity::Temperature,
    ];
    for quantity in others {
        if let Some(channel) = moduli::channel(channels, quantity) {
            let (time_s, values) = channel.included();
            curves.push(drawn(quantity, &time_s, &values));
        }
    }
    curves
}

/// The fitted relaxation at a time; no number where none covers it.
fn fitted_at(steps: &[step::MeasuredStep], time_s: f64) -> f64 {
    let covers =
        |measured: &&step::MeasuredStep| (measured.step.settled_s..=measured.step.end_s).contains(&time_s);
    let relaxation = steps
        .iter()
        .find(covers)
        .and_then(|step| step.relaxation.as_ref());
    relaxation.map_or(f64::NAN, |relaxation| relaxation.at(time_s))
}
