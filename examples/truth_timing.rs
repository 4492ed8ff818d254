//! Time that the truth simulator takes for a run with each effect of its catalogue, alone and in a pulse train.
//!
//! `cargo run --release --example truth_timing`: 650 readings of two channels over 600 s, wall time in milliseconds.

use ieap::domain::testing::branch;
use std::time::Instant;

use ieap::domain::{Drive, Level, Segment};
use ieap::model::Branch;
use ieap::truth::catalogue::{KNOWN, KnownEffect};
use ieap::truth::{HiddenEffect, Truth, simulate};

fn truth(effects: Vec<HiddenEffect>) -> Truth {
    Truth {
        branches: vec![branch(521.4, 0.098), branch(1000.0, 0.13)],
        steady_state_resistance_ohm_cm2: 5660.0,
        charge_to_curvature_per_c_cm: 13.88,
        relaxation_rate_per_s: 4e-3,
        area_cm2: 0.1,
        length_cm: Some(0.5),
        width_cm: Some(0.2),
        effects,
    }
}

fn hidden(effect: &KnownEffect, variant: Option<&str>) -> HiddenEffect {
    let parameters = effect.parameters.iter().map(|p| (p.key.to_owned(), p.example));
    HiddenEffect {
        id: effect.id.to_owned(),
        variant: variant.map(str::to_owned),
        parameters: parameters.collect(),
    }
}

fn pulses() -> Drive {
    let segments = (0..30).map(|k| {
        Segment::at(
            20.0 * f64::from(k),
            Level::Voltage(if k % 2 == 0 { 2.0 } else { 0.0 }),
        )
    });
    Drive {
        baseline_v: 0.0,
        segments: segments.collect(),
    }
}

fn milliseconds(truth: &Truth, drive: &Drive) -> f64 {
    let early = (0..120).map(|k| 0.25 * f64::from(k));
    let time_s: Vec<f64> = early.chain((30..560).map(|k| 1.02 * f64::from(k))).collect();
    let times = (0..5).map(|_| {
        let begun = Instant::now();
        let found = simulate(truth, drive, &time_s, &time_s, 0);
        assert!(found.is_ok(), "{found:?}");
        begun.elapsed().as_secs_f64() * 1e3
    });
    times.fold(f64::INFINITY, f64::min)
}

fn main() {
    println!("{:42} {:>8} {:>8}", "effect", "step", "pulses");
    let line = |name: &str, truth: &Truth| {
        let (step, train) = (
            milliseconds(truth, &Drive::step(2.0)),
            milliseconds(truth, &pulses()),
        );
        println!("{name:42} {step:8.2} {train:8.2}");
    };
    line("none", &truth(Vec::new()));
    let mut fast = truth(Vec::new());
    fast.branches[0] = Branch {
        resistance_ohm_cm2: 1.0,
        capacitance_f_per_cm2: 0.005,
    };
    line("none, a branch of 5 ms", &fast);
    for effect in KNOWN {
        let variants: Vec<Option<&str>> = match effect.variants {
            [] => vec![None],
            variants => variants.iter().copied().map(Some).collect(),
        };
        for variant in variants {
            let name = format!("{} {}", effect.id, variant.unwrap_or(""));
            line(&name, &truth(vec![hidden(effect, variant)]));
        }
    }
}
