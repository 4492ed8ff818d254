//! Specs that are refused, and what is written for those that are not.

use std::path::Path;

use super::*;
use crate::pipeline::Silent;
use crate::pipeline::infra::error::SpecError;

const HEAD: &str = r#"
[simulation]
seed = 7
folder = "runs"
statement = ["SIMULATED"]
baseline_s = 5.0

[noise]
current_a = 1e-7
curvature_per_cm = 1e-4

[[sampling]]
until_s = 60.0
every_s = 0.5
"#;

const PARAMETERS: &str = "parameters = { r1_ohm_cm2 = 500.0, c1_f_per_cm2 = 0.03, rss_ohm_cm2 = 5000.0, \
                          alpha_per_c_cm = 14.0, lambda_per_s = 2e-3 }";

fn run(file: &str, drive: &str) -> String {
    format!("\n[[run]]\nfile = \"{file}\"\narea_cm2 = 0.1\n{drive}\n{PARAMETERS}\n")
}

fn read(text: &str) -> Result<Spec, SpecError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("spec.toml");
    std::fs::write(&path, text).unwrap();
    Spec::read(&path)
}

fn refused(text: &str) -> String {
    let message = read(text).unwrap_err().to_string();
    message.split_once("spec.toml: ").unwrap().1.to_owned()
}

#[test]
fn specs_that_make_no_sense_are_refused_with_what_would() {
    let step = run("a.csv", "voltage_v = 2.0");
    let with = |effect: &str| refused(&format!("{HEAD}{step}\n[[effect]]\n{effect}\n"));
    assert!(with("id = \"warp\"").starts_with(
        "effect warp: found effect \"warp\" is not known; known are series-resistance, slow-branch, "
    ));
    assert!(
        with("id = \"softening\"\ncubic = 1")
            .contains("parameter \"cubic\" is not known; known are cubic_cm2")
    );
    assert!(
        with("id = \"softening\"\nform = \"tanh\"\ncubic_cm2 = 1.0")
            .contains("form \"tanh\" is not known; known are asinh, stop")
    );
    let unmatched = with("id = \"camera-zero\"\noffset_per_cm = 0.1\nruns = [\"b*\"]");
    assert_eq!(
        unmatched,
        "effect camera-zero: runs: found \"b*\", which no run's file matches, needed a pattern of run files"
    );
    let no_branch = with("id = \"unequal-coupling\"\nratio_change = 0.5");
    assert!(
        no_branch.starts_with("run a.csv: found effect unequal-coupling acts on branch 2"),
        "{no_branch}"
    );
    let both = run(
        "a.csv",
        "voltage_v = 2.0\npulses = { voltage_v = 1, on_s = 5, off_s = 5, count = 3 }",
    );
    assert!(refused(&format!("{HEAD}{both}")).contains("needed one of voltage_v, pulses, wave, and a drive"));
    let empty = run(
        "a.csv",
        "pulses = { voltage_v = 1, on_s = 0, off_s = 5, count = 3 }",
    );
    assert!(refused(&format!("{HEAD}{empty}")).contains("needed on_s and off_s above 0"));
    let loud = format!("{HEAD}{step}").replace("[noise]", "[noise]\noutlier_fraction = 1.5");
    assert!(refused(&loud).starts_with("noise.outlier_fraction: found 1.5"));
}

#[test]
fn pulses_are_segments_with_pauses() {
    let pulses = run(
        "a.csv",
        "baseline_v = 0.5\npulses = { voltage_v = 2, on_s = 10, off_s = 5, count = 2 }",
    );
    let drive = read(&format!("{HEAD}{pulses}")).unwrap().run[0].drive();
    let starts: Vec<f64> = drive.segments.iter().map(|segment| segment.start_s()).collect();
    assert_eq!((drive.baseline_v, starts), (0.5, vec![0.0, 10.0, 15.0, 25.0]));
    assert_eq!(drive.nominal_step_v(), 2.0);
}

