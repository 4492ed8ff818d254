//! Trains whose numbers are known in closed form: a resistor and a capacitor that age, and a curvature per charge.

use std::sync::Arc;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::*;
use ieap_domain::Segment;
use ieap_domain::testing::run;

const R_OHM: f64 = 100.0;
const C_F: f64 = 0.02;
const ALPHA: f64 = 5.0;
/// Half of a period, s: 2 time constants.
const HALF_S: f64 = 4.0;
const EVERY_S: f64 = 0.1;

/// Cycles of +1 V and -1 V on a resistor before a capacitor, with a curvature per charge that falls by `fade` a cycle.
/// The charge is exact, step by step.
fn square_train(cycles: usize, fade: f64, noise: f64, seed: u64) -> (Drive, Vec<Channel>) {
    train_beside(0.0, 0.0, (cycles, fade), (noise, seed))
}

/// The same with readings so long after the edges, and a leak of that conductance, which bends nothing.
fn train_beside(
    offset_s: f64,
    leak_s: f64,
    (cycles, fade): (usize, f64),
    (noise, seed): (f64, u64),
) -> (Drive, Vec<Channel>) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    let levels = (0..2 * cycles).map(|k| if k % 2 == 0 { 1.0 } else { -1.0 });
    let drive = Drive {
        baseline_v: 0.0,
        segments: levels
            .clone()
            .enumerate()
            .map(|(k, volts)| Segment::at(HALF_S * k as f64, Source::Voltage(volts)))
            .collect(),
    };
    let (mut time_s, mut ampere, mut bent) = (Vec::new(), Vec::new(), Vec::new());
    let mut charge = 0.0;
    for (k, volts) in levels.enumerate() {
        let alpha = ALPHA * (1.0 - fade * (k / 2) as f64);
        let steps = (HALF_S / EVERY_S).round() as usize;
        for step in 0..steps {
            let t = EVERY_S * step as f64 + offset_s;
            let now = C_F * volts + (charge - C_F * volts) * (-t / (R_OHM * C_F)).exp();
            time_s.push(HALF_S * k as f64 + t);
            ampere.push((volts - now / C_F) / R_OHM + leak_s * volts + noise * 0.01 * normal());
            bent.push(alpha * now + noise * 0.1 * normal());
        }
        charge = C_F * volts + (charge - C_F * volts) * (-HALF_S / (R_OHM * C_F)).exp();
    }
    let time: Arc<[f64]> = time_s.into();
    let channels = vec![
        Channel::new(Quantity::Current, time.clone(), ampere.into()),
        Channel::new(Quantity::Curvature, time, bent.into()),
    ];
    (drive, channels)
}

fn told(drive: Drive, channels: &[Channel]) -> Option<CycleRun> {
    let mut made = run("r", "CNaf-01", "air", None, 1.0);
    made.drive = Some(drive);
    cycle_run(&made, channels)
}

/// In the lasting cycle the charge goes from -q to q with q = C tanh(half / (2 R C)): closed form.
fn lasting_charge() -> f64 {
    C_F * (HALF_S / (2.0 * R_OHM * C_F)).tanh()
}

#[test]
fn a_square_train_has_the_numbers_of_its_circuit() {
    let (drive, channels) = square_train(40, 0.0, 1e-6, 1);
    let found = told(drive, &channels).unwrap();
    // The last level has no end but the last reading.
    assert!((39..=40).contains(&found.cycles.len()), "{}", found.cycles.len());
    let values = &found.cycles[20].values;
    let value = |k: usize| values[k].value.unwrap();
    let q = lasting_charge();
    assert!(
        (value(1) / (2.0 * q) - 1.0).abs() < 0.01,
        "charge in {}",
        value(1)
    );
    assert!(
        (value(2) / (2.0 * q) - 1.0).abs() < 0.01,
        "charge out {}",
        value(2)
    );
    assert!((value(3) - 100.0).abs() < 0.1, "efficiency {}", value(3));
    // Each half gives 1 V 2 q to the resistor: 4 q in all.
    assert!(
        (value(4) / (4e3 * q) - 1.0).abs() < 0.01,
        "energy {} mJ",
        value(4)
    );
    assert!((value(5) / ALPHA - 1.0).abs() < 0.005, "alpha {}", value(5));
    assert!((value(6) / R_OHM - 1.0).abs() < 0.03, "R {}", value(6));
    // The mean over the last quarter of a level, in closed form.
    let tau = R_OHM * C_F;
    let left = tau * ((-0.75 * HALF_S / tau).exp() - (-HALF_S / tau).exp()) / (0.25 * HALF_S);
    let amplitude = ALPHA * (C_F - (C_F + q) * left);
    assert!(
        (value(0) / amplitude - 1.0).abs() < 0.02,
        "amplitude {}",
        value(0)
    );
}

