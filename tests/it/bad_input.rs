//! Bad input: each gets a message that says where, what and how to mend it; nothing is lost, the rest goes on.

use serde_json::Value;

use crate::campaign::{CAMPAIGN_TOML, CampaignFolder, command, counted, run_table};

/// The table with every data row changed by `change`.
fn with_rows(seed: u32, change: impl Fn(usize, &str) -> String) -> String {
    let table = run_table(seed);
    let mut lines = table.lines();
    let header = lines.next().unwrap().to_owned() + "\n";
    header
        + &lines
            .enumerate()
            .map(|(number, line)| change(number, line) + "\n")
            .collect::<String>()
}

fn issue_codes(document: &Value, run: &str) -> Vec<String> {
    let fits = document["fits"].as_array().unwrap();
    let fit = fits
        .iter()
        .find(|fit| fit["run"] == run)
        .unwrap_or_else(|| panic!("{run} was not fitted: {document:#}"));
    fit["issues"]
        .as_array()
        .unwrap()
        .iter()
        .map(|issue| issue["code"].as_str().unwrap().to_owned())
        .collect()
}

#[test]
fn refused_files_name_place_reason_and_mend_and_the_rest_goes_on() {
    let folder = CampaignFolder::new();
    folder.write("runs/good.csv", run_table(1));
    let cases: [(&str, Vec<u8>, &str); 7] = [
        ("text.csv", b"just some words\n".to_vec(), "no known format fits"),
        (
            "notime.csv",
            b"voltage_v,current_a\n2.0,1e-3\n2.0,1e-3\n".to_vec(),
            "time",
        ),
        (
            "nounit.csv",
            b"time,voltage,current\n0,2,1e-3\n1,2,1e-3\n".to_vec(),
            "unit",
        ),
        (
            "unknown.csv",
            b"time_s,current (furlong)\n0,1e-3\n1,1e-3\n".to_vec(),
            "furlong",
        ),
        (
            "back.csv",
            [run_table(1), run_table(1)[44..].to_owned()]
                .concat()
                .into_bytes(),
            "time",
        ),
        (
            "noise.bin",
            (0..2000u32).map(|n| (n * n % 251) as u8).collect(),
            "no known format fits",
        ),
        ("broken.xlsx", b"PK\x03\x04 and nothing more".to_vec(), ""),
    ];
    for (name, bytes, _) in &cases {
        folder.write(&format!("runs/{name}"), bytes);
    }
    let ended = folder.ieap(&["run", "--no-diagnose"]).expect(3);
    for (name, _, reason) in &cases {
        assert!(
            ended.stderr.contains(&format!("runs/{name}")),
            "{name} is not listed: {}",
            ended.stderr
        );
        assert!(
            ended.stderr.contains(reason),
            "{name}: {reason} is not said: {}",
            ended.stderr
        );
    }
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    let refused = status["status"]["refused"].as_array().unwrap().clone();
    assert_eq!(refused.len(), cases.len());
    for file in &refused {
        let issue = &file["issues"][0];
        assert!(!issue["message"].as_str().unwrap().is_empty(), "{file}");
        assert!(!issue["mend"].as_str().unwrap().is_empty(), "{file}");
    }
    assert_eq!(status["status"]["runs_by_state"]["fitted"], 1);
    let page = folder.report("index.html");
    assert!(cases.iter().all(|(name, _, _)| page.contains(name)));
}

#[test]
fn empty_and_header_only_files_wait_and_are_taken_when_they_grow() {
    let folder = CampaignFolder::new();
    folder.write("runs/empty.csv", "");
    folder.write("runs/header.csv", "time_s,voltage_v,current_a\n");
    let first = folder.run_json();
    assert_eq!(first["ingest"]["waiting"].as_array().unwrap().len(), 2);
    assert_eq!(first["ingest"]["refused"], serde_json::json!([]));
    folder.write("runs/empty.csv", run_table(1));
    folder.write("runs/header.csv", run_table(2));
    assert_eq!(folder.run_json()["fit"]["fitted"], 2);
}

#[test]
fn a_cut_last_line_is_never_read_as_a_number() {
    let folder = CampaignFolder::new();
    let table = run_table(2);
    folder.write("runs/whole.csv", run_table(1));
    folder.write("runs/cut.csv", &table[..table.len() - 3]);
    let document = folder.ieap(&["fit", "--json"]).expect(0).json();
    let samples = |run: &str| {
        let fits = document["fits"].as_array().unwrap();
        fits.iter().find(|fit| fit["run"] == run).unwrap()["n_samples"]
            .as_u64()
            .unwrap()
    };
    // One reading of current and one of curvature stand in the last line.
    assert_eq!(samples("runs/cut.csv"), samples("runs/whole.csv") - 2);
    assert!(issue_codes(&document, "runs/cut.csv").contains(&"file-cut".to_owned()));
}

