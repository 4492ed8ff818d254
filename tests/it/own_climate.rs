//! Humidity and temperature that a run measured itself, in columns beside voltage and current.

use ieap::domain::{ClimateQuantity, RunRecord, TagSource};
use ieap::store::Store;

use crate::campaign::{CampaignFolder, run_table};

/// A run of 319 s whose humidity goes from 44.2 to 46.2 % with a mean of 45.2 %, at 23.1 °C.
fn own_table(seed: u32) -> String {
    let table = run_table(seed);
    let (head, rows) = table.split_once('\n').unwrap();
    let last = rows.lines().count() - 1;
    let mut text = format!("{head},RH (%),T (°C)\n");
    for (at, row) in rows.lines().enumerate() {
        let humidity = 44.2 + 2.0 * at as f64 / last as f64;
        text += &format!("{row},{humidity:.6},23.1\n");
    }
    text
}

/// A log of a reading a minute for three hours from 09:00.
fn log(humidity: f64, temperature: f64) -> String {
    let mut text = String::from("Time,Temperature (°C),Relative Humidity (%)\n");
    for k in 0..180 {
        text += &format!(
            "2026-01-10 {:02}:{:02}:00,{temperature},{humidity}\n",
            9 + k / 60,
            k % 60
        );
    }
    text
}

const START: &str = "started_at = \"2026-01-10T10:00:00+02:00\"\n";

fn ingested(folder: &CampaignFolder) -> Vec<RunRecord> {
    let ended = folder.ieap(&["ingest"]);
    assert!([0, 3].contains(&ended.status), "{ended:#?}");
    let store = Store::open_read_only(folder.path()).unwrap().unwrap();
    store.runs().unwrap()
}

/// Value, source and detail of the chosen tag.
fn chosen<'a>(run: &'a RunRecord, key: &str) -> Option<(&'a str, TagSource, &'a str)> {
    let tag = run.tags.iter().find(|tag| tag.key == key)?;
    Some((tag.value.as_str(), tag.source, tag.detail.as_str()))
}

fn codes(run: &RunRecord) -> Vec<&str> {
    run.issues.iter().map(|issue| issue.code.as_str()).collect()
}

#[test]
fn own_columns_give_humidity_and_temperature_before_a_log() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", own_table(1));
    folder.write("runs/a.csv.toml", START);
    folder.write("ambient/room.csv", log(61.0, 20.0));
    let run = &ingested(&folder)[0];
    let (value, source, detail) = chosen(run, "relative_humidity_percent").unwrap();
    assert_eq!((value, source), ("45.2", TagSource::Column));
    assert!(
        detail.starts_with("RH (%), mean of 320 readings, sd 0.58 %"),
        "{detail}"
    );
    assert_eq!(source.label(), "its own column");
    let (value, source, _) = chosen(run, "temperature_c").unwrap();
    assert_eq!((value, source), ("23.1", TagSource::Column));
    // The log's means are kept beside it.
    let of_log: Vec<(&str, &str)> = (run.tags.iter())
        .filter(|tag| tag.source == TagSource::Ambient)
        .map(|tag| (tag.key.as_str(), tag.value.as_str()))
        .collect();
    assert_eq!(
        of_log,
        [("relative_humidity_percent", "61"), ("temperature_c", "20")]
    );
    let humidity: Vec<(&str, bool)> = (run.climate.iter())
        .filter(|found| found.quantity == ClimateQuantity::RelativeHumidity)
        .map(|found| (found.sensor.as_str(), found.chosen))
        .collect();
    assert_eq!(humidity, [("its own column RH (%)", true), ("room", false)]);
    let dew_point = (run.climate.iter()).find(|found| found.quantity == ClimateQuantity::DewPoint);
    assert!((dew_point.unwrap().mean - 10.54).abs() < 0.1, "{dew_point:?}");
    // As a series they are there, too, and what the log says is no false label.
    assert!(
        run.channels
            .iter()
            .any(|channel| channel.raw_name == "RH (%)" && channel.readings == 320)
    );
    let status = folder.ieap(&["status", "--json"]).expect(0).json()["status"]["climate"].clone();
    assert_eq!(status["runs_label_differs"], serde_json::json!([]), "{status:#}");
    assert_eq!(status["runs_covered"], 1);
    // Tables hold its own humidity.
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let table = folder.ieap(&["table", "conditions", "--format", "csv"]).expect(0);
    assert!(
        table.stdout.contains("\nCNaf,air,45,2,1,1,1,"),
        "{}",
        table.stdout
    );
    // A log that goes takes nothing of it.
    std::fs::remove_file(folder.join("ambient/room.csv")).unwrap();
    let run = &ingested(&folder)[0];
    assert_eq!(run.tag("relative_humidity_percent"), Some("45.2"));
}

