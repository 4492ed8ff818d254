//! Methods that search minima: the thesis's own and the fast one end in the same place, and can be chosen.

use std::path::Path;

use serde_json::json;

use ieap::domain::{Channel, Fit, Quantity};
use ieap::fit::{FitInput, FitOptions, fit_run};
use ieap::pipeline::standalone::simulate::{Spec, run_table};

use super::campaign::{CAMPAIGN_TOML, CampaignFolder, counted, ieap};

/// Current and curvature of a run table.
fn channels(table: &str) -> Vec<Channel> {
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_reader(table.as_bytes());
    let headers = reader.headers().unwrap().clone();
    let column = |name: &str| headers.iter().position(|header| header == name).unwrap();
    let rows: Vec<csv::StringRecord> = reader.records().map(|row| row.unwrap()).collect();
    let channel = |quantity: Quantity| {
        let own = column(quantity.column());
        let readings = rows.iter().filter_map(|row| {
            let value = row[own].parse::<f64>().ok()?;
            Some((row[column("time_s")].parse::<f64>().unwrap(), value))
        });
        let (time_s, values): (Vec<f64>, Vec<f64>) = readings.unzip();
        Channel::new(quantity, time_s.into(), values.into())
    };
    vec![channel(Quantity::Current), channel(Quantity::Curvature)]
}

#[track_caller]
fn assert_same_minimum(one: &Fit, other: &Fit, name: &str) {
    for (a, b) in one.noise.iter().zip(&other.noise) {
        let relative = (a.residual_rms / b.residual_rms).powi(2) - 1.0;
        assert!(
            relative.abs() < 1e-6,
            "{name} {:?}: cost apart by {relative}",
            a.quantity
        );
    }
    for (a, b) in one.parameters.iter().zip(&other.parameters) {
        match (a.estimate.value, b.estimate.value) {
            (Some(x), Some(y)) => {
                let error = a.estimate.standard_error.unwrap();
                assert!(
                    (x - y).abs() < 1e-3 * error,
                    "{name} {}: {x} {y} +- {error}",
                    a.key
                );
            }
            (x, y) => assert_eq!(x.is_some(), y.is_some(), "{name} {}", a.key),
        }
    }
}

#[test]
fn differential_evolution_finds_the_minima_of_the_thesis_campaign() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("campaigns/thesis/simulation.toml");
    let spec = Spec::read(&path).unwrap();
    // Those of table 5; in the others something is hidden that the model does not have.
    let of_table_5 = spec.run.iter().filter(|run| !run.file.starts_with("PtNaf"));
    assert_eq!(of_table_5.clone().count(), 18);
    let fast = FitOptions::default();
    let evolution = fast.with_method("differential-evolution").unwrap();
    for (number, run) in of_table_5.enumerate().step_by(counted(3, 1)) {
        let channels = channels(&run_table(&spec, run, number).unwrap());
        let input = FitInput {
            channels: &channels,
            drive: &run.drive(),
            area_cm2: run.area_cm2,
        };
        let name = run.file.display().to_string();
        let (one, other) = (
            fit_run(&input, &fast).unwrap(),
            fit_run(&input, &evolution).unwrap(),
        );
        assert!(one.converged && other.converged, "{name}: {}", other.why_stopped);
        assert!(
            one.method.starts_with("two-step variable projection"),
            "{}",
            one.method
        );
        assert!(
            other.method.starts_with("two-step differential evolution"),
            "{}",
            other.method
        );
        assert_same_minimum(&one, &other, &name);
        // Every run has its minimum from one seed; another seed, and the same again, for the first of each material.
        if number % 9 != 0 {
            continue;
        }
        let another = FitOptions { seed: 7, ..evolution };
        assert_same_minimum(&other, &fit_run(&input, &another).unwrap(), &name);
        assert_eq!(
            other,
            fit_run(&input, &evolution).unwrap(),
            "{name}: the same seed repeats itself"
        );
    }
}

