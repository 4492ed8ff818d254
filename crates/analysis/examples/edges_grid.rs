//! Do intervals of charges, energies, efficiencies and cycles hold wherever the readings lie beside the edges?
//!
//! `cargo run --release -p ieap-analysis --example edges_grid -- 20 [first seed]`: for time constants of the fast branch from a
//! tenth to a hundred intervals, six clocks, a step, a step and a discharge, and pulses, so many runs each, and logs of a
//! modulus whose humidity steps between the readings; a Markdown table of how many stated intervals and bounds hold.

use std::collections::BTreeMap;
use std::sync::Arc;

use ieap_analysis::cycles::{CYCLE_FIGURES, cycle_run};
use ieap_analysis::dma::analyse;
use ieap_analysis::model_free::{ENERGIES, FIGURES, model_free};
use ieap_domain::modulus::step_keys;
use ieap_domain::testing::{campaign, known, run};
use ieap_domain::{Channel, Drive, Estimate, Level, Quantity, Segment};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Seconds before the first edge, and from it on; one reading a second.
const REST_S: f64 = 20.0;
const LASTING_S: f64 = 600.0;
/// Noise in parts of the largest reading.
const NOISE: f64 = 0.003;
/// Time constants of the fast branch in intervals of the readings.
const RATIOS: [f64; 7] = [0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0];
/// The drive under which the circuit has its fast branch only.
const ONE_BRANCH: &str = "pulses, one branch";
const MODULUS_MPA: f64 = 55.0;

/// Where readings lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Clock {
    /// On the edges, which are stated.
    Stated,
    /// On the edges, which only they tell of.
    On,
    /// Four tenths of an interval beside them.
    Beside,
    /// The voltage four tenths beside them, the rest on a clock of its own, every 1.03 s.
    Own,
    /// Beside them, without those of 2 to 8 s at half of the edges.
    Lost,
    /// Beside them, each off by 5 % of an interval.
    Jitter,
    /// From each edge on further and further apart.
    Log,
    /// As beside them, with noise that goes on from reading to reading (0.6).
    Slow,
}

const CLOCKS: [Clock; 8] = [
    Clock::Stated,
    Clock::On,
    Clock::Beside,
    Clock::Own,
    Clock::Lost,
    Clock::Jitter,
    Clock::Log,
    Clock::Slow,
];

fn main() {
    let mut arguments = std::env::args().skip(1).filter_map(|own| own.parse::<u64>().ok());
    let (count, first) = (arguments.next().unwrap_or(5), arguments.next().unwrap_or(1));
    let mut held = Held::default();
    for (name, levels) in drives() {
        for clock in CLOCKS {
            for ratio in RATIOS {
                (first..first + count).for_each(|seed| one(name, &levels, clock, ratio, seed, &mut held));
            }
        }
    }
    (first..first + 10 * count).for_each(|seed| humidity(seed, &mut held));
    held.print();
}

