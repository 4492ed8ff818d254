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
    let not_read = crate::ingest::campaign_file::NOT_READ;
    let warnings = context.warnings.iter().filter(|issue| issue.code != not_read);
    warnings.for_each(|issue| output.issue("campaign.toml", issue));
    let found = study(&context)?;
    output.show(SCHEMA, &found, &lines(&found))?;
    Ok(exit::DONE)
}
