//! `ieap export --what crate`: a campaign as one ZIP that a repository takes: raw files, tables, figures, campaign.toml, and what
//! all of it is, as an RO-Crate 1.2 (<https://w3id.org/ro/crate/1.2>) and for DataCite (Metadata Schema 4.5).

use std::collections::BTreeMap;
use std::io::{Seek, Write};
use std::path::Path;

use serde_json::{Value, json};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use super::export::{Export, written};
use super::figures::{self, MakeFigure};
use super::plain_tables::plain_table;
use crate::analysis::TableFormat;
use crate::analysis::json_rows::rows;
use crate::domain::FileState;
use crate::ingest::archive::Archive;
use crate::ingest::campaign_file::{self, Publication};
use crate::pipeline::campaign::context::CODE_VERSION;
use crate::pipeline::infra::whole_file::put_file;
use crate::pipeline::{Context, PipelineError, failed};
use crate::system::fs;

/// Resolution of figures; they are drawn as SVG, where it does not count.
const DOTS_PER_INCH: f64 = 300.0;
/// What campaign.toml needs before its data can be published.
const NEEDED: &str = "[publication]\nlicense = \"CC-BY-4.0\"\ndescription = \"What was measured, and why\"\n\
                      publisher = \"Your university, or the repository\"\n\
                      [[publication.author]]\nname = \"Family, Given\"\norcid = \"0000-0002-1825-0097\"";

/// What went in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CrateSummary {
    /// Files in the ZIP, the descriptions counted.
    pub files: usize,
    /// What is not in it, with the reason.
    pub left_out: Vec<(String, String)>,
}

/// Writes the crate; the file appears whole or not at all. The same campaign gives the same bytes.
///
/// # Errors
/// campaign.toml has no `[publication]` with a licence, an author, a description and a publisher; the disk refuses.
pub fn export_crate(context: &Context, path: &Path, overwrite: bool) -> Result<CrateSummary, PipelineError> {
    let stated_in = context.folder.join(campaign_file::FILE_NAME);
    let text = fs::read_stated_text(&context.folder, &stated_in).map_err(failed(&stated_in, "reading"))?;
    let publication = campaign_file::publication(&text, &stated_in)?.unwrap_or_default();
    asked_for(&publication)?;
    put_file(path, overwrite, |part| {
        let failed = failed(path, "writing the crate");
        let file = fs::OpenOptions::new().read(true).write(true).open(part);
        let mut zip = ZipWriter::new(file.map_err(&failed)?);
        let (columns, mut parts, mut left_out) = (columns(context)?, Vec::new(), Vec::new());
        let mut add = |name: &str, about: &str, bytes: &[u8]| {
            let mut part = described(name, about, bytes);
            let table = name.strip_prefix("tables/").and_then(|name| name.split_once('.'));
            if let Some(own) = table.and_then(|(table, _)| columns.get(table)) {
                part["variableMeasured"] = references(own);
            }
            parts.push(part);
            put(&mut zip, name, bytes).map_err(&failed)
        };
        add(
            campaign_file::FILE_NAME,
            "What was measured, on what, and how",
            text.as_bytes(),
        )?;
        let archive = Archive::new(&context.folder);
        for file in context.store.files()? {
            match (&file.hash, file.state) {
                (Some(hash), FileState::Run | FileState::Alias | FileState::Log) => {
                    add(&file.path, "Raw file of an instrument", &archive.read(hash)?)?;
                }
                _ => {
                    let reason = format!("{}: it holds no run and no log", file.state.key());
                    left_out.push((file.path, reason));
                }
            }
        }
        for (table, _) in written() {
            for (format, ending) in [(TableFormat::Parquet, "parquet"), (TableFormat::Csv, "csv")] {
                let (bytes, rows) = Export::bytes(context, table, format)?;
                let about = format!("Table {}, {rows} rows", table);
                add(&format!("tables/{}.{ending}", table), &about, &bytes)?;
            }
        }
        for (name, _, _, about) in figures::listed().filter(|(name, ..)| !figures::needs_no_campaign(name)) {
            let figure = MakeFigure {
                name: name.to_owned(),
                format: "svg".to_owned(),
                width_mm: None,
                dots_per_inch: DOTS_PER_INCH,
                run: None,
                parameter: None,
            };
            let name = format!("figures/{name}.svg");
            match figure.run(context) {
                Ok(bytes) => add(&name, about, &bytes)?,
                Err(PipelineError::Figure { reason, .. }) => left_out.push((name, reason)),
                Err(error) => return Err(error),
            }
        }
        let files = parts.len() + 2;
        let columns = columns.into_values().flatten();
        for (name, document) in descriptions(context, &publication, parts, columns)? {
            put(&mut zip, name, format!("{document:#}\n").as_bytes()).map_err(&failed)?;
        }
        zip.finish().map_err(|error| failed(error.into()))?;
        Ok(CrateSummary { files, left_out })
    })
}

