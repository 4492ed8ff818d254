//! The modulus of a strip, from the modulus logs of its sample or of its material.

use crate::domain::modulus::step_keys;
use crate::domain::tag::keys;
use crate::domain::{Estimate, ModulusLog, ModulusStep, Sample};

use crate::pipeline::campaign::standing;
use crate::pipeline::{Context, PipelineError};

/// A modulus is taken at a humidity at most this far from the one asked for, percent RH: in the thesis's table 4 a
/// modulus falls by 1 % of its value per percent of humidity, so that more would add a tenth of it.
const FARTHEST_HUMIDITY_PERCENT: f64 = 10.0;

/// A modulus with where it is from.
#[derive(Debug, Clone, PartialEq)]
pub struct StripModulus {
    /// MPa; not determined, with the reason, where no log has it.
    pub modulus_mpa: Estimate,
    /// Where it is from, one sentence; empty where there is none.
    pub source: String,
}

/// A level of humidity that a log held.
struct Held<'a> {
    log: &'a ModulusLog,
    is_own: bool,
    humidity_percent: f64,
    modulus: &'a Estimate,
}

/// The modulus |E*| that a log of that sample, else of another of its material, has at the humidity.
///
/// # Errors
/// The database cannot be read.
pub fn strip_modulus(
    context: &Context,
    sample: &Sample,
    humidity_percent: Option<f64>,
) -> Result<StripModulus, PipelineError> {
    let (logs, _) = standing::modulus_logs(context)?;
    let none = |reason: String| StripModulus {
        modulus_mpa: Estimate::not_determined(reason),
        source: String::new(),
    };
    let mut held: Vec<Held> = Vec::new();
    for log in &logs {
        let of = log
            .run
            .tag(keys::SAMPLE)
            .and_then(|id| context.campaign.sample(id));
        if let Some(of) = of.filter(|of| of.material == sample.material) {
            held.extend(levels(log, of.id == sample.id));
        }
    }
    if held.is_empty() {
        let material = &sample.material;
        return Ok(none(format!(
            "no modulus log of {material} has a humidity step; give --modulus"
        )));
    }
    let Some(asked) = humidity_percent else {
        return Ok(none(
            "the modulus depends on the humidity, which is not known here; give --rh or --modulus".to_owned(),
        ));
    };
    held.retain(|level| (level.humidity_percent - asked).abs() <= FARTHEST_HUMIDITY_PERCENT);
    let nearness = |level: &Held| (!level.is_own, (level.humidity_percent - asked).abs());
    held.sort_by(|a, b| {
        nearness(a)
            .partial_cmp(&nearness(b))
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    let Some(best) = held.first() else {
        return Ok(none(format!(
            "no modulus log of {} holds a humidity within {FARTHEST_HUMIDITY_PERCENT} % of {asked} % RH; give --modulus",
            sample.material
        )));
    };
    Ok(StripModulus {
        modulus_mpa: best.modulus.clone(),
        source: format!(
            "modulus from {} at {:.0} % RH, in oscillation; bending over minutes may meet a smaller one",
            best.log.run.path, best.humidity_percent
        ),
    })
}

/// Levels before and after every step, with a modulus.
fn levels(log: &ModulusLog, is_own: bool) -> Vec<Held<'_>> {
    let steps = log.analysis.iter().flat_map(|analysis| &analysis.steps);
    let of_step = |step| {
        let before = level(step, step_keys::HUMIDITY_BEFORE, step_keys::MODULUS_BEFORE);
        let after = level(step, step_keys::HUMIDITY_AFTER, step_keys::MODULUS_AFTER);
        before.into_iter().chain(after)
    };
    let all = steps.flat_map(of_step);
    all.map(|(humidity_percent, modulus)| Held {
        log,
        is_own,
        humidity_percent,
        modulus,
    })
    .collect()
}

fn level<'a>(step: &'a ModulusStep, humidity: &str, modulus: &str) -> Option<(f64, &'a Estimate)> {
    let humidity = step.estimate(humidity)?.value?;
    let modulus = step.estimate(modulus)?;
    modulus.value.map(|_| (humidity, modulus))
}
