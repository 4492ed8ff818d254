//! `plan` from the command line: its document is as its schema says, and what cannot be asked is told how to be.

use crate::campaign::CampaignFolder;

const SPEC: &str = r#"
[simulation]
seed = 1
folder = "runs"
statement = ["SIMULATED"]
[noise]
current_a = 2e-6
curvature_per_cm = 0.004
[[sampling]]
until_s = 100.0
every_s = 0.25
[[run]]
file = "S_air_1.2V.csv"
area_cm2 = 0.1
voltage_v = 1.2
parameters = { r1_ohm_cm2 = 59.0, c1_f_per_cm2 = 0.001, r2_ohm_cm2 = 130.0, c2_f_per_cm2 = 0.1, rss_ohm_cm2 = 9000.0, alpha_per_c_cm = 24.6, lambda_per_s = 0.02 }
tags = { sample = "S", environment = "air" }
"#;
const CAMPAIGN: &str =
    "[campaign]\nid = \"small\"\n[[sample]]\nid = \"S\"\nmaterial = \"M\"\nlength_mm = 5.0\nwidth_mm = 2.0\n";

fn folder() -> CampaignFolder {
    let folder = CampaignFolder::new();
    folder.write("campaign.toml", CAMPAIGN);
    folder.write("simulation.toml", SPEC);
    folder
}

#[test]
fn a_plan_from_a_file_and_from_an_earlier_run_name_what_stays_open() {
    let folder = folder();
    let of_spec = [
        "plan",
        "--json",
        "--spec",
        "simulation.toml",
        "--every",
        "0.25s",
        "--draws",
        "4",
    ];
    let document = folder.ieap(&of_spec).expect(0).json();
    assert_eq!(document["schema"], "ieap/plan/1");
    let answer = document["answer"].to_string();
    assert!(
        answer.contains("the branch of 59 ms is faster than a reading every 0.25 s"),
        "{answer}"
    );
    assert_eq!(document["parameters"][0]["key"], "r1_ohm_cm2");
    assert_ne!(document["parameters"][0]["verdict"], "determined");

    folder.ieap(&["simulate", "simulation.toml"]).expect(0);
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let run = "runs/S_air_1.2V.csv";
    let of_run = folder
        .ieap(&["plan", "--run", run, "--every", "0.2s", "--draws", "4"])
        .expect(0);
    assert!(
        of_run.stdout.starts_with("This run determines "),
        "{}",
        of_run.stdout
    );
    assert!(
        of_run.stdout.contains(&format!("those of {run} (lumped-2)")),
        "{}",
        of_run.stdout
    );
    let larger = [
        "plan",
        "--json",
        "--sample",
        "S",
        "--voltage",
        "2V",
        "--length",
        "10mm",
        "--every",
        "1s",
        "--draws",
        "2",
    ];
    let document = folder.ieap(&larger).expect(0).json();
    let area_cm2 = document["area_cm2"].as_f64().unwrap();
    assert!((area_cm2 - 0.2).abs() < 1e-12, "{area_cm2}");
}

#[test]
fn what_cannot_be_asked_is_told_how_to_be() {
    let folder = folder();
    let spec = ["plan", "--spec", "simulation.toml"];
    let cases: [(&[&str], &str); 5] = [
        (&["--every", "-1s"], "a time above 0 between readings, as 0.25s"),
        (
            &["--every", "1s", "--for", "1s"],
            "2 s or more at a reading every 1 s",
        ),
        (&["--every", "1s", "--run", "other.csv"], "S_air_1.2V.csv"),
        (&["--every", "1s", "--voltage", "0V"], "a step, as 1.2V"),
        (&["--every", "1s", "--draws", "0"], "needed 1 or more"),
    ];
    for (more, needed) in cases {
        let said = folder.ieap(&[&spec[..], more].concat()).expect(2).stderr;
        assert!(said.contains(needed), "{said}");
    }
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let said = folder
        .ieap(&["plan", "--run", "runs/none.csv", "--every", "1s"])
        .expect(2)
        .stderr;
    assert!(said.contains("`ieap status` lists the runs"), "{said}");
}

#[test]
fn a_plan_of_a_study_says_how_many_campaigns_see_a_change_and_what_that_rests_on() {
    let folder = folder();
    let asked = |more: &[&str]| {
        let plan = [
            "plan", "--study", "--strips", "1,2,4", "--change", "30", "--draws", "20",
        ];
        folder.ieap(&[&plan[..], &["--repeats", "2"], more].concat())
    };
    let document = asked(&["--json"]).expect(0).json();
    assert_eq!(document["schema"], "ieap/study-plan/1");
    let seen = document["seen"].as_array().unwrap();
    assert_eq!(seen.len(), 6, "{seen:#?}");
    let number = |at: usize, of: &str| seen[at][of].as_u64();
    assert_eq!(
        (number(0, "strips"), number(0, "of_material")),
        (Some(1), None),
        "{seen:#?}"
    );
    assert!(number(2, "of_material") >= number(1, "of_material"), "{seen:#?}");
    assert_eq!(document["scatter"][0]["materials"], 0);
    let said = asked(&[]).expect(0).stdout;
    assert!(
        said.starts_with("Any parameter, changed by 30 % from one environment to another: seen of the material with 2 strips in ")
            && said.contains("Assumed, for no material has repeats on two strips in two environments: "),
        "{said}"
    );
    let refused = folder.ieap(&["plan", "--study", "--strips", "0"]).expect(2);
    assert!(refused.stderr.contains("--strips"), "{}", refused.stderr);
    folder.ieap(&["plan", "--study", "--every", "1s"]).expect(2);
}
