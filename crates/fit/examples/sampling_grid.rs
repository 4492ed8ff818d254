//! Do stated intervals hold however a branch compares with the readings, and wherever these lie beside the edges?
//!
//! `cargo run --release -p ieap-fit --example sampling_grid -- 100 [first seed]`: for time constants of the fast branch from a
//! tenth to a hundred intervals, with readings on the edges, between them and from the edge on, under a step, a step and a
//! discharge, and pulses, so many runs each; a Markdown table of how many 95 % intervals and bounds hold the truth.

use std::collections::BTreeMap;
use std::sync::Arc;

use ieap_domain::{Channel, Drive, Estimate, Level, Quantity, Segment};
use ieap_fit::{FitInput, FitOptions, fit_run};
use ieap_model::{Branch, LumpedModel};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

const AREA_CM2: f64 = 0.1;
/// Readings of a record from the first edge on.
const READINGS: usize = 600;
/// Readings at rest before it.
const AT_REST: usize = 20;
/// Noise in parts of the largest signal.
const NOISE: f64 = 0.003;
/// Time constants of the fast branch in intervals of the readings.
const RATIOS: [f64; 7] = [0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0];

/// Where readings lie.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Beside {
    /// On the edges, which are stated; a reading at the instant of an edge is of the side behind it ...
    OnAfter,
    /// ... or of the side before it.
    OnBefore,
    /// Anywhere between; the drive is what the readings of the voltage tell.
    Between,
}

fn main() {
    let arguments: Vec<u64> = std::env::args()
        .skip(1)
        .filter_map(|own| own.parse().ok())
        .collect();
    let count = arguments.first().copied().unwrap_or(20);
    let first = arguments.get(1).copied().unwrap_or(1);
    println!(
        "| drive | readings | tau / interval | intervals that hold | bounds that hold | nothing stated | worst parameter |"
    );
    println!("|---|---|---|---|---|---|---|");
    for (name, levels) in drives() {
        for beside in [Beside::OnAfter, Beside::OnBefore, Beside::Between] {
            for ratio in RATIOS {
                let mut held = Held::default();
                (first..first + count).for_each(|seed| one(&levels, beside, ratio, seed, &mut held));
                println!("| {name} | {beside:?} | {ratio} | {} |", held.row());
            }
        }
    }
}

/// Times, in parts of the record, and voltages.
fn drives() -> [(&'static str, Vec<(f64, f64)>); 3] {
    let pulses = (0..20).map(|k| (0.05 * f64::from(k), if k % 2 == 0 { 2.0 } else { 0.0 }));
    [
        ("step", vec![(0.0, 2.0)]),
        ("step, discharge", vec![(0.0, 2.0), (0.5, 0.0)]),
        ("pulses", pulses.collect()),
    ]
}

fn one(levels: &[(f64, f64)], beside: Beside, ratio: f64, seed: u64, held: &mut Held) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut about = |value: f64| value * random.random_range(-0.3..0.3_f64).exp();
    let branch = |r: f64, tau_s: f64| Branch {
        resistance_ohm_cm2: r,
        capacitance_f_per_cm2: tau_s / r,
    };
    // One reading a second; the slow branch is told from the fast one and from the record.
    let fast_s = about(ratio);
    let slow_s = about((10.0 * ratio).clamp(30.0, 250.0)).max(2.5 * fast_s);
    let model = LumpedModel {
        branches: vec![branch(about(30.0), fast_s), branch(about(120.0), slow_s)],
        steady_state_resistance_ohm_cm2: about(2000.0),
        charge_to_curvature_per_c_cm: about(20.0),
        relaxation_rate_per_s: about(0.01),
    };
    let lasting_s = READINGS as f64;
    let segments = levels
        .iter()
        .map(|&(part, volts)| Segment::at(part * lasting_s, Level::Voltage(volts)));
    let drive = Drive {
        baseline_v: 0.0,
        segments: segments.collect(),
    };
    let offset_s = match beside {
        Beside::Between => random.random_range(0.02..0.98),
        _ => 0.0,
    };
    let time_s: Arc<[f64]> = (0..READINGS + AT_REST)
        .map(|k| k as f64 - AT_REST as f64 + offset_s)
        .collect();
    // A reading at the instant of an edge that is of the side before it is one just before it.
    let read_s: Vec<f64> = match beside {
        Beside::OnBefore => time_s.iter().map(|t| t - 1e-9).collect(),
        _ => time_s.to_vec(),
    };
    let seen = match beside {
        Beside::Between => drive.as_seen(&time_s),
        _ => drive.clone(),
    };
    let mut noisy = |values: Vec<f64>| -> Arc<[f64]> {
        let peak = values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let noise = |value: &f64| {
            let own: f64 = StandardNormal.sample(&mut random);
            value + NOISE * peak * own
        };
        values.iter().map(noise).collect()
    };
    let channels = [
        Channel::new(
            Quantity::Current,
            time_s.clone(),
            noisy(model.current_a(&drive, AREA_CM2, &read_s)),
        ),
        Channel::new(
            Quantity::Curvature,
            time_s.clone(),
            noisy(model.curvature_per_cm(&drive, AREA_CM2, &read_s)),
        ),
    ];
    let input = FitInput {
        channels: &channels,
        drive: &seen,
        area_cm2: AREA_CM2,
    };
    let Ok(fit) = fit_run(&input, &FitOptions::default()) else {
        return;
    };
    for parameter in &fit.parameters {
        if let Some(truth) = truth_of(&model, &parameter.key) {
            held.add(&parameter.key, &parameter.estimate, truth);
            if std::env::var_os("SHOW").is_some() && !holds(&parameter.estimate, truth) {
                eprintln!(
                    "seed {seed} {beside:?} {ratio} {} {truth:.5e} {:?}",
                    parameter.key, parameter.estimate
                );
            }
        }
    }
}

