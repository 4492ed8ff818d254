//! The main job as its user sees it: files in, fits and a report out, once and again.

use serde_json::Value;

use crate::campaign::{CampaignFolder, ieap, run_table};

fn parameter(fit: &Value, key: &str) -> Value {
    fit["parameters"][key].clone()
}

#[test]
fn files_become_runs_fits_and_a_report_and_a_second_run_changes_nothing() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.write("runs/sub/b.csv", run_table(2));
    let first = folder.run_json();
    assert_eq!(
        first["ingest"]["new"],
        serde_json::json!(["runs/a.csv", "runs/sub/b.csv"])
    );
    assert_eq!(first["fit"]["fitted"], 2);
    assert_eq!(first["report"]["rendered"], true);
    let index = folder.report("index.html");
    let again = folder.run_json();
    assert_eq!(again["ingest"]["new"], serde_json::json!([]));
    assert_eq!(again["fit"]["fitted"], 0);
    assert_eq!(again["report"]["rendered"], false);
    assert_eq!(folder.report("index.html"), index);
}

#[test]
fn fits_follow_the_contract_and_find_the_truth() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    let document = folder.ieap(&["fit", "--json"]).expect(0).json();
    assert_eq!(document["schema"], "ieap/fits/1");
    let fit = &document["fits"][0];
    assert_eq!(fit["run"], "runs/a.csv");
    assert_eq!((&fit["sample"], &fit["material"]), (&"S1".into(), &"CNaf".into()));
    assert_eq!(
        (&fit["environment"], &fit["voltage_v"]),
        (&"air".into(), &Value::from(2.0))
    );
    // 1e-3 A at 2 V on 0.1 cm2 is 200 Ohm cm2; tau = 20 s; 2e-5 A is 10 kOhm cm2.
    for (key, truth) in [
        ("c_total_f_per_cm2", 0.1),
        ("rss_ohm_cm2", 1e4),
        ("lambda_per_s", 2e-3),
    ] {
        let estimate = parameter(fit, key);
        let (low, high) = (
            estimate["low_95"].as_f64().unwrap(),
            estimate["high_95"].as_f64().unwrap(),
        );
        // One interval in twenty misses; four standard errors is far beyond chance.
        let margin = high - low;
        assert!(low - margin < truth && truth < high + margin, "{key}: {estimate}");
    }
}

#[test]
fn the_same_bytes_are_fitted_alike_at_any_number_of_threads() {
    let outcome = |threads: &str| {
        let folder = CampaignFolder::new();
        (0..5).for_each(|n| folder.write(&format!("runs/{n}.csv"), run_table(n)));
        folder
            .ieap(&["fit", "--json", "--threads", threads])
            .expect(0)
            .stdout
    };
    assert_eq!(outcome("1"), outcome("4"));
}

#[test]
fn copies_are_aliases_new_content_is_a_revision_and_a_moved_file_keeps_its_run() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.write("runs/copy of a.csv", run_table(1));
    let first = folder.run_json();
    assert_eq!(first["ingest"]["new"].as_array().unwrap().len(), 1);
    assert_eq!(
        first["ingest"]["aliases"],
        serde_json::json!(["runs/copy of a.csv"])
    );

    folder.write("runs/a.csv", run_table(7));
    let second = folder.run_json();
    // Its bytes lie under the other name, which is its own now.
    assert_eq!(second["ingest"]["new"], serde_json::json!(["runs/a.csv"]));

    std::fs::rename(folder.join("runs/a.csv"), folder.join("runs/renamed.csv")).unwrap();
    let third = folder.run_json();
    assert_eq!(
        third["ingest"]["renamed"],
        serde_json::json!([["runs/a.csv", "runs/renamed.csv"]])
    );
    let document = folder.ieap(&["fit", "--json"]).expect(0).json();
    let names: Vec<&str> = document["fits"]
        .as_array()
        .unwrap()
        .iter()
        .map(|f| f["run"].as_str().unwrap())
        .collect();
    assert!(
        names.contains(&"runs/renamed.csv") && !names.contains(&"runs/a.csv"),
        "{names:?}"
    );
}

