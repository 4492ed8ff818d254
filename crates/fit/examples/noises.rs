//! How often the 95 % intervals of single fits hold under noises of every kind, and how wide they are beside those under white
//! noise of the same size: `cargo run --release -p ieap-fit --example noises -- RUNS SEED [SPACING_S LENGTH_S RUNS_OF_INSTRUMENT]`;
//! first with a memory of neighbours, then with every kind of slow noise of each run alone, then with what the other runs of the
//! instrument tell of it.
//!
//! One voltage step; time constants and sizes are drawn, noise is 0.15 % of the peak current and 0.6 % of the peak bending.

use std::time::Instant;

use ieap_domain::{Channel, Drive, Estimate, Fit, Quantity};
use ieap_fit::{FitInput, FitOptions, InstrumentNoise, NoiseBy, ToldOfNoise, fit_run, told_of_noise};
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

/// A run of a strip whose parameters are drawn.
struct Drawn {
    channels: [Channel; 2],
    drive: Drive,
    /// Parameters in the order of the keys.
    truth: [f64; 7],
}

fn drawn(kind: &str, time_s: &[f64], length_s: f64, seed: u64) -> Drawn {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut about = |value: f64, by: f64| value * (by * (2.0 * random.random::<f64>() - 1.0)).exp();
    let (c1, c2) = (about(0.010, 0.5), about(0.018, 0.5));
    let fast_s = about(0.025 * length_s, 0.3);
    let slow_s = fast_s * about(8.0, 0.4);
    let branch = |time_s: f64, capacitance_f_per_cm2: f64| Branch {
        resistance_ohm_cm2: time_s / capacitance_f_per_cm2,
        capacitance_f_per_cm2,
    };
    let model = LumpedModel {
        branches: vec![branch(fast_s, c1), branch(slow_s, c2)],
        steady_state_resistance_ohm_cm2: about(2e4, 0.5),
        charge_to_curvature_per_c_cm: about(12.5, 0.5),
        relaxation_rate_per_s: about(0.8 / length_s, 0.9),
    };
    let drive = Drive::step(2.0);
    let mut channel = |quantity, exact: Vec<f64>, part: f64| {
        let peak = exact.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let signal: Vec<f64> = exact.iter().map(|v| v / peak).collect();
        let noise = noise(kind, time_s, &signal, &mut random);
        let values = exact.iter().zip(noise).map(|(v, noise)| v + part * peak * noise);
        Channel::new(quantity, time_s.to_vec().into(), values.collect())
    };
    let current_a = model.current_a(&drive, AREA_CM2, time_s);
    let per_cm = model.curvature_per_cm(&drive, AREA_CM2, time_s);
    let channels = [
        channel(Quantity::Current, current_a, 0.0015),
        channel(Quantity::Curvature, per_cm, 0.006),
    ];
    let truth = [
        model.branches[0].resistance_ohm_cm2,
        c1,
        model.branches[1].resistance_ohm_cm2,
        c2,
        model.steady_state_resistance_ohm_cm2,
        model.charge_to_curvature_per_c_cm,
        model.relaxation_rate_per_s,
    ];
    Drawn {
        channels,
        drive,
        truth,
    }
}

fn fitted(run: &Drawn, noise: NoiseBy) -> Result<Fit, Box<dyn std::error::Error>> {
    let options = FitOptions {
        noise,
        ..FitOptions::for_model("lumped-2")?
    };
    let input = FitInput {
        channels: &run.channels,
        drive: &run.drive,
        area_cm2: AREA_CM2,
    };
    Ok(fit_run(&input, &options)?)
}

fn told(run: &Drawn) -> Result<ToldOfNoise, Box<dyn std::error::Error>> {
    let input = FitInput {
        channels: &run.channels,
        drive: &run.drive,
        area_cm2: AREA_CM2,
    };
    Ok(told_of_noise(&input, &FitOptions::for_model("lumped-2")?)?)
}

/// What fits of many runs state of one parameter.
#[derive(Default, Clone)]
struct Stated {
    held: u32,
    stated: u32,
    widths: Vec<f64>,
}

