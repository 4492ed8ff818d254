//! The whole way of a finding: files of the truth simulator with an effect hidden in them, the command, the JSON
//! document and the pages.

use std::sync::atomic::{AtomicUsize, Ordering};

use ieap::pipeline::{Context, DiagnoseChoice, DiagnoseRuns, Silent};
use serde_json::Value;

use crate::campaign::{CampaignFolder, ieap, run_table};

pub const CAMPAIGN: &str = r#"
[campaign]
id = "hidden"
title = "A leak hidden in one of two samples"

[[sample]]
id = "leaky"
material = "CNaf"
length_mm = 5.0
width_mm = 2.0

[[sample]]
id = "clean"
material = "CNaf"
length_mm = 5.0
width_mm = 2.0
"#;

/// Five steps of each sample; electrolysis above 1.2 V in those of `leaky`.
pub fn spec() -> String {
    let mut spec = String::from(
        r#"[simulation]
seed = 5
folder = "runs"
statement = ["SIMULATED, not measured."]
baseline_s = 8.0

[noise]
current_a = 1e-6
curvature_per_cm = 2e-3

[[sampling]]
until_s = 400.0
every_s = 2.0

[[effect]]
id = "faradaic-leak"
variant = "terminal"
runs = ["leaky*"]
leak_current_a_per_cm2 = 2e-5
onset_v = 1.2
slope_v = 0.25
"#,
    );
    for sample in ["leaky", "clean"] {
        for voltage_v in ["1.0", "1.3", "1.6", "1.9", "2.2"] {
            spec += &format!(
                r#"
[[run]]
file = "{sample}_{voltage_v}V.csv"
area_cm2 = 0.1
length_cm = 0.5
voltage_v = {voltage_v}
parameters = {{ r1_ohm_cm2 = 520.0, c1_f_per_cm2 = 0.04, r2_ohm_cm2 = 1000.0, c2_f_per_cm2 = 0.13, rss_ohm_cm2 = 5600.0, alpha_per_c_cm = 14.0, lambda_per_s = 4e-3 }}
tags = {{ sample = "{sample}", environment = "air" }}
"#
            );
        }
    }
    spec
}

fn group<'a>(document: &'a Value, name: &str) -> &'a Value {
    let groups = document["groups"].as_array().unwrap();
    groups
        .iter()
        .find(|group| group["group"] == name)
        .unwrap_or_else(|| panic!("no group {name} in {groups:#?}"))
}

/// Addresses of the pages of groups that a page links to.
fn finding_links(html: &str) -> Vec<&str> {
    html.split("href=\"")
        .skip(1)
        .filter_map(|rest| rest.split('"').next())
        .filter(|href| href.contains("findings/"))
        .collect()
}

#[test]
fn a_hidden_leak_is_found_in_json_and_on_the_page_and_a_clean_sample_stays_right() {
    let folder = CampaignFolder::new();
    folder.write("campaign.toml", CAMPAIGN);
    std::fs::remove_file(folder.join("runs/tags.toml")).unwrap();
    folder.write("simulation.toml", spec());
    ieap(folder.path(), &["simulate", "simulation.toml"]).expect(0);
    let summary = folder.ieap(&["run", "--json"]).expect(0).json();
    assert_eq!(
        summary["run"]["diagnose"]["diagnosed"], 12,
        "two groups and ten runs"
    );

    let document = folder.ieap(&["diagnose", "--json"]).expect(0).json();
    assert_eq!(document["schema"], "ieap/diagnosis/4");
    assert_eq!((&document["seed"], &document["draws"]), (&1.into(), &999.into()));
    let leaky = group(&document, "sample=leaky,environment=air");
    assert_eq!(leaky["verdict"], "law", "{leaky:#}");
    let law = &leaky["missing"][0];
    assert_eq!(
        (&law["place"], &law["law"], &law["variable"]),
        (&"current".into(), &"leak".into(), &"voltage_v".into()),
        "{law:#}"
    );
    assert!(
        leaky["set"].as_array().unwrap().contains(&"faradaic-leak".into()),
        "{leaky:#}"
    );
    assert!(leaky["p_misfit"].as_f64().unwrap() < 0.01 && leaky["q_misfit"].as_f64().unwrap() < 0.05);
    assert!(
        leaky["gain"]["deviance"].as_f64().unwrap() > 0.0,
        "{:#}",
        leaky["gain"]
    );
    let effect = &leaky["effects"][0];
    assert!(
        effect["q"].as_f64().unwrap() <= 0.05 && effect["p"].as_f64().unwrap() <= 0.01,
        "{effect:#}"
    );
    assert!(!effect["parameters"].as_object().unwrap().is_empty());
    let clean = group(&document, "sample=clean,environment=air");
    assert_eq!(clean["verdict"], "right", "{clean:#}");
    assert!(clean["effects"].as_array().unwrap().is_empty() && clean["gain"].is_null());
    assert_eq!(document["runs"].as_array().unwrap().len(), 10);

    let list = folder.report("findings.html");
    assert!(list.contains("The model is wrong in 1 of 2 groups"), "{list}");
    let links = finding_links(&list);
    assert_eq!(links.len(), 2);
    let page = folder.report(links.iter().find(|href| href.contains("leaky")).unwrap());
    assert!(page.contains("faradaic-leak") && page.contains("<svg"));
    let overview = folder.report("index.html");
    let run = overview
        .split("href=\"")
        .find(|rest| rest.starts_with("runs/leaky"))
        .unwrap();
    let run = folder.report(run.split(['"', '#']).next().unwrap());
    assert_eq!(finding_links(&run).len(), 1, "the run leads to its group");

    let again = folder.ieap(&["diagnose", "--json"]).expect(0);
    assert!(
        again.stderr.contains("0 diagnosed, 12 up to date"),
        "{}",
        again.stderr
    );
    assert_eq!(again.json(), document);
}

