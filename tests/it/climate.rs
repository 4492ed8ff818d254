//! Climate logs: taken in, joined with runs, compared; late, moved, overlapping, damaged.

use ieap::analysis::climate::humid_air::{dew_point_c, vapour_pressure_pa};
use ieap::domain::{ClimateQuantity, RunClimate, RunRecord};
use ieap::store::Store;
use serde_json::Value;

use crate::campaign::{CampaignFolder, run_table};
#[cfg(unix)]
use crate::watch::{Watching, until};

/// A log of a reading every `step_s` from `start` (local time, `2026-01-10 08:00:00`), humidity and temperature by
/// formulas of the hours since then.
fn log(start: &str, step_s: i64, readings: i64, air: impl Fn(f64) -> (f64, f64)) -> String {
    let start: jiff::civil::DateTime = start.replace(' ', "T").parse().unwrap();
    let mut text = String::from("Time,Temperature (°C),Relative Humidity (%)\n");
    for k in 0..readings {
        let at = start
            .checked_add(jiff::SignedDuration::from_secs(k * step_s))
            .unwrap();
        let (rh, t) = air((k * step_s) as f64 / 3600.0);
        text += &format!("{},{t:.3},{rh:.3}\n", at.strftime("%Y-%m-%d %H:%M:%S"));
    }
    text
}

fn steady(_: f64) -> (f64, f64) {
    (45.0, 21.0)
}

/// A campaign with one run of 319 s that starts at that moment, tagged 45 %.
fn with_run(started_at: &str) -> CampaignFolder {
    let folder = CampaignFolder::new();
    add_run(&folder, "a", 1, started_at, "relative_humidity_percent = 45\n");
    folder
}

fn add_run(folder: &CampaignFolder, name: &str, seed: u32, started_at: &str, tags: &str) {
    folder.write(&format!("runs/{name}.csv"), run_table(seed));
    folder.write(
        &format!("runs/{name}.csv.toml"),
        format!("started_at = \"{started_at}\"\n{tags}"),
    );
}

fn ingest(folder: &CampaignFolder) -> Value {
    let ended = folder.ieap(&["ingest", "--json"]);
    assert!([0, 3].contains(&ended.status), "{ended:#?}");
    ended.json()["ingest"].clone()
}

fn runs(folder: &CampaignFolder) -> Vec<RunRecord> {
    Store::open_read_only(folder.path())
        .unwrap()
        .unwrap()
        .runs()
        .unwrap()
}

fn climate(folder: &CampaignFolder) -> Value {
    folder.ieap(&["status", "--json"]).expect(0).json()["status"]["climate"].clone()
}

fn of(run: &RunRecord, quantity: ClimateQuantity) -> &RunClimate {
    let found = run
        .climate
        .iter()
        .find(|found| found.quantity == quantity && found.chosen);
    found.unwrap_or_else(|| panic!("no {quantity:?}: {:#?}", run.issues))
}

fn codes(run: &RunRecord) -> Vec<&str> {
    run.issues.iter().map(|issue| issue.code.as_str()).collect()
}

fn problems(climate: &Value) -> Vec<String> {
    let issues = climate["assessment"]["issues"].as_array().unwrap();
    issues
        .iter()
        .map(|issue| issue["code"].as_str().unwrap().to_owned())
        .collect()
}

