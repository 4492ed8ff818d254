//! `ieap list effects`.

use serde_json::{Value, json};

use super::exit::{CliError, DONE};
use super::output::Output;
use crate::model::effects::{ALL, About, effect, mechanism_of};

/// Lists the effects that a model may be missing; of one that is named, everything that is known of it.
pub fn run(id: Option<&str>, output: &Output) -> Result<u8, CliError> {
    let chosen: Vec<&About> = match id {
        None => ALL.iter().map(|effect| effect.about()).collect(),
        Some(id) => vec![one(id)?],
    };
    if id.is_some() {
        chosen.iter().for_each(|about| everything(about, output));
    } else {
        list(&chosen, output);
    }
    let effects: Vec<Value> = chosen.iter().map(|about| document(about)).collect();
    output.document(&json!({ "schema": "ieap/effects/2", "effects": effects }))?;
    Ok(DONE)
}

fn one(id: &str) -> Result<&'static About, CliError> {
    effect(id).map(|effect| effect.about()).ok_or_else(|| {
        CliError::usage(&format!(
            "there is no effect `{id}`. `ieap list effects` lists the ids, `series-resistance` for one."
        ))
    })
}

fn list(effects: &[&About], output: &Output) {
    for about in effects {
        output.result(&format!(
            "{:<4} {:<30} {:<22} {}",
            about.code,
            about.id,
            mechanism(about),
            about.summary
        ));
    }
}

/// Id of its mechanism.
fn mechanism(about: &About) -> &'static str {
    mechanism_of(about.id).map_or("", |own| own.id)
}

fn everything(about: &About, output: &Output) {
    let line = |name: &str, text: &str| output.result(&format!("  {name:<13} {text}"));
    output.result(&format!(
        "{}  ({}, {})  {}",
        about.id,
        about.code,
        mechanism(about),
        about.summary
    ));
    if let Some(own) = mechanism_of(about.id) {
        line("mechanism", &format!("{}: {}", own.site.name(), own.words));
    }
    line("equation", about.equation);
    if !about.variants.is_empty() {
        line("variants", &about.variants.join(", "));
    }
    for (k, parameter) in about.parameters.iter().enumerate() {
        let name = if k == 0 { "parameters" } else { "" };
        let unit = if parameter.unit.is_empty() {
            "-"
        } else {
            parameter.unit
        };
        line(
            name,
            &format!(
                "{:<34} {:<6} {unit:<18} {}",
                parameter.key, parameter.symbol, parameter.meaning
            ),
        );
    }
    line("vanishes", about.vanishes);
    line("signature", about.signature);
    line("twins", &about.twins.join(", "));
    line("separated by", about.separated_by);
    line("sources", about.sources);
}

fn document(about: &About) -> Value {
    let parameters: Vec<Value> = about
        .parameters
        .iter()
        .map(|p| json!({ "key": p.key, "symbol": p.symbol, "unit": p.unit, "meaning": p.meaning }))
        .collect();
    json!({
        "id": about.id,
        "code": about.code,
        "site": mechanism_of(about.id).map(|own| own.site.name()),
        "mechanism": mechanism(about),
        "summary": about.summary,
        "equation": about.equation,
        "variants": about.variants,
        "parameters": parameters,
        "vanishes": about.vanishes,
        "signature": about.signature,
        "twins": about.twins,
        "separated_by": about.separated_by,
        "sources": about.sources,
    })
}
