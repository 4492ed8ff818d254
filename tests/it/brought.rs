//! `predict` and `drive` at a humidity at which no run was made: brought there by the model of the study, against strips
//! whose parameters follow the humidity in forms of their own.

use std::fmt::Write;

use ieap::domain::Drive;
use ieap::domain::testing::branch;
use ieap::model::LumpedModel;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;

use crate::campaign::{CampaignFolder, counted};

/// Area of the strips, cm2: 5 mm by 2 mm.
const AREA_CM2: f64 = 0.1;
const HUMIDITIES: [f64; 4] = [15.0, 30.0, 50.0, 65.0];
const ASKED: f64 = 40.0;
const TIMES_S: [f64; 3] = [10.0, 60.0, 600.0];

/// How a parameter goes with the humidity: its factor from 15 to 65 % RH, and a form.
#[derive(Clone, Copy)]
struct Follows {
    factor: f64,
    form: usize,
}

impl Follows {
    /// Logarithm of the parameter against 15 % RH.
    fn logarithm(self, humidity: f64) -> f64 {
        let part = (humidity - 15.0) / 50.0;
        match self.form {
            0 => part * self.factor.ln(),
            1 => (1.0 + part * (self.factor - 1.0)).ln(),
            _ => (humidity / 15.0).ln() / (65.0_f64 / 15.0).ln() * self.factor.ln(),
        }
    }
}

/// A material: R_1, C_1, R_2, C_2, R_ss, alpha, lambda at 15 % RH, and how each follows the humidity.
struct Material {
    values: [f64; 7],
    follows: [Follows; 7],
    /// Standard deviation of the logarithm of each parameter from run to run.
    scatter: f64,
}

fn normal(rng: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| rng.random_range(-0.5..0.5)).sum()
}

impl Material {
    fn drawn(rng: &mut ChaCha8Rng) -> Material {
        let values = [300.0, 0.05, 1500.0, 0.13, 6000.0, 14.0, 4e-3];
        let factors = [0.25, 1.3, 0.3, 1.5, 0.5, 0.7, 1.4];
        Material {
            values: values.map(|value: f64| value * (0.2 * normal(rng)).exp()),
            follows: factors.map(|factor: f64| Follows {
                factor: factor * (0.1 * normal(rng)).exp(),
                form: rng.random_range(0..3),
            }),
            scatter: rng.random_range(0.01..0.05),
        }
    }

    /// A run of a strip that differs by `offsets`.
    fn run(&self, humidity: f64, offsets: &[f64; 7], rng: &mut ChaCha8Rng) -> [f64; 7] {
        let of_run = std::array::from_fn(|k| offsets[k] + self.scatter * normal(rng));
        self.at(humidity, &of_run)
    }

    fn at(&self, humidity: f64, offsets: &[f64; 7]) -> [f64; 7] {
        std::array::from_fn(|k| self.values[k] * (self.follows[k].logarithm(humidity) + offsets[k]).exp())
    }

    /// Current and curvature at [`TIMES_S`] under 1.5 V while the humidity goes as `course` says: the differential equations in
    /// small steps.
    fn under(&self, course: &[(f64, f64)], offsets: &[f64; 7]) -> [Vec<f64>; 2] {
        const STEP_S: f64 = 0.01;
        let (mut charge, mut strain) = ([0.0; 2], 0.0);
        let mut told = [Vec::new(), Vec::new()];
        for k in 0..=60_000_u32 {
            let time_s = STEP_S * f64::from(k);
            let humidity = course.iter().rfind(|row| row.0 <= time_s).unwrap().1;
            let own = self.at(humidity, offsets);
            let flows = [0, 1].map(|b: usize| (1.5 - charge[b] / own[2 * b + 1]) / own[2 * b]);
            let flow = flows[0] + flows[1];
            if TIMES_S.iter().any(|t| (t - time_s).abs() < 0.5 * STEP_S) {
                told[0].push(AREA_CM2 * (flow + 1.5 / own[4]));
                told[1].push(AREA_CM2 * own[5] * strain);
            }
            strain += STEP_S * (flow - own[6] * strain);
            charge[0] += STEP_S * flows[0];
            charge[1] += STEP_S * flows[1];
        }
        told
    }
}

fn model([r1, c1, r2, c2, rss, alpha, lambda]: [f64; 7]) -> LumpedModel {
    LumpedModel {
        branches: vec![branch(r1, c1), branch(r2, c2)],
        steady_state_resistance_ohm_cm2: rss,
        charge_to_curvature_per_c_cm: alpha,
        relaxation_rate_per_s: lambda,
    }
}

