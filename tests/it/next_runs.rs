//! From a confounded campaign to the runs that untie it: the list, the run sheet, the runs made by it, and what is
//! left; and what becomes of sheets that are damaged, rewritten or contradicted.

use serde_json::Value;

use crate::campaign::{CampaignFolder, run_table};
use crate::watch::{Watching, fitted, until};

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

/// A simulated run whose lambda falls by 4 % with every cycle; `sample` counts from 0.
fn run(file: &str, voltage_v: f64, sample: usize, cycle: usize, tags: &str) -> String {
    let of_sample = 1.0 + 0.2 * sample as f64;
    let scatter = 1.0 + 0.01 * (((7 * cycle + 5 * sample) % 5) as f64 - 2.0);
    format!(
        r#"
[[run]]
file = "{file}.csv"
area_cm2 = 0.1
voltage_v = {voltage_v}
parameters = {{ r1_ohm_cm2 = {}, c1_f_per_cm2 = 0.04, r2_ohm_cm2 = 1000.0, c2_f_per_cm2 = 0.13, rss_ohm_cm2 = 5600.0, alpha_per_c_cm = 14.0, lambda_per_s = {} }}
tags = {{ {tags} }}
"#,
        520.0 * of_sample,
        4e-3 * of_sample * scatter * 0.96_f64.powi(cycle as i32),
    )
}

/// Two samples measured as in the thesis: environments one after the other, voltages rising in each.
fn confounded() -> CampaignFolder {
    let folder = CampaignFolder::new();
    std::fs::remove_file(folder.join("runs/tags.toml")).unwrap();
    let mut text = String::from("[campaign]\nid = \"plan\"\ntitle = \"Planned\"\n");
    let mut runs = HEAD.to_owned();
    for (s, sample) in ["S1", "S2"].iter().enumerate() {
        text +=
            &format!("[[sample]]\nid = \"{sample}\"\nmaterial = \"CNaf\"\nlength_mm = 5.0\nwidth_mm = 2.0\n");
        let conditions = ["vacuum", "inert", "air"].map(|e| [1.0, 1.5, 2.0].map(|volts| (e, volts)));
        for (k, (environment, volts)) in conditions.into_iter().flatten().enumerate() {
            let cycle = k + 1;
            let tags = format!(
                "sample = \"{sample}\", environment = \"{environment}\", voltage_v = {volts}, cycle = {cycle}"
            );
            runs += &run(&format!("{sample}_{cycle}"), volts, s, cycle, &tags);
        }
    }
    folder.write("campaign.toml", text);
    simulate(&folder, &runs);
    folder
}

fn simulate(folder: &CampaignFolder, spec: &str) {
    folder.write("simulation.toml", spec);
    let spec = folder.join("simulation.toml");
    folder
        .ieap(&["simulate", "--overwrite", spec.to_str().unwrap()])
        .expect(0);
}

/// What `ieap plan` says once the runs are fitted; groups are not diagnosed, for that takes long and is shown elsewhere.
fn planned_now(folder: &CampaignFolder) -> Value {
    folder.ieap(&["fit"]).expect(0);
    folder.ieap(&["next", "--json"]).expect(0).json()
}

/// What in the answers of the study about environments changed with them.
fn tied(folder: &CampaignFolder) -> Vec<String> {
    let document = folder.ieap(&["study", "--json"]).expect(0).json();
    let answers = document["answers"].as_array().unwrap().clone();
    let asked = answers
        .iter()
        .filter(|own| own["is_of_study"] == true && own["kind"] == "environment");
    let mut all: Vec<String> = asked.map(|own| own["also_changed"].to_string()).collect();
    all.sort();
    all.dedup();
    all
}