#[test]
fn effects_meet_the_runs_that_they_name() {
    let effects = "\n[[effect]]\nid = \"camera-zero\"\noffset_per_cm = 0.1\nruns = [\"*plus*\"]\n\
                   \n[[effect]]\nid = \"series-resistance\"\nseries_resistance_ohm_cm2 = 20\n";
    let own = "\n[[run.effect]]\nid = \"tip-formula\"\napplied = 1\n";
    let runs =
        run("s/plus.csv", "voltage_v = 2.0\nlength_cm = 0.5") + own + &run("minus.csv", "voltage_v = -2.0");
    let spec = read(&format!("{HEAD}{runs}{effects}")).unwrap();
    let ids = |number: usize| -> Vec<String> {
        let effects = hidden_effects(&spec, &spec.run[number]);
        effects.into_iter().map(|effect| effect.id).collect()
    };
    assert_eq!(ids(0), ["camera-zero", "series-resistance", "tip-formula"]);
    assert_eq!(ids(1), ["series-resistance"]);
}

/// A folder with a spec that hides an effect in one of two runs, simulated.
fn written(tell: bool) -> (tempfile::TempDir, Vec<std::path::PathBuf>) {
    let folder = tempfile::tempdir().unwrap();
    let head = HEAD.replace("[simulation]", &format!("[simulation]\ntell = {tell}"));
    let hidden = "\n[[run.effect]]\nid = \"faradaic-leak\"\nleak_current_a_per_cm2 = 1e-5\nonset_v = 1.2\nslope_v = 0.2\n";
    let text = head + &run("a.csv", "voltage_v = 2.0") + &run("b.csv", "voltage_v = 2.0") + hidden;
    std::fs::write(folder.path().join("spec.toml"), text).unwrap();
    let simulate = Simulate {
        spec: folder.path().join("spec.toml"),
        seed: None,
        overwrite: false,
    };
    let written = simulate.run(&Silent).unwrap();
    (folder, written)
}

#[test]
fn what_is_hidden_is_said_in_the_answer_key_and_in_the_file_only_on_request() {
    let (folder, paths) = written(false);
    let names: Vec<_> = paths
        .iter()
        .map(|path| path.strip_prefix(folder.path()).unwrap())
        .collect();
    assert_eq!(
        names,
        [
            Path::new("runs/a.csv"),
            Path::new("runs/b.csv"),
            Path::new("truth.json")
        ]
    );
    let text = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    assert!(!text("runs/b.csv").contains("faradaic"));
    let key: serde_json::Value = serde_json::from_str(&text("truth.json")).unwrap();
    assert_eq!(key["runs"][0]["effects"], serde_json::json!([]));
    let effect = &key["runs"][1]["effects"][0];
    assert_eq!(
        (&effect["id"], &effect["variant"]),
        (&"faradaic-leak".into(), &"terminal".into())
    );
    assert_eq!(effect["parameters"]["onset_v"], 1.2);
    let (told, _) = written(true);
    let text = std::fs::read_to_string(told.path().join("runs/b.csv")).unwrap();
    let line = "# hidden effect: faradaic-leak (terminal), leak_current_a_per_cm2 = 0.00001, onset_v = 1.2, slope_v = 0.2";
    assert!(text.lines().any(|found| found == line), "{text}");
}

#[test]
fn a_foreign_form_is_told_and_stands_in_the_answer_key() {
    let run = run("a.csv", "voltage_v = 2.0");
    let effect = "[[effect]]\nid = \"coupling-saturation\"\nvariant = \"gain\"\nform = \"tanh\"\ninverse_charge_per_c = 8.0\n";
    let spec = read(&format!("{HEAD}{run}\n{effect}")).unwrap();
    let hidden = spec.effect[0].hidden();
    assert_eq!(
        (hidden.variant_or_first(), hidden.form()),
        (Some("gain"), Some("tanh"))
    );
    assert_eq!(
        answer_key::told(&hidden),
        "hidden effect: coupling-saturation (gain) in the foreign form tanh, inverse_charge_per_c = 8"
    );
    let key = answer_key(&spec, Path::new("spec.toml"));
    let key: serde_json::Value = serde_json::from_str(&key).unwrap();
    let effect = &key["runs"][0]["effects"][0];
    assert_eq!(
        (&effect["variant"], &effect["form"]),
        (&"gain".into(), &"tanh".into())
    );
}