/// A campaign of one material with two samples, each measured at every humidity and 1.5 V twice, and fitted.
struct Made {
    folder: CampaignFolder,
    material: Material,
    /// By how much a further run of the first sample differs, as logarithms.
    further: [f64; 7],
}

impl Made {
    /// That run at the humidity that is asked for.
    fn run(&self) -> LumpedModel {
        model(self.material.at(ASKED, &self.further))
    }
}

fn campaign(seed: u64) -> Made {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let folder = CampaignFolder::new();
    std::fs::remove_file(folder.join("runs/tags.toml")).unwrap();
    let material = Material::drawn(&mut rng);
    let noise = rng.random_range(0.5..3.0);
    let every_s = [0.5, 1.0, 2.0][rng.random_range(0..3)];
    let mut text = String::from("[campaign]\nid = \"brought\"\ntitle = \"Brought\"\n");
    let mut spec = format!(
        "[simulation]\nseed = {seed}\nfolder = \"runs\"\nstatement = [\"SIMULATED, not measured.\"]\nbaseline_s = 5.0\n\
         [noise]\ncurrent_a = {}\ncurvature_per_cm = {}\n\
         [[sampling]]\nuntil_s = 60.0\nevery_s = {every_s}\n[[sampling]]\nuntil_s = 900.0\nevery_s = 5.0\n",
        2e-6 * noise,
        2e-3 * noise
    );
    let strips: [[f64; 7]; 2] = std::array::from_fn(|_| std::array::from_fn(|_| 0.03 * normal(&mut rng)));
    for (s, offsets) in strips.iter().enumerate() {
        let _ = writeln!(
            text,
            "[[sample]]\nid = \"S{s}\"\nmaterial = \"M\"\nlength_mm = 5.0\nwidth_mm = 2.0\nthickness_mm = 0.22"
        );
        for humidity in HUMIDITIES {
            for repeat in 0..2 {
                let [r1, c1, r2, c2, rss, alpha, lambda] = material.run(humidity, offsets, &mut rng);
                let _ = writeln!(
                    spec,
                    "[[run]]\nfile = \"S{s}_{humidity}_{repeat}.csv\"\narea_cm2 = {AREA_CM2}\nvoltage_v = 1.5\n\
                     parameters = {{ r1_ohm_cm2 = {r1}, c1_f_per_cm2 = {c1}, r2_ohm_cm2 = {r2}, c2_f_per_cm2 = {c2}, \
                     rss_ohm_cm2 = {rss}, alpha_per_c_cm = {alpha}, lambda_per_s = {lambda} }}\n\
                     tags = {{ sample = \"S{s}\", environment = \"air\", relative_humidity_percent = {humidity}, voltage_v = 1.5 }}",
                );
            }
        }
    }
    folder.write("campaign.toml", text);
    folder.write("simulation.toml", spec);
    let path = folder.join("simulation.toml");
    folder
        .ieap(&["simulate", "--overwrite", path.to_str().unwrap()])
        .expect(0);
    folder.ieap(&["fit"]).expect(0);
    let further = std::array::from_fn(|k| strips[0][k] + material.scatter * normal(&mut rng));
    Made {
        folder,
        material,
        further,
    }
}

fn predicted(folder: &CampaignFolder, humidity: &str) -> Value {
    predicted_with(folder, "--rh", humidity)
}

fn predicted_with(folder: &CampaignFolder, option: &str, humidity: &str) -> Value {
    let arguments = [
        "predict",
        "--json",
        "--sample",
        "S0",
        "--voltage",
        "1.5V",
        "--at",
        "10,60,600",
        option,
        humidity,
    ];
    folder.ieap(&arguments).expect(0).json()
}

/// Of current and curvature at the three times, how many intervals hold what a further run does.
fn held(document: &Value, truth: &LumpedModel) -> (usize, usize) {
    let drive = Drive::step(1.5);
    let current = truth.current_a(&drive, AREA_CM2, &TIMES_S);
    held_of(
        document,
        [current, truth.curvature_per_cm(&drive, AREA_CM2, &TIMES_S)],
    )
}

fn held_of(document: &Value, [current, curvature]: [Vec<f64>; 2]) -> (usize, usize) {
    let all = [("current_a", current), ("curvature_per_cm", curvature)];
    let (mut hold, mut of) = (0, 0);
    for (key, truth) in all {
        for (row, truth) in document["rows"].as_array().unwrap().iter().zip(truth) {
            let end = |name: &str| row[key][name].as_f64().unwrap();
            hold += usize::from((end("low_95")..=end("high_95")).contains(&truth));
            of += 1;
        }
    }
    (hold, of)
}

