//! Data known to be bad never speak: runs that a person dropped, runs in another unit, copies.

use serde_json::Value;

use super::campaign::{CAMPAIGN_TOML, CampaignFolder};

/// How a run is written, and of what strip it is.
#[derive(Clone)]
struct Written {
    seed: u32,
    voltage_v: f64,
    /// Factors on current and time: what a wrong unit does.
    current: f64,
    time: f64,
    delimiter: char,
    digits: usize,
    rows: std::ops::Range<i32>,
}

impl Written {
    const fn of(seed: u32, voltage_v: f64) -> Written {
        Written {
            seed,
            voltage_v,
            current: 1.0,
            time: 1.0,
            delimiter: ',',
            digits: 6,
            rows: -20..300,
        }
    }

    /// A step response with noise of its own.
    fn text(self) -> String {
        let (d, digits) = (self.delimiter, self.digits);
        let mut text = format!("time_s{d}voltage_v{d}current_a{d}curvature_per_cm\n");
        let mut state = self.seed.wrapping_mul(2_654_435_761).wrapping_add(12345);
        let mut noise = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1u32 << 24) - 0.5
        };
        for step in -20i32..300 {
            let t = f64::from(step);
            let on = f64::from(u8::from(step >= 0)) * self.voltage_v / 2.0;
            let (tau_s, lambda_per_s) = (20.0, 0.002);
            let current_a = on * (1e-3 * (-t / tau_s).exp() + 2e-5) + 4e-6 * noise();
            let relaxed = ((-t / tau_s).exp() - (-lambda_per_s * t).exp()) / (tau_s * lambda_per_s - 1.0);
            let curvature = on * 0.4 * relaxed + 4e-3 * noise();
            if self.rows.contains(&step) {
                let (time, volts, amperes) = (t * self.time, 2.0 * on, current_a * self.current);
                text += &format!("{time}{d}{volts}{d}{amperes:.digits$e}{d}{curvature:.digits$e}\n");
            }
        }
        text
    }
}

/// Two voltages with repeats, in air and in inert gas.
fn good() -> CampaignFolder {
    let folder = CampaignFolder::new();
    let environments = [("air", 0), ("inert", 100)];
    for (environment, seed) in environments {
        let tags = format!("sample = \"S1\"\nenvironment = \"{environment}\"\n");
        folder.write(&format!("runs/{environment}/tags.toml"), tags);
        for (at, voltage_v) in [1.5, 1.5, 2.0, 2.0].into_iter().enumerate() {
            let run = Written::of(seed + at as u32 + 1, voltage_v).text();
            folder.write(
                &format!("runs/{environment}/{}.csv", ["a", "b", "c", "d"][at]),
                run,
            );
        }
    }
    folder
}

/// Everything that results are read from, as text: tables, exports, alarms, and the pages of results.
fn results(folder: &CampaignFolder) -> Vec<(String, String)> {
    let mut all = Vec::new();
    for table in [
        "table3",
        "table5",
        "table6",
        "conditions",
        "fits-wide",
        "findings",
    ] {
        let ended = folder.ieap(&["table", table, "--format", "json"]);
        if ended.status == 0 {
            all.push((table.to_owned(), without_origin(&ended.stdout)));
        }
    }
    for what in ["fits", "fits-wide", "conditions", "traces"] {
        let file = format!("{what}.csv");
        let _ = folder
            .ieap(&["export", "--what", what, "-o", &file, "--overwrite"])
            .expect(0);
        all.push((file.clone(), std::fs::read_to_string(folder.join(&file)).unwrap()));
    }
    let fits = folder.ieap(&["fit", "--json"]).expect(0).json();
    all.push(("fits".to_owned(), without_ids(&fits["fits"])));
    let alarms = folder.ieap(&["status", "--alarms", "--json"]).json();
    all.push(("alarms".to_owned(), alarms.to_string()));
    for page in ["study", "parameters", "monitoring", "findings"] {
        let path = folder.join(&format!("report/{page}.html"));
        let text = std::fs::read_to_string(path).unwrap_or_default();
        // The footer says which change of the database it was made from.
        let said = text.split("<footer").next().unwrap_or_default();
        all.push((format!("{page}.html"), without_aside(said)));
    }
    all
}

