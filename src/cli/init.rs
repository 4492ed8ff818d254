//! `ieap init`.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::exit::{CliError, DONE};
use super::output::Output;
use crate::pipeline::init;

/// Make a folder a campaign: writes a commented campaign.toml and the folders runs/, dma/ and ambient/
#[derive(Debug, Args)]
pub struct InitArgs {
    /// Folder to make a campaign; made where it is not there
    #[arg(value_name = "FOLDER", default_value = ".")]
    folder: PathBuf,
}

pub fn run(args: &InitArgs, output: &Output) -> Result<u8, CliError> {
    let made = init(&args.folder)?;
    made.iter()
        .for_each(|path| output.result(&format!("made {}", path.display())));
    let file = args.folder.join("campaign.toml");
    output.message(&format!(
        "Next: name your samples in {}, put instrument files into {}, then `ieap run {}`.",
        file.display(),
        args.folder.join("runs").display(),
        args.folder.display()
    ));
    let made: Vec<String> = made.iter().map(|path| path.display().to_string()).collect();
    output.document(&json!({ "schema": "ieap/init/1", "made": made }))?;
    Ok(DONE)
}
