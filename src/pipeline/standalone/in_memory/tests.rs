//! Readings at hand come to the same bytes as in a campaign.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use super::*;
use crate::domain::{AskedFit, Drive, Level, Segment};
use crate::pipeline::campaign::standing;
use crate::pipeline::documents::diagnosis::diagnosis_document;
use crate::pipeline::documents::fits::fits_document;
use crate::pipeline::fits::instruments::Told;
use crate::pipeline::fits::plan::fit_plan;
use crate::pipeline::show::plain_tables::{plain_table, stored_readings};
use crate::pipeline::standalone::simulate::{Noise, Simulate};
use crate::pipeline::{Context, DiagnoseChoice, DiagnoseRuns, FitChoice, FitRuns, Ingest, Silent};
use crate::store::ResultKind;
use crate::truth::HiddenEffect;

const CAMPAIGN: &str =
    "[campaign]\nid = \"small\"\n[[sample]]\nid = \"S\"\nmaterial = \"M\"\nlength_mm = 5.0\nwidth_mm = 2.0\n";
const SPEC: &str = r#"
[simulation]
seed = 7
folder = "runs"
statement = ["SIMULATED"]
baseline_s = 10.0
[noise]
current_a = 2e-6
curvature_per_cm = 0.004
[[sampling]]
until_s = 300.0
every_s = 1.0
[[run]]
file = "a.csv"
area_cm2 = 0.1
voltage_v = 1.5
parameters = { r1_ohm_cm2 = 30.0, c1_f_per_cm2 = 0.02, r2_ohm_cm2 = 300.0, c2_f_per_cm2 = 0.03, rss_ohm_cm2 = 9000.0, alpha_per_c_cm = 120.0, lambda_per_s = 0.002 }
tags = { sample = "S", environment = "air" }
[[run]]
file = "b.csv"
area_cm2 = 0.1
voltage_v = 2.0
parameters = { r1_ohm_cm2 = 30.0, c1_f_per_cm2 = 0.02, r2_ohm_cm2 = 300.0, c2_f_per_cm2 = 0.03, rss_ohm_cm2 = 9000.0, alpha_per_c_cm = 120.0, lambda_per_s = 0.002 }
tags = { sample = "S", environment = "air" }
"#;

/// A campaign of two simulated runs, fitted.
fn campaign(folder: &Path) -> Context {
    campaign_of(folder, SPEC)
}

fn campaign_of(folder: &Path, runs: &str) -> Context {
    fs::write(folder.join("campaign.toml"), CAMPAIGN).unwrap();
    let spec = folder.join("simulation.toml");
    fs::write(&spec, runs).unwrap();
    let simulate = Simulate {
        spec,
        seed: None,
        overwrite: false,
    };
    simulate.run(&Silent).unwrap();
    let mut context = Context::open(folder, false).unwrap();
    Ingest { ready: &mut |_| true }
        .run(&mut context, &Silent)
        .unwrap();
    FitRuns::default().run(&mut context, &Silent).unwrap();
    context
}

fn strip() -> Stated {
    Stated {
        strip: Strip {
            length_mm: Some(5.0),
            width_mm: Some(2.0),
            ..Strip::default()
        },
        ..Stated::default()
    }
}

fn run_of_file(file: &Path, name: &str) -> RunAtHand {
    let table = read(file).unwrap().unwrap().remove(0);
    RunAtHand::new(name, &table, &strip()).unwrap()
}

