//! `predict` and `drive` at a humidity at which no run was made: brought there by the laws across runs, against strips
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
        std::array::from_fn(|k| {
            let logarithm = self.follows[k].logarithm(humidity) + offsets[k] + self.scatter * normal(rng);
            self.values[k] * logarithm.exp()
        })
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

/// A campaign of one material with two samples, each measured at every humidity and 1.5 V twice, and fitted; with a further
/// run of the first sample at the humidity that is asked for.
fn campaign(seed: u64) -> (CampaignFolder, LumpedModel) {
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
    let further = model(material.run(ASKED, &strips[0], &mut rng));
    (folder, further)
}

fn predicted(folder: &CampaignFolder, humidity: &str) -> Value {
    let arguments = [
        "predict",
        "--json",
        "--sample",
        "S0",
        "--voltage",
        "1.5V",
        "--at",
        "10,60,600",
        "--rh",
        humidity,
    ];
    folder.ieap(&arguments).expect(0).json()
}

/// Of current and curvature at the three times, how many intervals hold what a further run does.
fn held(document: &Value, truth: &LumpedModel) -> (usize, usize) {
    let drive = Drive::step(1.5);
    let all = [
        ("current_a", truth.current_a(&drive, AREA_CM2, &TIMES_S)),
        (
            "curvature_per_cm",
            truth.curvature_per_cm(&drive, AREA_CM2, &TIMES_S),
        ),
    ];
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
    let (folder, _) = campaign(7);
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
        found["remarks"].to_string().contains("by the laws across runs"),
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
        let (folder, truth) = campaign(3000 + seed);
        let (hold, of) = held(&predicted(&folder, "40"), &truth);
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
