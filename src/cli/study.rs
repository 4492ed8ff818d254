//! `ieap study`.

use clap::Args;

use super::campaign::CampaignArg;
use super::exit::{self, CliError};
use super::output::Output;
use crate::pipeline::findings::study::{SCHEMA, lines, study};

/// Answer what the study asked, from current fits
///
/// What environment, humidity, voltage and material do to each parameter.
#[derive(Debug, Args)]
pub struct StudyArgs {
    #[command(flatten)]
    campaign: CampaignArg,
}

pub fn run(args: &StudyArgs, output: &Output) -> Result<u8, CliError> {
    let context = args.campaign.open_to_show(output)?;
    let found = study(&context)?;
    output.show(SCHEMA, &found, &lines(&found))?;
    Ok(exit::DONE)
}
