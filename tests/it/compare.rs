//! Models held against each other: the verb on files, what is stored, and what the report, the table and the figure show.

use ieap::analysis::tables::named;
use ieap::domain::testing::branch;
use ieap::domain::{ComparedCurve, Drive, ModelScore, Quantity, ResponseScore, RunComparison};
use ieap::model::bending::{ChargeCourse, curvature_per_cm};
use ieap::model::{EquivalentCircuit, rival_law};
use ieap::report::pages::PAGES;
use ieap::report::print_figures::{FigureInput, figure_format_named, figure_named};
use ieap::report::tables::format_named;
use ieap::report::{Input, Site};

use crate::campaign::CampaignFolder;
use crate::report_fixture::{MadeUpCurves, input};

use super::page_outline::outline;

/// Current and curvature of a strip that keeps a third of its bending, as a file with a little noise.
fn keeping(step_v: f64, seed: u32) -> String {
    let circuit = EquivalentCircuit {
        branches: vec![branch(200.0, 0.05), branch(900.0, 0.1)],
        steady_state_resistance_ohm_cm2: 20_000.0,
    }
    .with_relaxation(1.0, 0.0);
    let (area_cm2, drive) = (0.1, Drive::step(step_v));
    let time_s: Vec<f64> = (-20..600).map(|k| 2.0 * f64::from(k)).collect();
    let charge = ChargeCourse::new(&circuit, &drive, area_cm2, &time_s);
    let law = rival_law("bao-two-way").expect("a rival");
    let bent = curvature_per_cm(law, &charge, &[15.0, 5.0], &[1.0 / 250.0]);
    let current = circuit.current_a(&drive, area_cm2, &time_s);
    let mut state = seed;
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1u32 << 24) - 0.5
    };
    let mut text = String::from("time_s,voltage_v,current_a,curvature_per_cm\n");
    for (k, t) in time_s.iter().enumerate() {
        let volts = if *t >= 0.0 { step_v } else { 0.0 };
        let (i, bent) = (current[k] + 4e-6 * noise(), bent[k] + 2e-3 * noise());
        text += &format!("{t},{volts},{i:.6e},{bent:.6}\n");
    }
    text
}

const MODELS: &str = "lumped-2,bao-two-way,maxwell";

#[test]
fn the_model_that_made_the_runs_is_named_and_stored() {
    let folder = CampaignFolder::new();
    folder.write("runs/low.csv", keeping(1.2, 7));
    folder.write("runs/high.csv", keeping(2.0, 8));
    let ended = folder.ieap(&["compare", "--models", MODELS]).expect(0);
    assert!(
        ended
            .stdout
            .starts_with("CNaf in air (2 runs): bao-two-way leaves 1.0 times the noise"),
        "{ended:#?}"
    );
    assert!(ended.stdout.contains("It is the best by BIC."), "{ended:#?}");
    assert!(
        ended.stderr.contains("2 runs compared, 0 up to date"),
        "{ended:#?}"
    );
    let again = folder.ieap(&["compare", "--models", MODELS, "--json"]).expect(0);
    assert!(
        again.stderr.contains("0 runs compared, 2 up to date"),
        "{again:#?}"
    );
    let document = again.json();
    assert_eq!(document["schema"], "ieap/comparison/1");
    let models = document["conditions"][0]["models"].as_array().expect("models");
    let of = |id: &str, key: &str| {
        let model = models.iter().find(|model| model["model"] == id).expect("a model");
        model[key].as_f64().expect("a number")
    };
    assert!((of("bao-two-way", "leaves_curvature") - 1.0).abs() < 0.1);
    assert!(
        (of("bao-two-way", "other_voltages") - 1.0).abs() < 0.3,
        "it is linear in the voltage"
    );
    assert!(of("lumped-2", "leaves_curvature") > 3.0 && of("lumped-2", "bic_beyond_best") > 100.0);
    assert!(of("maxwell", "later") > of("bao-two-way", "later"));
    // What was compared is shown, the campaign's own fits stay.
    folder.run_json();
    assert!(
        folder
            .report("models.html")
            .contains("bao-two-way leaves 1.0 times the noise")
    );
    let table = folder.ieap(&["table", "models", "--format", "csv"]).expect(0);
    let explained = folder.ieap(&["explain", "models", "1", "bic"]).expect(0);
    assert!(
        explained
            .stdout
            .contains("result: comparison of lumped-2 v12, bao-two-way v7, maxwell v7"),
        "{explained:#?}"
    );
    assert!(table.stdout.contains("CNaf,air,bao-two-way"), "{table:#?}");
    folder.ieap(&["figure", "models", "-o", "models.svg"]).expect(0);
    let fits = folder.ieap(&["fit", "--json"]).expect(0).json();
    assert_eq!(fits["fits"][0]["model"], "lumped-2");
    // Other runs are another question.
    folder.write("runs/middle.csv", keeping(1.6, 9));
    let more = folder.ieap(&["compare", "--models", MODELS]).expect(0);
    assert!(more.stderr.contains("3 runs compared"), "{more:#?}");
    folder.ieap(&["verify"]).expect(0);
}

#[test]
fn runs_are_fitted_with_a_rival_as_with_any_model() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", keeping(2.0, 3));
    let fits = folder
        .ieap(&["fit", "--model", "bao-two-way", "--json"])
        .expect(0)
        .json();
    let fit = &fits["fits"][0];
    assert_eq!(fit["model"], "bao-two-way");
    let kept = &fit["parameters"]["kept_part"];
    assert!(
        (kept["value"].as_f64().expect("a value") - 1.0 / 3.0).abs() < 0.02,
        "{kept}"
    );
    folder.run_json();
    let ended = folder.ieap(&["fit", "--group", "--model", "bao-two-way"]);
    assert_eq!(ended.status, 2, "{ended:#?}");
}

