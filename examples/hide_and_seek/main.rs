//! Hides effects in simulated groups of runs and counts what a diagnosis makes of them.
//!
//! `cargo run --release --example hide_and_seek -- null 500 [first seed]`, `-- effects 5 8,16,32 [id ...]`, `-- outside 8 16,64`, or
//! `-- benchmark 2 9000000 docs/benchmark.svg`, which asks textbook criteria and a linear oracle as well, or
//! `-- short`, which fails where a few groups of each kind come out worse than chance would have them.
//!
//! Environment: `SHOW=1` and `NOISE=1` print details (`SHOW=wrong` of wrong names only, `SHOW=strength` of strengths
//! outside of their intervals); `DRIVES=step` or `discharge` takes one or two runs in place of five; `STRENGTHS=16,32` and
//! `DRIVES=five` take a part of the benchmark's table of single causes; `READINGS=uneven`, `quantised` or `outliers` (1 %, ten
//! standard deviations off) says how groups are read; `GROWING=1` lets the noise at the largest signal
//! of a run be `sqrt(1 + GROWING^2)` times that at none. `FIRST` is the first seed of `effects` (1000 without it).

mod benchmark;
mod case;
mod count;
mod details;
mod faults;
mod figure;
mod hidden;
mod methods;
mod oracle;

use count::{effects, nulls, outsides};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let count: u64 = arguments.get(1).and_then(|n| n.parse().ok()).unwrap_or(20);
    match arguments.first().map(String::as_str) {
        Some("null") => {
            let first = arguments.get(2).and_then(|n| n.parse().ok()).unwrap_or(0);
            let _ = nulls(first, count);
        }
        Some("benchmark") => benchmark::benchmark(&extent(&arguments, count)),
        Some("figure") => {
            // From printed tables: a run of the benchmark takes long.
            let text = std::io::read_to_string(std::io::stdin()).unwrap_or_default();
            print!("{}", figure::svg(&figure::of_table(&text)));
        }
        Some("short") => short(),
        Some("outside") => {
            let strengths = arguments
                .get(2)
                .map_or("16", String::as_str)
                .split(',')
                .filter_map(|d| d.parse().ok());
            strengths.for_each(|d| outsides(count, d));
        }
        Some("effects") => {
            let strengths: Vec<f64> = arguments
                .get(2)
                .map_or("16", String::as_str)
                .split(',')
                .filter_map(|d| d.parse().ok())
                .collect();
            let _ = effects(
                seed_from(),
                count,
                &strengths,
                &arguments[3.min(arguments.len())..],
            );
        }
        _ => eprintln!(
            "usage: hide_and_seek null N [FIRST SEED] | effects N 8,16,32 [id ...] | outside N 16,64 | benchmark N FIRST_SEED [FIGURE.svg] [clean|single|several|outside|faults|next ...] | figure < TABLES | short"
        ),
    }
}

fn seed_from() -> u64 {
    let named = std::env::var("FIRST").ok();
    named.and_then(|first| first.parse().ok()).unwrap_or(1000)
}

fn extent(arguments: &[String], each: u64) -> benchmark::Extent {
    let figure = arguments.iter().find(|argument| argument.ends_with(".svg"));
    benchmark::Extent {
        each,
        first: arguments.get(2).and_then(|n| n.parse().ok()).unwrap_or(1),
        only: arguments
            .iter()
            .skip(3)
            .filter(|argument| !argument.ends_with(".svg"))
            .cloned()
            .collect(),
        figure: figure.map(std::path::PathBuf::from),
    }
}

/// The short form, on fixed seeds: limits that the long form passes by far.
fn short() {
    let (false_alarms, named) = nulls(0, 60);
    // 5 % of 60 are 3: other seeds would give 11 or more by chance in less than 1 of 3,000 runs.
    let mut failed = Vec::new();
    if false_alarms > 10 || named > 1 {
        failed.push(format!(
            "{false_alarms} of 60 clean groups had p < 0.05, {named} were given a name"
        ));
    }
    let ids = [
        "faradaic-leak",
        "voltage-dependent-capacitance",
        "partial-relaxation",
        "softening",
        "slow-branch",
    ];
    let total = effects(1000, 3, &[32.0], &ids.map(str::to_owned));
    let [hidden, seen, in_set, _, wrong, ..] = total;
    if hidden < 12 || seen < hidden || 10 * in_set < 8 * hidden || wrong > 1 {
        failed.push(format!(
            "of {hidden} hidden effects {seen} were seen, {in_set} in the set, {wrong} given a wrong name"
        ));
    }
    failed
        .iter()
        .for_each(|what| eprintln!("hide and seek failed: {what}"));
    std::process::exit(i32::from(!failed.is_empty()));
}
