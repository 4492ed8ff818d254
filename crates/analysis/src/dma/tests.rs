//! Tests of the analysis of modulus logs, and how often its intervals hold what they state.

use std::sync::Arc;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal, Uniform};

use super::*;
use ieap_domain::modulus::{log_keys, step_keys};
use ieap_domain::{Estimate, ModulusStep};

/// What a log is made from.
#[derive(Debug, Clone)]
struct Recipe {
    before_mpa: f64,
    equilibrium_mpa: f64,
    wetting_s: f64,
    drying_s: f64,
    loss_factor: f64,
    noise_mpa: f64,
    correlation: f64,
    every_s: f64,
    hold_s: f64,
    humidity_lag_s: f64,
    diffuses: bool,
    seed: u64,
}

/// What is left of a change after `since_s`: an exponential, or the mean of a strip that something diffuses into
/// (Crank, The Mathematics of Diffusion, equation 4.18).
fn left(since_s: f64, tau_s: f64, diffuses: bool) -> f64 {
    if !diffuses {
        return (-since_s / tau_s).exp();
    }
    let term = |n: u32| {
        let odd = f64::from(2 * n + 1).powi(2);
        (-odd * since_s / tau_s).exp() / odd
    };
    8.0 / std::f64::consts::PI.powi(2) * (0..200).map(term).sum::<f64>()
}

/// Time after which a twentieth is left.
fn equilibrium_s(tau_s: f64, diffuses: bool) -> f64 {
    let (mut low, mut high) = (0.0, 10.0 * tau_s);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if left(middle, tau_s, diffuses) > policy::REMAINDER {
            low = middle
        } else {
            high = middle
        }
    }
    high
}

impl Recipe {
    fn thesis(before_mpa: f64, after_mpa: f64, wetting_s: f64, drying_s: f64) -> Recipe {
        Recipe {
            before_mpa,
            equilibrium_mpa: after_mpa,
            wetting_s,
            drying_s,
            loss_factor: 0.1,
            noise_mpa: 0.004 * before_mpa,
            correlation: 0.3,
            every_s: 30.0,
            hold_s: 7200.0,
            humidity_lag_s: 60.0,
            diffuses: false,
            seed: 1,
        }
    }

    /// |E*| without noise: 60 min dry, then wet, then dry again.
    fn modulus_mpa(&self, time_s: f64) -> f64 {
        let (wet_s, dry_s) = (3600.0, 3600.0 + self.hold_s);
        let wetting = |since_s: f64| {
            self.equilibrium_mpa
                + (self.before_mpa - self.equilibrium_mpa) * left(since_s, self.wetting_s, self.diffuses)
        };
        if time_s <= wet_s {
            self.before_mpa
        } else if time_s <= dry_s {
            wetting(time_s - wet_s)
        } else {
            let wet = wetting(self.hold_s);
            self.before_mpa + (wet - self.before_mpa) * left(time_s - dry_s, self.drying_s, self.diffuses)
        }
    }

    fn channels(&self) -> Vec<Channel> {
        let mut generator = ChaCha8Rng::seed_from_u64(self.seed);
        let end_s = 3600.0 + 2.0 * self.hold_s;
        let time_s: Arc<[f64]> = (0..=(end_s / self.every_s) as usize)
            .map(|k| k as f64 * self.every_s)
            .collect();
        let mut noise = |sigma: f64, rho: f64| -> Vec<f64> {
            let mut last: f64 = StandardNormal.sample(&mut generator);
            time_s
                .iter()
                .map(|_| {
                    let fresh: f64 = StandardNormal.sample(&mut generator);
                    last = rho * last + (1.0 - rho * rho).sqrt() * fresh;
                    sigma * last
                })
                .collect()
        };
        let modulus_noise = noise(self.noise_mpa, self.correlation);
        let humidity_noise = noise(0.2, 0.5);
        let humidity = |t: f64| {
            let lag = |since_s: f64| 1.0 - (-since_s / self.humidity_lag_s).exp();
            let (wet_s, dry_s) = (3600.0, 3600.0 + self.hold_s);
            match t {
                t if t <= wet_s => 0.0,
                t if t <= dry_s => 40.0 * lag(t - wet_s),
                t => 40.0 * (1.0 - lag(t - dry_s)),
            }
        };
        let complex: Vec<f64> = time_s
            .iter()
            .zip(&modulus_noise)
            .map(|(&t, e)| self.modulus_mpa(t) + e)
            .collect();
        let storage_part = 1.0 / (1.0 + self.loss_factor * self.loss_factor).sqrt();
        let channel = |quantity, values: Vec<f64>| Channel::new(quantity, time_s.clone(), values.into());
        vec![
            channel(
                Quantity::StorageModulus,
                complex.iter().map(|e| e * storage_part).collect(),
            ),
            channel(
                Quantity::LossModulus,
                complex
                    .iter()
                    .map(|e| e * storage_part * self.loss_factor)
                    .collect(),
            ),
            channel(
                Quantity::RelativeHumidity,
                time_s
                    .iter()
                    .zip(&humidity_noise)
                    .map(|(&t, e)| humidity(t) + e)
                    .collect(),
            ),
            channel(Quantity::Frequency, vec![1.0; time_s.len()]),
        ]
    }
}

