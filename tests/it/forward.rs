//! `predict`, `drive` and `convert` from the command line, against the strips that were simulated.

use ieap::domain::testing::branch;
use std::fmt::Write;

use ieap::domain::{Drive, Level, Segment};
use ieap::model::LumpedModel;
use ieap::model::geometry::conversion::tip_displacement_mm;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;

use crate::campaign::{CampaignFolder, counted};

/// What strips of a material are like: a laminate that goes with the voltage, and differs from strip to strip.
#[derive(Debug, Clone)]
struct Laminate {
    /// R_1, C_1, R_2, C_2, R_ss, areal coupling, cm/C, lambda.
    values: [f64; 7],
    /// e-fold change of R_ss and lambda per volt.
    per_volt: [f64; 2],
}

impl Laminate {
    /// At that voltage, as a strip of that area: alpha belongs to the total charge.
    fn strip(&self, volts: f64, area_cm2: f64) -> LumpedModel {
        let [r1, c1, r2, c2, rss, coupling, lambda] = self.values;
        LumpedModel {
            branches: vec![branch(r1, c1), branch(r2, c2)],
            steady_state_resistance_ohm_cm2: rss * (-self.per_volt[0] * (volts - 1.5)).exp(),
            charge_to_curvature_per_c_cm: coupling / area_cm2,
            relaxation_rate_per_s: lambda * (self.per_volt[1] * (volts - 1.5)).exp(),
        }
    }

    /// Another strip of it: every parameter a few percent off.
    fn another(&self, share: f64, rng: &mut ChaCha8Rng) -> Laminate {
        Laminate {
            values: self.values.map(|value| value * (share * spread(rng)).exp()),
            ..self.clone()
        }
    }
}

/// About a standard normal number: the sum of twelve even ones.
fn spread(rng: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| rng.random_range(-0.5..0.5)).sum()
}

fn material(rng: &mut ChaCha8Rng) -> Laminate {
    let mut about = |value: f64| value * (0.3 * spread(rng)).exp();
    let values = [
        about(300.0),
        about(0.05),
        about(1500.0),
        about(0.13),
        about(6000.0),
        about(1.4),
        about(4e-3),
    ];
    Laminate {
        values,
        per_volt: [0.5, 0.4].map(|slope: f64| slope * (0.3 * spread(rng)).exp()),
    }
}

const HEAD: &str = r#"[simulation]
seed = 30
folder = "runs"
statement = ["SIMULATED, not measured."]
baseline_s = 5.0

[noise]
current_a = 2e-6
curvature_per_cm = 2e-3

[[sampling]]
until_s = 60.0
every_s = 1.0
[[sampling]]
until_s = 900.0
every_s = 6.0
"#;

/// Area of the strips that are measured, cm2: 5 mm by 2 mm.
const AREA_CM2: f64 = 0.1;
const VOLTAGES: [f64; 3] = [1.0, 1.5, 2.5];

