//! Laws of the humidity with a known truth: how often intervals of either scope hold, what is claimed where nothing is, and
//! what is found with two strips.

use ieap_domain::testing::{campaign, fit, known, run, tag};
use ieap_domain::{Campaign, Estimate, RunRecord, Sample};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

use super::*;
use crate::laws::doubt::Doubts;
use crate::parameters::COMPARED;

/// What a simulated humidity study is like.
#[derive(Debug, Clone, Copy)]
struct Design {
    strips: usize,
    humidities: &'static [f64],
    repeats: usize,
    voltages: usize,
    /// Part of the runs that are lost.
    lost: f64,
    /// Standard deviations of logarithms: between strips, of strips at a humidity, from run to run.
    scatter: [f64; 3],
    /// Standard deviation of the strips' slopes, part of the slope.
    spread: f64,
    /// Whether humidities are drawn anew for every run, from the first to the last.
    is_continuum: bool,
}

const LEVELS: &[f64] = &[20.0, 35.0, 50.0, 65.0, 80.0];
const TWO: Design = Design {
    strips: 2,
    humidities: LEVELS,
    repeats: 2,
    voltages: 1,
    lost: 0.0,
    scatter: [0.2, 0.0, 0.05],
    spread: 0.0,
    is_continuum: false,
};
const MATERIALS: [&str; 2] = ["CNaf", "CPvf"];
/// Slopes of logarithms, per percent of humidity, of each material: what a factor of 4.5, 2.1 and a third over 60 points come to.
const TRUE: [[f64; 5]; 2] = [[0.0, 0.025, 0.0, 0.0, -0.018], [0.0, 0.0125, 0.0, 0.0, 0.0]];
const NOTHING: [[f64; 5]; 2] = [[0.0; 5]; 2];

/// The runs, and what the strips' own slopes are on average, by material and parameter.
fn simulated(design: Design, truth: &[[f64; 5]; 2], seed: u64) -> (Vec<RunRecord>, Campaign, [[f64; 5]; 2]) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let normal = Normal::new(0.0, 1.0).unwrap();
    let mut draw = || normal.sample(&mut random);
    let mut campaign = campaign();
    let (mut runs, mut own_slopes) = (Vec::new(), [[0.0; 5]; 2]);
    for (m, material) in MATERIALS.iter().enumerate() {
        for strip in 0..design.strips {
            let id = format!("{material}-{strip}");
            campaign.samples.push(Sample {
                id: id.clone(),
                material: (*material).to_owned(),
                ..campaign.samples[0].clone()
            });
            let level = COMPARED.map(|_| design.scatter[0] * draw());
            let slopes: [f64; 5] = std::array::from_fn(|k| truth[m][k] * (1.0 + design.spread * draw()));
            (0..5).for_each(|k| own_slopes[m][k] += slopes[k] / design.strips as f64);
            for (h, &nominal) in design.humidities.iter().enumerate() {
                let together = COMPARED.map(|_| design.scatter[1] * draw());
                for voltage in 0..design.voltages {
                    for repeat in 0..design.repeats {
                        if draw().abs() < 0.126 * design.lost / 0.1 {
                            continue;
                        }
                        let (first, last) = (
                            design.humidities[0],
                            design.humidities[design.humidities.len() - 1],
                        );
                        let part = (0.5 + 0.25 * draw()).clamp(0.0, 1.0);
                        let humidity = if design.is_continuum {
                            first + part * (last - first)
                        } else {
                            nominal + draw()
                        };
                        let found: Vec<(&str, Estimate)> = (COMPARED.iter().enumerate())
                            .map(|(k, key)| {
                                let off = level[k] + together[k] + design.scatter[2] * draw() + 0.01 * draw();
                                let y = -1.0 + slopes[k] * (humidity - 50.0) + 0.4 * voltage as f64 + off;
                                (*key, known(y.exp(), 0.01))
                            })
                            .collect();
                        let name = format!("{id}-{h}-{voltage}-{repeat}");
                        let mut one = run(&name, &id, "air", Some(humidity), 1.0 + voltage as f64);
                        one.fit = Some(fit(&found));
                        // Humidities in an order of their own: 0, 3, 1, 4, 2.
                        let cycle = 1 + repeat + design.repeats * ((2 * h) % design.humidities.len());
                        one.tags.push(tag("cycle", &cycle.to_string()));
                        runs.push(one);
                    }
                }
            }
        }
    }
    (runs, campaign, own_slopes)
}

