//! `ieap list models`.

use serde_json::json;

use super::exit::{CliError, DONE};
use super::output::Output;
use crate::{model, pipeline};

fn law_text(about: &model::bending::LawText) -> serde_json::Value {
    json!({
        "equation": about.equation,
        "driven_by": about.driven_by,
        "source": about.source,
        "limits": about.limits,
    })
}

/// Lists the models that runs can be fitted with, their parameters, and the methods that search the minimum.
pub fn run(output: &Output) -> Result<u8, CliError> {
    for model in model::fit_models() {
        output.result(&format!(
            "{}  (version {})  {}",
            model.id, model.version, model.description
        ));
        if let Some(law) = model::rival_law(model.id) {
            let about = law.about();
            output.result(&format!("    {}", about.equation));
            output.result(&format!("    driven by {}", about.driven_by));
            output.result(&format!("    limits: {}", about.limits));
        }
        for parameter in model.parameters {
            let derived = if parameter.derived { " (derived)" } else { "" };
            output.result(&format!(
                "    {:<20} {:<10} {}{derived}",
                parameter.key,
                parameter.unit(),
                parameter.meaning
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
                .map(|p| json!({ "key": p.key, "symbol": p.symbol, "unit": p.unit(), "meaning": p.meaning, "derived": p.derived }))
                .collect();
            json!({ "id": model.id, "version": model.version, "description": model.description, "parameters": parameters, "law": model::rival_law(model.id).map(|law| law_text(&law.about())) })
        })
        .collect();
    let methods: Vec<_> = pipeline::methods()
        .iter()
        .map(|m| json!({ "id": m.id(), "description": m.description(), "random": m.is_random() }))
        .collect();
    output.document(&json!({ "schema": "ieap/models/1", "models": models, "methods": methods }))?;
    Ok(DONE)
}