/// A campaign of materials with three samples each, every sample measured at three voltages, and fitted; with a strip
/// of each material that was not measured.
fn campaign(materials: usize, seed: u64) -> (CampaignFolder, Vec<[Laminate; 2]>) {
    let folder = CampaignFolder::new();
    std::fs::remove_file(folder.join("runs/tags.toml")).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut text = String::from("[campaign]\nid = \"forward\"\ntitle = \"Forward\"\n");
    let mut spec = HEAD.to_owned();
    let mut truths = Vec::new();
    for m in 0..materials {
        let laminate = material(&mut rng);
        let strips: Vec<Laminate> = (0..4).map(|_| laminate.another(0.05, &mut rng)).collect();
        for (s, strip) in strips[..3].iter().enumerate() {
            let _ = writeln!(
                text,
                "[[sample]]\nid = \"M{m}-{s}\"\nmaterial = \"M{m}\"\nlength_mm = 5.0\nwidth_mm = 2.0\nthickness_mm = 0.22"
            );
            for volts in VOLTAGES {
                let model = strip.strip(volts, AREA_CM2);
                let [fast, slow] = [model.branches[0], model.branches[1]];
                let _ = writeln!(
                    spec,
                    r#"
[[run]]
file = "M{m}_{s}_{volts}.csv"
area_cm2 = {AREA_CM2}
voltage_v = {volts}
parameters = {{ r1_ohm_cm2 = {}, c1_f_per_cm2 = {}, r2_ohm_cm2 = {}, c2_f_per_cm2 = {}, rss_ohm_cm2 = {}, alpha_per_c_cm = {}, lambda_per_s = {} }}
tags = {{ sample = "M{m}-{s}", environment = "air", relative_humidity_percent = 34, voltage_v = {volts} }}"#,
                    fast.resistance_ohm_cm2,
                    fast.capacitance_f_per_cm2,
                    slow.resistance_ohm_cm2,
                    slow.capacitance_f_per_cm2,
                    model.steady_state_resistance_ohm_cm2,
                    model.charge_to_curvature_per_c_cm,
                    model.relaxation_rate_per_s,
                );
            }
        }
        truths.push([strips[0].clone(), strips[3].clone()]);
    }
    folder.write("campaign.toml", text);
    folder.write("simulation.toml", spec);
    let path = folder.join("simulation.toml");
    folder
        .ieap(&["simulate", "--overwrite", path.to_str().unwrap()])
        .expect(0);
    folder.ieap(&["fit"]).expect(0);
    (folder, truths)
}

const TIMES_S: [f64; 3] = [10.0, 60.0, 600.0];

/// Of current, curvature and tip at the three times: whether the interval holds what the strip does.
fn held(document: &Value, truth: &LumpedModel, volts: f64, area_cm2: f64, length_mm: f64) -> Vec<bool> {
    let drive = Drive::step(volts);
    let current = truth.current_a(&drive, area_cm2, &TIMES_S);
    let curvature = truth.curvature_per_cm(&drive, area_cm2, &TIMES_S);
    let mut found = Vec::new();
    for (k, row) in document["rows"].as_array().unwrap().iter().enumerate() {
        let tip = tip_displacement_mm(curvature[k], length_mm);
        let expected = [
            ("current_a", current[k]),
            ("curvature_per_cm", curvature[k]),
            ("tip_displacement_mm", tip),
        ];
        for (key, truth) in expected {
            let end = |name: &str| row[key][name].as_f64().unwrap();
            found.push((end("low_95")..=end("high_95")).contains(&truth));
        }
    }
    assert_eq!(found.len(), 9);
    found
}

/// Predictions of a strip of another size at a measured voltage, and of the sample at a voltage that was held out:
/// how many intervals hold, of how many.
fn count(materials: usize, seed: u64) -> [(usize, usize); 2] {
    let (folder, truths) = campaign(materials, seed);
    let mut counts = [(0, 0); 2];
    for (m, [own, other]) in truths.iter().enumerate() {
        let sample = format!("M{m}-0");
        let base = [
            "predict",
            "--json",
            "--sample",
            &sample,
            "--at",
            "10,60,600",
            "--voltage",
        ];
        let larger = [&base[..], &["1.5V", "--length", "12mm", "--width", "3mm"]].concat();
        let between = [&base[..], &["2V"]].concat();
        let asked = [
            (larger, other.strip(1.5, 0.36), 1.5, 0.36, 12.0),
            (between, own.strip(2.0, AREA_CM2), 2.0, AREA_CM2, 5.0),
        ];
        for (which, (arguments, truth, volts, area_cm2, length_mm)) in asked.into_iter().enumerate() {
            let document = folder.ieap(&arguments).expect(0).json();
            assert_eq!(document["schema"], "ieap/prediction/2");
            let held = held(&document, &truth, volts, area_cm2, length_mm);
            counts[which].0 += held.iter().filter(|held| **held).count();
            counts[which].1 += held.len();
        }
    }
    counts
}

/// docs/validation/predict.md states what this counts with `IEAP_LONG=1`.
#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn intervals_hold_strips_of_other_sizes_and_voltages_that_were_held_out() {
    let counts = count(counted(6, 60), 30);
    println!("another size, held-out voltage: {counts:?}");
    for (held, of) in counts {
        // Nine numbers of one strip go together: about three independent ones a strip.
        let strips = of as f64 / 3.0;
        let least = 0.95 - 3.0 * (0.05 * 0.95 / strips).sqrt();
        assert!(held as f64 / of as f64 > least, "{held} of {of}");
    }
}