/// Between readings, on them, and beside a leak: the intervals hold what the circuit does, and alpha is that of what is stored.
#[test]
fn edges_between_readings_and_a_leak_move_no_number() {
    let leak_s = 2e-3;
    for offset_s in [0.0, 0.04, 0.08] {
        let (drive, channels) = train_beside(offset_s, leak_s, (20, 0.0), (0.003, 7));
        let found = told(drive.as_seen(&channels[0].time_s), &channels).unwrap();
        let q = 2.0 * lasting_charge() + leak_s * HALF_S;
        let truths = [(1, q), (2, q), (3, 100.0), (4, 2e3 * q), (5, ALPHA)];
        for (k, truth) in truths {
            let held = found.cycles[4..].iter().filter(|cycle| {
                let own = &cycle.values[k];
                own.low_95.unwrap() <= truth && truth <= own.high_95.unwrap()
            });
            let (held, of) = (held.count(), found.cycles.len() - 4);
            assert!(
                held + 2 >= of,
                "{offset_s}, {}: {held} of {of}",
                CYCLE_FIGURES[k].key
            );
            let value = found.cycles[10].values[k].value.unwrap();
            assert!(
                (value / truth - 1.0).abs() < 0.08,
                "{offset_s}: {value} for {truth}"
            );
        }
        // At the edge itself, of which a faster current may have gone by.
        let resistance = (1.0 / R_OHM + leak_s).recip();
        let own = &found.cycles[10].values[6];
        assert!(own.high_95.unwrap() >= resistance, "{own:?} for {resistance}");
    }
}

/// Intervals of a cycle over all cycles and seeds hold what the noiseless train gives, and a fade is told with its size.
#[test]
fn intervals_of_cycles_hold_and_a_fade_is_told() {
    let (cycles, fade) = (60, 0.002);
    let (drive, channels) = square_train(cycles, fade, 0.0, 0);
    let truth = told(drive, &channels).unwrap();
    let mut held = [(0usize, 0usize); 7];
    for seed in 0..20 {
        let (drive, channels) = square_train(cycles, fade, 0.02, seed);
        let found = told(drive, &channels).unwrap();
        for (own, exact) in found.cycles.iter().zip(&truth.cycles) {
            for ((own, exact), held) in own.values.iter().zip(&exact.values).zip(&mut held) {
                let exact = exact.value.unwrap();
                held.1 += 1;
                held.0 += usize::from(own.low_95.unwrap() <= exact && exact <= own.high_95.unwrap());
            }
        }
        let amplitude = found.sentences.iter().find(|sentence| sentence.starts_with("κ̂"));
        let amplitude = amplitude.unwrap_or_else(|| panic!("{seed}: {:?}", found.sentences));
        assert!(amplitude.contains("falls by 1"), "{amplitude}");
    }
    for ((held, of), figure) in held.into_iter().zip(CYCLE_FIGURES) {
        let share = held as f64 / of as f64;
        assert!((0.92..=0.99).contains(&share), "{}: {held} of {of}", figure.key);
    }
}

#[test]
fn a_steady_train_has_no_trend_and_other_drives_are_none() {
    let mut shown: Vec<String> = Vec::new();
    for seed in 0..10 {
        let (drive, channels) = square_train(40, 0.0, 0.02, 100 + seed);
        shown.extend(told(drive, &channels).unwrap().sentences);
    }
    // Seven numbers of ten trains, each shown by chance in one of a hundred: four or more in one of two hundred.
    eprintln!("{shown:?}");
    assert!(shown.len() <= 3, "{shown:#?}");
    let (_, channels) = square_train(10, 0.0, 0.02, 1);
    assert!(told(Drive::step(1.0), &channels).is_none());
}

/// A sine on the same circuit: charge, phase and losses in closed form.
#[test]
fn a_sine_has_the_numbers_of_its_circuit() {
    let (period_s, every_s, cycles) = (10.0, 0.1, 12);
    let omega = std::f64::consts::TAU / period_s;
    let count = (f64::from(cycles) * period_s / every_s) as usize;
    let time_s: Vec<f64> = (0..count).map(|k| every_s * k as f64).collect();
    let volts: Vec<f64> = time_s.iter().map(|t| (omega * t).sin()).collect();
    let (re, im) = (R_OHM, -1.0 / (omega * C_F));
    let size = re.hypot(im);
    let lead = -im.atan2(re);
    let ampere: Arc<[f64]> = time_s.iter().map(|t| (omega * t + lead).sin() / size).collect();
    let bent: Arc<[f64]> = time_s
        .iter()
        .map(|t| -ALPHA * (omega * t + lead).cos() / (size * omega))
        .collect();
    let drive = Drive::staircase(&time_s, &volts, 0.0);
    let time: Arc<[f64]> = time_s.into();
    let channels = [
        Channel::new(Quantity::Current, time.clone(), ampere),
        Channel::new(Quantity::Curvature, time, bent),
    ];
    let found = told(drive, &channels).unwrap();
    assert!(found.cycles.len() >= 9, "{}", found.cycles.len());
    let values = &found.cycles[5].values;
    let expected = [
        ALPHA / (size * omega),
        2.0 / (size * omega),
        2.0 / (size * omega),
        100.0,
        1e3 * std::f64::consts::PI * re / (size * size * omega),
        ALPHA,
        size,
    ];
    for ((own, expected), figure) in values.iter().zip(expected).zip(CYCLE_FIGURES) {
        let value = own.value.unwrap_or_else(|| panic!("{}: {own:?}", figure.key));
        assert!(
            (value / expected - 1.0).abs() < 0.02,
            "{}: {value} for {expected}",
            figure.key
        );
    }
}