/// Without what says which change of the database it was made from.
fn without_origin(text: &str) -> String {
    let parts = text.split("change ").enumerate().map(|(at, part)| match at {
        0 => part.to_owned(),
        _ => part.split_once('Z').map_or(part, |(_, rest)| rest).to_owned(),
    });
    parts.collect()
}

/// Without what is shown of runs set aside: their marks, and the words about them.
fn without_aside(page: &str) -> String {
    let mut page = page.to_owned();
    for (mark, end) in [
        (" data-aside=\"1\"", "</g>"),
        (" class=\"legend aside\"", "</p>"),
        (" class=\"remark aside\"", "</p>"),
    ] {
        while let Some(at) = page.find(mark) {
            let start = page[..at].rfind('<').unwrap();
            let length = page[at..].find(end).unwrap() + end.len();
            page.replace_range(start..at + length, "");
        }
    }
    // What went leaves an empty line.
    let lines = page.lines().map(str::trim).filter(|line| !line.is_empty());
    lines.collect::<Vec<_>>().join("\n")
}

/// Without file hashes of what was stored when.
fn without_ids(value: &Value) -> String {
    serde_json::to_string_pretty(value).unwrap()
}

fn aside(folder: &CampaignFolder) -> Vec<(String, String, String)> {
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    let rows = status["status"]["set_aside"].as_array().unwrap().iter();
    rows.map(|row| (text(&row["run"]), text(&row["standing"]), text(&row["reason"])))
        .collect()
}

fn page_text(folder: &CampaignFolder, page: &str) -> String {
    std::fs::read_to_string(folder.join(&format!("report/{page}"))).unwrap()
}

#[test]
fn results_with_bad_runs_are_those_without_them() {
    let clean = good();
    let _ = clean.run_json();
    let expected = results(&clean);
    let spoilt = good();
    // A dropped run, one in milliamperes, one in milliseconds, one exported again in two ways, and a part of one.
    spoilt.write("runs/air/slipped.csv", Written::of(21, 1.0).text());
    spoilt.write(
        "runs/air/milliamperes.csv",
        Written {
            current: 1e3,
            ..Written::of(22, 2.0)
        }
        .text(),
    );
    spoilt.write(
        "runs/inert/milliseconds.csv",
        Written {
            time: 1e3,
            ..Written::of(23, 2.0)
        }
        .text(),
    );
    spoilt.write(
        "runs/inert/d.tsv",
        Written {
            delimiter: '\t',
            digits: 4,
            ..Written::of(104, 2.0)
        }
        .text(),
    );
    spoilt.write(
        "runs/inert/e.csv",
        Written {
            delimiter: ';',
            ..Written::of(104, 2.0)
        }
        .text(),
    );
    spoilt.write(
        "runs/air/part.csv",
        Written {
            rows: -20..150,
            ..Written::of(3, 2.0)
        }
        .text(),
    );
    let _ = spoilt.run_json();
    let _ = spoilt
        .ieap(&["drop", "runs/air/slipped.csv", "--why", "clip slipped"])
        .expect(0);
    let _ = spoilt.run_json();
    let found = aside(&spoilt);
    let expect = [
        (
            "runs/air/milliamperes.csv",
            "condemned",
            "its current is 1000 times",
        ),
        (
            "runs/air/part.csv",
            "copy",
            "all its readings stand in runs/air/c.csv too",
        ),
        (
            "runs/air/slipped.csv",
            "dropped",
            "clip slipped (dropped by tester",
        ),
        (
            "runs/inert/d.tsv",
            "copy",
            "the same readings as runs/inert/d.csv",
        ),
        (
            "runs/inert/e.csv",
            "copy",
            "the same readings as runs/inert/d.csv",
        ),
        (
            "runs/inert/milliseconds.csv",
            "condemned",
            "milliseconds were read as seconds",
        ),
    ];
    assert_eq!(found.len(), expect.len(), "{found:#?}");
    for ((run, standing, reason), wanted) in found.iter().zip(expect) {
        assert_eq!((run.as_str(), standing.as_str()), (wanted.0, wanted.1));
        assert!(reason.contains(wanted.2), "{reason}");
    }
    for ((name, expected), (_, found)) in expected.iter().zip(&results(&spoilt)) {
        assert!(
            expected == found,
            "{name}:\n{}",
            first_difference(expected, found)
        );
    }
    // What is condemned is shown beside the results, hollow and with the reason.
    let comparison = std::fs::read_to_string(spoilt.join("report/parameters.html")).unwrap();
    assert!(comparison.contains("data-aside=\"1\"") && comparison.contains("its current is 1000 times"));
    assert!(comparison.contains("Beyond the axes, at an arrow: air/milliamperes.csv, set aside ("));
    // They stand in the lists of runs with the reason, and have their pages.
    let index = page_text(&spoilt, "index.html");
    assert!(
        index.contains("Runs set aside") && index.contains("clip slipped (dropped by tester"),
        "{index}"
    );
    assert!(
        index.contains("6 runs are set aside") || index.contains("2 runs are set aside for wrong readings")
    );
    let runs = spoilt
        .ieap(&["table", "runs", "--format", "csv"])
        .expect(0)
        .stdout;
    assert!(runs.contains("set aside: clip slipped"), "{runs}");
    let pages = std::fs::read_dir(spoilt.join("report/runs")).unwrap();
    let page = pages
        .map(|entry| std::fs::read_to_string(entry.unwrap().path()).unwrap())
        .find(|text| text.contains("milliamperes.csv</h1>"))
        .unwrap();
    assert!(
        page.contains("Set aside, in no result: its current is 1000 times"),
        "{page}"
    );
    assert!(!page.contains("the model describes"), "{page}");
    let _ = spoilt
        .ieap(&["export", "--what", "runs", "-o", "runs.csv"])
        .expect(0);
    let export = std::fs::read_to_string(spoilt.join("runs.csv")).unwrap();
    assert!(export.contains(",dropped,") && export.contains(",condemned,") && export.contains(",copy,"));
}