#[test]
fn a_fit_of_a_file_and_of_arrays_is_the_campaigns() {
    let folder = tempfile::tempdir().unwrap();
    // Alone of its instrument, as readings are that no campaign holds.
    let alone = SPEC.replacen(r#""air" }"#, r#""air", instrument = "own" }"#, 1);
    let context = campaign_of(folder.path(), &alone);
    let stored = &fits_document(&context).unwrap().fits[0];
    let options = fit_options(&FitChoice::default()).unwrap();

    let of_file = fit(
        &run_of_file(&folder.path().join("runs/a.csv"), "runs/a.csv"),
        &options,
        &[],
    )
    .unwrap()
    .1;
    assert_eq!(of_file.parameters, stored.parameters);
    assert_eq!(of_file.data_hash, stored.data_hash);
    assert_eq!(
        (&of_file.noise, of_file.n_samples),
        (&stored.noise, stored.n_samples)
    );
    assert!(
        of_file.issues.iter().all(|issue| stored.issues.contains(issue)),
        "{:?}",
        of_file.issues
    );

    let (table, stated) = stored_readings(&context, "runs/a.csv").unwrap();
    let columns = ["time_s", "voltage_v", "current_a", "curvature_per_cm"];
    let time_s = table.channels[0].time_s.to_vec();
    let values = table.channels.iter().map(|channel| channel.values.to_vec());
    let columns = columns
        .iter()
        .zip([time_s].into_iter().chain(values))
        .map(|(name, numbers)| Column::new((*name).to_owned(), numbers));
    let arrays = arrays(columns.collect()).unwrap();
    let of_arrays = fit(&RunAtHand::new("b", &arrays, &strip()).unwrap(), &options, &[])
        .unwrap()
        .1;
    assert_eq!(
        (&of_arrays.parameters, &of_arrays.data_hash),
        (&stored.parameters, &stored.data_hash)
    );
    let of_store = fit(&RunAtHand::new("c", &table, &stated).unwrap(), &options, &[])
        .unwrap()
        .1;
    assert_eq!(of_store.parameters, stored.parameters);
    assert_eq!(of_store.input_hash, of_file.input_hash);
}

/// As the table for clusters has it, of readings and how they are fitted.
fn row_of(context: &Context, at: usize) -> CampaignRow {
    let run = standing::speaking(context).unwrap().remove(at);
    let task = context.store.fit_tasks().unwrap().remove(at);
    let stored = fits_document(context).unwrap().fits.remove(at);
    let plan = fit_plan(context, &AskedFit::default()).unwrap();
    let planned = plan.single.iter().find(|own| own.task.path == task.path).unwrap();
    CampaignRow {
        noise: Told::default().to(context, planned).unwrap(),
        run: run.path.clone(),
        data_hash: run.data_hash.clone(),
        input_hash: context
            .store
            .result_keys(ResultKind::Fit)
            .unwrap()
            .remove(&task.path)
            .unwrap(),
        area_cm2: task.area_cm2,
        length_cm: task.length_cm,
        electrode_resistance_ohm_per_sq: task.electrode_resistance_ohm_per_sq,
        electrode_resistance_error_ohm_per_sq: task.electrode_resistance_error_ohm_per_sq,
        drive: task.drive,
        channels: context.store.channels(run.id).unwrap(),
        chosen: AskedFit {
            model: Some(stored.model),
            method: Some("variable-projection".to_owned()),
            simultaneous: Some(false),
            seed: None,
            ..AskedFit::default()
        },
    }
}

#[test]
fn a_row_of_a_campaign_is_fitted_as_that_fits_it_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let context = campaign(folder.path());
    let row = row_of(&context, 0);
    let (stated, result) = row.fit(&FitChoice::default());
    let stored = &fits_document(&context).unwrap().fits[0];
    assert_eq!(stated.unwrap().parameters, stored.parameters);
    assert_eq!((&result.run, &result.input_hash), (&stored.run, &row.input_hash));
    assert!(result.fit.is_some() && result.issue.is_none() && result.asked.is_open());

    let other = FitChoice {
        model: Some("lumped-1".to_owned()),
        ..FitChoice::default()
    };
    let (stated, result) = row.fit(&other);
    assert_eq!(stated.unwrap().model, "lumped-1");
    assert!(result.input_hash != row.input_hash && result.asked.model.as_deref() == Some("lumped-1"));

    let changed = CampaignRow {
        area_cm2: 2.0 * row.area_cm2,
        ..row
    };
    let (refused, result) = changed.fit(&FitChoice::default());
    let refused = refused.unwrap_err();
    assert_eq!((&*refused.code, &*refused.place), ("other-input", "input_hash"));
    assert!(result.fit.is_none() && result.issue.is_some());
}

#[test]
fn a_diagnosis_is_that_of_a_campaign_of_one_group() {
    let folder = tempfile::tempdir().unwrap();
    let mut context = campaign(folder.path());
    let choice = DiagnoseChoice {
        draws: Some(99),
        ..DiagnoseChoice::default()
    };
    let verb = DiagnoseRuns {
        choice: choice.clone(),
        ..DiagnoseRuns::default()
    };
    verb.run(&mut context, &Silent).unwrap();
    let document = diagnosis_document(&context, &choice, None).unwrap();
    let runs = ["runs/a.csv", "runs/b.csv"].map(|name| run_of_file(&folder.path().join(name), name));
    let found = diagnose(&document.groups[0].group, &[&runs[0], &runs[1]], &choice)
        .unwrap()
        .unwrap();
    // The document leaves out what is drawn.
    let told = |group| serde_json::to_value(group).unwrap();
    assert_eq!(told(&found), told(&document.groups[0]));

    let twice = diagnose("twice", &[&runs[0], &runs[0]], &choice)
        .unwrap()
        .unwrap_err();
    assert_eq!(twice.code, "name-twice");
    let again = run_of_file(&folder.path().join("runs/a.csv"), "again");
    let same = diagnose("same", &[&runs[0], &again], &choice)
        .unwrap()
        .unwrap_err();
    assert_eq!(same.code, "same-readings");
}