#[test]
fn what_was_measured_wins_and_a_clear_contradiction_is_a_warning() {
    let folder = CampaignFolder::new();
    folder.write("runs/agrees.csv", own_table(1));
    folder.write("runs/agrees.csv.toml", "relative_humidity_percent = 47\n");
    folder.write("runs/contradicts.csv", own_table(2));
    folder.write("runs/contradicts.csv.toml", "relative_humidity_percent = 60\n");
    let runs = ingested(&folder);
    let label = |run: &RunRecord| run.tag("relative_humidity_percent").map(str::to_owned);
    assert_eq!(
        (label(&runs[0]).as_deref(), label(&runs[1]).as_deref()),
        (Some("45.2"), Some("45.2"))
    );
    assert!(
        !codes(&runs[0]).contains(&"tag-disagreement"),
        "{:?}",
        runs[0].issues
    );
    let said = runs[1]
        .issues
        .iter()
        .find(|issue| issue.code == "tag-disagreement");
    let said = said.unwrap_or_else(|| panic!("{:?}", runs[1].issues));
    assert_eq!(said.severity.key(), "warning");
    assert!(
        said.message.contains("its own column: RH (%)"),
        "{}",
        said.message
    );
    let status = folder.ieap(&["status", "--json"]).expect(0).json()["status"]["climate"].clone();
    assert_eq!(
        status["runs_label_differs"],
        serde_json::json!(["runs/contradicts.csv"])
    );
}

#[test]
fn without_a_start_its_own_columns_hold_and_no_untruth_is_said() {
    let folder = CampaignFolder::new();
    folder.write("runs/own.csv", own_table(1));
    folder.write("runs/none.csv", run_table(2));
    folder.write("runs/wrong.csv", run_table(3));
    folder.write("runs/wrong.csv.toml", "started_at = \"10.01.2026\"\n");
    folder.write("runs/day.csv", run_table(5));
    folder.write("runs/day.csv.toml", "started_at = 2026-01-10\n");
    folder.write("runs/stated.csv", run_table(4));
    folder.write("runs/stated.csv.toml", START);
    folder.write("ambient/room.csv", log(61.0, 20.0));
    let runs = ingested(&folder);
    let of = |path: &str| runs.iter().find(|run| run.path == path).unwrap();
    assert_eq!(of("runs/own.csv").tag("relative_humidity_percent"), Some("45.2"));
    assert_eq!(of("runs/own.csv").tag("temperature_c"), Some("23.1"));
    for (path, expected) in [
        ("runs/own.csv", None),
        ("runs/none.csv", Some("nothing says when the run started")),
        (
            "runs/wrong.csv",
            Some("the start that is stated for the run cannot be used"),
        ),
        (
            "runs/day.csv",
            Some("the start of the run is a day without a time"),
        ),
        ("runs/stated.csv", None),
    ] {
        let said = of(path)
            .issues
            .iter()
            .find(|issue| issue.code == "climate-no-start");
        assert_eq!(said.is_some(), expected.is_some(), "{path}: {said:?}");
        if let (Some(said), Some(expected)) = (said, expected) {
            assert!(said.message.ends_with(expected), "{}", said.message);
        }
    }
    assert_eq!(of("runs/day.csv").tag("started_at"), Some("2026-01-10"));
    assert!(of("runs/day.csv").climate.is_empty());
    let shown = folder.ieap(&["status"]).expect(0).stdout;
    assert!(
        shown.contains("no start of them is known") && !shown.contains("state no start"),
        "{shown}"
    );
    let status = folder.ieap(&["status", "--json"]).expect(0).json()["status"]["climate"].clone();
    let without = serde_json::json!(["runs/day.csv", "runs/none.csv", "runs/wrong.csv"]);
    assert_eq!(status["runs_without_start"], without);
    assert_eq!(status["runs_covered"], 1, "the log covers the one with a start");
}

