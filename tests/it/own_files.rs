//! Files as people have them: tags with slips, sweeps, dates that fit two orders, columns under other names.

use crate::campaign::{CAMPAIGN_TOML, CampaignFolder, run_table};

/// A triangle of the voltage between -1 V and 1 V, as in a cyclic voltammogram, too fast for its readings to carry it.
fn sweep() -> String {
    let mut text = String::from("time_s,voltage_v,current_a\n");
    for k in 0..800 {
        let phase = f64::from(k % 16) / 4.0;
        let volts = match phase {
            p if p < 1.0 => p,
            p if p < 3.0 => 2.0 - p,
            p => p - 4.0,
        };
        text += &format!("{},{volts:.4},{:.6e}\n", f64::from(k) * 0.1, 1e-3 * volts);
    }
    text
}

#[test]
fn a_value_that_no_run_can_have_is_refused_by_tag_and_nothing_is_set() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.ieap(&["ingest"]).expect(0);
    for (pair, told) in [
        ("environment=ari", "\"air\""),
        ("sample=S2", "[[sample]]"),
        ("voltage_v=abc", "not a number"),
        ("voltage_v=1,2", "decimal point"),
        ("relative_humidity_percent=330", "0 to 100"),
        ("started_at=31.12.26", "not a date"),
    ] {
        let refused = folder.ieap(&["tag", "runs/a.csv", "note=x", pair]).expect(2);
        let said = &refused.stderr;
        assert!(said.contains(told) && said.contains("nothing was set"), "{said}");
    }
    let tagged = folder.ieap(&["tag", "runs/a.csv", "cycle=1"]).expect(0);
    assert!(!tagged.stdout.contains("note"), "{}", tagged.stdout);
}

#[test]
fn several_runs_are_tagged_at_once_and_only_new_warnings_are_told() {
    let folder = CampaignFolder::new();
    for (name, seed) in [("a_rh30", 1), ("b_rh30", 2), ("c_rh60", 3)] {
        folder.write(&format!("runs/{name}.csv"), run_table(seed));
    }
    folder.ieap(&["ingest"]).expect(0);
    let tagged = folder
        .ieap(&["tag", "*_rh30.csv", "relative_humidity_percent=30", "--json"])
        .expect(0)
        .json();
    assert_eq!(tagged["tag"]["run"], "runs/a_rh30.csv");
    assert_eq!(tagged["others"][0]["run"], "runs/b_rh30.csv");
    assert_eq!(tagged["others"].as_array().unwrap().len(), 1);
    let first = folder
        .ieap(&["tag", "runs/a_rh30.csv", "runs/c_rh60.csv", "voltage_v=1"])
        .expect(0);
    assert!(first.stderr.contains("runs/c_rh60.csv"), "{}", first.stderr);
    let second = folder.ieap(&["tag", "runs/c_rh60.csv", "note=dry"]).expect(0);
    assert!(!second.stderr.contains("runs/c_rh60.csv"), "{}", second.stderr);
    let none = folder.ieap(&["tag", "*_rh99.csv", "note=x"]).expect(2);
    assert!(none.stderr.contains("no run is called"), "{}", none.stderr);
}

#[test]
fn a_key_that_is_neither_known_nor_declared_is_refused_by_tag_and_said_by_status() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.write("runs/b.csv", run_table(2));
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    for (pair, meant) in [
        ("relative_humdity_percent=40", "relative_humidity_percent"),
        ("exclude=true", "leave_out"),
        ("specimen=3", "[tags] extra = [\"specimen\"]"),
    ] {
        let refused = folder.ieap(&["tag", "runs/a.csv", pair]).expect(2);
        assert!(
            refused.stderr.contains(meant) && refused.stderr.contains("nothing was set"),
            "{}",
            refused.stderr
        );
    }
    folder.write(
        "runs/tags.toml",
        "sample = \"S1\"\nenvironment = \"air\"\nhumidity = 40\nspecimen = 3\n",
    );
    let run = folder.ieap(&["run", "--no-diagnose"]).expect(0);
    assert!(
        run.stderr.contains("2 runs, as runs/a.csv: `humidity`"),
        "{}",
        run.stderr
    );
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    let told = status["status"]["undeclared_tags"].as_array().unwrap();
    assert_eq!(told.len(), 2, "{told:#?}");
    assert_eq!(told[0]["paths"].as_array().unwrap().len(), 2);
    // Nothing is lost: the tags stand with the run, and declared they are known.
    let campaign = format!("{CAMPAIGN_TOML}\n[tags]\nextra = [\"specimen\"]\n");
    folder.write("campaign.toml", campaign);
    folder.ieap(&["tag", "runs/a.csv", "specimen=4"]).expect(0);
    // A tag looks again at the runs that it speaks of; the next run at all of them.
    let undeclared = |folder: &CampaignFolder| {
        let status = folder.ieap(&["status", "--json"]).expect(0).json();
        let told = status["status"]["undeclared_tags"].as_array().unwrap().iter();
        let of_specimen = told.filter(|told| told.to_string().contains("specimen"));
        of_specimen.map(|told| told["paths"].clone()).collect::<Vec<_>>()
    };
    assert_eq!(undeclared(&folder), [serde_json::json!(["runs/b.csv"])]);
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    assert_eq!(undeclared(&folder), [] as [serde_json::Value; 0]);
    let status = folder.ieap(&["status"]).expect(0);
    assert!(
        status.stdout.contains("write `relative_humidity_percent`"),
        "{}",
        status.stdout
    );
    assert!(!status.stdout.contains("specimen"), "{}", status.stdout);
}

