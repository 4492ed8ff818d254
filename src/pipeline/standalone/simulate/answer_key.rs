//! The answer key: what is hidden in which run.

use std::path::Path;

use serde_json::{Map, Value, json};

use super::effect_spec::slashed;
use super::run_spec::RunSpec;
use super::spec::Spec;
use super::spec::hidden_effects;
use super::strip_spec::StripSpec;
use crate::domain::Drive;
use crate::truth::HiddenEffect;
use crate::truth::catalogue::known;

/// Text of truth.json for a spec of that path.
pub fn answer_key(spec: &Spec, path: &Path) -> String {
    let runs: Vec<Value> = spec.run.iter().map(|run| run_key(spec, run)).collect();
    let mut key = json!({
        "schema": "ieap/simulation-truth/1",
        "spec": path.file_name().map(|name| name.to_string_lossy()),
        "folder": slashed(&spec.simulation.folder),
        "seed": spec.simulation.seed,
        "runs": runs,
    });
    if !spec.strip.is_empty() {
        key["strips"] = spec.strip.iter().map(strip_key).collect();
    }
    format!("{key:#}\n")
}

fn strip_key(strip: &StripSpec) -> Value {
    json!({
        "file": slashed(&strip.file),
        "written_by": "ladder of cells",
        "baseline_v": strip.baseline_v,
        "drive": segments(&strip.drive()),
        "parameters": strip.parameters,
    })
}

fn segments(drive: &Drive) -> Vec<Value> {
    let key = |(start_s, volts): (f64, Option<f64>)| match volts {
        Some(voltage_v) => json!({ "start_s": start_s, "voltage_v": voltage_v }),
        None => json!({ "start_s": start_s, "open_circuit": true }),
    };
    drive.levels().map(key).collect()
}

fn run_key(spec: &Spec, run: &RunSpec) -> Value {
    let drive = run.drive();
    let effects = hidden_effects(spec, run);
    json!({
        "file": slashed(&run.file),
        "written_by": if effects.is_empty() { "closed form" } else { "truth simulator" },
        "baseline_v": drive.baseline_v,
        // Of a wave the steps that stand for it are none of its own.
        "drive": run.wave.map_or_else(|| json!(segments(&drive)), |wave| json!({ "wave": wave })),
        "parameters": run.parameters,
        "effects": effects.iter().map(effect_key).collect::<Vec<_>>(),
    })
}

/// Id, variant, a foreign form where there is one, and all parameters, also those that were not given.
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
    let mut key = json!({ "id": effect.id, "variant": effect.variant_or_first(), "parameters": parameters });
    if let Some(form) = effect.form() {
        key["form"] = json!(form);
    }
    key
}

/// What is hidden, in a line for the file's header.
pub fn told(effect: &HiddenEffect) -> String {
    let mut text = format!("hidden effect: {}", effect.id);
    if let Some(variant) = effect.variant_or_first() {
        text += &format!(" ({variant})");
    }
    if let Some(form) = effect.form() {
        text += &format!(" in the foreign form {form}");
    }
    for (key, value) in &effect.parameters {
        text += &format!(", {key} = {value}");
    }
    text
}
