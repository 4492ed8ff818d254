//! What only a comparison of runs shows, through files and the command line: carry-over after short rests, a law of the humidity
//! beside runs that state none.

use serde_json::Value;

use crate::campaign::CampaignFolder;

const HEAD: &str = r#"[simulation]
seed = 8
folder = "runs"
statement = ["SIMULATED, not measured."]
baseline_s = 5.0

[noise]
current_a = 1e-6
curvature_per_cm = 2e-3

[[sampling]]
until_s = 400.0
every_s = 4.0
"#;

/// Factors of a run on the parameters, and the area that it truly has.
#[derive(Clone, Copy)]
struct Truth {
    area_cm2: f64,
    r1: f64,
    c2: f64,
    rss: f64,
    alpha: f64,
    lambda: f64,
}

const PLAIN: Truth = Truth {
    area_cm2: 0.1,
    r1: 1.0,
    c2: 1.0,
    rss: 1.0,
    alpha: 1.0,
    lambda: 1.0,
};

fn run(name: &str, voltage_v: f64, truth: Truth, tags: &str) -> String {
    format!(
        r#"
[[run]]
file = "{name}.csv"
area_cm2 = {}
voltage_v = {voltage_v}
parameters = {{ r1_ohm_cm2 = {}, c1_f_per_cm2 = 0.04, r2_ohm_cm2 = 1000.0, c2_f_per_cm2 = {}, rss_ohm_cm2 = {}, alpha_per_c_cm = {}, lambda_per_s = {} }}
tags = {{ environment = "air", voltage_v = {voltage_v}, {tags} }}
"#,
        truth.area_cm2,
        520.0 * truth.r1,
        0.13 * truth.c2,
        5600.0 * truth.rss,
        14.0 * truth.alpha,
        4e-3 * truth.lambda,
    )
}

