//! datacite.json: the fields that a DOI is registered with, after the DataCite Metadata Schema 4.5.

use serde_json::{Value, json};

use super::metadata::Complete;
use crate::pipeline::Context;
use crate::pipeline::campaign::context::CODE_VERSION;

/// Name of the file.
pub const FILE_NAME: &str = "datacite.json";

/// The document.
pub fn document(context: &Context, publication: &Complete) -> Value {
    let stated = &publication.stated;
    let creators: Vec<Value> = stated
        .author
        .iter()
        .map(|author| {
            let mut creator = json!({ "name": author.name, "nameType": "Personal" });
            if let Some(orcid) = &author.orcid {
                creator["nameIdentifiers"] = json!([{
                    "nameIdentifier": format!("https://orcid.org/{orcid}"),
                    "nameIdentifierScheme": "ORCID",
                    "schemeUri": "https://orcid.org",
                }]);
            }
            if let Some(affiliation) = &author.affiliation {
                creator["affiliation"] = json!([{ "name": affiliation }]);
            }
            creator
        })
        .collect();
    let mut document = json!({
        "schemaVersion": "http://datacite.org/schema/kernel-4",
        "titles": [{ "title": publication.title }],
        "creators": creators,
        "publicationYear": publication.date.get(..4).unwrap_or_default(),
        "dates": [{ "date": publication.date, "dateType": "Issued" }],
        "types": { "resourceTypeGeneral": "Dataset", "resourceType": "Step-response campaign" },
        "rightsList": [{ "rights": publication.license, "rightsUri": publication.license_address() }],
        "descriptions": [
            { "description": said_first(context, &publication.description), "descriptionType": "Abstract" },
            { "description": format!("Tables and figures were made by ieap {CODE_VERSION}."), "descriptionType": "TechnicalInfo" },
        ],
        "subjects": stated.keywords.iter().map(|word| json!({ "subject": word })).collect::<Vec<_>>(),
        "alternateIdentifiers": [{ "alternateIdentifier": context.campaign.id, "alternateIdentifierType": "campaign" }],
    });
    if let Some(publisher) = &stated.publisher {
        document["publisher"] = json!({ "name": publisher });
    }
    if let Some(address) = publication.doi_address() {
        document["identifiers"] = json!([{ "identifier": address, "identifierType": "DOI" }]);
    }
    document
}

/// The campaign's own statement before its description: whoever finds the record by its DOI reads that first.
fn said_first(context: &Context, description: &str) -> String {
    match &context.campaign.notice {
        Some(notice) if !description.contains(notice.as_str()) => format!("{notice}\n\n{description}"),
        _ => description.to_owned(),
    }
}