#[test]
fn an_effect_shows_in_the_readings_and_the_noise_stays() {
    let (folder, _) = written(false);
    let last = |name: &str| -> f64 {
        let text = std::fs::read_to_string(folder.path().join(name)).unwrap();
        text.lines()
            .last()
            .unwrap()
            .split(',')
            .nth(2)
            .unwrap()
            .parse()
            .unwrap()
    };
    let leak = 0.1 * 1e-5 * (0.8_f64 / 0.2).exp_m1();
    assert!((last("runs/b.csv") - last("runs/a.csv") - leak).abs() < 1e-6);
}

#[test]
fn the_thesis_campaign_is_written_byte_by_byte() {
    let campaign = Path::new(env!("CARGO_MANIFEST_DIR")).join("campaigns/thesis");
    let path = campaign.join("simulation.toml");
    let spec = Spec::read(&path).unwrap();
    for (number, run) in spec.run.iter().enumerate() {
        let stored = std::fs::read_to_string(campaign.join("runs").join(&run.file)).unwrap();
        assert!(
            run_table(&spec, run, number).unwrap() == stored,
            "{}",
            run.file.display()
        );
    }
    assert_eq!(
        std::fs::read_to_string(campaign.join("truth.json")).unwrap(),
        answer_key(&spec, &path)
    );
}

fn with_sigma(effect: &str, runs: &str) -> Result<Spec, String> {
    let mut spec = read(&format!("{HEAD}{runs}\n[[effect]]\n{effect}\n")).map_err(|e| e.to_string())?;
    spec.resolve_strengths()
        .map_err(|wrong| format!("{}: found {}, needed {}", wrong.place, wrong.found, wrong.needed))?;
    Ok(spec)
}

#[test]
fn a_strength_in_standard_deviations_leaves_as_many_after_the_refit() {
    let runs = run("a.csv", "voltage_v = 2.0") + &run("b.csv", "voltage_v = -1.0");
    let leak = "id = \"faradaic-leak\"\nonset_v = 1.2\nslope_v = 0.25\n";
    let strength = |sigma: f64| {
        let spec = with_sigma(&format!("{leak}strength_sigma = {sigma}"), &runs).unwrap();
        assert_eq!(spec.effect[0].strength_sigma, None);
        spec.effect[0].parameters["leak_current_a_per_cm2"]
    };
    let (weak, strong) = (strength(8.0), strength(16.0));
    // A small effect leaves in proportion to its strength.
    let ratio = strong / weak;
    assert!((ratio - 2.0).abs() < 0.12 && weak > 0.0, "{weak} {strong}");
    // One run of two, and the sign, are the user's choice.
    let zero = "id = \"camera-zero\"\nruns = [\"a*\"]\nstrength_sigma = -12";
    let spec = with_sigma(zero, &runs).unwrap();
    assert!(spec.effect[0].parameters["offset_per_cm"] < 0.0);
}

#[test]
fn a_strength_in_standard_deviations_that_cannot_be_is_refused() {
    let runs = run("a.csv", "voltage_v = 2.0");
    let leak = "id = \"faradaic-leak\"\nonset_v = 1.2\nslope_v = 0.25\n";
    let said = |effect: &str, runs: &str| with_sigma(effect, runs).unwrap_err();
    let both = format!("{leak}leak_current_a_per_cm2 = 1e-6\nstrength_sigma = 8");
    assert!(said(&both, &runs).contains("one of the two"));
    assert!(said(&format!("{leak}strength_sigma = 0"), &runs).contains("other than 0"));
    let never = "id = \"faradaic-leak\"\nonset_v = 5.0\nslope_v = 0.25\nstrength_sigma = 8";
    assert!(
        said(never, &runs).contains("leaves 0.00 sigmas"),
        "{}",
        said(never, &runs)
    );
    let differs = runs.clone() + &run("b.csv", "voltage_v = 1.0").replace("500.0", "700.0");
    assert!(said(&format!("{leak}strength_sigma = 8"), &differs).contains("different parameters"));
}

