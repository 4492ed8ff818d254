//! Is a change of alpha one of stiffness or of coupling? A strip bends by kappa = alpha q with alpha = mu / (E I) (the
//! thesis's equations 7, 8, 15 and 16): the modulus logs give E at a humidity, the dimensions give I, and so mu; a blocking
//! force gives mu without a modulus.

mod both_ways;
mod rows;
mod words;

pub use both_ways::{Ratios, both_ways};
pub use rows::{Change, SampleRow, sample_rows};
pub use words::{answer, sentences};

use ieap_domain::modulus::step_keys;
use ieap_domain::quantiles::NORMAL_95;
use ieap_domain::tag::keys;
use ieap_domain::{Estimate, ModulusLog, Sample};

/// Humidity beyond that of a log at which its nearest level still stands for it, percent: levels of that width are one
/// condition elsewhere, too.
const BEYOND_PERCENT: f64 = 5.0;

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
            if (nearest.humidity_percent - humidity).abs() > BEYOND_PERCENT {
                return Estimate::not_determined("the humidity lies outside those of the modulus logs");
            }
            (nearest.logarithm, nearest.error)
        }
    };
    of_logarithm(logarithm, error)
}

fn between(below: ModulusPoint, above: ModulusPoint, humidity: f64) -> (f64, f64) {
    let width = above.humidity_percent - below.humidity_percent;
    let share = match width > 0.0 {
        true => (humidity - below.humidity_percent) / width,
        false => 0.5,
    };
    let logarithm = (1.0 - share) * below.logarithm + share * above.logarithm;
    (
        logarithm,
        ((1.0 - share) * below.error).hypot(share * above.error),
    )
}

fn of_logarithm(logarithm: f64, error: f64) -> Estimate {
    let value = logarithm.exp();
    let width = (NORMAL_95 * error).exp();
    Estimate::determined(value, value * error, value / width, value * width)
}

/// Second moment of the cross-section of a strip, m4: b h^3 / 12 about its middle (the thesis's equation 8); none
/// without width and thickness.
pub fn second_moment_m4(sample: &Sample) -> Option<f64> {
    const PER_MM: f64 = 1e-3;
    let (width, thickness) = (sample.width_mm? * PER_MM, sample.thickness_mm? * PER_MM);
    Some(width * thickness.powi(3) / 12.0)
}

/// The product of independent positive numbers, each with its power; what one of them lacks, it lacks.
pub fn product(factors: &[(&Estimate, f64)]) -> Estimate {
    let (mut logarithm, mut variance) = (0.0, 0.0);
    for (factor, power) in factors {
        let known = factor
            .value
            .filter(|value| *value > 0.0)
            .zip(factor.standard_error);
        let Some((value, error)) = known else {
            let reason = factor.reason.clone();
            return Estimate::not_determined(
                reason.unwrap_or_else(|| "a part of it is not determined".to_owned()),
            );
        };
        logarithm += power * value.ln();
        variance += (power * error / value).powi(2);
    }
    of_logarithm(logarithm, variance.sqrt())
}

/// A coupling may bend the other way: its size is what is split.
pub(crate) fn size(alpha: &Estimate) -> Estimate {
    scaled(alpha, alpha.value.map_or(1.0, f64::signum))
}

/// An estimate in another unit.
pub(crate) fn scaled(estimate: &Estimate, factor: f64) -> Estimate {
    let times = |number: Option<f64>| number.map(|number| number * factor);
    let (low, high) = match factor < 0.0 {
        true => (estimate.high_95, estimate.low_95),
        false => (estimate.low_95, estimate.high_95),
    };
    Estimate {
        value: times(estimate.value),
        standard_error: estimate.standard_error.map(|error| error * factor.abs()),
        low_95: times(low),
        high_95: times(high),
        ..estimate.clone()
    }
}

