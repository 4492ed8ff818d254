//! `ieap models`.

use clap::Args;
use serde_json::json;

use super::exit::{CliError, DONE};
use super::output::Output;
use crate::{model, pipeline};

/// List the models that runs can be fitted with, their parameters, and the methods that search the minimum
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
    output.result("");
    output.result("Methods that search the minimum (--method):");
    for method in pipeline::methods() {
        let seed = if method.is_random() { " (--seed)" } else { "" };
        output.result(&format!("    {:<24} {}{seed}", method.id(), method.description()));
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
    let methods: Vec<_> = pipeline::methods()
        .iter()
        .map(|m| json!({ "id": m.id(), "description": m.description(), "random": m.is_random() }))
        .collect();
    output.document(&json!({ "schema": "ieap/models/1", "models": models, "methods": methods }))?;
    Ok(DONE)
}