#[test]
fn runs_of_another_date_are_a_data_problem_of_their_own_and_only_new_runs_are_diagnosed_again() {
    let folder = CampaignFolder::new();
    for (number, date) in [(1, "2024-07-17"), (2, "2024-07-17"), (3, "2024-02-13")] {
        let name = format!("runs/step_{number}.csv");
        folder.write(&name, run_table(number));
        folder.write(
            &format!("{name}.toml"),
            format!("started_at = \"{date}T10:00:00Z\"\n"),
        );
    }
    let arguments = ["diagnose", "--json", "--draws", "199"];
    let document = folder
        .ieap(&[&arguments[..], &["--threads", "1"]].concat())
        .expect(0)
        .json();
    let apart = group(&document, "sample=S1,environment=air,started_at=2024-02-13");
    assert_eq!(apart["verdict"], "data-problem");
    assert_eq!(apart["runs"], serde_json::json!(["runs/step_3.csv"]));
    let sentence = apart["sentence"].as_str().unwrap();
    assert!(sentence.contains("not the same series"), "{sentence}");
    let joined = group(&document, "sample=S1,environment=air");
    assert_eq!(
        joined["runs"],
        serde_json::json!(["runs/step_1.csv", "runs/step_2.csv"])
    );
    assert!(joined["p_misfit"].is_number());

    let afresh = folder
        .ieap(&[&arguments[..], &["--again", "--threads", "2"]].concat())
        .expect(0)
        .json();
    assert_eq!(afresh, document, "the same at any number of threads");

    folder.write("runs/other.csv", run_table(9));
    folder.write("runs/other.csv.toml", "environment = \"vacuum\"\n");
    let more = folder.ieap(&arguments).expect(0);
    assert!(
        more.stderr.contains("2 diagnosed, 5 up to date"),
        "{}",
        more.stderr
    );
    let one = folder
        .ieap(&[
            "diagnose",
            "--json",
            "--draws",
            "199",
            "--group",
            "sample=S1,environment=vacuum",
        ])
        .expect(0)
        .json();
    assert_eq!(one["groups"].as_array().unwrap().len(), 1);
    assert_eq!(one["runs"][0]["run"], "runs/other.csv");
    // The name that is printed means the same group.
    let printed = folder.ieap(&["diagnose", "--draws", "199", "--group", "S1 in vacuum"]);
    let heading = printed.expect(0).stdout;
    assert!(heading.starts_with("S1 in vacuum (1 run): "), "{heading}");
    let rival = folder.ieap(&["diagnose", "--model", "maxwell"]).expect(2);
    assert!(
        rival.stderr.contains("maxwell cannot be diagnosed") && rival.stderr.contains("lumped-1, lumped-2"),
        "{rival:#?}"
    );
    let unknown = folder.ieap(&["diagnose", "--group", "nothing"]).expect(2);
    assert!(unknown.stderr.contains("S1 in vacuum"), "{}", unknown.stderr);
}