fn number<'a>(step: &'a ModulusStep, key: &str) -> &'a Estimate {
    step.estimate(key).unwrap()
}

fn near(estimate: &Estimate, truth: f64, within: f64) {
    let value = estimate.value.unwrap_or_else(|| panic!("{estimate:?}"));
    assert!(
        (value - truth).abs() <= within,
        "{value} is not {truth}: {estimate:?}"
    );
}

#[test]
fn a_log_like_the_thesiss_is_understood_whole() {
    let recipe = Recipe::thesis(70.0, 55.0, 400.0, 400.0);
    let found = analyse(&recipe.channels()).unwrap();
    assert_eq!((found.steps.len(), found.frequency_hz), (2, Some(1.0)));
    let wetting = &found.steps[0];
    near(number(wetting, step_keys::HUMIDITY_BEFORE), 0.0, 0.3);
    near(number(wetting, step_keys::HUMIDITY_AFTER), 40.0, 0.3);
    near(number(wetting, step_keys::MODULUS_BEFORE), 70.0, 0.3);
    near(number(wetting, step_keys::MODULUS_AFTER), 55.0, 0.3);
    near(number(wetting, step_keys::RELATIVE_CHANGE), -21.43, 0.6);
    near(
        number(wetting, step_keys::EQUILIBRIUM_TIME),
        400.0 * 20f64.ln(),
        120.0,
    );
    near(number(wetting, step_keys::LOSS_FACTOR_AFTER), 0.1, 1e-3);
    near(found.estimate(log_keys::RECOVERY).unwrap(), 100.0, 3.0);
    near(found.estimate(log_keys::HYSTERESIS).unwrap(), 0.0, 0.7);
    assert_eq!(found.curves[0].quantity, Quantity::ComplexModulus);
    assert!(found.curves[0].fitted.iter().filter(|v| v.is_finite()).count() > 100);
}

/// The humidity steps on a reading, right after one, and right before the next: the time to equilibrium holds all.
#[test]
fn a_time_to_equilibrium_counts_from_between_two_readings() {
    let (tau_s, every_s) = (400.0, 30.0);
    let time_s: Arc<[f64]> = (0..400).map(|k| every_s * f64::from(k)).collect();
    for wet_s in [3600.0, 3600.3, 3615.0, 3629.7] {
        let read = |quantity, of: &dyn Fn(f64) -> f64| {
            let noise = |k: usize| (2.4 * k as f64).sin() + (1.3 * k as f64).cos();
            let value = |(k, t): (usize, &f64)| of(t - wet_s) + 0.005 * noise(k);
            Channel::new(
                quantity,
                time_s.clone(),
                time_s.iter().enumerate().map(value).collect(),
            )
        };
        let channels = [
            read(Quantity::ComplexModulus, &|t| {
                55.0 + 15.0 * (-t.max(0.0) / tau_s).exp()
            }),
            read(Quantity::RelativeHumidity, &|t| if t < 0.0 { 0.0 } else { 40.0 }),
            read(Quantity::Frequency, &|_| 1.0),
        ];
        let found = analyse(&channels).unwrap();
        let time = number(&found.steps[0], step_keys::EQUILIBRIUM_TIME);
        let truth = equilibrium_s(tau_s, false);
        near(time, truth, 0.55 * every_s);
        let (low, high) = time.low_95.zip(time.high_95).unwrap();
        assert!(low < truth && truth < high, "{wet_s}: {time:?} for {truth}");
    }
}