#[test]
fn the_method_is_chosen_on_the_command_line_and_part_of_what_is_up_to_date() {
    let folder = CampaignFolder::new();
    let mut table = "time_s,current_a,curvature_per_cm\n".to_owned();
    for k in 0..400 {
        let t = k as f64;
        let left = (-t / 50.0).exp();
        let ripple = 1e-6 * ((k * k) as f64).sin();
        let row = format!(
            "{t},{:e},{:e}\n",
            1e-3 * left + 1e-5 + ripple,
            0.2 * (1.0 - left) + 100.0 * ripple
        );
        table.push_str(&row);
    }
    folder.write("runs/S1_2.0V.csv", &table);
    folder.write(
        "runs/tags.toml",
        "sample = \"S1\"\nenvironment = \"air\"\nvoltage_v = 2.0\n",
    );
    let fit = |arguments: &[&str]| {
        let mut all = vec!["run", "--json", "--no-diagnose"];
        all.extend(arguments);
        let document = ieap(folder.path(), &all).expect(0).json();
        document["run"]["fit"]["fitted"].as_u64().unwrap()
    };
    assert_eq!((fit(&[]), fit(&[])), (1, 0));
    let evolution = ["--method", "differential-evolution"];
    assert_eq!((fit(&evolution), fit(&evolution)), (1, 0));
    let seeded = ["--method", "differential-evolution", "--seed", "5"];
    assert_eq!((fit(&seeded), fit(&seeded)), (1, 0));
    assert_eq!(
        fit(&[]),
        0,
        "what was asked for is kept where nothing else is said"
    );
    let kept = ieap(folder.path(), &["run", "--no-diagnose"]).expect(0);
    assert!(
        kept.stderr.contains("1 run: method differential-evolution, kept"),
        "{kept:?}"
    );
    folder.write("runs/S1_2.0V.csv", table.replace("\n3,", "\n3.001,"));
    let changed = ieap(folder.path(), &["run", "--no-diagnose", "--json"])
        .expect(0)
        .json();
    let fits = &changed["run"]["fit"];
    assert_eq!(
        (&fits["fitted"], &fits["choices"][0]["by"]),
        (&json!(1), &json!("kept"))
    );
    let stated = format!("{CAMPAIGN_TOML}[fit]\nsimultaneous = true\nmethod = \"variable-projection\"\n");
    folder.write("campaign.toml", stated);
    let by_campaign = ieap(folder.path(), &["run", "--no-diagnose", "--json"])
        .expect(0)
        .json();
    let fits = &by_campaign["run"]["fit"];
    assert_eq!(
        (&fits["fitted"], &fits["choices"][0]["by"]),
        (&json!(1), &json!("campaign"))
    );
    assert_eq!(fit(&[]), 0);
    let refused = ieap(folder.path(), &["fit", "--method", "guessing"]).expect(2);
    assert!(
        refused
            .stderr
            .contains("variable-projection, differential-evolution"),
        "{refused:?}"
    );
    let models = ieap(folder.path(), &["list", "models", "--json"])
        .expect(0)
        .json();
    assert_eq!(models["methods"][1]["id"], "differential-evolution");
}

#[test]
fn both_responses_can_be_fitted_together() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", super::campaign::run_table(1));
    let steps = folder
        .ieap(&["fit", "--json", "--model", "lumped-1"])
        .expect(0)
        .json();
    let together = folder
        .ieap(&["fit", "--json", "--model", "lumped-1", "--simultaneous"])
        .expect(0)
        .json();
    let of = |document: &serde_json::Value| document["fits"][0]["parameters"]["c_total_f_per_cm2"].clone();
    let (one, other) = (of(&steps), of(&together));
    assert_ne!(one, other);
    let (low, high) = (one["low_95"].as_f64().unwrap(), one["high_95"].as_f64().unwrap());
    let value = other["value"].as_f64().unwrap();
    assert!(low < value && value < high, "{one} {other}");
    let again = folder
        .ieap(&["fit", "--model", "lumped-1", "--simultaneous"])
        .expect(0);
    assert!(again.stderr.contains("0 fitted, 1 up to date"), "{again:?}");
}
