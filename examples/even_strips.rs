//! How often an even strip is called distributed: `cargo run --release --example even_strips -- 20 1`
//!
//! Strips whose electrodes conduct perfectly, read as a camera and a potentiostat read them: the noise between joints is
//! that of drawn frames as they are traced, the noise in time that of the truth simulator, with memory. Nothing of the
//! distributed model makes the readings. The first number says how many strips are drawn of every kind, the second is the
//! seed.

#[allow(dead_code)]
#[path = "../tests/it/rendered.rs"]
mod rendered;

use std::sync::Arc;

use ieap::domain::{Channel, Drive, Quantity};
use ieap::fit::distributed::{DistributedInput, LumpedOrDistributed, Strip, UNEVEN_BELOW, decide};
use ieap::model::{Branch, LumpedModel};
use ieap::strip::{Gray, Initial, Positive, Scale, Trace, View, trace};
use ieap::truth::{ChannelNoise, noise};
use rayon::prelude::*;
use rendered::{Frame, Scene};

const VECTORS: usize = 20;
const TIMES: usize = 120;
/// Frames from which the noise between joints is known.
const FRAMES: u64 = 60;
/// Frames before the step whose mean is the initial shape.
const INITIAL: f64 = 10.0;
/// Noise of the current over its first value, and of voltages, V.
const CURRENT_NOISE: f64 = 0.005;
const VOLTAGE_NOISE_V: f64 = 2e-3;

/// A laminate without resistance along its electrodes, with the dimensions of its strip.
struct Kind {
    name: &'static str,
    length_cm: f64,
    width_cm: f64,
    duration_s: f64,
    step_v: f64,
    branches: &'static [(f64, f64)],
    rss_ohm_cm2: f64,
    alpha_per_c_cm: f64,
    lambda_per_s: f64,
}

/// Both samples of the thesis's table 3, and one of its table 5, whose second branch the distributed model lacks.
const KINDS: [Kind; 3] = [
    Kind {
        name: "PtNaf",
        length_cm: 4.5,
        width_cm: 0.3,
        duration_s: 12.0,
        step_v: 0.25,
        branches: &[(3.0, 0.0197)],
        rss_ohm_cm2: 42.9,
        alpha_per_c_cm: 29.5,
        lambda_per_s: 0.29,
    },
    Kind {
        name: "CNaf",
        length_cm: 2.8,
        width_cm: 0.5,
        duration_s: 900.0,
        step_v: 1.5,
        branches: &[(4.5, 0.131)],
        rss_ohm_cm2: 22.7,
        alpha_per_c_cm: 2.1,
        lambda_per_s: 0.0029,
    },
    Kind {
        name: "two branches",
        length_cm: 0.5,
        width_cm: 0.2,
        duration_s: 600.0,
        step_v: 2.0,
        branches: &[(107.6, 0.026), (124.3, 0.13)],
        rss_ohm_cm2: 61_080.0,
        alpha_per_c_cm: 26.56,
        lambda_per_s: 1.1e-4,
    },
];
const MEMORIES: [f64; 3] = [0.0, 0.3, 0.6];
const READ: [&str; 3] = ["curvature", "curvature, current", "curvature, current, voltage"];

impl Kind {
    fn model(&self) -> LumpedModel {
        let branch = |&(resistance_ohm_cm2, capacitance_f_per_cm2): &(f64, f64)| Branch {
            resistance_ohm_cm2,
            capacitance_f_per_cm2,
        };
        LumpedModel {
            branches: self.branches.iter().map(branch).collect(),
            steady_state_resistance_ohm_cm2: self.rss_ohm_cm2,
            charge_to_curvature_per_c_cm: self.alpha_per_c_cm,
            relaxation_rate_per_s: self.lambda_per_s,
        }
    }
}

