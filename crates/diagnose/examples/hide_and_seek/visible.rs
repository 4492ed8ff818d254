//! Whether an error of the size that a diagnosis says it would have seen is seen.

use ieap_diagnose::{DiagnoseOptions, diagnose_group};
use ieap_domain::{Channel, Drive};
use rand::RngExt;

use crate::case::{Case, Clock, Drives, Plan, Slow, case, inputs, measured, true_responses};
use crate::each;

/// Bumps of an error over the logarithm of the time since an edge, an octave and a half apart.
const BUMPS: usize = 12;
const APART: f64 = 1.04;

/// Counts `count` groups of every way to measure: the same noise with nothing wrong, then with an error of the size that is said.
pub fn visible(first: u64, count: u64) {
    println!(
        "| condition | groups | error of the current, % of its range (median) | of the curvature | error of the current seen | of the curvature seen |"
    );
    println!("|---|---|---|---|---|---|");
    let white = Plan {
        autocorrelation: Some(0.0),
        ..Plan::default()
    };
    let plans = [
        ("five drives, correlations 0 to 0.8", Plan::default()),
        ("3600 readings", Plan { count: 3600, ..white }),
        (
            "beside the edges",
            Plan {
                clock: Clock::Beside,
                ..white
            },
        ),
        (
            "1/f noise",
            Plan {
                slow: Slow::OneOverF,
                ..white
            },
        ),
        (
            "one run",
            Plan {
                drives: Drives::Step,
                ..white
            },
        ),
    ];
    for (place, (name, plan)) in plans.into_iter().enumerate() {
        let seeds: Vec<u64> = (0..count).map(|k| first + 10_000 * place as u64 + k).collect();
        let found = each(&seeds, |&seed| seen(seed, plan));
        let of = |channel: usize| {
            let mut sizes: Vec<f64> = found.iter().map(|own| own[channel].0).collect();
            sizes.sort_by(f64::total_cmp);
            let seen = found.iter().filter(|own| own[channel].1).count();
            (
                sizes.get(sizes.len() / 2).copied().unwrap_or(f64::NAN),
                100.0 * seen as f64 / found.len().max(1) as f64,
            )
        };
        let [current, curvature] = [0, 1].map(of);
        println!(
            "| {name} | {} | {:.2} | {:.2} | {:.0} % | {:.0} % |",
            found.len(),
            current.0,
            curvature.0,
            current.1,
            curvature.1
        );
    }
}

/// For each channel the size that is said, and whether an error of it is seen.
fn seen(seed: u64, plan: Plan) -> Option<[(f64, bool); 2]> {
    let mut own = case(seed, plan);
    let plain = true_responses(&own, &[])?;
    let clean = measured(&mut own, &plain);
    let diagnosed = |case: &Case, runs: &[Vec<Channel>]| {
        diagnose_group("case", &inputs(case, runs), &DiagnoseOptions::default())
    };
    let said = diagnosed(&own, &clean).visible_percent;
    let sizes = [said.current?, said.curvature?];
    let found = [0, 1].map(|channel| {
        let range = |runs: &[Vec<Channel>]| {
            let all = runs
                .iter()
                .map(|run| ieap_domain::range_of(run[channel].values.iter().copied()));
            all.map(|(low, high)| high - low).fold(0.0, f64::max)
        };
        let size = 0.01 * sizes[channel] * range(&clean);
        let signs: Vec<f64> = (0..BUMPS)
            .map(|_| if own.generator.random_bool(0.5) { 1.0 } else { -1.0 })
            .collect();
        let mut wrong = clean.clone();
        for (run, design) in wrong.iter_mut().zip(&own.design) {
            add_error(&mut run[channel], &design.drive, size, &signs, own.plan.rate_hz);
        }
        let p = diagnosed(&own, &wrong).p_misfit;
        (sizes[channel], p.is_some_and(|p| p < 0.05))
    });
    Some(found)
}

/// Adds a smooth course over the logarithm of the time since each edge, `size` at most readings.
fn add_error(channel: &mut Channel, drive: &Drive, size: f64, signs: &[f64], rate_hz: f64) {
    let error = |t: f64| {
        let Some(edge) = drive.segments.iter().rev().find(|segment| segment.start_s() <= t) else {
            return 0.0;
        };
        let place = (1.0 + (t - edge.start_s()) * rate_hz).ln() / APART;
        let each = signs.iter().enumerate().map(|(bump, sign)| {
            let bell = (-0.5 * (place - bump as f64).powi(2)).exp();
            (sign * bell, bell * bell)
        });
        let (sum, square) = each.fold((0.0, 0.0), |sums, own| (sums.0 + own.0, sums.1 + own.1));
        size * sum / f64::sqrt(square)
    };
    let readings = channel.time_s.iter().zip(channel.values.iter());
    channel.values = readings.map(|(&t, value)| value + error(t)).collect();
}
