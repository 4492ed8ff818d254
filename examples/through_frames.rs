//! How often what is fitted through drawn frames holds the truth: `cargo run --release --example through_frames -- 8 1 60`
//!
//! Both samples of the thesis's table 3 in views drawn at random: their frames are drawn and traced, a current and two
//! voltages stand beside them, and everything is fitted jointly, with the electrodes' resistance given and not, with the
//! voltages and without. The numbers say how many views of each sample are drawn, the seed of the first, and how many
//! frames each has after the step. Told is how many 95 % intervals hold the truth.

#[allow(dead_code)]
#[path = "../tests/it/rendered.rs"]
mod rendered;

use std::sync::Arc;

use ieap::domain::{Channel, Drive, Fit, Quantity};
use ieap::fit::Steps;
use ieap::fit::distributed::{DistributedInput, Strip, fit_distributed};
use ieap::model::Branch;
use ieap::model::coupling::{ActiveArea, CurvaturePerTotalCharge};
use ieap::model::distributed::{DistributedModel, Laminate};
use ieap::strip::{Gray, Initial, Positive, Scale, Trace, View, trace};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use rendered::{Frame, Scene};

const LENGTH_PX: f64 = 520.0;
const VECTORS: usize = 20;
/// Frames before the step, a tenth of a second apart.
const BEFORE: usize = 10;
/// Readings of the current and the voltages, and their noise over their first value.
const READINGS: usize = 300;
const NOISE: f64 = 1e-3;
/// Places at which a curvature is known to be drawn.
const DRAWN: usize = 400;
const READ: [(bool, bool, &str); 4] = [
    (true, true, "R_e given, current, 2 voltages"),
    (true, false, "R_e given, current"),
    (false, true, "current, 2 voltages"),
    (false, false, "current"),
];

/// A sample.
struct Sample {
    name: &'static str,
    length_cm: f64,
    width_cm: f64,
    electrode_ohm_per_sq: f64,
    branch_ohm_cm2: f64,
    capacitance_f_per_cm2: f64,
    steady_ohm_cm2: f64,
    alpha_per_c_cm: f64,
    rate_per_s: f64,
    step_v: f64,
    duration_s: f64,
}

const SAMPLES: [Sample; 2] = [
    Sample {
        name: "PtNaf",
        length_cm: 4.5,
        width_cm: 0.3,
        electrode_ohm_per_sq: 4.5,
        branch_ohm_cm2: 3.0,
        capacitance_f_per_cm2: 0.0197,
        steady_ohm_cm2: 42.9,
        alpha_per_c_cm: 29.5,
        rate_per_s: 0.29,
        step_v: 0.25,
        duration_s: 12.0,
    },
    Sample {
        name: "CNaf",
        length_cm: 2.8,
        width_cm: 0.5,
        electrode_ohm_per_sq: 2.5,
        branch_ohm_cm2: 4.5,
        capacitance_f_per_cm2: 0.131,
        steady_ohm_cm2: 22.7,
        alpha_per_c_cm: 2.1,
        rate_per_s: 0.0029,
        step_v: 1.5,
        duration_s: 900.0,
    },
];

impl Sample {
    fn model(&self) -> DistributedModel {
        let of = ActiveArea {
            length_cm: self.length_cm,
            width_cm: self.width_cm,
        };
        Laminate {
            electrode_resistance_ohm_per_sq: self.electrode_ohm_per_sq,
            branch: Branch {
                resistance_ohm_cm2: self.branch_ohm_cm2,
                capacitance_f_per_cm2: self.capacitance_f_per_cm2,
            },
            steady_state_resistance_ohm_cm2: self.steady_ohm_cm2,
            coupling: CurvaturePerTotalCharge(self.alpha_per_c_cm).areal(&of),
            relaxation_rate_per_s: self.rate_per_s,
        }
        .strip(&of)
    }