#[test]
fn a_run_gets_what_the_log_says_and_nothing_it_does_not() {
    let folder = with_run("2026-01-10T10:00:00+02:00");
    // 45 % falling by 6 % an hour: 319 s around 10:02:40.
    folder.write(
        "ambient/box.csv",
        log("2026-01-10 08:00:00", 10, 2000, |h| {
            (57.0 - 6.0 * h, 20.0 + 0.5 * h)
        }),
    );
    add_run(&folder, "late", 2, "2026-01-10T15:00:00+02:00", "");
    add_run(&folder, "without start", 3, "2026-01-10", "");
    ingest(&folder);
    let found = runs(&folder);
    let run = &found[0];
    let humidity = of(run, ClimateQuantity::RelativeHumidity);
    assert_eq!(humidity.readings, 32);
    let middle_h = 2.0 + 155.0 / 3600.0;
    assert!(
        (humidity.mean - (57.0 - 6.0 * middle_h)).abs() < 1e-3,
        "{humidity:?}"
    );
    assert!((humidity.drift_per_h.unwrap() + 6.0).abs() < 1e-2, "{humidity:?}");
    assert!((humidity.largest_deviation - 155.0 / 600.0).abs() < 2e-3 && humidity.largest_gap_s == 10.0);
    assert_eq!(run.tag("temperature_c"), Some("21.02"));
    let dew_point = of(run, ClimateQuantity::DewPoint);
    assert!((dew_point.mean - 8.6).abs() < 0.2, "{dew_point:?}");
    assert!(
        run.tags
            .iter()
            .any(|tag| tag.source.key() == "ambient" && tag.key == "relative_humidity_percent")
    );
    for run in &found[1..] {
        assert!(
            run.climate.is_empty() && run.tag("relative_humidity_percent").is_none(),
            "{}",
            run.path
        );
    }
    assert!(
        codes(&found[1]).contains(&"climate-not-covered"),
        "{:?}",
        found[1].issues
    );
    assert!(
        codes(&found[2]).contains(&"climate-no-start"),
        "{:?}",
        found[2].issues
    );
}

#[test]
fn results_do_not_depend_on_the_order_of_arrival_and_nothing_is_done_twice() {
    let start = "2026-01-10T10:00:00+02:00";
    let first = log("2026-01-10 06:00:00", 60, 300, |h| (40.0 + h, 21.0));
    // The same logger, read out again later: 300 readings stand in both.
    let again = log("2026-01-10 06:00:00", 60, 900, |h| (40.0 + h, 21.0));
    let other = log("2026-01-10 05:00:30", 60, 900, |h| (39.5 + h, 21.3));
    let files = [
        ("ambient/log 2026-01-10.csv", &first),
        ("ambient/log 2026-01-11.csv", &again),
        ("ambient/z.csv", &other),
    ];
    let mut seen = Vec::new();
    for turn in 0..4 {
        let folder = CampaignFolder::new();
        let run = |folder: &CampaignFolder| add_run(folder, "a", 1, start, "");
        if turn % 2 == 0 {
            run(&folder);
            ingest(&folder);
        }
        for k in 0..3 {
            let (path, text) = files[(k * 2 + turn) % 3];
            folder.write(path, text);
            ingest(&folder);
        }
        if turn % 2 == 1 {
            run(&folder);
            ingest(&folder);
        }
        let nothing = ingest(&folder);
        assert_eq!(nothing["retagged"], serde_json::json!([]), "{nothing}");
        assert_eq!(nothing["logs"]["new"], serde_json::json!([]));
        let run = runs(&folder).remove(0);
        seen.push((run.tags, run.climate, run.issues, climate(&folder)));
    }
    assert!(seen.windows(2).all(|pair| pair[0] == pair[1]), "{seen:#?}");
    let readings = &seen[0].3["assessment"]["sensors"][0];
    assert_eq!(
        (readings["sensor"].as_str(), readings["readings"].as_u64()),
        (Some("log"), Some(900))
    );
    assert_eq!(readings["files"], 2);
}

