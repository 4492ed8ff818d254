//! Glitches go, and nothing else does.

use super::*;
use std::f64::consts::PI;

use ieap_domain::testing::clocks::LabClock;
use ieap_domain::{Edge, Level, Segment};
use ieap_model::{Branch, LumpedModel};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// A strip whose branches charge within those times, s.
fn strip([fast_s, slow_s]: [f64; 2]) -> LumpedModel {
    let branch = |tau_s: f64| Branch {
        resistance_ohm_cm2: 500.0,
        capacitance_f_per_cm2: tau_s / 500.0,
    };
    LumpedModel {
        branches: vec![branch(fast_s), branch(slow_s)],
        steady_state_resistance_ohm_cm2: 5000.0,
        charge_to_curvature_per_c_cm: 10.0,
        relaxation_rate_per_s: 0.3 / slow_s,
    }
}

/// Levels held for a time each, from the middle of a reading or from zero on.
fn drive(levels_v: &[f64], held_s: f64) -> Drive {
    let segment = |(k, level_v): (usize, &f64)| Segment::at(k as f64 * held_s, Level::Voltage(*level_v));
    Drive {
        baseline_v: 0.0,
        segments: levels_v.iter().enumerate().map(segment).collect(),
    }
}

/// Current and curvature, noise in parts of the largest value.
fn run(
    model: &LumpedModel,
    drive: &Drive,
    times: [&[f64]; 2],
    noise: f64,
    random: &mut ChaCha8Rng,
) -> Vec<Channel> {
    let mut channel = |quantity, time_s: &[f64], exact: Vec<f64>| {
        let sd = noise * peak(&exact);
        let values = exact.iter().map(|value| {
            let own: f64 = StandardNormal.sample(random);
            value + sd * own
        });
        Channel::new(quantity, time_s.into(), values.collect())
    };
    vec![
        channel(Quantity::Current, times[0], model.current_a(drive, 1.0, times[0])),
        channel(
            Quantity::Curvature,
            times[1],
            model.curvature_per_cm(drive, 1.0, times[1]),
        ),
    ]
}

fn count(cleaned: &Cleaned) -> usize {
    cleaned.left_out_s.iter().map(Vec::len).sum()
}

/// Readings, and how many of them are left out, of runs without a glitch on all clocks.
fn lost(noise: f64, seeds: std::ops::Range<u64>) -> (usize, usize) {
    let (mut readings, mut lost) = (0, 0);
    for seed in seeds {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let count_of = 10.0_f64.powf(random.random_range(0.5..3.3));
        let lasting_s = 600.0;
        let every_s = lasting_s / count_of;
        // Branches from a part of a reading to the whole record.
        let taus = [0.1 * every_s, lasting_s].map(f64::ln);
        let tau = |random: &mut ChaCha8Rng| random.random_range(taus[0]..taus[1]).exp();
        let model = strip([tau(&mut random), tau(&mut random)]);
        let levels: &[f64] = [&[2.0][..], &[2.0, 0.0], &[2.0, -2.0, 1.0, 0.0, 2.0]][seed as usize % 3];
        let stated = drive(levels, lasting_s / levels.len() as f64);
        for (k, (clock, _)) in LabClock::ALL.into_iter().enumerate() {
            let times = clock.times(k, &stated, lasting_s, every_s, || random.random());
            let bending_s: Vec<f64> = times.bending_s.clone();
            let mut channels = run(
                &model,
                &stated,
                [&times.current_s, &bending_s],
                noise,
                &mut random,
            );
            let shown = bending_s.iter().map(|t| t + times.bending_ahead_s);
            channels[1].time_s = shown.collect();
            for drive in [stated.clone(), stated.as_seen(&times.current_s)] {
                readings += channels.iter().map(Channel::len).sum::<usize>();
                lost += count(&without_outliers(&channels, &drive));
            }
        }
    }
    (readings, lost)
}

