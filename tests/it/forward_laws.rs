//! `predict` from fits that have a law beside the model: it acts under a drive that was not measured.

use std::path::Path;

use serde_json::Value;

use crate::campaign::CampaignFolder;

const THESIS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/campaigns/thesis");
const HELD_OUT: &str = "PtNaf_air_2.25V.csv";

/// The runs of PtNaf but one, fitted with the leak that is hidden in them, or with the model alone.
fn without_one(has_law: bool) -> CampaignFolder {
    let folder = CampaignFolder::new();
    let mut campaign = std::fs::read_to_string(Path::new(THESIS).join("campaign.toml")).unwrap();
    if has_law {
        campaign += "\n[[adopted]]\ngroup = \"sample=PtNaf-1,environment=air\"\nmodel = \"lumped-2 + faradaic-leak\"\n";
    }
    folder.write("campaign.toml", campaign);
    let runs = Path::new(THESIS).join("runs/PtNaf/air");
    for entry in std::fs::read_dir(runs).unwrap() {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        if !name.starts_with(HELD_OUT) {
            folder.write(
                &format!("runs/PtNaf/air/{name}"),
                std::fs::read(entry.path()).unwrap(),
            );
        }
    }
    folder.ieap(&["run", "--no-diagnose", "--quiet"]).expect(0);
    folder
}

/// What was read at these times in the run that was held out, A.
fn read_a(times: &[f64]) -> Vec<f64> {
    let text = std::fs::read_to_string(Path::new(THESIS).join("runs/PtNaf/air").join(HELD_OUT)).unwrap();
    let number = |cell: Option<&str>| cell.and_then(|cell| cell.parse::<f64>().ok());
    let rows: Vec<(f64, f64)> = text
        .lines()
        .filter_map(|line| {
            let mut cells = line.split(',');
            Some((number(cells.next())?, number(cells.nth(1))?))
        })
        .collect();
    let at = |time: &f64| rows.iter().find(|row| row.0 == *time).unwrap().1;
    times.iter().map(at).collect()
}

/// The current that is predicted at these times, with half its interval, A.
fn predicted_a(folder: &CampaignFolder, at: &str) -> (Value, Vec<(f64, f64)>) {
    let asked = [
        "predict",
        "--sample",
        "PtNaf-1",
        "--voltage",
        "2.25V",
        "--at",
        at,
        "--json",
    ];
    let document = folder.ieap(&asked).expect(0).json();
    let current = |row: &Value| {
        let number = |key: &str| row["current_a"][key].as_f64().unwrap();
        (number("value"), 0.5 * (number("high_95") - number("low_95")))
    };
    let rows = document["rows"].as_array().unwrap().iter().map(current).collect();
    (document, rows)
}

#[test]
fn a_law_that_was_adopted_predicts_a_drive_that_was_not_measured() {
    let times = [2.0, 5.0, 10.0, 30.0, 60.0, 100.0, 300.0, 600.0, 1200.0, 3600.0];
    let at = times.map(|time| time.to_string()).join(",");
    let (noise_a, read) = (2e-6, read_a(&times));
    let (with_law, alone) = (without_one(true), without_one(false));
    let (document, lawful) = predicted_a(&with_law, &at);
    let held = lawful
        .iter()
        .zip(&read)
        .filter(|((value, half), read)| (value - **read).abs() <= half.hypot(2.0 * noise_a));
    assert!(held.count() >= 8, "{lawful:?} {read:?}");
    // The model alone takes the leak for one that goes with the voltage: its interval has to hold that.
    let (_, plain) = predicted_a(&alone, &at);
    let wide = |all: &[(f64, f64)]| all.iter().map(|(_, half)| half).sum::<f64>();
    assert!(wide(&lawful) < 0.5 * wide(&plain), "{lawful:?} {plain:?}");
    let remarks = document["remarks"].to_string();
    assert!(
        remarks.contains("Fitted with lumped-2 + faradaic-leak"),
        "{remarks}"
    );
    // Nobody measured how the law goes with the size.
    let longer = [
        "predict",
        "--sample",
        "PtNaf-1",
        "--voltage",
        "2.25V",
        "--length",
        "9mm",
    ];
    let refused = with_law.ieap(&longer).expect(2).stderr;
    assert!(
        refused.contains("whose laws are known of that strip"),
        "{refused}"
    );
}