#[test]
fn a_log_that_comes_late_is_moved_changed_and_removed() {
    let folder = with_run("2026-01-10T10:00:00+02:00");
    assert_eq!(ingest(&folder)["new"], serde_json::json!(["runs/a.csv"]));
    folder.write("ambient/one.csv", log("2026-01-10 06:00:00", 60, 600, steady));
    let late = ingest(&folder);
    assert_eq!(late["retagged"], serde_json::json!(["runs/a.csv"]));
    std::fs::rename(folder.join("ambient/one.csv"), folder.join("ambient/two.csv")).unwrap();
    let moved = ingest(&folder);
    assert_eq!(
        moved["logs"]["renamed"],
        serde_json::json!([["ambient/one.csv", "ambient/two.csv"]])
    );
    folder.write("ambient/copy.csv", log("2026-01-10 06:00:00", 60, 600, steady));
    assert_eq!(
        ingest(&folder)["logs"]["aliases"],
        serde_json::json!(["ambient/copy.csv"])
    );
    // Left there, it would be a log of its own from when the other one says something else.
    std::fs::remove_file(folder.join("ambient/copy.csv")).unwrap();
    folder.write(
        "ambient/two.csv",
        log("2026-01-10 06:00:00", 60, 601, |_| (47.0, 21.0)),
    );
    let changed = ingest(&folder);
    assert_eq!(changed["logs"]["revised"], serde_json::json!(["ambient/two.csv"]));
    assert!((of(&runs(&folder)[0], ClimateQuantity::RelativeHumidity).mean - 47.0).abs() < 1e-9);
    std::fs::remove_file(folder.join("ambient/two.csv")).unwrap();
    let gone = ingest(&folder);
    assert_eq!(gone["gone"], serde_json::json!(["ambient/two.csv"]));
    assert!((of(&runs(&folder)[0], ClimateQuantity::RelativeHumidity).mean - 47.0).abs() < 1e-9);
    std::fs::remove_dir_all(folder.join("ambient")).unwrap();
    assert!(
        folder
            .ieap(&["ingest"])
            .expect(0)
            .stderr
            .contains("the climate logs known from it stay")
    );
}

#[test]
fn an_excursion_a_false_label_and_two_sensors_are_pointed_out() {
    let folder = with_run("2026-01-10T10:00:00+02:00");
    // A door is opened two minutes into the run.
    let door = |h: f64| (if (2.035..2.06).contains(&h) { 66.0 } else { 59.9 }, 18.1);
    folder.write("ambient/left.csv", log("2026-01-10 08:00:00", 10, 2000, door));
    folder.write(
        "ambient/right.csv",
        log("2026-01-10 08:00:00", 10, 2000, |h| (door(h).0 - 5.0, 18.2)),
    );
    ingest(&folder);
    let run = &runs(&folder)[0];
    let codes = codes(run);
    for code in [
        "climate-left-tolerance",
        "tag-disagreement",
        "climate-sensors-differ",
    ] {
        assert!(codes.contains(&code), "{code}: {:#?}", run.issues);
    }
    // What was measured counts, the label is asked, and both are kept.
    assert_eq!(run.tag("relative_humidity_percent"), Some("61.62"));
    let status = climate(&folder);
    assert_eq!(status["runs_left_tolerance"], serde_json::json!(["runs/a.csv"]));
    assert_eq!(status["runs_label_differs"], serde_json::json!(["runs/a.csv"]));
    let pair = &status["assessment"]["pairs"][0];
    assert!((pair["bias"].as_f64().unwrap() - 5.0).abs() < 1e-6, "{pair}");
    assert!(problems(&status).contains(&"sensors-disagree".to_owned()));
    // Stated accuracies and corrections take it back.
    let stated = "\n[[sensor]]\nid = \"right\"\nrelative_humidity_correction_percent = 5.0\n\
                  [climate]\nrelative_humidity_tolerance_percent = 8.0\n";
    folder.write(
        "campaign.toml",
        format!("{}{stated}", crate::campaign::CAMPAIGN_TOML),
    );
    ingest(&folder);
    let run = &runs(&folder)[0];
    assert_eq!(
        of(run, ClimateQuantity::RelativeHumidity).sensor,
        "right",
        "the one in campaign.toml comes first"
    );
    assert!(
        !self::codes(run).iter().any(|code| code.starts_with("climate-")),
        "{:#?}",
        run.issues
    );
    assert_eq!(problems(&climate(&folder)), Vec::<String>::new());
}

