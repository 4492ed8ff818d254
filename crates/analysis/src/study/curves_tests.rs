//! Whole curves with a known truth: how often "nowhere more than" is true, what is claimed where nothing is.

use std::collections::BTreeMap;

use ieap_domain::{Factor, RunRecord};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

use super::measures::{BENDING_CURVE, CURRENT_CURVE};
use super::tests::{BALANCED, Design, nothing, simulated};
use super::*;
use crate::laws::doubt::Doubts;
use crate::model_free::curves::{StepCurves, TimePoint, time_s};

/// Places of the times at which curves are drawn: 1 s to 1000 s.
const PLACES: std::ops::RangeInclusive<i32> = 0..=9;
/// Noise of a value, part of the largest.
const NOISE: f64 = 0.01;

/// The true curve at 1 V: in inert gas a tenth more than in vacuum; in air a third less, and what comes late is another.
fn mean(key: &str, environment: &str, differs: bool, time_s: f64) -> f64 {
    let (size, late_s) = match environment {
        "inert" if differs => (1.1, 2000.0),
        "air" if differs => (0.7, 500.0),
        _ => (1.0, 2000.0),
    };
    let rise = 1.0 - (-time_s / 20.0).exp();
    match key {
        CURRENT_CURVE => size * (1.1 - rise) * (1.0 - 0.3 * (-time_s / late_s).exp()),
        _ => size * rise * (-time_s / late_s).exp(),
    }
}

/// Curves of these runs: their size and what comes late differ by chance from sample to sample, in each environment of a
/// sample, and from run to run.
pub(super) fn drawn(runs: &[RunRecord], design: Design, differs: bool, seed: u64) -> Vec<StepCurves> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let normal = Normal::new(0.0, 1.0).unwrap();
    let mut known: BTreeMap<(String, String), [f64; 4]> = BTreeMap::new();
    let mut of_run = |run: &RunRecord| {
        let (sample, environment) = (run.tag("sample").unwrap(), run.tag("environment").unwrap());
        let volts = run.tag_number("voltage_v").unwrap();
        let mut off = [0.0; 4];
        let levels = [(sample, ""), (sample, environment), (run.path.as_str(), "")];
        for (level, (name, within)) in levels.into_iter().enumerate() {
            let key = (name.to_owned(), within.to_owned());
            let own = known
                .entry(key)
                .or_insert_with(|| [(); 4].map(|()| normal.sample(&mut random)));
            off.iter_mut()
                .zip(*own)
                .for_each(|(off, own)| *off += design.scatter[level] * own);
        }
        let mut curve = |key: &str, off: &[f64]| -> Vec<TimePoint> {
            let point = |place: i32| {
                let late = off[1] * time_s(place) / (time_s(place) + 200.0);
                let value = mean(key, environment, differs, time_s(place)) * (1.0 + off[0] + late);
                TimePoint {
                    place,
                    value: volts * (value + NOISE * normal.sample(&mut random)),
                    variance: (volts * NOISE).powi(2),
                }
            };
            PLACES.map(point).collect()
        };
        StepCurves {
            current: curve(CURRENT_CURVE, &off[..2]),
            bending: curve(BENDING_CURVE, &off[2..]),
        }
    };
    runs.iter().map(&mut of_run).collect()
}

fn study(design: Design, differs: bool, seed: u64) -> Study {
    let (runs, mut campaign) = simulated(design, nothing, seed);
    campaign.study.compare = vec![Factor::Environment];
    Study::of(Evidence {
        runs: &runs,
        campaign: &campaign,
        doubts: &Doubts::default(),
        curves: &drawn(&runs, design, differs, seed + 1_000_000),
    })
}

#[test]
fn without_its_curves_a_study_is_what_it_is_where_none_were_read() {
    let design = BALANCED;
    let (runs, mut campaign) = simulated(design, nothing, 1);
    campaign.study.compare = vec![Factor::Environment];
    let evidence = Evidence {
        runs: &runs,
        campaign: &campaign,
        doubts: &Doubts::default(),
        curves: &drawn(&runs, design, true, 2),
    };
    let with = Study::of(evidence);
    let without = Study::of(Evidence {
        curves: &[],
        ..evidence
    });
    assert!(with != without);
    assert_eq!(with.without_curves(&campaign), without);
}

/// The true difference at each time, percent of the range of both.
fn truth(own: &Answer, differs: bool) -> Vec<f64> {
    let side = |name: &str, place| {
        let of = |environment| mean(own.parameter, environment, differs, time_s(place));
        if name.starts_with("dry") {
            0.5 * (of("vacuum") + of("inert"))
        } else {
            of(name)
        }
    };
    let both = PLACES.map(|place| (side(&own.upper, place), side(&own.lower, place)));
    let range = both
        .clone()
        .map(|(upper, lower)| 0.5 * (upper + lower))
        .fold(0.0, f64::max);
    both.map(|(upper, lower)| 100.0 * (upper - lower) / range)
        .collect()
}

