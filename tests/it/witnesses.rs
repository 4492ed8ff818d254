//! What a run sheet, names and readings say of runs and contradict each other in: two rows that were swapped and a file with
//! a wrong name are asked, take part in nothing until somebody answers, and take part again once that is done.

use serde_json::{Value, json};

use crate::campaign::{CampaignFolder, run_table};

const HEAD: &str = r#"[simulation]
seed = 5
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
id = "swapped"
title = "Swapped"

[runs]
name_pattern = "{sample}_{environment}_{cycle}"

[study]
compare = ["environment"]

[[sample]]
id = "N1"
material = "Nafion"
length_mm = 5.0
width_mm = 2.0

[[sample]]
id = "P3"
material = "PVdF"
length_mm = 5.0
width_mm = 2.0
"#;

/// A run of a strip: its second material resists and bends more, and both relax faster in air.
fn run(name: &str, strip: &str, environment: &str, repeat: usize) -> String {
    let (rss, alpha) = if strip == "N1" {
        (5600.0, 14.0)
    } else {
        (8000.0, 20.0)
    };
    let lambda = if environment == "air" { 8e-3 } else { 4e-3 };
    let scatter = 1.0 + 0.01 * (repeat as f64 - 2.0);
    format!(
        r#"
[[run]]
file = "{name}.csv"
area_cm2 = 0.1
voltage_v = 2.0
parameters = {{ r1_ohm_cm2 = 520.0, c1_f_per_cm2 = 0.04, r2_ohm_cm2 = 1000.0, c2_f_per_cm2 = 0.13, rss_ohm_cm2 = {}, alpha_per_c_cm = {}, lambda_per_s = {} }}
"#,
        rss * scatter,
        alpha / scatter,
        lambda * scatter * scatter
    )
}

/// Three runs of each strip in each of two environments, and one more with a wrong name; the sheet swaps two rows.
fn campaign() -> CampaignFolder {
    let folder = CampaignFolder::new();
    std::fs::remove_file(folder.join("runs/tags.toml")).unwrap();
    folder.write("campaign.toml", CAMPAIGN);
    let (mut runs, mut sheet) = (HEAD.to_owned(), "file,sample,environment,voltage_v\n".to_owned());
    for (strip, environment) in [("N1", "air"), ("N1", "vacuum"), ("P3", "air"), ("P3", "vacuum")] {
        for repeat in 1..=3 {
            let name = format!("{strip}_{environment}_{repeat}");
            let by_sheet = match name.as_str() {
                "N1_air_2" => "P3",
                "P3_air_2" => "N1",
                _ => strip,
            };
            runs += &run(&name, strip, environment, repeat);
            sheet += &format!("{name}.csv,{by_sheet},{environment},2.0\n");
        }
    }
    runs += &run("P3_vacuum_9", "N1", "vacuum", 2);
    sheet += "P3_vacuum_9.csv,N1,vacuum,2.0\n";
    folder.write("simulation.toml", runs);
    let spec = folder.join("simulation.toml");
    folder.ieap(&["simulate", spec.to_str().unwrap()]).expect(0);
    folder.write("runs/run-sheet.csv", sheet);
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    folder
}

fn status(folder: &CampaignFolder) -> Value {
    folder.ieap(&["status", "--json"]).expect(0).json()["status"].clone()
}

fn study(folder: &CampaignFolder) -> Value {
    folder.ieap(&["study", "--json"]).expect(0).json()
}

/// Runs behind the answer about lambda of the first material in air.
fn behind(study: &Value) -> Value {
    let answers = study["answers"].as_array().unwrap();
    let is_it = |own: &&Value| {
        own["kind"] == "environment" && own["parameter"] == "lambda_per_s" && own["material"] == "Nafion"
    };
    answers.iter().find(is_it).unwrap()["runs"].clone()
}