const STRIP: &str = r#"
[[strip]]
file = "a.csv"
length_mm = 28.0
width_mm = 5.0
voltage_v = 1.5
curvature_at_mm = [1.4, 26.6]
parameters = { re_ohm_per_sq = 2.5, rc_ohm_cm2 = 4.5, c_f_per_cm2 = 0.131, rss_ohm_cm2 = 22.7, alpha_per_c_cm = 2.1, lambda_per_s = 0.0029 }
"#;

#[test]
fn strips_that_make_no_sense_are_refused_with_what_would() {
    let with = |what: &str, instead: &str| {
        assert!(STRIP.contains(what), "{what}");
        refused(&format!("{HEAD}{}", STRIP.replacen(what, instead, 1)))
    };
    let mut told: Vec<String> = [
        ("length_mm = 28.0", "length_mm = -28.0"),
        ("re_ohm_per_sq = 2.5", "re_ohm_per_sq = nan"),
        ("re_ohm_per_sq = 2.5", "re_ohm_per_sq = 0.0"),
        ("alpha_per_c_cm = 2.1", "alpha_per_c_cm = inf"),
        ("lambda_per_s = 0.0029", "lambda_per_s = -1.0"),
        ("voltage_v = 1.5", "voltage_v = nan"),
        ("voltage_v = 1.5", ""),
        ("voltage_v = 1.5", "drive = [{ start_s = 0.0 }]"),
        (
            "voltage_v = 1.5",
            "drive = [{ start_s = 2.0, voltage_v = 1.0 }, { start_s = 1.0, voltage_v = 0.0 }]",
        ),
        ("curvature_at_mm = [1.4, 26.6]", "curvature_at_mm = [1.4, 28.1]"),
        ("curvature_at_mm = [1.4, 26.6]", "curvature_at_mm = [1.4, 1.4]"),
        ("file = \"a.csv\"", "file = \"../a.csv\""),
        (
            "voltage_v = 1.5",
            "voltage_v = 1.5\nsampling = [{ until_s = 1.0, every_s = 1e-12 }]",
        ),
        (
            "voltage_v = 1.5",
            "voltage_v = 1.5\nsampling = [{ until_s = inf, every_s = 1.0 }]",
        ),
        (
            "alpha_per_c_cm = 2.1, lambda_per_s = 0.0029 }",
            "alpha_per_c_cm = 2.1, lambda_per_s = 0.0029 }\n[[strip.effect]]\nid = \"softening\"\ncubic_cm2 = 1.0",
        ),
    ]
    .into_iter()
    .map(|(what, instead)| with(what, instead))
    .collect();
    told.push(refused(&format!(
        "{HEAD}{STRIP}\n[[effect]]\nid = \"camera-zero\"\noffset_per_cm = 0.1\n"
    )));
    told.push(refused(&format!("{HEAD}{STRIP}{STRIP}")));
    let unknown = with("width_mm = 5.0", "width_mm = 5.0\nwidth_cm = 0.5");
    assert!(unknown.contains("unknown field `width_cm`"), "{unknown}");
    insta::assert_snapshot!(told.join("\n"));
}

#[test]
fn a_file_that_is_there_stops_everything_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let second = STRIP.replace("a.csv", "b.csv");
    std::fs::write(folder.path().join("spec.toml"), format!("{HEAD}{STRIP}{second}")).unwrap();
    std::fs::create_dir(folder.path().join("runs")).unwrap();
    std::fs::write(folder.path().join("runs/b.csv"), "mine").unwrap();
    let simulate = Simulate {
        spec: folder.path().join("spec.toml"),
        seed: None,
        overwrite: false,
    };
    let refused = simulate.run(&Silent).unwrap_err().to_string();
    assert!(refused.contains("b.csv"), "{refused}");
    assert!(!folder.path().join("runs/a.csv").exists());
}
