//! What a step says without a model, and a train cycle by cycle, as their user sees them: the table, the page of the run,
//! and why a number is missing.

use std::fmt::Write;

use ieap::domain::Drive;
use ieap::domain::testing::branch;
use ieap::model::LumpedModel;
use serde_json::Value;

use crate::campaign::CampaignFolder;

const SPEC: &str = r#"[simulation]
seed = 11
folder = "runs"
statement = ["SIMULATED, not measured."]
baseline_s = 10.0

[noise]
current_a = 2e-6
curvature_per_cm = 2e-3

[[sampling]]
until_s = 60.0
every_s = 0.2
[[sampling]]
until_s = 1500.0
every_s = 2.0

[[run]]
file = "step.csv"
area_cm2 = 0.1
voltage_v = 2.0
parameters = { r1_ohm_cm2 = 521.4, c1_f_per_cm2 = 0.098, r2_ohm_cm2 = 2629.9, c2_f_per_cm2 = 0.13, rss_ohm_cm2 = 5660.0, alpha_per_c_cm = 13.88, lambda_per_s = 4e-3 }
tags = { sample = "S1", environment = "air", relative_humidity_percent = 34, voltage_v = 2.0 }
"#;

/// The strip of [`SPEC`], against which the numbers are held: every number by a fine search on its own course.
fn strip() -> LumpedModel {
    LumpedModel {
        branches: vec![branch(521.4, 0.098), branch(2629.9, 0.13)],
        steady_state_resistance_ohm_cm2: 5660.0,
        charge_to_curvature_per_c_cm: 13.88,
        relaxation_rate_per_s: 4e-3,
    }
}

fn cell<'a>(table: &'a Value, key: &str) -> &'a Value {
    &table["rows"][0]["cells"][key]
}

#[test]
fn a_step_is_told_without_a_model_in_the_table_and_on_its_page() {
    let folder = CampaignFolder::new();
    std::fs::remove_file(folder.join("runs/tags.toml")).unwrap();
    folder.write(
        "campaign.toml",
        "[campaign]\nid = \"c\"\ntitle = \"C\"\n[[sample]]\nid = \"S1\"\nmaterial = \"CNaf\"\nlength_mm = 5.0\nwidth_mm = 2.0\nthickness_mm = 0.22\n",
    );
    folder.write("simulation.toml", SPEC);
    let spec = folder.join("simulation.toml");
    folder
        .ieap(&["simulate", "--overwrite", spec.to_str().unwrap()])
        .expect(0);
    folder.ieap(&["run", "--no-diagnose", "--quiet"]).expect(0);
    let table = folder
        .ieap(&["table", "model-free", "--format", "json"])
        .expect(0)
        .json();
    assert_eq!(table["rows"].as_array().unwrap().len(), 1, "{table:#}");

    let end_s = 1500.0;
    let fine: Vec<f64> = (1..150_000).map(|k| end_s * f64::from(k) / 150_000.0).collect();
    let course = strip().curvature_per_cm(&Drive::step(2.0), 0.1, &fine);
    let (at, peak) = (0..fine.len())
        .map(|k| (k, course[k]))
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap();
    let curvature = |t: f64| strip().curvature_per_cm(&Drive::step(2.0), 0.1, &[t])[0];
    let risen = course.iter().position(|k| *k >= 0.9 * peak).unwrap();
    let charge: f64 = {
        let current = strip().current_a(&Drive::step(2.0), 0.1, &fine);
        let strips = fine.windows(2).zip(current.windows(2));
        let between: f64 = strips.map(|(t, i)| 0.5 * (t[1] - t[0]) * (i[0] + i[1])).sum();
        between + fine[0] * current[0]
    };
    for (key, truth) in [
        ("peak_curvature_per_cm", peak),
        ("time_to_peak_s", fine[at]),
        (
            "lost_after_10_min_percent",
            100.0 * (1.0 - curvature(600.0) / peak),
        ),
        ("charge_c", charge),
        (
            "strain_rate_percent_per_s",
            100.0 * 0.022 * 0.9 * peak / fine[risen],
        ),
    ] {
        let found = cell(&table, key);
        let (low, high) = (
            found["low_95"].as_f64().unwrap(),
            found["high_95"].as_f64().unwrap(),
        );
        // A tenth beyond the interval: one run may lie beside it.
        let room = 0.5 * (high - low);
        assert!(
            low - room < truth && truth < high + room,
            "{key}: {truth}, {found:#}"
        );
        let half = 0.5 * (high - low) / truth.abs();
        assert!(half < 0.5, "{key} is told to {half}");
    }
    let missing = cell(&table, "lost_after_60_min_percent");
    assert!(missing["value"].is_null(), "{missing:#}");
    let shown = folder.ieap(&["table", "model-free"]).expect(0).stdout;
    assert!(shown.contains("the level is seen for 150"), "{shown}");

    // Energies: the voltage times the charge, per volume of the strip; an elastic one needs a modulus.
    let energies = folder
        .ieap(&["table", "energy", "--format", "json"])
        .expect(0)
        .json();
    let volume_dm3 = 0.1 * 0.022 / 1e3;
    for (key, truth) in [
        ("energy_level_mj", 1e3 * 2.0 * charge),
        ("energy_in_mj", 1e3 * 2.0 * charge),
        ("energy_density_wh_per_dm3", 2.0 * charge / 3600.0 / volume_dm3),
        ("mean_power_density_w_per_dm3", 2.0 * charge / end_s / volume_dm3),
    ] {
        let value = cell(&energies, key)["value"].as_f64().unwrap();
        assert!((value / truth - 1.0).abs() < 0.01, "{key}: {value} for {truth}");
    }
    let shown = folder.ieap(&["table", "energy"]).expect(0).stdout;
    assert!(shown.contains("no modulus log of the material"), "{shown}");
    let exported = folder
        .ieap(&["export", "--what", "model-free", "-o", "-"])
        .expect(0)
        .stdout;
    let mut rows = csv::Reader::from_reader(exported.as_bytes());
    let names = rows.headers().unwrap().clone();
    let row = rows.records().next().unwrap().unwrap();
    let exported = |key: &str| row[names.iter().position(|name| name == key).unwrap()].to_owned();
    let peak_low: f64 = exported("peak_curvature_per_cm_low_95").parse().unwrap();
    assert_eq!(
        Some(peak_low),
        cell(&table, "peak_curvature_per_cm")["low_95"].as_f64()
    );
    assert!(exported("efficiency_percent_reason").contains("no modulus log"));

    // The page of the run, and why.
    let pages = std::fs::read_dir(folder.join("report/runs")).unwrap();
    let page = pages
        .map(|page| std::fs::read_to_string(page.unwrap().path()).unwrap())
        .find(|page| page.contains("Without a model"))
        .expect("the page of the run says it");
    assert!(page.contains("the level is seen for 150"), "{page}");
    assert!(page.contains("elastic energy of the strip at the peak"), "{page}");
    let explained = folder
        .ieap(&["explain", "model-free", "step.csv", "t_peak"])
        .expect(0);
    assert!(explained.stdout.contains("runs/step.csv"), "{}", explained.stdout);
}

