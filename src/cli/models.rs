//! `ieap models`.

use clap::Args;
use serde_json::json;

use super::exit::{CliError, DONE};
use super::output::Output;
use crate::model;

/// List the models that runs can be fitted with, and their parameters
#[derive(Debug, Args)]
pub struct ModelsArgs {}

pub fn run(_args: &ModelsArgs, output: &Output) -> Result<u8, CliError> {
    for model in model::fit_models() {
        output.result(&format!(
            "{}  (version {})  {}",
            model.id, model.version, model.description
        ));
        for parameter in model.parameters {
            let derived = if parameter.derived { " (derived)" } else { "" };
            output.result(&format!(
                "    {:<20} {:<10} {}{derived}",
                parameter.key, parameter.unit, parameter.meaning
            ));
        }
    }
    let models: Vec<_> = model::fit_models()
        .iter()
        .map(|model| {
            let parameters: Vec<_> = model
                .parameters
                .iter()
                .map(|p| json!({ "key": p.key, "symbol": p.symbol, "unit": p.unit, "meaning": p.meaning, "derived": p.derived }))
                .collect();
            json!({ "id": model.id, "version": model.version, "description": model.description, "parameters": parameters })
        })
        .collect();
    output.document(&json!({ "schema": "ieap/models/1", "models": models }))?;
    Ok(DONE)
}
