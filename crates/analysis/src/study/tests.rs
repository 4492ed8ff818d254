//! Studies with a known truth: how often intervals hold, what is claimed where nothing is, what is found where something is.

use ieap_domain::testing::{campaign, fit, known, run, tag};
use ieap_domain::{Campaign, Estimate, Factor, RunRecord, Sample};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

use super::*;
use crate::laws::doubt::Doubts;

/// What a simulated study is like.
#[derive(Debug, Clone, Copy)]
pub(super) struct Design {
    pub samples: usize,
    pub voltages: usize,
    pub repeats: usize,
    /// Part of the runs that are lost.
    pub lost: f64,
    /// Standard deviation between samples, of samples in environments, from run to run: logarithms.
    pub scatter: [f64; 3],
    /// Error of the fits.
    pub error: f64,
    /// Whether one run in ten strays by three times as much.
    pub strays: bool,
}

pub(super) const BALANCED: Design = Design {
    samples: 3,
    voltages: 2,
    repeats: 2,
    lost: 0.0,
    scatter: [0.2, 0.05, 0.05],
    error: 0.02,
    strays: false,
};
const ENVIRONMENTS: [&str; 3] = ["vacuum", "inert", "air"];
const MATERIALS: [&str; 2] = ["CNaf", "CPvf"];
const KEYS: [&str; 2] = ["alpha_per_c_cm", "lambda_per_s"];

/// Logarithms of the parameters in vacuum at the lowest voltage.
const LEVELS: [f64; 2] = [3.0, -9.0];

/// Logarithm of the true effect of an environment on a parameter of a material.
pub(super) type Truth = fn(material: &str, key: &str, environment: &str) -> f64;

/// Alpha of one material halved in vacuum, lambda of the other five times larger in air.
fn two_effects(material: &str, key: &str, environment: &str) -> f64 {
    match (material, key, environment) {
        ("CPvf", "alpha_per_c_cm", "vacuum") => -(2.0_f64.ln()),
        ("CNaf", "lambda_per_s", "air") => 5.0_f64.ln(),
        _ => 0.0,
    }
}

pub(super) fn nothing(_: &str, _: &str, _: &str) -> f64 {
    0.0
}

pub(super) fn simulated(design: Design, truth: Truth, seed: u64) -> (Vec<RunRecord>, Campaign) {
    let (runs, campaign, _) = simulated_with_own(design, truth, seed);
    (runs, campaign)
}

/// By material, parameter and environment: by how much the strips strayed in it, on average.
type Strayed = [[[f64; 3]; 2]; 2];

fn simulated_with_own(design: Design, truth: Truth, seed: u64) -> (Vec<RunRecord>, Campaign, Strayed) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut draw = |size: f64| {
        if size > 0.0 {
            Normal::new(0.0, size).unwrap().sample(&mut random)
        } else {
            0.0
        }
    };
    let mut campaign = campaign();
    let (mut runs, mut strayed) = (Vec::new(), Strayed::default());
    for (m, material) in MATERIALS.into_iter().enumerate() {
        for sample in 0..design.samples {
            let id = format!("{material}-{sample}");
            campaign.samples.push(Sample {
                id: id.clone(),
                material: material.to_owned(),
                ..campaign.samples[0].clone()
            });
            let own = KEYS.map(|_| draw(design.scatter[0]));
            for (e, environment) in ENVIRONMENTS.into_iter().enumerate() {
                let both = KEYS.map(|_| draw(design.scatter[1]));
                (0..2).for_each(|k| strayed[m][k][e] += both[k] / design.samples as f64);
                for voltage in 0..design.voltages {
                    for repeat in 0..design.repeats {
                        // Every tenth lost run in a hundred draws: by a number of its own.
                        if draw(1.0).abs() < 0.126 * design.lost / 0.1 {
                            continue;
                        }
                        let number = |k: usize, draw: &mut dyn FnMut(f64) -> f64| -> Estimate {
                            let at = LEVELS[k] + truth(material, KEYS[k], environment) + 0.3 * voltage as f64;
                            let far = design.strays && draw(1.0).abs() > 1.645;
                            let scatter = if far { 3.0 } else { 1.0 } * design.scatter[2];
                            let y = at + own[k] + both[k] + draw(scatter) + draw(design.error);
                            known(y.exp(), design.error)
                        };
                        let found: Vec<(&str, Estimate)> =
                            (0..2).map(|k| (KEYS[k], number(k, &mut draw))).collect();
                        let mut one = run(
                            &format!("{id}-{environment}-{voltage}-{repeat}"),
                            &id,
                            environment,
                            None,
                            1.0 + voltage as f64,
                        );
                        one.fit = Some(fit(&found));
                        one.tags.push(tag("cycle", &(1 + repeat).to_string()));
                        runs.push(one);
                    }
                }
            }
        }
    }
    (runs, campaign, strayed)
}

