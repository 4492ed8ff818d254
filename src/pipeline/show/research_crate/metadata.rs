//! ro-crate-metadata.json: what the crate is, who made it, what each file is, and what made the tables.

use serde_json::{Value, json};

use super::part::Part;
use crate::ingest::campaign_file::Publication;
use crate::pipeline::campaign::context::CODE_VERSION;
use crate::pipeline::{Context, PipelineError};

/// Name that the specification gives the file.
pub const FILE_NAME: &str = "ro-crate-metadata.json";
/// Where licences of SPDX identifiers are described.
const SPDX: &str = "https://spdx.org/licenses/";
/// What campaign.toml needs before its data can be published.
const NEEDED: &str = "[publication]\nlicense = \"CC-BY-4.0\"\ndescription = \"What was measured, and why\"\n\
                      [[publication.author]]\nname = \"Family, Given\"\norcid = \"0000-0002-1825-0097\"";

/// What is published, with nothing open that a crate must state.
pub struct Complete {
    pub title: String,
    pub description: String,
    pub license: String,
    pub date: String,
    pub stated: Publication,
}

/// Takes what may be taken from elsewhere; what only people can say is asked for.
pub fn complete(context: &Context, stated: Publication) -> Result<Complete, PipelineError> {
    let lacking: Vec<&str> = [
        ("a license", stated.license.is_none()),
        ("an author", stated.author.is_empty()),
        ("a description", stated.description.is_none()),
    ]
    .into_iter()
    .filter_map(|(what, lacks)| lacks.then_some(what))
    .collect();
    if !lacking.is_empty() {
        return Err(PipelineError::BadArgument {
            what: "campaign.toml, [publication]",
            found: format!("none with {}", lacking.join(", ")),
            needed: format!("what only you can say of the data, such as\n{NEEDED}\n"),
        });
    }
    // The day on which the data were last changed, unless another one is stated.
    let (_, changed_at) = context.store.changes()?;
    let day = changed_at.get(..10).unwrap_or(&changed_at).to_owned();
    Ok(Complete {
        title: stated
            .title
            .clone()
            .unwrap_or_else(|| context.campaign.title.clone()),
        description: stated.description.clone().unwrap_or_default(),
        license: stated.license.clone().unwrap_or_default(),
        date: stated.date.clone().unwrap_or(day),
        stated,
    })
}

impl Complete {
    /// Address of the licence.
    pub fn license_address(&self) -> String {
        if self.license.contains("://") {
            self.license.clone()
        } else {
            format!("{SPDX}{}", self.license)
        }
    }

    /// Address of the data set; none before it has a DOI.
    pub fn doi_address(&self) -> Option<String> {
        let doi = self.stated.doi.as_ref()?;
        Some(format!(
            "https://doi.org/{}",
            doi.trim_start_matches("https://doi.org/")
        ))
    }
}

/// The document.
pub fn document(context: &Context, publication: &Complete, parts: &[Part]) -> Value {
    let mut graph = vec![
        json!({
            "@id": FILE_NAME,
            "@type": "CreativeWork",
            "conformsTo": { "@id": "https://w3id.org/ro/crate/1.2" },
            "about": { "@id": "./" },
        }),
        root(context, publication, parts),
        json!({ "@id": publication.license_address(), "@type": "CreativeWork", "name": publication.license }),
    ];
    graph.extend(people(publication));
    graph.extend(parts.iter().map(file));
    graph.extend(software(parts));
    json!({ "@context": "https://w3id.org/ro/crate/1.2/context", "@graph": graph })
}

fn root(context: &Context, publication: &Complete, parts: &[Part]) -> Value {
    let authors: Vec<Value> = (0..publication.stated.author.len())
        .map(|at| json!({ "@id": author_id(publication, at) }))
        .collect();
    let mut root = json!({
        "@id": "./",
        "@type": "Dataset",
        "name": publication.title,
        "description": publication.description,
        "datePublished": publication.date,
        "license": { "@id": publication.license_address() },
        "author": authors,
        "hasPart": parts.iter().map(|part| json!({ "@id": id_of(&part.path) })).collect::<Vec<_>>(),
        "mentions": { "@id": "#tables" },
    });
    if !publication.stated.keywords.is_empty() {
        root["keywords"] = publication.stated.keywords.join(", ").into();
    }
    if publication.stated.publisher.is_some() {
        root["publisher"] = json!({ "@id": "#publisher" });
    }
    if let Some(notice) = &context.campaign.notice {
        root["abstract"] = notice.as_str().into();
    }
    if let Some(address) = publication.doi_address() {
        root["identifier"] = address.as_str().into();
        root["cite-as"] = address.into();
    }
    root
}

fn author_id(publication: &Complete, at: usize) -> String {
    match &publication.stated.author[at].orcid {
        Some(orcid) => format!("https://orcid.org/{orcid}"),
        None => format!("#author-{}", at + 1),
    }
}

/// Authors, their institutes, and who publishes.
fn people(publication: &Complete) -> Vec<Value> {
    let mut people = Vec::new();
    for (at, author) in publication.stated.author.iter().enumerate() {
        let mut person = json!({ "@id": author_id(publication, at), "@type": "Person", "name": author.name });
        if let Some(affiliation) = &author.affiliation {
            let id = format!("#affiliation-{}", at + 1);
            person["affiliation"] = json!({ "@id": id });
            people.push(json!({ "@id": id, "@type": "Organization", "name": affiliation }));
        }
        people.push(person);
    }
    if let Some(publisher) = &publication.stated.publisher {
        people.push(json!({ "@id": "#publisher", "@type": "Organization", "name": publisher }));
    }
    people
}

fn file(part: &Part) -> Value {
    json!({
        "@id": id_of(&part.path),
        "@type": "File",
        "name": part.path.rsplit('/').next().unwrap_or_default(),
        "description": part.name,
        "encodingFormat": part.media_type,
        "contentSize": part.bytes.to_string(),
        "identifier": format!("blake3:{}", part.blake3),
    })
}

/// The program, and that it made tables and figures of the raw files.
fn software(parts: &[Part]) -> Vec<Value> {
    let of = |made: bool| -> Vec<Value> {
        let is_made = |part: &&Part| part.path.starts_with("tables/") || part.path.starts_with("figures/");
        let parts = parts.iter().filter(|part| is_made(part) == made);
        parts.map(|part| json!({ "@id": id_of(&part.path) })).collect()
    };
    vec![
        json!({
            "@id": "#ieap",
            "@type": "SoftwareApplication",
            "name": "ieap",
            "url": program_address(),
            "version": CODE_VERSION,
            "softwareVersion": CODE_VERSION,
            "description": "Database and report pipeline for step-response campaigns of ionic electroactive polymer actuators",
        }),
        json!({
            "@id": "#tables",
            "@type": "CreateAction",
            "name": "Tables and figures made from the raw files",
            "instrument": { "@id": "#ieap" },
            "object": of(false),
            "result": of(true),
        }),
    ]
}

/// Where the program is described; a name in place of an address while its package states no home page.
fn program_address() -> String {
    match env!("CARGO_PKG_HOMEPAGE") {
        "" => format!("urn:ieap:{CODE_VERSION}"),
        page => page.to_owned(),
    }
}

/// A path as a relative address: what an address cannot hold is escaped.
fn id_of(path: &str) -> String {
    let kept = |byte: u8| byte.is_ascii_alphanumeric() || b"-._~/()!$&'*+,;=@".contains(&byte);
    path.bytes()
        .map(|byte| {
            if kept(byte) {
                char::from(byte).to_string()
            } else {
                format!("%{byte:02X}")
            }
        })
        .collect()
}