#[test]
fn a_removed_file_leaves_its_run_and_a_missing_runs_folder_removes_nothing() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    std::fs::remove_file(folder.join("runs/a.csv")).unwrap();
    let summary = folder.run_json();
    assert_eq!(summary["ingest"]["gone"], serde_json::json!(["runs/a.csv"]));
    assert_eq!(
        folder.ieap(&["fit", "--json"]).expect(0).json()["fits"]
            .as_array()
            .unwrap()
            .len(),
        1
    );
    std::fs::rename(folder.join("runs"), folder.join("away")).unwrap();
    let offline = folder.ieap(&["run", "--no-diagnose"]);
    assert_ne!(offline.status, 0);
    assert!(offline.stderr.contains("runs folder is not there"), "{offline:?}");
}

#[test]
fn tags_arrive_later_by_hand_or_by_sidecar_and_are_recorded() {
    let folder = CampaignFolder::new();
    std::fs::remove_file(folder.join("runs/tags.toml")).unwrap();
    folder.write("runs/a.csv", run_table(1));
    folder.write("runs/b.csv", run_table(2));
    let first = folder.run_json();
    assert_eq!(first["ingest"]["untagged"].as_array().unwrap().len(), 2);
    assert_eq!(first["fit"]["fitted"], 0);
    let tagged = folder
        .ieap(&["tag", "runs/a.csv", "sample=S1", "environment=air"])
        .expect(0);
    assert!(
        tagged.stdout.contains("ready") && tagged.stdout.contains("set by hand"),
        "{tagged:?}"
    );
    folder.write("runs/b.csv.toml", "sample = \"S1\"\nenvironment = \"vacuum\"\n");
    let second = folder.run_json();
    assert_eq!(second["fit"]["fitted"], 2);
    assert_eq!(second["ingest"]["untagged"], serde_json::json!([]));
    let unknown = folder.ieap(&["tag", "runs/c.csv", "sample=S1"]).expect(2);
    assert!(unknown.stderr.contains("no run is called"), "{unknown:?}");
}

#[test]
fn a_changed_campaign_file_changes_what_follows_from_it() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    let before = folder.ieap(&["fit", "--json"]).expect(0).json();
    let wider = crate::campaign::CAMPAIGN_TOML.replace("width_mm = 2.0", "width_mm = 4.0");
    folder.write("campaign.toml", wider);
    let after = folder.ieap(&["fit", "--json"]).expect(0).json();
    let total = |document: &Value| {
        document["fits"][0]["parameters"]["c_total_f_per_cm2"]["value"]
            .as_f64()
            .unwrap()
    };
    // Twice the area, half the capacitance per area.
    assert!((total(&before) / total(&after) - 2.0).abs() < 1e-6);
}

#[test]
fn parts_of_a_run_are_joined_by_their_stem() {
    let folder = CampaignFolder::new();
    let whole = run_table(3);
    let part = |columns: &[usize]| -> String {
        let line = |line: &str| -> String {
            let cells: Vec<&str> = line.split(',').collect();
            columns.iter().map(|&c| cells[c]).collect::<Vec<_>>().join(",") + "\n"
        };
        whole.lines().map(line).collect()
    };
    folder.write("runs/a.current.csv", part(&[0, 1, 2]));
    folder.write("runs/a.curvature.csv", part(&[0, 3]));
    let document = folder.ieap(&["fit", "--json"]).expect(0).json();
    let fits = document["fits"].as_array().unwrap();
    assert_eq!(fits.len(), 1, "{document:#}");
    assert_eq!(fits[0]["run"], "runs/a.csv");
    assert!(parameter(&fits[0], "alpha_per_c_cm")["value"].is_number());
}

#[test]
fn a_tip_displacement_gives_curvature_through_the_length() {
    let folder = CampaignFolder::new();
    let mut text = String::from("time_s,voltage_v,current_a,tip_displacement_mm\n");
    for line in run_table(4).lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        // Inverse of kappa = 2 d / (L^2 + d^2) at L = 0.5 cm for small bending.
        let kappa: f64 = cells[3].parse().unwrap();
        let d_cm = if kappa == 0.0 {
            0.0
        } else {
            (1.0 - (1.0 - kappa * kappa * 0.25).sqrt()) / kappa
        };
        text += &format!("{},{},{},{:.6}\n", cells[0], cells[1], cells[2], d_cm * 10.0);
    }
    folder.write("runs/tip.csv", text);
    folder.write("runs/kappa.csv", run_table(4));
    let document = folder.ieap(&["fit", "--json"]).expect(0).json();
    let alpha = |name: &str| {
        let fits = document["fits"].as_array().unwrap();
        let fit = fits.iter().find(|fit| fit["run"] == name).unwrap();
        parameter(fit, "alpha_per_c_cm")["value"].as_f64().unwrap()
    };
    assert!((alpha("runs/tip.csv") / alpha("runs/kappa.csv") - 1.0).abs() < 1e-3);
}

