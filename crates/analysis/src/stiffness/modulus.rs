//! What E I is made of: the modulus at a humidity, and the cross-section.

use ieap_domain::modulus::step_keys;
use ieap_domain::tag::keys;
use ieap_domain::{Campaign, Estimate, ModulusLog, Sample};

use super::estimates::of_logarithm;
use crate::conditions::HUMIDITY_GAP_PERCENT;

/// |E*| of a material at a humidity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModulusPoint {
    /// Humidity, percent.
    pub humidity_percent: f64,
    /// Natural logarithm of |E*| in MPa.
    pub logarithm: f64,
    /// Its standard error.
    pub error: f64,
}

/// What the logs of samples say, by rising humidity: the level before the first step of each log and the end of each
/// stretch.
pub fn modulus_points(logs: &[ModulusLog], is_of: impl Fn(&str) -> bool) -> Vec<ModulusPoint> {
    let own = |log: &&ModulusLog| log.run.tag(keys::SAMPLE).is_some_and(&is_of);
    let mut points = Vec::new();
    for log in logs.iter().filter(own) {
        let steps = log.analysis.iter().flat_map(|found| &found.steps);
        for (ordinal, step) in steps.enumerate() {
            let at = |humidity: &str, modulus: &str| {
                let humidity_percent = step.estimate(humidity)?.value?;
                let modulus = step.estimate(modulus)?;
                let value = modulus.value.filter(|value| *value > 0.0)?;
                Some(ModulusPoint {
                    humidity_percent,
                    logarithm: value.ln(),
                    error: modulus.standard_error? / value,
                })
            };
            if ordinal == 0 {
                points.extend(at(step_keys::HUMIDITY_BEFORE, step_keys::MODULUS_BEFORE));
            }
            points.extend(at(step_keys::HUMIDITY_AFTER, step_keys::MODULUS_AFTER));
        }
    }
    points.sort_by(|a, b| a.humidity_percent.total_cmp(&b.humidity_percent));
    points
}

/// |E*| of a sample at a humidity, MPa: from the sample's own logs, else from those of its material; and the paths of those.
pub fn sample_modulus<'a>(
    logs: &'a [ModulusLog],
    campaign: &Campaign,
    sample: Option<&Sample>,
    humidity_percent: Option<f64>,
) -> (Estimate, Vec<&'a str>) {
    let Some(sample) = sample else {
        return (modulus_at(&[], humidity_percent), Vec::new());
    };
    let is_own = |id: &str| id == sample.id;
    let is_of_material = |id: &str| {
        let of = campaign.sample(id);
        of.is_some_and(|of| of.material == sample.material)
    };
    let own = modulus_points(logs, is_own);
    let has_own = !own.is_empty();
    let points = if has_own {
        own
    } else {
        modulus_points(logs, is_of_material)
    };
    let is_meant = |log: &&ModulusLog| {
        let sample = log.run.tag(keys::SAMPLE);
        sample.is_some_and(|id| if has_own { is_own(id) } else { is_of_material(id) })
    };
    let meant = logs.iter().filter(is_meant);
    let paths = meant.map(|log| log.run.path.as_str()).collect();
    (modulus_at(&points, humidity_percent), paths)
}

/// |E*| at a humidity, MPa: between two levels its logarithm goes on a line.
pub fn modulus_at(points: &[ModulusPoint], humidity_percent: Option<f64>) -> Estimate {
    if points.is_empty() {
        return Estimate::not_determined("no modulus log of the material has a humidity step");
    }
    let Some(humidity) = humidity_percent else {
        return Estimate::not_determined("the humidity of the runs is not known");
    };
    let above = points.iter().position(|point| point.humidity_percent >= humidity);
    let (logarithm, error) = match above {
        Some(at) if at > 0 => between(points[at - 1], points[at], humidity),
        other => {
            let nearest = points[other.unwrap_or(points.len() - 1)];
            // Beyond a log its nearest level stands for what is one condition with it.
            if (nearest.humidity_percent - humidity).abs() > HUMIDITY_GAP_PERCENT {
                return Estimate::not_determined("the humidity lies outside those of the modulus logs");
            }
            (nearest.logarithm, nearest.error)
        }
    };
    of_logarithm(logarithm, error)
}

fn between(below: ModulusPoint, above: ModulusPoint, humidity: f64) -> (f64, f64) {
    let width = above.humidity_percent - below.humidity_percent;
    let share = if width > 0.0 {
        (humidity - below.humidity_percent) / width
    } else {
        0.5
    };
    let logarithm = (1.0 - share) * below.logarithm + share * above.logarithm;
    (
        logarithm,
        ((1.0 - share) * below.error).hypot(share * above.error),
    )
}

/// Second moment of the cross-section of a strip, m4: b h^3 / 12 about its middle (the thesis's equation 8); none
/// without width and thickness.
pub fn second_moment_m4(sample: &Sample) -> Option<f64> {
    const PER_MM: f64 = 1e-3;
    let (width, thickness) = (sample.width_mm? * PER_MM, sample.thickness_mm? * PER_MM);
    Some(width * thickness.powi(3) / 12.0)
}
