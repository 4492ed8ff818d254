//! `ieap list formats`.

use serde_json::json;

use super::exit::{CliError, DONE};
use super::output::Output;
use crate::ingest::formats;

/// Lists the instrument formats that can be read.
pub fn run(output: &Output) -> Result<u8, CliError> {
    for format in formats::ALL {
        let extensions = format.extensions().join(", ");
        output.result(&format!(
            "{:<16} {} ({extensions}), reader {}",
            format.id(),
            format.title(),
            format.version()
        ));
    }
    let list: Vec<_> = formats::ALL
        .iter()
        .map(|format| {
            json!({ "id": format.id(), "title": format.title(), "extensions": format.extensions(), "version": format.version() })
        })
        .collect();
    output.document(&json!({ "schema": "ieap/formats/1", "formats": list }))?;
    Ok(DONE)
}