#[test]
fn spellings_of_the_same_table_give_the_same_fit() {
    let folder = CampaignFolder::new();
    let table = run_table(1);
    let comma = table.replace(',', ";").replace('.', ",");
    let utf16: Vec<u8> = std::iter::once(0xFEFFu16)
        .chain(table.encode_utf16())
        .flat_map(u16::to_le_bytes)
        .collect();
    let header = "Zeit (s);U/V;Strom (\u{b5}A)";
    let _ = header;
    folder.write("runs/a.csv", &table);
    folder.write("runs/comma.csv", comma);
    folder.write("runs/utf16.csv", utf16);
    let document = folder.ieap(&["fit", "--json"]).expect(0).json();
    let _ = folder
        .ieap(&["export", "--what", "runs", "-o", "runs.json"])
        .expect(0);
    let runs: Value = serde_json::from_slice(&std::fs::read(folder.join("runs.json")).unwrap()).unwrap();
    let hashes: Vec<&Value> = runs
        .as_array()
        .unwrap()
        .iter()
        .map(|run| &run["data_hash"])
        .collect();
    assert_eq!(hashes.len(), 3);
    assert!(hashes.iter().all(|hash| *hash == hashes[0]), "{hashes:?}");
    // They are one measurement, and count once.
    assert_eq!(document["fits"].as_array().unwrap().len(), 1);
    assert_eq!(document["set_aside"].as_array().unwrap().len(), 2);
}

#[test]
fn odd_cells_are_left_out_and_counted() {
    let folder = CampaignFolder::new();
    let replace = |seed: u32, wanted: usize, cell: &'static str| {
        with_rows(seed, move |number, line| {
            let mut cells: Vec<&str> = line.split(',').collect();
            if number == wanted {
                cells[2] = cell;
            }
            cells.join(",")
        })
    };
    folder.write("runs/nan.csv", replace(1, 100, "NaN"));
    folder.write("runs/inf.csv", replace(2, 100, "-inf"));
    folder.write("runs/text.csv", replace(3, 100, "overload"));
    // Beside the others a current a thousand times too large would be set aside; alone it is only improbable.
    let alone = CampaignFolder::new();
    alone.write(
        "runs/amperes.csv",
        with_rows(4, |_, line| {
            let cells: Vec<&str> = line.split(',').collect();
            format!(
                "{},{},{:e},{}",
                cells[0],
                cells[1],
                cells[2].parse::<f64>().unwrap() * 1000.0,
                cells[3]
            )
        }),
    );
    let document = folder.ieap(&["fit", "--json"]).expect(0).json();
    assert!(issue_codes(&document, "runs/nan.csv").contains(&"not-finite".to_owned()));
    assert!(issue_codes(&document, "runs/inf.csv").contains(&"not-finite".to_owned()));
    assert!(issue_codes(&document, "runs/text.csv").contains(&"text-in-number-column".to_owned()));
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    let left_out = status["status"]["readings_left_out"].as_array().unwrap();
    let said = ["inf", "nan", "text"].map(|name| format!("runs/{name}.csv"));
    assert!(left_out.iter().map(|run| &run["path"]).eq(&said), "{left_out:#?}");
    let text = folder.ieap(&["status"]).expect(0).stdout;
    assert!(
        text.contains("1 of 320 cells of column \"current_a\" hold no finite number"),
        "{text}"
    );
    let document = alone.ieap(&["fit", "--json"]).expect(0).json();
    assert!(issue_codes(&document, "runs/amperes.csv").contains(&"suspicious-range".to_owned()));
}

#[test]
fn sidecars_that_contradict_or_are_no_toml_are_pointed_out() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.write("runs/a.csv.toml", "voltage_v = 1.0\n");
    folder.write("runs/b.csv", run_table(2));
    folder.write("runs/b.csv.toml", "this = is = no toml");
    folder.write("runs/c.csv", run_table(3));
    folder.write("runs/c.csv.toml", "sample = \"S9\"\n");
    let document = folder.ieap(&["fit", "--json"]).expect(3).json();
    let aside = &document["set_aside"][0];
    assert_eq!(
        (&aside["run"], &aside["standing"]),
        (&"runs/a.csv".into(), &"contradicted".into())
    );
    let reason = aside["reason"].as_str().unwrap();
    assert!(
        reason.contains("the sidecar says voltage 1\u{a0}V, the voltage channel 2\u{a0}V"),
        "{reason}"
    );
    for (at, run, why) in [(0, "runs/b.csv", "tag-file-not-toml"), (1, "runs/c.csv", "S9")] {
        let not_fitted = &document["not_fitted"][at];
        assert_eq!(
            (&not_fitted["run"], &not_fitted["state"]),
            (&run.into(), &"untagged".into())
        );
        assert!(not_fitted.to_string().contains(why), "{not_fitted:#}");
    }
}

