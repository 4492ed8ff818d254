//! From a folder of files as people have them to a report with every run that can be used: three actions.

use std::fs;
use std::path::Path;

use crate::campaign::{Ended, command, run_table};

/// Runs `ieap` on a computer of that time zone.
fn ieap(folder: &Path, arguments: &[&str]) -> Ended {
    let output = command(folder, arguments)
        .env("TZ", "Europe/Tallinn")
        .output()
        .unwrap();
    Ended {
        status: output.status.code().unwrap_or(-1),
        stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
        stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}

/// A run table in another spelling: semicolons and decimal commas.
fn with_commas(table: &str) -> String {
    let row = |line: &str| line.replace(',', ";").replace('.', ",") + "\n";
    table.lines().map(row).collect()
}

/// Thirteen files as a laboratory has them.
fn folder_of_files(folder: &Path) {
    let write = |name: &str, text: &str| {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    };
    let table = |seed: u32| run_table(seed);
    let headed = |seed: u32, header: &str| {
        let table = run_table(seed);
        let (_, rows) = table.split_once('\n').unwrap();
        format!("{header}\n{rows}")
    };
    // Plain ones.
    write("CNaf-01_air_2.0V_1.csv", &table(1));
    write("CNaf-01_air_2.0V_2.csv", &table(2));
    // Decimal commas, German names.
    write(
        "CNaf-01_air_2.0V_3.csv",
        &with_commas(&headed(3, "Zeit [s],Spannung [V],Strom [A],Kr\u{fc}mmung [1/cm]")),
    );
    // Units in a row of their own.
    write(
        "CNaf-01_vacuum_2.0V_4.csv",
        &headed(4, "Time\tVoltage\tCurrent\tCurvature\ns\tV\tA\t1/cm").replace(',', "\t"),
    );
    // A slip in a column's name, one in the environment's.
    write(
        "CNaf-02_inert_2.0V_1.csv",
        &headed(5, "time_s,voltage_v,curent_a,curvature_per_cm"),
    );
    write("CNaf-02_vaccum_2.0V_2.csv", &table(6));
    // Another spelling of the sample.
    write("cnaf02_air_2.0V_3.csv", &table(7));
    // A current over the area, which is 0.1 cm².
    let over_area = |row: &str| {
        let cells: Vec<&str> = row.split(',').collect();
        let current_a: f64 = cells[2].parse().unwrap();
        format!("{},{},{:.5e},{}\n", cells[0], cells[1], current_a / 0.1, cells[3])
    };
    let rows: String = table(8).lines().skip(1).map(over_area).collect();
    write(
        "CNaf-02_air_2.0V_4.csv",
        &format!("time_s,voltage_v,current density (A/cm2),curvature_per_cm\n{rows}"),
    );
    // The environment in the folder's name.
    write("Argon/CPvf-01_2.0V_1.csv", &table(9));
    // A sweep that is too fast for its readings.
    let sweep: String = (0..800)
        .map(|k| {
            let phase = f64::from(k % 16) / 4.0;
            let volts = if phase < 2.0 { phase - 1.0 } else { 3.0 - phase };
            format!("{},{volts:.4},{:.6e}\n", f64::from(k) * 0.1, 1e-3 * volts)
        })
        .collect();
    write("CV_CNaf-01.csv", &format!("time_s,voltage_v,current_a\n{sweep}"));
    // A logger with dots in its dates, and one with slashes.
    let log = |date: &str| {
        let rows: String = (0..20)
            .map(|k| format!("{date} 10:{:02};21,{k};40,5\n", 2 * k))
            .collect();
        format!("Datum;Temperatur (\u{b0}C);Luftfeuchte (%)\n{rows}")
    };
    write("Logger_M\u{e4}rz.csv", &log("02.03.2026"));
    // A modulus log, and something that nobody reads.
    let modulus: String = (0..40)
        .map(|k| format!("{},{},6\n", 10 * k, 60.0 - 0.1 * f64::from(k)))
        .collect();
    write(
        "CNaf-01_modulus.csv",
        &format!("Time (s),Storage modulus (MPa),Loss modulus (MPa)\n{modulus}"),
    );
    write("notes.docx", "PK not really");
}

#[test]
fn three_actions_lead_from_a_folder_of_files_to_a_report() {
    let root = tempfile::tempdir().unwrap();
    let files = root.path().join("files");
    folder_of_files(&files);
    let before = listed(&files);
    assert_eq!(before.len(), 13);
    // Shown, and nothing written.
    let shown = ieap(root.path(), &["init", "study", "--from", "files"]).expect(0);
    assert!(!root.path().join("study").exists());
    for part in [
        "climate log",
        "modulus log",
        "no steps",
        "name_pattern = \"{sample}_{environment}_{voltage_v}V_{cycle}\" explains",
        "length_mm and width_mm of",
    ] {
        assert!(shown.stdout.contains(part), "{part}\n{}", shown.stdout);
    }
    // First action.
    ieap(root.path(), &["init", "study", "--from", "files", "--yes"]).expect(0);
    assert_eq!(listed(&files), before, "the files themselves are never touched");
    // Second: the sizes, which only a person knows.
    let path = root.path().join("study/campaign.toml");
    let text = fs::read_to_string(&path).unwrap();
    let filled = text
        .replace("# length_mm = 0.0    # FILL IN", "length_mm = 5.0    #")
        .replace("# width_mm = 0.0    # FILL IN", "width_mm = 2.0    #");
    assert!(!filled.contains("FILL IN:"), "{filled}");
    // Vacuum and dry gas hold no water: laws of the humidity have their runs too.
    for id in ["vacuum", "inert", "argon"] {
        let dry = format!("id = \"{id}\"\nrelative_humidity_percent = 0 ");
        assert!(text.contains(&dry), "{text}");
    }
    fs::write(&path, filled).unwrap();
    // Third. What nobody reads is refused with its reason.
    ieap(root.path(), &["run", "study", "--no-diagnose"]).expect(3);
    let status = ieap(root.path(), &["status", "study", "--json"]).expect(0).json();
    let status = &status["status"];
    assert_eq!(
        status["runs_by_state"],
        serde_json::json!({ "fitted": 9, "no_steps": 1 }),
        "{status:#}"
    );
    assert_eq!(
        status["modulus_logs_by_state"],
        serde_json::json!({ "analysed": 1 }),
        "{status:#}"
    );
    assert_eq!(status["climate"]["logs"], 1);
    assert_eq!(status["refused"].as_array().unwrap().len(), 1);
    assert_eq!(status["undeclared_tags"], serde_json::json!([]));
    assert!(root.path().join("study/report/index.html").exists());
    let fits = ieap(root.path(), &["fit", "study", "--json"]).json();
    let fit = |run: &str| {
        let fits = fits["fits"].as_array().unwrap();
        fits.iter()
            .find(|fit| fit["run"] == run)
            .cloned()
            .unwrap_or_else(|| panic!("{run}: {fits:#?}"))
    };
    for (run, sample, environment) in [
        ("runs/CNaf-02_vaccum_2.0V_2.csv", "CNaf-02", "vacuum"),
        ("runs/cnaf02_air_2.0V_3.csv", "CNaf-02", "air"),
        ("runs/Argon/CPvf-01_2.0V_1.csv", "CPvf-01", "argon"),
    ] {
        assert_eq!(fit(run)["sample"], sample, "{run}");
        assert_eq!(fit(run)["environment"], environment, "{run}");
    }
    // A campaign that is there is never written over.
    let again = ieap(root.path(), &["init", "study", "--from", "files", "--yes"]);
    assert_ne!(again.status, 0);
    let itself = ieap(root.path(), &["init", "files", "--from", "files"]).expect(2);
    assert!(itself.stderr.contains("the campaign itself"), "{}", itself.stderr);
}

#[test]
fn files_of_one_header_have_one_draft() {
    let root = tempfile::tempdir().unwrap();
    let files = root.path().join("files");
    fs::create_dir_all(&files).unwrap();
    let rows: String = (0..40).map(|k| format!("{k};{};{}\n", k % 7, 3 * k)).collect();
    for (lines, header) in [
        (1, "tick;gauge;dial"),
        (3, "tick;gauge;dial"),
        (2, "tick;knob;dial"),
    ] {
        let head: String = (0..lines).map(|k| format!("remark {k}\n")).collect();
        fs::write(
            files.join(format!("odd_{lines}.csv")),
            format!("{head}{header}\n{rows}"),
        )
        .unwrap();
    }
    let shown = ieap(root.path(), &["init", "study", "--from", "files", "--json"]).expect(0);
    let profiles = shown.json();
    let profiles = profiles["proposed"]["profiles"].as_array().unwrap();
    let of: Vec<usize> = profiles
        .iter()
        .map(|profile| profile["files"].as_array().unwrap().len())
        .collect();
    assert_eq!(of, [2, 1], "{profiles:#?}");
}

/// Names, sizes and times of change of all files.
fn listed(folder: &Path) -> Vec<(String, u64, std::time::SystemTime)> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_owned()];
    while let Some(at) = open.pop() {
        for entry in fs::read_dir(at).unwrap() {
            let entry = entry.unwrap();
            let about = entry.metadata().unwrap();
            if about.is_dir() {
                open.push(entry.path())
            } else {
                found.push((
                    entry.path().display().to_string(),
                    about.len(),
                    about.modified().unwrap(),
                ))
            }
        }
    }
    found.sort();
    found
}
