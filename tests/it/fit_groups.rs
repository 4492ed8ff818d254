//! `ieap run --only fit --group`: runs of one sample in one condition, fitted at once.

use serde_json::Value;

use super::campaign::{CampaignFolder, run_table};

/// Three repeats in air, one run of another environment, and one that has no current.
fn campaign() -> CampaignFolder {
    let folder = CampaignFolder::new();
    for (k, name) in ["a", "b", "c"].iter().enumerate() {
        folder.write(&format!("runs/{name}.csv"), run_table(k as u32));
        folder.write(&format!("runs/{name}.csv.toml"), format!("cycle = {k}\n"));
    }
    folder.write("runs/dry.csv", run_table(7));
    folder.write("runs/dry.csv.toml", "environment = \"inert\"\n");
    let curvature_only: String = run_table(9)
        .lines()
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            format!("{},{},{}\n", cells[0], cells[1], cells[3])
        })
        .collect();
    folder.write("runs/camera.csv", curvature_only);
    folder
}

fn half_width(parameter: &Value) -> f64 {
    (parameter["high_95"].as_f64().unwrap() - parameter["low_95"].as_f64().unwrap()) / 2.0
}

#[test]
fn repeats_share_their_parameters_and_tell_more_than_one() {
    let folder = campaign();
    let document = folder
        .ieap(&["fit", "--json", "--group", "--model", "lumped-1"])
        .expect(0)
        .json();
    assert_eq!(document["schema"], "ieap/fits/1");
    let groups = document["groups"].as_array().unwrap();
    let names: Vec<&str> = groups
        .iter()
        .map(|group| group["group"].as_str().unwrap())
        .collect();
    assert_eq!(
        names,
        ["sample=S1,environment=air", "sample=S1,environment=inert"]
    );
    let air = &groups[0];
    assert_eq!(
        air["runs"],
        serde_json::json!(["runs/a.csv", "runs/b.csv", "runs/c.csv"])
    );
    assert_eq!(air["left_out"][0]["run"], "runs/camera.csv");
    let reason = air["left_out"][0]["issue"]["message"].as_str().unwrap();
    assert!(reason.contains("no current channel"), "{reason}");
    assert!(
        air["converged"].as_bool().unwrap() && air["issues"].as_array().unwrap().is_empty(),
        "{air:#}"
    );
    // Repeats do share: what sharing costs is noise.
    assert_eq!(air["sharing"]["parameters_saved"], 10);
    assert!(air["sharing"]["p"].as_f64().unwrap() > 1e-3, "{}", air["sharing"]);
    // The same estimator of one run: what stands in the campaign is weighed by other kinds of noise.
    let alone = folder
        .ieap(&["fit", "--json", "--profile", "--model", "lumped-1"])
        .expect(0)
        .json();
    let single = alone["groups"]
        .as_array()
        .unwrap()
        .iter()
        .find(|group| group["runs"] == serde_json::json!(["runs/a.csv"]))
        .unwrap();
    for key in [
        "r1_ohm_cm2",
        "c1_f_per_cm2",
        "alpha_per_c_cm",
        "lambda_per_s",
        "tau1_s",
    ] {
        let shared = &air["parameters"][key];
        let gain = half_width(&single["parameters"][key]) / half_width(shared);
        assert!(gain > 1.3 && gain < 2.5, "{key}: {gain}");
        assert_eq!(shared, &air["fits"][2]["parameters"][key], "{key}");
    }
    let tau_s = &air["parameters"]["tau1_s"];
    assert!(
        tau_s["low_95"].as_f64().unwrap() < 20.0 && tau_s["high_95"].as_f64().unwrap() > 20.0,
        "{tau_s}"
    );
    assert_eq!(groups[1]["sharing"], Value::Null, "a single run shares nothing");
}

#[test]
fn profiles_asked_for_are_stated_for_every_run_by_itself() {
    let folder = campaign();
    let document = folder
        .ieap(&["fit", "--json", "--profile", "--model", "lumped-1"])
        .expect(0)
        .json();
    let groups = document["groups"].as_array().unwrap();
    let names: Vec<&str> = groups
        .iter()
        .map(|group| group["group"].as_str().unwrap())
        .collect();
    assert!(
        names.contains(&"run=runs/a.csv") && names.contains(&"run=runs/camera.csv"),
        "{names:?}"
    );
    let of = |entry: &Value| entry["fits"][0]["parameters"]["tau1_s"].clone();
    let profiled = of(groups
        .iter()
        .find(|group| group["group"] == "run=runs/a.csv")
        .unwrap());
    let fits = document["fits"].as_array().unwrap();
    let stored = &fits.iter().find(|fit| fit["run"] == "runs/a.csv").unwrap()["parameters"]["tau1_s"];
    // Both hold the truth, and neither is far wider than the other where the covariance does not mislead.
    for interval in [&profiled, stored] {
        let (low, high) = (
            interval["low_95"].as_f64().unwrap(),
            interval["high_95"].as_f64().unwrap(),
        );
        assert!(low < 20.0 && 20.0 < high, "{interval}");
    }
    let ratio = half_width(&profiled) / half_width(stored);
    assert!(ratio > 0.5 && ratio < 2.0, "{ratio}");
}