#[test]
fn group_by_is_checked_and_a_key_that_no_run_carries_is_said() {
    let folder = CampaignFolder::new();
    let toml = |keys: &str| {
        crate::campaign::CAMPAIGN_TOML.replace("id = \"test\"", &format!("id = \"test\"\ngroup_by = {keys}"))
    };
    folder.write("campaign.toml", toml("[\"sample\", \"sample\"]"));
    let refused = folder.ieap(&["diagnose"]).expect(2);
    assert!(
        refused.stderr.contains("group_by") && refused.stderr.contains("twice"),
        "{}",
        refused.stderr
    );
    folder.write("campaign.toml", toml("[\"sample\", \"labratory\"]"));
    folder.write("runs/a.csv", run_table(1));
    let said = folder.ieap(&["diagnose", "--draws", "99"]).expect(0);
    assert!(
        said.stderr.contains("no run carries the tag \"labratory\""),
        "{}",
        said.stderr
    );
    assert!(said.stdout.contains("S1 (1 run)"), "{}", said.stdout);
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn an_adopted_model_is_fitted_to_its_group_and_says_how_wrong_the_base_was() {
    let folder = CampaignFolder::new();
    folder.write("campaign.toml", CAMPAIGN);
    std::fs::remove_file(folder.join("runs/tags.toml")).unwrap();
    folder.write("simulation.toml", spec());
    ieap(folder.path(), &["simulate", "simulation.toml"]).expect(0);
    let clean = folder.ieap(&["diagnose", "--adopt", "--group", "sample=clean,environment=air"]);
    assert!(clean.expect(2).stderr.contains("tells what is missing"));

    let adopted = folder.ieap(&["diagnose", "--adopt"]).expect(0);
    assert!(
        adopted.stderr.contains("adopted in campaign.toml"),
        "{}",
        adopted.stderr
    );
    let file = std::fs::read_to_string(folder.join("campaign.toml")).unwrap();
    assert!(
        file.starts_with(CAMPAIGN) && file.matches("[[adopted]]").count() == 1,
        "{file}"
    );
    let again = folder.ieap(&["diagnose", "--adopt"]).expect(0);
    assert!(again.stderr.contains("has its model already"), "{}", again.stderr);
    let nothing = folder.ieap(&["run", "--json"]).expect(0).json();
    assert_eq!(nothing["run"]["fit"]["fitted"], 0, "what is adopted stays fitted");
    let report = std::fs::read_dir(folder.join("report/findings")).unwrap();
    let pages: Vec<String> = report
        .map(|entry| std::fs::read_to_string(entry.unwrap().path()).unwrap_or_default())
        .collect();
    assert!(pages.iter().any(|page| page.contains("Adopted in campaign.toml")));

    // Of so few voltages the shape of the leak is not told: a free curve of it is adopted, which has R_ss in it. One who knows that
    // it is faradaic says so.
    let line = file.lines().find(|line| line.starts_with("model = ")).unwrap();
    assert!(line.contains("leak"), "{file}");
    let file = file.replace(line, "model = \"lumped-2 + faradaic-leak\"");
    folder.write("campaign.toml", &file);
    let document = folder.ieap(&["fit", "--json"]).expect(0).json();
    let fits = document["fits"].as_array().unwrap();
    for fit in fits {
        let leaky = fit["sample"] == "leaky";
        let model = fit["model"].as_str().unwrap();
        assert_eq!(model.starts_with("lumped-2 + "), leaky, "{model}");
    }
    // The truth of the base parameters comes back where the effect is allowed for.
    let leaky = fits
        .iter()
        .find(|fit| fit["run"] == "runs/leaky_2.2V.csv")
        .unwrap();
    for (key, truth) in [
        ("r1_ohm_cm2", 520.0),
        ("c2_f_per_cm2", 0.13),
        ("alpha_per_c_cm", 14.0),
        ("lambda_per_s", 4e-3),
    ] {
        let found = &leaky["parameters"][key];
        let (value, error) = (
            found["value"].as_f64().unwrap(),
            found["standard_error"].as_f64().unwrap(),
        );
        assert!(
            (value - truth).abs() < 4.0 * error && error < 0.1 * truth,
            "{key}: {found}"
        );
    }
    let notes = leaky["issues"]
        .as_array()
        .unwrap()
        .iter()
        .map(|issue| issue["code"].as_str().unwrap());
    let notes: Vec<&str> = notes.collect();
    assert!(
        notes.contains(&"shared-parameters") && notes.contains(&"base-parameter-was-wrong"),
        "{notes:?}"
    );

    folder.write(
        "campaign.toml",
        file + "\n[[adopted]]\ngroup = \"sample=gone\"\nmodel = \"lumped-2\"\n",
    );
    let stale = folder.ieap(&["fit"]).expect(0);
    assert!(
        stale.stderr.contains("there is no group \"sample=gone\""),
        "{}",
        stale.stderr
    );
    let unknown = folder.ieap(&["fit", "--model", "lumped-2 + faradaic"]).expect(2);
    assert!(
        unknown.stderr.contains("did you mean \"faradaic-leak\""),
        "{}",
        unknown.stderr
    );
}

#[test]
fn a_model_with_an_effect_that_cannot_act_is_not_fitted_under_its_name() {
    let folder = CampaignFolder::new();
    folder.write(
        "campaign.toml",
        CAMPAIGN.replace("length_mm = 5.0\nwidth_mm = 2.0", "area_cm2 = 0.1"),
    );
    std::fs::remove_file(folder.join("runs/tags.toml")).unwrap();
    folder.write("simulation.toml", spec());
    ieap(folder.path(), &["simulate", "simulation.toml"]).expect(0);
    let fit = |model: &str| folder.ieap(&["fit", "--json", "--model", model]).expect(0);
    let without = fit("lumped-2 + tip-formula");
    assert_eq!(without.json()["fits"].as_array().unwrap().len(), 0);
    assert!(
        without.stderr.contains("cannot act in these runs"),
        "{}",
        without.stderr
    );
    let with = fit("lumped-2 + camera-zero").json();
    let fits = with["fits"].as_array().unwrap();
    assert_eq!(fits.len(), 10);
    for fit in fits {
        assert_eq!(fit["converged"], true);
        assert!(
            !fit["parameters"]["camera-zero.offset_per_cm"].is_null(),
            "{fit:#}"
        );
    }
}

#[test]
fn status_says_which_findings_wait() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.ieap(&["fit"]).expect(0);
    let lists = |of: &str| {
        let status = folder.ieap(&["status", "--json"]).expect(0).json();
        status["status"][of].as_array().unwrap().clone()
    };
    assert_eq!(lists("groups_not_diagnosed"), ["sample=S1,environment=air"]);
    // Draws and seed are the user's choice, and no reason to ask again.
    folder
        .ieap(&["diagnose", "--draws", "99", "--seed", "7"])
        .expect(0);
    assert_eq!(lists("groups_not_diagnosed").len(), 0);
    assert_eq!(lists("findings_out_of_date").len(), 0);
    folder.write("runs/b.csv", run_table(2));
    folder.ieap(&["ingest"]).expect(0);
    assert_eq!(lists("findings_out_of_date"), ["sample=S1,environment=air"]);
    // The new run waits for its fit, and nothing is wrong with it.
    let waiting = lists("not_fitted");
    assert_eq!(waiting.len(), 1);
    assert_eq!(waiting[0]["path"], "runs/b.csv");
    let issues = waiting[0]["issues"].as_array().unwrap();
    assert_eq!(issues.last().unwrap()["code"], "not-fitted-yet", "{issues:?}");
    // What the study asks needs fits: a diagnosis makes them first.
    folder.ieap(&["diagnose", "--draws", "99"]).expect(0);
    assert_eq!(lists("findings_out_of_date").len(), 0);
    assert_eq!(lists("not_fitted").len(), 0);
}

