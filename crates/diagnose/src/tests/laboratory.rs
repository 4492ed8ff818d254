//! Groups in which nothing is wrong, measured as laboratories do: runs scatter, clocks run beside the edges, noise is slow.

use super::varies::{diagnosed, differing};
use super::*;
use ieap_domain::ParameterScatter;
use ieap_model::extended::ExtendedModel;

/// Four drives twice, each of a sample whose parameters are off by that part, one standard deviation.
fn scattering(part: f64, seed: u64) -> Vec<Runs> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut off = |value: f64| {
        let unit: f64 = StandardNormal.sample(&mut random);
        value * (part * unit).exp()
    };
    let mut own = || {
        let branches = [30.0, 0.03, 120.0, 0.15].map(&mut off);
        sample(branches, off(3000.0), off(20.0), off(0.01))
    };
    let twice = FOUR.iter().chain(FOUR);
    let runs: Vec<(LumpedModel, Levels)> = twice.map(|drive| (own(), *drive)).collect();
    differing(&runs, seed)
}

#[test]
fn scatter_from_run_to_run_is_noise_and_is_told() {
    let found = diagnosed(&scattering(0.03, 5));
    assert!(found.scatter_is_noise, "{:?} {}", found.verdict, found.sentence);
    assert!(
        !found.verdict.is_misfit(),
        "{:?} {}",
        found.verdict,
        found.sentence
    );
    let holds = |own: &&ParameterScatter| own.low_95_percent <= 3.0 && 3.0 <= own.high_95_percent;
    assert_eq!(found.scatter.len(), 7);
    assert!(
        found.scatter.iter().filter(holds).count() >= 6,
        "{:?}",
        found.scatter
    );
    assert!(
        found.scatter.iter().any(|own| own.low_95_percent > 1.0),
        "{:?}",
        found.scatter
    );
}

#[test]
fn runs_that_agree_have_no_scatter_taken_for_noise() {
    let found = diagnosed(&scattering(0.0, 5));
    assert!(!found.scatter_is_noise);
    assert!(
        !found.verdict.is_misfit(),
        "{:?} {}",
        found.verdict,
        found.sentence
    );
    assert!(
        found.scatter.iter().all(|own| own.low_95_percent < 0.5),
        "{:?}",
        found.scatter
    );
}

#[test]
fn scatter_is_looked_for_once_and_in_repeats_alone() {
    let model = ExtendedModel {
        base: base(),
        effects: Vec::new(),
    };
    let (four, repeated) = (
        Runs::with(None, FOUR, 3),
        Runs::with(None, &[STEP, HALF, STEP], 3),
    );
    assert!(
        group::RunGroup::new(&four.inputs())
            .with_scatter(&model)
            .is_none()
    );
    let inputs = repeated.inputs();
    let beside = group::RunGroup::new(&inputs).with_scatter(&model).unwrap();
    assert!(beside.scatter().unwrap().taken.is_empty());
    assert!(beside.with_scatter(&model).is_none());
}

const STEP_BESIDE: Levels = &[(0.35, 2.0)];
const HALF_BESIDE: Levels = &[(0.6, 1.0)];
const DISCHARGED_BESIDE: Levels = &[(0.2, 2.0), (300.7, 0.0)];

impl Runs {
    /// With the drives as a voltmeter tells them that is read every second.
    fn with_edges_read(mut self) -> Runs {
        let time_s: Vec<f64> = (0..=600).map(f64::from).collect();
        self.drives
            .iter_mut()
            .for_each(|drive| *drive = drive.as_seen(&time_s));
        self
    }
}

#[test]
fn a_clock_beside_the_edges_is_no_misfit() {
    let drives = [STEP_BESIDE, HALF_BESIDE, DISCHARGED_BESIDE];
    for seed in [11, 12] {
        let found = Runs::with(None, &drives, seed).with_edges_read().diagnosed();
        assert!(
            !found.verdict.is_misfit(),
            "{:?} {}",
            found.verdict,
            found.sentence
        );
    }
}

/// Noise as large as the readings' own, with a correlation that dies away in 30 s.
#[test]
fn red_noise_is_no_misfit() {
    for seed in [21, 22] {
        let mut runs = Runs::with(None, FOUR, seed);
        let mut random = ChaCha8Rng::seed_from_u64(1000 + seed);
        for channel in runs.channels.iter_mut().flatten() {
            let peak = channel.values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
            let keeps = (-1.0_f64 / 30.0).exp();
            let mut slow = 0.0;
            let mut next = || -> f64 {
                let fresh: f64 = StandardNormal.sample(&mut random);
                slow = keeps * slow + (1.0 - keeps * keeps).sqrt() * fresh;
                slow
            };
            channel.values = channel
                .values
                .iter()
                .map(|v| v + NOISE[0] * peak * next())
                .collect();
        }
        let found = runs.diagnosed();
        assert!(
            !found.verdict.is_misfit(),
            "{:?} {}",
            found.verdict,
            found.sentence
        );
    }
}