fn study(design: Design, truth: Truth, seed: u64) -> Study {
    study_with_own(design, truth, seed).0
}

fn study_with_own(design: Design, truth: Truth, seed: u64) -> (Study, Strayed) {
    let (runs, mut campaign, strayed) = simulated_with_own(design, truth, seed);
    campaign.study.compare = vec![Factor::Environment, Factor::Material];
    let study = Study::of(Evidence {
        runs: &runs,
        campaign: &campaign,
        doubts: &Doubts::default(),
        curves: &[],
    });
    (study, strayed)
}

/// The true logarithm of a pooled answer about environments, by that of an environment in a material.
fn true_value(own: &Answer, truth: impl Fn(&str, &str) -> f64) -> f64 {
    let of = |material: &str| {
        let side = |name: &str| match name.strip_prefix("dry (") {
            Some(_) => 0.5 * (truth(material, "vacuum") + truth(material, "inert")),
            None => truth(material, name),
        };
        side(&own.upper) - side(&own.lower)
    };
    of(&own.material) - own.against_material.as_deref().map_or(0.0, of)
}

/// Counts over simulated studies.
#[derive(Debug, Default)]
struct Counts {
    asked: usize,
    held: usize,
    alike_asked: usize,
    alike_true: usize,
    studies_with_false: usize,
    claims: usize,
    false_claims: usize,
    true_found: usize,
    true_there: usize,
    /// Of the strips as they were measured, by what these strayed.
    strips_asked: usize,
    strips_held: usize,
    strips_found: usize,
}

fn counted(design: Design, truth: Truth, seeds: std::ops::Range<u64>) -> Counts {
    let mut counts = Counts::default();
    let place = |of: &[&str], name: &str| of.iter().position(|own| *own == name).unwrap();
    for seed in seeds {
        let (study, strayed) = study_with_own(design, truth, seed);
        let mut has_false = false;
        let of_environments = |own: &&Answer| {
            matches!(own.kind, Kind::Environment | Kind::ByMaterial) && own.scale == Scale::Ratio
        };
        for own in study
            .asked()
            .filter(of_environments)
            .filter(|own| KEYS.contains(&own.parameter))
        {
            let k = place(&KEYS, own.parameter);
            let of = |material: &str, environment: &str| truth(material, KEYS[k], environment);
            let of_strips = |material: &str, environment: &str| {
                let (m, e) = (place(&MATERIALS, material), place(&ENVIRONMENTS, environment));
                of(material, environment) + strayed[m][k][e]
            };
            if let Some(strips) = &own.of_strips {
                let own_truth = true_value(own, of_strips);
                let ends = strips.low_95.ln()..=strips.high_95.ln();
                counts.strips_asked += 1;
                counts.strips_held += usize::from(ends.contains(&own_truth));
                counts.strips_found += usize::from(strips.is_shown && true_value(own, of) != 0.0);
            }
            let truth = true_value(own, of);
            let (Some(low), Some(high)) = (own.low_95, own.high_95) else {
                continue;
            };
            counts.asked += 1;
            counts.held += usize::from((low.ln()..=high.ln()).contains(&truth));
            let most = own.no_more_than.unwrap();
            counts.alike_asked += 1;
            counts.alike_true += usize::from(100.0 * truth.abs().exp_m1() <= most + 1e-9);
            let claims = own.verdict == Verdict::Differs;
            counts.claims += usize::from(claims);
            counts.false_claims += usize::from(claims && truth == 0.0);
            has_false |= claims && truth == 0.0;
            counts.true_there += usize::from(truth != 0.0);
            counts.true_found += usize::from(claims && truth != 0.0);
        }
        counts.studies_with_false += usize::from(has_false);
    }
    counts
}

