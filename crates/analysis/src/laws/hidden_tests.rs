//! Campaigns with and without a hidden law, its covariate confounded by design in half of them: what is found, what
//! is claimed without being there.

use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::covariate::Covariate;
use super::find::{CampaignLaws, Evidence, find};
use super::shape::Law;
use super::words;
use crate::cache::Cache;
use crate::study::{self, Study};
use ieap_domain::tag::keys;
use ieap_domain::testing::{campaign, fit, run, tag};
use ieap_domain::{Campaign, Estimate, RunRecord};

const PARAMETERS: [(&str, f64); 7] = [
    ("r1_ohm_cm2", 60.0),
    ("c1_f_per_cm2", 0.04),
    ("r2_ohm_cm2", 150.0),
    ("c2_f_per_cm2", 0.12),
    ("rss_ohm_cm2", 60_000.0),
    ("alpha_per_c_cm", 24.0),
    ("lambda_per_s", 1e-3),
];
/// Standard deviation of the logarithms between samples, between runs of a sample, and by the fits.
const BETWEEN: f64 = 0.2;
const RUNS: f64 = 0.1;
const FITS: f64 = 0.04;

/// How a simulated campaign is made.
#[derive(Clone, Copy)]
pub(super) struct Plan {
    pub(super) samples: usize,
    pub(super) humidities: &'static [f64],
    pub(super) voltages: &'static [f64],
    /// Whether humidities rise with the order of the runs.
    pub(super) is_confounded: bool,
    pub(super) between: f64,
    /// Whether each sample is measured at one humidity only.
    pub(super) one_humidity_a_sample: bool,
}

pub(super) const PLAN: Plan = Plan {
    samples: 6,
    humidities: &[20.0, 40.0, 60.0, 80.0],
    voltages: &[1.5, 2.5],
    is_confounded: false,
    between: BETWEEN,
    one_humidity_a_sample: false,
};

/// What is hidden: change of the logarithm of a parameter by humidity (percent) and cycle.
pub(super) type Hidden<'a> = &'a dyn Fn(&str, f64, usize) -> f64;

fn simulate(plan: Plan, hidden: Hidden, seed: u64) -> (Vec<RunRecord>, Campaign) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut campaign = campaign();
    let template = campaign.samples[0].clone();
    campaign.samples = Default::default();
    let mut runs = Vec::new();
    for s in 0..plan.samples {
        let id = format!("S{s:02}");
        campaign.samples.push(ieap_domain::Sample {
            id: id.clone(),
            ..template.clone()
        });
        let offsets: Vec<f64> = PARAMETERS
            .iter()
            .map(|_| plan.between * normal(&mut random))
            .collect();
        let mut conditions: Vec<(f64, f64)> = Vec::new();
        for (k, &humidity) in plan.humidities.iter().enumerate() {
            if !plan.one_humidity_a_sample || k == s % plan.humidities.len() {
                conditions.extend(plan.voltages.iter().map(|&volts| (humidity, volts)));
            }
        }
        if !plan.is_confounded {
            conditions.shuffle(&mut random);
        }
        let mut hour = 0.0;
        for (k, (humidity, volts)) in conditions.into_iter().enumerate() {
            hour += 2.0 + 6.0 * random.random::<f64>();
            let humidity = humidity + normal(&mut random);
            let values: Vec<(&str, Estimate)> = PARAMETERS
                .iter()
                .zip(&offsets)
                .map(|(&(key, center), offset)| {
                    let by_voltage = if key == "lambda_per_s" { 0.5 * volts } else { 0.0 };
                    let scatter = RUNS * normal(&mut random) + FITS * normal(&mut random);
                    let y = offset + by_voltage + hidden(key, humidity, k) + scatter;
                    (key, estimate(center * y.exp()))
                })
                .collect();
            let mut made = run(&format!("{id}_{k:02}"), &id, "air", Some(humidity), volts);
            made.tags.push(tag(keys::CYCLE, &(k + 1).to_string()));
            made.tags.push(tag(
                keys::TEMPERATURE_C,
                &(24.0 + normal(&mut random)).to_string(),
            ));
            let start =
                jiff::Timestamp::from_second(1_790_000_000 + (3600.0 * hour) as i64 + 86_400 * s as i64);
            made.tags.push(tag(keys::STARTED_AT, &start.unwrap().to_string()));
            made.fit = Some(fit(&values));
            runs.push(made);
        }
    }
    (runs, campaign)
}

