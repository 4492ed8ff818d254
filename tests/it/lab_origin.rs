//! What the readings of a run rest on: saved profiles, clocks of several instruments, marks of instruments.

use serde_json::{Value, json};

use crate::campaign::{CampaignFolder, run_table};

const PROFILE: &str = r#"
[profile]
version = 1
title = "bench"

[layout]
separator = "semicolon"
decimal = "comma"
header_line = 2

[time]
base = "elapsed"
column = "Zeit"
unit = "s"
zero = "step"

[[column]]
column = "U"
quantity = "voltage"
unit = "V"

[[column]]
column = "I"
quantity = "current"
unit = "mA"

[[column]]
column = "K"
quantity = "curvature"
unit = "1/cm"
"#;

/// [`run_table`] in another spelling: a preamble, semicolons, decimal commas, names without units, mA.
fn bench_log(seed: u32) -> String {
    let mut text = "Pruefstand 3\nZeit;U;I;K\n".to_owned();
    for line in run_table(seed).lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let current_ma = cells[2].parse::<f64>().unwrap() * 1e3;
        let row = format!("{};{};{current_ma:.6e};{}\n", cells[0], cells[1], cells[3]);
        text += &row.replace('.', ",");
    }
    text
}

fn fit(folder: &CampaignFolder, run: &str) -> Value {
    let fits = folder.ieap(&["fit", "--json"]).json();
    let entry = fits["fits"]
        .as_array()
        .unwrap()
        .iter()
        .find(|fit| fit["run"] == run);
    entry
        .cloned()
        .unwrap_or_else(|| panic!("{run} has no fit: {fits:#}"))
}

#[test]
fn a_profile_that_is_added_or_changed_reads_its_files_anew() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", bench_log(1));
    folder.write("runs/b.csv", run_table(2));
    let first = folder.run_json();
    assert_eq!(first["ingest"]["refused"][0][0], "runs/a.csv", "{first:#}");
    folder.write("profiles/bench.toml", PROFILE);
    let second = folder.run_json();
    assert_eq!(second["ingest"]["new"], json!(["runs/a.csv"]), "{second:#}");
    assert_eq!(
        second["ingest"]["revised"],
        json!([]),
        "the plain table is looked at, not revised"
    );
    let before = fit(&folder, "runs/a.csv");
    let profile = &before["origin"]["profiles"][0];
    assert_eq!(
        (&profile["id"], &profile["version"]),
        (&json!("bench"), &json!(1))
    );
    assert_eq!(folder.run_json()["ingest"]["revised"], json!([]));
    // Four times the current, which no unit differs by: the resistances must follow.
    folder.write(
        "profiles/bench.toml",
        PROFILE
            .replace("version = 1", "version = 2")
            .replace("unit = \"mA\"", "unit = \"mA\"\nfactor = 4.0"),
    );
    let third = folder.run_json();
    assert_eq!(third["ingest"]["revised"], json!(["runs/a.csv"]), "{third:#}");
    let after = fit(&folder, "runs/a.csv");
    assert_eq!(
        (&after["revision"], &after["origin"]["profiles"][0]["version"]),
        (&json!(2), &json!(2))
    );
    let r1 = |fit: &Value| fit["parameters"]["r1_ohm_cm2"]["value"].as_f64().unwrap();
    assert!(
        (r1(&before) / r1(&after) - 4.0).abs() < 0.04,
        "{} {}",
        r1(&before),
        r1(&after)
    );
    let page = std::fs::read_to_string(folder.join("report/index.html")).unwrap();
    assert!(page.contains("runs/"), "the report stands");
    // A comment changes the text, not what is read; still the run rests on another text.
    assert_eq!(folder.run_json()["ingest"]["revised"], json!([]));
}

#[test]
fn a_wrong_profile_is_told_and_its_files_wait() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", bench_log(1));
    folder.write("profiles/bench.toml", PROFILE.replace("\"semicolon\"", "\";\""));
    let ended = folder.ieap(&["run", "--no-diagnose"]).expect(3);
    for part in ["bench.toml, line 7, [layout] separator", "\"semicolon\""] {
        assert!(ended.stderr.contains(part), "{}", ended.stderr);
    }
}