/// Rows of a sheet: planned id, file, sample, voltage, cycle.
fn rows(text: &str) -> Vec<[String; 5]> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let columns = reader.headers().unwrap().clone();
    let at = |name: &str| columns.iter().position(|column| column == name).unwrap();
    let wanted = ["planned", "file", "sample", "voltage_v", "cycle"].map(at);
    let records = reader.records().map(Result::unwrap);
    records
        .map(|record| wanted.map(|column| record[column].to_owned()))
        .collect()
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn the_runs_of_the_sheet_untie_what_was_confounded() {
    let folder = confounded();
    let before = planned_now(&folder);
    assert!(
        tied(&folder).iter().any(|own| own.contains("the cycle")),
        "{:?}",
        tied(&folder)
    );
    let list = before["next_runs"].as_array().unwrap();
    assert!(
        !list.is_empty() && list[0]["splits"].to_string().contains("environment"),
        "{list:#?}"
    );

    // On the sheet, in its order.
    folder
        .ieap(&["next", "--sheet", "runs/next.run-sheet.csv"])
        .expect(0);
    let sheet = std::fs::read_to_string(folder.join("runs/next.run-sheet.csv")).unwrap();
    let planned = rows(&sheet);
    assert_eq!(planned.len(), list.len());
    assert_eq!(planned[0][0], "P01");

    // The sheet is no run and is not refused; its runs are open, under the names that they have.
    let summary = folder.run_json();
    assert_eq!(summary["ingest"]["new"], Value::Array(vec![]));
    assert_eq!(summary["ingest"]["refused"], Value::Array(vec![]));
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    assert_eq!(
        status["status"]["planned"]["open"].as_array().unwrap().len(),
        planned.len()
    );
    let again = folder.ieap(&["next", "--json"]).expect(0).json();
    assert_eq!(again["next_runs"][0]["planned"], "P01");
    assert_eq!(again["next_runs"][0]["on_sheet"], "runs/next.run-sheet.csv");

    // The bench: files of those names, without a word in them of what they are.
    let mut spec = HEAD.replace("seed = 3", "seed = 4");
    for [_, file, sample, volts, cycle] in &planned {
        let number = usize::from(sample == "S2");
        spec += &run(file, volts.parse().unwrap(), number, cycle.parse().unwrap(), "");
    }
    simulate(&folder, &spec);
    let after = planned_now(&folder);
    assert_eq!(after["next_runs"], Value::Array(vec![]), "{after:#}");
    assert_eq!(tied(&folder), ["[]"]);
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    let done = status["status"]["planned"]["done"].as_array().unwrap();
    assert_eq!(done.len(), planned.len(), "{status:#}");
    assert_eq!(status["status"]["planned"]["open"], Value::Array(vec![]));
    assert_eq!(status["status"]["untagged"], Value::Array(vec![]));

    // A sheet that is written over keeps the rows of runs that were made, for they have their tags from them.
    folder
        .ieap(&["next", "--sheet", "runs/next.run-sheet.csv"])
        .expect(0);
    let kept = std::fs::read_to_string(folder.join("runs/next.run-sheet.csv")).unwrap();
    assert_eq!(rows(&kept)[..planned.len()], planned[..]);
    let summary = folder.run_json();
    assert_eq!(summary["ingest"]["untagged"], Value::Array(vec![]));
}

const SHEET: &str = "planned,file,sample,environment,voltage_v,cycle,drive,why\n\
    P01,P01-S1,S1,air,2,4,hold 2.00 V for 300 s,tells a from b\n\
    P02,P02-S1,S1,inert,2,5,hold 2.00 V for 300 s,tells a from b\n\
    P03,P03-S1,S1,air,2,6,hold 2.00 V for 300 s,tells a from b\n";

/// A campaign whose runs have their tags from a sheet alone.
fn on_sheet(sheet: &str) -> CampaignFolder {
    let folder = CampaignFolder::new();
    std::fs::remove_file(folder.join("runs/tags.toml")).unwrap();
    folder.write("runs/november/bench.csv", sheet);
    folder.write("runs/P01-S1.csv", run_table(1));
    folder.write("runs/today/P03-S1.csv", run_table(2));
    folder
}

fn tag<'a>(document: &'a Value, key: &str) -> &'a Value {
    &document["tags"][key]
}

/// Chosen tags of a run with their sources, as `ieap tag` shows them.
fn tags_of(folder: &CampaignFolder, run: &str) -> Value {
    let note = folder
        .ieap(&["tag", run, "note=looked", "--json"])
        .expect(0)
        .json();
    let pairs = note["tag"]["tags"]
        .as_array()
        .unwrap_or_else(|| panic!("{note:#}"))
        .clone();
    let named = |pair: &Value| {
        (
            pair[0].as_str().unwrap().to_owned(),
            Value::Array(vec![pair[1].clone(), pair[2].clone()]),
        )
    };
    serde_json::json!({ "tags": pairs.iter().map(named).collect::<serde_json::Map<_, _>>() })
}

#[test]
fn a_sheet_is_known_by_its_columns_and_passes_over_nothing() {
    let folder = on_sheet(SHEET);
    let summary = folder.run_json();
    assert_eq!(summary["ingest"]["untagged"], Value::Array(vec![]), "{summary:#}");
    assert_eq!(summary["fit"]["fitted"], 2);
    let found = tags_of(&folder, "runs/today/P03-S1.csv");
    assert_eq!(
        tag(&found, "environment"),
        &serde_json::json!(["air", "run sheet"])
    );
    assert_eq!(tag(&found, "planned"), &serde_json::json!(["P03", "run sheet"]));
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    let planned = &status["status"]["planned"];
    assert_eq!(planned["sheets"], serde_json::json!(["runs/november/bench.csv"]));
    let open = planned["open"].as_array().unwrap();
    assert_eq!(
        (open.len(), &open[0]["planned"], &open[0]["passed_over"]),
        (1, &"P02".into(), &true.into())
    );
    let text = folder.ieap(&["status"]).expect(0).stdout;
    assert!(
        text.contains("planned runs: 2 done, 1 open") && text.contains("passed over"),
        "{text}"
    );
    let shown = folder
        .ieap(&["inspect", "--json", "runs/november/bench.csv"])
        .json();
    assert_eq!(shown["status"], "sidecar");
    // Numbers go on after those that are taken.
    let next = folder.ieap(&["next", "--json"]).expect(0).json();
    for entry in next["next_runs"].as_array().unwrap() {
        assert!(entry["planned"].as_str().unwrap() > "P03", "{next:#}");
    }
}

