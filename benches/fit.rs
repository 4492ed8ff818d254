//! Time of one fit with uncertainties: 3,600 and 36,000 samples of current and curvature, by each method, and of
//! merely reading them.

use ieap::domain::testing::branch;
use std::hint::black_box;
use std::sync::Arc;

use criterion::{Criterion, criterion_group, criterion_main};
use ieap::domain::{Channel, Drive, Edge, Level, Quantity, Segment};
use ieap::fit::{FitInput, FitOptions, fit_run};
use ieap::model::LumpedModel;
use ieap::numerics::sums;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// CNaf in air at 2 V (thesis, table 5) for an hour, with noise of 1 % of the peak.
fn run(samples: usize) -> Vec<Channel> {
    let model = LumpedModel {
        branches: vec![branch(521.4, 0.098), branch(2629.9, 0.13)],
        steady_state_resistance_ohm_cm2: 5660.0,
        charge_to_curvature_per_c_cm: 13.88,
        relaxation_rate_per_s: 3.8e-4,
    };
    let time_s: Arc<[f64]> = (0..samples).map(|k| 3600.0 * k as f64 / samples as f64).collect();
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut channel = |quantity, exact: Vec<f64>| {
        let peak = exact.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let noisy = exact.into_iter().map(|v| {
            let noise: f64 = StandardNormal.sample(&mut rng);
            v + 0.01 * peak * noise
        });
        Channel::new(quantity, time_s.clone(), noisy.collect())
    };
    let drive = Drive::step(2.0);
    vec![
        channel(Quantity::Current, model.current_a(&drive, 0.1, &time_s)),
        channel(Quantity::Curvature, model.curvature_per_cm(&drive, 0.1, &time_s)),
    ]
}

fn fits(criterion: &mut Criterion) {
    let drive = Drive::step(2.0);
    for samples in [3_600, 36_000] {
        let channels = run(samples);
        let input = FitInput {
            channels: &channels,
            drive: &drive,
            area_cm2: 0.1,
        };
        criterion.bench_function(&format!("fit {samples} samples x 2 channels"), |bencher| {
            bencher.iter(|| fit_run(black_box(&input), &FitOptions::default()));
        });
    }
}

/// The same where the step lies between two readings, as of every record that is not told of it: where it was is fitted, too.
fn open_edges(criterion: &mut Criterion) {
    let drive = Drive {
        segments: vec![Segment {
            edge: Edge::between(-1.0, 0.0),
            level: Level::Voltage(2.0),
        }],
        ..Drive::step(2.0)
    };
    for samples in [3_600, 36_000] {
        let channels = run(samples);
        let input = FitInput {
            channels: &channels,
            drive: &drive,
            area_cm2: 0.1,
        };
        criterion.bench_function(
            &format!("fit {samples} samples x 2 channels, step between readings"),
            |bencher| {
                bencher.iter(|| fit_run(black_box(&input), &FitOptions::default()));
            },
        );
    }
}

/// The thesis's method on the same run.
fn evolution(criterion: &mut Criterion) {
    let drive = Drive::step(2.0);
    let channels = run(3_600);
    let input = FitInput {
        channels: &channels,
        drive: &drive,
        area_cm2: 0.1,
    };
    let Ok(options) = FitOptions::default().with_method("differential-evolution") else {
        return;
    };
    criterion.bench_function(
        "fit 3600 samples x 2 channels, differential evolution",
        |bencher| {
            bencher.iter(|| fit_run(black_box(&input), &options));
        },
    );
}

/// What no fit can be faster than: every time and value is read once and added up.
fn reading_once(criterion: &mut Criterion) {
    for samples in [3_600, 36_000] {
        let channels = run(samples);
        criterion.bench_function(&format!("read {samples} samples x 2 channels once"), |bencher| {
            bencher.iter(|| {
                let columns = black_box(&channels)
                    .iter()
                    .flat_map(|channel| [&channel.time_s, &channel.values]);
                columns.map(|column| sums::sum(column)).sum::<f64>()
            });
        });
    }
}

criterion_group!(benches, fits, open_edges, evolution, reading_once);
criterion_main!(benches);
