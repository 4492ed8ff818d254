//! The four-point probe as its user sees it: a table in probe/, tags of runs, cracks, and what it makes of a fit.

use std::fmt::Write as _;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde_json::Value;

use crate::campaign::{CampaignFolder, chosen_tag, run_issues, run_table};

/// Readings every third day from 1 March 2026: 2.5 Ohm/sq with an error of 2 %, a crack to 4 before the 15th.
fn table(readings: usize) -> String {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut text = "date,sample,resistance_ohm_per_sq,standard_error_ohm_per_sq,flexings\n".to_owned();
    for k in 0..readings {
        let noise: f64 = StandardNormal.sample(&mut random);
        let truth = if k >= 14 { 4.0 } else { 2.5 };
        let date = jiff::civil::date(2026, 3, 1) + jiff::Span::new().days(3 * k as i64);
        writeln!(
            text,
            "{date},S1,{:.4},{:.4},{}",
            truth * (1.0 + 0.02 * noise),
            0.02 * truth,
            100 * k
        )
        .unwrap();
    }
    text
}

fn folder() -> CampaignFolder {
    let folder = CampaignFolder::new();
    folder.write("probe/keithley.csv", table(24));
    // Half-way between the readings of 7 and 10 March; and far after the last one.
    folder.write("runs/early.csv", run_table(1));
    folder.write(
        "runs/early.csv.toml",
        "started_at = \"2026-03-08T23:00:00+02:00\"\n",
    );
    folder.write("runs/late.csv", run_table(2));
    folder.write(
        "runs/late.csv.toml",
        "started_at = \"2026-09-01T12:00:00+03:00\"\n",
    );
    folder
}

fn tag(folder: &CampaignFolder, run: &str, key: &str) -> Option<f64> {
    chosen_tag(folder.path(), run, key).map(|value| value.parse().unwrap())
}

fn cell<'a>(document: &'a Value, row: usize, key: &str) -> &'a Value {
    &document["rows"][row]["cells"][key]
}

#[test]
fn runs_get_what_the_probe_read_and_a_crack_is_told() {
    let folder = folder();
    folder.ieap(&["run", "--no-diagnose", "--quiet"]).expect(0);
    let near = |key: &str, value: f64, within: f64| {
        let found = tag(&folder, "runs/early.csv", key).unwrap_or_else(|| panic!("{key}"));
        assert!((found - value).abs() < within, "{key}: {found}");
    };
    near("electrode_resistance_ohm_per_sq", 2.5, 0.1);
    near("electrode_resistance_error_ohm_per_sq", 0.035, 0.03);
    near("flexings", 250.0, 10.0);
    assert_eq!(
        tag(&folder, "runs/late.csv", "electrode_resistance_ohm_per_sq"),
        None
    );
    let (_, said) = run_issues(folder.path(), "probe-not-covered").remove(0);
    assert!(said.contains("more than 7"), "{said}");
    let page = folder.report("monitoring.html");
    assert!(page.contains("Electrodes of S1: A crack"), "{page}");
    assert!(
        page.contains("between 2026-04-09 and 2026-04-12, by 1400 flexings"),
        "{page}"
    );
    let document = folder
        .ieap(&["table", "electrodes", "--format", "json"])
        .expect(0)
        .json();
    assert_eq!(document["rows"].as_array().unwrap().len(), 24);
    assert!(
        cell(&document, 14, "event")["text"]
            .as_str()
            .unwrap()
            .starts_with("crack: × 1.6"),
        "{document:#}"
    );
    // The climate knows nothing of it.
    assert!(!folder.report("climate.html").contains("keithley"));
    // Nothing new: nothing is done. A database made anew is the same.
    let again = folder.run_json();
    assert_eq!(again["ingest"]["logs"]["new"], serde_json::json!([]), "{again:#}");
    folder.ieap(&["verify", "--deep", "--quiet"]).expect(0);
}

#[test]
fn a_table_that_comes_later_tags_runs_again_and_a_bad_one_is_told() {
    let folder = folder();
    std::fs::remove_file(folder.join("probe/keithley.csv")).unwrap();
    folder.ieap(&["ingest", "--quiet"]).expect(0);
    assert_eq!(
        tag(&folder, "runs/early.csv", "electrode_resistance_ohm_per_sq"),
        None
    );
    folder.write("probe/keithley.csv", table(24));
    folder.ieap(&["ingest", "--quiet"]).expect(0);
    assert!(tag(&folder, "runs/early.csv", "electrode_resistance_ohm_per_sq").is_some());
    folder.write("probe/no-unit.csv", "date,sample,resistance\n2026-03-01,S1,2.5\n");
    let ended = folder.ieap(&["ingest"]).expect(3);
    assert!(
        ended.stderr.contains("no-unit.csv") || ended.stdout.contains("no-unit.csv"),
        "{ended:?}"
    );
}