#[test]
fn what_is_free_is_stated_for_every_run_and_the_bootstrap_repeats_itself() {
    let folder = campaign();
    let arguments = [
        "fit",
        "--json",
        "--group",
        "--model",
        "lumped-1",
        "--free",
        "rss_ohm_cm2,alpha_per_c_cm",
        "--profile",
        "--bootstrap",
        "60",
        "--seed",
        "5",
    ];
    let document = folder.ieap(&arguments).expect(0).json();
    let air = &document["groups"][0];
    assert_eq!(
        air["shared"],
        serde_json::json!(["r1_ohm_cm2", "c1_f_per_cm2", "lambda_per_s"])
    );
    assert!(air["parameters"].get("alpha_per_c_cm").is_none());
    let values: Vec<f64> = air["fits"]
        .as_array()
        .unwrap()
        .iter()
        .map(|fit| fit["parameters"]["alpha_per_c_cm"]["value"].as_f64().unwrap())
        .collect();
    assert!(
        values.len() == 3 && values[0] != values[1] && values[1] != values[2],
        "{values:?}"
    );
    let resampled = &air["fits"][0]["bootstrap"]["c1_f_per_cm2"];
    let error = air["parameters"]["c1_f_per_cm2"]["standard_error"]
        .as_f64()
        .unwrap();
    let ratio = resampled["standard_deviation"].as_f64().unwrap() / error;
    assert!(
        ratio > 0.5 && ratio < 2.0 && resampled["replicates"].as_u64().unwrap() > 50,
        "{ratio} {resampled}"
    );
    let mut again = arguments.to_vec();
    again.extend(["--threads", "1"]);
    assert_eq!(
        folder.ieap(&again).expect(0).json()["groups"],
        document["groups"],
        "the same at any number of threads"
    );
}

#[test]
fn runs_that_differ_are_said_to_differ_and_group_by_keeps_them_apart() {
    let folder = campaign();
    let slower = run_table(1).replace("e-4", "e-5");
    folder.write("runs/b.csv", slower);
    let document = folder
        .ieap(&["fit", "--json", "--group", "--model", "lumped-1"])
        .expect(0)
        .json();
    let issue = &document["groups"][0]["issues"][0];
    assert_eq!(issue["code"], "group-differs", "{issue}");
    assert!(issue["mend"].as_str().unwrap().contains("--free"));
    let toml = std::fs::read_to_string(folder.join("campaign.toml")).unwrap();
    folder.write(
        "campaign.toml",
        toml.replace(
            "title = \"A test\"",
            "title = \"A test\"\ngroup_by = [\"sample\", \"cycle\"]",
        ),
    );
    let document = folder
        .ieap(&["fit", "--json", "--group", "--model", "lumped-1"])
        .expect(0)
        .json();
    let names: Vec<&str> = document["groups"]
        .as_array()
        .unwrap()
        .iter()
        .map(|group| group["group"].as_str().unwrap())
        .collect();
    assert_eq!(
        names,
        [
            "sample=S1",
            "sample=S1,cycle=0",
            "sample=S1,cycle=1",
            "sample=S1,cycle=2"
        ]
    );
}

#[test]
fn what_cannot_be_asked_for_is_refused_and_says_what_can() {
    let folder = campaign();
    for (arguments, expected) in [
        (
            &["fit", "--group", "--free", "r9_ohm_cm2"][..],
            "those that can are r1_ohm_cm2",
        ),
        (&["fit", "--group", "--shared", "tau1_s"], "cannot be shared"),
        (
            &["fit", "--group", "--model", "distributed"],
            "choose a lumped one",
        ),
        (&["fit", "--group", "--bootstrap", "5"], "needed 40 or more"),
        (&["fit", "--free", "rss_ohm_cm2"], "--group"),
        (
            &["fit", "--group", "--shared", "a", "--free", "b"],
            "cannot be used with",
        ),
    ] {
        let ended = folder.ieap(arguments).expect(2);
        assert!(ended.stderr.contains(expected), "{arguments:?}: {}", ended.stderr);
    }
    let text = folder.ieap(&["fit", "--group", "--model", "lumped-1"]).expect(0);
    for expected in [
        "sample=S1,environment=air",
        "sharing costs",
        "residual current_a",
        "x noise",
    ] {
        assert!(text.stdout.contains(expected), "{expected}: {}", text.stdout);
    }
    assert!(text.stderr.contains("runs/camera.csv"), "{}", text.stderr);
}