/// What a change of alpha comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// Alpha does not change beyond its uncertainty.
    None,
    /// The stiffness alone changes beyond its uncertainty, in that direction.
    Stiffness,
    /// The coupling mu alone does.
    Coupling,
    /// Both do.
    Both,
    /// Neither is known well enough, or one is not known at all.
    Open,
}

impl Cause {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Cause::None => "no change",
            Cause::Stiffness => "stiffness",
            Cause::Coupling => "coupling",
            Cause::Both => "stiffness and coupling",
            Cause::Open => "not told",
        }
    }
}

/// What makes alpha another, from the ratios of alpha, of the stiffness E I and of the coupling mu to those of a
/// reference.
pub fn cause(alpha: &Estimate, stiffness: &Estimate, coupling: &Estimate) -> Cause {
    let changes = |ratio: &Estimate| {
        let (low, high) = ratio.low_95.zip(ratio.high_95)?;
        Some(low > 1.0 || high < 1.0)
    };
    match (changes(alpha), changes(stiffness), changes(coupling)) {
        (Some(false), ..) => Cause::None,
        (Some(true), Some(true), Some(true)) => Cause::Both,
        (Some(true), Some(true), Some(false)) => Cause::Stiffness,
        (Some(true), Some(false), Some(true)) => Cause::Coupling,
        _ => Cause::Open,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::testing::{campaign, known};

    fn point(humidity_percent: f64, modulus_mpa: f64) -> ModulusPoint {
        ModulusPoint {
            humidity_percent,
            logarithm: modulus_mpa.ln(),
            error: 0.02,
        }
    }

    #[test]
    fn the_modulus_between_two_humidities_is_their_geometric_mean() {
        let points = [point(0.0, 400.0), point(40.0, 100.0)];
        let half = modulus_at(&points, Some(20.0));
        assert!((half.value.unwrap() - 200.0).abs() < 1e-9);
        assert!((half.standard_error.unwrap() - 200.0 * 0.02 / 2.0_f64.sqrt()).abs() < 1e-9);
        assert!((modulus_at(&points, Some(43.0)).value.unwrap() - 100.0).abs() < 1e-9);
        for (humidity, reason) in [(Some(60.0), "outside"), (None, "not known")] {
            let open = modulus_at(&points, humidity);
            assert!(open.value.is_none() && open.reason.unwrap().contains(reason));
        }
        assert!(modulus_at(&[], Some(20.0)).value.is_none());
    }

    #[test]
    fn a_strip_of_known_stiffness() {
        // 2 mm x 0.22 mm: 1.775e-15 m4; with 400 MPa 7.1e-7 N m2.
        let sample = &campaign().samples[0];
        let moment = second_moment_m4(sample).unwrap();
        assert!((moment / (2e-3 * 0.22e-3_f64.powi(3) / 12.0) - 1.0).abs() < 1e-12);
        let thin = Sample {
            thickness_mm: None,
            ..sample.clone()
        };
        assert_eq!(second_moment_m4(&thin), None);
    }

    #[test]
    fn a_halved_alpha_is_told_apart() {
        let half = known(0.5, 0.05);
        let twice = known(2.0, 0.05);
        let same = known(1.0, 0.05);
        // alpha = mu / EI: twice as stiff, or half the coupling.
        assert_eq!(cause(&half, &twice, &same), Cause::Stiffness);
        assert_eq!(cause(&half, &same, &half), Cause::Coupling);
        assert_eq!(cause(&known(0.25, 0.05), &twice, &half), Cause::Both);
        assert_eq!(cause(&same, &twice, &twice), Cause::None);
        let open = Estimate::not_determined("no log");
        assert_eq!(cause(&half, &open, &open), Cause::Open);
        let mu = product(&[(&half, 1.0), (&twice, 1.0)]);
        assert!((mu.value.unwrap() - 1.0).abs() < 1e-12);
        let error = mu.standard_error.unwrap();
        assert!((error - 0.05 * 2.0_f64.sqrt()).abs() < 1e-12, "{error}");
        assert!(product(&[(&half, 1.0), (&open, -1.0)]).value.is_none());
    }
}
