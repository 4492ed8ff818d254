//! Alarms do not depend on where they are read: campaigns over three years drawn at random, with seasons, a step, a drift or
//! nothing, held beside page, status, table and SQL.

use std::collections::BTreeSet;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;

use crate::campaign::{CampaignFolder, counted};

/// The runs of a strip, monthly: how lambda follows the season is drawn, and what stays besides.
fn life(random: &mut ChaCha8Rng) -> String {
    let slope: f64 = random.random_range(0.0..0.04);
    let step: f64 = [0.0, 0.25, -0.25][random.random_range(0..3)];
    let drift: f64 = [0.0, 0.006][random.random_range(0..2)];
    let at = random.random_range(8..22);
    let mut runs = String::new();
    for month in 0..30 {
        let season = (f64::from(month) * std::f64::consts::TAU / 12.0).sin();
        let stays = drift * f64::from(month) + if month >= at { step } else { 0.0 };
        let mut scatter = || 1.0 + random.random_range(-0.02..0.02);
        let lambda = 4e-3 * (slope * 3.5 * season + stays).exp() * scatter();
        runs += &format!(
            r#"
[[run]]
file = "S1_{month:02}.csv"
area_cm2 = 0.1
voltage_v = 2.0
parameters = {{ r1_ohm_cm2 = {}, c1_f_per_cm2 = 0.04, r2_ohm_cm2 = 1000.0, c2_f_per_cm2 = 0.13, rss_ohm_cm2 = {}, alpha_per_c_cm = {}, lambda_per_s = {lambda} }}
tags = {{ voltage_v = 2.0, environment = "air", sample = "S1", relative_humidity_percent = {}, temperature_c = {}, started_at = "{}-{:02}-05T12:00:00Z" }}
"#,
            520.0 * scatter(),
            5600.0 * scatter(),
            14.0 * scatter(),
            35.0 + 3.5 * season,
            22.0 + 1.5 * season * scatter(),
            2024 + month / 12,
            1 + month % 12,
        );
    }
    runs
}

const HEAD: &str = r#"[simulation]
seed = 3
folder = "runs"
statement = ["SIMULATED, not measured."]
baseline_s = 5.0

[noise]
current_a = 1e-6
curvature_per_cm = 2e-3

[[sampling]]
until_s = 400.0
every_s = 2.0
"#;
const CAMPAIGN: &str = r#"[campaign]
id = "seasons"
title = "Seasons"
[[sample]]
id = "S1"
material = "CNaf"
length_mm = 5.0
width_mm = 2.0
"#;

/// Parameters with the charts that raised an alarm on them, from what SQL shows.
fn in_sql(folder: &CampaignFolder) -> BTreeSet<(String, String)> {
    let connection = rusqlite::Connection::open(folder.path().join("campaign.db")).unwrap();
    let mut asked = connection
        .prepare("SELECT parameter, alarms FROM monitoring_view")
        .unwrap();
    let rows = asked.query_map([], |row| {
        Ok((row.get::<_, String>(0)?, row.get::<_, Option<String>>(1)?))
    });
    let rows: Vec<(String, Option<String>)> = rows.unwrap().map(Result::unwrap).collect();
    assert!(!rows.is_empty());
    let each = rows.into_iter().flat_map(|(parameter, alarms)| {
        let charts: Vec<String> = serde_json::from_str(&alarms.unwrap_or_default()).unwrap_or_default();
        charts.into_iter().map(move |chart| (parameter.clone(), chart))
    });
    each.collect()
}

/// Ids of the alarms on the page.
fn ids_on(page: &str) -> BTreeSet<&str> {
    let after = page.split("id ").skip(1).filter_map(|rest| rest.get(..12));
    after
        .filter(|id| id.bytes().all(|own| own.is_ascii_hexdigit()))
        .collect()
}

#[test]
fn page_status_json_and_sql_say_the_same_alarms() {
    let mut random = ChaCha8Rng::seed_from_u64(72);
    let mut some = 0;
    for place in 0..counted(4, 20) {
        // Of one campaign what findings say against fits takes part.
        let diagnose = (place > 0).then_some("--no-diagnose");
        let folder = CampaignFolder::new();
        folder.write("campaign.toml", CAMPAIGN);
        folder.write("simulation.toml", format!("{HEAD}{}", life(&mut random)));
        let spec = folder.path().join("simulation.toml");
        folder.ieap(&["simulate", spec.to_str().unwrap()]).expect(0);
        let summary = folder
            .ieap(&[&["run", "--json"], diagnose.as_slice()].concat())
            .json();
        let status = folder.ieap(&["status", "--json"]).expect(0).json();
        let alarms = status["status"]["alarms"].as_array().unwrap().clone();
        let page = folder.report("monitoring.html");
        let ids: BTreeSet<&str> = alarms.iter().map(|alarm| alarm["id"].as_str().unwrap()).collect();
        assert_eq!(ids_on(&page), ids, "{alarms:#?}");
        assert_eq!(
            summary["run"]["alarms"]["standing"].as_u64(),
            Some(alarms.len() as u64)
        );
        let ended = folder.ieap(&["status", "--alarms", "--json"]);
        assert_eq!(ended.status, if alarms.is_empty() { 0 } else { 5 });
        assert_eq!(ended.json()["alarms"].as_array().unwrap().len(), alarms.len());
        let of = |sign: &Value| {
            let text = |key: &str| sign[key].as_str().unwrap().to_owned();
            (text("parameter"), text("chart"))
        };
        let said: BTreeSet<(String, String)> = alarms
            .iter()
            .flat_map(|alarm| alarm["shown_by"].as_array().unwrap())
            .map(of)
            .collect();
        assert_eq!(in_sql(&folder), said);
        some += usize::from(!alarms.is_empty());
    }
    assert!(some > 0);
}
