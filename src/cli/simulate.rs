//! `ieap simulate`.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::exit::{CliError, DONE};
use super::global::Global;
use super::output::Output;
use crate::domain::words::counted;
use crate::pipeline::standalone::simulate::Simulate;

/// Write run files of a model, with noise, seeded
///
/// The same spec gives the same bytes.
#[derive(Debug, Args)]
pub struct SimulateArgs {
    /// What to simulate; campaigns/thesis/simulation.toml shows how
    #[arg(value_name = "SPEC.toml")]
    spec: PathBuf,
    /// Write over files that are there
    #[arg(long)]
    overwrite: bool,
}

pub fn run(args: &SimulateArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    let simulate = Simulate {
        spec: args.spec.clone(),
        seed: global.seed,
        overwrite: args.overwrite,
    };
    let written = simulate.run(output)?;
    output.result(&format!("{} written", counted(written.len(), "file")));
    written
        .iter()
        .for_each(|path| output.detail(&format!("wrote {}", path.display())));
    let written: Vec<String> = written.iter().map(|path| path.display().to_string()).collect();
    output.document(&json!({ "schema": "ieap/simulate/1", "written": written }))?;
    Ok(DONE)
}