fn truth_of(model: &LumpedModel, key: &str) -> Option<f64> {
    let [fast, slow] = model.branches.as_slice() else {
        return None;
    };
    let parallel = (fast.resistance_ohm_cm2.recip() + slow.resistance_ohm_cm2.recip()).recip();
    Some(match key {
        "r1_ohm_cm2" => fast.resistance_ohm_cm2,
        "r2_ohm_cm2" => slow.resistance_ohm_cm2,
        "c1_f_per_cm2" => fast.capacitance_f_per_cm2,
        "c2_f_per_cm2" => slow.capacitance_f_per_cm2,
        "tau1_s" => fast.time_constant_s(),
        "tau2_s" => slow.time_constant_s(),
        "c_total_f_per_cm2" => model.total_capacitance_f_per_cm2(),
        "r_parallel_ohm_cm2" => parallel,
        "rss_ohm_cm2" => model.steady_state_resistance_ohm_cm2,
        "alpha_per_c_cm" => model.charge_to_curvature_per_c_cm,
        "lambda_per_s" => model.relaxation_rate_per_s,
        _ => return None,
    })
}

fn holds(estimate: &Estimate, truth: f64) -> bool {
    estimate.low_95.is_none_or(|low| low <= truth) && estimate.high_95.is_none_or(|high| truth <= high)
}

/// What is stated, and how often it holds.
#[derive(Default)]
struct Held {
    intervals: [usize; 2],
    bounds: [usize; 2],
    nothing: usize,
    by_key: BTreeMap<String, [usize; 2]>,
}

impl Held {
    fn add(&mut self, key: &str, estimate: &Estimate, truth: f64) {
        let holds = usize::from(holds(estimate, truth));
        match (estimate.low_95, estimate.high_95) {
            (Some(_), Some(_)) => {
                self.intervals = [self.intervals[0] + 1, self.intervals[1] + holds];
                let own = self.by_key.entry(key.to_owned()).or_default();
                *own = [own[0] + 1, own[1] + holds];
            }
            (None, None) => self.nothing += 1,
            _ => self.bounds = [self.bounds[0] + 1, self.bounds[1] + holds],
        }
    }

    fn row(&self) -> String {
        let share = |[all, held]: [usize; 2]| match all {
            0 => "-".to_owned(),
            all => format!("{held} of {all} ({:.0} %)", 100.0 * held as f64 / all as f64),
        };
        let worst = self.by_key.iter().min_by(|a, b| {
            let part = |own: &[usize; 2]| own[1] as f64 / own[0] as f64;
            part(a.1).total_cmp(&part(b.1))
        });
        let worst = worst.map_or_else(String::new, |(key, own)| format!("{key} {}", share(*own)));
        format!(
            "{} | {} | {} | {worst}",
            share(self.intervals),
            share(self.bounds),
            self.nothing
        )
    }
}