#[test]
fn a_sweep_waits_for_nothing_and_is_counted_as_what_it_is() {
    let folder = CampaignFolder::new();
    std::fs::remove_file(folder.join("runs/tags.toml")).unwrap();
    folder.write("runs/a.csv", sweep());
    let run = folder.ieap(&["run", "--no-diagnose", "--json"]).expect(0).json();
    let ingest = &run["run"]["ingest"];
    assert_eq!(ingest["no_steps"], serde_json::json!(["runs/a.csv"]));
    assert_eq!(ingest["untagged"], serde_json::json!([]));
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    assert_eq!(
        status["status"]["runs_by_state"],
        serde_json::json!({ "no_steps": 1 })
    );
    assert_eq!(status["status"]["not_fitted"], serde_json::json!([]));
    let text = folder.ieap(&["status"]).expect(0).stdout;
    assert!(text.contains("whose voltage does not go in steps"), "{text}");
    assert!(
        !text.contains("voltage_v` is missing") && !text.contains("lacks"),
        "{text}"
    );
    let fits = folder.ieap(&["fit", "--json"]).expect(0).json();
    assert_eq!(fits["not_fitted"][0]["state"], "no_steps");
}

/// What is said of every run: code and sentence, by path.
fn told(folder: &CampaignFolder) -> Vec<(String, Vec<String>)> {
    let fits = folder.ieap(&["fit", "--json"]).expect(0).json();
    let runs = fits["not_fitted"].as_array().unwrap().iter();
    let of_run = |run: &serde_json::Value| {
        let issues = run["issues"].as_array().unwrap().iter();
        let said = |issue: &serde_json::Value| issue["message"].as_str().unwrap().to_owned();
        (
            run["run"].as_str().unwrap().to_owned(),
            issues.map(said).collect(),
        )
    };
    runs.map(of_run).collect()
}

#[test]
fn a_record_of_a_constant_current_is_told_by_one_sentence() {
    let folder = CampaignFolder::new();
    // A voltage that climbs far, and one that drifts by a few millivolts.
    for (name, volts, amperes) in [("climbs", 0.8, 1e-3), ("drifts", 0.008, 1.0004e-3)] {
        let row = |k: i32| {
            let share = f64::from(k) / 200.0;
            let current = amperes + 1e-7 * f64::from(k % 3);
            format!("{k},{:.5},{current:.7}\n", 0.3 + volts * share)
        };
        let rows: String = (0..200).map(row).collect();
        folder.write(
            &format!("runs/{name}.csv"),
            format!("time_s,voltage_v,current_a\n{rows}"),
        );
    }
    // The same by an instrument that states the technique.
    let rows: String = (0..200)
        .map(|k| format!("{k}\t{:.5}\t1.00000\r\n", 0.3 + 0.00004 * f64::from(k)))
        .collect();
    let head = "EC-Lab ASCII FILE\r\nNb header lines : 4\r\nChronopotentiometry\r\n";
    folder.write(
        "runs/stated.mpt",
        format!("{head}time/s\tEwe/V\t<I>/mA\r\n{rows}"),
    );
    let _ = folder.ieap(&["ingest"]);
    let told = told(&folder);
    assert_eq!(told.len(), 3, "{told:#?}");
    for (run, said) in &told {
        let about = |text: &&String| text.contains("voltage");
        assert_eq!(said.iter().filter(about).count(), 1, "{run}: {said:#?}");
        let wanted = if run.ends_with("mpt") {
            "this technique is no response to voltage steps"
        } else {
            "the current is held at 1.00"
        };
        assert!(said.iter().any(|text| text.contains(wanted)), "{run}: {said:#?}");
        let wrong = |text: &String| text.contains("changes") || text.contains("missing");
        assert!(!said.iter().any(wrong), "{run}: {said:#?}");
    }
}