impl Stated {
    fn count(&mut self, own: &Estimate, truth: f64) {
        if own.low_95.is_none() && own.high_95.is_none() {
            return;
        }
        self.stated += 1;
        let inside =
            own.low_95.is_none_or(|low| low <= truth) && own.high_95.is_none_or(|high| truth <= high);
        self.held += u32::from(inside);
        if let (Some(low), Some(high)) = (own.low_95, own.high_95) {
            self.widths.push((high - low) / truth);
        }
    }

    fn width(&self) -> f64 {
        let mut widths = self.widths.clone();
        widths.sort_by(f64::total_cmp);
        widths.get(widths.len() / 2).copied().unwrap_or(f64::NAN)
    }
}

fn share(held: u32, stated: u32) -> f64 {
    100.0 * f64::from(held) / f64::from(stated.max(1))
}

fn counted(runs: &[Drawn], fits: &[Fit]) -> Vec<Stated> {
    let mut stated = vec![Stated::default(); KEYS.len()];
    for (run, fit) in runs.iter().zip(fits) {
        for ((own, key), truth) in stated.iter_mut().zip(KEYS).zip(run.truth) {
            if let Some(estimate) = fit.parameter(key) {
                own.count(estimate, truth);
            }
        }
    }
    stated
}

fn said(name: &str, kind: &str, stated: &[Stated], under_white: &[f64], ms: f64) {
    let all = share(
        stated.iter().map(|own| own.held).sum(),
        stated.iter().map(|own| own.stated).sum(),
    );
    let one = |((own, key), white): ((&Stated, &str), &f64)| {
        let symbol = key.split('_').next().unwrap_or(key);
        let (hold, wide) = (share(own.held, own.stated), own.width() / white);
        format!("{symbol} {hold:.0} ({}) {wide:.1}", own.stated)
    };
    let each: Vec<String> = stated.iter().zip(KEYS).zip(under_white).map(one).collect();
    println!(
        "{name:10} {kind:9} {all:5.1} % hold; {}; {ms:.1} ms a fit",
        each.join(", ")
    );
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<f64> = std::env::args()
        .skip(1)
        .map(|own| own.parse())
        .collect::<Result<_, _>>()?;
    let given = |place: usize, default: f64| arguments.get(place).copied().unwrap_or(default);
    let (runs, seed) = (given(0, 48.0) as u64, given(1, 1.0) as u64);
    let (spacing_s, length_s) = (given(2, 4.0), given(3, 600.0));
    let of_instrument = given(4, 12.0) as usize;
    let before = (0.06 * length_s / spacing_s) as i32;
    let time_s: Vec<f64> = (-before..(length_s / spacing_s) as i32)
        .map(|k| (f64::from(k) + 0.5) * spacing_s)
        .collect();
    let mut under_white: Vec<f64> = Vec::new();
    println!("Of each parameter: percent that hold (stated), and width in that of the first line.");
    for kind in KINDS {
        let runs: Vec<Drawn> = (0..runs)
            .map(|run| drawn(kind, &time_s, length_s, seed * 100_000 + run))
            .collect();
        let each = |noise: NoiseBy| {
            runs.iter()
                .map(|run| fitted(run, noise))
                .collect::<Result<Vec<Fit>, _>>()
        };
        let mut say = |name: &str, fits: &[Fit], begun: Instant| {
            let ms = 1e3 * begun.elapsed().as_secs_f64() / runs.len() as f64;
            let stated = counted(&runs, fits);
            if under_white.is_empty() {
                under_white = stated.iter().map(Stated::width).collect();
            }
            said(name, kind, &stated, &under_white, ms);
        };
        let begun = Instant::now();
        say("memory", &each(NoiseBy::Memory)?, begun);
        let begun = Instant::now();
        let alone = each(NoiseBy::Kinds(None))?;
        say("alone", &alone, begun);
        let begun = Instant::now();
        let told: Vec<ToldOfNoise> = runs.iter().map(told).collect::<Result<_, _>>()?;
        let mut beside_others = Vec::new();
        for (place, run) in runs.iter().enumerate() {
            let first = place / of_instrument * of_instrument;
            let mut others = InstrumentNoise::default();
            let of_others = (first..(first + of_instrument).min(runs.len())).filter(|other| *other != place);
            of_others.for_each(|other| others.learn(&told[other]));
            beside_others.push(fitted(run, NoiseBy::Kinds(Some(&others)))?);
        }
        say("instrument", &beside_others, begun);
    }
    Ok(())
}