/// Six runs of one condition with a limit, the last one with ten times the current, but not so exactly that it is known without
/// a diagnosis: that condemns it.
fn watched_with_an_odd_run() -> CampaignFolder {
    let folder = CampaignFolder::new();
    let monitoring = "[monitoring]\ncommand = [\"sh\", \"-c\", \"echo $IEAP_ALARM_RUN >> told.txt\"]\n\
                      [[monitoring.limit]]\nparameter = \"rss_ohm_cm2\"\nbelow = 5e3\n";
    folder.write("campaign.toml", format!("{CAMPAIGN_TOML}{monitoring}"));
    for cycle in 1..=6 {
        let written = Written {
            current: if cycle == 6 { 10.4 } else { 1.0 },
            ..Written::of(cycle, 2.0)
        };
        folder.write(&format!("runs/{cycle}.csv.toml"), format!("cycle = {cycle}\n"));
        folder.write(&format!("runs/{cycle}.csv"), written.text());
    }
    folder
}

#[cfg(unix)]
#[test]
fn no_alarm_is_told_of_a_run_that_the_diagnosis_condemns() {
    // Where no diagnosis follows, nothing speaks against the run.
    let folder = watched_with_an_odd_run();
    let _ = folder
        .ieap(&["run", "--no-diagnose", "--allow-command"])
        .expect(0);
    let told = std::fs::read_to_string(folder.join("told.txt")).unwrap();
    assert!(told.contains("runs/6.csv"), "{told}");
    // Condemned later, it is taken back, and that is said.
    let _ = folder.ieap(&["status", "--alarms"]).expect(5);
    let _ = folder.ieap(&["run"]).expect(0);
    let lifted = folder.ieap(&["status", "--alarms"]).expect(0).stdout;
    assert!(
        lifted.contains("is taken back") && lifted.contains("its unit is wrong"),
        "{lifted}"
    );
    // Where one follows, the alarm waits for what it says of the run, and then there is none.
    let folder = watched_with_an_odd_run();
    let run = folder
        .ieap(&["run", "--json", "--allow-command"])
        .expect(0)
        .json();
    assert_eq!(run["run"]["alarms"]["new"], serde_json::json!([]), "{run:#}");
    assert!(!folder.join("told.txt").exists());
    assert_eq!(aside(&folder)[0].0, "runs/6.csv");
    let _ = folder.ieap(&["status", "--alarms"]).expect(0);
}