fn study(runs: &[RunRecord], campaign: &Campaign) -> Study {
    Study::of(Evidence {
        runs,
        campaign,
        doubts: &Doubts::default(),
        curves: &[],
    })
}

/// Counts over simulated studies, of laws and of how they differ between materials.
#[derive(Debug, Default)]
struct Counts {
    asked: usize,
    strips_hold: usize,
    material_asked: usize,
    material_hold: usize,
    true_there: usize,
    true_found: usize,
    shown_of_material: usize,
    differ_there: usize,
    differ_found: usize,
    claims: usize,
    false_claims: usize,
    studies_with_false: usize,
}

fn counted(design: Design, truth: &[[f64; 5]; 2], seeds: std::ops::Range<u64>) -> Counts {
    let mut counts = Counts::default();
    for seed in seeds {
        let (runs, campaign, own) = simulated(design, truth, seed);
        let study = study(&runs, &campaign);
        let mut has_false = false;
        for law in study
            .asked()
            .filter(|own| own.scale == Scale::PerUnit && own.kind != Kind::VoltageLaw)
        {
            let Some(k) = COMPARED.iter().position(|key| *key == law.parameter) else {
                continue;
            };
            let m = MATERIALS.iter().position(|name| *name == law.material).unwrap();
            let by_material = law.kind == Kind::HumidityByMaterial;
            let of = |slopes: &[[f64; 5]; 2]| {
                if by_material {
                    slopes[0][k] - slopes[1][k]
                } else {
                    slopes[m][k]
                }
            };
            let (Some(low), Some(high)) = (law.low_95, law.high_95) else {
                continue;
            };
            counts.asked += 1;
            counts.strips_hold += usize::from((low..=high).contains(&of(&own)));
            if let Some(material) = &law.of_material {
                counts.material_asked += 1;
                counts.material_hold +=
                    usize::from((material.low_95..=material.high_95).contains(&of(truth)));
                counts.shown_of_material += usize::from(material.is_shown && of(truth) != 0.0);
            }
            let claims = law.verdict == Verdict::Differs;
            let is_there = of(truth) != 0.0;
            counts.claims += usize::from(claims);
            counts.false_claims += usize::from(claims && !is_there);
            has_false |= claims && !is_there;
            if by_material {
                counts.differ_there += usize::from(is_there);
                counts.differ_found += usize::from(is_there && claims);
            } else {
                counts.true_there += usize::from(is_there);
                counts.true_found += usize::from(is_there && claims);
            }
        }
        counts.studies_with_false += usize::from(has_false);
    }
    counts
}

fn law<'a>(study: &'a Study, kind: Kind, material: &str, key: &str) -> &'a Answer {
    let is = |own: &&Answer| own.kind == kind && own.material == material && own.parameter == key;
    study.asked().find(is).unwrap()
}