/// When levels start, s, and their voltages.
fn drives() -> [(&'static str, Vec<(f64, f64)>); 4] {
    let pulse = |k: u32| (30.0 * f64::from(k), if k.is_multiple_of(2) { 2.0 } else { 0.0 });
    let pulses: Vec<(f64, f64)> = (0..20).map(pulse).collect();
    [
        ("step", vec![(0.0, 2.0)]),
        ("step, discharge", vec![(0.0, 2.0), (300.0, 0.0)]),
        ("pulses", pulses.clone()),
        (ONE_BRANCH, pulses),
    ]
}

/// Two resistors with capacitors beside a leak, and a strip that bends with what they store and relaxes.
struct Circuit {
    /// Ohm and s.
    branches: [(f64, f64); 2],
    leak_ohm: f64,
    alpha: f64,
    rate_per_s: f64,
    levels: Vec<(f64, f64)>,
}

/// What it does at a time: current, charge that has flowed, curvature.
struct Now {
    ampere: f64,
    charge: f64,
    bent: f64,
}

impl Circuit {
    fn at(&self, t: f64) -> Now {
        let (mut stored, mut leaked, mut bent, mut ampere) = ([0.0; 2], 0.0, 0.0, 0.0);
        for (k, &(start_s, volts)) in self.levels.iter().enumerate() {
            if t < start_s {
                break;
            }
            let since_s = self.levels.get(k + 1).map_or(t, |next| next.0.min(t)) - start_s;
            bent *= (-self.rate_per_s * since_s).exp();
            ampere = volts / self.leak_ohm;
            leaked += ampere * since_s;
            for (own, (ohm, tau_s)) in stored.iter_mut().zip(self.branches) {
                let flow = (volts * tau_s / ohm - *own) / tau_s;
                let (left, relaxed) = ((-since_s / tau_s).exp(), (-self.rate_per_s * since_s).exp());
                *own += flow * tau_s * (1.0 - left);
                ampere += flow * left;
                bent += self.alpha * flow * (relaxed - left) / (1.0 / tau_s - self.rate_per_s);
            }
        }
        let charge = leaked + stored.iter().sum::<f64>();
        Now { ampere, charge, bent }
    }

    /// Charge between two times that are edges, or the end.
    fn flowed(&self, from_s: f64, to_s: f64) -> f64 {
        self.at(to_s - 1e-9).charge - self.at(from_s).charge
    }

    fn end_s(&self, level: usize, last_s: f64) -> f64 {
        self.levels.get(level + 1).map_or(last_s, |next| next.0)
    }

    /// Mean of the curvature over the last quarter of a level.
    fn bent_at_end(&self, level: usize, last_s: f64) -> f64 {
        let (from_s, to_s) = (self.levels[level].0, self.end_s(level, last_s));
        let at = |k: u32| to_s - 0.25 * (to_s - from_s) * (f64::from(k) + 0.5) / 400.0;
        (0..400).map(|k| self.at(at(k)).bent).sum::<f64>() / 400.0
    }
}

fn times(clock: Clock, levels: &[(f64, f64)], random: &mut ChaCha8Rng) -> Vec<f64> {
    let even = |every_s: f64, offset_s: f64| -> Vec<f64> {
        let count = ((REST_S + LASTING_S) / every_s) as usize;
        (0..count)
            .map(|k| every_s * k as f64 - REST_S + offset_s)
            .collect()
    };
    match clock {
        Clock::Stated | Clock::On => even(1.0, 0.0),
        Clock::Beside | Clock::Slow => even(1.0, 0.6),
        Clock::Own => even(1.03, random.random_range(0.0..1.0)),
        Clock::Jitter => {
            let off = |t: f64| t + 0.05 * Distribution::<f64>::sample(&StandardNormal, random);
            even(1.0, 0.6).into_iter().map(off).collect()
        }
        Clock::Lost => {
            let mut kept = even(1.0, 0.6);
            for &(edge_s, _) in levels {
                let (is_lost, lost_s): (bool, f64) = (random.random(), random.random_range(2.0..8.0));
                let from_s = edge_s - lost_s * random.random_range(0.0..1.0);
                kept.retain(|t| !is_lost || !(from_s..from_s + lost_s).contains(t));
            }
            kept
        }
        Clock::Log => {
            let mut found = even(1.0, 0.6);
            found.retain(|t| *t < 0.0);
            for (k, &(edge_s, _)) in levels.iter().enumerate() {
                let end_s = levels.get(k + 1).map_or(LASTING_S, |next| next.0);
                let (mut t, mut every_s) = (edge_s + 0.1 * random.random_range(0.1..1.0), 0.1);
                while t < end_s {
                    found.push(t);
                    t += every_s;
                    every_s = f64::min(1.15 * every_s, 5.0);
                }
            }
            found
        }
    }
}

fn one(name: &str, levels: &[(f64, f64)], clock: Clock, ratio: f64, seed: u64, held: &mut Held) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut about = |value: f64| value * random.random_range(-0.3..0.3_f64).exp();
    let fast_s = about(ratio);
    let slow_s = about((10.0 * ratio).clamp(30.0, 250.0)).max(2.5 * fast_s);
    let slow_ohm = if name == ONE_BRANCH { 1e12 } else { about(1200.0) };
    let circuit = Circuit {
        branches: [(about(300.0), fast_s), (slow_ohm, slow_s)],
        leak_ohm: about(20_000.0),
        alpha: about(20.0),
        rate_per_s: about(0.01),
        levels: levels.to_vec(),
    };
    let segment = |&(start_s, volts): &(f64, f64)| Segment::at(start_s, Level::Voltage(volts));
    let stated = Drive {
        baseline_v: 0.0,
        segments: levels.iter().map(segment).collect(),
    };
    let time_s: Arc<[f64]> = times(clock, levels, &mut random).into();
    let drive = match clock {
        Clock::Stated => stated,
        Clock::Own => stated.as_seen(&times(Clock::Beside, levels, &mut random)),
        _ => stated.as_seen(&time_s),
    };
    let goes_on: f64 = if clock == Clock::Slow { 0.6 } else { 0.0 };
    let mut read = |of: &dyn Fn(f64) -> f64| -> Arc<[f64]> {
        let exact: Vec<f64> = time_s.iter().map(|t| of(*t)).collect();
        let peak = exact.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let mut last: f64 = StandardNormal.sample(&mut random);
        let noisy = |value: &f64| {
            let fresh: f64 = StandardNormal.sample(&mut random);
            last = goes_on * last + (1.0 - goes_on * goes_on).sqrt() * fresh;
            value + NOISE * peak * last
        };
        exact.iter().map(noisy).collect()
    };
    let channels = [
        Channel::new(Quantity::Current, time_s.clone(), read(&|t| circuit.at(t).ampere)),
        Channel::new(Quantity::Curvature, time_s.clone(), read(&|t| circuit.at(t).bent)),
    ];
    let mut record = run("r", "CNaf-01", "air", None, 2.0);
    record.drive = Some(drive);
    record.area_cm2 = Some(0.1);
    let mut add = |quantity: &str, estimate: &Estimate, truth: f64| {
        held.add((name, clock, ratio, quantity), estimate, truth);
        let show = std::env::var("SHOW").unwrap_or_default();
        if show == "all" || !show.is_empty() && !holds(estimate, truth) {
            eprintln!("seed {seed} {name} {clock:?} {ratio} {quantity} {truth:.5e} {estimate:?}");
        }
    };
    let last_s = time_s[time_s.len() - 1];
    let sample = campaign().samples[0].clone();
    let step = model_free(&record, &channels, Some(&sample), &known(MODULUS_MPA, 1e-9));
    if let Some(step) = step {
        let end_s = circuit.end_s(0, last_s);
        add(FIGURES[4].key, &step.values[4], circuit.flowed(0.0, end_s));
        let peak_s = peak_s(&circuit, end_s);
        add(FIGURES[0].key, &step.values[0], circuit.at(peak_s).bent);
        add(FIGURES[1].key, &step.values[1], peak_s);
        let joule = |sign: f64| -> f64 {
            let of = |(k, &(from_s, volts)): (usize, &(f64, f64))| {
                let joule = volts * circuit.flowed(from_s, circuit.end_s(k, last_s));
                if sign * joule > 0.0 { joule.abs() } else { 0.0 }
            };
            1e3 * levels.iter().enumerate().map(of).sum::<f64>()
        };
        let first = 2e3 * circuit.flowed(0.0, end_s);
        let truths = [first, joule(1.0), joule(-1.0), joule(1.0) - joule(-1.0)];
        // Of these drives none gives energy back, which all say.
        (truths.iter().enumerate().filter(|(_, truth)| **truth > 0.0))
            .for_each(|(k, truth)| add(ENERGIES[k].key, &step.energies[k], *truth));
        add(ENERGIES[5].key, &step.energies[5], efficiency(&circuit, end_s));
    }
    let Some(train) = cycle_run(&record, &channels) else {
        return;
    };
    for cycle in &train.cycles {
        let first = levels.partition_point(|(edge_s, _)| *edge_s <= cycle.start_s + 1e-6) - 1;
        let of = |level: usize| circuit.flowed(levels[level].0, circuit.end_s(level, last_s));
        let conducts = circuit.branches.iter().map(|(ohm, _)| ohm.recip()).sum::<f64>();
        let (inward, outward) = (of(first), -of(first + 1));
        let swing = circuit.bent_at_end(first, last_s) - circuit.bent_at_end(first + 1, last_s);
        let truths = [
            0.5 * swing.abs(),
            inward,
            outward,
            100.0 * outward / inward,
            2e3 * inward,
            circuit.alpha,
            (conducts + circuit.leak_ohm.recip()).recip(),
        ];
        for ((figure, estimate), truth) in CYCLE_FIGURES.iter().zip(&cycle.values).zip(truths) {
            add(figure.key, estimate, truth);
        }
    }
}