#[test]
fn a_logger_with_dots_speaks_and_one_with_slashes_follows_the_folder_or_campaign_toml() {
    let log = |date: &str| {
        let rows: String = (0..12)
            .map(|k| format!("{date} 10:{:02};21,{k};40,5\n", 5 * k))
            .collect();
        format!("Datum;Temperatur (\u{b0}C);Luftfeuchte (%)\n{rows}")
    };
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.write("ambient/dots.csv", log("02.03.2026"));
    folder.ieap(&["ingest"]).expect(0);
    folder.write("ambient/slashes.csv", log("02/03/2026"));
    let refused = folder.ieap(&["ingest"]).expect(3);
    for mend in ["date_order", "ieap profile", "beside a file whose dates show"] {
        assert!(refused.stderr.contains(mend), "{}", refused.stderr);
    }
    // A file that comes later shows the order.
    folder.write("ambient/later.csv", log("14/03/2026"));
    folder.ieap(&["ingest"]).expect(0);
    std::fs::remove_file(folder.join("ambient/later.csv")).unwrap();
    folder.write("ambient/other.csv", log("04/05/2026"));
    folder.ieap(&["ingest"]).expect(3);
    let stated = CAMPAIGN_TOML.replace("timezone", "date_order = \"month-first\"\ntimezone");
    folder.write("campaign.toml", stated);
    folder.ieap(&["ingest"]).expect(0);
}

/// A record of Gamry that began on that day.
fn gamry(day: &str, level: f64) -> String {
    let mut text = format!(
        "EXPLAIN\r\nTAG\tCHRONOA\r\nTITLE\tLABEL\tx\tt\r\nDATE\tLABEL\t{day}\tDate\r\n\
         TIME\tLABEL\t10:20:30\tTime\r\nCURVE\tTABLE\r\n\tPt\tT\tVf\tIm\r\n\t#\ts\tV vs. Ref.\tA\r\n"
    );
    for row in 0..60 {
        let time_s = 0.5 * f64::from(row);
        let current_a = level * (-time_s / 5.0).exp() + 1e-5;
        text += &format!("\t{row}\t{time_s}\t1.5\t{current_a:e}\r\n");
    }
    text
}

#[test]
fn the_start_of_a_run_follows_the_folder_or_campaign_toml_where_its_date_fits_two_orders() {
    let folder = CampaignFolder::new();
    let start = |folder: &CampaignFolder| {
        folder.ieap(&["ingest"]).expect(0);
        let note = folder
            .ieap(&["tag", "runs/a.DTA", "note=seen", "--json"])
            .expect(0)
            .json();
        let tags = note["tag"]["tags"].as_array().unwrap();
        let of_start = tags.iter().find(|tag| tag[0] == "started_at");
        let issues = note["tag"]["issues"].to_string();
        (
            of_start.map(|tag| tag[1].as_str().unwrap()[..10].to_owned()),
            issues,
        )
    };
    folder.write("runs/a.DTA", gamry("3/10/2019", 1e-3));
    let (found, issues) = start(&folder);
    assert!(
        found.is_none() && issues.contains("date_order"),
        "{found:?} {issues}"
    );
    // A record that comes later shows the order; without it campaign.toml states it.
    folder.write("runs/b.DTA", gamry("3/14/2019", 2e-3));
    let (found, issues) = start(&folder);
    assert_eq!(found.as_deref(), Some("2019-03-10"));
    assert!(!issues.contains("date-uncertain"), "{issues}");
    let stated = CAMPAIGN_TOML.replace("timezone", "date_order = \"day-first\"\ntimezone");
    folder.write("campaign.toml", stated);
    assert_eq!(start(&folder).0.as_deref(), Some("2019-10-03"));
}

