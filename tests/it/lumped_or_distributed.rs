//! Effects along the strip, hidden in run files by the ladder: the resistance of the electrodes is named from places,
//! a cracked foil is found and placed, and an even strip is left in peace.

use ieap::domain::Drive;
use ieap::model::coupling::CurvaturePerLineCharge;
use ieap::model::distributed::{DistributedModel, Ladder};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::campaign::{CAMPAIGN_TOML, CampaignFolder};

/// A strip of 28 mm by 5 mm.
fn strip(electrode_resistance_ohm_per_cm: f64) -> DistributedModel {
    DistributedModel {
        electrode_resistance_ohm_per_cm,
        branch_resistance_ohm_cm: 9.0,
        capacitance_f_per_cm: 0.0655,
        steady_state_resistance_ohm_cm: 45.4,
        length_cm: 2.8,
        coupling: CurvaturePerLineCharge(5.88),
        relaxation_rate_per_s: 0.0029,
    }
}

/// A run file with the current and curvatures at nine places.
fn table(model: &DistributedModel, contact_break: Option<(f64, f64)>, seed: u64) -> String {
    const CELLS: usize = 180;
    let cells: Vec<usize> = (0..9).map(|k| 10 + 20 * k).collect();
    let mut ladder = Ladder::new(model, CELLS).unwrap();
    if let Some((place_cm, factor)) = contact_break {
        ladder = ladder.broken(place_cm, factor);
    }
    let times: Vec<f64> = (0..240).map(|k| f64::from(k) * 0.5).collect();
    let truth = ladder.respond(&Drive::step(1.5), &times, 1e-7);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut noise = |sd: f64| -> f64 {
        let drawn: f64 = StandardNormal.sample(&mut random);
        sd * drawn
    };
    let mut text = String::from("time_s,current_a");
    for cell in &cells {
        text += &format!(",curvature_per_cm@{:.4}", 10.0 * truth.arc_length_cm[*cell]);
    }
    text += "\n";
    for (k, t) in times.iter().enumerate() {
        text += &format!("{t:.3},{:.6e}", truth.clamp_current_a[k] + noise(1e-3));
        for cell in &cells {
            text += &format!(",{:.6}", truth.curvature_per_cm.at(k, *cell) + noise(3e-3));
        }
        text += "\n";
    }
    text
}

fn campaign(text: &str) -> CampaignFolder {
    let folder = CampaignFolder::new();
    let strip = "length_mm = 28.0\nwidth_mm = 5.0\n";
    folder.write(
        "campaign.toml",
        CAMPAIGN_TOML.replace("length_mm = 5.0\nwidth_mm = 2.0\n", strip),
    );
    folder.write("runs/a.csv", text);
    folder.write("runs/a.csv.toml", "voltage_v = 1.5\n");
    folder
}

fn note<'a>(fit: &'a serde_json::Value, code: &str) -> Option<&'a str> {
    let issues = fit["issues"].as_array()?;
    let issue = issues.iter().find(|issue| issue["code"] == code)?;
    issue["message"].as_str()
}