/// A resistor before a capacitor under pulses, whose curvature per charge falls by a thousandth a cycle.
fn life_test() -> String {
    let (ohm, farad, half_s, every_s) = (100.0, 0.02, 4.0, 0.25);
    let mut text = "time_s,voltage_v,current_a,curvature_per_cm\n".to_owned();
    let (mut charge, mut random) = (0.0_f64, 12345_u64);
    let mut noise = move || {
        // A linear congruence (Knuth's) is enough for a spread of readings.
        random = random
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (random >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    for level in 0..240 {
        let volts = if level % 2 == 0 { 1.0 } else { 0.0 };
        let alpha = 5.0 * (1.0 - 1e-3 * f64::from(level / 2));
        for step in 0..16 {
            let t = every_s * f64::from(step);
            let now = farad * volts + (charge - farad * volts) * (-t / (ohm * farad)).exp();
            let (i, k) = (
                (volts - now / farad) / ohm + 2e-5 * noise(),
                alpha * now + 5e-4 * noise(),
            );
            writeln!(text, "{:.3},{volts},{i:.8},{k:.8}", half_s * f64::from(level) + t).unwrap();
        }
        charge = farad * volts + (charge - farad * volts) * (-half_s / (ohm * farad)).exp();
    }
    text
}

#[test]
fn a_life_test_is_told_cycle_by_cycle_with_its_fade() {
    let folder = CampaignFolder::new();
    folder.write("runs/life.csv", life_test());
    folder.ieap(&["run", "--no-diagnose", "--quiet"]).expect(0);
    let table = folder
        .ieap(&["table", "cycles", "--format", "json"])
        .expect(0)
        .json();
    let rows = table["rows"].as_array().unwrap();
    assert!((115..=120).contains(&rows.len()), "{}", rows.len());
    let exported = folder
        .ieap(&["export", "--what", "cycles", "-o", "-"])
        .expect(0)
        .stdout;
    assert_eq!(exported.lines().count(), 1 + rows.len());
    let value = |row: usize, key: &str| rows[row]["cells"][key]["value"].as_f64().unwrap();
    let database = rusqlite::Connection::open(folder.join("campaign.db")).unwrap();
    let sql = "SELECT cells ->> '$.charge_in_c', unit FROM tables_view JOIN columns_view USING (name)
               WHERE name = 'cycles' AND key = 'charge_in_c' AND row_number = 11";
    let in_sql: (f64, String) = database
        .query_row(sql, [], |row| Ok((row.get(0)?, row.get(1)?)))
        .unwrap();
    assert_eq!(in_sql, (value(10, "charge_in_c"), "C".to_owned()));
    for row in [10, 100] {
        let alpha = 5.0 * (1.0 - 1e-3 * row as f64);
        assert!(
            (value(row, "curvature_per_c_cm") / alpha - 1.0).abs() < 0.03,
            "{row}"
        );
        assert!(
            (value(row, "coulombic_efficiency_percent") - 100.0).abs() < 2.0,
            "{row}"
        );
        // Edges lie between readings a quarter of a second apart, in which the current falls by a ninth: a bound.
        let resistance = &rows[row]["cells"]["resistance_ohm"];
        let bound = resistance["high_95"].as_f64().unwrap();
        assert!((100.0..115.0).contains(&bound), "{row}: {resistance}");
    }
    let shown = folder.ieap(&["table", "cycles"]).expect(0).stdout;
    let told = shown
        .lines()
        .find(|line| line.contains("Δκ/ΔQ ("))
        .unwrap_or_default();
    assert!(told.contains("falls by 1"), "{shown}");
    assert!(shown.contains("of its beginning"), "{shown}");
    let pages = std::fs::read_dir(folder.join("report/runs")).unwrap();
    let told = pages
        .map(|page| std::fs::read_to_string(page.unwrap().path()).unwrap())
        .any(|page| page.contains("coulombic") || page.contains("are told apart; every one"));
    assert!(told);
}
