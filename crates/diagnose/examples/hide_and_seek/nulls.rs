//! Groups in which nothing is wrong, measured in the ways of laboratories: how often the alarm is false.

use std::collections::BTreeMap;

use ieap_domain::testing::clocks::LabClock;
use ieap_domain::{GroupDiagnosis, Verdict};

use crate::case::{Clock, Drives, Plan, Readings, Slow, case, diagnose, true_responses};
use crate::each;

/// Seeds of a condition are so far from those of the next.
const APART: u64 = 10_000;

/// What laboratories' clocks do beside the edges, under steps and under pulses: groups of 5 x 700 readings.
fn laboratories() -> Vec<(String, Plan)> {
    let of = |(clock, name): (LabClock, &str)| {
        [(Drives::Steps, "steps"), (Drives::Pulses, "pulses")].map(|(drives, of)| {
            let plan = Plan {
                drives,
                clock: Clock::Lab(clock),
                count: 680,
                autocorrelation: Some(0.0),
                ..Plan::default()
            };
            (format!("{name}, {of}"), plan)
        })
    };
    LabClock::ALL.into_iter().flat_map(of).collect()
}

/// Conditions with their names. What is not said is as in the first.
pub fn conditions() -> Vec<(&'static str, Plan)> {
    let own = Plan::default();
    let white = Plan {
        autocorrelation: Some(0.0),
        ..own
    };
    let long = |count, rate_hz, edges| Plan {
        count,
        rate_hz,
        edges,
        ..white
    };
    let clock = |clock| Plan { clock, ..white };
    let slow = |slow| Plan { slow, ..white };
    let driven = |drives, plan| Plan { drives, ..plan };
    let step = |plan| driven(Drives::Step, plan);
    vec![
        ("600 readings, on the edges, correlations 0 to 0.8", own),
        ("3600 readings, 1 Hz", long(3_600, 1.0, 30)),
        ("36000 readings, 1 Hz", long(36_000, 1.0, 30)),
        ("3600 readings, 10 Hz", long(3_600, 10.0, 30)),
        ("36000 readings, 10 Hz", long(36_000, 10.0, 30)),
        ("36000 readings, 100 Hz", long(36_000, 100.0, 30)),
        ("3600 readings, 100 edges", long(3_600, 1.0, 100)),
        ("36000 readings, 1000 edges", long(36_000, 1.0, 1000)),
        ("beside the edges", clock(Clock::Beside)),
        (
            "beside the edges, 3600 readings, 10 Hz",
            Plan {
                clock: Clock::Beside,
                ..long(3_600, 10.0, 30)
            },
        ),
        (
            "zero of the current another in each run",
            Plan {
                zero: 0.0015,
                ..clock(Clock::Irregular)
            },
        ),
        (
            "laser drifts by 1 %",
            Plan {
                drift: 0.01,
                ..clock(Clock::Irregular)
            },
        ),
        ("irregular", clock(Clock::Irregular)),
        ("irregular, on the edges", clock(Clock::IrregularOnEdges)),
        ("red noise of 30 s", slow(Slow::Red(30.0))),
        ("1/f noise", slow(Slow::OneOverF)),
        (
            "quantised",
            Plan {
                readings: Readings::Quantised,
                ..white
            },
        ),
        (
            "2 % outliers",
            Plan {
                outliers: 0.02,
                ..white
            },
        ),
        ("one run", step(white)),
        ("one run, 3600 readings", step(long(3_600, 1.0, 30))),
        ("one run, 36000 readings, 10 Hz", step(long(36_000, 10.0, 30))),
        ("one run, beside the edge", step(clock(Clock::Beside))),
        ("one run, red noise of 30 s", step(slow(Slow::Red(30.0)))),
        (
            "one run, 2 % outliers",
            step(Plan {
                outliers: 0.02,
                ..white
            }),
        ),
        (
            "runs scatter by 1 %",
            Plan {
                scatter: 0.01,
                ..white
            },
        ),
        ("runs scatter by 3 %", Plan { scatter: 0.03, ..own }),
        ("sine, chirp and triangle", driven(Drives::Moving, own)),
        ("one sine", driven(Drives::Sine, white)),
        ("two steps and a sine", driven(Drives::StepsAndSine, own)),
        (
            "sine, chirp and triangle, irregular",
            driven(Drives::Moving, clock(Clock::Irregular)),
        ),
        (
            "sine, chirp and triangle, red noise of 30 s",
            driven(Drives::Moving, slow(Slow::Red(30.0))),
        ),
        (
            "three repeats scatter by 1 %",
            Plan {
                scatter: 0.01,
                drives: Drives::Same,
                ..white
            },
        ),
        (
            "two steps and a sine, beside the edges",
            driven(Drives::StepsAndSine, clock(Clock::Beside)),
        ),
        (
            "two steps and a sine, 2 % outliers",
            driven(
                Drives::StepsAndSine,
                Plan {
                    outliers: 0.02,
                    ..white
                },
            ),
        ),
        (
            "two steps and a sine, runs scatter by 1 %",
            driven(
                Drives::StepsAndSine,
                Plan {
                    scatter: 0.01,
                    ..white
                },
            ),
        ),
        (
            "sine, chirp and triangle, 2 % outliers",
            driven(
                Drives::Moving,
                Plan {
                    outliers: 0.02,
                    ..white
                },
            ),
        ),
        (
            "sine, chirp and triangle, 3600 readings, 10 Hz",
            driven(Drives::Moving, long(3_600, 10.0, 30)),
        ),
        (
            "one sine, 36000 readings, 10 Hz",
            driven(Drives::Sine, long(36_000, 10.0, 30)),
        ),
    ]
}