#[test]
fn a_report_with_a_fault_is_not_made_again_until_something_changes() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", Written::of(1, 2.0).text());
    let _ = folder.ieap(&["run", "--no-diagnose"]).expect(0);
    // As a fault of a page leaves it.
    let report = folder.join("report");
    let stamp = std::fs::read_to_string(report.join(".made-from")).unwrap();
    std::fs::remove_file(report.join(".made-from")).unwrap();
    let fault = serde_json::json!({ "place": "parameters.html", "runs": [], "reason": "a fault" });
    let faulty = serde_json::json!({ "made_from": stamp, "faults": [fault] });
    std::fs::write(report.join(".faults.json"), faulty.to_string()).unwrap();
    let written = std::fs::read_to_string(report.join(".written")).unwrap();
    let hash = blake3::hash(faulty.to_string().as_bytes()).to_hex();
    let lines = written.lines().filter(|line| !line.ends_with(".made-from"));
    let lines: Vec<&str> = lines.collect();
    let written = format!("{}\n{hash}  .faults.json\n", lines.join("\n"));
    std::fs::write(report.join(".written"), written).unwrap();
    // It stands, and the fault is told again.
    let again = folder.ieap(&["report", "--json"]).expect(3).json();
    assert_eq!(again["report"]["rendered"], false, "{again:#}");
    assert_eq!(again["report"]["faults"][0]["reason"], "a fault");
    folder.write("runs/b.csv", Written::of(2, 2.0).text());
    let _ = folder.ieap(&["run", "--no-diagnose"]).expect(0);
    assert!(report.join(".made-from").exists() && !report.join(".faults.json").exists());
}

