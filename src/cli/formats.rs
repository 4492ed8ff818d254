//! `ieap list formats`.

use serde_json::json;

use super::exit::{CliError, DONE};
use super::output::Output;
use crate::ingest::formats::{self, About};

/// Lists the instrument formats that can be read.
pub fn run(output: &Output) -> Result<u8, CliError> {
    let mut list = Vec::new();
    for format in formats::ALL {
        let About {
            id,
            title,
            extensions,
            version,
        } = format.about();
        let all = extensions.join(", ");
        output.result(&format!("{id:<16} {title} ({all}), reader {version}"));
        list.push(json!({ "id": id, "title": title, "extensions": extensions, "version": version }));
    }
    output.document(&json!({ "schema": "ieap/formats/1", "formats": list }))?;
    Ok(DONE)
}