#[test]
fn a_proposed_profile_shows_what_it_reads_and_is_saved_when_it_is_whole() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", bench_log(1));
    let open = folder
        .ieap(&["profile", "runs/a.csv", "--write", "bench", "--json"])
        .expect(3)
        .json();
    assert_eq!(
        open["open"][0], "[time] unit: the file names no unit of time",
        "{open:#}"
    );
    assert!(folder.join("profiles/bench.toml.draft").is_file() && open["read"].is_null());
    assert_eq!(
        folder.run_json()["ingest"]["refused"][0][0],
        "runs/a.csv",
        "a draft is not read"
    );
    folder.write("runs/b.csv", format!("one more line\n{}", bench_log(2)));
    let second = folder
        .ieap(&["profile", "runs/b.csv", "--write", "other"])
        .expect(2);
    assert!(second.stderr.contains("bench.toml.draft"), "{}", second.stderr);
    folder.write("runs/c.csv", run_table(1));
    let whole = folder
        .ieap(&["profile", "runs/c.csv", "--write", "plain", "--json"])
        .expect(0)
        .json();
    assert_eq!(whole["read"]["runs"][0]["rows"], 320, "{whole:#}");
    assert!(folder.join("profiles/plain.toml").is_file());
    let inspected = folder.ieap(&["inspect", "runs/c.csv", "--json"]).expect(0).json();
    assert_eq!(
        (&inspected["format"], &inspected["profile"]["id"]),
        (&json!("profile"), &json!("plain"))
    );
    assert_eq!(inspected["candidates"][0]["format"], "profile:plain");
    folder
        .ieap(&["profile", "runs/c.csv", "--write", "plain"])
        .expect(2);
}

/// First and last are no range: what lies between may be far from both.
#[test]
fn inspect_tells_the_ends_of_a_column_from_its_range() {
    let folder = CampaignFolder::new();
    folder.write(
        "runs/a.csv",
        "time_s,voltage_v,current_a\n-1,0,0\n0,2,0.5\n1,2,-0.25\n2,2,0.125\n",
    );
    let shown = folder.ieap(&["inspect", "runs/a.csv"]).expect(0).stdout;
    assert!(
        shown.contains("first 0, last 0.125; between -0.25 and 0.5"),
        "{shown}"
    );
    let table = folder.ieap(&["inspect", "runs/a.csv", "--json"]).expect(0).json();
    let columns = table["runs"][0]["columns"].as_array().unwrap();
    let current = columns
        .iter()
        .find(|column| column["quantity"] == "current")
        .unwrap();
    assert_eq!(
        (
            &current["first"],
            &current["last"],
            &current["smallest"],
            &current["largest"]
        ),
        (&json!(0.0), &json!(0.125), &json!(-0.25), &json!(0.5))
    );
}

/// The columns of [`run_table`] in two files, the bending on a clock that shows `late_s` less.
fn two_clocks(folder: &CampaignFolder, late_s: f64) {
    let mut files = [
        "time_s,voltage_v,current_a\n".to_owned(),
        "time_s,curvature_per_cm\n".to_owned(),
    ];
    for line in run_table(3).lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        files[0] += &format!("{},{},{}\n", cells[0], cells[1], cells[2]);
        files[1] += &format!("{},{}\n", cells[0].parse::<f64>().unwrap() - late_s, cells[3]);
    }
    folder.write("runs/a.current.csv", &files[0]);
    folder.write("runs/a.curvature.csv", &files[1]);
}

#[test]
fn the_offset_of_a_second_clock_is_shown_and_used_when_it_is_stated() {
    let folder = CampaignFolder::new();
    two_clocks(&folder, 7.0);
    folder.run_json();
    let before = fit(&folder, "runs/a.csv");
    let clocks = before["origin"]["clocks"].as_array().unwrap();
    assert_eq!((clocks.len(), &clocks[0]["is_reference"]), (2, &json!(true)));
    let offsets = before["origin"]["offsets"].as_array().unwrap();
    let estimated = offsets
        .iter()
        .find(|offset| offset["source"] == "estimated")
        .unwrap();
    let (offset, error) = (
        estimated["offset_s"].as_f64().unwrap(),
        estimated["standard_error_s"].as_f64().unwrap(),
    );
    assert!(
        (offset - 7.0).abs() < 3.0 * error + 0.5 && error < 2.0,
        "{offset} ± {error}"
    );
    assert_eq!(estimated["applied"], false);
    let codes = |fit: &Value| -> Vec<String> {
        let issues = fit["issues"].as_array().unwrap().iter();
        issues
            .map(|issue| issue["code"].as_str().unwrap().to_owned())
            .collect()
    };
    assert!(
        codes(&before).contains(&"clock-offset".to_owned()),
        "{:?}",
        codes(&before)
    );
    // The sidecar of the joined run's own name, and of any of its files, is read.
    folder.write("runs/a.curvature.csv.toml", "clock_offset_s = 7.0\n");
    folder.run_json();
    let after = fit(&folder, "runs/a.csv");
    let stated = &after["origin"]["offsets"].as_array().unwrap()[0];
    assert_eq!(
        (&stated["source"], &stated["applied"], &stated["offset_s"]),
        (&json!("stated"), &json!(true), &json!(7.0))
    );
    assert!(!codes(&after).contains(&"clock-offset".to_owned()));
    let r_squared = |fit: &Value| fit["r_squared_curvature"].as_f64().unwrap();
    assert!(
        r_squared(&after) > r_squared(&before),
        "{} {}",
        r_squared(&before),
        r_squared(&after)
    );
    assert_eq!(after["revision"], 1, "a tag makes no revision");
    folder
        .ieap(&["tag", "runs/a.csv", "clock_offset_s=6.5"])
        .expect(0);
    folder.run_json();
    assert_eq!(
        fit(&folder, "runs/a.csv")["origin"]["offsets"][0]["offset_s"],
        6.5
    );
}

