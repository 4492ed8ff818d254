//! How often the 95 % intervals of single fits hold under noises of every kind, and how wide they are beside those under white
//! noise of the same size: `cargo run --release -p ieap-fit --example noises -- RUNS SEED [SPACING_S LENGTH_S]`;
//! first with a memory of neighbours, then with every kind of slow noise.
//!
//! One voltage step; time constants and sizes are drawn, noise is 0.15 % of the peak current and 0.6 % of the peak bending.

use std::time::Instant;

use ieap_domain::{Channel, Drive, Quantity};
use ieap_fit::{FitInput, FitOptions, NoiseBy, fit_run};
use ieap_model::{Branch, LumpedModel};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

const KINDS: [&str; 8] = [
    "white", "next", "red", "1/f", "walk", "line", "outliers", "growing",
];
const KEYS: [&str; 7] = [
    "r1_ohm_cm2",
    "c1_f_per_cm2",
    "r2_ohm_cm2",
    "c2_f_per_cm2",
    "rss_ohm_cm2",
    "alpha_per_c_cm",
    "lambda_per_s",
];
const AREA_CM2: f64 = 1.0;

fn normal(random: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(random)
}

/// Noise of unit size; `signal` in parts of its peak.
fn noise(kind: &str, time_s: &[f64], signal: &[f64], random: &mut ChaCha8Rng) -> Vec<f64> {
    let n = time_s.len();
    let spacing_s = time_s[1] - time_s[0];
    let record_s = time_s[n - 1] - time_s[0];
    let dying = |kept: f64, random: &mut ChaCha8Rng| {
        let mut state = normal(random);
        (0..n)
            .map(|_| {
                let own = state;
                state = kept * state + (1.0 - kept * kept).sqrt() * normal(random);
                own
            })
            .collect::<Vec<f64>>()
    };
    let white = |random: &mut ChaCha8Rng| -> Vec<f64> { (0..n).map(|_| normal(random)).collect() };
    let sum =
        |a: f64, x: Vec<f64>, b: f64, y: Vec<f64>| x.iter().zip(y).map(|(x, y)| a * x + b * y).collect();
    match kind {
        "next" => dying(0.6, random),
        "red" => sum(0.8, white(random), 0.6, dying((-spacing_s / 60.0).exp(), random)),
        "1/f" => {
            let mut slow = vec![0.0; n];
            let mut time_s = spacing_s / 2.0;
            let mut count = 0.0_f64;
            while time_s < record_s {
                let own = dying((-spacing_s / time_s).exp(), random);
                slow.iter_mut().zip(own).for_each(|(slow, own)| *slow += own);
                time_s *= 3.0;
                count += 1.0;
            }
            slow.iter_mut().for_each(|slow| *slow /= count.sqrt());
            sum(0.7, white(random), 0.7, slow)
        }
        "walk" => {
            let mut place = 0.0;
            let walk = (0..n)
                .map(|_| {
                    place += normal(random) * 2.0 * (spacing_s / record_s).sqrt();
                    place
                })
                .collect();
            sum(1.0, white(random), 1.0, walk)
        }
        "line" => {
            let slope = 3.0 * normal(random);
            let line = time_s
                .iter()
                .map(|t| slope * (t - time_s[0]) / record_s)
                .collect();
            sum(1.0, white(random), 1.0, line)
        }
        "outliers" => white(random)
            .into_iter()
            .map(|own| {
                if random.random::<f64>() < 0.02 {
                    8.0 * own
                } else {
                    own
                }
            })
            .collect(),
        "growing" => white(random)
            .into_iter()
            .zip(signal)
            .map(|(own, part)| own * (0.3 + part.abs()))
            .collect(),
        _ => white(random),
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<f64> = std::env::args()
        .skip(1)
        .map(|own| own.parse())
        .collect::<Result<_, _>>()?;
    let given = |place: usize, default: f64| arguments.get(place).copied().unwrap_or(default);
    let (runs, seed) = (given(0, 40.0) as u64, given(1, 1.0) as u64);
    let (spacing_s, length_s) = (given(2, 4.0), given(3, 600.0));
    let before = (0.06 * length_s / spacing_s) as i32;
    let time_s: Vec<f64> = (-before..(length_s / spacing_s) as i32)
        .map(|k| (f64::from(k) + 0.5) * spacing_s)
        .collect();
    let mut white: Vec<Option<Vec<f64>>> = vec![None; KEYS.len()];
    for (by, kind) in [NoiseBy::Memory, NoiseBy::Kinds]
        .into_iter()
        .flat_map(|by| KINDS.map(|kind| (by, kind)))
    {
        let options = FitOptions {
            noise: by,
            ..FitOptions::for_model("lumped-2")?
        };
        let (mut held, mut stated) = ([0_u32; 7], [0_u32; 7]);
        let mut widths: Vec<Vec<f64>> = vec![Vec::new(); KEYS.len()];
        let mut spent_s = 0.0;
        for run in 0..runs {
            let mut random = ChaCha8Rng::seed_from_u64(seed * 100_000 + run);
            let mut about = |value: f64, by: f64| value * (by * (2.0 * random.random::<f64>() - 1.0)).exp();
            let (c1, c2) = (about(0.010, 0.5), about(0.018, 0.5));
            let fast_s = about(0.025 * length_s, 0.3);
            let slow_s = fast_s * about(8.0, 0.4);
            let model = LumpedModel {
                branches: vec![
                    Branch {
                        resistance_ohm_cm2: fast_s / c1,
                        capacitance_f_per_cm2: c1,
                    },
                    Branch {
                        resistance_ohm_cm2: slow_s / c2,
                        capacitance_f_per_cm2: c2,
                    },
                ],
                steady_state_resistance_ohm_cm2: about(2e4, 0.5),
                charge_to_curvature_per_c_cm: about(12.5, 0.5),
                relaxation_rate_per_s: about(0.8 / length_s, 0.9),
            };
            let drive = Drive::step(2.0);
            let mut channel = |quantity, exact: Vec<f64>, part: f64| {
                let peak = exact.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
                let signal: Vec<f64> = exact.iter().map(|v| v / peak).collect();
                let noise = noise(kind, &time_s, &signal, &mut random);
                let values = exact.iter().zip(noise).map(|(v, noise)| v + part * peak * noise);
                Channel::new(quantity, time_s.clone().into(), values.collect())
            };
            let channels = [
                channel(
                    Quantity::Current,
                    model.current_a(&drive, AREA_CM2, &time_s),
                    0.0015,
                ),
                channel(
                    Quantity::Curvature,
                    model.curvature_per_cm(&drive, AREA_CM2, &time_s),
                    0.006,
                ),
            ];
            let input = FitInput {
                channels: &channels,
                drive: &drive,
                area_cm2: AREA_CM2,
            };
            let begun = Instant::now();
            let fit = fit_run(&input, &options)?;
            spent_s += begun.elapsed().as_secs_f64();
            let truth = [
                model.branches[0].resistance_ohm_cm2,
                c1,
                model.branches[1].resistance_ohm_cm2,
                c2,
                model.steady_state_resistance_ohm_cm2,
                model.charge_to_curvature_per_c_cm,
                model.relaxation_rate_per_s,
            ];
            for (place, (key, truth)) in KEYS.iter().zip(truth).enumerate() {
                let Some(own) = fit.parameter(key) else { continue };
                if own.low_95.is_none() && own.high_95.is_none() {
                    continue;
                }
                stated[place] += 1;
                let inside =
                    own.low_95.is_none_or(|low| low <= truth) && own.high_95.is_none_or(|high| truth <= high);
                held[place] += u32::from(inside);
                if let (Some(low), Some(high)) = (own.low_95, own.high_95) {
                    widths[place].push((high - low) / truth);
                }
            }
        }
        let middle = |own: &Vec<f64>| {
            let mut own = own.clone();
            own.sort_by(f64::total_cmp);
            own.get(own.len() / 2).copied().unwrap_or(f64::NAN)
        };
        let medians: Vec<f64> = widths.iter().map(middle).collect();
        let share = |held: u32, stated: u32| 100.0 * f64::from(held) / f64::from(stated.max(1));
        let all = share(held.iter().sum(), stated.iter().sum());
        let each: Vec<String> = KEYS
            .iter()
            .enumerate()
            .map(|(place, key)| {
                let first = white[place].get_or_insert_with(|| vec![medians[place]])[0];
                format!(
                    "{} {:.0} ({}) {:.1}",
                    key.split('_').next().unwrap_or(key),
                    share(held[place], stated[place]),
                    stated[place],
                    medians[place] / first
                )
            })
            .collect();
        let whites: Vec<String> = white
            .iter()
            .flatten()
            .map(|own| format!("{:.2}", 100.0 * own[0]))
            .collect();
        println!(
            "{by:?} {kind:9} {all:5.1} % hold of {}; {}; {:.1} ms a fit; widths under white noise {} %",
            stated.iter().sum::<u32>(),
            each.join(", "),
            1e3 * spent_s / runs as f64,
            whites.join(" ")
        );
    }
    Ok(())
}