#[test]
fn vacuum_has_no_humidity_of_the_room_and_exposure_accumulates() {
    let folder = CampaignFolder::new();
    add_run(&folder, "a", 1, "2026-01-10T10:00:00+02:00", "");
    add_run(
        &folder,
        "b",
        2,
        "2026-01-10T12:00:00+02:00",
        "environment = \"vacuum\"\n",
    );
    add_run(&folder, "c", 3, "2026-01-10T18:00:00+02:00", "");
    // Above 60 % from 13:00 to 15:30; no reading from 16:00 on.
    let humid = |h: f64| (if (5.0..7.5).contains(&h) { 70.0 } else { 40.0 }, 22.0);
    folder.write("ambient/room.csv", log("2026-01-10 08:00:00", 60, 481, humid));
    ingest(&folder);
    let found = runs(&folder);
    assert_eq!(found[1].tag("relative_humidity_percent"), None);
    assert_eq!(found[1].tag("temperature_c"), Some("22"));
    let exposure = &climate(&folder)["assessment"]["exposures"][0];
    let hours = |key: &str| exposure[key].as_f64().unwrap();
    assert!((hours("above_h") - 2.5).abs() < 0.03, "{exposure}");
    let (vacuum_h, span_h) = (319.0 / 3600.0, 8.0 + 319.0 / 3600.0);
    assert!((hours("covered_h") - (6.0 - vacuum_h)).abs() < 1e-3, "{exposure}");
    let sum = hours("covered_h") + hours("uncovered_h") + hours("elsewhere_h");
    assert!((sum - span_h).abs() < 1e-6, "{exposure}");
}

#[test]
fn clocks_of_every_kind_place_their_readings() {
    // The run starts at 03:30 summer time, the first of the two 03:30 of that night.
    let folder = with_run("2026-10-25T03:30:00+03:00");
    // A clock that goes back: 30 % in the first of the two hours, 60 % in the second.
    let mut text = String::from("Time,RH (%)\n");
    for (hour, percent) in [(2, 20), (3, 30), (3, 60), (4, 50)] {
        for minute in (0..60).step_by(5) {
            text += &format!("2026-10-25 0{hour}:{minute:02}:00,{percent}\n");
        }
    }
    folder.write("ambient/follows.csv", text);
    ingest(&folder);
    assert_eq!(
        of(&runs(&folder)[0], ClimateQuantity::RelativeHumidity).mean,
        30.0
    );
    std::fs::remove_file(folder.join("ambient/follows.csv")).unwrap();
    // Offsets in the header and in every row.
    let folder = with_run("2026-10-25T03:30:00+03:00");
    let stated = log("2026-10-25 00:00:00", 300, 30, |h| (10.0 * h, 20.0)).replace("Time,", "Time (UTC),");
    folder.write("ambient/utc.csv", stated);
    ingest(&folder);
    let mean = of(&runs(&folder)[0], ClimateQuantity::RelativeHumidity).mean;
    // 00:30 UTC is the start; readings at 00:30 and 00:35.
    assert!((mean - 5.417).abs() < 0.01, "{mean}");
    // Without any zone nothing is placed.
    let folder = with_run("2026-01-10T10:00:00+02:00");
    let toml = crate::campaign::CAMPAIGN_TOML.replace("timezone = \"Europe/Tallinn\"\n", "");
    folder.write("campaign.toml", &toml);
    folder.write("ambient/a.csv", log("2026-01-10 08:00:00", 60, 300, steady));
    ingest(&folder);
    assert!(runs(&folder)[0].climate.is_empty());
    assert_eq!(problems(&climate(&folder)), ["log-without-zone"]);
    folder.write(
        "campaign.toml",
        format!("{toml}[[sensor]]\nid = \"a\"\nutc_offset = \"+02:00\"\n"),
    );
    ingest(&folder);
    assert_eq!(runs(&folder)[0].climate.len(), 5);
}

#[test]
fn logs_of_one_sensor_that_contradict_each_other_are_pointed_out_and_the_first_counts() {
    let folder = with_run("2026-01-10T10:00:00+02:00");
    folder.write(
        "ambient/log 2026-01-10.csv",
        log("2026-01-10 09:00:00", 60, 120, |_| (40.0, 21.0)),
    );
    // The same hour and a half again with another humidity and the same temperature.
    folder.write(
        "ambient/log 2026-01-11.csv",
        log("2026-01-10 09:30:00", 60, 120, |_| (44.0, 21.0)),
    );
    ingest(&folder);
    let assessment = climate(&folder)["assessment"].clone();
    let issues = assessment["issues"].as_array().unwrap();
    let told: Vec<(&str, &str)> = issues
        .iter()
        .map(|issue| (issue["code"].as_str().unwrap(), issue["place"].as_str().unwrap()))
        .collect();
    assert_eq!(told, [("logs-contradict", "relative_humidity_percent")]);
    let message = issues[0]["message"].as_str().unwrap();
    assert!(
        message.starts_with("90 readings of log stand in two files"),
        "{message}"
    );
    let run = runs(&folder).remove(0);
    assert_eq!(of(&run, ClimateQuantity::RelativeHumidity).mean, 40.0);
}