#[test]
fn a_prediction_holds_what_the_simulated_strip_does_and_says_what_it_rests_on() {
    let (folder, truths) = campaign(1, 5);
    let base = [
        "predict",
        "--sample",
        "M0-0",
        "--voltage",
        "1.5V",
        "--at",
        "10,60,600",
    ];
    let document = folder.ieap(&[&base[..], &["--json"]].concat()).expect(0).json();
    let own = truths[0][0].strip(1.5, AREA_CM2);
    let holds = held(&document, &own, 1.5, AREA_CM2, 5.0);
    assert!(holds.iter().filter(|held| **held).count() >= 8, "{holds:?}");
    assert_eq!(document["sources"].as_array().unwrap().len(), 3);
    assert_eq!(document["model"], "lumped");
    assert_eq!(document["shapes"][2]["joints"].as_array().unwrap().len(), 41);
    let moment = &document["rows"][0]["blocked_moment_mn_mm"];
    assert!(moment.is_null(), "no modulus is known: {moment}");

    // The moment by hand, the table and the figure.
    let with = [&base[..], &["--modulus", "100MPa", "--json", "-o", "step.csv"]].concat();
    let document = folder.ieap(&with).expect(0).json();
    let row = &document["rows"][1];
    let stiffness = 1e3 * 100.0 * 2.0 * 0.22_f64.powi(3) / 12.0 / 10.0;
    let moment = row["blocked_moment_mn_mm"]["value"].as_f64().unwrap();
    let curvature = row["curvature_per_cm"]["value"].as_f64().unwrap();
    assert!((moment / (stiffness * curvature) - 1.0).abs() < 1e-9);
    let table = std::fs::read_to_string(folder.join("step.csv")).unwrap();
    assert!(
        table.starts_with("time_s,current_a,current_a_low_95,") && table.lines().count() == 4,
        "{table}"
    );
    for name in ["step.svg", "step.png", "step.pdf"] {
        folder.ieap(&[&base[..], &["-o", name]].concat()).expect(0);
        assert!(std::fs::metadata(folder.join(name)).unwrap().len() > 1000);
    }

    // A longer strip of unknown electrodes is told to be a guess; with their resistance the distributed model steps in.
    let long = [&base[..], &["--length", "60mm"]].concat();
    let said = folder.ieap(&long).expect(0).stdout;
    assert!(
        said.contains("whether it carries over to 60 mm is not known"),
        "{said}"
    );
    assert!(said.contains("No run was repeated"), "{said}");
    let known = [&long[..], &["--electrode-resistance", "10", "--json"]].concat();
    let document = folder.ieap(&known).expect(0).json();
    assert_eq!(document["model"], "distributed");
    assert!(document["lumped_error_at_tip"].as_f64().unwrap() > 0.05);
    let bent = |link: usize| {
        document["shapes"][0]["links"][link]["curvature_per_cm"]
            .as_f64()
            .unwrap()
    };
    assert!(bent(0) > bent(39));

    // What makes no sense is refused with the way to mend it.
    for (wrong, needed) in [
        (vec!["--thickness", "0.4mm"], "identify the other laminate"),
        (vec!["--environment", "vacuum"], "one of air"),
        (vec!["--rh", "80"], "34 to 34 % RH"),
        (vec!["--length", "60V"], "needed a number"),
        (vec!["-o", "step.doc"], ".csv, .svg"),
    ] {
        let ended = folder.ieap(&[&base[..], &wrong].concat()).expect(2);
        assert!(ended.stderr.contains(needed), "{wrong:?}: {}", ended.stderr);
    }
    folder
        .ieap(&["predict", "--sample", "M9", "--voltage", "1V"])
        .expect(2);
}

/// Voltages of a document's drive.
fn volts_of(document: &Value) -> Vec<f64> {
    let segments = document["drive"]["segments"].as_array().unwrap();
    segments
        .iter()
        .map(|segment| segment["voltage_v"].as_f64().unwrap())
        .collect()
}

