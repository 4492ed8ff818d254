//! `ieap list schemas`: the JSON Schemas of what `--json` prints. A document is one file in schemas/ and one row in [`SCHEMAS`].

use serde_json::{Value, json};

use super::exit::{CliError, DONE};
use super::output::Output;

/// The schema of one document.
#[derive(Debug)]
pub struct Schema {
    /// Its name, `fits`.
    pub name: &'static str,
    /// The schema.
    pub text: &'static str,
}

macro_rules! schemas {
    ($($name:literal),* $(,)?) => {
        [$(Schema { name: $name, text: include_str!(concat!("../../schemas/", $name, ".json")) }),*]
    };
}

/// Every document that `--json` prints, by name. tests/it/schemas.rs holds what is printed against them.
pub const SCHEMAS: &[Schema] = &schemas![
    "alarms",
    "backup",
    "comparison",
    "convert",
    "diagnosis",
    "dma",
    "drive",
    "drop",
    "effects",
    "explain",
    "export",
    "figure",
    "figures",
    "files",
    "fits",
    "formats",
    "impedance",
    "import-fits",
    "ingest",
    "init",
    "init-from",
    "inspect",
    "models",
    "moved",
    "next",
    "plan",
    "prediction",
    "profile",
    "rebuild",
    "report",
    "restore",
    "run",
    "schemas",
    "serve",
    "simulate",
    "status",
    "study",
    "study-plan",
    "table",
    "tables",
    "tag",
    "trace",
    "verify",
];

/// The schema of that name, `fits`.
pub fn schema_named(name: &str) -> Option<&'static Schema> {
    SCHEMAS.iter().find(|schema| schema.name == name)
}

/// Lists the schemas of what `--json` prints, or prints that of one document: `fits`, or `ieap/fits/1` as its key "schema"
/// says. A schema says what is always there; later versions of the program may add keys.
pub fn run(name: Option<&str>, output: &Output) -> Result<u8, CliError> {
    let Some(name) = name else {
        return list(output);
    };
    let is_meant = |schema: &&Schema| schema.name == name || title(schema).as_deref() == Some(name);
    let found = SCHEMAS.iter().find(is_meant).ok_or_else(|| {
        let known: Vec<&str> = SCHEMAS.iter().map(|schema| schema.name).collect();
        CliError::usage(&format!(
            "schema: found {name:?}, needed one of {}",
            known.join(", ")
        ))
    })?;
    output.write(found.text.as_bytes());
    Ok(DONE)
}

fn list(output: &Output) -> Result<u8, CliError> {
    let entries: Vec<Value> = SCHEMAS.iter().map(entry).collect();
    for entry in &entries {
        let text = |key: &str| entry[key].as_str().unwrap_or_default().to_owned();
        output.result(&format!("{:<22} {}", text("id"), text("about")));
    }
    output.document(&json!({ "schema": "ieap/schemas/1", "schemas": entries }))?;
    Ok(DONE)
}

fn entry(schema: &Schema) -> Value {
    let read = read(schema);
    json!({ "name": schema.name, "id": read["title"], "about": read["description"] })
}

/// What the document's key "schema" says: `ieap/fits/1`.
fn title(schema: &Schema) -> Option<String> {
    read(schema)["title"].as_str().map(str::to_owned)
}

fn read(schema: &Schema) -> Value {
    serde_json::from_str(schema.text).unwrap_or_default()
}

#[cfg(test)]
mod derived_tests;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_schema_is_json_and_says_what_it_is_of() {
        for schema in SCHEMAS {
            let read: Value = serde_json::from_str(schema.text).expect(schema.name);
            let title = title(schema).expect("a title");
            assert!(title.starts_with(&format!("ieap/{}/", schema.name)), "{title}");
            assert_eq!(read["properties"]["schema"]["const"], title.as_str());
            assert!(
                read["description"]
                    .as_str()
                    .is_some_and(|text| text.contains("`ieap ")),
                "{title}"
            );
        }
        assert!(
            SCHEMAS.windows(2).all(|pair| pair[0].name < pair[1].name),
            "in order of names"
        );
    }
}
