//! What holds across runs, through files: a hidden humidity law, an order that ties it to age, the design of the
//! thesis, and alarms of monitoring with their command and exit status.

use serde_json::Value;

use crate::campaign::{CAMPAIGN_TOML, CampaignFolder, run_table};

const PLAIN: [f64; 7] = [520.0, 0.04, 1000.0, 0.13, 5600.0, 14.0, 4e-3];

/// A simulated run of 120 s, with the factor of each sample on its parameters and one of lambda.
fn run(name: &str, tags: &str, of_sample: f64, on_lambda: f64, on_alpha: f64) -> String {
    let [r1, c1, r2, c2, rss, alpha, lambda] = PLAIN;
    format!(
        r#"
[[run]]
file = "{name}.csv"
area_cm2 = 0.1
voltage_v = 2.0
parameters = {{ r1_ohm_cm2 = {}, c1_f_per_cm2 = {c1}, r2_ohm_cm2 = {r2}, c2_f_per_cm2 = {c2}, rss_ohm_cm2 = {rss}, alpha_per_c_cm = {}, lambda_per_s = {} }}
tags = {{ voltage_v = 2.0, environment = "air", {tags} }}
"#,
        r1 * of_sample,
        alpha / of_sample * on_alpha,
        lambda * of_sample * on_lambda
    )
}

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

fn campaign(samples: &[&str], more: &str) -> CampaignFolder {
    let folder = CampaignFolder::new();
    let mut text = String::from("[campaign]\nid = \"across\"\ntitle = \"Across runs\"\n");
    for sample in samples {
        text +=
            &format!("[[sample]]\nid = \"{sample}\"\nmaterial = \"CNaf\"\nlength_mm = 5.0\nwidth_mm = 2.0\n");
    }
    folder.write("campaign.toml", text + more);
    folder
}

fn simulate(folder: &CampaignFolder, runs: &str) {
    folder.write("simulation.toml", format!("{HEAD}{runs}"));
    let spec = folder.path().join("simulation.toml");
    let ended = folder.ieap(&["simulate", spec.to_str().unwrap()]);
    assert_eq!(ended.status, 0, "{ended:#?}");
}

/// Scatter of a run that repeats: a few percent, in an order without meaning.
fn scatter(k: usize) -> f64 {
    1.0 + 0.03 * (((14 * k * k + 7 * k) % 17) as f64 / 8.0 - 1.0)
}

fn hidden(order: &[[f64; 4]; 3]) -> Value {
    hidden_in(order, 1.0, |_| ())
}

/// The same with another size of lambda, and files that `prepare` changes.
fn hidden_in(order: &[[f64; 4]; 3], size: f64, prepare: fn(&CampaignFolder)) -> Value {
    let samples = ["S1", "S2", "S3"];
    let folder = campaign(&samples, "");
    let mut runs = String::new();
    for (s, (sample, humidities)) in samples.iter().zip(order).enumerate() {
        for (k, humidity) in humidities.iter().enumerate() {
            let tags = format!(
                "sample = \"{sample}\", cycle = {}, relative_humidity_percent = {humidity}",
                k + 1
            );
            let law = size * (0.02 * (humidity - 20.0)).exp() * scatter(4 * s + k);
            runs += &run(
                &format!("{sample}_{k}"),
                &tags,
                1.0 + 0.2 * s as f64,
                law,
                scatter(4 * s + k + 5),
            );
        }
    }
    simulate(&folder, &runs);
    prepare(&folder);
    folder.ieap(&["fit"]).expect(0);
    folder.ieap(&["study", "--json"]).expect(0).json()
}

/// What the study says of lambda over numbers.
fn of_lambda<'a>(document: &'a Value, kind: &str) -> Vec<&'a Value> {
    let entries = document["answers"].as_array().unwrap();
    entries
        .iter()
        .filter(|entry| entry["parameter"] == "lambda_per_s" && entry["kind"] == kind)
        .collect()
}

/// The only law of the humidity; it holds the truth, 0.02 per percent, in an interval at most so wide.
fn law(document: &Value, widest: f64) -> &Value {
    let [entry] = of_lambda(document, "humidity-law")[..] else {
        panic!("{:#}", document["answers"]);
    };
    assert_eq!(entry["verdict"], "differs", "{entry:#}");
    assert_eq!(entry["covariate"], "relative_humidity_percent");
    let end = |name: &str| entry[name].as_f64().unwrap();
    let held = end("low_95")..=end("high_95");
    assert!(
        held.contains(&0.02) && end("high_95") - end("low_95") < widest,
        "{entry:#}"
    );
    entry
}