fn peak_s(circuit: &Circuit, end_s: f64) -> f64 {
    let places = (1..20_000).map(|k| (end_s - 1e-6) * f64::from(k) / 2e4);
    places
        .max_by(|a, b| circuit.at(*a).bent.total_cmp(&circuit.at(*b).bent))
        .unwrap_or(end_s)
}

/// Elastic energy at the peak of the first level over the electrical energy until then, percent.
fn efficiency(circuit: &Circuit, end_s: f64) -> f64 {
    let peak_s = peak_s(circuit, end_s);
    let sample = campaign().samples[0].clone();
    let size = |of: Option<f64>| of.unwrap_or(f64::NAN);
    let (width, thickness) = (size(sample.width_mm), size(sample.thickness_mm));
    let moment = width * thickness.powi(3) / 12.0;
    // N/mm2 times mm4 / mm is N mm, a thousandth of a joule.
    let bent_per_mm = circuit.at(peak_s).bent / 10.0;
    let elastic = 1e-3 * MODULUS_MPA * moment * size(sample.length_mm) * bent_per_mm.powi(2) / 2.0;
    100.0 * elastic / (2.0 * circuit.flowed(0.0, peak_s))
}

/// A log every 30 s whose humidity steps somewhere between two readings, or on one.
fn humidity(seed: u64, held: &mut Held) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (lag_s, tau_s) = (
        [0.0, 0.0, 20.0, 90.0][seed as usize % 4],
        random.random_range(200.0..1500.0),
    );
    let wet_s = 3600.0 + [0.0, 12.0, random.random_range(0.0..30.0)][seed as usize % 3];
    let sigma = random.random_range(0.0005..0.004);
    let time_s: Arc<[f64]> = (0..400).map(|k| 30.0 * f64::from(k)).collect();
    let mut noisy = |of: &dyn Fn(f64) -> f64, size: f64| -> Arc<[f64]> {
        let value = |t: &f64| {
            let own: f64 = StandardNormal.sample(&mut random);
            (if *t < wet_s { of(-1.0) } else { of(t - wet_s) }) + size * own
        };
        time_s.iter().map(value).collect()
    };
    let wetted = |t: f64| {
        if lag_s > 0.0 {
            1.0 - (-t / lag_s).exp()
        } else {
            1.0
        }
    };
    let percent = noisy(&|t| if t < 0.0 { 0.0 } else { 40.0 * wetted(t) }, 0.2);
    let modulus = noisy(&|t| 55.0 + 15.0 * (-t.max(0.0) / tau_s).exp(), 55.0 * sigma);
    let channels = [
        Channel::new(Quantity::ComplexModulus, time_s.clone(), modulus),
        Channel::new(Quantity::RelativeHumidity, time_s.clone(), percent),
        Channel::new(Quantity::Frequency, time_s.clone(), vec![1.0; 400].into()),
    ];
    let Ok(found) = analyse(&channels) else { return };
    let Some(time) = found
        .steps
        .first()
        .and_then(|step| step.estimate(step_keys::EQUILIBRIUM_TIME))
    else {
        return;
    };
    let truth = tau_s * 20f64.ln();
    held.add(
        ("humidity", Clock::Beside, lag_s, "equilibrium_time_s"),
        time,
        truth,
    );
    if std::env::var_os("SHOW").is_some() && !holds(time, truth) {
        eprintln!("seed {seed} humidity {lag_s} {wet_s} {truth:.1} {time:?}");
    }
}