#[test]
fn the_run_s_own_record_shows_a_clock_that_is_off() {
    let folder = CampaignFolder::new();
    // A run of a day that records the temperature, beside a logger whose clock is 3 h behind.
    let air = |h: f64| 21.0 + 3.0 * (h / 1.7).sin() + (h / 0.41).sin();
    let mut text = String::from("time_s,voltage_v,current_a,temperature_c\n");
    for k in 0..1440 {
        text += &format!(
            "{},2.0,{:e},{:.3}\n",
            k * 60,
            1e-3 / f64::from(k + 1),
            air(f64::from(k) / 60.0)
        );
    }
    folder.write("runs/long.csv", text);
    folder.write(
        "runs/long.csv.toml",
        "started_at = \"2026-01-10T10:00:00+02:00\"\n",
    );
    folder.write(
        "ambient/room.csv",
        log("2026-01-10 06:00:00", 60, 2000, |h| {
            (45.0 + (h / 3.0).sin(), air(h - 1.0))
        }),
    );
    ingest(&folder);
    let status = climate(&folder);
    let pair = &status["assessment"]["pairs"][0];
    assert_eq!(
        (&pair["first"], &pair["second"]),
        (&"room".into(), &"runs/long.csv".into()),
        "{pair}"
    );
    assert_eq!(pair["clock_ahead_h"], 3.0, "{pair}");
    assert_eq!(problems(&status), ["clock-offset"]);
}

#[test]
fn bad_logs_are_refused_with_a_reason_and_the_rest_goes_on() {
    let folder = with_run("2026-01-10T10:00:00+02:00");
    folder.write("ambient/good.csv", log("2026-01-10 08:00:00", 60, 300, steady));
    folder.write("ambient/empty.csv", "");
    folder.write("ambient/header.csv", "Time,Temperature (°C),RH (%)\n");
    folder.write("ambient/photo.jpg", b"\xff\xd8\xff\xe0\0\x10JFIF\0\x01");
    folder.write("ambient/run.csv", run_table(7));
    folder.write(
        "ambient/no climate.csv",
        "Time,CO2 (ppm)\n2026-01-10 08:00:00,420\n",
    );
    folder.write(
        "ambient/two orders.csv",
        "Time,RH (%)\n01/02/26 10:00,40\n01/02/26 11:00,41\n",
    );
    folder.write("ambient/box/.hidden.csv", "x");
    let ended = folder.ieap(&["ingest", "--json"]).expect(3);
    let summary = ended.json()["ingest"].clone();
    let refused: Vec<&str> = summary["refused"]
        .as_array()
        .unwrap()
        .iter()
        .map(|r| r[0].as_str().unwrap())
        .collect();
    let expected = [
        "ambient/no climate.csv",
        "ambient/run.csv",
        "ambient/two orders.csv",
    ];
    assert_eq!(refused, expected, "a picture is no data and needs nobody");
    for entry in summary["refused"].as_array().unwrap() {
        assert!(!entry[1]["message"].as_str().unwrap().is_empty(), "{entry}");
    }
    assert_eq!(
        summary["waiting"],
        serde_json::json!(["ambient/empty.csv", "ambient/header.csv"])
    );
    assert_eq!(runs(&folder).len(), 1, "a log is no run");
    assert_eq!(runs(&folder)[0].climate.len(), 5);
    // A log cut in the middle of a number gives what is before it.
    let text = log("2026-01-10 08:00:00", 60, 300, steady);
    folder.write("ambient/good.csv", &text[..text.len() - 5]);
    ingest(&folder);
    assert_eq!(climate(&folder)["assessment"]["sensors"][0]["readings"], 299);
}