#[test]
fn runs_that_no_tag_tells_apart_are_named() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.write("runs/b.csv", run_table(2));
    let document = folder.ieap(&["fit", "--json"]).expect(0).json();
    assert!(issue_codes(&document, "runs/a.csv").contains(&"same-tags".to_owned()));
    folder.write("runs/b.csv.toml", "cycle = 2\n");
    let document = folder.ieap(&["fit", "--json"]).expect(0).json();
    assert!(!issue_codes(&document, "runs/a.csv").contains(&"same-tags".to_owned()));
}

#[test]
fn names_tags_and_headers_are_shown_as_text_everywhere() {
    let folder = CampaignFolder::new();
    folder.write("runs/<script>alert(1)<_script>.csv", run_table(1));
    folder.write("runs/quote\"and'.csv", run_table(2));
    folder.write("runs/esc\u{1b}[31mred.csv", run_table(3));
    folder.write("runs/tagged.csv", run_table(4));
    folder.write(
        "runs/tagged.csv.toml",
        "operator = \"<img src=x onerror=alert(1)>\"\nnote = \"\\u001b[31mred\"\n",
    );
    folder.write("runs/bad<b>.csv", "no table\n\u{1b}[2J");
    let ended = folder.ieap(&["run", "--verbose", "--no-diagnose"]).expect(3);
    assert!(
        !ended.stdout.contains('\u{1b}') && !ended.stderr.contains('\u{1b}'),
        "{ended:?}"
    );
    let mut pages = vec![
        folder.join("report/index.html"),
        folder.join("report/parameters.html"),
    ];
    pages.extend(
        std::fs::read_dir(folder.join("report/runs"))
            .unwrap()
            .map(|entry| entry.unwrap().path()),
    );
    // All four runs are of one group, and so on one page.
    assert_eq!(pages.len(), 2 + 1);
    for page in pages {
        let html = std::fs::read_to_string(&page).unwrap();
        for forbidden in ["<script>alert", "<img src=x", "bad<b>", "\u{1b}"] {
            assert!(!html.contains(forbidden), "{}: {forbidden}", page.display());
        }
    }
}

#[cfg(unix)]
#[test]
fn names_that_are_no_utf8_and_links_out_of_the_campaign() {
    use std::os::unix::ffi::OsStrExt;
    let folder = CampaignFolder::new();
    let odd = folder
        .join("runs")
        .join(std::ffi::OsStr::from_bytes(b"odd\xff.csv"));
    std::fs::write(odd, run_table(1)).unwrap();
    let outside = tempfile::tempdir().unwrap();
    std::fs::write(outside.path().join("secret.csv"), run_table(2)).unwrap();
    std::os::unix::fs::symlink(outside.path().join("secret.csv"), folder.join("runs/link.csv")).unwrap();
    std::os::unix::fs::symlink(outside.path(), folder.join("runs/linked")).unwrap();
    let ended = folder.ieap(&["run", "--no-diagnose"]).expect(3);
    assert!(
        ended.stderr.contains("runs/link.csv") && ended.stderr.contains("runs/linked"),
        "{ended:?}"
    );
    let document = folder.ieap(&["fit", "--json"]).expect(3).json();
    assert_eq!(document["fits"].as_array().unwrap().len(), 1);
}

#[test]
fn thousands_of_irrelevant_files_do_not_drown_the_run() {
    let irrelevant = counted(1_000, 10_000);
    let folder = CampaignFolder::new();
    folder.write("runs/good.csv", run_table(1));
    for n in 0..irrelevant {
        folder.write(&format!("runs/junk/{n}.log"), format!("entry {n}\n"));
    }
    let ended = folder.ieap(&["run", "--no-diagnose"]).expect(3);
    assert!(
        ended.stdout.contains("1 new") && ended.stderr.lines().count() < 60,
        "{}",
        ended.stderr
    );
    assert!(
        ended.stderr.contains(&format!("{} more", irrelevant - 10)),
        "{}",
        ended.stderr
    );
    let page = std::fs::metadata(folder.join("report/index.html")).unwrap().len();
    assert!(page < 1 << 20, "the index has {page} bytes");
}

