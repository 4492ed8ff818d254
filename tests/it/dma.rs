//! Modulus logs as their user sees them: files under dma/ in, table 4 and figure 24 out.

use std::path::Path;

use ieap::domain::Quantity;
use ieap::ingest::formats::{ReadContext, read};
use ieap::pipeline::standalone::simulate::Simulate;
use ieap::pipeline::{AnalyseModulus, Context, Ingest, RenderReport, Silent};
use ieap::report::pages::PAGES;
use ieap::report::{Input, Site};
use serde_json::Value;

use crate::campaign::{CampaignFolder, command};
use crate::report_fixture::current_only_input;
use crate::watch::until;

use super::page_outline::outline;

/// A log of 40 min at 0 %, 80 at 40 % and 80 at 0 % relative humidity; |E*| goes from 100 to 80 MPa and back.
fn log(seed: u32, header: &str, columns: &[&str]) -> String {
    let mut state = seed.wrapping_mul(2_654_435_761).wrapping_add(12345);
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1u32 << 24) - 0.5
    };
    let mut text = header.to_owned();
    for row in 0..=400 {
        let time_s = 30.0 * f64::from(row);
        let lag = |start_s: f64, tau_s: f64| {
            if time_s > start_s {
                1.0 - (-(time_s - start_s) / tau_s).exp()
            } else {
                0.0
            }
        };
        let percent = 40.0 * (lag(2400.0, 40.0) - lag(7200.0, 40.0)) + 0.3 * noise();
        let complex_mpa = 100.0 - 20.0 * (lag(2400.0, 300.0) - lag(7200.0, 300.0)) + 0.5 * noise();
        let cells: Vec<String> = columns
            .iter()
            .map(|column| match *column {
                "minutes" => format!("{}", time_s / 60.0),
                "time" => format!("{time_s}"),
                "humidity" => format!("{percent:.2}"),
                "storage" => format!("{:.3}", complex_mpa * 0.8),
                "loss" => format!("{:.3}", complex_mpa * 0.6),
                "complex" => format!("{complex_mpa:.3}"),
                other => panic!("{other}"),
            })
            .collect();
        text += &cells.join(",");
        text.push('\n');
    }
    text
}

pub fn plain_log(seed: u32) -> String {
    log(
        seed,
        "time_s,relative_humidity_percent,storage_modulus_mpa,loss_modulus_mpa\n",
        &["time", "humidity", "storage", "loss"],
    )
}

/// A campaign whose dma/ belongs to the sample S1.
fn folder() -> CampaignFolder {
    let folder = CampaignFolder::new();
    folder.write("dma/tags.toml", "sample = \"S1\"\n");
    folder
}

fn logs(folder: &CampaignFolder) -> Value {
    let ended = folder.ieap(&["dma", "--json"]);
    assert!([0, 3].contains(&ended.status), "{ended:#?}");
    ended.json()["logs"].clone()
}

fn change(log: &Value) -> f64 {
    log["steps"][0]["estimates"]["relative_change_percent"]["value"]
        .as_f64()
        .unwrap_or_else(|| panic!("{log:#}"))
}

/// The thesis's campaign with its modulus logs only, taken in and analysed.
fn thesis() -> (tempfile::TempDir, Context) {
    let folder = tempfile::tempdir().unwrap();
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("campaigns/thesis");
    std::fs::create_dir_all(folder.path().join("runs")).unwrap();
    std::fs::create_dir_all(folder.path().join("dma")).unwrap();
    std::fs::copy(source.join("campaign.toml"), folder.path().join("campaign.toml")).unwrap();
    for entry in std::fs::read_dir(source.join("dma")).unwrap() {
        let entry = entry.unwrap();
        std::fs::copy(entry.path(), folder.path().join("dma").join(entry.file_name())).unwrap();
    }
    let mut context = Context::open(folder.path(), false).unwrap();
    Ingest { ready: &mut |_| true }
        .run(&mut context, &Silent)
        .unwrap();
    let done = AnalyseModulus::default().run(&mut context, &Silent).unwrap();
    assert_eq!((done.analysed, done.failed.len()), (3, 0));
    (folder, context)
}