#[test]
fn simulated_curves_are_those_of_the_run_file() {
    let folder = tempfile::tempdir().unwrap();
    campaign(folder.path());
    let text = fs::read_to_string(folder.path().join("runs/a.csv")).unwrap();
    let rows: Vec<Vec<&str>> = text
        .lines()
        .skip(2)
        .map(|line| line.split(',').collect())
        .collect();
    let curves = simulate(&asked(Vec::new())).unwrap();
    assert_eq!(rows.len(), curves.time_s.len());
    for (index, row) in rows.iter().enumerate() {
        assert_eq!(row[1], curves.voltage_v[index].to_string());
        assert_eq!(row[2], format!("{:.5e}", curves.current_a[index]));
        assert_eq!(row[3], format!("{:.5}", curves.curvatures[0].per_cm[index]));
    }
}

fn asked(effects: Vec<HiddenEffect>) -> CurvesAsked {
    let parameters = [
        ("r1_ohm_cm2", 30.0),
        ("c1_f_per_cm2", 0.02),
        ("r2_ohm_cm2", 300.0),
        ("c2_f_per_cm2", 0.03),
        ("rss_ohm_cm2", 9000.0),
        ("alpha_per_c_cm", 120.0),
        ("lambda_per_s", 0.002),
    ];
    CurvesAsked {
        model: "lumped-2".to_owned(),
        places_mm: Vec::new(),
        parameters: parameters
            .iter()
            .map(|(key, value)| ((*key).to_owned(), *value))
            .collect(),
        strip: Strip {
            area_cm2: Some(0.1),
            ..Strip::default()
        },
        baseline_v: 0.0,
        drive: vec![(0.0, Some(1.5))],
        effects,
        noise: Noise {
            current_a: 2e-6,
            curvature_per_cm: 0.004,
            ..Noise::default()
        },
        seed: 7,
        time_s: (-10..=300).map(f64::from).collect(),
    }
}

#[test]
fn what_is_missing_or_wrong_is_said_with_its_remedy() {
    let columns = |voltage_v: Option<f64>| {
        let time_s: Vec<f64> = (0..50).map(f64::from).collect();
        let column = |name: &str, numbers| Column::new(name.to_owned(), numbers);
        let mut columns = vec![
            column("time_s", time_s.clone()),
            column("current_a", vec![1e-3; 50]),
        ];
        columns.extend(voltage_v.map(|v| column("voltage_v", vec![v; 50])));
        arrays(columns).unwrap()
    };
    let area = RunAtHand::new("a", &columns(Some(1.0)), &Stated::default()).unwrap_err();
    assert_eq!((&*area.code, &*area.place), ("no-area", "area_cm2"));
    let drive = RunAtHand::new("a", &columns(None), &strip()).unwrap_err();
    assert!(
        drive.code == "no-drive" && drive.mend.contains("voltage_v"),
        "{drive:?}"
    );
    let stated = Stated {
        drive: Some(Drive {
            baseline_v: 0.0,
            segments: vec![
                Segment::at(0.0, Level::Voltage(2.0)),
                Segment::at(20.0, Level::OpenCircuit),
            ],
        }),
        ..strip()
    };
    let run = RunAtHand::new("a", &columns(None), &stated).unwrap();
    assert_eq!(run.drive().segments[1].level, Level::OpenCircuit);
    let train = cycles(&run).unwrap_err();
    assert!(
        train.code == "no-train" && train.mend.contains("voltage"),
        "{train:?}"
    );
    let spectrum = impedance(&columns(None), &[]).unwrap_err();
    assert!(
        spectrum.code == "one-spectrum" && spectrum.mend.contains("frequency_hz"),
        "{spectrum:?}"
    );
    let of_group = FitChoice {
        model: Some("lumped-2 + faradaic-leak".to_owned()),
        ..FitChoice::default()
    };
    assert_eq!(fit_options(&of_group).unwrap_err().code, "model-of-group");
    let nonsense = HiddenEffect {
        id: "no-such-effect".to_owned(),
        variant: None,
        parameters: BTreeMap::new(),
    };
    assert_eq!(simulate(&asked(vec![nonsense])).unwrap_err().code, "bad-effect");
    let still = CurvesAsked {
        time_s: vec![1.0, 1.0],
        ..asked(Vec::new())
    };
    let still = simulate(&still).unwrap_err();
    assert_eq!((&*still.code, &*still.place), ("bad-value", "time_s"));
    let unknown = FitChoice {
        model: Some("no-such-model".to_owned()),
        ..FitChoice::default()
    };
    assert_eq!(fit_options(&unknown).unwrap_err().code, "not-known");
    let none = diagnose("none", &[], &DiagnoseChoice::default()).unwrap();
    assert_eq!(none.unwrap_err().code, "no-runs");
}