/// Counts `count` groups of every condition whose name holds one of `only`.
pub fn nulls(first: u64, count: u64, only: &[String]) {
    println!(
        "| condition | groups | p < 0.01 | p < 0.05 | p < 0.5 | distance from uniform (5 % point) | verdicts |"
    );
    println!("|---|---|---|---|---|---|---|");
    let conditions = conditions()
        .into_iter()
        .map(|(name, plan)| (name.to_owned(), plan));
    for (place, (name, plan)) in conditions.chain(laboratories()).enumerate() {
        if !only.is_empty() && !only.iter().any(|part| name.contains(part.as_str())) {
            continue;
        }
        let began = std::time::Instant::now();
        let found = diagnosed(first + APART * place as u64, count, plan);
        println!("{}", row(&name, &found));
        eprintln!(
            "{name}: {:.1} s a group",
            began.elapsed().as_secs_f64() / found.len().max(1) as f64
        );
    }
}

/// Groups with p below 0.05, and groups that were given a name, among so many of the first condition.
pub fn own(first: u64, count: u64) -> (usize, usize) {
    let found = diagnosed(first, count, Plan::default());
    println!("{}", row("as the library's own", &found));
    let named = found.iter().filter(|found| found.verdict == Verdict::Law);
    (below(&found, 0.05), named.count())
}

/// Groups in which a misfit is told, among so many of each of the conditions that laboratories measure in and that the first
/// has not.
pub fn of_laboratories(first: u64, count: u64) -> (usize, usize) {
    let (mut told, mut among) = (0, 0);
    for (place, (name, plan)) in (0..).zip(conditions()) {
        if ![
            "beside the edges",
            "red noise of 30 s",
            "runs scatter by 1 %",
            "three repeats scatter by 1 %",
            "zero of the current another in each run",
            "laser drifts by 1 %",
        ]
        .contains(&name)
        {
            continue;
        }
        let found = diagnosed(first + APART * place, count, plan);
        println!("{}", row(name, &found));
        // Of runs that scatter it is true that they differ; of repeats that is known to be scatter, and no finding.
        let is_true =
            |found: &&GroupDiagnosis| name == "runs scatter by 1 %" && found.verdict == Verdict::Differs;
        let misfits = found.iter().filter(|found| found.verdict.is_misfit());
        told += misfits.filter(|found| !is_true(found)).count();
        among += found.len();
    }
    (told, among)
}

fn diagnosed(first: u64, count: u64, plan: Plan) -> Vec<GroupDiagnosis> {
    let seeds: Vec<u64> = (first..first + count).collect();
    each(&seeds, |&seed| {
        let mut case = case(seed, plan);
        let plain = true_responses(&case, &[])?;
        let found = diagnose(&mut case, &plain, None);
        if std::env::var_os("SHOW").is_some() && found.p_misfit.is_none_or(|p| p < 0.05) {
            println!(
                "seed {seed} p {:?} {:?} {}",
                found.p_misfit, found.set, found.sentence
            );
        }
        Some(found)
    })
}

fn below(found: &[GroupDiagnosis], limit: f64) -> usize {
    found
        .iter()
        .filter(|found| found.p_misfit.is_some_and(|p| p < limit))
        .count()
}

fn row(name: &str, found: &[GroupDiagnosis]) -> String {
    let mut ps: Vec<f64> = found.iter().filter_map(|found| found.p_misfit).collect();
    ps.sort_by(f64::total_cmp);
    let n = ps.len() as f64;
    let off = ps
        .iter()
        .enumerate()
        .map(|(k, p)| (p - (k as f64 + 0.5) / n).abs());
    let distance = off.fold(0.0, f64::max);
    let mut verdicts: BTreeMap<&str, usize> = BTreeMap::new();
    let of = |found: &GroupDiagnosis| -> &'static str { Verdict::key(found.verdict) };
    for found in found {
        *verdicts.entry(of(found)).or_default() += 1;
    }
    let told: Vec<String> = verdicts
        .iter()
        .map(|(key, count)| format!("{count} {key}"))
        .collect();
    let percent = |limit: f64| 100.0 * below(found, limit) as f64 / found.len().max(1) as f64;
    format!(
        "| {name} | {} | {:.1} % | {:.1} % | {:.0} % | {distance:.3} ({:.3}) | {} |",
        found.len(),
        percent(0.01),
        percent(0.05),
        percent(0.5),
        1.36 / n.sqrt(),
        told.join(", ")
    )
}