#[test]
fn runs_are_brought_to_a_humidity_between_theirs_and_it_is_said() {
    let Made { folder, .. } = campaign(7);
    let between = predicted(&folder, "40");
    assert_eq!(between["relative_humidity_percent"], 40.0);
    let brought = &between["brought"][0];
    assert_eq!(brought["covariate"], "relative_humidity_percent");
    assert_eq!(
        (&brought["from_low"], &brought["from_high"]),
        (&15.0.into(), &65.0.into())
    );
    let by_law = brought["by_law"].as_array().unwrap();
    assert!(by_law.iter().any(|key| key == "r1_ohm_cm2"), "{by_law:?}");
    let part = |document: &Value| {
        let row = &document["rows"][0]["current_a"];
        row["standard_deviation"]["conditions"].as_f64().unwrap()
    };
    assert!(part(&between) > 0.0);
    let remarks = between["remarks"].to_string();
    assert!(
        remarks.contains("No run of the sample was made at 40 % RH"),
        "{remarks}"
    );
    // All sixteen runs tell: those of the sample itself are used for its own strip.
    assert_eq!(between["sources"].as_array().unwrap().len(), 8);

    // Where runs were made nothing is brought; the prediction goes from one to the other.
    let (dry, wet) = (predicted(&folder, "30"), predicted(&folder, "50"));
    assert!(dry["brought"].as_array().unwrap().is_empty() && part(&dry) == 0.0);
    let current = |document: &Value| document["rows"][0]["current_a"]["value"].as_f64().unwrap();
    assert!(current(&dry) < current(&between) && current(&between) < current(&wet));

    // Nothing is said of what lies outside, or of what no run states.
    let base = ["predict", "--sample", "S0", "--voltage", "1.5V"];
    for (wrong, needed) in [
        (["--rh", "80"], "15 to 65 % RH"),
        (["--temperature", "25C"], "state no temperature"),
        (["--age", "20h"], "state no age"),
    ] {
        let ended = folder.ieap(&[&base[..], &wrong].concat()).expect(2);
        assert!(ended.stderr.contains(needed), "{wrong:?}: {}", ended.stderr);
    }
    let plan = [
        "plan",
        "--sample",
        "S0",
        "--rh",
        "40",
        "--voltage",
        "1.5V",
        "--every",
        "1s",
        "--draws",
        "5",
    ];
    let planned = folder.ieap(&plan);
    assert!(
        planned.stdout.contains("taken to 40 % RH by the laws"),
        "{planned:?}"
    );
    let drive = [
        "drive", "--sample", "S0", "--hold", "0.05mm", "--for", "60s", "--rh", "40", "--json",
    ];
    let found = folder.ieap(&drive).expect(0).json();
    assert!(
        found["remarks"]
            .to_string()
            .contains("by the study's model of them"),
        "{found}"
    );
}

/// docs/validation/predict.md states what this counts with `IEAP_LONG=1`.
#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn intervals_hold_a_further_run_at_a_humidity_that_was_not_measured() {
    let campaigns = counted(8, 40) as u64;
    let (mut held_of_all, mut of_all) = (0, 0);
    for seed in 0..campaigns {
        let made = campaign(3000 + seed);
        let (hold, of) = held(&predicted(&made.folder, "40"), &made.run());
        println!("{seed}: {hold} of {of}");
        held_of_all += hold;
        of_all += of;
    }
    println!("{held_of_all} of {of_all}");
    // Six numbers of one strip are about two independent ones.
    let least = 0.95 - 3.0 * (0.05 * 0.95 / (2.0 * campaigns as f64)).sqrt();
    assert!(
        held_of_all as f64 / of_all as f64 > least,
        "{held_of_all} of {of_all}"
    );
}

/// Held until the next row.
const COURSE: [(f64, f64); 4] = [(0.0, 30.0), (5.0, 60.0), (40.0, 20.0), (300.0, 45.0)];

fn written(folder: &CampaignFolder, name: &str, course: &[(f64, f64)]) -> String {
    let mut text = "time_s,relative_humidity_percent\n".to_owned();
    for (time_s, percent) in course {
        writeln!(text, "{time_s},{percent}").unwrap();
    }
    folder.write(name, text);
    folder.join(name).to_str().unwrap().to_owned()
}

