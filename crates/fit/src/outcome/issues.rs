//! What a reader of a fit must know beside its numbers.

use crate::circuit::held_voltage;
use crate::joint::single::Judged;
use crate::joint_estimates::{choice_in_words, two_step_choice_in_words};
use crate::sampled::Sampled;
use crate::two_steps::Identified;
use crate::zero::Zero;
use ieap_domain::number::{interval, rounded_bound, significant};
use ieap_domain::{Drive, EstimateState, Issue, Level, Parameter};
use ieap_numerics::decay::Block;
use ieap_numerics::least_squares::Stop;

pub(crate) fn not_converged(stop: Stop) -> Issue {
    Issue::warning(
        "not-converged",
        format!("the search did not settle: {}", stop.words()),
    )
}

/// Notes on parameters without a value.
pub(crate) fn parameter_issues(parameters: &[Parameter]) -> Vec<Issue> {
    let mut issues = Vec::new();
    for parameter in parameters {
        let estimate = &parameter.estimate;
        let Some(reason) = &estimate.reason else { continue };
        let (code, what) = match estimate.state() {
            EstimateState::Determined(_) => continue,
            EstimateState::Between(low, high) => (
                "parameter-bounded",
                format!("only bounds are known, {}", interval(low, high)),
            ),
            EstimateState::Above(low) => (
                "parameter-bounded",
                format!(
                    "only a lower bound is known, {}",
                    rounded_bound(low, false).value_text()
                ),
            ),
            EstimateState::Below(high) => (
                "parameter-bounded",
                format!(
                    "only an upper bound is known, {}",
                    rounded_bound(high, true).value_text()
                ),
            ),
            EstimateState::Open => ("parameter-not-determined", "not determined".to_owned()),
        };
        issues.push(Issue::note(code, format!("{what}: {reason}")).at(parameter.key.as_str()));
    }
    issues
}

pub(super) fn issues(
    drive: &Drive,
    identified: &Identified,
    parameters: &[Parameter],
    judged: Option<&Judged>,
) -> Vec<Issue> {
    let mut issues = parameter_issues(parameters);
    let weighings = judged.map_or(&[][..], |judged| &judged.weighings);
    for evidence in weighings.iter().filter(|evidence| evidence.gain.is_finite()) {
        issues.push(Issue::note("model-choice", choice_in_words(evidence)));
    }
    if let (true, Ok((_, electrical))) = (weighings.is_empty(), &identified.current)
        && let Some(words) = two_step_choice_in_words(electrical)
    {
        issues.push(Issue::note("model-choice", words));
    }
    if let Ok((sampled, electrical)) = &identified.current
        && electrical.conductances_a_per_v.is_empty()
        && electrical.steady_a_per_v == 0.0
        && flows_backwards(drive, sampled)
    {
        let message = "the current flows against the voltage: no resistor or capacitor does that";
        let issue = Issue::warning("current-against-voltage", message).at("column current_a");
        issues
            .push(issue.mend(
                "check the sign of current and voltage: instruments differ in what they call positive",
            ));
    }
    if let Ok((_, electrical)) = &identified.current
        && let Some(zero) = judged.map_or_else(|| electrical.zero(), |judged| judged.zeros[0])
        && zero.is_plain()
    {
        let message = format!(
            "the current is off by {} A at every voltage, which no resistor explains; fitted as the instrument's zero",
            significant(zero.value, 5)
        );
        issues.push(Issue::note("current-offset", message).at("column current_a"));
    }
    if let Ok((_, bending)) = &identified.curvature
        && let Some(zero) = judged.map_or(bending.zero, |judged| judged.zeros[1])
        && zero.is_plain()
    {
        issues.push(bent_at_rest(zero));
    }
    let unfinished = [
        identified
            .current
            .as_ref()
            .ok()
            .map(|(_, electrical)| electrical.stop),
        identified
            .curvature
            .as_ref()
            .ok()
            .map(|(_, bending)| bending.stop),
    ];
    let afterwards = judged.map(|judged| judged.stop);
    for stop in unfinished
        .into_iter()
        .chain([afterwards])
        .flatten()
        .filter(|stop| !stop.converged())
    {
        issues.push(not_converged(stop));
    }
    issues
}

/// What is said of a strip that is bent before the step.
pub(crate) fn bent_at_rest(zero: Zero) -> Issue {
    let message = format!(
        "the strip is bent by {} 1/cm before the step; fitted as an offset",
        significant(zero.value, 5)
    );
    Issue::note("initial-curvature", message).at("column curvature_per_cm")
}

/// Whether the current after the step is on the whole opposite to the first change of the voltage.
fn flows_backwards(drive: &Drive, sampled: &Sampled) -> bool {
    if sampled.moves {
        let block = |(segment, block): &(Option<usize>, Block)| {
            let readings = &sampled.values[block.first..block.first + block.len];
            held_voltage(drive, *segment) * readings.iter().sum::<f64>()
        };
        // What is passive takes up energy.
        return sampled.blocks.iter().map(block).sum::<f64>() < 0.0;
    }
    let held = drive.segments.iter().find_map(|segment| match segment.level {
        Level::Voltage(level_v) if level_v != drive.baseline_v => Some(level_v - drive.baseline_v),
        _ => None,
    });
    let after = &sampled.values[sampled.before_step()..];
    held.is_some_and(|change_v| change_v * after.iter().sum::<f64>() < 0.0)
}