#[test]
fn swapped_rows_and_a_wrong_name_are_asked_and_speak_once_answered() {
    let folder = campaign();
    let before = status(&folder);
    let questions = before["questions"].as_array().unwrap();
    let of = |key: &str| -> Vec<&Value> { questions.iter().map(|asked| &asked[key]).collect() };
    let (swapped, misnamed) = (["runs/N1_air_2.csv", "runs/P3_air_2.csv"], "runs/P3_vacuum_9.csv");
    assert_eq!(of("runs"), [&json!(swapped), &json!([misnamed])]);
    assert_eq!(
        of("question"),
        [
            "2 runs may be swapped: the run sheet says sample P3 where the file name says N1, and the other way round; \
             their readings are like what the file name says",
            "runs/P3_vacuum_9.csv: the run sheet says sample N1, the file name P3; its readings are like those of N1"
        ]
    );
    let commands = [
        r#"ieap tag "runs/N1_air_2.csv" sample=N1"#,
        r#"ieap tag "runs/P3_air_2.csv" sample=P3"#,
        r#"ieap tag "runs/P3_vacuum_9.csv" sample=N1"#,
    ];
    assert_eq!(of("answers"), [&json!(commands[..2]), &json!(commands[2..])]);
    let silent = before["set_aside"].as_array().unwrap().iter();
    let silent: Vec<&Value> = silent.map(|own| &own["run"]).collect();
    assert_eq!(silent, [swapped[0], swapped[1], misnamed]);
    let told = folder.ieap(&["status"]).expect(0).stdout;
    let page = std::fs::read_to_string(folder.join("report/index.html")).unwrap();
    for question in of("question") {
        assert!(told.contains(question.as_str().unwrap()), "{question}\n{told}");
    }
    for command in commands {
        assert!(told.contains(command), "{told}");
        assert!(page.contains(&command.replace('"', "&quot;")), "{command}");
    }
    // The study says so.
    let of_them = study(&folder);
    assert_eq!(behind(&of_them), json!([2, 3]));
    assert_eq!(of_them["left_out"], json!([swapped[0], swapped[1], misnamed]));
    let said = folder.ieap(&["study"]).expect(0).stdout;
    assert!(said.contains("`ieap status` asks which is right"), "{said}");
    // As it is typed.
    for command in commands {
        let words: Vec<&str> = command.split(' ').map(|word| word.trim_matches('"')).collect();
        folder.ieap(&words[1..]).expect(0);
    }
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let after = status(&folder);
    assert_eq!(
        (&after["questions"], &after["set_aside"]),
        (&json!([]), &json!([]))
    );
    let of_all = study(&folder);
    assert_eq!(
        (&behind(&of_all), &of_all["left_out"]),
        (&json!([3, 4]), &json!([]))
    );
}

#[test]
fn a_voltage_that_the_readings_contradict_and_a_fraction_of_humidity_are_in_no_table_until_answered() {
    let folder = CampaignFolder::new();
    for (seed, name) in ["right", "high", "damp"].into_iter().enumerate() {
        folder.write(&format!("runs/{name}.csv"), run_table(seed as u32));
    }
    folder.write("runs/high.csv.toml", "voltage_v = 3\n");
    folder.write("runs/damp.csv.toml", "relative_humidity_percent = 0.33\n");
    folder.run_json();
    let told = status(&folder);
    let asked = |key: &str| -> Vec<Value> {
        let questions = told["questions"].as_array().unwrap();
        questions.iter().map(|asked| asked[key].clone()).collect()
    };
    assert_eq!(
        asked("question"),
        [
            "runs/high.csv: the sidecar says voltage 3\u{a0}V, the voltage channel 2\u{a0}V",
            "runs/damp.csv: the sidecar says relative humidity 0.33\u{a0}%, or 33\u{a0}% if that is a fraction"
        ]
    );
    let fraction = r#"ieap tag "runs/damp.csv" relative_humidity_percent=33"#;
    assert_eq!(asked("answers")[1][0], fraction);
    let measured = || {
        let sql = "SELECT voltage_v, relative_humidity_percent FROM fits_view WHERE speaks = 1 \
                   GROUP BY run ORDER BY run";
        let database = rusqlite::Connection::open(folder.join("campaign.db")).unwrap();
        let mut rows = database.prepare(sql).unwrap();
        let found = rows.query_map([], |row| Ok((row.get(0)?, row.get(1)?))).unwrap();
        found.map(Result::unwrap).collect::<Vec<(f64, Option<f64>)>>()
    };
    assert_eq!(measured(), [(2.0, None)]);
    let conditions = folder.ieap(&["table", "conditions", "--json"]).expect(0).stdout;
    assert!(!conditions.contains("0.33"), "{conditions}");
    for answer in ["voltage_v=2", "relative_humidity_percent=33"] {
        let run = if answer.starts_with("voltage") {
            "high"
        } else {
            "damp"
        };
        folder
            .ieap(&["tag", &format!("runs/{run}.csv"), answer])
            .expect(0);
    }
    folder.run_json();
    assert_eq!(status(&folder)["questions"], json!([]));
    assert_eq!(measured(), [(2.0, Some(33.0)), (2.0, None), (2.0, None)]);
}