#[test]
fn a_joined_run_that_was_only_touched_makes_no_revision() {
    let folder = CampaignFolder::new();
    two_clocks(&folder, 0.0);
    assert_eq!(folder.run_json()["ingest"]["new"], json!(["runs/a.csv"]));
    two_clocks(&folder, 0.0);
    let again = folder.run_json();
    assert_eq!(
        (&again["ingest"]["revised"], &again["fit"]["fitted"]),
        (&json!([]), &json!(0)),
        "{again:#}"
    );
    two_clocks(&folder, 1.0);
    assert_eq!(folder.run_json()["ingest"]["revised"], json!(["runs/a.csv"]));
}

/// A record of Gamry with an overload of the current and one of the auxiliary input.
fn marked_record() -> String {
    let mut text = "EXPLAIN\r\nTAG\tCHRONOA\r\nTITLE\tLABEL\tx\tt\r\nDATE\tLABEL\t13.5.2026\tDate\r\n\
                    TIME\tLABEL\t10:20:30\tTime\r\nCURVE\tTABLE\r\n\tPt\tT\tVf\tIm\tOver\r\n\
                    \t#\ts\tV vs. Ref.\tA\tbits\r\n"
        .to_owned();
    for row in 0..60 {
        let over = match row {
            3 | 4 => "...i.......",
            9 => "..........a",
            _ => "...........",
        };
        let time_s = 0.5 * f64::from(row);
        let current_a = 1e-3 * (-time_s / 5.0).exp() + 1e-5;
        text += &format!("\t{row}\t{time_s}\t1.5\t{current_a:e}\t{over}\r\n");
    }
    text
}

#[test]
fn marks_of_an_instrument_are_kept_and_shown() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.DTA", marked_record());
    folder.run_json();
    let fit = fit(&folder, "runs/a.DTA");
    let flags = fit["origin"]["flags"].as_array().unwrap();
    assert_eq!(
        (
            flags.len(),
            &flags[0]["flag"],
            &flags[0]["readings"],
            &flags[0]["excludes"],
            &flags[1]["excludes"]
        ),
        (2, &json!("...i......."), &json!(2), &json!(true), &json!(false))
    );
    let stamp = &fit["origin"]["clocks"][0]["stamp"];
    assert_eq!(
        (&stamp["raw"], &stamp["kind"], &stamp["offset"]),
        (&json!("13.5.2026 10:20:30"), &json!("start"), &Value::Null)
    );
    let runs = std::fs::read_dir(folder.join("report/runs")).unwrap();
    let page = runs
        .map(|entry| entry.unwrap().path())
        .find(|path| path.extension().is_some_and(|extension| extension == "html"))
        .map(|path| std::fs::read_to_string(path).unwrap())
        .unwrap();
    for part in [
        "Marked by the instrument",
        "...i.......",
        "13.5.2026 10:20:30 (start)",
        "no zone in the file",
    ] {
        assert!(page.contains(part), "{part}");
    }
}

#[test]
fn tags_leave_readings_out_by_mark_and_by_time_and_give_them_back() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.DTA", marked_record());
    let count = |what: &str| {
        let summary = folder.run_json();
        let fit = fit(&folder, "runs/a.DTA");
        let notes = fit["issues"].as_array().unwrap().iter();
        let notes: Vec<String> = notes
            .filter(|issue| issue["place"] == what)
            .map(|issue| issue["message"].as_str().unwrap().to_owned())
            .collect();
        let samples = fit["n_samples"].as_u64().unwrap();
        (samples, summary["fit"]["fitted"].as_u64().unwrap(), notes)
    };
    // Two of sixty readings are overloads of the current.
    let (before, fitted, notes) = count("leave_out_marked");
    assert_eq!((before, fitted, notes.len()), (58, 1, 0));
    folder.write(
        "runs/a.DTA.toml",
        "leave_out_marked = \"..........a\"\nleave_out = [[10, 12]]\n",
    );
    let (left, fitted, notes) = count("leave_out_marked");
    assert_eq!((left, fitted), (before - 1 - 5, 1), "{notes:?}");
    assert_eq!(
        notes,
        ["left out of fits by the tag `leave_out_marked`: 1 of 60 readings of Im"]
    );
    folder.write(
        "runs/a.DTA.toml",
        "leave_out_marked = \"Range\"\nleave_out = \"noon\"\n",
    );
    let (back, fitted, notes) = count("leave_out_marked");
    assert_eq!((back, fitted), (before, 1));
    assert!(notes[0].contains("its marks are Over=..........a, "), "{notes:?}");
    let (_, fitted, notes) = count("leave_out");
    assert_eq!((fitted, notes.len()), (0, 1), "{notes:?}");
}