#[test]
fn what_a_model_does_not_describe_is_said() {
    let with = |model: &str, keys: &[&str], drive: &[(f64, Option<f64>)]| {
        let mut asked = asked(Vec::new());
        asked.model = model.to_owned();
        asked.parameters = keys.iter().map(|key| ((*key).to_owned(), 1.0)).collect();
        asked.drive = drive.to_vec();
        asked.strip.length_mm = Some(5.0);
        simulate(&asked)
    };
    let along = ["rc_ohm_cm2", "c_f_per_cm2"];
    let open = with("distributed", &along, &[(0.0, Some(1.0)), (9.0, None)]).unwrap_err();
    assert_eq!((&*open.code, &*open.place), ("bad-drive", "drive"));
    // Without a place there is a current, and no curvature.
    let held = with("distributed", &along, &[(0.0, Some(1.0))]).unwrap();
    assert!(held.curvatures.is_empty() && held.current_a.len() == held.time_s.len());
    let bent = [
        "alpha_final_per_c_cm",
        "e1_per_e0_per_s",
        "e2_per_e0",
        "stiffening_rate_per_s",
    ];
    let again = [(0.0, Some(1.0)), (9.0, Some(0.0))];
    let several = with("yagasaki-tamagawa", &bent, &again).unwrap_err();
    assert_eq!((&*several.code, &*several.place), ("bad-drive", "drive"));
    let lacking = with("yagasaki-tamagawa", &bent[1..], &again[..1]).unwrap_err();
    assert!(lacking.message.contains("alpha_final_per_c_cm"), "{lacking:?}");
}

#[test]
fn what_is_stated_and_cannot_both_hold_names_both() {
    let two_areas = Stated {
        strip: Strip {
            area_cm2: Some(0.3),
            ..strip().strip
        },
        ..Stated::default()
    };
    let issue = two_areas.contradiction().unwrap();
    assert_eq!(issue.code, "contradiction");
    assert!(
        issue.message.contains("0.3 cm2") && issue.message.contains("5 mm x 2 mm"),
        "{issue:?}"
    );
    let rounded = Stated {
        strip: Strip {
            area_cm2: Some(0.1001),
            ..strip().strip
        },
        ..Stated::default()
    };
    assert_eq!(rounded.contradiction(), None);
    let tag = |key: &str, value: &str| BTreeMap::from([(key.to_owned(), value.to_owned())]);
    let of_drive = |voltage_v: &str| Stated {
        drive: Some(Drive::step(1.5)),
        tags: tag("voltage_v", voltage_v),
        ..strip()
    };
    let issue = of_drive("2").contradiction().unwrap();
    assert!(
        issue.message.contains("2 V") && issue.message.contains("1.5 V"),
        "{issue:?}"
    );
    assert_eq!(of_drive("1.5").contradiction(), None);
    let slip = Stated {
        tags: tag("humidty", "40"),
        ..strip()
    };
    let issue = slip.misspelt().next().unwrap();
    assert!(
        issue.message.contains("humidty") && issue.mend.contains("relative_humidity_percent"),
        "{issue:?}"
    );
}

#[test]
fn a_strip_that_cannot_be_is_not_simulated() {
    let with = |key: &str, value: f64| {
        let mut asked = asked(Vec::new());
        asked.parameters.insert(key.to_owned(), value);
        simulate(&asked)
    };
    for (key, value) in [
        ("r1_ohm_cm2", -1.0),
        ("c2_f_per_cm2", f64::NAN),
        ("rss_ohm_cm2", 0.0),
        ("lambda_per_s", -0.1),
    ] {
        let issue = with(key, value).unwrap_err();
        assert!(issue.place.contains(key), "{key}: {issue:?}");
    }
    let alone = with("r3_ohm_cm2", 10.0).unwrap_err();
    assert!(
        alone.message.contains("r3_ohm_cm2 without c3_f_per_cm2"),
        "{alone:?}"
    );
}

#[test]
fn tables_of_a_campaign_are_plain_columns() {
    let folder = tempfile::tempdir().unwrap();
    let context = campaign(folder.path());
    let runs = plain_table(&context, "runs").unwrap();
    assert!(
        runs.iter().any(|column| column.name == "run"),
        "{:?}",
        runs.iter().map(|c| &c.name).collect::<Vec<_>>()
    );
    assert!(plain_table(&context, "nothing").is_err());
    assert!(
        stored_readings(&context, "a.csv").is_err(),
        "a run has its whole name"
    );
}
