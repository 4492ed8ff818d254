//! Values of the reference condition brought to one humidity and one temperature: the seasons that the tolerance of the
//! condition lets in are no ageing.
//!
//! The runs of a strip tell by themselves how its parameter follows either, in a mixed model whose level drifts and steps by
//! chance from run to run, so that what stays is not taken for what comes back.

use ieap_numerics::grouped::Grouped;
use ieap_numerics::mixed::{Estimated, MixedModel, Reading, Unit, Width};

use super::policy::MOST_LEVELS;
use crate::laws::covariate::Covariate;
use crate::laws::facts::RunFacts;
use crate::laws::values::Values;

/// A covariate with the value to which a series was brought.
pub type Brought = (Covariate, f64);

/// What a series tells of a condition that differs within it.
struct Told {
    of: Covariate,
    mean: f64,
    /// The condition of each value, less the mean.
    off: Vec<f64>,
}

/// Brings the values of one sample to the mean humidity and the mean temperature of their runs, as far as what they tell of
/// these stands out of chance (the estimate of James and Stein), with what that leaves open in their errors. `order`: places of
/// the values in the order of the runs.
pub fn bring(found: &mut Values, facts: &[RunFacts], order: &[usize]) -> Vec<Brought> {
    let told: Vec<Told> = [Covariate::RelativeHumidity, Covariate::Temperature]
        .into_iter()
        .filter_map(|of| differing(found, facts, of))
        .collect();
    let mut grouped = Grouped::new(&vec![1.0; found.values.len()], &vec![0; found.values.len()], &[]);
    let told: Vec<Told> = told
        .into_iter()
        .filter(|own| grouped.take_out(&own.off))
        .collect();
    if told.is_empty() {
        return Vec::new();
    }
    let Some(law) = model(found, &told, order).estimated() else {
        return Vec::new();
    };
    let part = part(&law, told.len());
    if part.is_nan() || part <= 0.0 {
        return Vec::new();
    }
    for (k, value) in found.values.iter_mut().enumerate() {
        let factors: Vec<f64> = std::iter::once(0.0)
            .chain(told.iter().map(|own| -own.off[k]))
            .collect();
        let by = law.combined(&factors);
        value.y += part * by.mean();
        value.variance += part * by.error().powi(2);
    }
    told.iter().map(|own| (own.of, own.mean)).collect()
}

/// A condition that all runs state and that is not the same in all of them.
fn differing(found: &Values, facts: &[RunFacts], of: Covariate) -> Option<Told> {
    let own = |place: usize| Some(facts[place].numbers.get(&of)?.value);
    let x: Vec<f64> = found
        .values
        .iter()
        .map(|value| own(value.place))
        .collect::<Option<_>>()?;
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    let off = x.iter().map(|x| x - mean).collect();
    x.iter().any(|own| *own != x[0]).then_some(Told { of, mean, off })
}

/// The part of what is told that stands out of chance: 1 less what its square would be of nothing, over what it is.
fn part(law: &Estimated, told: usize) -> f64 {
    let keep: Vec<usize> = (1..=told).collect();
    let weighed = law.covariance.part(&keep).solve(&law.coefficients[1..], 1e-12);
    let square: f64 = weighed
        .iter()
        .zip(&law.coefficients[1..])
        .map(|(a, b)| a * b)
        .sum();
    1.0 - told as f64 / square
}

