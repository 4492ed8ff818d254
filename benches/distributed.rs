//! Time of the distributed model: 100 positions x 1,000 times in closed form, and the ladder through a drive.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{Criterion, criterion_group, criterion_main};
use ieap::domain::{Channel, Drive, Level, Quantity, Segment};
use ieap::fit::Steps;
use ieap::fit::distributed::{DistributedInput, Strip, fit_distributed};
use ieap::model::DistributedModel;
use ieap::model::coupling::CurvaturePerLineCharge;
use ieap::model::distributed::Ladder;

/// PtNaf of thesis table 3, a strip of 45 mm by 3 mm: its electrodes resist most.
const PTNAF: DistributedModel = DistributedModel {
    electrode_resistance_ohm_per_cm: 15.0,
    branch_resistance_ohm_cm: 10.0,
    capacitance_f_per_cm: 0.00591,
    steady_state_resistance_ohm_cm: 143.0,
    length_cm: 4.5,
    coupling: CurvaturePerLineCharge(132.75),
    relaxation_rate_per_s: 0.29,
};

fn distributed(criterion: &mut Criterion) {
    let s: Vec<f64> = (0..100).map(|k| PTNAF.length_cm * f64::from(k) / 99.0).collect();
    let t: Vec<f64> = (0..1000).map(|k| 0.01 * f64::from(k)).collect();
    criterion.bench_function("voltage, 100 positions x 1,000 times", |bencher| {
        bencher.iter(|| PTNAF.voltage_v(1.5, black_box(&s), &t));
    });
    criterion.bench_function("charge, 100 positions x 1,000 times", |bencher| {
        bencher.iter(|| PTNAF.charge_c_per_cm(1.5, black_box(&s), &t));
    });
    criterion.bench_function("curvature, 100 positions x 1,000 times", |bencher| {
        bencher.iter(|| PTNAF.curvature_per_cm(1.5, black_box(&s), &t));
    });
    criterion.bench_function("shapes of 100 links, 1,000 times", |bencher| {
        bencher.iter(|| PTNAF.shapes(1.5, 100, black_box(&t)));
    });
    let segment = |start_s, level| Segment::at(start_s, level);
    let drive = Drive {
        baseline_v: 0.0,
        segments: vec![
            segment(0.0, Level::Voltage(1.5)),
            segment(3.0, Level::Voltage(-1.0)),
            segment(6.0, Level::OpenCircuit),
        ],
    };
    criterion.bench_function("ladder of 100 cells, 1,000 times, three segments", |bencher| {
        bencher.iter(|| {
            let ladder = Ladder::new(black_box(&PTNAF), 100);
            ladder.map(|ladder| ladder.respond(&drive, &t, 1e-8))
        });
    });
}

/// The current and curvatures at 50 places and 500 times.
fn fit(criterion: &mut Criterion) {
    let times: Arc<[f64]> = (0..500).map(|k| 20.0 * (f64::from(k) / 499.0).powi(2)).collect();
    // A thousandth of disturbance that needs no seed.
    let disturbed = |k: usize, value: f64| value * (1.0 + 1e-3 * ((k * 7919 % 1009) as f64 / 504.5 - 1.0));
    let current = PTNAF.clamp_current_a(1.5, &times);
    let current = current
        .iter()
        .enumerate()
        .map(|(k, i)| disturbed(k, *i))
        .collect();
    let mut channels = vec![Channel::new(Quantity::Current, times.clone(), current)];
    for place in 0..50 {
        let s = PTNAF.length_cm * (f64::from(place) + 0.5) / 50.0;
        let bent = PTNAF.curvature_per_cm(1.5, &[s], &times).values;
        let values = bent
            .iter()
            .enumerate()
            .map(|(k, v)| disturbed(k + 31 * place as usize, *v));
        let mut channel = Channel::new(Quantity::Curvature, times.clone(), values.collect());
        channel.position_mm = Some(10.0 * s);
        channels.push(channel);
    }
    let drive = Drive::step(1.5);
    let input = DistributedInput {
        channels: &channels,
        drive: &drive,
        strip: Strip {
            length_cm: PTNAF.length_cm,
            width_cm: 0.3,
            electrode_resistance_ohm_per_sq: None,
            electrode_resistance_error_ohm_per_sq: None,
        },
    };
    criterion.bench_function(
        "distributed fit, 50 positions x 500 times and a current",
        |bencher| {
            bencher.iter(|| fit_distributed(black_box(&input), Steps::TwoStep));
        },
    );
}

criterion_group!(benches, distributed, fit);
criterion_main!(benches);
