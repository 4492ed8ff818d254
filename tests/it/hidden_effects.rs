//! Runs with an effect hidden in them, simulated, taken in and fitted by the command as its user calls it.

use ieap::model::truth::catalogue::KNOWN;
use serde_json::Value;

use crate::campaign::{CampaignFolder, ieap};

/// The worked example of docs/simulate.md.
fn worked_example() -> String {
    let page = docs();
    let text = page.split("```toml\n").nth(1).unwrap();
    text.split("```").next().unwrap().to_owned()
}

fn docs() -> String {
    std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/simulate.md")).unwrap()
}

fn estimate<'a>(fits: &'a Value, run: &str, key: &str) -> &'a Value {
    let fits = fits["fits"].as_array().unwrap();
    let fit = fits.iter().find(|fit| fit["run"] == run).unwrap();
    &fit["parameters"][key]
}

#[test]
fn the_worked_example_is_simulated_taken_in_and_fitted() {
    let folder = CampaignFolder::new();
    folder.write("simulation.toml", worked_example());
    let told = folder.path().join("simulation.toml");
    let simulated = ieap(folder.path(), &["simulate", told.to_str().unwrap(), "--json"]).expect(0);
    assert_eq!(simulated.json()["written"].as_array().unwrap().len(), 7);
    let key = std::fs::read_to_string(folder.join("truth.json")).unwrap();
    let key: Value = serde_json::from_str(&key).unwrap();
    let hidden = |run: usize| key["runs"][run]["effects"].as_array().unwrap().len();
    assert_eq!([hidden(0), hidden(1), hidden(2)], [1, 2, 0]);
    let fits = folder.ieap(&["fit", "--json"]).expect(0).json();
    assert_eq!(fits["fits"].as_array().unwrap().len(), 3);
    // 2e-5 (e^4 - 1) A/cm2 beside 2 V / 5600 Ohm cm2: the base model takes the hidden leak for a lower R_ss.
    let leak = 2.0 / (2.0 / 5600.0 + 2e-5 * 4.0_f64.exp_m1());
    for (run, expected) in [("runs/plus.csv", leak), ("runs/back.csv", 5600.0)] {
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
        assert!(margin < 0.2 * expected, "{run}: {found}");
    }
}

#[test]
fn an_effect_that_is_not_known_is_refused_and_nothing_is_written() {
    let folder = CampaignFolder::new();
    let spec = worked_example().replace("faradaic-leak", "faraday");
    folder.write("simulation.toml", spec);
    let ended = ieap(folder.path(), &["simulate", "simulation.toml"]).expect(2);
    assert!(
        ended
            .stderr
            .contains("effect \"faraday\" is not known; known are series-resistance"),
        "{ended:?}"
    );
    assert!(!folder.join("truth.json").exists() && !folder.join("runs/plus.csv").exists());
}

#[test]
fn every_effect_stands_on_the_page_with_its_variants_and_parameters() {
    let page = docs();
    for effect in KNOWN {
        let row = page
            .lines()
            .find(|line| line.starts_with(&format!("| `{}` |", effect.id)));
        let row = row.unwrap_or_else(|| panic!("{} is not on the page", effect.id));
        assert!(
            effect.variants.iter().all(|variant| row.contains(variant)),
            "{row}"
        );
        let keys = effect.parameters.iter();
        assert!(
            keys.into_iter()
                .all(|parameter| row.contains(&format!("`{}`", parameter.key))),
            "{row}"
        );
    }
}