#[test]
fn the_committed_logs_are_what_the_spec_writes_and_say_that_they_are_simulated() {
    let folder = tempfile::tempdir().unwrap();
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("campaigns/thesis");
    let spec = folder.path().join("simulation.toml");
    std::fs::copy(source.join("simulation.toml"), &spec).unwrap();
    let simulate = Simulate {
        spec,
        seed: None,
        overwrite: false,
    };
    simulate.run(&Silent).unwrap();
    let mut files = 0;
    for entry in std::fs::read_dir(source.join("dma")).unwrap() {
        let path = entry.unwrap().path();
        let written = folder.path().join("dma").join(path.file_name().unwrap());
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(
            text,
            std::fs::read_to_string(written).unwrap(),
            "{}",
            path.display()
        );
        let is_table = path.extension().is_some_and(|extension| extension == "csv");
        assert!(
            !is_table || text.starts_with("# SIMULATED, not measured"),
            "{}",
            path.display()
        );
        files += 1;
    }
    assert_eq!(files, 6);
}

#[test]
fn the_page_of_the_thesis_logs() {
    let (_folder, context) = thesis();
    let mut logs = context.store.modulus_logs().unwrap();
    for log in &mut logs {
        log.run.ingested_at = "2026-11-20T06:00:00Z".to_owned();
    }
    let input = Input {
        campaign: context.campaign.clone(),
        modulus_logs: logs,
        ..current_only_input()
    };
    let page = PAGES.iter().find(|page| page.file == "dma.html").unwrap();
    assert!((page.is_shown)(&input) && !(page.is_shown)(&current_only_input()));
    let content = (page.content)(&Site::new(&input)).unwrap();
    insta::assert_snapshot!(outline(&content.context));
    // All together, and of each log its course and |E*| over the humidity.
    assert_eq!(content.figures.len(), 7);
    assert!(content.figures["chart-1"].contains("Nafion-117-EMImTFS"));
}

#[test]
fn a_report_has_the_page_where_there_are_logs_and_links_to_it() {
    let (folder, context) = thesis();
    let report = RenderReport::default().run(&context, &Silent).unwrap();
    let page = |name: &str| std::fs::read_to_string(folder.path().join("report").join(name)).unwrap();
    assert!(page("parameters.html").contains("href=\"dma.html\""));
    assert!(page("dma.html").contains("Simulated, not measured"));
    assert!(page("dma.csv").lines().count() > 50);
    // Overview, parameters, findings, climate, files and this one.
    assert_eq!(report.pages, 6);
    let without = CampaignFolder::new();
    without.run_json();
    assert!(!without.report("parameters.html").contains("dma.html"));
    assert!(!without.join("report/dma.html").exists());
}

#[test]
fn logs_are_taken_in_once_revised_renamed_and_kept_apart_from_runs() {
    let folder = folder();
    folder.write("dma/a.csv", plain_log(1));
    folder.write("dma/copy.csv", plain_log(1));
    let first = folder.run_json();
    assert_eq!(first["ingest"]["new"], serde_json::json!(["dma/a.csv"]));
    assert_eq!(first["ingest"]["aliases"], serde_json::json!(["dma/copy.csv"]));
    assert_eq!(
        (&first["modulus"]["analysed"], &first["fit"]["fitted"]),
        (&1.into(), &0.into())
    );
    let again = folder.run_json();
    assert_eq!(
        (&again["modulus"]["analysed"], &again["modulus"]["up_to_date"]),
        (&0.into(), &1.into())
    );
    assert_eq!(again["report"]["rendered"], false);
    assert!((change(&logs(&folder)[0]) + 20.0).abs() < 1.0);
    // New content is a revision and is analysed anew; a moved file keeps its log.
    std::fs::remove_file(folder.join("dma/copy.csv")).unwrap();
    let whole = plain_log(1);
    let (cut, _) = whole.trim_end().rsplit_once('\n').unwrap();
    folder.write("dma/a.csv", cut);
    assert_eq!(folder.run_json()["modulus"]["analysed"], 1);
    std::fs::rename(folder.join("dma/a.csv"), folder.join("dma/b.csv")).unwrap();
    assert_eq!(
        folder.run_json()["ingest"]["renamed"],
        serde_json::json!([["dma/a.csv", "dma/b.csv"]])
    );
    let status = folder.ieap(&["status", "--json"]).expect(0).json()["status"].clone();
    assert_eq!(
        (&status["runs"], &status["modulus_logs_by_state"]["analysed"]),
        (&0.into(), &1.into())
    );
    assert_eq!(logs(&folder)[0]["revision"], 2);
    // The same bytes among the runs are a run of their own, which nothing can fit.
    folder.write("runs/b.csv", cut);
    assert_eq!(
        folder.run_json()["ingest"]["new"],
        serde_json::json!(["runs/b.csv"])
    );
    let exported = folder
        .ieap(&["export", "--what", "dma", "-o", "dma.csv"])
        .expect(0);
    assert!(exported.stdout.contains("21 rows"), "{exported:?}");
}