#[test]
fn two_effects_are_found_and_named_with_their_size() {
    let study = study(BALANCED, two_effects, 1);
    let of = |material: &str, key: &str, upper: &str| {
        study
            .asked()
            .find(|own| {
                own.kind == Kind::Environment
                    && own.material == material
                    && own.parameter == key
                    && own.upper == upper
            })
            .unwrap()
    };
    let halved = of("CPvf", "alpha_per_c_cm", "inert");
    assert_eq!(
        (halved.verdict, halved.lower.as_str()),
        (Verdict::Differs, "vacuum"),
        "{halved:?}"
    );
    assert!(
        halved.low_95.unwrap() < 2.0 && halved.high_95.unwrap() > 2.0,
        "{halved:?}"
    );
    let faster = of("CNaf", "lambda_per_s", "air");
    assert_eq!(
        (faster.verdict, faster.lower.as_str()),
        (Verdict::Differs, "dry (vacuum, inert)"),
        "{faster:?}"
    );
    assert!(
        faster.low_95.unwrap() < 5.0 && faster.high_95.unwrap() > 5.0,
        "{faster:?}"
    );
    let lead = lead(&study, "CPvf");
    assert!(
        lead.iter()
            .any(|line| line.starts_with("In inert gas, against vacuum, CPvf's coupling α rises ")),
        "{lead:?}"
    );
}

#[test]
fn two_strips_tell_what_surroundings_did_to_them_and_say_what_their_material_needs() {
    let two = Design {
        samples: 2,
        ..BALANCED
    };
    let counts = counted(two, two_effects, 0..6);
    assert!(
        counts.strips_held as f64 >= 0.88 * counts.strips_asked as f64 && counts.strips_asked > 0,
        "{counts:?}"
    );
    assert!(counts.strips_found == counts.true_there, "{counts:?}");
    let unlike = Design {
        scatter: [0.2, 0.15, 0.05],
        ..two
    };
    let is_open = |own: &&Answer| {
        own.certainty == Certainty::Open
            && own.verdict == Verdict::Open
            && own.of_strips.as_ref().is_some_and(|strips| strips.is_shown)
    };
    let mut studies = (0..20).map(|seed| study(unlike, two_effects, seed));
    let open = studies
        .find_map(|study| study.asked().find(is_open).cloned())
        .unwrap();
    let open = &open;
    assert_eq!(open.scope, Scope::Material, "{open:?}");
    let said = sentence(open);
    assert!(
        said.ends_with(" in the two strips measured; a third would tell)."),
        "{said}"
    );
}

#[test]
fn intervals_hold_and_nothing_is_claimed_where_nothing_is() {
    let counts = counted(BALANCED, nothing, 0..12);
    assert!(counts.held as f64 >= 0.9 * counts.asked as f64, "{counts:?}");
    assert!(
        counts.alike_true as f64 >= 0.9 * counts.alike_asked as f64,
        "{counts:?}"
    );
    assert!(counts.studies_with_false <= 2, "{counts:?}");
}

/// `cargo test -p ieap-analysis --release --lib study::tests -- --include-ignored --nocapture`
#[test]
#[ignore = "minutes: counts for docs/validation/study.md"]
fn counts_of_many_studies() {
    let unlike = Design {
        scatter: [0.2, 0.15, 0.05],
        ..BALANCED
    };
    let alike = Design {
        scatter: [0.2, 0.0, 0.05],
        ..BALANCED
    };
    let two = Design { samples: 2, ..unlike };
    let lost = Design {
        samples: 5,
        lost: 0.3,
        ..unlike
    };
    let strays = Design {
        strays: true,
        ..unlike
    };
    for (name, design) in [
        ("samples differ", unlike),
        ("samples do not differ", alike),
        ("two samples", two),
        ("30 % lost", lost),
        ("one run in ten strays", strays),
    ] {
        for (effects, truth) in [
            ("nothing", nothing as Truth),
            ("two effects", two_effects as Truth),
        ] {
            println!("{name}, {effects}: {:?}", counted(design, truth, 8000..8200));
        }
    }
}

