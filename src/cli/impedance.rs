//! `ieap run --only impedance`.

use clap::Args;

use super::campaign::CampaignArg;
use super::exit::{self, CliError};
use super::global::Global;
use super::ingest;
use super::output::Output;
use crate::model::impedance::{SpectrumCircuit, circuit};
use crate::pipeline::Ingest;
use crate::pipeline::findings::impedance::{SCHEMA, has_fault, spectra, view};

/// A step of `run`: test and fit impedance spectra
///
/// Sets them beside the steps of the same samples, after taking in new files.
#[derive(Debug, Args)]
#[command(override_usage = "ieap run --only impedance [OPTIONS] [CAMPAIGN]")]
pub struct ImpedanceArgs {
    #[command(flatten)]
    campaign: CampaignArg,
    /// Fit this circuit as well, such as "R0-p(R1,CPE1)-W1": `-` in series, p(..,..) beside each other, elements R C L
    /// CPE W Wo Ws TLMQ; may be given again
    #[arg(long, value_name = "CIRCUIT", value_parser = parsed)]
    circuit: Vec<SpectrumCircuit>,
}

fn parsed(text: &str) -> Result<SpectrumCircuit, String> {
    circuit(text).map_err(|error| error.to_string())
}

pub fn run(args: &ImpedanceArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    let mut context = args.campaign.open(global, output)?;
    let ingest = Ingest { ready: &mut |_| true }.run(&mut context, output)?;
    ingest::left_out(&ingest, output);
    let found = spectra(&context, &args.circuit)?;
    output.show(SCHEMA, &found, &view(&found, &context.campaign))?;
    Ok(exit::after(has_fault(&found), !ingest.left_out_inputs()))
}