#[test]
fn resistance_along_the_strip_is_named_from_places() {
    let folder = campaign(&table(&strip(5.0), None, 5));
    let document = folder.ieap(&["diagnose", "--json"]).expect(0).json();
    let group = &document["groups"][0];
    assert_eq!(group["verdict"], "law", "{group:#}");
    assert_eq!(group["set"], serde_json::json!(["lengthwise-resistance"]));
    let fits = folder.ieap(&["fit", "--json"]).expect(0).json();
    let told = note(&fits["fits"][0], "lumped-or-distributed").unwrap();
    assert!(told.starts_with("distributed: 9 places"), "{told}");
    // Every verb says it, in text and for machines.
    let file = folder.join("runs/a.csv");
    let inspected = ["inspect", file.to_str().unwrap(), "--json"];
    let inspected = folder.ieap(&inspected).expect(0).json();
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    let diagnosed = folder.ieap(&["diagnose", "--json"]).expect(0).json();
    for told in [
        &fits["fits"][0]["lumped_or_distributed"],
        &diagnosed["groups"][0]["lumped_or_distributed"][0],
        &diagnosed["runs"][0]["lumped_or_distributed"],
        &inspected["stored"]["lumped_or_distributed"],
        &status["status"]["lumped_or_distributed"][0],
    ] {
        assert_eq!(
            (&told["run"], &told["verdict"]),
            (&"runs/a.csv".into(), &"distributed".into()),
            "{told:#}"
        );
    }
    let status = folder.ieap(&["status"]).expect(0).stdout;
    assert!(
        status.contains("lumped or distributed: 1 distributed"),
        "{status}"
    );
    // The run's page says so in the same words.
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let pages = std::fs::read_dir(folder.join("report/runs")).unwrap();
    let mut pages = pages.map(|page| std::fs::read_to_string(page.unwrap().path()).unwrap());
    assert!(pages.any(|page| page.contains("Distributed: 9 places")));
}

/// R_e L^2 over R_c of 30, as PtNaf of the thesis's table 3 has it.
#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn a_strip_that_resists_as_strongly_as_ptnaf_is_named_from_places() {
    let strong = strip(30.0 * 9.0 / (2.8 * 2.8));
    let folder = campaign(&table(&strong, None, 8));
    let document = folder.ieap(&["diagnose", "--json"]).expect(0).json();
    let group = &document["groups"][0];
    assert_eq!(group["verdict"], "law", "{group:#}");
    assert_eq!(group["set"], serde_json::json!(["lengthwise-resistance"]));
}

/// Differences are claimed from p < 0.05 on: of four even strips two are called uneven by chance in 1 of 70 cases.
#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn even_strips_are_left_in_peace() {
    let folder = campaign(&table(&strip(1e-3), None, 6));
    for (name, seed) in [("b", 16), ("c", 26), ("d", 36)] {
        folder.write(&format!("runs/{name}.csv"), table(&strip(1e-3), None, seed));
        folder.write(&format!("runs/{name}.csv.toml"), "voltage_v = 1.5\n");
    }
    let document = folder.ieap(&["diagnose", "--json"]).expect(0).json();
    let group = &document["groups"][0];
    assert!(
        ["right", "undecided"].contains(&group["verdict"].as_str().unwrap()),
        "{group:#}"
    );
    let fits = folder
        .ieap(&["fit", "--json", "--model", "distributed"])
        .expect(0)
        .json();
    let fits = fits["fits"].as_array().unwrap();
    assert_eq!(fits.len(), 4);
    let told = |fit: &serde_json::Value| note(fit, "lumped-or-distributed").unwrap().to_owned();
    let even: Vec<_> = fits
        .iter()
        .filter(|fit| told(fit).starts_with("lumped: 9 places"))
        .collect();
    assert!(even.len() >= 3, "{:?}", fits.iter().map(told).collect::<Vec<_>>());
    for fit in even {
        assert!(fit["parameters"]["re_ohm_per_sq"]["value"].is_null(), "{fit:#}");
        assert!(note(fit, "contact-break").is_none());
    }
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn a_cracked_foil_is_found_and_placed() {
    let folder = campaign(&table(&strip(5.0), Some((1.5, 4.0)), 7));
    let fits = folder
        .ieap(&["fit", "--json", "--model", "distributed", "--simultaneous"])
        .expect(0)
        .json();
    let fit = &fits["fits"][0];
    assert!(note(fit, "contact-break").unwrap().contains("mm on"), "{fit:#}");
    for (key, truth) in [("place_mm", 15.0), ("resistance_factor", 4.0)] {
        let found = &fit["parameters"][format!("contact-break.{key}")];
        let bound = |name: &str| found[name].as_f64().unwrap();
        let (low, high) = (bound("low_95"), bound("high_95"));
        let margin = high - low;
        assert!(low - margin < truth && truth < high + margin, "{key}: {found:#}");
        assert!(margin < 0.2 * truth, "{key}: {found:#}");
    }
}