/// Refuses what lacks something that only people can say.
fn asked_for(stated: &Publication) -> Result<(), PipelineError> {
    let lacking: Vec<&str> = [
        ("a license", stated.license.is_none()),
        ("an author", stated.author.is_empty()),
        ("a description", stated.description.is_none()),
        ("a publisher", stated.publisher.is_none()),
    ]
    .into_iter()
    .filter_map(|(what, lacks)| lacks.then_some(what))
    .collect();
    if lacking.is_empty() {
        return Ok(());
    }
    Err(PipelineError::BadArgument {
        what: "campaign.toml, [publication]",
        found: format!("none with {}", lacking.join(", ")),
        needed: format!("what only you can say of the data, such as\n{NEEDED}\n"),
    })
}

/// Adds a file to the ZIP, without a time of day.
fn put<W: Write + Seek>(zip: &mut ZipWriter<W>, name: &str, bytes: &[u8]) -> std::io::Result<()> {
    let options = SimpleFileOptions::default().large_file(bytes.len() as u64 >= u64::from(u32::MAX));
    zip.start_file(name, options)?;
    zip.write_all(bytes)
}

/// A file as the crate describes it.
fn described(path: &str, about: &str, bytes: &[u8]) -> Value {
    let ending = path.rsplit('.').next().unwrap_or_default().to_lowercase();
    let media_type = match ending.as_str() {
        "csv" => "text/csv",
        "tsv" => "text/tab-separated-values",
        "txt" | "dta" | "mpt" | "dat" | "asc" => "text/plain",
        "parquet" => "application/vnd.apache.parquet",
        "svg" => "image/svg+xml",
        "toml" => "application/toml",
        "json" => "application/json",
        "zip" => "application/zip",
        _ => "application/octet-stream",
    };
    json!({
        "@id": id_of(path),
        "@type": "File",
        "name": path.rsplit('/').next().unwrap_or_default(),
        "description": about,
        "encodingFormat": media_type,
        "contentSize": bytes.len().to_string(),
        "identifier": format!("blake3:{}", blake3::hash(bytes).to_hex()),
    })
}

