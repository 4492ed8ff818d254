//! What alarms name where only resistances jump: campaigns of the truth simulator, each run fitted as one of a lab is.

use std::sync::Arc;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

use super::{Evidence, monitor};
use crate::laws::doubt::Doubts;
use crate::laws::facts::facts;
use ieap_domain::testing::{campaign, run, tag};
use ieap_domain::{Alarm, AlarmSign, Branch, Channel, Drive, Quantity, RunRecord};
use ieap_fit::{FitInput, FitOptions, fit_run};
use ieap_truth::{ChannelNoise, Truth, noise, simulate};

/// R1, C1, R2, C2, R_ss, alpha, lambda and step voltage of rows of the thesis's table 5.
const ROWS: [[f64; 8]; 4] = [
    [521.4, 0.098, 2629.9, 0.13, 5660.0, 13.88, 3.8e-4, 2.0],
    [92.8, 0.137, 1533.7, 0.06, 67590.0, 17.57, 9.4e-5, 2.5],
    [158.1, 0.146, 638.1, 0.17, 1910.0, 12.28, 1.8e-3, 2.5],
    [20.7, 0.067, 37.8, 1.87, 1000.0, 3.41, 1.1e-4, 2.0],
];
const AREA_CM2: f64 = 0.1;
const RUNS: usize = 40;
/// Scatter of every parameter from run to run.
const SCATTER: f64 = 0.01;

/// A run of an hour, with noise of that part of the peak, fitted.
fn fitted(place: usize, row: &[f64; 8], noise_part: f64, seed: u64) -> RunRecord {
    let time_s: Arc<[f64]> = (0..600).map(|k| 6.0 * f64::from(k) + 0.3).collect();
    let branch = |k: usize| Branch {
        resistance_ohm_cm2: row[2 * k],
        capacitance_f_per_cm2: row[2 * k + 1],
    };
    let truth = Truth {
        branches: vec![branch(0), branch(1)],
        steady_state_resistance_ohm_cm2: row[4],
        charge_to_curvature_per_c_cm: row[5],
        relaxation_rate_per_s: row[6],
        area_cm2: AREA_CM2,
        length_cm: None,
        width_cm: None,
        effects: Vec::new(),
    };
    let drive = Drive::step(row[7]);
    let exact = simulate(&truth, &drive, &time_s, &time_s, place).unwrap();
    let channel = |quantity, signal: &[f64], stream| {
        let peak = signal.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let kind = ChannelNoise {
            standard_deviation: noise_part * peak,
            ..ChannelNoise::default()
        };
        Channel::new(
            quantity,
            time_s.clone(),
            noise(signal, &kind, seed, stream).into(),
        )
    };
    let stream = 2 * place as u64;
    let channels = [
        channel(Quantity::Current, &exact.current_a, stream),
        channel(Quantity::Curvature, &exact.curvature_per_cm, stream + 1),
    ];
    let input = FitInput {
        channels: &channels,
        drive: &drive,
        area_cm2: AREA_CM2,
    };
    let mut record = run(&format!("r{place:02}"), "S1", "air", Some(35.0), row[7]);
    record.tags.push(tag("cycle", &place.to_string()));
    record.fit = fit_run(&input, &FitOptions::default()).ok();
    record
}

/// The alarms of a campaign in which R1, or R1 and R2, jump by 1.3 to 3 either way, or nothing does; with the factor.
fn alarms(jumps: bool, noise_part: f64, seed: u64) -> (f64, Vec<Alarm>) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let row = ROWS[random.random_range(0..ROWS.len())];
    let at = random.random_range(12..30);
    let size: f64 = random.random_range(1.3_f64.ln()..3.0_f64.ln());
    let (rises, both): (bool, bool) = (random.random(), random.random());
    let factor = match (jumps, rises) {
        (false, _) => 1.0,
        (true, true) => size.exp(),
        (true, false) => (-size).exp(),
    };
    let runs: Vec<RunRecord> = (0..RUNS)
        .map(|place| {
            let mut own = row;
            for value in &mut own[..7] {
                let by: f64 = StandardNormal.sample(&mut random);
                *value *= (SCATTER * by).exp();
            }
            if place >= at {
                own[0] *= factor;
                own[2] *= if both { factor } else { 1.0 };
            }
            fitted(place, &own, noise_part, seed)
        })
        .collect();
    let campaign = campaign();
    let facts = facts(&runs, &campaign);
    let doubts = Doubts::default();
    let evidence = Evidence {
        runs: &runs,
        campaign: &campaign,
        facts: &facts,
        doubts: &doubts,
    };
    (factor, monitor(evidence).alarms)
}

/// Whether the change that a sign states holds the factor.
fn holds(sign: &AlarmSign, factor: f64) -> bool {
    let change = sign.change.as_ref();
    change.is_some_and(|one| one.low_95.unwrap() <= factor && factor <= one.high_95.unwrap())
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn a_jump_of_resistances_raises_no_alarm_of_others() {
    // Chance alone brings an alarm in 40 of 500 runs, of which some name others than resistances: 8 of 100 at most. More
    // than these come by chance in one of 1,000 tries.
    let (kinds, draws, most): (&[(bool, f64)], u64, usize) = match std::env::var_os("IEAP_LONG") {
        Some(_) => (
            &[(false, 0.005), (true, 0.005), (false, 0.03), (true, 0.03)],
            100,
            18,
        ),
        None => (&[(true, 0.005)], 10, 4),
    };
    for &(jumps, noise_part) in kinds {
        let all: Vec<(f64, Vec<Alarm>)> = (0..draws)
            .into_par_iter()
            .map(|k| alarms(jumps, noise_part, 83_000 + k))
            .collect();
        let signs = |(_, alarms): &(f64, Vec<Alarm>)| -> Vec<AlarmSign> {
            alarms.iter().flat_map(|alarm| alarm.shown_by.clone()).collect()
        };
        let with = |begins: &[&str]| {
            let is = |sign: &AlarmSign| begins.iter().any(|begin| sign.parameter.starts_with(begin));
            all.iter().filter(|one| signs(one).iter().any(is)).count()
        };
        let told = all
            .iter()
            .flat_map(|one| signs(one).into_iter().map(move |sign| (one.0, sign)));
        let of_r1: Vec<(f64, AlarmSign)> = told
            .filter(|(_, sign)| sign.parameter == "r1_ohm_cm2" && sign.chart == "jump")
            .collect();
        let held = of_r1.iter().filter(|(factor, sign)| holds(sign, *factor)).count();
        let others = with(&["c", "alpha", "lambda"]);
        println!(
            "jump {jumps}, noise {noise_part}: of {draws} campaigns alarms name a resistance in {}, a capacitance in {}, \
             any other in {others}; {held} of {} jumps of R1 held",
            with(&["r"]),
            with(&["c"]),
            of_r1.len()
        );
        if let Some(alarm) = all.iter().find_map(|(_, alarms)| alarms.last()) {
            println!("{}", alarm.message);
        }
        assert!(others <= most, "{others}");
    }
}