#[test]
fn a_folder_of_logs_that_goes_takes_nothing_with_it() {
    let folder = folder();
    folder.write("dma/a.csv", plain_log(1));
    folder.run_json();
    std::fs::rename(folder.join("dma"), folder.join("away")).unwrap();
    assert_eq!(folder.run_json()["ingest"]["gone"], serde_json::json!([]));
    std::fs::rename(folder.join("away"), folder.join("dma")).unwrap();
    std::fs::remove_file(folder.join("dma/a.csv")).unwrap();
    assert_eq!(
        folder.run_json()["ingest"]["gone"],
        serde_json::json!(["dma/a.csv"])
    );
    assert_eq!(logs(&folder).as_array().unwrap().len(), 1);
}

#[test]
fn the_humidity_may_stand_in_a_file_of_its_own() {
    let folder = folder();
    folder.write(
        "dma/a.modulus.csv",
        log(3, "Time (min),|E*| (MPa)\n", &["minutes", "complex"]),
    );
    folder.write(
        "dma/a.humidity.csv",
        log(4, "time_s,relative_humidity_percent\n", &["time", "humidity"]),
    );
    let found = logs(&folder);
    assert_eq!(found[0]["log"], "dma/a.csv");
    assert_eq!(found[0]["modulus_source"], "|E*| as the instrument gives it");
    assert!((change(&found[0]) + 20.0).abs() < 1.0);
}

#[test]
fn columns_that_were_never_seen_are_used_when_a_tag_says_what_they_are() {
    let folder = folder();
    let header = "#EXPORTTYPE:DATA ALL\n#DECIMAL:POINT\n#SEPARATOR:COMMA\n#MTYPE:DMA\n\
                  ##Time/min,E'/MPa,E''/MPa,RH/%\n";
    folder.write(
        "dma/a.txt",
        log(5, header, &["minutes", "storage", "loss", "humidity"]),
    );
    let waiting = &logs(&folder)[0];
    assert_eq!(waiting["state"], "not_fitted");
    assert_eq!(waiting["issues"][0]["code"], "no-modulus");
    assert!(
        waiting["issues"][0]["mend"]
            .as_str()
            .unwrap()
            .contains("storage_modulus_column")
    );
    folder.write(
        "dma/a.txt.toml",
        "storage_modulus_column = \"E'/MPa\"\nloss_modulus_column = \"E''/MPa\"\n\
         relative_humidity_column = \"RH/%\"\n",
    );
    let found = &logs(&folder)[0];
    assert_eq!(
        (&found["state"], found["issues"].as_array().unwrap().len()),
        (&"ready".into(), 0)
    );
    assert!((change(found) + 20.0).abs() < 1.0);
    // Taken back, the log waits again.
    folder.write("dma/a.txt.toml", "");
    assert_eq!(logs(&folder)[0]["steps"], serde_json::json!([]));
}