#[test]
fn a_damaged_sheet_is_refused_and_its_runs_stay_as_they_were() {
    let folder = on_sheet(SHEET);
    folder.run_json();
    folder.write("runs/november/bench.csv", SHEET.replace("air,2,6", "air,two,6"));
    let ended = folder.ieap(&["run", "--json", "--no-diagnose"]).expect(3);
    let summary = ended.json()["run"].clone();
    let refused = &summary["ingest"]["refused"][0];
    assert_eq!(refused[0], "runs/november/bench.csv");
    assert_eq!(refused[1]["place"], "line 4, column voltage_v");
    assert!(
        refused[1]["mend"].as_str().unwrap().contains("such as 2.5"),
        "{refused:#}"
    );
    assert_eq!(summary["ingest"]["retagged"], Value::Array(vec![]));
    assert_eq!(summary["ingest"]["untagged"], Value::Array(vec![]));
    // Asked again, the same; and a hand tag does not undo it.
    folder.ieap(&["run", "--no-diagnose"]).expect(3);
    let text = folder.ieap(&["status"]).expect(0).stdout;
    assert!(text.contains("1 run sheet that cannot be used"), "{text}");

    // Mended and rewritten: what changed is tagged again, and nothing else.
    folder.write("runs/november/bench.csv", SHEET.replace("air,2,6", "vacuum,2,6"));
    let summary = folder.run_json();
    assert_eq!(
        summary["ingest"]["retagged"],
        serde_json::json!(["runs/today/P03-S1.csv"]),
        "{summary:#}"
    );
    let found = tags_of(&folder, "runs/today/P03-S1.csv");
    assert_eq!(
        tag(&found, "environment"),
        &serde_json::json!(["vacuum", "run sheet"])
    );
}

#[test]
fn a_sheet_that_another_source_contradicts_is_an_issue_of_the_run() {
    let folder = on_sheet(SHEET);
    folder.write("runs/today/tags.toml", "environment = \"inert\"\n");
    folder.run_json();
    let found = tags_of(&folder, "runs/today/P03-S1.csv");
    assert_eq!(
        tag(&found, "environment"),
        &serde_json::json!(["inert", "tags.toml"])
    );
    let note = folder
        .ieap(&["tag", "runs/today/P03-S1.csv", "note=twice", "--json"])
        .expect(0)
        .json();
    let issues = note["tag"]["issues"].as_array().unwrap();
    assert!(
        issues.iter().any(|issue| {
            let message = issue["message"].as_str().unwrap();
            issue["code"] == "tag-disagreement" && message.contains("run sheet: runs/november/bench.csv, P03")
        }),
        "{note:#}"
    );
}

#[test]
fn nothing_is_written_over_that_is_no_sheet() {
    let folder = confounded();
    folder.ieap(&["fit"]).expect(0);
    folder.write("notes.csv", "mine,not\n1,2\n");
    let ended = folder.ieap(&["next", "--sheet", "notes.csv"]).expect(2);
    assert!(ended.stderr.contains("planned and file"), "{}", ended.stderr);
    assert_eq!(
        std::fs::read_to_string(folder.join("notes.csv")).unwrap(),
        "mine,not\n1,2\n"
    );
}

#[test]
fn a_sheet_and_its_runs_reach_a_running_watch_in_any_order() {
    let folder = CampaignFolder::new();
    std::fs::remove_file(folder.join("runs/tags.toml")).unwrap();
    folder.write("runs/P01-S1.csv", run_table(1));
    let watching = Watching::start(&folder, &[]);
    assert_eq!(fitted(&folder), 0, "without its sheet nothing tells its sample");
    folder.write("runs/november/bench.csv", SHEET);
    until("the run that was there before", || fitted(&folder) == 1);
    folder.write("runs/today/P03-S1.csv", run_table(2));
    until("the run that came after", || fitted(&folder) == 2);
    // A row that is written anew reaches the run that it stands for.
    folder.write("runs/november/bench.csv", SHEET.replace("air,2,6", "vacuum,2,6"));
    let environment = || tag(&tags_of(&folder, "runs/today/P03-S1.csv"), "environment")[0].clone();
    until("the new tag", || environment() == "vacuum");
    drop(watching);
}
