//! Groups in which nothing is hidden and the noise is as slow as a record is long.

use ieap_diagnose::{DiagnoseOptions, diagnose_group};
use ieap_domain::Channel;
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::benchmark::each;
use crate::case::{Plan, case, inputs, measured, responses};
use crate::verdicts::Count;

/// Exponents of the slow noise's spectrum, 1/f^exponent.
const EXPONENTS: [f64; 2] = [1.0, 2.0];
/// Its standard deviation in units of the white noise's.
const SIZES: [f64; 3] = [0.5, 2.0, 8.0];
/// Waves that it is made of; the slowest goes half round in a record.
const WAVES: usize = 300;

/// Counts `count` groups of every spectrum and size.
pub fn rednoise(first: u64, count: u64) {
    let mut rows = Vec::new();
    for (kind, exponent) in EXPONENTS.iter().enumerate() {
        for (place, size) in SIZES.iter().enumerate() {
            let own = first + 10_000 * kind as u64 + 1000 * place as u64;
            let seeds: Vec<u64> = (own..own + count).collect();
            let found = each(&seeds, |&seed| {
                let plan = Plan {
                    autocorrelation: Some(0.0),
                    ..Plan::default()
                };
                let mut case = case(seed, plan);
                let plain = responses(&case, &[]);
                let mut runs = measured(&mut case, &plain);
                let sds = [case.noise.current_a, case.noise.curvature_per_cm];
                for run in &mut runs {
                    for (channel, sd) in run.iter_mut().zip(sds) {
                        add_slow(channel, size * sd, *exponent, &mut case.generator);
                    }
                }
                Some(diagnose_group(
                    "case",
                    &inputs(&case, &runs),
                    &DiagnoseOptions::default(),
                ))
            });
            let what = format!("1/f^{exponent}, {size} times the white noise");
            eprintln!("{what}: {} groups", found.len());
            let mut count = Count::default();
            found.iter().for_each(|found| count.add(found, None));
            rows.push(format!("{} {} |", count.row(&what), count.called()));
        }
    }
    println!("{}", Count::heading_with("slow noise", &["wrong names"]));
    rows.iter().for_each(|row| println!("{row}"));
}

/// Adds a Gaussian series of that standard deviation and spectrum.
pub fn add_slow(channel: &mut Channel, sd: f64, exponent: f64, generator: &mut impl Rng) {
    let last_s = channel.time_s.iter().copied().fold(0.0, f64::max);
    let powers: Vec<f64> = (1..=WAVES).map(|k| (k as f64).powf(-exponent)).collect();
    let whole: f64 = powers.iter().sum();
    let waves: Vec<(f64, f64, f64)> = powers
        .iter()
        .zip(1..)
        .map(|(power, k)| {
            let size = sd * (power / whole).sqrt();
            let (even, odd): (f64, f64) = (
                StandardNormal.sample(&mut *generator),
                StandardNormal.sample(&mut *generator),
            );
            (
                std::f64::consts::PI * f64::from(k) / last_s,
                size * even,
                size * odd,
            )
        })
        .collect();
    let slow = |t: f64| -> f64 {
        let each = waves.iter().map(|(turning, even, odd)| {
            let (sine, cosine) = (turning * t).sin_cos();
            even * cosine + odd * sine
        });
        each.sum()
    };
    let readings = channel.time_s.iter().zip(channel.values.iter());
    channel.values = readings.map(|(t, value)| value + slow(*t)).collect();
}
