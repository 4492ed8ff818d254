//! Uneven strips and broken foils are found, clean ones are left alone at the rate that is stated.

use std::sync::Arc;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::policy::UNEVEN_BELOW;
use super::*;
use ieap_domain::{Channel, Drive, Quantity};
use ieap_model::coupling::CurvaturePerLineCharge;
use ieap_model::distributed::{BrokenStrip, DistributedModel};

/// CNaf of table 3 of the thesis, 28 mm by 5 mm.
const CNAF: DistributedModel = DistributedModel {
    electrode_resistance_ohm_per_cm: 5.0,
    branch_resistance_ohm_cm: 9.0,
    capacitance_f_per_cm: 0.0655,
    steady_state_resistance_ohm_cm: 45.4,
    length_cm: 2.8,
    coupling: CurvaturePerLineCharge(5.88),
    relaxation_rate_per_s: 0.0029,
};
const PLACES: usize = 8;
const TIMES: usize = 100;

/// How a run is simulated.
#[derive(Clone, Copy)]
struct Case {
    /// Place (cm) and factor of a break.
    contact_break: Option<(f64, f64)>,
    /// Part by which couplings differ from place to place.
    uneven_coupling: f64,
    /// Noise, as a share of the largest reading.
    noise: f64,
    /// Its correlation in time, and between neighbouring places.
    autocorrelation: f64,
    neighbours: f64,
    voltages: bool,
}

const CLEAN: Case = Case {
    contact_break: None,
    uneven_coupling: 0.0,
    noise: 0.01,
    autocorrelation: 0.0,
    neighbours: 0.0,
    voltages: false,
};

fn autoregressive(autocorrelation: f64, random: &mut ChaCha8Rng) -> Vec<f64> {
    let mut last: f64 = StandardNormal.sample(random);
    let mut next = || {
        let fresh: f64 = StandardNormal.sample(random);
        last = autocorrelation * last + (1.0 - autocorrelation * autocorrelation).sqrt() * fresh;
        last
    };
    (0..TIMES).map(|_| next()).collect()
}

/// The current and voltages or curvatures at places, for a step of 1.5 V.
fn channels(model: &DistributedModel, case: &Case, seed: u64) -> Vec<Channel> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let time_s: Arc<[f64]> = (0..TIMES).map(|k| 200.0 * (k as f64 / 99.0).powi(2)).collect();
    let places: Vec<f64> = (0..PLACES)
        .map(|k| model.length_cm * (k as f64 + 0.5) / PLACES as f64)
        .collect();
    let (place, factor) = case.contact_break.unwrap_or((1.4, 1.0));
    let strip = BrokenStrip::new(model, place, factor);
    let (quantity, field) = if case.voltages {
        (Quantity::Voltage, strip.voltage_v(1.5, &places, &time_s))
    } else {
        (Quantity::Curvature, strip.curvature_per_cm(1.5, &places, &time_s))
    };
    let largest = |values: &[f64]| values.iter().fold(0.0f64, |most, v| most.max(v.abs()));
    let sd = case.noise * largest(&field.values);
    let mut channels = Vec::new();
    let mut neighbour = autoregressive(case.autocorrelation, &mut random);
    for (k, s) in places.iter().enumerate() {
        let own = autoregressive(case.autocorrelation, &mut random);
        let (a, b) = (case.neighbours, (1.0 - case.neighbours.powi(2)).sqrt());
        neighbour = neighbour.iter().zip(&own).map(|(n, o)| a * n + b * o).collect();
        let coupling = 1.0 + case.uneven_coupling * ((k * 7 % 5) as f64 - 2.0) / 2.0;
        let value = |t: usize| coupling * field.at(t, k) + sd * neighbour[t];
        let mut channel = Channel::new(quantity, time_s.clone(), (0..TIMES).map(value).collect());
        channel.position_mm = Some(10.0 * s);
        channels.push(channel);
    }
    let current = strip.clamp_current_a(1.5, &time_s);
    let sd = case.noise * largest(&current);
    let noise = autoregressive(case.autocorrelation, &mut random);
    let values = current.iter().zip(noise).map(|(i, n)| i + sd * n).collect();
    channels.push(Channel::new(Quantity::Current, time_s, values));
    channels
}

fn with_input<R>(
    model: &DistributedModel,
    case: &Case,
    seed: u64,
    then: impl Fn(&DistributedInput) -> R,
) -> R {
    let channels = channels(model, case, seed);
    let drive = Drive::step(1.5);
    then(&DistributedInput {
        channels: &channels,
        drive: &drive,
        strip: Strip {
            length_cm: model.length_cm,
            width_cm: 0.5,
            electrode_resistance_ohm_per_sq: None,
            electrode_resistance_error_ohm_per_sq: None,
        },
    })
}