/// What the strip does under a drive that was written for a source, at its samples.
fn simulated(folder: &CampaignFolder, name: &str, model: &LumpedModel) -> (Vec<f64>, Vec<f64>) {
    let text = std::fs::read_to_string(folder.join(name)).unwrap();
    let rows: Vec<(f64, f64)> = text
        .lines()
        .skip(1)
        .map(|line| line.split_once(',').unwrap())
        .map(|(time, volts)| (time.parse().unwrap(), volts.parse().unwrap()))
        .collect();
    let segment = |&(start_s, volts): &(f64, f64)| Segment::at(start_s, Level::Voltage(volts));
    let drive = Drive {
        baseline_v: 0.0,
        segments: rows.iter().map(segment).collect(),
    };
    let every_s = rows[1].0 - rows[0].0;
    let times: Vec<f64> = rows.iter().map(|row| row.0 + every_s).collect();
    let curvature = model.curvature_per_cm(&drive, AREA_CM2, &times);
    (
        times,
        curvature
            .iter()
            .map(|kappa| tip_displacement_mm(*kappa, 5.0))
            .collect(),
    )
}

#[test]
fn the_strip_does_under_the_found_drive_what_was_wanted() {
    let (folder, truths) = campaign(1, 6);
    // A course that needs about the lowest voltage of the runs: there the strip is known.
    let model = truths[0][0].strip(1.0, AREA_CM2);
    let step = model.curvature_per_cm(&Drive::step(1.5), AREA_CM2, &[60.0])[0];
    let reachable_mm = tip_displacement_mm(step, 5.0);
    let wanted_mm = 0.5 * reachable_mm;
    let course = format!("time_s,tip_displacement_mm\n0,0\n100,{wanted_mm}\n200,{wanted_mm}\n");
    folder.write("wanted.csv", course);
    let base = ["drive", "--sample", "M0-0", "--json"];
    let follow = [&base[..], &["--course", "wanted.csv", "-o", "drive.csv"]].concat();
    let document = folder.ieap(&follow).expect(0).json();
    assert_eq!(document["schema"], "ieap/drive/2");
    assert!(
        document["rms_error_mm"].as_f64().unwrap() < 1e-3 * wanted_mm,
        "{document}"
    );
    let (times, tips) = simulated(&folder, "drive.csv", &model);
    for (time, tip) in times.iter().zip(&tips) {
        let wanted = wanted_mm * (time / 100.0).min(1.0);
        // The fits know the strip's own parameters to a few percent.
        assert!((tip - wanted).abs() < 0.05 * wanted_mm, "{time}: {tip} {wanted}");
    }
    let last = document["rows"].as_array().unwrap().last().unwrap();
    let end = |name: &str| last["reached_mm"][name].as_f64().unwrap();
    assert!((end("low_95")..=end("high_95")).contains(tips.last().unwrap()));

    // The prediction of that drive is what the inverse says of it.
    let again = [
        "predict",
        "--sample",
        "M0-0",
        "--drive",
        "drive.csv",
        "--at",
        "200",
        "--json",
    ];
    let predicted = folder.ieap(&again).expect(0).json();
    let tip = predicted["rows"][0]["tip_displacement_mm"]["value"]
        .as_f64()
        .unwrap();
    assert!((tip - end("value")).abs() < 1e-6, "{tip} {}", end("value"));

    // Limits hold, and what they cost is said: too far, too steep, below the onset.
    let hold = format!("{}mm", 3.0 * reachable_mm);
    let far = [
        &base[..],
        &[
            "--hold",
            &hold,
            "--for",
            "300s",
            "--onset",
            "1.1V",
            "--max-slope",
            "50mV/s",
        ],
    ]
    .concat();
    let document = folder.ieap(&far).expect(0).json();
    assert!(document["limited_by"].as_str().unwrap().contains("onset"));
    let volts = volts_of(&document);
    assert_eq!(volts.len(), 200);
    let possible = document["least_rms_error_mm"].as_f64().unwrap();
    let reached = document["rms_error_mm"].as_f64().unwrap();
    assert!(
        0.0 < possible && possible <= reached && reached < 1.001 * possible,
        "{possible} {reached}"
    );
    let mut before = 0.0;
    for volts in &volts {
        assert!(volts.abs() <= 1.1 + 1e-12 && (volts - before).abs() <= 0.05 * 1.5 + 1e-12);
        before = *volts;
    }
    assert!(document["reached_after_s"].is_null());
    let own = truths[0][0].strip(1.1, AREA_CM2).steady_state_resistance_ohm_cm2;
    let leaks = |document: &Value, every_s: f64| {
        let leaked = &document["leaked_charge_c"];
        let flux: f64 = volts_of(document).iter().map(|volts| volts.abs() * every_s).sum();
        let truth = flux * AREA_CM2 / own;
        let range = leaked["low_95"].as_f64().unwrap()..=leaked["high_95"].as_f64().unwrap();
        assert!(range.contains(&truth), "{leaked} {truth}");
    };
    leaks(&document, 1.5);
    // What flows back through the leak is lost as well, and a drive of 200 moves comes out whole.
    let there_and_back =
        format!("time_s,tip_displacement_mm\n0,0\n50,{wanted_mm}\n150,-{wanted_mm}\n200,0\n");
    folder.write("back.csv", there_and_back);
    let back = [
        &base[..],
        &[
            "--course",
            "back.csv",
            "--max-slope",
            "20mV/s",
            "-o",
            "back-drive.csv",
        ],
    ]
    .concat();
    let document = folder.ieap(&back).expect(0).json();
    leaks(&document, 1.0);
    let said = [
        "predict",
        "--sample",
        "M0-0",
        "--drive",
        "back-drive.csv",
        "--json",
    ];
    let predicted = folder.ieap(&said).expect(0).json();
    assert_eq!(volts_of(&predicted), volts_of(&document));
    for wrong in [
        vec!["--hold", "1mm"],
        vec!["--hold", "9mm", "--for", "60s"],
        vec!["--hold", "0.1mm", "--for", "60s", "--every", "2min"],
        vec!["--hold", "0.1mm", "--for", "60s", "--max-voltage", "0V"],
    ] {
        let refused = [&base[..], &wrong].concat();
        assert_eq!(folder.ieap(&refused).status, 2, "{wrong:?}");
    }
}