fn holds(estimate: &Estimate, truth: f64) -> bool {
    estimate.low_95.is_none_or(|low| low <= truth) && estimate.high_95.is_none_or(|high| truth <= high)
}

/// What is stated, and how often it holds: intervals and bounds, each stated and held, nothing stated.
#[derive(Default, Clone)]
struct Count {
    intervals: [usize; 2],
    bounds: [usize; 2],
    open: usize,
    widths: Vec<f64>,
}

/// Drive, clock, tau / interval, quantity.
type Place<'a> = (&'a str, Clock, f64, &'a str);

#[derive(Default)]
struct Held {
    counts: BTreeMap<(String, String, String, String), Count>,
}

impl Held {
    fn add(&mut self, (drive, clock, ratio, quantity): Place, estimate: &Estimate, truth: f64) {
        let (clock, ratio) = (format!("{clock:?}"), format!("{ratio:5}"));
        let key = (quantity.to_owned(), drive.to_owned(), clock, ratio);
        let own = self.counts.entry(key).or_default();
        let holds = usize::from(holds(estimate, truth));
        match (estimate.low_95, estimate.high_95) {
            (Some(low), Some(high)) => {
                own.intervals = [own.intervals[0] + 1, own.intervals[1] + holds];
                own.widths.push((high - low) / truth.abs());
            }
            (None, None) => own.open += 1,
            _ => own.bounds = [own.bounds[0] + 1, own.bounds[1] + holds],
        }
    }