#[test]
fn logs_are_found_where_the_runs_folder_is_the_whole_campaign() {
    let folder = with_run("2026-01-10T10:00:00+02:00");
    folder.write(
        "campaign.toml",
        format!("{}\n[runs]\nfolder = \".\"\n", crate::campaign::CAMPAIGN_TOML),
    );
    folder.write("ambient/box.csv", log("2026-01-10 08:00:00", 60, 300, steady));
    let summary = ingest(&folder);
    assert_eq!(summary["new"], serde_json::json!(["runs/a.csv"]));
    assert_eq!(summary["logs"]["new"], serde_json::json!(["ambient/box.csv"]));
    assert_eq!(runs(&folder)[0].climate.len(), 5);
}

#[test]
fn pages_show_the_climate() {
    let folder = with_run("2026-01-10T10:00:00+02:00");
    folder.run_json();
    assert!(folder.report("climate.html").contains("No climate log was found"));
    folder.write(
        "ambient/<box>.csv",
        log("2026-01-10 08:00:00", 60, 300, |h| (59.9 + 0.1 * h, 18.1)),
    );
    folder.run_json();
    let page = folder.report("climate.html");
    for text in [
        "The logs cover 1 of 1 run.",
        "In 1 run the label",
        "Relative humidity (%)",
        "&lt;box&gt;",
        "Exposure of samples",
    ] {
        assert!(page.contains(text), "{text}");
    }
    assert!(!page.contains("<box>"));
    let run = std::fs::read_dir(folder.join("report/runs"))
        .unwrap()
        .next()
        .unwrap()
        .unwrap()
        .path();
    let run = std::fs::read_to_string(run).unwrap();
    for text in [
        "Climate during the run",
        "Absolute humidity (g/m³)",
        "Time since the start of the run",
        "60.10",
    ] {
        assert!(run.contains(text), "{text}");
    }
}

#[cfg(unix)]
#[test]
fn a_log_that_arrives_while_watching_reaches_the_run() {
    let folder = with_run("2026-01-10T10:00:00+02:00");
    let _watching = Watching::start(&folder, &[]);
    // The folder of logs comes into being while the watch goes on.
    folder.write("ambient/first.csv", log("2026-01-10 08:00:00", 60, 60, steady));
    until("the first log", || climate(&folder)["logs"] == 1);
    folder.write(
        "ambient/box/second.csv",
        log("2026-01-10 08:00:00", 60, 300, |_| (55.0, 20.0)),
    );
    until("the run has its climate", || {
        climate(&folder)["runs_covered"] == 1
    });
    until("the report has it", || {
        folder.report("climate.html").contains("In 1 run the label")
    });
}

/// Against what lies beside the project.
mod needs_shared {
    use super::*;
    use crate::needs_shared::shared;