#[test]
fn what_cannot_be_compared_is_said() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", "time_s,voltage_v,curvature_per_cm\n0,1,0\n1,1,0.1\n2,1,0.2\n3,1,0.2\n4,1,0.2\n5,1,0.2\n6,1,0.2\n7,1,0.2\n8,1,0.2\n");
    let ended = folder.ieap(&["compare"]).expect(0);
    assert!(ended.stderr.contains("no current to fit"), "{ended:#?}");
    assert!(
        ended.stdout.contains("no run that models could be compared on"),
        "{ended:#?}"
    );
    for (models, said) in [
        ("lumped-9", "lumped-1, lumped-2"),
        ("distributed", "along its length"),
        ("lumped-2,lumped-2", "each model once"),
    ] {
        let ended = folder.ieap(&["compare", "--models", models]).expect(2);
        assert!(ended.stderr.contains(said), "{ended:#?}");
    }
    let figure = folder.ieap(&["figure", "models"]);
    assert!(
        figure.status != 0 && figure.stderr.contains("ieap compare"),
        "{figure:#?}"
    );
}

#[test]
fn simulated_figures_need_no_campaign() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["figure13", "figure16", "figure18"] {
        let file = format!("{name}.svg");
        crate::campaign::ieap(folder.path(), &["figure", name, "-o", &file]).expect(0);
        let drawn = std::fs::read_to_string(folder.path().join(&file)).expect("a figure");
        assert!(drawn.starts_with("<svg") || drawn.starts_with("<?xml"), "{name}");
    }
    crate::campaign::ieap(folder.path(), &["figure", "figure13", "--run", "a.csv"]).expect(2);
}

/// The made-up campaign with three models compared on the runs of CNaf in air.
fn compared_input() -> Input {
    let mut input = input(&["CNaf"], 1);
    let in_air = |path: &str| path.contains("air");
    let score = |model: &str, bic: f64, leaves: f64| ModelScore {
        model: model.to_owned(),
        version: 1,
        parameters: 7,
        bic: Some(bic),
        responses: vec![
            ResponseScore {
                quantity: Quantity::Current,
                readings: 400,
                leaves: 1.01,
                later: Some(1.1),
                other_voltages: Some(30.0),
            },
            ResponseScore {
                quantity: Quantity::Curvature,
                readings: 400,
                leaves,
                later: Some(2.0 * leaves),
                other_voltages: None,
            },
        ],
        missing: None,
        seconds: 0.5,
    };
    let time_s: Vec<f64> = (0..100).map(|k| 10.0 * f64::from(k)).collect();
    let bent = |scale: f64| {
        time_s
            .iter()
            .map(|t| scale * (-t / 400.0).exp())
            .collect::<Vec<f64>>()
    };
    let comparison = |run: &str| RunComparison {
        run: run.to_owned(),
        models: vec![
            score("lumped-2", 900.0, 3.1),
            score("bao-two-way", 210.0, 1.3),
            score("maxwell", 9e5, 40.0),
        ],
        curves: vec![ComparedCurve {
            quantity: Quantity::Curvature,
            noise: 0.004,
            measured: bent(0.3),
            fitted: vec![bent(0.31), bent(0.301), bent(0.2)],
            time_s: time_s.clone(),
        }],
    };
    input.comparisons = input
        .runs
        .iter()
        .filter(|run| in_air(&run.path))
        .map(|run| comparison(&run.path))
        .collect();
    assert!(!input.comparisons.is_empty());
    input.outdated_comparisons = 1;
    input
}

#[test]
fn page_and_table_of_models_compared() {
    let input = compared_input();
    let page = PAGES
        .iter()
        .find(|page| page.file == "models.html")
        .expect("a page");
    assert!((page.is_shown)(&input));
    let content = (page.content)(&Site::new(&input)).expect("its content");
    insta::assert_snapshot!("models_compared", outline(&content.context));
    assert_eq!(content.figures.len(), 1);
    let mut tables = input.of_tables();
    tables.origin = "ieap 0.1.0, change 412";
    let table = named("models").expect("a table").table(&tables);
    let text = (format_named("text").expect("a format").write)(&table);
    insta::assert_snapshot!("models_compared_table", text);
    // Where all of them are out of date, that is said, and not that there are none.
    tables.comparisons = &[];
    let table = named("models").expect("a table").table(&tables);
    assert_eq!(table.remarks.len(), 1, "{:?}", table.remarks);
    assert!(
        table.remarks[0].starts_with("1 comparison, not shown"),
        "{:?}",
        table.remarks
    );
}

#[test]
fn the_figure_of_models_is_drawn_in_every_format() {
    let input = compared_input();
    let site = Site::new(&input);
    let curves = MadeUpCurves::of(&input);
    let draw = |run| {
        let input = FigureInput {
            parameter: None,
            site: &site,
            curves: &curves,
            run,
        };
        figure_named("models").expect("a figure").print(&input, 170.0)
    };
    let print = draw(None).expect("drawn");
    for format in ["svg", "png", "pdf"] {
        let written = (figure_format_named(format).expect("a format").write)(&print, 150.0).expect("written");
        assert!(written.len() > 2000, "{format}");
    }
    let elsewhere = input.runs.iter().position(|run| run.path.contains("vacuum"));
    assert!(draw(elsewhere).is_err_and(|message| message.contains("not compared on that run")));
}