#[test]
fn bad_logs_are_refused_or_wait_with_their_reason_and_the_others_go_on() {
    let folder = CampaignFolder::new();
    folder.write("dma/good.csv", plain_log(1));
    folder.write("dma/good.csv.toml", "sample = \"S1\"\n");
    folder.write("dma/untagged.csv", plain_log(2));
    folder.write("dma/unknown.csv", plain_log(3));
    folder.write("dma/unknown.csv.toml", "sample = \"S9\"\n");
    folder.write("dma/empty.csv", "");
    folder.write(
        "dma/noise.xls",
        b"\xd0\xcf\x11\xe0 Exported Data, Data header and nothing more",
    );
    folder.write(
        "dma/words.csv",
        "time_s,storage_modulus_mpa\nsoft,softer\nhard,harder\n",
    );
    folder.write(
        "dma/alone.csv",
        log(
            4,
            "time_s,relative_humidity_percent,E' (MPa)\n",
            &["time", "humidity", "storage"],
        ),
    );
    folder.write("dma/alone.csv.toml", "sample = \"S1\"\n");
    folder.write(
        "dma/short.csv",
        "time_s,complex_modulus_mpa,rh (%)\n0,1,0\n30,2,40\n60,1,0\n",
    );
    folder.write("dma/short.csv.toml", "sample = \"S1\"\n");
    let summary = folder.run_json();
    let refused: Vec<&str> = summary["ingest"]["refused"]
        .as_array()
        .unwrap()
        .iter()
        .map(|pair| pair[0].as_str().unwrap())
        .collect();
    assert_eq!(refused, ["dma/noise.xls", "dma/words.csv"], "{summary:#}");
    assert_eq!(summary["modulus"]["failed"][0][1]["code"], "no-complex-modulus");
    let status = folder.ieap(&["status", "--json"]).expect(0).json()["status"].clone();
    assert_eq!(
        status["modulus_logs_by_state"],
        serde_json::json!({ "analysed": 2, "not_analysed": 1, "untagged": 2 })
    );
    let all = logs(&folder);
    let of = |name: &str| {
        let path = format!("dma/{name}.csv");
        all.as_array()
            .unwrap()
            .iter()
            .find(|log| log["log"] == path.as_str())
            .unwrap()
    };
    assert!((change(of("good")) + 20.0).abs() < 1.0);
    assert_eq!(of("short")["steps"], serde_json::json!([]));
    assert_eq!(of("untagged")["issues"][0]["code"], "tag-missing");
    assert_eq!(of("unknown")["issues"][0]["code"], "unknown-sample");
    assert!(
        folder
            .report("dma.html")
            .contains("no source says which sample was measured")
    );
    // A tag by hand is enough.
    folder.ieap(&["tag", "dma/untagged.csv", "sample=S1"]).expect(0);
    assert_eq!(folder.run_json()["modulus"]["analysed"], 1);
}

#[cfg(unix)]
#[test]
fn a_watch_takes_a_log_into_a_folder_that_comes_later() {
    let folder = CampaignFolder::new();
    let mut child = command(folder.path(), &["watch", "--quiet-s", "0.3"])
        .stderr(std::process::Stdio::null())
        .stdout(std::process::Stdio::null())
        .spawn()
        .unwrap();
    until("the first report", || folder.join("report/index.html").exists());
    folder.write("dma/tags.toml", "sample = \"S1\"\n");
    folder.write("dma/a.csv", plain_log(1));
    until("the log's page", || folder.join("report/dma.html").exists());
    folder.write("dma/later.csv", plain_log(2));
    until("the second log", || {
        folder.report("dma.html").contains("dma/later.csv")
    });
    child.kill().unwrap();
    child.wait().unwrap();
}

/// `"14-12-2022 11:14:01","19.9","48.7","8.79"`: the humidity.
fn humidity_of_box(line: &str) -> Option<f64> {
    let cells: Vec<&str> = line.split([',', '\t', ';']).map(str::trim).collect();
    let date = cells
        .iter()
        .position(|cell| cell.len() >= 16 && cell.contains(':') && cell.contains('-'))?;
    cells.get(date + 2)?.trim_matches('"').parse().ok()
}

/// Against what lies beside the project.
mod needs_shared {
    use super::*;
    use crate::needs_shared::shared;

    #[test]
    fn table_4_of_the_thesis_comes_back() {
        let Some(path) = shared("reference/thesis_table4_dma.csv") else {
            return;
        };
        let samples = [
            ("Nafion 117 dry", "Nafion-117-dry"),
            ("Nafion 117 with EMImTFS", "Nafion-117-EMImTFS"),
            ("CNaf", "CNaf-2"),
        ];
        let (_folder, context) = thesis();
        let logs = context.store.modulus_logs().unwrap();
        let mut rows = 0;
        for row in csv::Reader::from_path(path).unwrap().records() {
            let row = row.unwrap();
            let (_, sample) = samples.iter().find(|(printed, _)| *printed == &row[0]).unwrap();
            let log = logs
                .iter()
                .find(|log| log.run.tag("sample") == Some(sample))
                .unwrap();
            let step = &log.analysis.as_ref().unwrap().steps[0];
            let holds = |key: &str, truth: f64| {
                let estimate = step.estimate(key).unwrap();
                let (low, high) = (estimate.low_95.unwrap(), estimate.high_95.unwrap());
                assert!(
                    low <= truth && truth <= high,
                    "{sample} {key}: {low} to {high}, {truth}"
                );
                assert!(
                    high - low < 0.05 * truth.abs().max(40.0),
                    "{sample} {key}: {low} to {high}"
                );
                estimate.value.unwrap()
            };
            let (before, after): (f64, f64) = (row[1].parse().unwrap(), row[2].parse().unwrap());
            holds("complex_modulus_before_mpa", before);
            holds("complex_modulus_after_mpa", after);
            let found = holds("relative_change_percent", 100.0 * (after / before - 1.0));
            // The thesis rounds its changes: 39.1 to 40, 21.4 to 20, 3.6 to "<5".
            match row[3].strip_prefix('<') {
                Some(bound) => assert!(-found < bound.parse().unwrap(), "{sample}: {found}"),
                None => assert!(
                    (-found - row[3].parse::<f64>().unwrap()).abs() < 2.0,
                    "{sample}: {found}"
                ),
            }
            rows += 1;
        }
        assert_eq!(rows, 3);
        // What the text beside the table says: equilibrium after 5 to 10 and about 20 minutes, and a membrane that is far
        // from recovered.
        let of = |sample: &str| {
            logs.iter()
                .find(|log| log.run.tag("sample") == Some(sample))
                .unwrap()
        };
        let minutes = |sample: &str| {
            let step = &of(sample).analysis.as_ref().unwrap().steps[0];
            step.estimate("equilibrium_time_s").unwrap().value.unwrap() / 60.0
        };
        assert!((5.0..10.0).contains(&minutes("Nafion-117-EMImTFS")));
        assert!((18.0..22.0).contains(&minutes("CNaf-2")));
        let dry = of("Nafion-117-dry").analysis.as_ref().unwrap();
        assert!(dry.recovery().unwrap().high_95.unwrap() < 60.0);
        assert!(
            dry.steps[1]
                .estimate("equilibrium_time_s")
                .unwrap()
                .value
                .is_none()
        );
    }

