//! What is known of parameters before a fit: in campaign.toml and by hand, said with the fit, hashed, refused where it cannot be.

use serde_json::Value;

use crate::campaign::{CAMPAIGN_TOML, CampaignFolder, Ended, run_table};

fn with_run() -> CampaignFolder {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder
}

fn stated(folder: &CampaignFolder, entry: &str) {
    folder.write(
        "campaign.toml",
        format!("{CAMPAIGN_TOML}\n[[fit.known]]\n{entry}"),
    );
}

fn first_fit(ended: &Ended) -> Value {
    ended.json()["fits"][0].clone()
}

fn page_of_run(folder: &CampaignFolder) -> String {
    let pages = std::fs::read_dir(folder.join("report/runs")).unwrap();
    let page = pages
        .map(|entry| entry.unwrap().path())
        .find(|path| path.extension().is_some_and(|e| e == "html"));
    std::fs::read_to_string(page.unwrap()).unwrap()
}

fn codes(fit: &Value) -> Vec<String> {
    let issues = fit["issues"].as_array().unwrap().iter();
    issues
        .map(|issue| issue["code"].as_str().unwrap().to_owned())
        .collect()
}

#[test]
fn what_campaign_toml_knows_is_in_every_fit_of_the_sample_and_said() {
    let folder = with_run();
    folder.ieap(&["fit"]).expect(0);
    stated(
        &folder,
        "parameter = \"lambda_per_s\"\nvalue = 0.002\nstandard_error = 2e-4\nsource = \"a datasheet\"\nsample = \"S1\"\n",
    );
    let ended = folder.ieap(&["fit", "--json"]).expect(0);
    assert!(
        ended.stderr.contains("1 fitted"),
        "what is known makes the fit anew: {}",
        ended.stderr
    );
    let fit = first_fit(&ended);
    assert!(codes(&fit).contains(&"known-parameter".to_owned()), "{fit}");
    assert!(fit.to_string().contains("0.002 ± 0.0002 (a datasheet)"), "{fit}");
    assert!(fit["method"].as_str().unwrap().contains("what is known"));
    // Nothing changed: nothing is fitted.
    let again = folder.ieap(&["fit"]).expect(0);
    assert!(
        again.stderr.contains("0 fitted, 1 up to date"),
        "{}",
        again.stderr
    );
    folder.ieap(&["report"]).expect(0);
    let page = page_of_run(&folder);
    assert!(page.contains("taken as known: 0.002") && page.contains("(a datasheet)"));
    // A model of another kind passes over it, and says so.
    let rival = folder
        .ieap(&["fit", "--model", "kelvin-voigt", "--json"])
        .expect(0);
    assert!(codes(&first_fit(&rival)).contains(&"known-not-used".to_owned()));
}

#[test]
fn what_is_known_by_hand_is_kept_and_a_contradiction_is_said() {
    let folder = with_run();
    let set = folder
        .ieap(&["fit", "--set", "lambda_per_s=0.02±0.0005", "--json"])
        .expect(0);
    let found = codes(&first_fit(&set));
    assert!(found.contains(&"known-contradicted".to_owned()), "{found:?}");
    let kept = folder.ieap(&["fit"]).expect(0);
    assert!(kept.stderr.contains("0 fitted, 1 up to date"), "{}", kept.stderr);
    assert!(
        kept.stderr.contains("lambda_per_s = 0.02 ± 0.0005"),
        "{}",
        kept.stderr
    );
}

#[test]
fn what_cannot_be_known_is_refused_with_what_can() {
    let folder = with_run();
    for (set, needed) in [
        ("lambda_per_s", "r1_ohm_cm2=120±6"),
        ("q=3", "it has r1_ohm_cm2"),
        ("tau1_s=3", "give it a standard error"),
        ("r1_ohm_cm2=-3", "positive"),
    ] {
        let ended = folder.ieap(&["fit", "--set", set]).expect(2);
        assert!(ended.stderr.contains(needed), "{set}: {}", ended.stderr);
    }
    // Where what is known is not used, a slip in a name is refused all the same.
    let rival = folder.ieap(&["fit", "--model", "maxwell", "--set", "lamda_per_s=0.1"]);
    assert!(rival.expect(2).stderr.contains("no model has such a parameter"));
    let grouped = folder
        .ieap(&["fit", "--group", "--set", "lambda_per_s=0.002"])
        .expect(2);
    assert!(grouped.stderr.contains("leave --group"), "{}", grouped.stderr);
    for (entry, needed) in [
        (
            "parameter = \"lambda_per_s\"\nlow = 1.0\n",
            "found low = 1; needed value",
        ),
        (
            "parameter = \"lambda_per_s\"\nvalue = 1.0\nstandard_eror = 0.1\n",
            "standard_eror",
        ),
        (
            "parameter = \"lambda_per_s\"\nvalue = 1.0\nsample = \"S2\"\n",
            "there are S1",
        ),
        ("value = 1.0\n", "parameter"),
    ] {
        stated(&folder, entry);
        let ended = folder.ieap(&["fit"]);
        assert!(
            ended.status != 0 && ended.stderr.contains(needed),
            "{entry}: {ended:?}"
        );
    }
}