fn first_difference(one: &str, other: &str) -> String {
    let at = one.bytes().zip(other.bytes()).take_while(|(a, b)| a == b).count();
    let cut = |text: &str| {
        let from = at.saturating_sub(200);
        String::from_utf8_lossy(&text.as_bytes()[from..(at + 200).min(text.len())]).into_owned()
    };
    format!("...{}\n---\n...{}", cut(one), cut(other))
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn a_run_is_dropped_and_comes_back_and_deleted_files_go_at_once() {
    let folder = good();
    let _ = folder.run_json();
    let before = results(&folder);
    let _ = folder.ieap(&["drop", "runs/air/a.csv", "--why", " "]).expect(2);
    let _ = folder
        .ieap(&["drop", "runs/air/none.csv", "--why", "x"])
        .expect(2);
    let said = folder
        .ieap(&[
            "drop",
            "air/a.csv",
            "runs/air/b.csv",
            "--why",
            "wet",
            "--by",
            "Ann",
            "--json",
        ])
        .expect(0)
        .json();
    assert_eq!(said["schema"], "ieap/drop/1");
    assert_eq!(said["drop"]["set_aside"][1]["run"], "runs/air/b.csv");
    assert!(
        said["drop"]["set_aside"][0]["reason"]
            .as_str()
            .unwrap()
            .starts_with("wet (dropped by Ann, ")
    );
    let _ = folder.run_json();
    let fits = folder.ieap(&["fit", "--json"]).expect(0).json();
    assert_eq!(fits["fits"].as_array().unwrap().len(), 6);
    assert_eq!(fits["set_aside"][0]["run"], "runs/air/a.csv");
    let _ = folder
        .ieap(&["drop", "--undo", "runs/air/a.csv", "runs/air/b.csv"])
        .expect(0);
    let again = folder.ieap(&["drop", "--undo", "runs/air/c.csv"]).expect(2);
    assert!(again.stderr.contains("which is not dropped"), "{again:?}");
    let _ = folder.run_json();
    for ((name, before), (_, after)) in before.iter().zip(&results(&folder)) {
        assert!(before == after, "{name}:\n{}", first_difference(before, after));
    }
    let none = folder.ieap(&["drop", "--deleted", "--why", "lost"]).expect(0);
    assert!(none.stdout.contains("nothing was dropped"), "{none:?}");
    std::fs::remove_file(folder.join("runs/inert/a.csv")).unwrap();
    let _ = folder.run_json();
    let status = folder.ieap(&["status"]).expect(0).stdout;
    assert!(status.contains("ieap drop --deleted"), "{status}");
    let _ = folder.ieap(&["drop", "--deleted", "--why", "lost"]).expect(0);
    assert_eq!(aside(&folder).len(), 1);
    assert_eq!(aside(&folder)[0].0, "runs/inert/a.csv");
}

#[test]
fn a_person_s_word_lets_a_condemned_run_speak() {
    let folder = good();
    folder.write(
        "runs/air/odd.csv",
        Written {
            current: 1e-3,
            ..Written::of(31, 2.0)
        }
        .text(),
    );
    let _ = folder.run_json();
    assert_eq!(aside(&folder)[0].1, "condemned");
    let bare = folder.ieap(&["drop", "--undo", "runs/air/odd.csv"]).expect(2);
    assert!(bare.stderr.contains("its current is a 1000th of"), "{bare:?}");
    let said = folder
        .ieap(&["drop", "--undo", "runs/air/odd.csv", "--why", "a dry strip"])
        .expect(0);
    assert!(said.stdout.contains("against the program's"), "{said:?}");
    let _ = folder.run_json();
    assert_eq!(aside(&folder), []);
    let fits = folder.ieap(&["fit", "--json"]).expect(0).json();
    assert_eq!(fits["fits"].as_array().unwrap().len(), 9);
    // Other readings under that name are not what the person looked at.
    folder.write(
        "runs/air/odd.csv",
        Written {
            current: 1e-3,
            ..Written::of(32, 2.0)
        }
        .text(),
    );
    let _ = folder.run_json();
    assert_eq!(aside(&folder)[0].1, "condemned");
}

#[test]
fn one_measurement_under_two_names_joins_their_tags_and_says_where_they_contradict() {
    let folder = CampaignFolder::new();
    folder.write("runs/air/a.csv", Written::of(1, 2.0).text());
    folder.write("runs/inert/a.csv", Written::of(1, 2.0).text());
    folder.write(
        "runs/inert/a.csv.toml",
        "environment = \"inert\"\noperator = \"Ann\"\n",
    );
    folder.write("runs/air/a.csv.toml", "environment = \"air\"\n");
    let _ = folder.run_json();
    let status = folder.ieap(&["status"]).expect(0).stdout;
    let asked = "runs/air/a.csv: the sidecar says environment air, another one inert";
    assert!(status.contains(asked), "{status}");
    assert!(status.contains("also as runs/inert/a.csv"), "{status}");
    assert_eq!(aside(&folder)[0].1, "contradicted");
    let _ = folder
        .ieap(&["export", "--what", "tags", "-o", "tags.csv"])
        .expect(0);
    let tags = std::fs::read_to_string(folder.join("tags.csv")).unwrap();
    assert!(tags.contains("runs/air/a.csv,operator,Ann,sidecar"), "{tags}");
    // Said by hand, it is no contradiction any more; and the second name means the same run.
    let _ = folder
        .ieap(&["tag", "runs/inert/a.csv", "environment=inert"])
        .expect(0);
    let status = folder.ieap(&["status"]).expect(0).stdout;
    assert!(!status.contains(asked), "{status}");
    assert_eq!(aside(&folder), []);
}

#[test]
fn a_reason_of_two_lines_is_no_line_of_its_own() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", Written::of(1, 2.0).text());
    folder.run_json();
    let forged = "0 alarms of monitoring:";
    let why = format!("clip slipped\n{forged}\r\n\u{85}{forged}");
    let told = folder
        .ieap(&["drop", "runs/a.csv", "--why", &why, "--by", "me\nyou"])
        .expect(0);
    let status = folder.ieap(&["status"]).expect(0);
    for said in [told.stdout, status.stdout] {
        assert!(said.contains("clip slipped 0 alarms"), "{said}");
        assert!(said.contains("by me you"), "{said}");
        assert!(
            !said.lines().any(|line| line.trim_start().starts_with(forged)),
            "{said}"
        );
    }
}