#[test]
fn a_plateau_that_is_not_reached_is_said_and_its_time_is_a_bound() {
    let found = analyse(&Recipe::thesis(460.0, 280.0, 900.0, 20_000.0).channels()).unwrap();
    let drying = &found.steps[1];
    let time = number(drying, step_keys::EQUILIBRIUM_TIME);
    assert!(time.value.is_none() && time.high_95.is_none(), "{time:?}");
    assert!(time.low_95.is_some_and(|low| low > 3600.0), "{time:?}");
    assert!(
        time.reason
            .as_ref()
            .unwrap()
            .contains("not reached within the 2 h")
    );
    let codes: Vec<&str> = found.issues.iter().map(|issue| issue.code.as_str()).collect();
    assert!(codes.contains(&"plateau-not-reached"), "{codes:?}");
    near(
        found.estimate(log_keys::RECOVERY).unwrap(),
        100.0 * (1.0 - (-7200.0_f64 / 20_000.0).exp()),
        2.0,
    );
}

#[test]
fn a_modulus_that_does_not_move_has_no_equilibrium_time() {
    let found = analyse(&Recipe::thesis(56.0, 56.0, 400.0, 400.0).channels()).unwrap();
    let time = number(&found.steps[0], step_keys::EQUILIBRIUM_TIME);
    assert!(time.value.is_none() && time.reason.is_some(), "{time:?}");
    let recovery = found.estimate(log_keys::RECOVERY).unwrap();
    assert!(recovery.value.is_none(), "{recovery:?}");
}

#[test]
fn what_a_log_lacks_is_said_and_nothing_is_made_up() {
    let mut channels = Recipe::thesis(70.0, 55.0, 400.0, 400.0).channels();
    let without = |quantity| -> Vec<Channel> {
        let all = channels.iter().filter(|c| c.quantity != quantity);
        all.cloned().collect()
    };
    let dry = analyse(&without(Quantity::RelativeHumidity)).unwrap();
    assert_eq!((dry.steps.len(), dry.issues[0].code.as_str()), (0, "no-humidity"));
    assert_eq!(dry.estimates, []);
    let alone = analyse(&without(Quantity::LossModulus)).unwrap_err();
    assert_eq!(alone.code, "no-complex-modulus");
    assert!(analyse(&[]).is_err());
    // Another |E*| than the columns give is pointed out, and the instrument's counts.
    let other: Vec<f64> = channels[0].values.iter().map(|e| e * 1.2).collect();
    channels.push(Channel::new(
        Quantity::ComplexModulus,
        channels[0].time_s.clone(),
        other.into(),
    ));
    let found = analyse(&channels).unwrap();
    assert_eq!(found.issues[0].code, "moduli-disagree");
    near(
        number(&found.steps[0], step_keys::MODULUS_BEFORE),
        70.0 * 1.2 / 1.01f64.sqrt(),
        0.5,
    );
}

#[test]
fn one_frequency_of_several_is_used_and_a_sweep_is_refused() {
    let channels = Recipe::thesis(70.0, 55.0, 400.0, 400.0).channels();
    let with_frequency = |frequency: fn(usize) -> f64| -> Vec<Channel> {
        let mut all = channels.clone();
        let count = all[3].values.len();
        all[3].values = (0..count).map(frequency).collect();
        all
    };
    let found = analyse(&with_frequency(|k| if k % 3 == 0 { 10.0 } else { 1.0 })).unwrap();
    assert_eq!((found.frequency_hz, found.steps.len()), (Some(1.0), 2));
    assert_eq!(found.issues[0].code, "one-frequency");
    let sweep = analyse(&with_frequency(|k| {
        10f64.powf(-1.0 + 3.0 * (k % 20) as f64 / 19.0)
    }))
    .unwrap_err();
    assert_eq!(sweep.code, "frequency-sweep");
}

/// How often statements hold: of all made.
type Counts = std::collections::BTreeMap<&'static str, (usize, usize)>;