#[test]
fn a_diagnosis_made_in_turns_ends_as_one_made_at_once() {
    let folder = CampaignFolder::new();
    for run in 1..4 {
        folder.write(&format!("runs/{run}.csv"), run_table(run));
        folder.write(
            &format!("runs/{run}.csv.toml"),
            format!("relative_humidity_percent = {}\n", 20 * run),
        );
    }
    folder.run_json();
    let verb = DiagnoseRuns {
        choice: DiagnoseChoice {
            draws: Some(199),
            ..DiagnoseChoice::default()
        },
        ..DiagnoseRuns::default()
    };
    let mut context = Context::open(folder.path(), false).unwrap();
    let sentences = |context: &Context| -> Vec<(String, String)> {
        let stored = context.store.diagnoses().unwrap();
        stored
            .into_iter()
            .map(|one| (one.origin.name, one.diagnosed.found.sentence))
            .collect()
    };
    // Each turn may begin one group: it is asked once before the batch and once before each group.
    let mut left = Vec::new();
    for _ in 0..3 {
        let asked = AtomicUsize::new(0);
        let may_go_on = || asked.fetch_add(1, Ordering::SeqCst) < 2;
        let summary = verb
            .run_while(&mut context, &Silent, &may_go_on, &mut |_| Ok(()))
            .unwrap();
        left.push(summary.left);
    }
    // A group of one run and that run alone are one question.
    assert_eq!(left, [4, 2, 0]);
    let in_turns = sentences(&context);
    let whole = DiagnoseRuns { again: true, ..verb };
    assert_eq!(whole.run(&mut context, &Silent).unwrap().diagnosed, 6);
    assert_eq!(sentences(&context), in_turns);
}