#[test]
fn a_hidden_humidity_law_is_found_from_files() {
    let document = hidden(&[
        [20.0, 60.0, 40.0, 80.0],
        [60.0, 20.0, 80.0, 40.0],
        [80.0, 40.0, 20.0, 60.0],
    ]);
    let entry = law(&document, 0.008);
    assert_eq!(entry["also_changed"], Value::Array(vec![]));
    assert_eq!(
        (&entry["samples"], &entry["from_to"][1]),
        (&3.into(), &80.0.into())
    );
    // Use tells nothing.
    let of_use = of_lambda(&document, "other-law");
    assert!(
        of_use.iter().all(|own| own["verdict"] != "differs"),
        "{of_use:#?}"
    );
}

/// Takes the current out of every run table.
fn without_current(folder: &CampaignFolder) {
    for entry in std::fs::read_dir(folder.join("runs")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "csv") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let head = text.lines().find(|line| !line.starts_with('#')).unwrap();
        let current = head.split(',').position(|name| name == "current_a").unwrap();
        let lines = text.lines().map(|line| {
            if line.starts_with('#') {
                line.to_owned()
            } else {
                let cells = line.split(',').enumerate().filter(|(place, _)| *place != current);
                cells.map(|(_, cell)| cell).collect::<Vec<_>>().join(",")
            }
        });
        std::fs::write(&path, lines.collect::<Vec<_>>().join("\n")).unwrap();
    }
}

#[test]
fn bending_without_a_current_is_fitted_and_asked_across_runs() {
    // Relaxation slower than charging at every humidity: bending alone cannot tell them apart else.
    let document = hidden_in(
        &[
            [20.0, 60.0, 40.0, 80.0],
            [60.0, 20.0, 80.0, 40.0],
            [80.0, 40.0, 20.0, 60.0],
        ],
        0.25,
        without_current,
    );
    law(&document, 0.012);
}

#[test]
fn a_humidity_that_rose_with_every_run_is_said_to_be_tied_to_age() {
    let rising = [20.0, 40.0, 60.0, 80.0];
    let document = hidden(&[rising; 3]);
    let tied = law(&document, 0.008)["also_changed"].to_string();
    assert!(tied.contains("the cycle"), "{tied}");
}

const MONITORING: &str = r#"
[monitoring]
reference = { environment = "air", voltage_v = 2.0, relative_humidity_percent = 35 }
false_alarm_runs = 5000
command = ["sh", "-c", "echo \"$IEAP_ALARM_ID $IEAP_ALARM_SAMPLE $IEAP_ALARM_PARAMETER $IEAP_ALARM_CHARTS\" >> told.txt"]
[[monitoring.limit]]
parameter = "alpha_per_c_cm"
below = 10.0
"#;

/// Steady for eight runs, then alpha fades; beside them runs at another humidity.
fn fading(until: usize) -> String {
    let mut runs = String::new();
    for k in 0..until {
        let fade = 1.0 - 0.06 * (k as f64 - 7.0).max(0.0);
        let tags = format!(
            "sample = \"S1\", cycle = {}, relative_humidity_percent = 35",
            2 * k + 1
        );
        runs += &run(
            &format!("S1_{k:02}"),
            &tags,
            1.0,
            scatter(k + 3),
            fade * scatter(k),
        );
    }
    runs
}