    /// Copies the files of a folder beside the project, those that `wanted` wants, into `ambient/`.
    fn with_files(folder: &CampaignFolder, from: &str, wanted: impl Fn(&str) -> bool) -> Option<usize> {
        let from = shared(from)?;
        let mut count = 0;
        for entry in std::fs::read_dir(from).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if wanted(&name) {
                folder.write(&format!("ambient/{name}"), std::fs::read(&path).unwrap());
                count += 1;
            }
        }
        Some(count)
    }

    #[test]
    fn ten_sensors_beside_a_station_show_two_hours_and_a_copied_column() {
        let folder = CampaignFolder::new();
        add_run(&folder, "a", 1, "2020-04-04T12:00:00+03:00", "");
        let Some(files) = with_files(&folder, "data/humidity-sensor-intercomparison", |name| {
            name.ends_with(".csv")
        }) else {
            return;
        };
        assert_eq!(ingest(&folder)["logs"]["new"].as_array().unwrap().len(), files);
        let status = climate(&folder);
        let assessment = &status["assessment"];
        let pair = |first: &str, second: &str, quantity: &str| {
            let pairs = assessment["pairs"].as_array().unwrap().iter();
            let is = |pair: &&Value| {
                pair["first"] == first && pair["second"] == second && pair["quantity"] == quantity
            };
            pairs
                .clone()
                .find(is)
                .unwrap_or_else(|| panic!("{first} {second}"))
                .clone()
        };
        // What the provenance file found by arithmetic, readings of the minute: bias +7.2 and 10.5 % for the AM2320
        // before the clocks are put right; 8.6 % for the HTU21D-2, which falls below 0.8 % after.
        let am2320 = pair(
            "FRWRTM/MET_CS215",
            "Ta_RH_Test/AM2320",
            "relative_humidity_percent",
        );
        assert!((am2320["bias"].as_f64().unwrap() + 7.2).abs() < 0.05, "{am2320}");
        assert!(
            (am2320["standard_deviation"].as_f64().unwrap() - 10.5).abs() < 0.1,
            "{am2320}"
        );
        let htu21d = pair(
            "FRWRTM/MET_CS215",
            "Ta_RH_Test/2_HTU21D",
            "relative_humidity_percent",
        );
        assert!(
            (htu21d["standard_deviation"].as_f64().unwrap() - 8.6).abs() < 0.05,
            "{htu21d}"
        );
        assert!(htu21d["put_right"][1].as_f64().unwrap() < 0.8, "{htu21d}");
        let across = assessment["pairs"]
            .as_array()
            .unwrap()
            .iter()
            .filter(|pair| pair["first"] == "FRWRTM/MET_CS215");
        let ahead: Vec<f64> = across
            .map(|pair| pair["clock_ahead_h"].as_f64().unwrap())
            .collect();
        assert_eq!(ahead, vec![2.0; 17]);
        let problems = problems(&status);
        assert_eq!(problems.iter().filter(|code| *code == "clock-offset").count(), 1);
        assert_eq!(problems[0], "humidity-is-temperature");
        let copied = assessment["sensors"]
            .as_array()
            .unwrap()
            .iter()
            .find(|sensor| !sensor["not_used"].is_null())
            .unwrap();
        assert_eq!(
            (&copied["sensor"], &copied["quantity"]),
            (&"Ta_RH_Test/2_BME280".into(), &"relative_humidity_percent".into())
        );
    }

    #[test]
    fn a_box_labelled_50_percent_reads_59_9() {
        let folder = CampaignFolder::new();
        folder.write(
            "campaign.toml",
            crate::campaign::CAMPAIGN_TOML.replace("Tallinn", "Zurich"),
        );
        add_run(
            &folder,
            "a",
            1,
            "2023-04-26T12:00:00+02:00",
            "relative_humidity_percent = 50\n",
        );
        let wanted = |name: &str| name == "MoistureData_DL_121TH_ClimateBox_raw_RH50.csv";
        if with_files(&folder, "data/wood-rheology-sorption", wanted).is_none() {
            return;
        }
        ingest(&folder);
        let run = &runs(&folder)[0];
        let humidity = of(run, ClimateQuantity::RelativeHumidity);
        // The authors state 59.9 % and 18.1 °C for the settled box.
        assert!((humidity.mean - 59.9).abs() < 0.5, "{humidity:?}");
        assert!((of(run, ClimateQuantity::Temperature).mean - 18.1).abs() < 0.5);
        // The logger writes dew points of its own: a second statement of the formula, over all of its range.
        let log =
            std::fs::read_to_string(folder.join("ambient/MoistureData_DL_121TH_ClimateBox_raw_RH50.csv"))
                .unwrap();
        let mut compared = 0;
        for line in log.lines().filter(|line| line.starts_with("\"")) {
            let cells: Vec<f64> = line
                .split(',')
                .filter_map(|cell| cell.trim_matches('"').parse().ok())
                .collect();
            if let [temperature_c, percent, own_c] = cells[..] {
                let found_c = dew_point_c(vapour_pressure_pa(temperature_c, percent)).unwrap();
                assert!((found_c - own_c).abs() < 0.03, "{line}: {found_c}");
                compared += 1;
            }
        }
        assert_eq!(compared, 4447);
        let issue = run
            .issues
            .iter()
            .find(|issue| issue.code == "tag-disagreement")
            .unwrap();
        assert!(issue.message.contains("and 50 ("), "{}", issue.message);
    }

    #[test]
    fn two_loggers_of_one_box_differ_by_two_percent_and_one_is_at_its_end() {
        let folder = CampaignFolder::new();
        folder.write(
            "campaign.toml",
            crate::campaign::CAMPAIGN_TOML.replace("Tallinn", "Zurich"),
        );
        let wanted = |name: &str| name.contains("RH05_Desorption") && !name.starts_with("Precheck");
        if with_files(&folder, "data/wood-rheology-sorption", wanted).is_none() {
            return;
        }
        ingest(&folder);
        let status = climate(&folder);
        let pair = &status["assessment"]["pairs"][0];
        assert_eq!(pair["first"], "010104085");
        assert!((pair["bias"].as_f64().unwrap() + 2.0).abs() < 0.15, "{pair}");
        let issues = status["assessment"]["issues"].as_array().unwrap().clone();
        let at_end = issues
            .iter()
            .find(|issue| issue["code"] == "sensor-at-end")
            .unwrap();
        assert!(
            at_end["message"].as_str().unwrap().contains("exactly 3.5 %"),
            "{at_end}"
        );
        assert!(
            at_end["message"].as_str().unwrap().contains("in 920 of 1199"),
            "{at_end}"
        );
    }

    #[test]
    fn every_real_log_becomes_series_of_its_sensors() {
        let folder = CampaignFolder::new();
        let is_log =
            |name: &str| (name.ends_with(".csv") || name.ends_with(".txt")) && name != "expected.json";
        let mut files = 0;
        for from in [
            "data/wood-rheology-sorption",
            "data/hobo-u12-indoor",
            "formats/rh_loggers",
        ] {
            files += with_files(&folder, from, is_log).unwrap_or(0);
        }
        if files == 0 {
            return;
        }
        let summary = ingest(&folder);
        assert_eq!(summary["refused"], serde_json::json!([]));
        // The U12's log lies in two of the folders: the same bytes under one name.
        assert_eq!(
            summary["logs"]["new"].as_array().unwrap().len(),
            summary["logs"]["files"].as_u64().unwrap() as usize
        );
        let status = climate(&folder);
        let sensors = status["assessment"]["sensors"].as_array().unwrap().clone();
        let sensor = |name: &str, quantity: &str| {
            let is = |sensor: &&Value| sensor["sensor"] == name && sensor["quantity"] == quantity;
            sensors
                .iter()
                .find(is)
                .unwrap_or_else(|| panic!("{name} {quantity}"))
                .clone()
        };
        // Month first, as its provenance shows; 30 minutes; the offset stands in the header.
        let u12 = sensor("sample_hobo_u12_data", "relative_humidity_percent");
        assert_eq!(u12["from"], "2013-10-02T05:00:00Z");
        assert_eq!(
            (u12["readings"].as_u64(), u12["interval_s"].as_f64()),
            (Some(2998), Some(1800.0))
        );
        assert!(
            (u12["least"].as_f64().unwrap() - 39.0).abs() < 0.1
                && (u12["most"].as_f64().unwrap() - 73.4).abs() < 0.1
        );
        // Fahrenheit became Celsius; humidity above 100 % is pointed out.
        let h08 = sensor("274341", "temperature_c");
        assert!(
            (h08["most"].as_f64().unwrap() - (37.2 - 32.0) / 1.8).abs() < 1e-3,
            "{h08}"
        );
        assert!(problems(&status).contains(&"humidity-out-of-range".to_owned()));
        // Four depths of one logger, three thermocouples of another.
        assert_eq!(
            sensor("20750528", "temperature_c")["readings"],
            sensor("20750528/4", "temperature_c")["readings"]
        );
        assert_eq!(
            sensor("picolog_temperature_sparse/Outside", "temperature_c")["readings"],
            2226
        );
        // The logger of the wood boxes is one sensor in all of its five files.
        assert_eq!(sensor("010104085", "temperature_c")["files"], 5);
    }
}
