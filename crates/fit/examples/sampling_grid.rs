//! Do stated intervals hold however a branch compares with the readings, and whatever clock reads them?
//!
//! `cargo run --release -p ieap-fit --example sampling_grid -- 100 [first seed [part of a clock's name ...]]`: for time constants
//! of the fast branch from a tenth to a hundred intervals, on the clocks of laboratories, under a step, a step and a discharge,
//! and pulses, so many runs each; a Markdown table of how many stated 95 % intervals hold the truth, with how many are stated,
//! and of the bounds. `SHOW=1` prints each that does not.

use std::collections::BTreeMap;
use std::sync::Arc;

use ieap_domain::testing::clocks::LabClock;
use ieap_domain::{Channel, Drive, Estimate, Level, Quantity, Segment};
use ieap_fit::{FitInput, FitOptions, fit_run};
use ieap_model::{Branch, LumpedModel};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

const AREA_CM2: f64 = 0.1;
/// Readings of a record from the first edge on.
const READINGS: usize = 600;
/// Noise in parts of the largest signal.
const NOISE: f64 = 0.003;
/// How far zeros are off, standard deviation in that of the noise: a tenth is half a standard error of twenty readings at rest.
const ZERO: f64 = 1.0;
/// Time constants of the fast branch in intervals of the readings.
const RATIOS: [f64; 7] = [0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0];

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |at: usize| arguments.get(at).and_then(|own| own.parse::<u64>().ok());
    let (count, first) = (number(0).unwrap_or(20), number(1).unwrap_or(1));
    let only = &arguments[2.min(arguments.len())..];
    let ratios: String = RATIOS.iter().map(|ratio| format!(" {ratio} |")).collect();
    println!("| drive | readings |{ratios} bounds that hold | nothing stated | worst parameter |");
    println!("|---|---|{}---|---|---|", "---|".repeat(RATIOS.len()));
    let stated = [(None, "drive stated, read on it")];
    let clocks = stated
        .into_iter()
        .chain(LabClock::ALL.map(|(clock, name)| (Some(clock), name)));
    for (clock, clock_name) in clocks {
        if !only.is_empty() && !only.iter().any(|part| clock_name.contains(part.as_str())) {
            continue;
        }
        for (name, levels) in drives() {
            let mut all = Held::default();
            let mut row = String::new();
            for ratio in RATIOS {
                let mut held = Held::default();
                (first..first + count).for_each(|seed| one(&levels, clock, ratio, seed, &mut held));
                row += &format!(" {} |", held.percent());
                all.take(&held);
            }
            println!("| {name} | {clock_name} |{row} {} |", all.rest());
        }
    }
}

/// Times, in parts of the record, and voltages.
fn drives() -> [(&'static str, Vec<(f64, f64)>); 3] {
    // Later edges lie on no reading of a clock that reads the first.
    let pulses = (0..19).map(|k| (0.05033 * f64::from(k), if k % 2 == 0 { 2.0 } else { 0.0 }));
    [
        ("step", vec![(0.0, 2.0)]),
        ("step, discharge", vec![(0.0, 2.0), (0.50067, 0.0)]),
        ("pulses", pulses.collect()),
    ]
}

fn one(levels: &[(f64, f64)], clock: Option<LabClock>, ratio: f64, seed: u64, held: &mut Held) {
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
    let times = match clock {
        Some(clock) => clock.times(seed as usize, &drive, lasting_s, 1.0, || random.random()),
        None => LabClock::AtZero.times(0, &drive, lasting_s, 1.0, || random.random()),
    };
    let seen = match clock {
        Some(_) => drive.as_seen(&times.current_s),
        None => drive.clone(),
    };
    let bending_s: Vec<f64> = times
        .bending_s
        .iter()
        .map(|t| t + times.bending_ahead_s)
        .collect();
    // Where rows at rest tell it, zero is off by up to a few times the noise.
    let rests = times.current_s.iter().filter(|t| **t < 0.0).count() > 1;
    let mut zeros = [0.0; 2];
    let mut noisy = |values: Vec<f64>, zero: &mut f64| -> Arc<[f64]> {
        let peak = values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let off: f64 = StandardNormal.sample(&mut random);
        *zero = if rests { ZERO * NOISE * peak * off } else { 0.0 };
        let noise = |value: &f64| {
            let own: f64 = StandardNormal.sample(&mut random);
            value + *zero + NOISE * peak * own
        };
        values.iter().map(noise).collect()
    };
    let channels = [
        Channel::new(
            Quantity::Current,
            times.current_s.as_slice().into(),
            noisy(model.current_a(&drive, AREA_CM2, &times.current_s), &mut zeros[0]),
        ),
        Channel {
            own_clock: clock == Some(LabClock::Joined),
            ..Channel::new(
                Quantity::Curvature,
                bending_s.into(),
                noisy(
                    model.curvature_per_cm(&drive, AREA_CM2, &times.bending_s),
                    &mut zeros[1],
                ),
            )
        },
    ];
    let input = FitInput {
        channels: &channels,
        drive: &seen,
        area_cm2: AREA_CM2,
    };
    let Ok(fit) = fit_run(&input, &FitOptions::default()) else {
        return;
    };
    let parameters = fit.parameters.iter().map(|own| (&own.key, &own.estimate));
    let parameters = parameters.filter_map(|(key, found)| Some((key, found, truth_of(&model, key)?)));
    let edges = fit.nuisances.iter().map(|own| (&own.key, &own.estimate));
    let nuisances = edges.filter_map(|(key, found)| {
        let truth = match key.as_str() {
            "current_zero_a" => zeros[0],
            "curvature_zero_per_cm" => zeros[1],
            "bending_clock_ahead_s" => times.bending_ahead_s,
            key => {
                let number: usize = key.strip_prefix("edge_")?.strip_suffix("_s")?.parse().ok()?;
                drive.segments.get(number - 1)?.start_s()
            }
        };
        Some((key, found, truth))
    });
    for (key, estimate, truth) in parameters.chain(nuisances) {
        let counted = if key.starts_with("edge_") { "edge_s" } else { key };
        held.add(counted, estimate, truth);
        if std::env::var_os("SHOW").is_some() && !holds(estimate, truth) {
            eprintln!("seed {seed} {clock:?} {ratio} {key} {truth:.5e} {estimate:?}");
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

    fn take(&mut self, other: &Held) {
        let add = |own: &mut [usize; 2], more: [usize; 2]| *own = [own[0] + more[0], own[1] + more[1]];
        add(&mut self.intervals, other.intervals);
        add(&mut self.bounds, other.bounds);
        self.nothing += other.nothing;
        for (key, more) in &other.by_key {
            add(self.by_key.entry(key.clone()).or_default(), *more);
        }
    }

    fn percent(&self) -> String {
        match self.intervals {
            [0, _] => "-".to_owned(),
            [all, held] => format!("{:.0} ({all})", 100.0 * held as f64 / all as f64),
        }
    }

    fn rest(&self) -> String {
        let share = |[all, held]: [usize; 2]| match all {
            0 => "-".to_owned(),
            all => format!("{held} of {all} ({:.0} %)", 100.0 * held as f64 / all as f64),
        };
        let worst = self.by_key.iter().min_by(|a, b| {
            let part = |own: &[usize; 2]| own[1] as f64 / own[0] as f64;
            part(a.1).total_cmp(&part(b.1))
        });
        let worst = worst.map_or_else(String::new, |(key, own)| format!("{key} {}", share(*own)));
        format!("{} | {} | {worst}", share(self.bounds), self.nothing)
    }
}
