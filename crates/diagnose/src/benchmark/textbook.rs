//! What textbook criteria make of the same readings: the methods that a benchmark compares this diagnosis with.
//!
//! They take every reading as independent, as programs do that offer them: the size of the noise is found beside a
//! smooth curve, its memory is not looked at, and no limit is simulated.

use ieap_numerics::chance::chi_square_chance;
use ieap_numerics::sums::dot;

use crate::cause::candidates::fit_candidates;
use crate::cause::proof::{discrepancy, held_out};
use crate::fitting::base_fit;
use crate::fitting::fitted::Fitted;
use crate::fitting::scale::scale;
use crate::fitting::without_outliers::with_base;
use crate::misfit::signature;
use crate::options::DiagnoseOptions;
use crate::readings::group::{RunGroup, RunInput};

/// Steps of a forward selection at most.
const MOST_STEPS: usize = 3;
/// Lags of the test of Ljung and Box.
const LAGS: usize = 20;

/// What such criteria need of a group.
#[derive(Debug, Clone, PartialEq)]
pub struct Textbook {
    /// Readings.
    pub readings: usize,
    /// Smallest p of the tests of Ljung and Box (20 lags) over the channels of all runs, times their number.
    pub ljung_box_p: f64,
    /// Effects in the order in which a forward selection takes them.
    pub path: Vec<ForwardStep>,
    /// Fall of the sum of squares on held-out runs by a smooth answer to the voltage without a name, with the noise's
    /// memory known.
    pub nameless_gain: f64,
}

/// One effect taken.
#[derive(Debug, Clone, PartialEq)]
pub struct ForwardStep {
    /// Its id.
    pub effect: &'static str,
    /// Fall of the sum of squares by the full fit, in units of the noise's variance.
    pub gain: f64,
    /// Parameters that it adds.
    pub parameters: usize,
}

/// Follows a forward selection from the base model up to three effects; none where nothing can be fitted.
pub fn textbook(runs: &[RunInput], options: &DiagnoseOptions) -> Option<Textbook> {
    let raw = RunGroup::new(runs);
    let nameless_gain = with_base(&raw, options.model, |group, base| {
        let before = held_out::parts(&base, group);
        discrepancy::falls(&base, group, &before).iter().sum()
    })?;
    with_base(&raw, options.model, |group, base| {
        let white = group.memoryless(&base.problem.model(&base.at));
        let base = base_fit::refit(&white, &base)?;
        Some(Textbook {
            readings: white.rows(),
            ljung_box_p: ljung_box(&white, &base),
            path: path(&white, base),
            nameless_gain,
        })
    })?
}

fn path<'g>(group: &'g RunGroup<'g>, base: Fitted<'g>) -> Vec<ForwardStep> {
    let scale = scale(group, &base.problem, &base.at);
    let signatures = signature::signatures(&base.problem, &base.at, &scale);
    let mut model = base;
    let mut path = Vec::new();
    while path.len() < MOST_STEPS {
        let (_, tangent) = model.tangent();
        let directions = signature::directions(&signatures, &tangent);
        let mut candidates = fit_candidates(&model, &model.residuals(), &signatures, &directions, &[]);
        if candidates.is_empty() {
            break;
        }
        let best = candidates.swap_remove(0);
        let Some(fitted) = best.fitted else { break };
        path.push(ForwardStep {
            effect: best.effect,
            gain: model.square - fitted.square,
            parameters: fitted.extra() - model.extra(),
        });
        model = fitted;
    }
    path
}

/// The test of Ljung and Box on the residuals of every channel of every run, Bonferroni over them.
fn ljung_box(group: &RunGroup, base: &Fitted) -> f64 {
    let residuals = base.residuals();
    let p = group
        .blocks
        .iter()
        .map(|block| whiteness(&residuals[block.first..block.end]));
    (p.fold(1.0, f64::min) * group.blocks.len() as f64).min(1.0)
}

/// Chance of autocorrelations as large in white noise.
fn whiteness(series: &[f64]) -> f64 {
    let n = series.len();
    let lags = LAGS.min(n / 4);
    let whole = dot(series, series);
    let statistic: f64 = (1..=lags)
        .map(|lag| {
            let r = dot(&series[lag..], &series[..n - lag]) / whole;
            r * r / (n - lag) as f64
        })
        .sum();
    chi_square_chance((n * (n + 2)) as f64 * statistic, lags)
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    #[test]
    fn white_noise_passes_in_95_of_100_and_noise_with_memory_hardly_ever() {
        let mut random = ChaCha8Rng::seed_from_u64(2);
        let mut passed = |rho: f64| -> usize {
            let one = |_| {
                let mut state = 0.0;
                let series: Vec<f64> = (0..500)
                    .map(|_| {
                        let fresh: f64 = StandardNormal.sample(&mut random);
                        state = rho * state + fresh;
                        state
                    })
                    .collect();
                usize::from(whiteness(&series) > 0.05)
            };
            (0..400).map(one).sum()
        };
        // 380 expected; fewer than 360 by chance in 1 of 100,000 tries.
        let white = passed(0.0);
        assert!((360..=398).contains(&white), "{white}");
        assert!(passed(0.4) < 4);
    }
}