    fn truth(&self) -> [(&'static str, f64); 6] {
        [
            ("re_ohm_per_sq", self.electrode_ohm_per_sq),
            ("rc_ohm_cm2", self.branch_ohm_cm2),
            ("c_f_per_cm2", self.capacitance_f_per_cm2),
            ("rss_ohm_cm2", self.steady_ohm_cm2),
            ("alpha_per_c_cm", self.alpha_per_c_cm),
            ("lambda_per_s", self.rate_per_s),
        ]
    }

    /// Times after the step, closer together at first.
    fn times_s(&self, count: usize) -> Arc<[f64]> {
        (1..=count)
            .map(|k| self.duration_s * (k as f64 / count as f64).powi(2))
            .collect()
    }

    fn px_per_cm(&self) -> f64 {
        LENGTH_PX / self.length_cm
    }

    /// Curvatures at the joints as they are traced; frames that are refused are left out.
    fn curvatures(&self, seed: u64, frames: usize, random: &mut ChaCha8Rng) -> Option<Vec<Channel>> {
        let (scene, rest_per_px) = view(seed, random);
        let model = self.model();
        let before = (0..BEFORE).map(|k| (k as f64 - BEFORE as f64) * 0.1);
        let times: Vec<f64> = before.chain(self.times_s(frames).iter().copied()).collect();
        let traced = |(k, &time_s): (usize, &f64)| {
            let scene = Scene {
                seed: seed * 100_000 + k as u64,
                ..scene.clone()
            };
            let bent = bent_per_cm(&model, self.step_v, time_s);
            let frame = scene.draw(LENGTH_PX, |s| {
                rest_per_px + at(&bent, s / LENGTH_PX) / self.px_per_cm()
            });
            trace(&gray(&frame)?, &View::default()).ok()
        };
        let traces: Vec<Option<Trace>> = times.par_iter().enumerate().map(traced).collect();
        let first: Vec<Trace> = traces[..BEFORE].iter().flatten().cloned().collect();
        let scale = Scale::PixelsPerMm(self.px_per_cm() / 10.0);
        let initial = Initial::of(&first, scale, VECTORS, Positive::CounterClockwise)?;
        let rows: Vec<_> = times
            .iter()
            .zip(&traces)
            .filter_map(|(time_s, trace)| Some((*time_s, initial.bending(trace.as_ref()?).ok()?)))
            .collect();
        let time_s: Arc<[f64]> = rows.iter().map(|row| row.0).collect();
        let channel = |(joint, place_mm): (usize, &f64)| {
            let values = rows.iter().map(|row| row.1.curvature_per_cm[joint].value);
            placed(Quantity::Curvature, *place_mm, &time_s, values.collect())
        };
        Some(initial.joints_mm.iter().enumerate().map(channel).collect())
    }

    /// The current, and voltages at two places.
    fn electrical(&self, random: &mut ChaCha8Rng) -> Vec<Channel> {
        let (model, time_s) = (self.model(), self.times_s(READINGS));
        let mut noisy = |exact: Vec<f64>, size: f64| -> Arc<[f64]> {
            let drawn = |value: &f64| -> f64 {
                let normal: f64 = StandardNormal.sample(random);
                value + NOISE * size * normal
            };
            exact.iter().map(drawn).collect()
        };
        let current = model.clamp_current_a(self.step_v, &time_s);
        let first = current[0];
        let mut channels = vec![Channel::new(
            Quantity::Current,
            time_s.clone(),
            noisy(current, first),
        )];
        for share in [0.3, 0.8] {
            let place_cm = share * self.length_cm;
            let exact = model.voltage_v(self.step_v, &[place_cm], &time_s).values;
            let values = noisy(exact, self.step_v);
            channels.push(placed(Quantity::Voltage, 10.0 * place_cm, &time_s, values));
        }
        channels
    }

    fn fitted(&self, channels: &[Channel], given: bool) -> Option<Fit> {
        let drive = Drive::step(self.step_v);
        let input = DistributedInput {
            channels,
            drive: &drive,
            strip: Strip {
                length_cm: self.length_cm,
                width_cm: self.width_cm,
                electrode_resistance_ohm_per_sq: given.then_some(self.electrode_ohm_per_sq),
                electrode_resistance_error_ohm_per_sq: None,
            },
        };
        fit_distributed(&input, Steps::Simultaneous).ok()
    }
}

/// A view, and the curvature (1/pixel) that the strip has in it before the step.
fn view(seed: u64, random: &mut ChaCha8Rng) -> (Scene, f64) {
    let mut between = |low: f64, high: f64| random.random_range(low..high);
    let scene = Scene {
        width: 560,
        height: 400,
        root: between(0.86, 0.92),
        tilt_rad: between(-0.02, 0.1),
        thickness: between(5.0, 12.0),
        dark: between(0.0, 1.0) < 0.6,
        blur: between(0.7, 1.6),
        noise: between(1.0, 3.5),
        uneven: between(0.0, 0.5),
        seed,
        ..Scene::default()
    };
    (scene, between(-1e-4, 6e-4))
}

/// Curvatures along the strip, evenly from end to end, 1/cm.
fn bent_per_cm(model: &DistributedModel, step_v: f64, time_s: f64) -> Vec<f64> {
    if time_s <= 0.0 {
        return vec![0.0; DRAWN + 1];
    }
    let places: Vec<f64> = (0..=DRAWN)
        .map(|k| model.length_cm * k as f64 / DRAWN as f64)
        .collect();
    model.curvature_per_cm(step_v, &places, &[time_s]).values
}

/// A value between evenly placed ones.
fn at(values: &[f64], share: f64) -> f64 {
    let last = values.len() - 1;
    let u = (share * last as f64).clamp(0.0, last as f64 - 1e-9);
    let (k, part) = (u as usize, u.fract());
    values[k] * (1.0 - part) + values[k + 1] * part
}

fn gray(frame: &Frame) -> Option<Gray> {
    let values = frame.pixels.iter().map(|v| f32::from(*v) / 255.0).collect();
    Gray::new(frame.width, frame.height, values)
}

fn placed(quantity: Quantity, place_mm: f64, time_s: &Arc<[f64]>, values: Arc<[f64]>) -> Channel {
    let mut channel = Channel::new(quantity, time_s.clone(), values);
    channel.position_mm = Some(place_mm);
    channel
}

/// How often intervals of a parameter held the truth, of how many, and how wide they were beside it.
#[derive(Clone, Copy, Default)]
struct Held {
    inside: usize,
    of: usize,
    error: f64,
}

fn main() {
    let words = std::env::args().skip(1);
    let numbers: Vec<u64> = words.filter_map(|word| word.parse().ok()).collect();
    let number = |k: usize, otherwise: u64| numbers.get(k).copied().unwrap_or(otherwise);
    let (views, first, frames) = (number(0, 8), number(1, 1), number(2, 60) as usize);
    println!("| sample, read | cracks | R_e | R_c | C | R_ss | alpha | lambda |");
    println!("|---|---|---|---|---|---|---|---|");
    let (mut inside, mut of) = (0, 0);
    for sample in &SAMPLES {
        let mut held = [[Held::default(); 6]; READ.len()];
        let mut cracks = [0; READ.len()];
        for seed in first..first + views {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let Some(mut channels) = sample.curvatures(seed, frames, &mut random) else {
                eprintln!(
                    "{} in view {seed}: no frame of its initial shape is traced",
                    sample.name
                );
                continue;
            };
            channels.extend(sample.electrical(&mut random));
            for (case, (given, voltages, _)) in READ.into_iter().enumerate() {
                let used = channels
                    .iter()
                    .filter(|c| voltages || c.quantity != Quantity::Voltage);
                let used: Vec<Channel> = used.cloned().collect();
                let Some(fit) = sample.fitted(&used, given) else {
                    continue;
                };
                cracks[case] += u32::from(fit.issues.iter().any(|issue| issue.code == "contact-break"));
                for (held, (key, truth)) in held[case].iter_mut().zip(sample.truth()) {
                    let Some(estimate) = fit.parameter(key) else {
                        continue;
                    };
                    if let (Some(low), Some(high)) = (estimate.low_95, estimate.high_95) {
                        held.inside += usize::from(low <= truth && truth <= high);
                        held.of += 1;
                        held.error += 0.5 * (high - low) / truth;
                    }
                }
            }
        }
        for (case, (_, _, read)) in READ.into_iter().enumerate() {
            print!("| {}, {read} | {} |", sample.name, cracks[case]);
            for held in held[case] {
                match held.of {
                    0 => print!(" - |"),
                    of => print!(
                        " {} of {of}, {:.2} % |",
                        held.inside,
                        100.0 * held.error / of as f64
                    ),
                }
                (inside, of) = (inside + held.inside, of + held.of);
            }
            println!();
        }
    }
    println!("\n{inside} of {of} intervals hold the truth, {frames} frames after the step");
}