#[test]
fn two_strips_tell_a_law_of_themselves_and_say_what_their_material_needs() {
    let (runs, campaign, own) = simulated(TWO, &TRUE, 3);
    let study = study(&runs, &campaign);
    let lambda = law(&study, Kind::HumidityLaw, "CNaf", COMPARED[1]);
    assert_eq!(
        (lambda.verdict, lambda.scope),
        (Verdict::Differs, Scope::Strips),
        "{lambda:?}"
    );
    assert!(
        lambda.low_95.unwrap() < own[0][1] && lambda.high_95.unwrap() > own[0][1],
        "{lambda:?}"
    );
    let material = lambda.of_material.as_ref().unwrap();
    assert!(material.low_95 < lambda.low_95.unwrap() && material.high_95 > lambda.high_95.unwrap());
    let other = law(&study, Kind::HumidityByMaterial, "CNaf", COMPARED[1]);
    assert_eq!(
        (other.verdict, other.against_material.as_deref()),
        (Verdict::Differs, Some("CPvf")),
        "{other:?}"
    );
    let lead = lead(&study, "CNaf").join("\n");
    assert!(
        lead.contains(" in the two strips measured)") && lead.contains(" for each percent of humidity ("),
        "{lead}"
    );
    let sentence = sentence(other);
    assert!(
        sentence.starts_with("The change of λ of CNaf against CPvf with the relative humidity from "),
        "{sentence}"
    );
}

#[test]
fn strips_that_differ_in_their_slopes_are_told_apart_and_their_mean_is_the_law() {
    let spread = Design {
        spread: 0.5,
        humidities: &[20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0],
        ..TWO
    };
    let (runs, campaign, own) = simulated(spread, &TRUE, 1);
    let study = study(&runs, &campaign);
    let lambda = law(&study, Kind::HumidityLaw, "CNaf", COMPARED[1]);
    assert!(lambda.strips_differ_p.unwrap() < 1e-3, "{lambda:?}");
    let (least, largest) = lambda.strips_from_to.unwrap();
    assert!(least < own[0][1] && own[0][1] < largest, "{lambda:?} {own:?}");
    assert!(
        lambda.low_95.unwrap() < own[0][1] && lambda.high_95.unwrap() > own[0][1],
        "{lambda:?} {own:?}"
    );
    assert!(
        sentence(lambda).contains(" times in single strips"),
        "{}",
        sentence(lambda)
    );
}

#[test]
fn what_rose_with_the_humidity_is_said_and_what_can_be_told_apart_is_taken_out() {
    let (mut runs, campaign, _) = simulated(TWO, &TRUE, 4);
    for own in &mut runs {
        let humidity = own.tag_number("relative_humidity_percent").unwrap();
        own.tags.retain(|own| own.key != "cycle");
        own.tags
            .push(tag("cycle", &((humidity / 15.0).round() as i64).to_string()));
    }
    let study = study(&runs, &campaign);
    let lambda = law(&study, Kind::HumidityLaw, "CNaf", COMPARED[1]);
    assert_eq!(lambda.also_changed, ["the cycle"]);
    let (runs, campaign, _) = simulated(TWO, &TRUE, 4);
    let study = super::two_scopes_tests::study(&runs, &campaign);
    let lambda = law(&study, Kind::HumidityLaw, "CNaf", COMPARED[1]);
    assert!(lambda.also_changed.is_empty(), "{lambda:?}");
}

#[test]
fn laws_hold_and_few_are_false() {
    let counts = counted(TWO, &TRUE, 0..6);
    assert!(
        counts.strips_hold as f64 >= 0.88 * counts.asked as f64,
        "{counts:?}"
    );
    assert!(
        counts.true_found as f64 >= 0.85 * counts.true_there as f64,
        "{counts:?}"
    );
    let nothing = counted(TWO, &NOTHING, 0..6);
    assert!(nothing.studies_with_false <= 1, "{nothing:?}");
}