/// Errors of the curvatures at all joints, 1/cm of a strip of 1 cm, one row for each of many frames of one shape.
fn traced_errors() -> Vec<Vec<f64>> {
    const LENGTH_PX: f64 = 1000.0;
    let found: Vec<Vec<f64>> = (0..FRAMES)
        .into_par_iter()
        .filter_map(|seed| {
            let scene = Scene {
                root: 0.85,
                seed,
                ..Scene::default()
            };
            let frame = scene.draw(LENGTH_PX, |_| 6e-4);
            let traced = trace(&gray(&frame)?, &View::default()).ok()?;
            Some(curvatures(&traced, LENGTH_PX))
        })
        .collect();
    let n = found.len() as f64;
    let mean = |joint: usize| found.iter().map(|row| row[joint]).sum::<f64>() / n;
    let means: Vec<f64> = (0..VECTORS - 1).map(mean).collect();
    let less = |row: &Vec<f64>| row.iter().zip(&means).map(|(value, mean)| value - mean).collect();
    found.iter().map(less).collect()
}

fn gray(frame: &Frame) -> Option<Gray> {
    let values = frame.pixels.iter().map(|v| f32::from(*v) / 255.0).collect();
    Gray::new(frame.width, frame.height, values)
}

fn curvatures(traced: &Trace, px_per_cm: f64) -> Vec<f64> {
    let scale = Scale::PixelsPerMm(px_per_cm / 10.0);
    let straight = Initial::straight(traced, scale, VECTORS, Positive::CounterClockwise);
    let bending = straight.and_then(|initial| initial.bending(traced).ok());
    bending.map_or_else(Vec::new, |bending| {
        bending
            .curvature_per_cm
            .iter()
            .map(|reading| reading.value)
            .collect()
    })
}

/// One strip to be drawn.
struct Case {
    kind: &'static Kind,
    memory: f64,
    read: usize,
    seed: u64,
}

/// Unit noise with that memory.
fn unit(case: &Case, stream: u64, count: usize) -> Vec<f64> {
    let channel = ChannelNoise {
        standard_deviation: 1.0,
        autocorrelation: case.memory,
        ..ChannelNoise::default()
    };
    noise(&vec![0.0; count], &channel, case.seed, stream)
}

fn channels(case: &Case, errors: &[Vec<f64>]) -> Vec<Channel> {
    let kind = case.kind;
    let drive = Drive::step(kind.step_v);
    let area_cm2 = kind.length_cm * kind.width_cm;
    let last = (TIMES - 1) as f64;
    let time_s: Arc<[f64]> = (0..TIMES)
        .map(|k| kind.duration_s * ((k + 1) as f64 / (last + 1.0)).powi(2))
        .collect();
    let model = kind.model();
    let bent = model.curvature_per_cm(&drive, area_cm2, &time_s);
    // A combination of traced errors has their covariance between joints; that of the initial shape stays for good.
    let scale = 1.0 / ((errors.len() - 1) as f64).sqrt() / kind.length_cm;
    let weights: Vec<Vec<f64>> = (0..errors.len())
        .map(|row| unit(case, row as u64, TIMES + 1))
        .collect();
    let error = |joint: usize, time: usize| -> f64 {
        let moving: f64 = weights
            .iter()
            .zip(errors)
            .map(|(w, row)| w[time] * row[joint])
            .sum();
        let fixed: f64 = weights
            .iter()
            .zip(errors)
            .map(|(w, row)| w[TIMES] * row[joint])
            .sum();
        scale * (moving - fixed / INITIAL.sqrt())
    };
    let placed = |quantity, position_cm: f64, values: Vec<f64>| {
        let mut channel = Channel::new(quantity, time_s.clone(), values.into());
        channel.position_mm = Some(10.0 * position_cm);
        channel
    };
    let mut channels: Vec<Channel> = (0..VECTORS - 1)
        .map(|joint| {
            let values = bent.iter().enumerate().map(|(t, value)| value + error(joint, t));
            let place_cm = kind.length_cm * (joint + 1) as f64 / VECTORS as f64;
            placed(Quantity::Curvature, place_cm, values.collect())
        })
        .collect();
    if case.read > 0 {
        let exact = model.current_a(&drive, area_cm2, &time_s);
        let drawn = unit(case, 1000, TIMES);
        let values = exact
            .iter()
            .zip(drawn)
            .map(|(i, n)| i + CURRENT_NOISE * exact[0] * n);
        channels.push(Channel::new(Quantity::Current, time_s.clone(), values.collect()));
    }
    for place in 0..if case.read > 1 { 4 } else { 0 } {
        let drawn = unit(case, 2000 + place, TIMES);
        let values = drawn.iter().map(|n| kind.step_v + VOLTAGE_NOISE_V * n);
        let place_cm = kind.length_cm * (place as f64 + 0.5) / 4.0;
        channels.push(placed(Quantity::Voltage, place_cm, values.collect()));
    }
    channels
}