#[test]
fn a_humidity_that_changes_takes_the_strip_along_and_its_interval_holds() {
    let made = campaign(7);
    let folder = &made.folder;
    let course = written(folder, "course.csv", &COURSE);
    let found = predicted_with(folder, "--rh-course", &course);
    let brought = &found["brought"][0];
    let ends = [&brought["to"], &brought["to_low"], &brought["to_high"]].map(|own| own.as_f64().unwrap());
    assert_eq!(ends, [30.0, 20.0, 60.0]);
    assert!(
        found["remarks"].to_string().contains("follow it at once"),
        "{found}"
    );
    let (hold, of) = held_of(&found, made.material.under(&COURSE, &made.further));
    assert!(hold + 1 >= of, "{hold} of {of}: {found:#}");
    // The strip carries its charge from one humidity into the next: no humidity alone gives this current.
    let currents = |document: &Value| document["rows"][1]["current_a"]["value"].as_f64().unwrap();
    assert!((currents(&found) / currents(&predicted(folder, "20")) - 1.0).abs() > 0.05);

    // A humidity that stays is that humidity.
    let still = written(folder, "still.csv", &[(0.0, 40.0), (30.0, 40.0), (200.0, 40.0)]);
    let (still, one) = (
        predicted_with(folder, "--rh-course", &still),
        predicted(folder, "40"),
    );
    for (still, one) in still["rows"]
        .as_array()
        .unwrap()
        .iter()
        .zip(one["rows"].as_array().unwrap())
    {
        for key in ["current_a", "charge_c", "curvature_per_cm"] {
            for end in ["value", "low_95", "high_95"] {
                let (still, one) = (still[key][end].as_f64().unwrap(), one[key][end].as_f64().unwrap());
                assert!(
                    (still - one).abs() <= 1e-9 * one.abs(),
                    "{key} {end}: {still} {one}"
                );
            }
        }
    }

    // A drive for it holds the tip nearer than one for its first humidity.
    let miss = |option: &str, humidity: &str, file: &str| {
        let hold = [
            "drive", "--sample", "S0", "--hold", "0.05mm", "--for", "400s", "-o", file,
        ];
        folder.ieap(&[&hold[..], &[option, humidity]].concat()).expect(0);
        let (drive, times) = (folder.join(file), "50,100,200,300,390");
        let told = [
            "predict",
            "--json",
            "--sample",
            "S0",
            "--at",
            times,
            "--rh-course",
            &course,
        ];
        let told = [&told[..], &["--drive", drive.to_str().unwrap()]].concat();
        let told = folder.ieap(&told).expect(0).json();
        let rows = told["rows"].as_array().unwrap().iter();
        let tips = rows.map(|row| row["tip_displacement_mm"]["value"].as_f64().unwrap());
        tips.map(|tip| (tip - 0.05).powi(2)).sum::<f64>().sqrt()
    };
    let (own, of_first) = (
        miss("--rh-course", &course, "own.csv"),
        miss("--rh", "30", "first.csv"),
    );
    assert!(own < 0.5 * of_first, "{own} {of_first}");

    let outside = written(folder, "outside.csv", &[(0.0, 30.0), (60.0, 80.0)]);
    let wrong = written(folder, "wrong.csv", &[(0.0, 30.0), (60.0, 130.0)]);
    let base = ["predict", "--sample", "S0", "--voltage", "1.5V", "--rh-course"];
    for (file, said) in [(outside, "15 to 65 % RH"), (wrong, "between 0 and 100")] {
        let ended = folder.ieap(&[&base[..], &[&file]].concat()).expect(2);
        assert!(ended.stderr.contains(said), "{}", ended.stderr);
    }
}

/// docs/validation/predict.md states what this counts with `IEAP_LONG=1`.
#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn intervals_hold_a_run_whose_humidity_changes() {
    let campaigns = counted(8, 40) as u64;
    let (mut held_of_all, mut of_all) = (0, 0);
    for seed in 0..campaigns {
        let made = campaign(7000 + seed);
        let course = written(&made.folder, "course.csv", &COURSE);
        let found = predicted_with(&made.folder, "--rh-course", &course);
        let (hold, of) = held_of(&found, made.material.under(&COURSE, &made.further));
        println!("{seed}: {hold} of {of}");
        held_of_all += hold;
        of_all += of;
    }
    println!("{held_of_all} of {of_all}");
    let least = 0.95 - 3.0 * (0.05 * 0.95 / (2.0 * campaigns as f64)).sqrt();
    assert!(
        held_of_all as f64 / of_all as f64 > least,
        "{held_of_all} of {of_all}"
    );
}