/// The study of simulated runs, with the fits of two of them put in each other's place, or without these two.
fn with_swapped(seed: u64, names: [&str; 2], are_left_out: bool) -> Study {
    let (mut runs, mut campaign) = simulated(BALANCED, two_effects, seed);
    campaign.study.compare = vec![Factor::Environment, Factor::Material];
    let [a, b] = names.map(|name| runs.iter().position(|own| own.path.contains(name)).unwrap());
    let fits = [runs[a].fit.take(), runs[b].fit.take()];
    if !are_left_out {
        [runs[b].fit, runs[a].fit] = fits;
    }
    Study::of(Evidence {
        runs: &runs,
        campaign: &campaign,
        doubts: &Doubts::default(),
        curves: &[],
    })
}

#[test]
fn two_swapped_runs_are_named_and_move_no_answer() {
    // A run of the material whose lambda is five times larger in air, and one of the material whose alpha is halved in vacuum.
    let swapped = ["CNaf-1-air-0-1", "CPvf-2-vacuum-1-0"];
    let (mut held, mut asked, mut said_swapped) = (0, 0, 0);
    for seed in 0..8 {
        let [odd, clean] = [false, true].map(|are_left_out| with_swapped(seed, swapped, are_left_out));
        let is_named = |name: &str| {
            odd.odd
                .iter()
                .any(|own| own.run.contains(name) && own.weight < 0.01)
        };
        assert!(swapped.iter().all(|name| is_named(name)), "{seed}: {:?}", odd.odd);
        let said = odd::odd_runs(&odd.odd).join("\n");
        assert!(
            said.contains("is not like the other runs of its condition"),
            "{said}"
        );
        let in_short = odd_in_short(&odd.odd).unwrap();
        assert_eq!(odd_in_short(&clean.odd), None);
        said_swapped += usize::from(in_short.contains(" may be swapped"));
        let odd_ones = odd.odd.iter().filter(|own| own.weight >= 0.99);
        assert_eq!(odd_ones.count(), 0, "{:?}", odd.odd);
        let both = clean.asked().zip(odd.asked());
        for (clean, own) in both.filter(|(own, _)| own.scale == Scale::Ratio) {
            let (Some(low), Some(high)) = (clean.low_95, clean.high_95) else {
                continue;
            };
            let width = |low: f64, high: f64| (high / low).ln();
            let (before, after) = (width(low, high), width(own.low_95.unwrap(), own.high_95.unwrap()));
            let moved = (own.value.unwrap() / clean.value.unwrap()).ln().abs();
            asked += 1;
            let is_alike = moved < 0.1 * before && (after / before - 1.0).abs() < 0.1;
            held += usize::from(is_alike);
        }
    }
    println!("{held} of {asked}");
    assert!(said_swapped >= 6, "{said_swapped} of 8");
    assert!(held * 10 >= asked * 9, "{held} of {asked}");
}

#[test]
fn one_run_a_condition_says_three_things() {
    let design = Design {
        samples: 1,
        voltages: 3,
        repeats: 1,
        ..BALANCED
    };
    let study = study(design, two_effects, 3);
    let own = study
        .asked()
        .find(|own| own.parameter == KEYS[0] && own.material == "CPvf" && own.upper == "inert")
        .unwrap();
    assert_eq!((own.basis, own.samples), (Basis::DryPair, 1));
    let (fits, all) = (
        own.fits_high_95.unwrap() / own.fits_low_95.unwrap(),
        own.high_95.unwrap() / own.low_95.unwrap(),
    );
    assert!(fits < all, "{own:?}");
    // What would undo a factor of two of three pairs: 100 (exp(ln 2 / 1.96 / sqrt(2 / 3)) - 1), by the fits a little less.
    let undone = own.undone_by_scatter.unwrap();
    let expected = 100.0 * (own.value.unwrap().ln() / 1.96 / (2.0_f64 / 3.0).sqrt()).exp_m1();
    assert!((undone / expected - 1.0).abs() < 0.05, "{undone} {expected}");
}

