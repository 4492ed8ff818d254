//! An adopted model and the findings that it rests on, derived again and rebuilt.

use serde_json::Value;

use crate::campaign::{CampaignFolder, forge_results, ieap};
use crate::findings::{CAMPAIGN, spec};
use crate::rebuild::{content, same, without_database};

/// The results that `verify --deep --diagnoses` looked at, and codes of its errors about them.
fn derived_again(folder: &CampaignFolder, status: i32) -> (String, Vec<String>) {
    let document = folder
        .ieap(&["verify", "--deep", "--diagnoses", "--json"])
        .expect(status)
        .json();
    let parts = document["verify"]["parts"].as_array().unwrap();
    let results = parts.iter().find(|part| part["part"] == "results").unwrap();
    let errors = results["findings"].as_array().unwrap().iter();
    let errors = errors.filter(|found| found["severity"] == "error");
    let code = |found: &Value| {
        format!(
            "{} {}",
            found["code"].as_str().unwrap(),
            found["place"].as_str().unwrap()
        )
    };
    (
        results["looked_at"].as_str().unwrap().to_owned(),
        errors.map(code).collect(),
    )
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn an_adopted_model_comes_back_with_a_rebuilding_and_findings_are_derived_again() {
    let folder = CampaignFolder::new();
    folder.write("campaign.toml", CAMPAIGN);
    std::fs::remove_file(folder.join("runs/tags.toml")).unwrap();
    folder.write("simulation.toml", spec());
    ieap(folder.path(), &["simulate", "simulation.toml"]).expect(0);
    folder.ieap(&["diagnose", "--adopt"]).expect(0);
    folder.ieap(&["run"]).expect(0);
    let adopted_fits = || {
        let document = folder.ieap(&["fit", "--json"]).expect(0).json();
        let fits = document["fits"].as_array().unwrap().clone().into_iter();
        let extended = fits.filter(|fit| fit["model"].as_str().unwrap().starts_with("lumped-2 + "));
        extended.count()
    };
    assert_eq!(adopted_fits(), 5);

    let (looked_at, errors) = derived_again(&folder, 0);
    assert!(looked_at.contains("12 diagnoses"), "{looked_at}");
    assert_eq!(errors, Vec::<String>::new());

    let before = content(&folder);
    without_database(folder.path());
    folder.ieap(&["rebuild"]).expect(0);
    let lacking = before.differences(&content(&folder));
    assert!(
        lacking.iter().all(|(part, _)| *part == "diagnosis"),
        "{lacking:?}"
    );
    assert_eq!(adopted_fits(), 5);
    folder.ieap(&["run"]).expect(0);
    same(&content(&folder), &before);

    // A number that is wrong under a hash that is right.
    forge_results(folder.path(), "group", |document| {
        if document["found"]["group"] == "sample=clean,environment=air" {
            let p = document["found"]["p_misfit"].as_f64().unwrap();
            document["found"]["p_misfit"] = (p / 2.0).into();
        }
    });
    folder.ieap(&["report"]).expect(0);
    folder.ieap(&["verify", "--deep"]).expect(0);
    let (_, errors) = derived_again(&folder, 4);
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert!(errors[0].starts_with("result-differs"), "{errors:?}");
}