/// How often what is stated of logs drawn at random holds the truth.
fn counts(logs: usize, diffuses: bool) -> Counts {
    let mut generator = ChaCha8Rng::seed_from_u64(20_260_704);
    let mut between = |low: f64, high: f64| Uniform::new(low, high).unwrap().sample(&mut generator);
    let mut counts = Counts::new();
    for seed in 0..logs {
        let before_mpa = between(20.0, 800.0);
        let recipe = Recipe {
            before_mpa,
            equilibrium_mpa: before_mpa * between(0.5, 0.98),
            wetting_s: between(100.0, 3000.0),
            drying_s: between(300.0, 20_000.0),
            noise_mpa: before_mpa * between(0.001, 0.01),
            correlation: between(0.0, 0.7),
            every_s: [10.0, 30.0, 60.0][seed % 3],
            diffuses,
            seed: seed as u64,
            ..Recipe::thesis(0.0, 0.0, 1.0, 1.0)
        };
        count(&recipe, &mut counts);
    }
    counts
}

fn count(recipe: &Recipe, counts: &mut Counts) {
    let found = analyse(&recipe.channels()).unwrap();
    assert_eq!(found.steps.len(), 2, "{recipe:?}");
    let mut count = |key, estimate: &Estimate, truth: f64| {
        let (low, high) = (estimate.low_95, estimate.high_95);
        let holds = low.is_none_or(|low| low <= truth) && high.is_none_or(|high| truth <= high);
        let key = match (estimate.value, low.or(high)) {
            (Some(_), _) => key,
            (None, Some(_)) => "bounds",
            (None, None) => return,
        };
        let entry = counts.entry(key).or_default();
        *entry = (entry.0 + usize::from(holds), entry.1 + 1);
    };
    for step in &found.steps {
        let (before, after) = (recipe.modulus_mpa(step.start_s), recipe.modulus_mpa(step.end_s));
        count("before", number(step, step_keys::MODULUS_BEFORE), before);
        count("after", number(step, step_keys::MODULUS_AFTER), after);
        let change = 100.0 * (after / before - 1.0);
        count("change", number(step, step_keys::RELATIVE_CHANGE), change);
    }
    // Of the time since the humidity began to change, which is between two readings.
    for (step, tau_s) in found.steps.iter().zip([recipe.wetting_s, recipe.drying_s]) {
        let time_s = equilibrium_s(tau_s, recipe.diffuses);
        count(
            "equilibrium time",
            number(step, step_keys::EQUILIBRIUM_TIME),
            time_s,
        );
    }
    let wet = number(&found.steps[0], step_keys::MODULUS_EQUILIBRIUM);
    count("equilibrium", wet, recipe.equilibrium_mpa);
    let far = recipe.modulus_mpa(3600.0 + recipe.hold_s);
    let last = recipe.modulus_mpa(3600.0 + 2.0 * recipe.hold_s);
    let recovery = 100.0 * (last - far) / (recipe.before_mpa - far);
    count("recovery", found.estimate(log_keys::RECOVERY).unwrap(), recovery);
}

/// Logs drawn: 300 where `IEAP_LONG` is set.
fn logs_drawn() -> usize {
    if std::env::var_os("IEAP_LONG").is_some() {
        300
    } else {
        60
    }
}

/// Whether counts are as `share` makes them, within three standard deviations and one part in a hundred for what is
/// approximate.
fn check(logs: usize, counts: Counts, share: impl Fn(&str) -> f64) {
    for (key, (held, all)) in counts {
        let (held, all, share) = (held as f64, all as f64, share(key));
        println!("{key}: {held} of {all}, {:.1} %", 100.0 * held / all);
        let least = share - 0.01 - 3.0 * (share * (1.0 - share) / all).sqrt();
        assert!(
            all > 0.1 * logs as f64 && held / all >= least,
            "{key}: {held} of {all}"
        );
    }
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn stated_intervals_hold_the_truth() {
    check(logs_drawn(), counts(logs_drawn(), false), |_| 0.95);
}

/// A relaxation by diffusion is no sum of two exponentials: where it ends is then stated too narrowly (docs/dma.md), what
/// the modulus is before and after is not.
#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn stated_intervals_under_diffusion() {
    check(logs_drawn(), counts(logs_drawn(), true), |key| match key {
        "equilibrium" => 0.90,
        "equilibrium time" => 0.86,
        _ => 0.95,
    });
}