#[test]
fn a_bound_gives_a_bound_and_enters_no_mean() {
    let design = Design {
        samples: 1,
        voltages: 2,
        repeats: 1,
        ..BALANCED
    };
    let (mut runs, campaign) = simulated(design, two_effects, 4);
    let bounded = runs
        .iter_mut()
        .find(|own| own.path.contains("CNaf-0-vacuum-1"))
        .unwrap();
    bounded.fit = Some(fit(&[
        (KEYS[0], known(20.0, 0.1)),
        (KEYS[1], Estimate::below(1e-7, "search limit")),
    ]));
    let study = Study::of(Evidence {
        runs: &runs,
        campaign: &campaign,
        doubts: &Doubts::default(),
        curves: &[],
    });
    let own: Vec<&Answer> = study
        .answers
        .iter()
        .filter(|own| {
            own.material == "CNaf"
                && own.parameter == KEYS[1]
                && own.kind == Kind::Environment
                && own.upper == "air"
                && own.lower == "vacuum"
        })
        .collect();
    let bound = own.iter().find(|own| own.voltages_v == [2.0]).unwrap();
    assert_eq!((bound.verdict, bound.value), (Verdict::Bound, None));
    assert!(bound.at_least.unwrap() > 1e3, "{bound:?}");
    let pooled = own.iter().find(|own| own.value.is_some()).unwrap();
    assert_eq!(pooled.voltages_v, [1.0]);
}

/// The studies of the same runs with alpha as it is and with each value taken through `of`.
fn with_alpha(of: impl Fn(usize, f64) -> f64) -> Study {
    let (mut runs, campaign) = simulated(BALANCED, two_effects, 6);
    for (at, run) in runs.iter_mut().enumerate() {
        let alpha = &mut run.fit.as_mut().unwrap().parameters[0].estimate;
        let value = of(at, alpha.value.unwrap());
        let error = 0.02 * value.abs();
        *alpha = Estimate::determined(value, error, value - 1.96 * error, value + 1.96 * error);
    }
    Study::of(Evidence {
        runs: &runs,
        campaign: &campaign,
        doubts: &Doubts::default(),
        curves: &[],
    })
}

#[test]
fn bending_that_is_counted_the_other_way_round_is_compared_by_its_size() {
    let alpha = |study: &Study| -> Vec<Answer> {
        let of = |own: &&Answer| own.parameter == KEYS[0] && own.kind == Kind::Environment;
        study.answers.iter().filter(of).cloned().collect()
    };
    let (usual, other) = (
        alpha(&with_alpha(|_, value| value)),
        alpha(&with_alpha(|_, value| -value)),
    );
    assert_eq!(usual.len(), other.len());
    for (usual, other) in usual.iter().zip(&other) {
        assert!(
            (usual.value.unwrap() / other.value.unwrap() - 1.0).abs() < 1e-3,
            "{usual:?} {other:?}"
        );
        assert_eq!(usual.verdict, other.verdict);
    }
    // Of both signs there is no ratio: every question says so.
    let mixed = alpha(&with_alpha(|at, value| if at % 2 == 0 { value } else { -value }));
    assert!(!mixed.is_empty() && mixed.iter().all(|own| own.verdict == Verdict::NotTold));
    assert!(
        mixed[0].reason.as_ref().unwrap().contains("no ratio"),
        "{mixed:?}"
    );
}

#[test]
fn a_law_of_the_voltage_goes_over_its_size_and_runs_of_no_answer_are_named() {
    let (mut runs, campaign) = simulated(
        Design {
            voltages: 3,
            ..BALANCED
        },
        nothing,
        8,
    );
    // Lambda grows by 30 % a step of the voltage; half of the repeats bend to the other side.
    for run in runs.iter_mut().filter(|run| run.path.ends_with("-1.csv")) {
        let volts = run.tag_number("voltage_v").unwrap();
        run.tags.retain(|own| own.key != "voltage_v");
        run.tags.push(tag("voltage_v", &(-volts).to_string()));
    }
    runs[0].tags.retain(|own| own.key != "environment");
    let study = Study::of(Evidence {
        runs: &runs,
        campaign: &campaign,
        doubts: &Doubts::default(),
        curves: &[],
    });
    let law = study
        .asked()
        .find(|own| own.kind == Kind::VoltageLaw && own.parameter == KEYS[1])
        .unwrap();
    assert!(
        law.low_95.unwrap() < 0.3 && law.high_95.unwrap() > 0.3 && law.span == Some(2.0),
        "{law:?}"
    );
    assert_eq!((law.scope, law.samples), (Scope::Strips, 3), "{law:?}");
    let material = law.of_material.as_ref().unwrap();
    assert!(
        material.is_shown && material.low_95 <= law.low_95.unwrap(),
        "{law:?}"
    );
    let said = sentence(law);
    // Of the material too: no word of strips.
    assert!(said.contains(" rises ") && !said.contains("strips"), "{said}");
    assert_eq!(study.left_out, [runs[0].path.clone()]);
    assert!(words::left_out(&study)[0].starts_with("1 fitted run takes part in no answer (runs/"));
}

