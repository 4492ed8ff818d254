//! A campaign of very many runs: `cargo run --release --example many_runs -- 100000 FOLDER`
//!
//! Makes the folder with short simulated tables, takes them in with `ieap ingest`'s own code and prints how long that
//! took, how long `status` and a look that finds nothing new take, and how long the report does. Where the folder is there
//! already, what is in it is measured. Fits are left out: each takes as long as in a small campaign.

use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use ieap::pipeline::upkeep::status::status;
use ieap::pipeline::{Context, Ingest, RenderReport, Silent};

/// Files of one folder.
const A_FOLDER: usize = 1000;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(count), Some(folder)) = (arguments.next(), arguments.next()) else {
        return Err("usage: many_runs NUMBER FOLDER".into());
    };
    let (count, folder): (usize, PathBuf) = (count.parse()?, folder.into());
    if !folder.exists() {
        make(&folder, count)?;
    }
    let mut context = Context::open(&folder, false)?;
    for what in ["taking the files in", "a look that finds nothing new"] {
        let begun = Instant::now();
        let summary = Ingest { ready: &mut |_| true }.run(&mut context, &Silent)?;
        println!(
            "{what}: {:.2} s, {} new runs",
            begun.elapsed().as_secs_f64(),
            summary.new.len()
        );
    }
    drop(context);
    let begun = Instant::now();
    let status = status(&Context::open_read_only(&folder)?)?;
    println!(
        "status: {:.2} s, {} runs",
        begun.elapsed().as_secs_f64(),
        status.runs
    );
    let context = Context::open(&folder, false)?;
    let begun = Instant::now();
    let report = RenderReport {
        again: true,
        ..RenderReport::default()
    }
    .run(&context, &Silent)?;
    println!(
        "report: {:.1} s, {} pages",
        begun.elapsed().as_secs_f64(),
        report.pages
    );
    if let Some(peak) = peak_memory() {
        println!("memory at most: {peak}");
    }
    Ok(())
}

/// Writes a campaign with so many tables of 30 rows.
fn make(folder: &Path, count: usize) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(folder.join("runs"))?;
    let campaign = "[campaign]\nid = \"many\"\ntitle = \"Very many runs\"\n\n[[sample]]\nid = \"S1\"\nmaterial = \"CNaf\"\nlength_mm = 5.0\nwidth_mm = 2.0\n";
    fs::write(folder.join("campaign.toml"), campaign)?;
    fs::write(
        folder.join("runs/tags.toml"),
        "sample = \"S1\"\nenvironment = \"air\"\n",
    )?;
    for run in 0..count {
        let within = folder.join(format!("runs/{:03}", run / A_FOLDER));
        if run % A_FOLDER == 0 {
            fs::create_dir_all(&within)?;
        }
        let mut table = "time_s,voltage_v,current_a,curvature_per_cm\n".to_owned();
        for step in -2i32..28 {
            let on = f64::from(u8::from(step >= 0));
            let current_a = on * (1e-3 + 1e-9 * run as f64) * (-f64::from(step) / 8.0).exp();
            writeln!(table, "{step},{},{current_a:.9e},{:.4}", 2.0 * on, 0.1 * on)?;
        }
        fs::write(within.join(format!("{run:06}.csv")), table)?;
    }
    Ok(())
}

/// What the system says of the most memory that was used; none where it says nothing.
fn peak_memory() -> Option<String> {
    let told = fs::read_to_string("/proc/self/status").ok()?;
    let line = told.lines().find(|line| line.starts_with("VmHWM"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}
