//! Schemas as the structs say them: the files in schemas/ are written from here, and held against it.
//!
//! `IEAP_UPDATE_EXPECTED=1 cargo unit -p ieap schemas_are_as` writes them. What no struct stands behind is written by hand
//! ([`BY_HAND`]).

use std::path::Path;

use schemars::generate::SchemaSettings;
use schemars::transform::{RecursiveTransform, Transform as _};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::{Map, Value, json};

use super::SCHEMAS;
use crate::cli::status::{AlarmsDocument, FilesDocument};
use crate::pipeline::documents::comparison::ComparisonDocument;
use crate::pipeline::documents::diagnosis::DiagnosisDocument;
use crate::pipeline::documents::dma::Dma;
use crate::pipeline::documents::fits::FitsDocument;
use crate::pipeline::findings::impedance::Spectra;
use crate::pipeline::findings::next_runs::{PlannedRun, SheetSummary};
use crate::pipeline::findings::study::Study;
use crate::pipeline::findings::study_plan::StudyPlanDocument;
use crate::pipeline::intake::trace::TraceSummary;
use crate::pipeline::show::tables::MovedDocument;
use crate::pipeline::standalone::convert::ConversionDocument;
use crate::pipeline::standalone::forward::DriveDocument;
use crate::pipeline::standalone::forward::document::PredictionDocument;
use crate::pipeline::standalone::inspect::Inspection;
use crate::pipeline::standalone::preflight::PlanDocument;
use crate::pipeline::standalone::profile::ProposedProfile;
use crate::pipeline::upkeep::backup::{BackedUp, Restored};
use crate::pipeline::upkeep::import_fits::ImportSummary;
use crate::pipeline::upkeep::status::Status;
use crate::pipeline::upkeep::verify::Verified;
use crate::pipeline::{
    IngestSummary, Proposed, RebuildSummary, ReportSummary, RunSummary, SpokenOf, TagSummary,
};
use crate::show::Document;

/// Documents that verbs put together themselves, without a struct.
const BY_HAND: [&str; 13] = [
    "effects", "explain", "export", "figure", "figures", "formats", "init", "models", "schemas", "serve",
    "simulate", "table", "tables",
];
/// Width of a line, above which a value is spread over several.
const WIDTH: usize = 125;

/// What one key of a document holds.
type Of = fn(&mut SchemaGenerator) -> Schema;

/// A document with what prints it.
struct Derived {
    /// `fits/1`.
    id: &'static str,
    /// The command that prints it.
    printed_by: &'static str,
    /// All keys but `schema`.
    of: Of,
}

fn derived() -> Vec<Derived> {
    let document = |id, printed_by, of| Derived { id, printed_by, of };
    vec![
        document("alarms/2", "status --alarms", whole::<AlarmsDocument>),
        document("backup/1", "backup", |of| {
            keys([("backup", value::<BackedUp>(of))])
        }),
        document("comparison/1", "compare", whole::<ComparisonDocument>),
        document("convert/1", "convert NAME=VALUE", whole::<ConversionDocument>),
        document("diagnosis/4", "diagnose", whole::<DiagnosisDocument>),
        document("dma/1", "dma", whole::<Document<Dma>>),
        document("drive/2", "drive", whole::<DriveDocument>),
        document("drop/1", "drop RUN", |of| {
            let mut schema = keys([("drop", value::<SpokenOf>(of))]);
            schema.insert(
                "description".to_owned(),
                "`ieap drop RUN --undo --json` prints the same.".into(),
            );
            schema
        }),
        document("files/1", "status --files", whole::<FilesDocument>),
        document("fits/1", "fit", whole::<FitsDocument>),
        document("impedance/2", "impedance", whole::<Document<Spectra>>),
        document("import-fits/2", "import-fits FILES", |of| {
            keys([("imported", value::<ImportSummary>(of))])
        }),
        document("ingest/1", "ingest", |of| {
            keys([("ingest", value::<IngestSummary>(of))])
        }),
        document("init-from/1", "init FOLDER --from FILES", |of| {
            keys([("proposed", value::<Proposed>(of))])
        }),
        document("inspect/1", "inspect FILE", whole::<Inspection>),
        document("moved/1", "table NAME --moved", whole::<MovedDocument>),
        document("next/2", "next", |of| {
            keys([
                ("next_runs", value::<Vec<PlannedRun>>(of)),
                ("sheet", value::<Option<SheetSummary>>(of)),
            ])
        }),
        document("plan/1", "plan --every TIME", whole::<PlanDocument>),
        document("prediction/2", "predict", whole::<PredictionDocument>),
        document("profile/1", "profile FILE", whole::<ProposedProfile>),
        document("rebuild/1", "rebuild", |of| {
            keys([("rebuild", value::<RebuildSummary>(of))])
        }),
        document("report/1", "report", |of| {
            keys([("report", value::<ReportSummary>(of))])
        }),
        document("restore/1", "restore", |of| {
            keys([("restored", value::<Restored>(of))])
        }),
        document("run/1", "run", |of| keys([("run", value::<RunSummary>(of))])),
        document("study/1", "study", whole::<Document<Study>>),
        document("study-plan/1", "plan --study", whole::<StudyPlanDocument>),
        document("status/2", "status", |of| keys([("status", value::<Status>(of))])),
        document("tag/1", "tag RUN KEY=VALUE", |of| {
            keys([
                ("tag", value::<TagSummary>(of)),
                ("others", value::<Vec<TagSummary>>(of)),
            ])
        }),
        document("trace/1", "trace FRAMES", whole::<TraceSummary>),
        document("verify/1", "verify", |of| {
            keys([("sound", value::<bool>(of)), ("verify", value::<Verified>(of))])
        }),
    ]
}

