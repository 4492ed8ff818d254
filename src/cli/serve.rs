//! `ieap serve`.

use std::net::{IpAddr, SocketAddr};

use clap::Args;
use serde_json::json;

use super::campaign::CampaignArg;
use super::exit::{CliError, DONE};
use super::global::Global;
use super::output::Output;
use super::signals;
use crate::pipeline::Observer;
use crate::pipeline::serve::{DEFAULT_BIND, DEFAULT_PORT, Limits, Server};

/// Show the report in a browser of this machine
///
/// Until stopped with Ctrl-C; pages follow what `watch` renders.
#[derive(Debug, Args)]
pub struct ServeArgs {
    #[command(flatten)]
    campaign: CampaignArg,
    /// Port to listen at; 0 takes a free one
    #[arg(long, value_name = "N", default_value_t = DEFAULT_PORT)]
    port: u16,
    /// Address to listen at; any but a loopback one lets everyone who reaches this machine read the report
    #[arg(long, value_name = "ADDRESS", default_value_t = DEFAULT_BIND)]
    bind: IpAddr,
}

pub fn run(args: &ServeArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    let folder = args.campaign.folder()?;
    let has = |name: &str| folder.join(name).is_file();
    if !has("campaign.toml") && !has("campaign.db") {
        return Err(CliError::usage(&format!(
            "{}: there is no campaign.toml; name a campaign folder",
            folder.display()
        )));
    }
    let address = SocketAddr::new(args.bind, args.port);
    let server = Server::listen(&folder, address, Limits::default()).map_err(|error| {
        CliError::usage(&format!(
            "cannot listen at {address}: {error}; another --port or --bind may do"
        ))
    })?;
    let stop = signals::listen(global.quiet, Some(DONE), STOPPED)?;
    let url = format!("http://{}/", server.address());
    if server.is_open() {
        output.warn(&format!(
            "everyone who reaches {} can read the report; there is no password and no encryption",
            server.address()
        ));
    }
    if global.json {
        output.document(&json!({ "schema": "ieap/serve/1", "url": url }))?;
    }
    output.message(&format!(
        "Report of {} at {url}; stop with Ctrl-C.",
        folder.display()
    ));
    server
        .run(stop.flag(), output)
        .map_err(|error| CliError::internal(&format!("the server stopped: {error}")))?;
    output.message(STOPPED);
    Ok(DONE)
}

const STOPPED: &str = "Stopped.";
