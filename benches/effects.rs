//! Time of one simulation of a run with effects: 700 readings of current and of curvature.

use ieap::domain::testing::branch;
use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use ieap::domain::{Drive, Level, Segment};
use ieap::model::LumpedModel;
use ieap::model::effects::{Applied, effect};
use ieap::model::extended::{ExtendedModel, RunContext};

const END_S: f64 = 300.0;

fn base() -> LumpedModel {
    LumpedModel {
        branches: vec![branch(3.0, 0.1), branch(15.0, 0.6)],
        steady_state_resistance_ohm_cm2: 300.0,
        charge_to_curvature_per_c_cm: 1.2,
        relaxation_rate_per_s: 0.012,
    }
}

fn pulses(edges: u32) -> Drive {
    let level = |k: u32| Level::Voltage(if k.is_multiple_of(2) { 2.0 } else { 0.0 });
    let segment = |k: u32| Segment::at(END_S * f64::from(k) / f64::from(edges), level(k));
    Drive {
        baseline_v: 0.0,
        segments: (0..edges).map(segment).collect(),
    }
}

fn simulations(criterion: &mut Criterion) {
    let time_s: Vec<f64> = (0..700).map(|k| END_S * f64::from(k) / 700.0).collect();
    let effects: [(&str, &[f64]); 5] = [
        ("base", &[]),
        ("softening", &[0.2]),
        ("dispersion", &[0.3]),
        ("mechanical-lag", &[0.1]),
        ("joule-heating", &[0.1, 20.0]),
    ];
    for (name, drive) in [("step", Drive::step(2.0)), ("30 edges", pulses(30))] {
        let run = RunContext {
            index: 0,
            drive: &drive,
            area_cm2: 0.1,
            length_cm: Some(0.5),
            duration_s: END_S,
            resolved_s: None,
            tags: &[],
            channels: &[],
        };
        for (id, parameters) in effects {
            let applied = effect(id).map(|effect| Applied {
                effect,
                variant: 0,
                parameters: parameters.to_vec(),
            });
            let model = ExtendedModel {
                base: base(),
                effects: applied.into_iter().collect(),
            };
            criterion.bench_function(&format!("700 x 2 readings, {name}, {id}"), |bencher| {
                bencher.iter(|| model.responses(black_box(&run), &time_s, &time_s));
            });
        }
    }
}

criterion_group!(benches, simulations);
criterion_main!(benches);