/// Of designs whose humidities lie as they fall, from 2 to 8 points apart, in how many lambda is told to follow the humidity
/// that doubles it over all of them.
fn told_of_random_designs(seeds: std::ops::Range<u64>) -> (usize, usize) {
    let (mut asked, mut told) = (0, 0);
    for seed in seeds {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut at = random.random_range(20.0..40.0);
        let mut humidities = vec![at];
        for _ in 0..random.random_range(4..12) {
            at += random.random_range(2.0..8.0);
            humidities.push(at);
        }
        let slope = 2.0_f64.ln() / (at - humidities[0]);
        let design = Design {
            strips: random.random_range(1..=2),
            humidities: Box::leak(humidities.into_boxed_slice()),
            repeats: 1,
            voltages: random.random_range(1..=2),
            ..TWO
        };
        let truth = [[0.0, slope, 0.0, 0.0, 0.0]; 2];
        let (runs, campaign, _) = simulated(design, &truth, seed);
        let study = study(&runs, &campaign);
        for material in MATERIALS {
            let of = |own: &&Answer| {
                (own.kind, own.material.as_str(), own.parameter) == (Kind::HumidityLaw, material, COMPARED[1])
            };
            asked += 1;
            told += usize::from(
                study
                    .asked()
                    .find(of)
                    .is_some_and(|own| own.verdict == Verdict::Differs),
            );
        }
    }
    (told, asked)
}

#[test]
fn humidities_are_followed_however_they_fall() {
    // Twelve humidities 4 points apart: no gap makes levels of them.
    let close = Design {
        strips: 1,
        humidities: &[
            20.0, 24.0, 28.0, 32.0, 36.0, 40.0, 44.0, 48.0, 52.0, 56.0, 60.0, 64.0,
        ],
        repeats: 1,
        ..TWO
    };
    let (runs, campaign, _) = simulated(close, &TRUE, 3);
    let own = study(&runs, &campaign);
    assert!(own.compared.contains(&ieap_domain::Factor::Humidity));
    assert_eq!(
        law(&own, Kind::HumidityLaw, "CNaf", COMPARED[1]).verdict,
        Verdict::Differs
    );
    // Three years of a room between 30 and 40 %, its humidity never set.
    let room = Design {
        strips: 1,
        humidities: &[30.0, 31.0, 33.0, 36.0, 38.0, 40.0, 39.0, 37.0, 34.0, 32.0],
        repeats: 4,
        ..TWO
    };
    let truth = [[0.0, 0.04, 0.0, 0.0, 0.0]; 2];
    let (runs, campaign, _) = simulated(room, &truth, 3);
    let own = study(&runs, &campaign);
    assert_eq!(
        law(&own, Kind::HumidityLaw, "CNaf", COMPARED[1]).verdict,
        Verdict::Differs
    );
    let (told, asked) = told_of_random_designs(0..12);
    assert!(told * 100 >= 85 * asked, "{told} of {asked}");
}

/// `cargo test -p ieap-analysis --lib study::two_scopes -- --include-ignored --nocapture`
#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn counts_of_laws() {
    let three = Design { strips: 3, ..TWO };
    println!("random designs: {:?}", told_of_random_designs(16000..16060));
    for (name, design) in [
        ("two strips", TWO),
        (
            "two strips, one run a humidity, 10 %",
            Design {
                repeats: 1,
                scatter: [0.2, 0.0, 0.1],
                ..TWO
            },
        ),
        (
            "two strips, three humidities",
            Design {
                humidities: &[25.0, 50.0, 75.0],
                ..TWO
            },
        ),
        ("two strips, slopes spread by 20 %", Design { spread: 0.2, ..TWO }),
        (
            "two strips, sessions of 5 %",
            Design {
                scatter: [0.2, 0.05, 0.05],
                ..TWO
            },
        ),
        (
            "two strips, a third of the runs lost",
            Design {
                lost: 0.3,
                voltages: 2,
                ..TWO
            },
        ),
        (
            "two strips, continuum",
            Design {
                is_continuum: true,
                ..TWO
            },
        ),
        (
            "three strips, slopes spread by 20 %",
            Design { spread: 0.2, ..three },
        ),
        (
            "four strips, sessions of 5 %",
            Design {
                strips: 4,
                scatter: [0.2, 0.05, 0.05],
                ..TWO
            },
        ),
        ("six strips", Design { strips: 6, ..TWO }),
    ] {
        println!("{name}: {:?}", counted(design, &TRUE, 7000..7040));
        println!("{name}, nothing: {:?}", counted(design, &NOTHING, 7000..7040));
    }
}