#[test]
fn init_makes_a_campaign_that_runs() {
    let root = tempfile::tempdir().unwrap();
    ieap(root.path(), &["init", "new"]).expect(0);
    let ended = ieap(root.path(), &["run", "new", "--no-diagnose"]).expect(0);
    assert!(
        ended.stdout.contains("Report: new/report/index.html"),
        "{ended:?}"
    );
    assert!(root.path().join("new/report/index.html").exists());
    ieap(root.path(), &["init", "new"]).expect(2);
    let nowhere = ieap(root.path(), &["run", "--no-diagnose"]).expect(2);
    assert!(nowhere.stderr.contains("ieap init"), "{nowhere:?}");
}

#[test]
fn exports_hold_every_fit_and_reading() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    folder
        .ieap(&["export", "--what", "fits", "-o", "fits.csv"])
        .expect(0);
    let fits = std::fs::read_to_string(folder.join("fits.csv")).unwrap();
    assert!(fits.lines().next().unwrap().contains("low_95"), "{fits}");
    folder
        .ieap(&["export", "--what", "traces", "-o", "traces.csv"])
        .expect(0);
    let traces = std::fs::read_to_string(folder.join("traces.csv")).unwrap();
    // 320 readings of voltage, current and curvature, and the header.
    assert_eq!(traces.lines().count(), 3 * 320 + 1);
    folder
        .ieap(&["export", "--what", "traces", "-o", "traces.parquet"])
        .expect(0);
    let parquet = std::fs::read(folder.join("traces.parquet")).unwrap();
    assert!(parquet.starts_with(b"PAR1") && parquet.ends_with(b"PAR1"));
    folder.ieap(&["export", "-o", "fits.csv"]).expect(2);
    folder.ieap(&["export", "-o", "fits.ods"]).expect(2);
}

#[test]
fn an_open_circuit_is_told_by_a_column_or_by_a_tag() {
    let table = run_table(3);
    let mut lines = table.lines();
    let header = lines.next().unwrap();
    let (mut plain, mut column) = (format!("{header}\n"), format!("{header},open_circuit\n"));
    for line in lines {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        let time_s: f64 = cells[0].parse().unwrap();
        let open = (100.0..200.0).contains(&time_s);
        if open {
            // What a voltmeter shows while nothing holds the voltage.
            cells[1] = format!("{:.3}", 1.9 - 0.004 * (time_s - 100.0));
        }
        plain += &(cells.join(",") + "\n");
        column += &format!("{},{open}\n", cells.join(","));
    }
    let tags = "sample = \"S1\"\nenvironment = \"air\"\nvoltage_v = 2.0\n";
    let files = [
        ("column", &column, ""),
        ("tag", &plain, "open_circuit = \"100-200\"\n"),
        ("list", &plain, "open_circuit = [[100.0, 200.0]]\n"),
        ("untold", &plain, ""),
    ];
    // In one campaign they would be one measurement.
    let made = files.map(|(name, text, tag)| {
        let folder = CampaignFolder::new();
        folder.write(&format!("runs/{name}.csv"), text);
        folder.write(&format!("runs/{name}.csv.toml"), format!("{tags}{tag}"));
        let document = folder.ieap(&["fit", "--json"]).expect(0).json();
        let status = folder.ieap(&["status"]).expect(0).stdout;
        (document["fits"][0]["parameters"].clone(), status)
    });
    assert!(made[0].0.is_object());
    assert!(made[..3].iter().all(|(parameters, _)| *parameters == made[0].0));
    let (untold, status) = &made[3];
    assert!(
        untold.is_null() && status.contains("as where an open circuit is not stated"),
        "{status}"
    );
}