/// `1 ± part`, without an order that means anything.
fn scatter(k: usize, part: f64) -> f64 {
    let bits = (k as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    1.0 + part * ((bits >> 40) as f64 / f64::from(1 << 23) - 1.0)
}

fn campaign(samples: &[String]) -> CampaignFolder {
    let folder = CampaignFolder::new();
    std::fs::remove_file(folder.join("runs/tags.toml")).unwrap();
    let mut text = String::from("[campaign]\nid = \"hidden\"\ntitle = \"Hidden across runs\"\n");
    for sample in samples {
        text +=
            &format!("[[sample]]\nid = \"{sample}\"\nmaterial = \"CNaf\"\nlength_mm = 5.0\nwidth_mm = 2.0\n");
    }
    folder.write("campaign.toml", text);
    folder
}

fn simulate(folder: &CampaignFolder, runs: &str) {
    folder.write("simulation.toml", format!("{HEAD}{runs}"));
    let spec = folder.join("simulation.toml");
    folder.ieap(&["simulate", spec.to_str().unwrap()]).expect(0);
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn a_carry_over_after_short_rests_is_found_from_files() {
    let samples: Vec<String> = (1..=3).map(|s| format!("S{s}")).collect();
    let folder = campaign(&samples);
    // An order of its own for each sample, so that the rest is not the cycle.
    let orders = [
        [20.0, 900.0, 60.0, 300.0, 120.0, 20.0, 900.0, 60.0],
        [300.0, 60.0, 900.0, 20.0, 20.0, 120.0, 300.0, 900.0],
        [120.0, 20.0, 300.0, 900.0, 60.0, 900.0, 20.0, 120.0],
    ];
    let mut runs = String::new();
    for (s, (sample, rests)) in samples.iter().zip(orders).enumerate() {
        for (k, &rest) in rests.iter().enumerate() {
            let left: f64 = 0.5 * (-rest / 100.0_f64).exp();
            let truth = Truth {
                // What the run before left makes the strip relax faster, and is gone after some minutes.
                lambda: (1.0 + 0.1 * s as f64) * left.exp() * scatter(8 * s + k, 0.02),
                r1: scatter(100 + 8 * s + k, 0.02),
                ..PLAIN
            };
            let tags = format!("sample = \"{sample}\", cycle = {}, rest_before_s = {rest}", k + 1);
            runs += &run(&format!("{sample}_{k}"), 2.0, truth, &tags);
        }
    }
    simulate(&folder, &runs);
    folder.ieap(&["fit"]).expect(0);
    let document = folder.ieap(&["study", "--json"]).expect(0).json();
    let answers = document["answers"].as_array().unwrap();
    let is_it = |own: &&Value| own["covariate"] == "rest_before_s" && own["parameter"] == "lambda_per_s";
    let found = answers
        .iter()
        .find(is_it)
        .unwrap_or_else(|| panic!("{document:#}"));
    assert_eq!(found["verdict"], "differs", "{found:#}");
    assert!(found["value"].as_f64().unwrap() < 0.0, "{found:#}");
}

#[test]
fn a_humidity_law_stands_first_and_vacuum_runs_without_a_humidity_do_not_hide_it() {
    let samples = ["S1".to_owned(), "S2".to_owned()];
    let folder = campaign(&samples);
    let humidities = [60.0, 15.0, 75.0, 30.0, 45.0];
    let mut runs = String::new();
    for (s, sample) in samples.iter().enumerate() {
        let mut add = |cycle: usize, humidity: f64, tags: &str| {
            let truth = Truth {
                lambda: (0.042_f64 * (humidity - 40.0)).exp() * scatter(10 * s + cycle, 0.05),
                ..PLAIN
            };
            let tags = format!("sample = \"{sample}\", cycle = {cycle}{tags}");
            runs += &run(&format!("{sample}-{cycle}"), 2.0, truth, &tags);
        };
        for (k, &humidity) in humidities.iter().enumerate() {
            add(
                k + 1,
                humidity,
                &format!(", relative_humidity_percent = {humidity}"),
            );
        }
        add(6, 0.0, "");
        add(7, 0.0, "");
    }
    let dry = "tags = { environment = \"vacuum\"";
    let runs: Vec<String> = runs
        .split("[[run]]")
        .map(|text| {
            if text.contains("relative_humidity_percent") {
                text.to_owned()
            } else {
                text.replace("tags = { environment = \"air\"", dry)
            }
        })
        .collect();
    simulate(&folder, &runs.join("[[run]]"));
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    let without = status["status"]["without_humidity"].as_array().unwrap();
    assert_eq!(without.len(), 4, "{without:?}");
    let overview = folder.report("index.html").replace("&#39;", "'");
    let law = overview
        .find("With the relative humidity from 15 to 75\u{a0}% RH, CNaf's back-relaxation rate λ rises ")
        .expect("the law");
    let parameters = overview.find("The parameters over").expect("the parameters");
    assert!(law < parameters);
    // The same law for print, by the beginning of the parameter's key.
    folder
        .ieap(&["figure", "laws", "--parameter", "lambda", "-o", "lambda.pdf"])
        .expect(0);
    assert!(
        std::fs::read(folder.join("lambda.pdf"))
            .unwrap()
            .starts_with(b"%PDF")
    );
    folder
        .ieap(&["figure", "figure26", "--parameter", "lambda", "-o", "none.pdf"])
        .expect(2);
    let slip = folder.ieap(&["figure", "laws", "--parameter", "lamda", "-o", "none.pdf"]);
    assert!(slip.expect(2).stderr.contains("a parameter by its key or symbol"));
    // Said of the environment once, the runs in vacuum are of the law.
    let text = std::fs::read_to_string(folder.join("campaign.toml")).unwrap();
    folder.write(
        "campaign.toml",
        text + "\n[[environment]]\nid = \"vacuum\"\nrelative_humidity_percent = 0\n",
    );
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    assert_eq!(status["status"]["without_humidity"], Value::Array(vec![]));
}