/// A document that is one struct.
fn whole<T: JsonSchema>(generator: &mut SchemaGenerator) -> Schema {
    T::json_schema(generator)
}

/// A value of a document.
fn value<T: JsonSchema>(generator: &mut SchemaGenerator) -> Schema {
    generator.subschema_for::<T>()
}

/// A document of such values under their keys.
fn keys<const N: usize>(values: [(&str, impl Into<Value>); N]) -> Schema {
    let required: Vec<&str> = ["schema"]
        .into_iter()
        .chain(values.iter().map(|(key, _)| *key))
        .collect();
    let mut properties = Map::from_iter([("schema".to_owned(), Value::Null)]);
    let required = json!(required);
    properties.extend(values.map(|(key, value)| (key.to_owned(), value.into())));
    json_schema!({ "type": "object", "properties": properties, "required": required })
}

/// The schema of a document.
fn schema(document: &Derived) -> Value {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    let mut generator = settings.into_generator();
    let body = (document.of)(&mut generator);
    let (name, version) = document.id.split_once('/').expect("name/version");
    let title = format!("ieap/{name}/{version}");
    let mut root = Map::new();
    root.insert(
        "$schema".to_owned(),
        generator.settings().meta_schema.as_deref().into(),
    );
    root.insert("$id".to_owned(), format!("urn:ieap:{name}:{version}").into());
    root.insert("title".to_owned(), title.clone().into());
    let about = body
        .get("description")
        .and_then(Value::as_str)
        .unwrap_or_default();
    let about = format!("What `ieap {} --json` prints. {about}", document.printed_by);
    root.insert("description".to_owned(), about.trim_end().into());
    for key in ["type", "properties", "required"] {
        root.insert(key.to_owned(), body.get(key).cloned().unwrap_or_default());
    }
    root["properties"]["schema"] = json!({ "const": title });
    let mut definitions = generator.take_definitions(false);
    definitions.sort_keys();
    if !definitions.is_empty() {
        root.insert("$defs".to_owned(), definitions.into());
    }
    let mut root = Schema::from(root);
    RecursiveTransform(as_printed).transform(&mut root);
    root.to_value()
}

/// What serde_json makes of values: numbers that are not finite are null. Of comments lines are joined; defaults are for
/// who reads, and formats are words of Rust.
fn as_printed(schema: &mut Schema) {
    if schema.get("type").is_some_and(|of| of == "number") {
        schema.insert("type".to_owned(), json!(["number", "null"]));
    }
    if let Some(Value::String(text)) = schema.remove("description") {
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        schema
            .ensure_object()
            .shift_insert(0, "description".to_owned(), text.into());
    }
    schema.remove("default");
    schema.remove("format");
}

/// A schema as its file has it: what fits into a line stands in one.
fn laid_out(value: &Value, indent: usize, before: usize) -> String {
    let short = in_a_line(value);
    let parts: Vec<(String, &Value)> = match value {
        Value::Object(object) => object
            .iter()
            .map(|(key, own)| (format!("{key:?}: "), own))
            .collect(),
        Value::Array(items) => items.iter().map(|own| (String::new(), own)).collect(),
        _ => Vec::new(),
    };
    if parts.is_empty() || (indent > 0 && before + short.len() < WIDTH) {
        return short;
    }
    let brackets = if value.is_object() { ['{', '}'] } else { ['[', ']'] };
    let inner = indent + 2;
    let lines = parts.iter().map(|(key, own)| {
        let own = laid_out(own, inner, inner + key.len());
        format!("{:inner$}{key}{own}", "")
    });
    let lines: Vec<String> = lines.collect();
    format!(
        "{}\n{}\n{:indent$}{}",
        brackets[0],
        lines.join(",\n"),
        "",
        brackets[1]
    )
}

fn in_a_line(value: &Value) -> String {
    match value {
        Value::Object(object) => {
            let parts: Vec<String> = object
                .iter()
                .map(|(key, own)| format!("{key:?}: {}", in_a_line(own)))
                .collect();
            format!("{{{}}}", parts.join(", "))
        }
        Value::Array(items) => format!("[{}]", items.iter().map(in_a_line).collect::<Vec<_>>().join(", ")),
        other => other.to_string(),
    }
}

#[test]
fn schemas_are_as_the_structs_say() {
    let documents = derived();
    let mut differing = Vec::new();
    for document in &documents {
        let (name, _) = document.id.split_once('/').expect("name/version");
        let text = laid_out(&schema(document), 0, 0) + "\n";
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("schemas/{name}.json"));
        if std::env::var_os("IEAP_UPDATE_EXPECTED").is_some() {
            std::fs::write(&path, &text).expect("a file in schemas/");
        }
        if std::fs::read_to_string(&path).ok().as_deref() != Some(&text) {
            differing.push(name);
        }
    }
    assert!(
        differing.is_empty(),
        "schemas/ is not what the structs say of {}: write it with `IEAP_UPDATE_EXPECTED=1 cargo unit -p ieap schemas_are_as`, and look \
         at what changed: later versions may add keys, and change none",
        differing.join(", ")
    );
    let mut names: Vec<&str> = documents
        .iter()
        .filter_map(|document| document.id.split('/').next())
        .collect();
    names.extend(BY_HAND);
    names.sort_unstable();
    assert_eq!(
        names,
        SCHEMAS.iter().map(|schema| schema.name).collect::<Vec<_>>(),
        "derived ones and those by hand"
    );
}
