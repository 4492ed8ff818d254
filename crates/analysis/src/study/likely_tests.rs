//! How often what is called likely is so, and what a campaign with nothing hidden opens with.

use ieap_domain::testing::{campaign, fit, known, run};
use ieap_domain::{Campaign, Estimate, Factor, RunRecord, Sample};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::*;
use crate::laws::doubt::Doubts;
use crate::parameters::COMPARED;

const MATERIALS: [&str; 2] = ["CNaf", "CPvf"];
/// Logarithms of what air does to each parameter of each material.
type Effects = [[f64; 5]; 2];

/// Strips of two materials in three environments at two voltages: air changes every second parameter, by a standard deviation of
/// `size`. Strips differ in what surroundings do to them in every second campaign.
fn simulated(size: f64, seed: u64) -> (Vec<RunRecord>, Campaign, Effects) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let normal = |random: &mut ChaCha8Rng, size: f64| -> f64 {
        let own: f64 = StandardNormal.sample(random);
        size * own
    };
    let (strips, repeats) = (random.random_range(2..=3), random.random_range(1..=2));
    let differ = if random.random::<bool>() { 0.05 } else { 0.0 };
    let effects: Effects = std::array::from_fn(|_| {
        std::array::from_fn(|_| {
            let own = normal(&mut random, size);
            if random.random::<bool>() { own } else { 0.0 }
        })
    });
    let mut campaign = campaign();
    campaign.study.compare = vec![Factor::Environment, Factor::Material];
    let mut runs = Vec::new();
    for (m, material) in MATERIALS.iter().enumerate() {
        for strip in 0..strips {
            let id = format!("{material}-{strip}");
            campaign.samples.push(Sample {
                id: id.clone(),
                material: (*material).to_owned(),
                ..campaign.samples[0].clone()
            });
            let level = COMPARED.map(|_| normal(&mut random, 0.2));
            for environment in ["vacuum", "inert", "air"] {
                let own = COMPARED.map(|_| normal(&mut random, differ));
                for voltage in 0..2 {
                    for repeat in 0..repeats {
                        let value = |(k, key): (usize, &&'static str), random: &mut ChaCha8Rng| {
                            let effect = if environment == "air" { effects[m][k] } else { 0.0 };
                            let y = level[k] + own[k] + effect + normal(random, 0.05) - 1.0;
                            (*key, known(y.exp(), 0.01))
                        };
                        let found: Vec<(&str, Estimate)> = COMPARED
                            .iter()
                            .enumerate()
                            .map(|own| value(own, &mut random))
                            .collect();
                        let name = format!("{id}-{environment}-{voltage}-{repeat}");
                        let mut one = run(&name, &id, environment, None, 1.0 + f64::from(voltage));
                        one.fit = Some(fit(&found));
                        runs.push(one);
                    }
                }
            }
        }
    }
    (runs, campaign, effects)
}

/// Answers about air that are sure and likely: how many, and how many are false; campaigns that open with a change.
#[derive(Debug, Default)]
struct Counts {
    sure: [usize; 2],
    likely: [usize; 2],
    open_with_a_change: usize,
}

fn counted(size: f64, seeds: std::ops::Range<u64>) -> Counts {
    let mut counts = Counts::default();
    for seed in seeds {
        let (runs, campaign, effects) = simulated(size, seed);
        let study = Study::of(Evidence {
            runs: &runs,
            campaign: &campaign,
            doubts: &Doubts::default(),
            curves: &[],
        });
        for own in study.asked().filter(|own| own.kind == Kind::Environment) {
            let Some(k) = COMPARED.iter().position(|key| *key == own.parameter) else {
                continue;
            };
            let m = MATERIALS.iter().position(|name| *name == own.material).unwrap();
            let effect = if own.upper == "air" { effects[m][k] } else { 0.0 };
            // Beside what does nothing, what goes the other way is false.
            let is_false = effect == 0.0 || own.value.is_some_and(|value| value.ln() * effect < 0.0);
            let of = match (own.verdict, own.certainty) {
                (Verdict::Differs, _) => &mut counts.sure,
                (_, Certainty::Likely) => &mut counts.likely,
                _ => continue,
            };
            of[0] += 1;
            of[1] += usize::from(is_false);
        }
        let screen = first_screen(&study, None).join(" ");
        let says = |word: &str| screen.contains(word);
        counts.open_with_a_change += usize::from([" rises ", " falls ", " loses "].into_iter().any(says));
    }
    counts
}

#[test]
fn nothing_is_likely_where_nothing_is() {
    let counts = counted(0.0, 0..30);
    assert!(
        counts.open_with_a_change <= 3 && counts.likely[0] <= 3,
        "{counts:?}"
    );
}

/// `cargo test -p ieap-analysis --lib study::likely -- --include-ignored --nocapture`
#[test]
#[ignore = "minutes: counts for docs/validation/study.md"]
fn counts_of_what_is_likely() {
    println!("nothing: {:?}", counted(0.0, 15000..15150));
    for size in [0.05, 0.1, 0.3] {
        println!("{size}: {:?}", counted(size, 15000..15060));
    }
}