/// Draws: few, or `IEAP_DRAWS` times as many. A hundred times takes an hour: it is a proof of its own, and no part of
/// the long tests of a change.
fn draws(few: u64) -> u64 {
    let times = std::env::var("IEAP_DRAWS")
        .ok()
        .and_then(|times| times.parse().ok());
    few * times.unwrap_or(1)
}

/// Counts of an event of chance `p` that `n` draws exceed in less than one of 2000 cases.
fn at_most(p: f64, n: u64) -> u64 {
    let mean = p * n as f64;
    (mean + 3.3 * (mean * (1.0 - p)).sqrt() + 1.0) as u64
}

const EVEN: DistributedModel = DistributedModel {
    electrode_resistance_ohm_per_cm: 1e-6,
    ..CNAF
};

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn even_strips_are_called_uneven_no_more_often_than_stated() {
    for (autocorrelation, neighbours) in [(0.0, 0.0), (0.6, 0.0), (0.6, 0.7)] {
        for voltages in [false, true] {
            let case = Case {
                autocorrelation,
                neighbours,
                voltages,
                ..CLEAN
            };
            let n = draws(10);
            let uneven = (0..n)
                .filter(|&seed| {
                    with_input(&EVEN, &case, seed, |input| {
                        decide(input).unwrap().unevenness.unwrap().p < UNEVEN_BELOW
                    })
                })
                .count() as u64;
            eprintln!(
                "correlation {autocorrelation}, neighbours {neighbours}, voltages {voltages}: {uneven} of {n}"
            );
            assert!(
                uneven <= at_most(UNEVEN_BELOW, n),
                "{autocorrelation} {neighbours} {voltages}: {uneven} of {n}"
            );
        }
    }
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn resistance_is_told_from_a_coupling_that_differs_from_place_to_place() {
    for seed in 0..draws(4) {
        let case = Case {
            noise: 0.003,
            autocorrelation: 0.6,
            neighbours: 0.7,
            ..CLEAN
        };
        let verdict = with_input(&CNAF, &case, seed, |input| decide(input).unwrap().verdict());
        assert_eq!(verdict, LumpedOrDistributed::Distributed, "{seed}");
    }
    let case = Case {
        uneven_coupling: 0.1,
        ..CLEAN
    };
    let n = draws(10);
    let named = (0..n)
        .filter(|&seed| {
            with_input(&EVEN, &case, seed, |input| {
                decide(input).unwrap().verdict() == LumpedOrDistributed::Distributed
            })
        })
        .count() as u64;
    assert!(named <= at_most(UNEVEN_BELOW, n), "{named} of {n}");
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn a_break_is_found_and_placed_from_voltages_and_from_curvatures() {
    for voltages in [true, false] {
        let (mut found, mut inside) = (0, 0);
        let n = draws(3);
        for seed in 0..n {
            let case = Case {
                contact_break: Some((1.3, 3.0)),
                noise: 0.005,
                autocorrelation: 0.3,
                voltages,
                ..CLEAN
            };
            let fit = with_input(&CNAF, &case, seed, |input| {
                fit_distributed(input, Steps::TwoStep).unwrap()
            });
            let Some(place) = fit.parameter("contact-break.place_mm") else {
                continue;
            };
            found += u64::from(fit.issues.iter().any(|issue| issue.code == "contact-break"));
            let (low, high) = place.low_95.zip(place.high_95).unwrap_or((f64::NAN, f64::NAN));
            inside += u64::from(low <= 13.0 && 13.0 <= high);
        }
        eprintln!("voltages {voltages}: found in {found} of {n}, place held in {inside}");
        assert_eq!(found, n, "voltages {voltages}");
        assert!(
            inside * 100 >= 80 * n - 100,
            "voltages {voltages}: {inside} of {n}"
        );
    }
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn clean_strips_break_no_more_often_than_stated() {
    for (model, autocorrelation) in [(&CNAF, 0.0), (&CNAF, 0.6), (&EVEN, 0.6)] {
        for voltages in [false, true] {
            let case = Case {
                autocorrelation,
                neighbours: 0.5,
                voltages,
                ..CLEAN
            };
            let n = draws(4);
            let broken = (0..n)
                .filter(|&seed| {
                    with_input(model, &case, seed, |input| {
                        let fit = fit_distributed(input, Steps::TwoStep).unwrap();
                        fit.parameter("contact-break.place_mm").is_some()
                    })
                })
                .count() as u64;
            eprintln!("correlation {autocorrelation}, voltages {voltages}: {broken} of {n}");
            assert!(
                broken <= at_most(0.02, n),
                "{autocorrelation} {voltages}: {broken} of {n}"
            );
        }
    }
}

#[test]
fn one_place_leaves_it_to_the_criterion_and_says_so() {
    let told = |given: Option<f64>, keep: usize| {
        with_input(&CNAF, &CLEAN, 1, |input| {
            let mut channels = input.channels.to_vec();
            channels.drain(keep..PLACES);
            let mut one = DistributedInput {
                channels: &channels,
                ..*input
            };
            one.strip.electrode_resistance_ohm_per_sq = given;
            decide(&one).unwrap()
        })
    };
    let decided = told(Some(2.5), 1);
    assert_eq!(decided.verdict(), LumpedOrDistributed::ByCriterion);
    assert!(
        decided.issue().message.contains("of its first motion"),
        "{:?}",
        decided.issue()
    );
    // R_e L^2 (1/R_c + 1/R_ss) = 5.22: what `model::distributed::criterion` says of it.
    let expected = CNAF.lumped_error().first_displacement;
    let found = decided.lumped_error.unwrap();
    assert!(
        found.low_first <= expected && expected <= found.high_first,
        "{found:?} {expected}"
    );
}

/// A probe whose stated error is 15 % reads off by this many of them; a current tells R_e as well.
fn with_probe<R>(case: &Case, off: f64, stated: bool, seed: u64, then: impl Fn(&Fit) -> R) -> R {
    const ERROR: f64 = 0.15;
    with_input(&CNAF, case, seed, |input| {
        let mut probed = *input;
        let read = 0.5 * CNAF.electrode_resistance_ohm_per_cm * (ERROR * off).exp();
        probed.strip.electrode_resistance_ohm_per_sq = Some(read);
        probed.strip.electrode_resistance_error_ohm_per_sq = stated.then_some(ERROR * read);
        then(&fit_distributed(&probed, Steps::TwoStep).unwrap())
    })
}

fn says(fit: &Fit, code: &str) -> bool {
    fit.issues.iter().any(|issue| issue.code == code)
}

#[test]
fn a_probe_that_reads_wrong_is_no_crack() {
    let case = Case {
        noise: 0.005,
        ..CLEAN
    };
    for (off, stated) in [(-1.6, true), (1.6, true), (1.6, false)] {
        with_probe(&case, off, stated, 3, |fit| {
            assert!(!says(fit, "contact-break"), "{off} {stated}: {:?}", fit.issues);
            // Off by 1.6 of its errors is what probes do; off without an error contradicts the readings.
            assert_eq!(says(fit, "probe-contradicted"), !stated, "{:?}", fit.issues);
            if stated {
                let found = fit.parameter("re_ohm_per_sq").unwrap();
                let truth = 0.5 * CNAF.electrode_resistance_ohm_per_cm;
                assert!((found.value.unwrap() / truth - 1.0).abs() < 0.1, "{found:?}");
            }
        });
    }
    with_probe(&case, 6.0, true, 3, |fit| {
        assert!(
            says(fit, "probe-contradicted") && !says(fit, "contact-break"),
            "{:?}",
            fit.issues
        );
    });
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn with_a_probe_intervals_hold_and_breaks_are_told_as_often_as_stated() {
    let truth = 0.5 * CNAF.electrode_resistance_ohm_per_cm;
    let n = 20 * draws(1);
    let (mut held, mut cracked, mut contradicted) = (0, 0, 0);
    for seed in 0..n {
        let mut random = ChaCha8Rng::seed_from_u64(7000 + seed);
        let off: f64 = StandardNormal.sample(&mut random);
        let case = Case {
            noise: 0.005,
            autocorrelation: 0.4,
            ..CLEAN
        };
        let fit = with_probe(&case, off, true, seed, Fit::clone);
        let found = fit.parameter("re_ohm_per_sq").unwrap();
        held += u64::from(found.low_95.unwrap() <= truth && truth <= found.high_95.unwrap());
        cracked += u64::from(says(&fit, "contact-break"));
        contradicted += u64::from(says(&fit, "probe-contradicted"));
    }
    eprintln!("held {held}, cracked {cracked}, contradicted {contradicted} of {n}");
    assert!(n - held <= at_most(0.05, n), "{held} of {n}");
    assert!(cracked <= at_most(0.01, n) && contradicted <= at_most(0.01, n));
    // A probe takes nothing from a break that is there.
    for stated in [true, false] {
        let case = Case {
            contact_break: Some((1.3, 3.0)),
            noise: 0.005,
            ..CLEAN
        };
        let fit = with_probe(&case, 0.0, stated, 1, Fit::clone);
        assert!(says(&fit, "contact-break"), "{stated}: {:?}", fit.issues);
    }
}