#[test]
fn bending_is_converted_with_the_strip_of_a_campaign() {
    let folder = CampaignFolder::new();
    let typed = [
        "convert",
        "displacement=1.2mm",
        "--length",
        "5mm",
        "--thickness",
        "0.22mm",
    ];
    insta::assert_snapshot!("convert", folder.ieap(&typed).expect(0).stdout);
    let document = folder.ieap(&[&typed[..], &["--json"]].concat()).expect(0).json();
    assert_eq!(document["schema"], "ieap/convert/1");
    let curvature = document["values"]["curvature_per_cm"]["value"].as_f64().unwrap();
    assert!((curvature - 24.0 / 26.44).abs() < 1e-12);
    let moment = &document["values"]["bending_moment_mn_mm"];
    assert!(moment["value"].is_null() && moment["reason"] == "needs the width");
    let wrong = folder
        .ieap(&["convert", "displacement=1.2V", "--length", "5mm"])
        .expect(2);
    assert!(wrong.stderr.contains("mm, cm, um, m"), "{}", wrong.stderr);
    folder.write(
        "campaign.toml",
        "[campaign]\nid = \"c\"\ntitle = \"C\"\n[[sample]]\nid = \"S\"\nmaterial = \"CNaf\"\nlength_mm = 5.0\nwidth_mm = 2.0\nthickness_mm = 0.22\n",
    );
    folder.ieap(&["ingest"]).expect(0);
    let of_sample = [
        "convert",
        "curvature=0.5/cm",
        "--sample",
        "S",
        "--modulus",
        "100MPa",
        "--json",
    ];
    let document = folder.ieap(&of_sample).expect(0).json();
    let moment = document["values"]["bending_moment_mn_mm"]["value"]
        .as_f64()
        .unwrap();
    let by_hand = 1e3 * 100.0 * 2.0 * 0.22_f64.powi(3) / 12.0 * 0.05;
    assert!((moment / by_hand - 1.0).abs() < 1e-9);
}