/// The level and what is told as fixed; steps between runs by chance, at most [`MOST_LEVELS`] of them, spread evenly.
fn model(found: &Values, told: &[Told], order: &[usize]) -> MixedModel {
    let last = order.len().saturating_sub(1);
    let steps = last.min(MOST_LEVELS);
    let mut units: Vec<Unit> = Vec::new();
    for (at, &k) in order.iter().enumerate() {
        let (value, variance) = (found.values[k].y, found.values[k].variance);
        units.push(Unit {
            block: 0,
            fixed: std::iter::once(1.0)
                .chain(told.iter().map(|own| own.off[k]))
                .collect(),
            random: (1..=steps)
                .map(|step| f64::from(u8::from(at * steps >= step * last)))
                .collect(),
            readings: vec![Reading::new(value, variance)],
        });
    }
    MixedModel {
        units,
        component_of: vec![0; steps],
        widths: vec![Width::Readings; steps.min(1)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::facts::facts;
    use crate::laws::values::values;
    use ieap_domain::RunRecord;
    use ieap_domain::testing::{campaign, fit, known, run, tag};
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, Normal};

    /// Three years of monthly runs whose humidity follows the season; the level changes by `level` of the month.
    fn seasons(seed: u64, slope: f64, level: impl Fn(usize) -> f64) -> Vec<RunRecord> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let noise = Normal::new(0.0, 0.02).unwrap();
        (0..36)
            .map(|month| {
                let humidity = 35.0 + 4.0 * (month as f64 * std::f64::consts::TAU / 12.0).sin();
                let y = slope * (humidity - 35.0) + level(month) + noise.sample(&mut random);
                let mut own = run(&format!("m{month}"), "CNaf-01", "air", Some(humidity), 2.0);
                own.fit = Some(fit(&[("lambda_per_s", known(1e-4 * f64::exp(y), 0.01))]));
                own.tags.push(tag(
                    "started_at",
                    &format!("{}-{:02}-05T12:00:00Z", 2024 + month / 12, 1 + month % 12),
                ));
                own
            })
            .collect()
    }

    /// The values before and after, and to what they were brought.
    fn brought(runs: &[RunRecord]) -> (Vec<f64>, Vec<f64>, Vec<Brought>) {
        let facts = facts(runs, &campaign());
        let places: Vec<usize> = (0..runs.len()).collect();
        let mut found = values(runs, &facts, &places, "lambda_per_s");
        let y = |found: &Values| found.values.iter().map(|value| value.y).collect::<Vec<f64>>();
        let before = y(&found);
        let to = bring(&mut found, &facts, &places);
        (before, y(&found), to)
    }

    fn spread(of: &[f64]) -> f64 {
        let (low, high) = of
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| {
                (low.min(*y), high.max(*y))
            });
        high - low
    }

    #[test]
    fn seasons_are_taken_out() {
        let (before, after, to) = brought(&seasons(11, 0.03, |_| 0.0));
        assert!(
            spread(&before) > 0.2 && spread(&after) < 0.5 * spread(&before),
            "{before:?} {after:?}"
        );
        assert_eq!(to[0].0, Covariate::RelativeHumidity);
        assert!((to[0].1 - 35.0).abs() < 0.5);
    }

    #[test]
    fn ageing_stays() {
        let (_, after, to) = brought(&seasons(11, 0.03, |month| -0.02 * month as f64));
        assert_eq!(to.len(), 1);
        // 35 months of 2 %.
        assert!((spread(&after) - 0.7).abs() < 0.12, "{after:?}");
    }

    #[test]
    fn a_step_stays_where_it_is() {
        for seed in 20..30 {
            let (_, after, _) = brought(&seasons(seed, 0.03, |month| if month < 17 { 0.0 } else { 0.2 }));
            let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len() as f64;
            let step = mean(&after[17..]) - mean(&after[..17]);
            assert!((step - 0.2).abs() < 0.05, "{seed}: {step}");
        }
    }

    #[test]
    fn what_tells_nothing_of_the_season_is_hardly_moved() {
        let moved = |seed| {
            let (before, after, _) = brought(&seasons(seed, 0.0, |_| 0.0));
            before
                .iter()
                .zip(&after)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max)
        };
        let all: Vec<f64> = (0..20).map(moved).collect();
        let still = all.iter().filter(|moved| **moved == 0.0).count();
        assert!(still >= 10 && all.iter().all(|moved| *moved < 0.03), "{all:?}");
    }
}
