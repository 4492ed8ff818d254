//! The answer key: what is hidden in which run.

use std::path::Path;

use serde_json::{Map, Value, json};

use super::effect_spec::hidden_effects;
use super::run_spec::RunSpec;
use super::spec::Spec;
use crate::domain::Level;
use crate::model::truth::HiddenEffect;
use crate::model::truth::catalogue::known;

/// Text of truth.json for a spec of that path.
pub fn answer_key(spec: &Spec, path: &Path) -> String {
    let runs: Vec<Value> = spec.run.iter().map(|run| run_key(spec, run)).collect();
    let key = json!({
        "schema": "ieap/simulation-truth/1",
        "spec": path.file_name().map(|name| name.to_string_lossy()),
        "folder": slashed(&spec.simulation.folder),
        "seed": spec.simulation.seed,
        "runs": runs,
    });
    format!("{key:#}\n")
}

fn run_key(spec: &Spec, run: &RunSpec) -> Value {
    let drive = run.drive();
    let segments: Vec<Value> = drive
        .segments
        .iter()
        .map(|segment| match segment.level {
            Level::Voltage(voltage_v) => json!({ "start_s": segment.start_s, "voltage_v": voltage_v }),
            Level::OpenCircuit => json!({ "start_s": segment.start_s, "open_circuit": true }),
        })
        .collect();
    let effects = hidden_effects(spec, run);
    json!({
        "file": slashed(&run.file),
        "written_by": if effects.is_empty() { "closed form" } else { "truth simulator" },
        "baseline_v": drive.baseline_v,
        "drive": segments,
        "parameters": run.parameters,
        "effects": effects.iter().map(effect_key).collect::<Vec<_>>(),
    })
}

/// Id, variant and all parameters, also those that were not given.
fn effect_key(effect: &HiddenEffect) -> Value {
    let parameters: Map<String, Value> = known(&effect.id)
        .into_iter()
        .flat_map(|entry| entry.parameters)
        .map(|parameter| {
            let value = effect
                .parameters
                .get(parameter.key)
                .copied()
                .or(parameter.default);
            (parameter.key.to_owned(), json!(value))
        })
        .collect();
    json!({ "id": effect.id, "variant": effect.variant_or_first(), "parameters": parameters })
}

/// What is hidden, in a line for the file's header.
pub fn told(effect: &HiddenEffect) -> String {
    let mut text = format!("hidden effect: {}", effect.id);
    if let Some(variant) = effect.variant_or_first() {
        text += &format!(" ({variant})");
    }
    for (key, value) in &effect.parameters {
        text += &format!(", {key} = {value}");
    }
    text
}

fn slashed(path: &Path) -> String {
    path.to_string_lossy().replace('\\', "/")
}