/// Both p of the evidence, and the verdict; none where nothing could be fitted.
fn judged(case: &Case, errors: &[Vec<f64>]) -> Option<(f64, f64, LumpedOrDistributed)> {
    let channels = channels(case, errors);
    let drive = Drive::step(case.kind.step_v);
    let decided = decide(&DistributedInput {
        channels: &channels,
        drive: &drive,
        strip: Strip {
            length_cm: case.kind.length_cm,
            width_cm: case.kind.width_cm,
            electrode_resistance_ohm_per_sq: None,
            electrode_resistance_error_ohm_per_sq: None,
        },
    })?;
    let found = decided.unevenness?;
    Some((found.p, found.p_later, decided.verdict()))
}

/// Ends of the 95 % interval of a share (Wilson).
fn interval(count: usize, of: usize) -> (f64, f64) {
    let (n, z2) = (of as f64, 1.96f64.powi(2));
    let share = count as f64 / n;
    let middle = share + z2 / (2.0 * n);
    let half = 1.96 * (share * (1.0 - share) / n + z2 / (4.0 * n * n)).sqrt();
    ((middle - half) / (1.0 + z2 / n), (middle + half) / (1.0 + z2 / n))
}

fn line(name: &str, found: &[(Case, (f64, f64, LumpedOrDistributed))], keep: impl Fn(&Case) -> bool) {
    let kept: Vec<_> = found
        .iter()
        .filter(|(case, _)| keep(case))
        .map(|(_, found)| found)
        .collect();
    let share = |is: &dyn Fn(&(f64, f64, LumpedOrDistributed)) -> bool| {
        let count = kept.iter().filter(|found| is(found)).count();
        let (low, high) = interval(count, kept.len());
        format!(
            "{:.1} ({:.1} to {:.1})",
            100.0 * count as f64 / kept.len() as f64,
            100.0 * low,
            100.0 * high
        )
    };
    println!(
        "| {name} | {} | {} | {} | {} |",
        kept.len(),
        share(&|found| found.0 < UNEVEN_BELOW),
        share(&|found| found.1 < UNEVEN_BELOW),
        share(&|found| found.2 == LumpedOrDistributed::Distributed)
    );
}

fn main() {
    let numbers: Vec<u64> = std::env::args()
        .skip(1)
        .filter_map(|text| text.parse().ok())
        .collect();
    let (of_each, seed) = (
        numbers.first().copied().unwrap_or(20),
        numbers.get(1).copied().unwrap_or(1),
    );
    let errors = traced_errors();
    if errors.len() < VECTORS {
        eprintln!("only {} of {FRAMES} drawn frames could be traced", errors.len());
        std::process::exit(1);
    }
    let mut cases = Vec::new();
    for kind in &KINDS {
        for memory in MEMORIES {
            for read in 0..READ.len() {
                for draw in 0..of_each {
                    let seed = seed * 1_000_000 + cases.len() as u64 + 1000 * draw;
                    cases.push(Case {
                        kind,
                        memory,
                        read,
                        seed,
                    });
                }
            }
        }
    }
    let all = cases.len();
    let found: Vec<_> = cases
        .into_par_iter()
        .filter_map(|case| {
            let found = judged(&case, &errors)?;
            Some((case, found))
        })
        .collect();
    println!(
        "{all} even strips from seed {seed}, {} without an answer",
        all - found.len()
    );
    println!(
        "\n| strips | number | p below {UNEVEN_BELOW}, % | p of later below {UNEVEN_BELOW}, % | called distributed, % |"
    );
    println!("|---|---|---|---|---|");
    line("all", &found, |_| true);
    for kind in &KINDS {
        line(kind.name, &found, |case| case.kind.name == kind.name);
    }
    for memory in MEMORIES {
        line(&format!("memory {memory}"), &found, |case| case.memory == memory);
    }
    for (read, name) in READ.iter().enumerate() {
        line(name, &found, |case| case.read == read);
    }
}
