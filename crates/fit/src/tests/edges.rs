//! Edges of the drive that lie between two readings, in groups and of bending alone.

use super::*;
use ieap_domain::testing::drive;
use rand::RngExt;

/// Readings every second whose clock begins anywhere within a second, and the drive as these tell it.
fn beside(drive: &Drive, seed: u64) -> (Arc<[f64]>, Drive) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let first_s = -20.0 + rng.random_range(0.02..0.98);
    let time_s: Arc<[f64]> = (0..620).map(|k| first_s + f64::from(k)).collect();
    let seen = drive.as_seen(&time_s);
    (time_s, seen)
}

/// A step, another one, a discharge, a reversal, and pulses.
fn drives() -> [Drive; 5] {
    let pulses: Vec<(f64, Option<f64>)> = (0..20)
        .map(|k| (20.0 * f64::from(k), Some(if k % 2 == 0 { 2.0 } else { 0.0 })))
        .collect();
    [
        Drive::step(2.0),
        Drive::step(-1.0),
        drive(2.0, &[(0.0, Some(0.0))]),
        drive(0.0, &[(0.0, Some(2.0)), (250.0, Some(-1.0))]),
        drive(0.0, &pulses),
    ]
}

/// How many of the intervals of `fit` hold the truth, and how many there are.
fn held(fit: &Fit, truth: &[(&str, f64)]) -> (usize, usize) {
    let intervals = truth.iter().filter_map(|(key, expected)| {
        let estimate = fit.parameter(key)?;
        let (low, high) = estimate.low_95.zip(estimate.high_95)?;
        Some(low <= *expected && *expected <= high)
    });
    let intervals: Vec<bool> = intervals.collect();
    (intervals.iter().filter(|holds| **holds).count(), intervals.len())
}

/// Five runs of a branch that charges within a reading or two, each with a clock of its own. Taken at the readings that saw
/// them, the edges leave 2 of 36 intervals that hold, and runs of one sample are told to differ.
#[test]
fn a_group_finds_edges_between_readings_with_what_its_runs_share() {
    let model = model(&CPVF_AIR_1V);
    let (mut inside, mut of) = (0, 0);
    for seed in 0..counted(4, 40) {
        let drives = drives();
        let each = (100 * seed..).zip(&drives);
        let seen: Vec<_> = each.map(|(seed, drive)| beside(drive, seed)).collect();
        let runs = (7000 + 100 * seed..).zip(drives.iter().zip(&seen));
        let runs: Vec<Vec<Channel>> = runs
            .map(|(seed, (drive, (time_s, _)))| channels(&model, drive, time_s, 0.005, 0.0, seed))
            .collect();
        let inputs: Vec<FitInput> = (runs.iter().zip(&seen))
            .map(|(channels, (_, drive))| FitInput {
                channels,
                drive,
                area_cm2: AREA_CM2,
            })
            .collect();
        let group = fit_group(&inputs, &GroupOptions::default()).unwrap();
        let (holding, all) = held(&group.runs[0], &truth(&model));
        (inside, of) = (inside + holding, of + all);
        let sharing = group.sharing.unwrap();
        assert!(sharing.p > 1e-3, "{sharing:?}");
        assert_eq!(codes(&group.runs[0], "edges-between-readings"), 1);
    }
    // The nine of a group lean on each other: the spread is that of a third as many.
    let (inside, of) = (inside as f64, of as f64);
    assert!(
        of >= 36.0 && inside >= 0.95 * of - 2.5 * (0.05 * 0.95 * of * 3.0).sqrt(),
        "{inside} of {of}"
    );
}

/// What the edge leaves open is in the intervals of a curvature without a current, too.
#[test]
fn bending_alone_states_what_an_edge_between_readings_leaves_open() {
    let model = model(&CPVF_AIR_1V);
    let told = bending::told(&model);
    let (mut inside, mut of) = (0, 0);
    for seed in 0..counted(12, 100) {
        let drive = Drive::step(2.0);
        let (time_s, seen) = beside(&drive, seed);
        let run = channels(&model, &drive, &time_s, 0.0005, 0.0, 9000 + seed).split_off(1);
        let fit = fitted(&run, &seen);
        assert_eq!(codes(&fit, "edges-between-readings"), 1, "{seed}");
        let (holding, all) = held(&fit, &told);
        (inside, of) = (inside + holding, of + all);
    }
    assert!(10 * inside >= 9 * of && of > 50, "{inside} of {of}");
}

fn codes(fit: &Fit, code: &str) -> usize {
    fit.issues.iter().filter(|issue| issue.code == code).count()
}