/// ro-crate-metadata.json: what the crate is, who made it, and what each file is; datacite.json: the fields that a DOI is
/// registered with.
fn descriptions(
    context: &Context,
    stated: &Publication,
    parts: Vec<Value>,
    columns: impl Iterator<Item = Value>,
) -> Result<[(&'static str, Value); 2], PipelineError> {
    let title = stated.title.as_ref().unwrap_or(&context.campaign.title);
    let description = stated.description.as_deref().unwrap_or_default();
    let license = stated.license.as_deref().unwrap_or_default();
    let publisher = stated.publisher.as_deref().unwrap_or_default();
    let license_id = if license.contains("://") {
        license.to_owned()
    } else {
        format!("https://spdx.org/licenses/{license}")
    };
    // The day on which the data were last changed, unless another one is stated.
    let (_, changed_at) = context.store.changes()?;
    let date = stated.date.as_ref().unwrap_or(&changed_at);
    let date = date.get(..10).unwrap_or(date);
    let doi = stated
        .doi
        .as_deref()
        .map(|doi| doi.trim_start_matches("https://doi.org/"));
    let doi = doi.map(|doi| format!("https://doi.org/{doi}"));

    let (mut people, mut authors, mut creators) = (Vec::new(), Vec::new(), Vec::new());
    for (number, author) in (1..).zip(&stated.author) {
        let mut creator = json!({ "name": author.name, "nameType": "Personal" });
        let mut id = format!("#author-{number}");
        if let Some(orcid) = &author.orcid {
            id = format!("https://orcid.org/{orcid}");
            creator["nameIdentifiers"] = json!([{
                "nameIdentifier": id, "nameIdentifierScheme": "ORCID", "schemeUri": "https://orcid.org",
            }]);
        }
        authors.push(json!({ "@id": id }));
        let mut person = json!({ "@id": id, "@type": "Person", "name": author.name });
        if let Some(affiliation) = &author.affiliation {
            let id = format!("#affiliation-{number}");
            creator["affiliation"] = json!([{ "name": affiliation }]);
            person["affiliation"] = json!({ "@id": id });
            people.push(json!({ "@id": id, "@type": "Organization", "name": affiliation }));
        }
        people.push(person);
        creators.push(creator);
    }
    let mut root = json!({
        "@id": "./",
        "@type": "Dataset",
        "name": title,
        "description": description,
        "datePublished": date,
        "license": { "@id": license_id },
        "author": authors,
        "hasPart": references(&parts),
        "publisher": { "@id": "#publisher" },
    });
    // Whoever finds the record by its DOI reads the campaign's own statement first.
    let first = match &context.campaign.notice {
        Some(notice) if !description.contains(notice.as_str()) => format!("{notice}\n\n{description}"),
        _ => description.to_owned(),
    };
    let mut datacite = json!({
        "schemaVersion": "http://datacite.org/schema/kernel-4",
        "titles": [{ "title": title }],
        "creators": creators,
        "publisher": { "name": publisher },
        "publicationYear": date.get(..4).unwrap_or_default(),
        "dates": [{ "date": date, "dateType": "Issued" }],
        "types": { "resourceTypeGeneral": "Dataset", "resourceType": "Step-response campaign" },
        "rightsList": [{ "rights": license, "rightsUri": license_id }],
        "descriptions": [
            { "description": first, "descriptionType": "Abstract" },
            { "description": format!("Tables and figures were made by ieap {CODE_VERSION}."), "descriptionType": "TechnicalInfo" },
        ],
        "subjects": stated.keywords.iter().map(|word| json!({ "subject": word })).collect::<Vec<_>>(),
        "alternateIdentifiers": [{ "alternateIdentifier": context.campaign.id, "alternateIdentifierType": "campaign" }],
    });
    people.push(json!({ "@id": "#publisher", "@type": "Organization", "name": publisher }));
    if !stated.keywords.is_empty() {
        root["keywords"] = stated.keywords.join(", ").into();
    }
    if let Some(notice) = &context.campaign.notice {
        root["abstract"] = notice.as_str().into();
    }
    if let Some(address) = &doi {
        root["identifier"] = address.as_str().into();
        root["cite-as"] = address.as_str().into();
        datacite["identifiers"] = json!([{ "identifier": address, "identifierType": "DOI" }]);
    }
    let mut graph = vec![
        json!({
            "@id": "ro-crate-metadata.json",
            "@type": "CreativeWork",
            "conformsTo": { "@id": "https://w3id.org/ro/crate/1.2" },
            "about": { "@id": "./" },
        }),
        root,
        json!({ "@id": license_id, "@type": "CreativeWork", "name": license }),
    ];
    graph.extend(people);
    graph.extend(parts);
    graph.extend(columns);
    let metadata = json!({ "@context": "https://w3id.org/ro/crate/1.2/context", "@graph": graph });
    Ok([("ro-crate-metadata.json", metadata), ("datacite.json", datacite)])
}

/// The columns of each table, as the table `columns` has them.
fn columns(context: &Context) -> Result<BTreeMap<String, Vec<Value>>, PipelineError> {
    let mut by_table: BTreeMap<String, Vec<Value>> = BTreeMap::new();
    for row in rows(&plain_table(context, "columns")?, Value::Bool) {
        let [table, name] = ["table", "column"].map(|key| row[key].as_str().unwrap_or_default());
        let mut property = json!({
            "@id": format!("#{table}.{}", id_of(name)),
            "@type": "PropertyValue",
            "name": name,
            "description": row["meaning"].as_str().unwrap_or_default(),
        });
        if row["unit"].is_string() {
            property["unitText"] = row["unit"].clone();
        }
        by_table.entry(table.to_owned()).or_default().push(property);
    }
    Ok(by_table)
}

fn references(to: &[Value]) -> Value {
    to.iter().map(|one| json!({ "@id": one["@id"] })).collect()
}

/// A path as a relative address: what an address cannot hold is escaped.
fn id_of(path: &str) -> String {
    let kept = |byte: u8| byte.is_ascii_alphanumeric() || b"-._~/()!$&'*+,;=@".contains(&byte);
    path.bytes()
        .map(|byte| match byte {
            _ if kept(byte) => char::from(byte).to_string(),
            _ => format!("%{byte:02X}"),
        })
        .collect()
}
