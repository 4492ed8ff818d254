//! A campaign as a data set to publish.

use std::collections::BTreeSet;
use std::io::Read;

use serde_json::Value;

use crate::campaign::{CAMPAIGN_TOML, CampaignFolder, run_table};
use crate::sql::{has_python, run_python};

const PUBLICATION: &str = r#"
[publication]
license = "CC-BY-4.0"
description = "Step responses of one strip"
publisher = "An institute"
keywords = ["ionic actuator"]
doi = "10.1234/example"

[[publication.author]]
name = "Carberry, Josiah"
orcid = "0000-0002-1825-0097"
affiliation = "Brown University"
"#;

fn campaign() -> CampaignFolder {
    let folder = CampaignFolder::new();
    let told = CAMPAIGN_TOML.replace("title =", "notice = \"Simulated, not measured.\"\ntitle =");
    folder.write("campaign.toml", format!("{told}{PUBLICATION}"));
    folder.write("runs/first run.csv", run_table(1));
    folder.write("runs/refused.csv", "nothing,that\na,reader knows\n");
    folder.run_json();
    folder
}

fn unpacked(bytes: &[u8]) -> Vec<(String, Vec<u8>)> {
    let mut archive = zip::ZipArchive::new(std::io::Cursor::new(bytes)).unwrap();
    let mut files = Vec::new();
    for at in 0..archive.len() {
        let mut file = archive.by_index(at).unwrap();
        let name = file.name().unwrap().into_owned();
        let mut content = Vec::new();
        file.read_to_end(&mut content).unwrap();
        files.push((name, content));
    }
    files
}

#[test]
fn a_crate_holds_the_campaign_and_says_what_each_file_is() {
    let folder = campaign();
    let said = folder
        .ieap(&["export", "--what", "crate", "-o", "out.zip"])
        .expect(0);
    assert!(said.stderr.contains("not in it: runs/refused.csv"), "{said:?}");
    let bytes = std::fs::read(folder.join("out.zip")).unwrap();
    let files = unpacked(&bytes);
    let content = |name: &str| &files.iter().find(|(found, _)| found == name).expect(name).1;
    assert_eq!(
        *content("runs/first run.csv"),
        run_table(1).into_bytes(),
        "the raw bytes"
    );
    assert!(content("tables/fits.parquet").starts_with(b"PAR1"));
    assert!(files.iter().any(|(name, _)| name.starts_with("figures/")));
    let metadata: Value = serde_json::from_slice(content("ro-crate-metadata.json")).unwrap();
    let graph = metadata["@graph"].as_array().unwrap();
    let entity = |id: &str| {
        graph
            .iter()
            .find(|entity| entity["@id"] == id)
            .unwrap_or_else(|| panic!("{id}"))
    };
    assert_eq!(
        entity("ro-crate-metadata.json")["conformsTo"]["@id"],
        "https://w3id.org/ro/crate/1.2"
    );
    let root = entity("./");
    assert_eq!(root["license"]["@id"], "https://spdx.org/licenses/CC-BY-4.0");
    assert_eq!(root["author"][0]["@id"], "https://orcid.org/0000-0002-1825-0097");
    let raw = entity("runs/first%20run.csv");
    let hash = blake3::hash(run_table(1).as_bytes()).to_hex().to_string();
    assert_eq!(raw["identifier"], format!("blake3:{hash}"));
    // Every file but the descriptions is described, everything described is there, and every reference leads somewhere.
    let described: BTreeSet<String> = graph
        .iter()
        .filter(|entity| entity["@type"] == "File")
        .map(|entity| entity["@id"].as_str().unwrap().replace("%20", " "))
        .collect();
    let descriptions = ["ro-crate-metadata.json", "datacite.json"];
    let there: BTreeSet<String> = files
        .iter()
        .map(|(name, _)| name.clone())
        .filter(|name| !descriptions.contains(&name.as_str()))
        .collect();
    assert_eq!(described, there);
    for part in root["hasPart"].as_array().unwrap() {
        entity(part["@id"].as_str().unwrap());
    }
    // Every column of every table says what it is; one that ends in a unit has it.
    let columns = entity("tables/fits.parquet")["variableMeasured"]
        .as_array()
        .unwrap();
    assert_eq!(columns.len(), 19, "{columns:?}");
    for column in columns {
        let said = entity(column["@id"].as_str().unwrap());
        assert!(
            said["description"].as_str().is_some_and(|said| !said.is_empty()),
            "{said}"
        );
    }
    assert_eq!(entity("#fits.voltage_v")["unitText"], "V");
    assert_eq!(entity("#fits.value")["unitText"], Value::Null);
    assert!(content("tables/columns.csv").starts_with(b"table,column,type,unit,meaning\n"));
    assert_eq!(
        entity(root["publisher"]["@id"].as_str().unwrap())["name"],
        "An institute"
    );
    let datacite: Value = serde_json::from_slice(content("datacite.json")).unwrap();
    assert_eq!(
        datacite["creators"][0]["nameIdentifiers"][0]["nameIdentifier"],
        "https://orcid.org/0000-0002-1825-0097"
    );
    let said_first = &datacite["descriptions"][0];
    assert_eq!(said_first["descriptionType"], "Abstract");
    assert_eq!(
        said_first["description"],
        "Simulated, not measured.\n\nStep responses of one strip"
    );
    folder
        .ieap(&["export", "--what", "crate", "-o", "again.zip"])
        .expect(0);
    assert!(
        std::fs::read(folder.join("again.zip")).unwrap() == bytes,
        "the same campaign gives the same bytes"
    );
}

#[test]
fn what_only_people_can_say_is_asked_for_and_never_made_up() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.run_json();
    let refused = folder
        .ieap(&["export", "--what", "crate", "-o", "out.zip"])
        .expect(2);
    assert!(
        refused
            .stderr
            .contains("a license, an author, a description, a publisher"),
        "{refused:?}"
    );
    assert!(!folder.join("out.zip").exists());
    let slip = PUBLICATION.replace("0097", "0096");
    folder.write("campaign.toml", format!("{CAMPAIGN_TOML}{slip}"));
    let refused = folder
        .ieap(&["export", "--what", "crate", "-o", "out.zip"])
        .expect(2);
    assert!(
        refused.stderr.contains("ORCID") && refused.stderr.contains("line "),
        "{refused:?}"
    );
}

/// The validator of the people who wrote the specification, where it is there (`pip install roc-validator`).
#[test]
fn an_existing_validator_finds_nothing_that_is_required_and_missing() {
    if !has_python("rocrate_validator") {
        return;
    }
    let folder = campaign();
    folder
        .ieap(&["export", "--what", "crate", "-o", "out.zip"])
        .expect(0);
    for (name, content) in unpacked(&std::fs::read(folder.join("out.zip")).unwrap()) {
        folder.write(&format!("crate/{name}"), content);
    }
    // The validator fetches the specification's context; without a network it can say nothing.
    let script = "
from rocrate_validator import models, services
settings = services.ValidationSettings(rocrate_uri='crate', profile_identifier='ro-crate-1.2',
    requirement_severity=models.Severity.REQUIRED)
try:
    result = services.validate(settings)
except Exception as error:
    if 'urlopen' not in str(error):
        raise
    print('no network')
else:
    for issue in result.get_issues():
        print(issue.severity.name, issue.message)
";
    match run_python(folder.path(), script).as_str() {
        "no network\n" => println!("not tried: the validator finds no network"),
        said => assert_eq!(said, ""),
    }
}