#[cfg(unix)]
#[test]
fn an_alarm_is_told_once_and_stands_in_the_exit_status() {
    let folder = campaign(&["S1"], MONITORING);
    simulate(&folder, &fading(8));
    folder
        .ieap(&["run", "--no-diagnose", "--allow-command"])
        .expect(0);
    folder.ieap(&["status", "--alarms"]).expect(0);
    assert!(!folder.path().join("told.txt").exists());

    simulate_over(&folder, &fading(14));
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let told = std::fs::read_to_string(folder.path().join("told.txt")).unwrap();
    assert!(told.contains("S1 alpha_per_c_cm limit"), "{told}");
    // One change is one alarm.
    let of_charts = told
        .lines()
        .filter(|line| line.contains("alpha_per_c_cm") && !line.contains("limit"));
    let of_charts: Vec<&str> = of_charts.collect();
    assert_eq!(of_charts.len(), 1, "{told}");
    assert!(of_charts[0].contains("ewma"), "{told}");

    // Once and not again.
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    assert_eq!(
        std::fs::read_to_string(folder.path().join("told.txt")).unwrap(),
        told
    );

    let ended = folder.ieap(&["status", "--alarms", "--json"]).expect(5);
    let alarms = ended.json()["alarms"].as_array().unwrap().clone();
    assert_eq!(alarms.len(), told.lines().count());
    folder.ieap(&["status"]).expect(0);
    let page = std::fs::read_to_string(folder.path().join("report/monitoring.html")).unwrap();
    assert!(
        page.contains("left control in the reference condition"),
        "no alarm on the page"
    );

    // Known alarms are not counted.
    let ids: Vec<String> = alarms.iter().map(|alarm| alarm["id"].to_string()).collect();
    let known = MONITORING.replace(
        "[[monitoring",
        &format!("acknowledged = [{}]\n[[monitoring", ids.join(", ")),
    );
    let text = std::fs::read_to_string(folder.path().join("campaign.toml")).unwrap();
    folder.write("campaign.toml", text.replace(MONITORING, &known));
    folder.ieap(&["status", "--alarms"]).expect(0);
}

fn simulate_over(folder: &CampaignFolder, runs: &str) {
    folder.write("simulation.toml", format!("{HEAD}{runs}"));
    let spec = folder.path().join("simulation.toml");
    folder
        .ieap(&["simulate", "--overwrite", spec.to_str().unwrap()])
        .expect(0);
}

#[test]
fn runs_that_do_not_say_when_they_were_made_are_not_watched_and_status_says_so() {
    let limit = "[monitoring]\n[[monitoring.limit]]\nparameter = \"alpha_per_c_cm\"\nbelow = 1e6\n";
    let folder = CampaignFolder::new();
    folder.write("campaign.toml", format!("{CAMPAIGN_TOML}{limit}"));
    for run in 1..5 {
        folder.write(&format!("runs/{run}.csv"), run_table(run));
    }
    folder.run_json();
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    let why = status["status"]["monitoring"]
        .as_str()
        .unwrap_or_default()
        .to_owned();
    assert!(
        why.starts_with("4 of 4 runs of S1 in the reference condition do not say when"),
        "{why}"
    );
    let page = folder.report("monitoring.html");
    assert!(page.contains("do not say when they were made"), "{page}");
}

#[test]
fn a_limit_without_a_side_is_refused_with_its_place() {
    let folder = campaign(
        &["S1"],
        "[monitoring]\n[[monitoring.limit]]\nparameter = \"alpha_per_c_cm\"\n",
    );
    let ended = folder.ieap(&["status"]);
    assert_eq!(ended.status, 2, "{ended:#?}");
    assert!(
        ended.stderr.contains("neither below nor above"),
        "{}",
        ended.stderr
    );
}

#[test]
fn what_is_a_function_of_the_voltage_is_not_said_to_come_from_use() {
    let folder = campaign(&["S1", "S2"], "");
    let mut runs = String::new();
    for sample in ["S1", "S2"] {
        for cycle in 1..=8 {
            // Each voltage once, rising: the cycle is a function of it, and lambda of both.
            let volts = 0.8 + 0.2 * f64::from(cycle);
            let tags = format!("sample = \"{sample}\", cycle = {cycle}");
            let noise = 1.0 + 0.01 * scatter(cycle as usize + 20 * usize::from(sample == "S2"));
            let on_lambda = (0.5 * (volts - 1.5)).exp() * noise;
            let own = run(&format!("{sample}_{cycle}"), &tags, 1.0, on_lambda, 1.0);
            runs += &own.replace("voltage_v = 2.0", &format!("voltage_v = {volts:.1}"));
        }
    }
    simulate(&folder, &runs);
    folder.ieap(&["fit"]).expect(0);
    let document = folder.ieap(&["study", "--json"]).expect(0).json();
    assert_eq!(
        of_lambda(&document, "voltage-law")[0]["verdict"],
        "differs",
        "{document:#}"
    );
    let of_use = of_lambda(&document, "other-law");
    assert!(of_use.is_empty(), "{of_use:#?}");
}
