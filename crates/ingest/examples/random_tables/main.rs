//! Writes tables in random dialects and counts what the reader makes of them.
//!
//! `cargo run --release -p ieap-ingest --example random_tables -- COUNT SEED [--show K]`: tables of the seeds SEED to
//! SEED + COUNT - 1; of each kind of silent error the first K are shown with the seed that makes the table again.
//! `--write FOLDER` keeps the bytes of each table that is shown, `--print` prints those of SEED and counts nothing. The exit status is 1 where a table was misread in silence.

mod clock;
mod compare;
mod count;
mod dialect;
mod dice;
mod ending;
mod expected;
mod head;
mod judge;
mod names;
mod number;
mod odd;
mod shapes;
mod start;
mod table;
mod times;
mod truth;
mod units;
mod wall;
mod words;
mod write;

use std::io::Write;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |at: usize, default: u64| arguments.get(at).and_then(|n| n.parse().ok()).unwrap_or(default);
    let option = |name: &str| {
        arguments
            .iter()
            .position(|a| a == name)
            .and_then(|at| arguments.get(at + 1))
    };
    let show = option("--show").and_then(|n| n.parse().ok()).unwrap_or(1);
    if arguments.iter().any(|a| a == "--print") {
        return print(number(1, 1));
    }
    let counts = count::count(number(0, 1000), number(1, 1));
    print!("{}", counts.text(show));
    if let Some(folder) = option("--write") {
        counts.write(folder, show);
    }
    if counts.wrong() == 0 {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

fn print(seed: u64) -> ExitCode {
    let (_, dialect, table) = count::of_seed(seed);
    eprintln!("{}", dialect.words());
    let written = std::io::stdout().write_all(&table.bytes);
    if written.is_ok() {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