#[test]
fn a_column_that_covers_half_of_a_run_is_not_its_climate() {
    let folder = CampaignFolder::new();
    let half = own_table(1)
        .lines()
        .enumerate()
        .fold(String::new(), |text, (at, line)| {
            let line = if at > 160 {
                line.replace(",23.1", ",")
            } else {
                line.to_owned()
            };
            text + &line + "\n"
        });
    folder.write("runs/a.csv", half);
    let run = &ingested(&folder)[0];
    assert_eq!(run.tag("relative_humidity_percent"), Some("45.2"));
    assert_eq!(run.tag("temperature_c"), None);
    let said = run
        .issues
        .iter()
        .find(|issue| issue.code == "climate-not-covered")
        .unwrap();
    assert!(
        said.message
            .contains("its own column T (°C) does not cover 2.7 min of it"),
        "{}",
        said.message
    );
}

/// Relative humidity of a room since 09:00, percent.
fn humidity(since_s: f64) -> f64 {
    40.0 + 8.0 * (since_s / 12.0).sin()
}

/// What a logger in a room reads every ten seconds.
fn log_of(humidity: impl Fn(f64) -> f64) -> String {
    let mut log = String::from("Time,Temperature (°C),Relative Humidity (%)\n");
    for k in 0..1_080 {
        let (hour, minute) = (9 + k / 360, k % 360 / 6);
        log += &format!(
            "2026-01-10 {hour:02}:{minute:02}:{:02},21.0,{:.1}\n",
            k % 6 * 10,
            humidity(10.0 * f64::from(k))
        );
    }
    log
}

/// Four runs of one strip, half an hour apart, at other voltages, that leak by the humidity around them.
fn leaking_in_a_room() -> CampaignFolder {
    let folder = CampaignFolder::new();
    for (name, seed, part, began_s) in [
        ("a", 1, 1.0, 3600.0),
        ("b", 2, 0.5, 5400.0),
        ("c", 3, -1.0, 7200.0),
        ("d", 4, 0.75, 9000.0),
    ] {
        let table = run_table(seed);
        let (head, rows) = table.split_once('\n').unwrap();
        let mut text = format!("{head}\n");
        for row in rows.lines() {
            let cells: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
            let [t, volts, current_a, bent] = cells[..] else {
                panic!("{row}")
            };
            // The clock of the run begins at -20 s.
            let leak_a = 1e-5 * volts * (humidity(began_s + t + 20.0) - 40.0) / 8.0;
            let (volts, current_a, bent) = (part * volts, part * (current_a + leak_a), part * bent);
            text += &format!("{t},{volts},{current_a:.6e},{bent:.5}\n");
        }
        folder.write(&format!("runs/{name}.csv"), text);
        let (hour, minute) = (9 + began_s as u32 / 3600, began_s as u32 % 3600 / 60);
        folder.write(
            &format!("runs/{name}.csv.toml"),
            format!("started_at = \"2026-01-10T{hour:02}:{minute:02}:00+02:00\"\n"),
        );
    }
    folder.write("ambient/room.csv", log_of(humidity));
    folder
}

#[test]
fn a_law_of_a_humidity_that_a_logger_in_the_room_read_is_told() {
    let folder = leaking_in_a_room();
    let ran = folder.ieap(&["run", "--quiet"]);
    assert!([0, 1, 3].contains(&ran.status), "{ran:#?}");
    let found = folder.ieap(&["diagnose", "--json"]).json();
    let group = &found["groups"][0];
    let law = &group["missing"][0];
    assert_eq!(law["variable"], "relative_humidity_percent", "{group:#}");
    assert_eq!(law["law"], "leak", "{law:#}");
    // A log that says otherwise is another question.
    folder.write("ambient/room.csv", log_of(|since_s| 40.0 + since_s / 1e4));
    let ran = folder.ieap(&["run", "--quiet"]);
    assert!([0, 1, 3].contains(&ran.status), "{ran:#?}");
    let found = folder.ieap(&["diagnose", "--json"]).json();
    let after = found["groups"][0]["missing"].to_string();
    assert!(!after.contains("relative_humidity"), "{after}");
}
