//! Runs with an effect hidden in them, simulated, taken in and fitted by the command as its user calls it.

use ieap::truth::catalogue::KNOWN;
use serde_json::Value;

use crate::campaign::{CampaignFolder, ieap};

/// The worked example of docs/simulate.md: the samples for campaign.toml, and the spec.
fn worked_example() -> (String, String) {
    let page = docs("simulate.md");
    let mut blocks = page.split("```toml\n").skip(1);
    let mut block = || blocks.next().unwrap().split("```").next().unwrap().to_owned();
    (block(), block())
}

/// A campaign with the samples of the worked example, and nothing simulated yet.
fn example_campaign(spec: &str) -> CampaignFolder {
    let folder = CampaignFolder::new();
    std::fs::remove_file(folder.join("runs/tags.toml")).unwrap();
    let head = "[campaign]\nid = \"example\"\ntitle = \"The worked example\"\n";
    folder.write("campaign.toml", format!("{head}{}", worked_example().0));
    folder.write("simulation.toml", spec);
    folder
}

fn docs(name: &str) -> String {
    std::fs::read_to_string(format!("{}/docs/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

fn estimate<'a>(fits: &'a Value, run: &str, key: &str) -> &'a Value {
    let fits = fits["fits"].as_array().unwrap();
    let fit = fits.iter().find(|fit| fit["run"] == run).unwrap();
    &fit["parameters"][key]
}

#[test]
fn the_worked_example_is_simulated_taken_in_and_fitted() {
    let folder = example_campaign(&worked_example().1);
    let simulated = folder.ieap(&["simulate", "simulation.toml", "--json"]).expect(0);
    assert_eq!(simulated.json()["written"].as_array().unwrap().len(), 11);
    let key = std::fs::read_to_string(folder.join("truth.json")).unwrap();
    let key: Value = serde_json::from_str(&key).unwrap();
    let hidden = |run: usize| key["runs"][run]["effects"].as_array().unwrap().len();
    assert_eq!([0, 1, 2, 3, 4].map(hidden), [1, 1, 1, 1, 0]);
    let fits = folder.ieap(&["fit", "--json"]).expect(0).json();
    assert_eq!(fits["fits"].as_array().unwrap().len(), 5);
    // 2e-5 (e^4 - 1) A/cm2 beside 2.2 V / 5600 Ohm cm2: the base model takes the hidden leak for a lower R_ss.
    let leak = 2.2 / (2.2 / 5600.0 + 2e-5 * 4.0_f64.exp_m1());
    for (run, expected) in [("runs/step_2.2V.csv", leak), ("runs/back.csv", 5600.0)] {
        let found = estimate(&fits, run, "rss_ohm_cm2");
        let (low, high) = (
            found["low_95"].as_f64().unwrap(),
            found["high_95"].as_f64().unwrap(),
        );
        let margin = high - low;
        assert!(
            low - margin < expected && expected < high + margin,
            "{run}: {found}"
        );
        // Its edges lie between readings, its zero is fitted, and five runs leave it open whether the noise is slow.
        assert!(margin < 0.55 * expected, "{run}: {found}");
    }
}

/// What the page says of the findings.
#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn the_worked_example_is_found_as_its_page_says() {
    let folder = example_campaign(&worked_example().1);
    folder.ieap(&["simulate", "simulation.toml"]).expect(0);
    let found = folder.ieap(&["diagnose", "--json"]).expect(0).json();
    let said = |place: usize| {
        let group = &found["groups"][place];
        let set = group["set"].as_array().unwrap();
        let set: Vec<&str> = set.iter().map(|effect| effect.as_str().unwrap()).collect();
        (group["verdict"].as_str().unwrap().to_owned(), set.join(" "))
    };
    assert_eq!(said(0), ("law".to_owned(), "faradaic-leak".to_owned()));
    // Three voltages tell the law and its one textbook curve, and no more than that it is about this curve.
    let leak = &found["groups"][0]["missing"][0];
    assert_eq!(leak["names"], serde_json::json!(["faradaic-leak"]));
    assert!(leak["probability"].as_f64().unwrap() > 0.95, "{leak}");
    let late = &found["groups"][1]["missing"][0];
    assert_eq!(
        (&late["place"], &late["law"]),
        (&"bending".into(), &"delay".into()),
        "{late:#}"
    );
    assert_eq!(
        said(1),
        ("law".to_owned(), "camera-delay mechanical-lag".to_owned())
    );
    assert_eq!(said(2).0, "right");
}

#[test]
fn an_effect_that_is_not_known_is_refused_and_nothing_is_written() {
    let folder = example_campaign(&worked_example().1.replace("faradaic-leak", "faraday"));
    let ended = ieap(folder.path(), &["simulate", "simulation.toml"]).expect(2);
    assert!(
        ended
            .stderr
            .contains("effect \"faraday\" is not known; known are series-resistance"),
        "{ended:?}"
    );
    assert!(!folder.join("truth.json").exists() && !folder.join("runs/step_1.0V.csv").exists());
}

#[test]
fn every_effect_stands_on_the_page_with_its_variants_forms_and_parameters() {
    let page = docs("hidden-effects.md");
    for effect in KNOWN {
        let row = page
            .lines()
            .find(|line| line.starts_with(&format!("| `{}` |", effect.id)));
        let row = row.unwrap_or_else(|| panic!("{} is not on the page", effect.id));
        assert!(
            effect.variants.iter().all(|variant| row.contains(variant)),
            "{row}"
        );
        let forms = row.split(" | ").nth(2).unwrap_or_default();
        assert_eq!(forms.trim(), effect.forms.join(", "), "{row}");
        let keys = effect.parameters.iter();
        assert!(
            keys.into_iter()
                .all(|parameter| row.contains(&format!("`{}`", parameter.key))),
            "{row}"
        );
    }
}