    #[test]
    fn the_eplexor_export_that_is_public_is_read() {
        let Some(path) = shared("formats/netzsch/freq_Eplexor_raw.xls") else {
            return;
        };
        let bytes = std::fs::read(path).unwrap();
        let reading = read("freq_Eplexor_raw.xls", &bytes, &ReadContext::default()).unwrap();
        assert_eq!((reading.format, reading.tables[0].rows), ("eplexor-xls", 210));
        assert_eq!(reading.technique.as_deref(), Some("Temp. Freq. Sweep"));
        assert!(reading.issues.is_empty(), "{:?}", reading.issues);
        let channel = |quantity| {
            reading.tables[0]
                .channels
                .iter()
                .find(|c| c.quantity == quantity)
                .unwrap()
        };
        let storage = channel(Quantity::StorageModulus);
        assert_eq!(
            (storage.time_s[0], storage.values[0]),
            (6432.17, 8097.1755453452715)
        );
        assert_eq!(channel(Quantity::LossFactor).values[209], 0.38135379317838003);
        // Its own columns agree: |E*| is what storage and loss modulus give. As a sweep it holds no modulus over time.
        let channels = &reading.tables[0].channels;
        let refused = ieap::analysis::dma::analyse(channels).unwrap_err();
        assert_eq!(refused.code, "frequency-sweep");
        for k in 0..210 {
            let loss = channel(Quantity::LossModulus).values[k];
            let complex = channel(Quantity::ComplexModulus).values[k];
            assert!((storage.values[k].hypot(loss) / complex - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn humidity_of_real_chambers_gives_steps_only_where_the_level_changes() {
        let Some(folder) = shared("data/wood-rheology-sorption") else {
            return;
        };
        let entries = std::fs::read_dir(&folder).unwrap();
        let mut logs = 0;
        for entry in entries {
            let path = entry.unwrap().path();
            if path.extension().is_none_or(|extension| extension != "csv") {
                continue;
            }
            let text = String::from_utf8_lossy(&std::fs::read(&path).unwrap()).into_owned();
            let percent: Vec<f64> = text.lines().filter_map(humidity_of_box).collect();
            let time_s: Vec<f64> = (0..percent.len()).map(|k| 600.0 * k as f64).collect();
            let found = ieap::analysis::dma::humidity_steps::find(&time_s, &percent);
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            println!("{name}: {} readings, {} steps", percent.len(), found.steps.len());
            for step in &found.steps {
                println!("   {step:.1?}");
                assert!(
                    (step.after_percent - step.before_percent).abs() > 3.0,
                    "{name}: {step:?}"
                );
                assert!(
                    step.held_from_s <= step.start_s && step.start_s <= step.settled_s,
                    "{name}: {step:?}"
                );
            }
            // A box stands weeks at one humidity; it is opened now and then, and filled and emptied at the ends.
            assert!(
                percent.len() > 1000 && found.steps.len() <= 6,
                "{name}: {:?}",
                found.steps
            );
            logs += 1;
        }
        assert_eq!(logs, 15);
    }
}