#[test]
fn what_changed_with_an_environment_is_said_beside_it() {
    let (mut runs, campaign) = simulated(BALANCED, two_effects, 5);
    for own in &mut runs {
        let in_air = own.tag("environment") == Some("air");
        own.tags.retain(|own| own.key != "cycle");
        own.tags.push(tag("cycle", if in_air { "9" } else { "1" }));
        own.tags
            .push(tag("instrument", if in_air { "camera" } else { "laser" }));
    }
    let study = Study::of(Evidence {
        runs: &runs,
        campaign: &campaign,
        doubts: &Doubts::default(),
        curves: &[],
    });
    let own = study
        .asked()
        .find(|own| own.upper == "air" && own.parameter == KEYS[1])
        .unwrap();
    assert_eq!(
        own.also_changed,
        ["the cycle (9 against 1)", "the instrument (camera against laser)"]
    );
    let dry = study.asked().find(|own| own.upper == "inert").unwrap();
    assert!(dry.also_changed.is_empty(), "{dry:?}");
}

#[test]
fn a_law_of_the_humidity_is_found_within_an_environment() {
    let mut campaign = campaign();
    let mut runs = Vec::new();
    let mut random = ChaCha8Rng::seed_from_u64(9);
    let mut draw = |size: f64| Normal::new(0.0, size).unwrap().sample(&mut random);
    for sample in 0..3 {
        let id = format!("S-{sample}");
        campaign.samples.push(Sample {
            id: id.clone(),
            material: "CNaf".to_owned(),
            ..campaign.samples[0].clone()
        });
        let own = draw(0.2);
        for humidity in [10.0, 30.0, 50.0, 70.0] {
            let y: f64 = -8.0 + own + 0.03 * humidity + draw(0.03);
            let mut one = run(&format!("{id}-{humidity}"), &id, "air", Some(humidity), 2.0);
            one.fit = Some(fit(&[(KEYS[1], known(y.exp(), 0.02))]));
            runs.push(one);
        }
    }
    let study = Study::of(Evidence {
        runs: &runs,
        campaign: &campaign,
        doubts: &Doubts::default(),
        curves: &[],
    });
    assert_eq!(study.compared, [Factor::Humidity]);
    // What the law answers is not asked pair by pair as well.
    assert!(
        study.asked().all(|own| own.kind == Kind::HumidityLaw),
        "{:?}",
        lead(&study, "CNaf")
    );
    assert!(study.answers.iter().any(|own| own.kind == Kind::Environment));
    let law = study
        .asked()
        .find(|own| own.kind == Kind::HumidityLaw && own.parameter == KEYS[1])
        .unwrap();
    assert_eq!(law.verdict, Verdict::Differs, "{law:?}");
    assert!(
        law.low_95.unwrap() < 0.03 && law.high_95.unwrap() > 0.03 && law.high_95.unwrap() < 0.035,
        "{law:?}"
    );
    assert!(
        sentence(law).contains(" % for each percent of humidity ("),
        "{}",
        sentence(law)
    );
}

/// `cargo test -p ieap-analysis --release --lib study::tests::ten -- --include-ignored --nocapture`
#[test]
#[ignore = "a measurement: says how long the answers of a large campaign take"]
fn ten_thousand_runs() {
    let design = Design {
        samples: 20,
        voltages: 4,
        repeats: 21,
        ..BALANCED
    };
    let (runs, campaign) = simulated(design, two_effects, 7);
    let curves = super::curves_tests::drawn(&runs, design, true, 8);
    let started = std::time::Instant::now();
    let study = Study::of(Evidence {
        runs: &runs,
        campaign: &campaign,
        doubts: &Doubts::default(),
        curves: &curves,
    });
    println!(
        "{} runs, {} answers: {:?}",
        runs.len(),
        study.answers.len(),
        started.elapsed()
    );
}
