//! Chambers: pressure, oxygen and water as measured series beside humidity and temperature; and materials compared by
//! what they are made of.

use std::fmt::Write as _;

use serde_json::Value;

use crate::campaign::{CampaignFolder, chosen_tag, run_issues, run_table};

const TOML: &str = r#"
[campaign]
id = "chamber"
title = "A chamber"
timezone = "Europe/Tallinn"

[[sample]]
id = "S1"
material = "CNaf"
length_mm = 5.0
width_mm = 2.0

[[sample]]
id = "S2"
material = "PtNaf"
length_mm = 5.0
width_mm = 2.0

[[material]]
id = "CNaf"
electrode = "carbon"
membrane = "Nafion 117"

[[material]]
id = "PtNaf"
electrode = "platinum"
membrane = "Nafion 117"

[[sensor]]
id = "gauge"
files = "vacuum/"
environments = ["vacuum"]

[climate]
water_limit_ppm = 1.0
"#;

fn log(header: &str, row: impl Fn(u32) -> String) -> String {
    let mut text = format!("date;{header}\n");
    for minute in 0..60 {
        writeln!(text, "2026-03-01 10:{minute:02}:00;{}", row(minute)).unwrap();
    }
    text
}

fn folder() -> CampaignFolder {
    let folder = CampaignFolder::new();
    folder.write("campaign.toml", TOML);
    // Half a millibar that does not move for forty minutes; traces of a glove box, water rising above its limit.
    folder.write(
        "ambient/vacuum/gauge.csv",
        log("Pressure (mbar)", |minute| {
            if minute < 40 { "0.55" } else { "0.85" }.to_owned()
        }),
    );
    folder.write(
        "ambient/box.csv",
        log("O2 (ppm);H2O (ppm)", |minute| {
            format!("0.{};{:.2}", 4 + minute % 2, 0.5 + 0.04 * f64::from(minute))
        }),
    );
    for (name, sample, environment, minute) in [
        ("a", "S1", "vacuum", 10),
        ("b", "S1", "inert", 10),
        ("c", "S2", "inert", 0),
        ("d", "S1", "air", 10),
        ("e", "S1", "vacuum", 37),
    ] {
        folder.write(
            &format!("runs/{name}.csv"),
            run_table(u32::from(name.as_bytes()[0])),
        );
        let tags = format!(
            "sample = \"{sample}\"\nenvironment = \"{environment}\"\nstarted_at = \"2026-03-01T10:{minute:02}:00+02:00\"\n"
        );
        folder.write(&format!("runs/{name}.csv.toml"), tags);
    }
    folder
}

fn tag(folder: &CampaignFolder, run: &str, key: &str) -> Option<f64> {
    chosen_tag(folder.path(), run, key).map(|value| value.parse().unwrap())
}

/// Runs with an issue of that code.
fn issues(folder: &CampaignFolder, code: &str) -> Vec<String> {
    let found = run_issues(folder.path(), code).into_iter();
    found.map(|(run, _)| run).collect()
}

#[test]
fn pressure_oxygen_and_water_reach_the_runs_that_they_speak_for() {
    let folder = folder();
    folder.ieap(&["run", "--no-diagnose", "--quiet"]).expect(0);
    assert_eq!(tag(&folder, "runs/a.csv", "pressure_pa"), Some(55.0));
    assert_eq!(tag(&folder, "runs/b.csv", "pressure_pa"), None);
    let oxygen = tag(&folder, "runs/b.csv", "oxygen_ppm").unwrap();
    assert!((0.4..=0.5).contains(&oxygen), "{oxygen}");
    assert!(tag(&folder, "runs/b.csv", "water_ppm").is_some_and(|ppm| ppm > 0.5));
    // The analyser stands at the glove box: it knows nothing of air or vacuum.
    for run in ["runs/a.csv", "runs/d.csv"] {
        assert_eq!(tag(&folder, run, "oxygen_ppm"), None, "{run}");
    }
    let page = folder.report("climate.html");
    for title in ["Pressure (Pa)", "Oxygen (ppm)", "Water (ppm)"] {
        assert!(page.contains(title), "{title}");
    }
    // The water passed 1 ppm in run b and not in run c, ten minutes earlier; the vacuum jumped in run e alone.
    assert_eq!(issues(&folder, "climate-above-limit"), ["runs/b.csv"]);
    assert_eq!(issues(&folder, "climate-left-tolerance"), ["runs/e.csv"]);
    for said in ["above the limit of 1 ppm", "the pressure left the tolerance"] {
        assert!(page.contains(said), "{said}");
    }
}

#[test]
fn materials_are_compared_by_what_they_are_made_of() {
    let folder = folder();
    folder.ieap(&["run", "--no-diagnose", "--quiet"]).expect(0);
    let materials = |arguments: &[&str]| -> Vec<String> {
        let document: Value = folder.ieap(arguments).expect(0).json();
        let rows = document["rows"].as_array().unwrap().iter();
        let mut found: Vec<String> = rows
            .map(|row| row["cells"]["material"]["text"].as_str().unwrap_or("").to_owned())
            .collect();
        found.sort();
        found.dedup();
        found
    };
    let table = ["table", "conditions", "--format", "json"];
    assert_eq!(materials(&table), ["CNaf", "PtNaf"]);
    let by = |class: &str| materials(&[&table[..], &["--by", class]].concat());
    assert_eq!(by("electrode"), ["carbon", "platinum"]);
    assert_eq!(by("membrane"), ["Nafion 117"]);
    // What no material states leaves the materials as they are.
    assert_eq!(by("electrolyte"), ["CNaf", "PtNaf"]);
    folder.ieap(&["table", "conditions", "--by", "colour"]).expect(2);
    // A table of single runs puts nothing together, and says so.
    let refused = folder.ieap(&["table", "runs", "--by", "electrode"]).expect(2);
    assert!(refused.stderr.contains("conditions"), "{refused:?}");
    folder.write(
        "campaign.toml",
        format!("{TOML}\n[compare]\nby = \"electrode\"\n"),
    );
    folder.ieap(&["report", "--quiet"]).expect(0);
    let page = folder.report("parameters.html");
    assert!(page.contains("platinum") && page.contains("carbon"), "{page}");
    // A run stays one of its material.
    assert_eq!(
        materials(&["table", "runs", "--format", "json"]),
        ["CNaf", "PtNaf"]
    );
    folder.write("campaign.toml", format!("{TOML}\n[compare]\nby = \"colour\"\n"));
    let refused = folder.ieap(&["report"]);
    assert!(
        refused.status != 0 && refused.stderr.contains("electrode, membrane"),
        "{refused:?}"
    );
}
