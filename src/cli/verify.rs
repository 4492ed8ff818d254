//! `ieap verify`.

use clap::Args;
use serde_json::json;

use super::campaign::CampaignArg;
use super::exit::{CliError, DONE, STORAGE};
use super::output::Output;
use crate::pipeline::upkeep::verify::{Part, Verified, Verify};

/// Check that nothing is lost or damaged
///
/// Looks at database, raw files, journal and report; with --deep also whether every number can be derived again.
///
/// Nothing is changed, and `ieap watch` may go on beside it. Ends with status 4 where something is lost or damaged; each
/// finding says how to mend it.
#[derive(Debug, Args)]
pub struct VerifyArgs {
    #[command(flatten)]
    campaign: CampaignArg,
    /// Read all raw files and fit all runs again, and compare every reading and number with what is stored
    #[arg(long)]
    deep: bool,
    /// With --deep: diagnose all groups again, too, which may take hours
    #[arg(long, requires = "deep")]
    diagnoses: bool,
}

pub fn run(args: &VerifyArgs, output: &Output) -> Result<u8, CliError> {
    let verify = Verify {
        deep: args.deep,
        diagnoses: args.diagnoses,
    };
    let verified = verify.run(&args.campaign.folder()?, output)?;
    verified.parts.iter().for_each(|part| print(part, output));
    say_end(&verified, output);
    let is_sound = verified.is_sound();
    output.document(&json!({ "schema": "ieap/verify/1", "sound": is_sound, "verify": verified }))?;
    Ok(if is_sound { DONE } else { STORAGE })
}

fn print(part: &Part, output: &Output) {
    let state = if part.is_sound() { "sound" } else { "NOT SOUND" };
    output.result(&format!("{}: {state} ({})", part.part, part.looked_at));
    for issue in &part.findings {
        let place = match issue.place.as_str() {
            "" => String::new(),
            place => format!("{place}: "),
        };
        output.result(&format!("  {}: {place}{}", issue.severity.key(), issue.message));
        if !issue.mend.is_empty() {
            output.result(&format!("    {}", issue.mend));
        }
    }
}

fn say_end(verified: &Verified, output: &Output) {
    if let Some(hash) = &verified.content_hash {
        output.result(&format!("content hash: {hash}"));
    }
}