#[test]
fn a_campaign_file_that_is_wrong_is_refused_with_its_place() {
    let folder = CampaignFolder::new();
    folder.write("campaign.toml", "[campaign\nid = 3");
    assert!(
        folder
            .ieap(&["run", "--no-diagnose"])
            .expect(2)
            .stderr
            .contains("line")
    );
    folder.write(
        "campaign.toml",
        CAMPAIGN_TOML.replace("Europe/Tallinn", "Europe/Nowhere"),
    );
    assert!(
        folder
            .ieap(&["run", "--no-diagnose"])
            .expect(2)
            .stderr
            .contains("Europe/Nowhere")
    );
    folder.write(
        "campaign.toml",
        CAMPAIGN_TOML.replace("[campaign]", "[campaign]\nmodel = \"lumped-9\""),
    );
    assert!(
        folder
            .ieap(&["run", "--no-diagnose"])
            .expect(2)
            .stderr
            .contains("lumped-9")
    );
    std::fs::remove_file(folder.join("campaign.toml")).unwrap();
    assert!(
        folder
            .ieap(&["run", "."])
            .expect(2)
            .stderr
            .contains("campaign.toml")
    );
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn a_database_that_is_none_newer_or_locked_is_refused_with_status_4() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.write(
        "campaign.db",
        "this is no database, whatever its name says; it is long enough to look at",
    );
    let none = folder.ieap(&["run", "--no-diagnose"]).expect(4);
    assert!(none.stderr.contains("not a readable SQLite database"), "{none:?}");
    std::fs::remove_file(folder.join("campaign.db")).unwrap();
    folder.ieap(&["run", "--no-diagnose"]).expect(0);

    let database = rusqlite::Connection::open(folder.join("campaign.db")).unwrap();
    database.execute_batch("BEGIN EXCLUSIVE").unwrap();
    folder.write("runs/b.csv", run_table(2));
    let locked = folder.ieap(&["run", "--no-diagnose"]).expect(4);
    assert!(locked.stderr.contains("locked"), "{locked:?}");
    database.execute_batch("ROLLBACK").unwrap();

    database.pragma_update(None, "user_version", 999).unwrap();
    drop(database);
    let newer = folder.ieap(&["run", "--no-diagnose"]).expect(4);
    assert!(newer.stderr.contains("999"), "{newer:?}");
    folder.ieap(&["status"]).expect(4);
}

#[cfg(unix)]
#[test]
fn a_second_instance_is_refused_while_the_first_works() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    let mut watch = command(folder.path(), &["watch", "--quiet-s", "0.1"])
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    crate::watch::until("the watch has fitted", || crate::watch::fitted(&folder) == 1);
    let second = folder.ieap(&["run", "--no-diagnose"]).expect(4);
    assert!(
        second.stderr.contains("another ieap") && second.stderr.contains("process"),
        "{second:?}"
    );
    // Reading and tagging go on beside it.
    folder.ieap(&["status"]).expect(0);
    folder.ieap(&["tag", "runs/a.csv", "note=seen"]).expect(0);
    watch.kill().unwrap();
    watch.wait().unwrap();
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
}

#[test]
fn wrong_usage_is_told_with_status_2() {
    let folder = CampaignFolder::new();
    folder.ieap(&["fly"]).expect(2);
    folder.ieap(&["run", "--threads", "0"]).expect(2);
    folder.ieap(&["watch", "--quiet-s", "-1"]).expect(2);
    folder.ieap(&["tag", "runs/a.csv", "nothing"]).expect(2);
    folder.ieap(&["run", "nowhere"]).expect(2);
    folder.ieap(&["--help"]).expect(0);
}

#[test]
fn every_verb_that_works_on_a_campaign_says_what_in_its_file_is_not_understood() {
    let folder = CampaignFolder::new();
    folder.write(
        "campaign.toml",
        "[campaign]\nid = \"c\"\ntitle = \"c\"\ntime_zone = \"UTC\"\n",
    );
    // In what status answers it stands with the rest.
    for (verb, status) in [
        ("ingest", 0),
        ("run", 0),
        ("fit", 0),
        ("dma", 0),
        ("diagnose", 0),
        ("report", 0),
        ("status", 3),
    ] {
        let told = folder.ieap(&[verb]).expect(status);
        let said = if verb == "status" {
            told.stdout
        } else {
            told.stderr
        };
        assert!(
            said.contains("time_zone") && said.contains("timezone"),
            "{verb}: {said}"
        );
    }
}