#[test]
fn clean_runs_lose_no_reading() {
    let (readings, none) = lost(0.0, 0..60);
    assert!(
        readings > 100_000 && none == 0,
        "{none} of {readings} without noise"
    );
    for noise in [1e-5, 1e-3, 0.03] {
        let (readings, few) = lost(noise, 60..120);
        assert!(few * 20_000 <= readings, "{few} of {readings}, noise {noise}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn noiseless_courses_lose_nothing(
        readings in 3..2000_usize,
        fast in -1.0..3.0_f64,
        slow in -1.0..3.0_f64,
        digits in prop::option::of(3..8_i32),
        offset in -0.5..0.5_f64,
    ) {
        let time_s: Vec<f64> = (0..readings).map(|k| k as f64 - 20.0 + offset).collect();
        let model = strip([10.0_f64.powf(fast), 10.0_f64.powf(slow)]);
        let drive = drive(&[1.5, -1.0], 0.5 * readings as f64);
        let mut channels = run(&model, &drive, [&time_s, &time_s], 0.0, &mut ChaCha8Rng::seed_from_u64(1));
        if let Some(digits) = digits {
            for channel in &mut channels {
                let digit = peak(&channel.values) * 10.0_f64.powi(-digits);
                channel.values = channel.values.iter().map(|v| (v / digit).round() * digit).collect();
            }
        }
        prop_assert_eq!(count(&without_outliers(&channels, &drive)), 0);
    }
}

/// A decay of 501 readings with noise, and glitches at these places.
fn glitched(places: &[usize]) -> (Channel, Drive) {
    let time_s: Vec<f64> = (0..501).map(|k| 0.25 * f64::from(k) - 5.0).collect();
    let drive = Drive::step(2.0);
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let mut channel = run(&strip([2.0, 20.0]), &drive, [&time_s, &time_s], 1e-4, &mut random).swap_remove(0);
    let mut values = channel.values.to_vec();
    places.iter().for_each(|&k| values[k] = 0.05);
    channel.values = values.into();
    (channel, drive)
}

#[test]
fn glitches_go_and_are_told_with_their_times() {
    let (mut channel, drive) = glitched(&[70, 300]);
    channel.excluded = [5, 80].into();
    let cleaned = without_outliers(&[channel], &drive);
    assert_eq!(cleaned.left_out_s, vec![vec![12.5, 70.0]]);
    assert_eq!(cleaned.channels[0].excluded[..], [5, 70, 80, 300]);
    let issues = cleaned.issues_of_whole();
    assert_eq!(issues.len(), 1);
    assert_eq!(issues[0].code, "outliers-left-out");
    assert_eq!(
        issues[0].message,
        "2 readings of the current stand far off their neighbours and are left out: 12.5, 70 s"
    );
    // What was cleaned has no others.
    assert_eq!(count(&without_outliers(&cleaned.channels, &drive)), 0);
}

#[test]
fn what_may_answer_to_an_edge_stays() {
    for place in [18, 19, 20, 21, 22, 23] {
        let (channel, drive) = glitched(&[place]);
        assert_eq!(count(&without_outliers(&[channel], &drive)), 0, "{place}");
    }
    // Of an edge that lies anywhere in a time nothing in it is judged.
    let (channel, mut drive) = glitched(&[60]);
    assert_eq!(
        count(&without_outliers(std::slice::from_ref(&channel), &drive)),
        1
    );
    drive.segments[0].edge = Edge::between(0.0, 10.0);
    assert_eq!(count(&without_outliers(&[channel], &drive)), 0);
}

#[test]
fn smaller_glitches_are_seen_behind_larger_ones() {
    let (mut channel, drive) = glitched(&[200]);
    let mut values = channel.values.to_vec();
    (values[200], values[300], values[400]) = (9.9e37, -4e3, 0.004);
    channel.values = values.into();
    assert_eq!(
        without_outliers(&[channel], &drive).left_out_s,
        vec![vec![45.0, 70.0, 95.0]]
    );
}

#[test]
fn what_no_model_is_fitted_to_and_a_moving_voltage_stay() {
    let (channel, drive) = glitched(&[70]);
    let voltage = Channel {
        quantity: Quantity::Voltage,
        ..channel.clone()
    };
    assert_eq!(count(&without_outliers(&[voltage], &drive)), 0);
    let volts: Vec<f64> = channel
        .time_s
        .iter()
        .map(|t| (2.0 * PI * t / 25.0).sin())
        .collect();
    let moving = Drive::staircase(&channel.time_s, &volts, 0.0);
    assert!(moving.moves());
    assert_eq!(count(&without_outliers(&[channel], &moving)), 0);
}

#[test]
fn times_are_told_to_six_digits_and_many_are_counted() {
    assert_eq!(
        left_out_in_words("current", &[0.1 + 0.2]),
        "1 reading of the current stands far off its neighbours and is left out: 0.3 s"
    );
    let many: Vec<f64> = (1..9).map(f64::from).collect();
    assert!(left_out_in_words("curvature", &many).ends_with("are left out: 1, 2, 3, 4, 5 s and 3 more"));
}
