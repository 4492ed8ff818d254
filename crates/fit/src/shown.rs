//! Whether a curvature shows what bends the strip: as the model has it, otherwise, or not at all.

use ieap_numerics::robust::sd_on_a_slope;
use ieap_numerics::sums;

use crate::interval_rule::{FLAT, NOT_DESCRIBED};
use crate::policy::{BENDING_EVIDENCE, DIFFERS_SIGMAS};
use crate::sampled::Sampled;
use crate::uncertainty::Residuals;

/// What a curvature shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shown {
    /// A response to the charge, beside all that the model leaves.
    Response,
    /// More than its noise, but no such response.
    Otherwise,
    /// Nothing but noise.
    Nothing,
}

impl Shown {
    /// From what a fit leaves: against a constant where an offset was fitted, else against nothing.
    pub(super) fn of(residuals: &Residuals, sampled: &Sampled, with_offset: bool) -> Shown {
        let values = &sampled.values;
        let mean = if with_offset {
            sums::sum(values) / values.len() as f64
        } else {
            0.0
        };
        let gain = sums::square_about(values, mean) - residuals.square;
        let is_response = gain > BENDING_EVIDENCE * residuals.long_run_variance(sums::peak(values));
        Shown::beside(is_response, sampled, with_offset)
    }

    /// Where that is known already.
    pub(super) fn beside(is_response: bool, sampled: &Sampled, with_offset: bool) -> Shown {
        if is_response {
            Shown::Response
        } else if differs_from_noise(sampled, with_offset) {
            Shown::Otherwise
        } else {
            Shown::Nothing
        }
    }

    /// Whether it is a response to the charge.
    pub(super) fn is_response(self) -> bool {
        self == Shown::Response
    }

    /// Why there are no parameters of the bending; none where it is a response.
    pub(super) fn why_open(self) -> Option<&'static str> {
        match self {
            Shown::Response => None,
            Shown::Otherwise => Some(NOT_DESCRIBED),
            Shown::Nothing => Some(FLAT),
        }
    }
}

/// Whether a mean of neighbouring readings stands farther off the level before the step than the noise of these readings, found
/// without any model, leaves of a mean.
fn differs_from_noise(sampled: &Sampled, with_offset: bool) -> bool {
    let values = &sampled.values;
    let (sd, correlation, window) = match &sampled.scatter {
        Some(noise) => (noise.standard_deviation, noise.correlation, noise.window),
        None => (sd_on_a_slope(values), 0.0, 1),
    };
    let memory = (1.0 + correlation) / (1.0 - correlation).max(f64::MIN_POSITIVE);
    // What is rounded is not known better than its last digit.
    let steps = values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let digit = steps
        .filter(|step| *step > 0.0)
        .min_by(f64::total_cmp)
        .unwrap_or(0.0);
    let rest = sampled.at_rest();
    let of_rest = rest.as_ref().map_or(0.0, |rest| rest.long_run_variance);
    let variance = (sd * sd * memory.max(1.0)).max(digit * digit / 12.0).max(of_rest);
    let before = sampled.before_step();
    let level = rest.filter(|_| with_offset).map_or(0.0, |rest| rest.mean);
    let of_level = if with_offset {
        variance / before as f64
    } else {
        0.0
    };
    let noise = (variance / window as f64 + of_level).sqrt();
    let means = values[before..]
        .chunks_exact(window)
        .map(|own| sums::sum(own) / window as f64);
    means
        .map(|mean| (mean - level).abs())
        .any(|off| off > DIFFERS_SIGMAS * noise)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::{Channel, Drive, Quantity};
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    /// Noise of correlation `rho` about a level that goes from `before` to `after` at the step.
    fn sampled(readings: i32, [before, after]: [f64; 2], rho: f64, seed: u64) -> Sampled {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut last = 0.0;
        let mut next = || {
            let fresh: f64 = StandardNormal.sample(&mut random);
            last = rho * last + (1.0 - rho * rho).sqrt() * fresh;
            last
        };
        let time_s = (-readings / 5..readings).map(f64::from).collect();
        let level = |k: i32| if k < 0 { before } else { after };
        let values = (-readings / 5..readings).map(|k| level(k) + next()).collect();
        let channel = Channel::new(Quantity::Curvature, time_s, values);
        Sampled::new(&channel, &Drive::step(2.0), true)
    }

    #[test]
    fn noise_that_remembers_does_not_differ_from_itself_and_a_level_does() {
        for rho in [-0.5, 0.0, 0.5, 0.8] {
            let differ = |levels: [f64; 2], with_offset: bool, readings: i32| {
                let of = |seed| differs_from_noise(&sampled(readings, levels, rho, seed), with_offset);
                (0..100).filter(|seed| of(*seed)).count()
            };
            for readings in [50, 400, 2000] {
                // Fifty readings do not tell a long memory.
                let most = if readings == 50 { 3 } else { 0 };
                assert!(differ([0.0, 0.0], false, readings) <= most, "{rho} {readings}");
                assert!(differ([500.0, 500.0], true, readings) <= most, "{rho} {readings}");
                assert_eq!(differ([0.0, 300.0], false, readings), 100, "{rho} {readings}");
                assert_eq!(differ([500.0, 800.0], true, readings), 100, "{rho} {readings}");
            }
        }
    }

    #[test]
    fn a_last_digit_that_turns_now_and_then_is_noise() {
        let time_s = (-20..200).map(f64::from).collect();
        let values = (-20..200).map(|k| f64::from(u8::from(k % 37 == 5))).collect();
        let channel = Channel::new(Quantity::Curvature, time_s, values);
        let sampled = Sampled::new(&channel, &Drive::step(2.0), true);
        assert!(!differs_from_noise(&sampled, false));
    }
}