#[derive(Debug, Default)]
struct Counts {
    asked: usize,
    nowhere_more: usize,
    held: usize,
    claims: usize,
    studies_with_a_claim: usize,
}

fn counted(design: Design, differs: bool, seeds: std::ops::Range<u64>) -> Counts {
    let mut counts = Counts::default();
    for seed in seeds {
        let study = study(design, differs, seed);
        let before = counts.claims;
        for own in study.asked().filter(|own| own.is_of_curve()) {
            let truth = truth(own, differs);
            let Some((most, (low, high))) = own.no_more_than.zip(own.low_95.zip(own.high_95)) else {
                continue;
            };
            let at = PLACES
                .clone()
                .position(|place| Some(time_s(place)) == own.most_at_s)
                .unwrap();
            counts.asked += 1;
            counts.nowhere_more += usize::from(truth.iter().all(|off| off.abs() <= most));
            counts.held += usize::from((low..=high).contains(&truth[at]));
            counts.claims += usize::from(own.verdict == Verdict::Differs);
        }
        counts.studies_with_a_claim += usize::from(counts.claims > before);
    }
    counts
}

#[test]
fn a_whole_curve_is_alike_or_differs_where_it_does() {
    let five = Design {
        samples: 5,
        ..BALANCED
    };
    let study = study(five, true, 3);
    let of = |upper: &str| {
        let mut asked = study.asked();
        asked
            .find(|own| own.parameter == BENDING_CURVE && own.upper == upper && own.material == "CNaf")
            .unwrap()
    };
    let (air, inert) = (of("air"), of("inert"));
    assert_eq!(
        (air.verdict, air.times_s),
        (Verdict::Differs, Some((1.0, 1000.0))),
        "{air:?}"
    );
    assert!(
        air.value.unwrap() < -30.0 && air.high_95.unwrap() < 0.0,
        "{air:?}"
    );
    let largest = truth(inert, true)
        .iter()
        .fold(0.0_f64, |most, off| most.max(off.abs()));
    assert!(inert.no_more_than.unwrap() >= largest, "{inert:?}");
    let said = lead(&study, "CNaf").join(" ");
    assert!(
        said.contains("curve of bending is lower by ") && said.contains(" do not change (within "),
        "{said}"
    );
    assert!(study.left_out_of_curves.is_empty());
}

#[test]
fn what_does_not_differ_is_no_claim_and_a_bound_is_true() {
    let none = counted(BALANCED, false, 0..12);
    assert!(none.studies_with_a_claim <= 2, "{none:?}");
    let some = counted(BALANCED, true, 0..12);
    assert!(some.nowhere_more as f64 >= 0.9 * some.asked as f64, "{some:?}");
}

#[test]
fn runs_without_a_curve_are_named_and_short_curves_say_why() {
    let (runs, campaign) = simulated(BALANCED, nothing, 4);
    let mut curves = drawn(&runs, BALANCED, false, 5);
    let of = |curves: &[StepCurves]| {
        Study::of(Evidence {
            runs: &runs,
            campaign: &campaign,
            doubts: &Doubts::default(),
            curves,
        })
    };
    curves[0] = StepCurves::default();
    assert_eq!(of(&curves).left_out_of_curves, [runs[0].path.clone()]);
    for own in &mut curves {
        own.bending.truncate(3);
    }
    let study = of(&curves);
    let short = study.asked().find(|own| own.parameter == BENDING_CURVE).unwrap();
    assert_eq!(
        (short.verdict, short.value),
        (Verdict::NotTold, None),
        "{short:?}"
    );
    assert!(
        short.reason.as_ref().unwrap().contains("too few times"),
        "{short:?}"
    );
    // Who reads no curve asks nothing of them.
    assert!(of(&[]).left_out_of_curves.is_empty());
}

/// `cargo test -p ieap-analysis --release --lib curves_tests -- --include-ignored --nocapture`
#[test]
#[ignore = "minutes: counts for docs/validation/study.md"]
fn counts_of_many_curves() {
    let unlike = Design {
        scatter: [0.2, 0.15, 0.05],
        ..BALANCED
    };
    let alike = Design {
        scatter: [0.2, 0.0, 0.05],
        ..BALANCED
    };
    let lost = Design {
        samples: 5,
        lost: 0.3,
        ..unlike
    };
    let single = Design {
        samples: 1,
        voltages: 3,
        repeats: 1,
        scatter: [0.0, 0.0, 0.1],
        ..BALANCED
    };
    for (name, design) in [
        ("samples differ", unlike),
        ("samples do not differ", alike),
        ("two samples", Design { samples: 2, ..unlike }),
        ("30 % lost", lost),
        ("one run a condition", single),
    ] {
        for differs in [false, true] {
            println!("{name}, {differs}: {:?}", counted(design, differs, SEEDS));
        }
    }
}

const SEEDS: std::ops::Range<u64> = 6000..6200;