#[test]
fn columns_under_other_names_are_read_proposed_or_told_as_missing() {
    let folder = CampaignFolder::new();
    // German names with units, a slip, a current over the area of 0.1 cm2.
    let german = run_table(1)
        .replacen("curvature_per_cm", "Kr\u{fc}mmung [1/cm]", 1)
        .replacen("current_a", "Strom [A]", 1);
    folder.write("runs/a.csv", german);
    folder.write(
        "runs/slip.csv",
        run_table(2).replacen("curvature_per_cm", "curvture_per_cm", 1),
    );
    let density: String = run_table(3)
        .lines()
        .enumerate()
        .map(|(index, line)| {
            let cells: Vec<&str> = line.split(',').collect();
            match index {
                0 => "time_s,voltage_v,current density (mA/cm2),curvature_per_cm\n".to_owned(),
                _ => {
                    let density = cells[2].parse::<f64>().unwrap() * 1e3 / 0.1;
                    format!("{},{},{density:.6e},{}\n", cells[0], cells[1], cells[3])
                }
            }
        })
        .collect();
    folder.write("runs/density.csv", density);
    folder.write("runs/density_reference.csv", run_table(3));
    folder.write(
        "runs/unread.csv",
        run_table(4).replacen("curvature_per_cm", "probe 7 (1/cm)", 1),
    );
    let fits = folder.ieap(&["fit", "--json"]).expect(0).json();
    let of = |run: &str| {
        let fits = fits["fits"].as_array().unwrap();
        let found = fits
            .iter()
            .find(|fit| fit["run"] == run)
            .unwrap_or_else(|| panic!("{run}: {fits:#?}"));
        found.clone()
    };
    assert!(of("runs/a.csv")["r_squared_curvature"].is_number());
    assert!(of("runs/slip.csv")["r_squared_curvature"].is_number());
    let resistance = |run: &str| of(run)["parameters"]["r1_ohm_cm2"]["value"].as_f64().unwrap();
    let (of_density, of_current) = (
        resistance("runs/density.csv"),
        resistance("runs/density_reference.csv"),
    );
    assert!(
        (of_density / of_current - 1.0).abs() < 1e-3,
        "{of_density} {of_current}"
    );
    assert!(of("runs/unread.csv")["r_squared_curvature"].is_null());
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    let lacking = &status["status"]["fitted_without_response"];
    assert_eq!(lacking.as_array().unwrap().len(), 1, "{lacking:#}");
    assert_eq!(lacking[0]["path"], "runs/unread.csv");
    let text = folder.ieap(&["status"]).expect(0).stdout;
    assert!(
        text.contains("without its curvature: column \"probe 7 (1/cm)\""),
        "{text}"
    );
    let slip = folder.ieap(&["inspect", "runs/slip.csv"]).expect(0).stdout;
    assert!(slip.contains("is read as curvature in 1/cm"), "{slip}");
}

#[test]
fn the_same_mend_of_many_runs_is_told_once_with_the_pattern_that_gives_it() {
    let folder = CampaignFolder::new();
    std::fs::remove_file(folder.join("runs/tags.toml")).unwrap();
    for k in 1..=4 {
        folder.write(&format!("runs/S1_air_2.0V_{k}.csv"), run_table(k));
    }
    let run = folder.ieap(&["run", "--no-diagnose"]).expect(0).stderr;
    assert!(
        run.contains("4 runs, as runs/S1_air_2.0V_1.csv: `sample` is missing"),
        "{run}"
    );
    let pattern = "{sample}_{environment}_{voltage_v}V_{cycle}";
    assert!(run.contains(pattern), "{run}");
    assert_eq!(run.matches("`sample` is missing").count(), 1, "{run}");
    let status = folder.ieap(&["status"]).expect(0);
    assert_eq!(
        status.stdout.matches("`sample` is missing").count(),
        1,
        "{}",
        status.stdout
    );
    folder.write(
        "campaign.toml",
        format!("{CAMPAIGN_TOML}\n[runs]\nname_pattern = \"{pattern}\"\n"),
    );
    let fits = folder.ieap(&["fit", "--json"]).expect(0).json();
    assert_eq!(fits["fits"].as_array().unwrap().len(), 4);
}

#[test]
fn a_slip_in_campaign_toml_is_in_status_its_document_and_its_exit_status() {
    let folder = CampaignFolder::new();
    folder.ieap(&["status"]).expect(0);
    folder.write("campaign.toml", CAMPAIGN_TOML.replace("timezone", "timezome"));
    let told = folder.ieap(&["status"]).expect(3);
    assert!(
        told.stdout.contains("`timezome`") && told.stdout.contains("write `timezone`"),
        "{told:#?}"
    );
    let document = folder.ieap(&["status", "--json"]).expect(3).json();
    assert_eq!(document["status"]["campaign_file"][0]["code"], "unknown-key");
    let alarms = folder.ieap(&["status", "--alarms"]).expect(0);
    assert!(alarms.stderr.contains("`timezome`"), "{alarms:#?}");
}