fn normal(random: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(random)
}

fn estimate(value: f64) -> Estimate {
    Estimate::determined(
        value,
        FITS * value,
        value * (-1.96 * FITS).exp(),
        value * (1.96 * FITS).exp(),
    )
}

pub(super) fn found(plan: Plan, hidden: Hidden, seed: u64) -> CampaignLaws {
    let (runs, campaign) = simulate(plan, hidden, seed);
    let study = Study::of(study::Evidence {
        runs: &runs,
        campaign: &campaign,
        doubts: &Default::default(),
        curves: &[],
    });
    find(&Evidence {
        findings: Default::default(),
        of_humidity: &study.of_humidity(),
        runs: &runs,
        campaign: &campaign,
        charge_c: &vec![None; runs.len()],
        attempts: &[],
        seed,
        kept: &Cache::default(),
    })
}

pub(super) fn tries(short: u64, long: u64) -> u64 {
    match std::env::var_os("IEAP_LONG") {
        Some(_) => long,
        None => short,
    }
}

fn nothing(_: &str, _: f64, _: usize) -> f64 {
    0.0
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn where_nothing_is_hidden_nothing_is_claimed() {
    let count = tries(24, 500);
    let (mut wrong, mut lengths) = (0, 0);
    let mut p_of = std::collections::BTreeMap::<Covariate, Vec<f64>>::new();
    for seed in 0..count {
        let plan = Plan {
            is_confounded: seed % 2 == 1,
            ..PLAN
        };
        let laws = found(plan, &nothing, 7_000 + seed);
        // Samples do differ.
        let claimed: Vec<_> = laws
            .claimed()
            .filter(|found| found.covariate != Covariate::Sample)
            .collect();
        wrong += u64::from(!claimed.is_empty());
        lengths += u64::from(
            laws.lengths
                .iter()
                .any(|doubt| doubt.q <= 0.05 && doubt.explains_all),
        );
        for one in laws
            .dependences
            .iter()
            .filter(|one| one.covariate != Covariate::Sample)
        {
            p_of.entry(one.covariate).or_default().push(one.p);
        }
    }
    let rate = wrong as f64 / count as f64;
    println!(
        "{count} null campaigns: {wrong} with a law claimed, {:.1} %; {lengths} with a length doubted",
        100.0 * rate
    );
    let all: Vec<f64> = p_of.values().flatten().copied().collect();
    println!(
        "{} p-values: KS distance {:.4} (5 %, were they independent: {:.4})",
        all.len(),
        super::chance_of::distance_from_even(&all),
        1.358 / (all.len() as f64).sqrt()
    );
    for (covariate, p) in &p_of {
        let below = p.iter().filter(|p| **p <= 0.05).count() as f64 / p.len() as f64;
        println!(
            "  {}: {} p-values, {:.3} below 0.05",
            covariate.key(),
            p.len(),
            below
        );
    }
    // 5 % and what chance adds to it in 1 of 1000 tries.
    assert!(rate <= 0.05 + 3.1 * (0.05 * 0.95 / count as f64).sqrt(), "{rate}");
    assert!(lengths as f64 / count as f64 <= 0.05 + 3.1 * (0.05 * 0.95 / count as f64).sqrt());
    // Parameters of one run share nothing here; questions of a set and its members do not overlap.
    assert!(super::chance_of::distance_from_even(&all) < 2.2 / (all.len() as f64).sqrt());
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn a_humidity_law_of_twice_the_spread_is_found() {
    let count = tries(20, 200);
    // Between 20 and 80 % the parameter moves by twice the standard deviation between samples.
    let law = |key: &str, humidity: f64, _: usize| match key {
        "lambda_per_s" => 2.0 * BETWEEN * (humidity - 20.0) / 60.0,
        _ => 0.0,
    };
    let (mut seen, mut held, mut wrong, mut claims) = (0, 0, 0, 0);
    for seed in 0..count {
        let laws = found(PLAN, &law, 20_000 + seed);
        let claimed: Vec<_> = laws
            .claimed()
            .filter(|found| found.covariate != Covariate::Sample)
            .collect();
        claims += claimed.len();
        let is_right = |one: &&&super::Dependence| {
            one.parameter == "lambda_per_s" && one.covariate == Covariate::RelativeHumidity
        };
        wrong += claimed.iter().filter(|one| !is_right(one)).count();
        if let Some(right) = claimed.iter().find(|one| is_right(one)) {
            seen += 1;
            let change = right.change().unwrap();
            let span = right.span.unwrap();
            let truth = 2.0 * BETWEEN * span.length() / 60.0;
            held += u64::from(change.low_95.unwrap() <= truth && truth <= change.high_95.unwrap());
            assert!(right.confounded_with.is_empty(), "{right:?}");
        }
    }
    println!(
        "humidity law: found in {seen} of {count}; {held} intervals hold the truth; {wrong} of {claims} claims wrong"
    );
    assert!(seen as f64 >= 0.9 * count as f64);
    assert!(held as f64 >= 0.95 * seen as f64 - 3.0 * (0.05 * seen as f64).sqrt());
    assert!(wrong as f64 / claims as f64 <= 0.05 + 3.0 * (0.05 / claims as f64).sqrt());
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn a_confounded_pair_is_one_finding_with_both_names() {
    let count = tries(10, 200);
    let law = |key: &str, humidity: f64, _: usize| match key {
        "alpha_per_c_cm" => -0.4 * (humidity - 20.0) / 60.0,
        _ => 0.0,
    };
    let plan = Plan {
        is_confounded: true,
        ..PLAN
    };
    for seed in 0..count {
        let laws = found(plan, &law, 30_000 + seed);
        let names = |one: &super::Dependence| {
            let mut names = one.confounded_with.clone();
            names.push(one.covariate);
            names
        };
        // One finding with both names, and no claim of either without the other.
        let of_either: Vec<_> = laws
            .claimed()
            .filter(|one| one.parameter == "alpha_per_c_cm" && one.covariate != Covariate::Sample)
            .filter(|one| {
                let names = names(one);
                names.contains(&Covariate::RelativeHumidity) || names.contains(&Covariate::Cycle)
            })
            .collect();
        assert_eq!(of_either.len(), 1, "{of_either:#?}");
        let names = names(of_either[0]);
        assert!(names.contains(&Covariate::RelativeHumidity), "{names:?}");
        assert!(names.contains(&Covariate::Cycle), "{names:?}");
        assert!(words::sentence(of_either[0]).contains("cannot be told"));
    }
}

#[test]
fn ageing_is_not_taken_for_humidity() {
    let ageing = |key: &str, _: f64, k: usize| match key {
        "rss_ohm_cm2" => -0.12 * k as f64,
        _ => 0.0,
    };
    let laws = found(PLAN, &ageing, 41);
    let of_rss: Vec<_> = laws
        .claimed()
        .filter(|one| one.parameter == "rss_ohm_cm2" && one.covariate != Covariate::Sample)
        .collect();
    assert_eq!(of_rss.len(), 1, "{of_rss:#?}");
    assert_eq!(of_rss[0].covariate.effect(), Some("degradation"));
    let sentence = words::sentence(of_rss[0]);
    assert!(
        sentence.contains("Rₛₛ of CNaf falls by a factor of"),
        "{sentence}"
    );
}

#[test]
fn declared_tags_are_asked_and_others_are_not() {
    let (mut runs, mut campaign) = simulate(PLAN, &nothing, 43);
    let mut random = ChaCha8Rng::seed_from_u64(44);
    for made in &mut runs {
        let charge_s = f64::from(random.random_range(0..4_u32)) * 60.0;
        let (specimen, offset) = [("left", 0.0), ("right", 0.5)][random.random_range(0..2_usize)];
        made.tags.push(tag("pre_charge_s", &charge_s.to_string()));
        made.tags.push(tag("specimen", specimen));
        let parameters = made.fit.iter_mut().flat_map(|fit| &mut fit.parameters);
        for parameter in parameters {
            let y = match parameter.key.as_str() {
                "alpha_per_c_cm" => 0.003 * charge_s,
                "rss_ohm_cm2" => offset,
                _ => 0.0,
            };
            let value = parameter.estimate.value.unwrap();
            parameter.estimate = estimate(value * y.exp());
        }
    }
    let claimed = |campaign: &Campaign| -> Vec<(String, String, Law)> {
        let laws = find(&Evidence {
            findings: Default::default(),
            of_humidity: &Default::default(),
            runs: &runs,
            campaign,
            charge_c: &vec![None; runs.len()],
            attempts: &[],
            seed: 1,
            kept: &Cache::default(),
        });
        let of_tags = laws
            .claimed()
            .filter(|one| one.covariate.effect() == Some("tag-dependence"));
        let told = |one: &super::dependence::Dependence| {
            let law = one.laws.first().map_or(Law::Jump, |law| law.law);
            (one.parameter.clone(), one.covariate.key().to_owned(), law)
        };
        of_tags.map(told).collect()
    };
    assert!(claimed(&campaign).is_empty());
    campaign.extra_tags = vec!["pre_charge_s".to_owned(), "specimen".to_owned()];
    let found = claimed(&campaign);
    for (parameter, key) in [("alpha_per_c_cm", "pre_charge_s"), ("rss_ohm_cm2", "specimen")] {
        let is_it = |one: &&(String, String, Law)| one.0 == parameter && one.1 == key;
        assert_eq!(found.iter().filter(is_it).count(), 1, "{found:?}");
    }
    assert_eq!(found.len(), 2, "{found:?}");
}

#[test]
fn what_follows_humidity_alone_is_said_to_come_back() {
    let law = |key: &str, humidity: f64, _: usize| match key {
        "lambda_per_s" => 0.02 * humidity,
        _ => 0.0,
    };
    let said = crate::monitoring::words::split(&found(PLAN, &law, 42));
    let own: Vec<&String> = said
        .iter()
        .filter(|text| text.starts_with("λ of CNaf:"))
        .collect();
    assert_eq!(own.len(), 1, "{said:?}");
    assert!(
        own[0].contains("with humidity it rises by a factor of"),
        "{own:?}"
    );
    assert!(own[0].contains("comes back"), "{own:?}");
}

#[test]
fn samples_at_one_humidity_each_are_compared_as_samples() {
    let law = |key: &str, humidity: f64, _: usize| match key {
        "lambda_per_s" => 2.0 * (humidity - 20.0) / 60.0,
        _ => 0.0,
    };
    let plan = Plan {
        samples: 12,
        one_humidity_a_sample: true,
        ..PLAN
    };
    let laws = found(plan, &law, 5);
    let claimed: Vec<_> = laws
        .claimed()
        .filter(|one| one.covariate == Covariate::RelativeHumidity)
        .collect();
    assert_eq!(claimed.len(), 1);
    assert_eq!(
        (claimed[0].level, claimed[0].parameter.as_str()),
        (super::design::Level::Between, "lambda_per_s")
    );
    // Two samples each are too few to claim anything, however many runs they have.
    let plan = Plan { samples: 4, ..plan };
    let laws = found(plan, &nothing, 6);
    let p: Vec<f64> = laws
        .dependences
        .iter()
        .filter(|one| one.covariate == Covariate::RelativeHumidity)
        .map(|one| one.p)
        .collect();
    assert!(p.iter().all(|p| *p > 1e-3), "{p:?}");
}

/// Humidities rise and fall again, once for each sample.
const UP_AND_DOWN: Plan = Plan {
    humidities: &[20.0, 40.0, 60.0, 80.0, 60.0, 40.0, 20.0],
    voltages: &[2.0],
    is_confounded: true,
    ..PLAN
};

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn wetting_and_drying_are_told_apart() {
    let count = tries(5, 200);
    let late = |key: &str, humidity: f64, k: usize| match key {
        "lambda_per_s" => 0.01 * humidity + if k > 3 { 0.3 } else { 0.0 },
        _ => 0.0,
    };
    let mut seen = 0;
    for seed in 0..count {
        let laws = found(UP_AND_DOWN, &late, 50_000 + seed);
        let covers = |covariate: Covariate| {
            laws.claimed().any(|one| {
                one.parameter == "lambda_per_s"
                    && (one.covariate == covariate || one.confounded_with.contains(&covariate))
            })
        };
        seen += u64::from(covers(Covariate::RelativeHumidity) && covers(Covariate::Direction));
    }
    println!("humidity and its direction: found in {seen} of {count}");
    assert!(seen as f64 >= 0.9 * count as f64);
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn where_drying_is_as_wetting_no_difference_is_claimed() {
    let count = tries(24, 200);
    let law = |key: &str, humidity: f64, _: usize| match key {
        "lambda_per_s" => 0.01 * humidity,
        _ => 0.0,
    };
    let (mut wrong, mut p) = (0, Vec::new());
    for seed in 0..count {
        let laws = found(UP_AND_DOWN, &law, 60_000 + seed);
        let of_direction = |one: &&super::Dependence| {
            one.covariate == Covariate::Direction || one.confounded_with.contains(&Covariate::Direction)
        };
        wrong += u64::from(laws.claimed().any(|one| of_direction(&one)));
        p.extend(laws.dependences.iter().filter(of_direction).map(|one| one.p));
    }
    let below = p.iter().filter(|p| **p <= 0.05).count() as f64 / p.len() as f64;
    println!(
        "no hysteresis: claimed in {wrong} of {count}; {} p-values, {below:.3} below 0.05, KS distance {:.4} (5 %: {:.4})",
        p.len(),
        super::chance_of::distance_from_even(&p),
        1.358 / (p.len() as f64).sqrt()
    );
    assert!(wrong as f64 / count as f64 <= 0.05 + 3.1 * (0.05 * 0.95 / count as f64).sqrt());
    assert!(below <= 0.05 + 3.1 * (0.05 * 0.95 / p.len() as f64).sqrt());
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let law = |_: &str, humidity: f64, _: usize| 0.01 * humidity;
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| format!("{:?}", found(PLAN, &law, 3)))
    };
    assert_eq!(on(1), on(3));
}

#[test]
fn a_threshold_is_told_from_a_slope() {
    let plan = Plan {
        humidities: &[10.0, 25.0, 40.0, 50.0, 60.0, 70.0, 80.0],
        ..PLAN
    };
    let law = |key: &str, humidity: f64, _: usize| match key {
        "rss_ohm_cm2" => -0.05 * f64::max(humidity - 55.0, 0.0),
        _ => 0.0,
    };
    let laws = found(plan, &law, 12);
    let one = laws
        .claimed()
        .find(|one| one.parameter == "rss_ohm_cm2" && one.covariate == Covariate::RelativeHumidity)
        .unwrap();
    assert_eq!(one.laws[0].law, Law::Threshold, "{:#?}", one.laws);
    let at = one.laws[0].bend_at.unwrap();
    assert!(
        at.low_95.unwrap() <= 55.0 && at.high_95.unwrap() >= 55.0,
        "{at:?}"
    );
}