    /// The table: over all ratios, over all drives and clocks, and with `ALL` set every row.
    fn print(&self) {
        println!(
            "| quantity | drive | clock | tau / interval | intervals that hold | median width, % | bounds that hold | nothing stated |"
        );
        println!("|---|---|---|---|---|---|---|---|");
        let all = || "all".to_owned();
        self.rows(|(quantity, drive, clock, _)| (quantity.clone(), drive.clone(), clock.clone(), all()));
        self.rows(|(quantity, _, _, ratio)| (quantity.clone(), all(), all(), ratio.clone()));
        if std::env::var_os("ALL").is_some() {
            self.rows(Clone::clone);
        }
    }

    fn rows(&self, key: impl Fn(&(String, String, String, String)) -> (String, String, String, String)) {
        let mut rows: BTreeMap<_, Count> = BTreeMap::new();
        for (place, count) in &self.counts {
            let row = rows.entry(key(place)).or_default();
            for k in 0..2 {
                row.intervals[k] += count.intervals[k];
                row.bounds[k] += count.bounds[k];
            }
            row.open += count.open;
            row.widths.extend(&count.widths);
        }
        let share = |[all, held]: [usize; 2]| match all {
            0 => "-".to_owned(),
            all => format!("{held} of {all} ({:.1} %)", 100.0 * held as f64 / all as f64),
        };
        for ((quantity, drive, clock, ratio), count) in &rows {
            let mut widths = count.widths.clone();
            widths.sort_by(f64::total_cmp);
            let width = widths
                .get(widths.len() / 2)
                .map_or(String::new(), |width| format!("{:.1}", 100.0 * width));
            println!(
                "| {quantity} | {drive} | {clock} | {ratio} | {} | {width} | {} | {} |",
                share(count.intervals),
                share(count.bounds),
                count.open
            );
        }
    }
}
