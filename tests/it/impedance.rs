//! Impedance spectra as a user meets them: files become runs of their own kind, are tested and fitted, and are set
//! beside the steps of the same sample.

use std::fmt::Write as _;

use ieap::model::impedance::spectrum_circuit;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde_json::Value;

use crate::campaign::CampaignFolder;

/// R1, C1, R2, C2 and R_ss of the whole sample, Ohm and F.
const STRIP: [f64; 5] = [220.0, 4e-3, 1500.0, 1.2e-2, 3e4];

fn normal(random: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(random)
}

/// Frequency, real and imaginary part with noise of half a percent.
fn spectrum(values: &[f64], seed: u64) -> Vec<(f64, f64, f64)> {
    let circuit = spectrum_circuit("lumped-2").unwrap();
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    (0..45)
        .map(|k| {
            let hz = 1e4 * 10.0_f64.powf(-6.5 * f64::from(k) / 44.0);
            let z = circuit.impedance(values, hz);
            let mut noise = || 0.005 * z.magnitude() * normal(&mut random);
            (hz, z.re + noise(), z.im + noise())
        })
        .collect()
}

fn table(readings: &[(f64, f64, f64)]) -> String {
    let mut text = "Frequency (Hz);Z' (Ω);-Z'' (Ω)\n".to_owned();
    for (hz, real, imaginary) in readings {
        writeln!(text, "{hz:.6e};{real:.6e};{:.6e}", -imaginary).unwrap();
    }
    text
}

/// Current and curvature of the same strip under a step, 4 readings a second.
fn step(values: &[f64], volts: f64, seed: u64) -> String {
    moved(("curvature_per_cm", ALPHA_PER_C_CM), values, volts, seed)
}

/// What a charge of the free strip bends.
const ALPHA_PER_C_CM: f64 = 2.0;

/// Current, and what the charge moves by so much.
fn moved((column, per_charge): (&str, f64), values: &[f64], volts: f64, seed: u64) -> String {
    let [r1, c1, r2, c2, leak] = values else {
        panic!("five parameters");
    };
    let lambda_per_s = 0.01;
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut text = format!("time_s,current_a,{column}\n");
    for k in 0..800 {
        let t = 0.25 * f64::from(k);
        let (mut current, mut all) = (volts / leak, 0.0);
        for (r, c) in [(r1, c1), (r2, c2)] {
            let tau = r * c;
            current += volts / r * (-t / tau).exp();
            let g = ((-t / tau).exp() - (-lambda_per_s * t).exp()) / (tau * lambda_per_s - 1.0);
            all += per_charge * volts * c * g;
        }
        current += 2e-6 * normal(&mut random);
        all += 1e-4 * per_charge * normal(&mut random);
        writeln!(text, "{t},{current:.6e},{all:.6e}").unwrap();
    }
    text
}

fn campaign() -> CampaignFolder {
    let folder = CampaignFolder::new();
    folder.write("impedance/CNaf-01.csv", table(&spectrum(&STRIP, 1)));
    folder.write(
        "impedance/tags.toml",
        "sample = \"S1\"\nenvironment = \"air\"\nrelative_humidity_percent = 34.0\n",
    );
    folder.write(
        "runs/tags.toml",
        "sample = \"S1\"\nenvironment = \"air\"\nrelative_humidity_percent = 36.0\n",
    );
    folder.write("runs/low.csv", step(&STRIP, 0.5, 2));
    folder.write("runs/low.csv.toml", "voltage_v = 0.5\n");
    folder
}

fn impedance(folder: &CampaignFolder) -> Value {
    folder.ieap(&["fit"]).expect(0);
    folder.ieap(&["impedance", "--json"]).expect(0).json()
}

#[test]
fn a_spectrum_and_a_step_of_one_strip_tell_one_circuit() {
    let folder = campaign();
    let document = impedance(&folder);
    let found = &document["spectra"][0];
    assert_eq!(found["kramers_kronig"]["verdict"], "consistent", "{found:#}");
    assert_eq!(found["best"], "lumped-2", "{found:#}");
    let circuits = found["circuits"].as_array().unwrap();
    let fit = circuits.iter().find(|fit| fit["circuit"] == "lumped-2").unwrap();
    assert_eq!(fit["describes"], true);
    let keys = ["r1_ohm", "c1_f", "r2_ohm", "c2_f", "rss_ohm"];
    for (key, truth) in keys.into_iter().zip(STRIP) {
        let own = &fit["parameters"][key];
        // One draw of five numbers: how often intervals hold is counted in ieap-fit, over 400.
        let (value, error) = (
            own["value"].as_f64().unwrap(),
            own["standard_error"].as_f64().unwrap(),
        );
        assert!((value - truth).abs() < 4.0 * error, "{key}: {own:#}");
    }
    let beside = &document["beside_steps"][0];
    assert_eq!(beside["steps"]["runs"], serde_json::json!(["runs/low.csv"]));
    assert_eq!(beside["effects"], serde_json::json!([]), "{beside:#}");
    let numbers = beside["numbers"].as_array().unwrap();
    assert_eq!(numbers.len(), 7);
    let said = beside["sentences"][0].as_str().unwrap();
    assert!(
        said.starts_with("The step and the spectrum tell the same circuit"),
        "{beside:#}"
    );
    // Per unit area: 0.1 cm2.
    let r1 = &numbers[0];
    assert_eq!(r1["key"], "r1_ohm_cm2");
    assert!(
        (r1["spectrum"]["value"].as_f64().unwrap() / 22.0 - 1.0).abs() < 0.05,
        "{r1:#}"
    );
}

#[test]
fn a_circuit_of_ones_own_is_fitted_wherever_spectra_are_shown() {
    let folder = campaign();
    let file = folder.join("campaign.toml");
    let own = "\n[impedance]\ncircuits = [\"p(R1-C1,R2-C2,R3)\", \"R0-p(R1)\"]\n";
    std::fs::write(&file, std::fs::read_to_string(&file).unwrap() + own).unwrap();
    let asked = ["impedance", "--json", "--circuit", "R0-CPE1"];
    let document = folder.ieap(&asked).expect(0).json();
    let found = &document["spectra"][0];
    let circuits = found["circuits"].as_array().unwrap();
    let names: Vec<&str> = circuits
        .iter()
        .map(|fit| fit["circuit"].as_str().unwrap())
        .collect();
    assert_eq!(names[5..], ["p(R1-C1,R2-C2,R3)", "R0-CPE1"]);
    // The same circuit as a text has the same numbers as by its name.
    for (key, named) in [("r1_ohm", "r1_ohm"), ("c2_f", "c2_f"), ("r3_ohm", "rss_ohm")] {
        let of = |at: usize, key: &str| circuits[at]["parameters"][key]["value"].as_f64().unwrap();
        assert!((of(5, key) / of(1, named) - 1.0).abs() < 1e-6, "{key}: {found:#}");
    }
    let refused = &document["refused_circuits"][0];
    assert_eq!(refused["code"], "circuit-notation");
    assert!(
        refused["message"].as_str().unwrap().contains("character 8"),
        "{refused:#}"
    );
    let wrong = folder.ieap(&["impedance", "--circuit", "R0-Q1"]);
    assert!(
        wrong.status != 0 && wrong.stderr.contains("known elements are R, C"),
        "{wrong:#?}"
    );
    // Two chains beside a leak are, as relaxations, two arcs; the slow one is that of the leak.
    assert_eq!(found["z_hit"]["drifts"], false, "{found:#}");
    assert_eq!(found["relaxation"]["describes"], true, "{found:#}");
    let peaks = found["relaxation"]["peaks"].as_array().unwrap().len();
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let page = std::fs::read_to_string(folder.join("report/impedance.html")).unwrap();
    for text in ["p(R1-C1,R2-C2,R3)", "R3 (Ω)", "Relaxation times", "Z-HIT"] {
        assert!(page.contains(text), "{text}");
    }
    let rows = |table: &str, text: &str| {
        let printed = folder.ieap(&["table", table, "--format", "csv"]).expect(0).stdout;
        printed.lines().filter(|line| line.contains(text)).count()
    };
    assert_eq!(rows("circuits", "p(R1-C1,R2-C2,R3)"), 5);
    assert_eq!(rows("relaxation-times", "CNaf-01"), peaks);
}

#[test]
fn a_step_and_a_spectrum_in_one_likelihood_have_one_circuit() {
    let folder = campaign();
    folder.ieap(&["fit"]).expect(0);
    let table = folder
        .ieap(&["table", "step-and-spectrum", "--format", "json"])
        .expect(0);
    let table: Value = serde_json::from_str(&table.stdout).unwrap();
    let rows = table["rows"].as_array().unwrap();
    assert_eq!(rows.len() % 3, 0);
    let cell = |row: &Value, key: &str| row["cells"][key].clone();
    let low: Vec<&Value> = rows
        .iter()
        .filter(|row| cell(row, "run")["text"] == "runs/low.csv")
        .collect();
    assert_eq!(low.len(), 3, "{table:#}");
    assert_eq!(cell(low[2], "from")["text"], "both");
    assert_eq!(cell(low[2], "agrees")["text"], "yes", "{table:#}");
    let error = |row: &Value| cell(row, "c2_f_per_cm2")["standard_error"].as_f64().unwrap();
    assert!(
        error(low[2]) < error(low[0]) && error(low[2]) < 1.02 * error(low[1]),
        "{table:#}"
    );
}

#[test]
fn the_force_of_the_held_strip_is_in_the_same_likelihood() {
    const MU_MN_M_PER_C: f64 = 0.05;
    let folder = campaign();
    // F = 3 M / (2 a), 5 mm from the clamp.
    let per_charge = 1.5 * 1e3 * MU_MN_M_PER_C / 5.0;
    folder.write(
        "runs/held.csv",
        moved(("blocking_force_mn", per_charge), &STRIP, 0.5, 5),
    );
    folder.write(
        "runs/held.csv.toml",
        "voltage_v = 0.5\nblocking_force_at_mm = 5.0\n",
    );
    folder.ieap(&["fit"]).expect(0);
    let table = folder.ieap(&["table", "step-and-spectrum", "--format", "json"]);
    let table = table.expect(0).json();
    let rows = table["rows"].as_array().unwrap();
    let words = |row: &Value, key: &str| row["cells"][key]["text"].clone();
    let from: Vec<Value> = rows.iter().map(|row| words(row, "from")).collect();
    assert_eq!(from, ["step", "spectrum", "force", "all"], "{table:#}");
    assert_eq!(words(&rows[3], "agrees"), "yes", "{table:#}");
    assert_eq!(words(&rows[3], "held"), "runs/held.csv");
    let of = |row: &Value, key: &str, what: &str| row["cells"][key][what].as_f64().unwrap();
    let mu = |what: &str| of(&rows[3], "mu_mn_mm_per_c", what);
    assert!(
        (mu("low_95")..=mu("high_95")).contains(&(1e3 * MU_MN_M_PER_C)),
        "{table:#}"
    );
    let error = |row: &Value, key: &str| of(row, key, "standard_error");
    assert!(
        error(&rows[3], "lambda_per_s") < error(&rows[0], "lambda_per_s"),
        "{table:#}"
    );
    assert!(
        error(&rows[3], "mu_mn_mm_per_c") < error(&rows[2], "mu_mn_mm_per_c"),
        "{table:#}"
    );
}

#[test]
fn a_leak_above_an_onset_is_told_by_the_step_alone() {
    let folder = campaign();
    let mut leaking = STRIP;
    leaking[4] = 2e3;
    folder.write("runs/high.csv", step(&leaking, 2.0, 3));
    folder.write("runs/high.csv.toml", "voltage_v = 2.0\n");
    let beside = &impedance(&folder)["beside_steps"][0];
    assert_eq!(
        beside["effects"],
        serde_json::json!(["faradaic-leak"]),
        "{beside:#}"
    );
    let said = beside["sentences"][1].as_str().unwrap();
    assert!(said.starts_with("At 2 V the step leaks"), "{said}");
}

#[test]
fn a_series_resistance_stands_in_the_spectrum() {
    let folder = campaign();
    let lead_ohm = 60.0;
    let mut readings = spectrum(&STRIP, 4);
    readings.iter_mut().for_each(|reading| reading.1 += lead_ohm);
    folder.write("impedance/CNaf-01.csv", table(&readings));
    let beside = &impedance(&folder)["beside_steps"][0];
    let effects = beside["effects"].as_array().unwrap();
    assert!(effects.contains(&"series-resistance".into()), "{beside:#}");
}

#[test]
fn spectra_are_runs_of_their_own_kind_for_every_verb() {
    let folder = campaign();
    // Among the runs, in another form, and without a sample.
    let mut polar = "freq / Hz,Z / Ohm,neg. Phase / °\n".to_owned();
    for (hz, real, imaginary) in spectrum(&STRIP, 5) {
        let phase = -imaginary.atan2(real).to_degrees();
        writeln!(polar, "{hz:.6e},{:.6e},{phase:.6e}", real.hypot(imaginary)).unwrap();
    }
    folder.write("runs/polar.csv", polar);
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let document = folder.ieap(&["impedance", "--json"]).expect(0).json();
    let spectra = document["spectra"].as_array().unwrap();
    let paths: Vec<&Value> = spectra.iter().map(|found| &found["run"]).collect();
    assert_eq!(paths, ["impedance/CNaf-01.csv", "runs/polar.csv"]);
    for found in spectra {
        assert_eq!(found["best"], "lumped-2", "{found:#}");
    }
    // They are no step responses.
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    assert_eq!(status["status"]["runs"], 1, "{status:#}");
    assert_eq!(status["status"]["spectra"], 2);
    let table = folder
        .ieap(&["table", "impedance", "--format", "csv"])
        .expect(0)
        .stdout;
    assert_eq!(
        table.lines().filter(|line| line.contains("lumped-2")).count(),
        2,
        "{table}"
    );
    let page = std::fs::read_to_string(folder.join("report/impedance.html")).unwrap();
    for text in [
        "Nyquist plot",
        "Bode plot",
        "Kramers-Kronig",
        "tell the same circuit",
    ] {
        assert!(page.contains(text), "{text}");
    }
    // A database that is made anew says the same.
    let before = folder.ieap(&["impedance", "--json"]).expect(0).stdout;
    folder.ieap(&["rebuild"]).expect(0);
    assert_eq!(folder.ieap(&["impedance", "--json"]).expect(0).stdout, before);
    folder.ieap(&["verify", "--deep"]).expect(0);
    // What a person drops says nothing any more.
    folder
        .ieap(&["drop", "impedance/CNaf-01.csv", "--why", "the clip slipped"])
        .expect(0);
    let document = folder.ieap(&["impedance", "--json"]).expect(0).json();
    assert_eq!(document["spectra"].as_array().unwrap().len(), 1);
    assert_eq!(document["set_aside"][0]["run"], "impedance/CNaf-01.csv");
}

/// Sweeps of one strip at several voltages, with no step beside them, and times too coarse to tell the frequencies apart.
#[test]
fn a_campaign_of_spectra_says_what_it_has_and_draws_the_capacitance() {
    let folder = CampaignFolder::new();
    folder.write("impedance/tags.toml", "sample = \"S1\"\nenvironment = \"air\"\n");
    for (k, volts) in [-1.0, -0.5, 0.0, 0.5, 1.0, 1.0].into_iter().enumerate() {
        let mut text = "Time (s),Frequency (Hz),Zre (Ohm),Zim (Ohm)\n".to_owned();
        let mut strip = STRIP;
        strip[3] *= 1.0 + 0.3 * volts * volts;
        for (at, (hz, real, imaginary)) in spectrum(&strip, 40 + k as u64).into_iter().enumerate() {
            writeln!(text, "{},{hz:.6e},{real:.6e},{imaginary:.6e}", at / 8).unwrap();
        }
        folder.write(&format!("impedance/s{k}.csv"), text);
        folder.write(
            &format!("impedance/s{k}.csv.toml"),
            format!("voltage_v = {volts:?}\n"),
        );
    }
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let document = folder.ieap(&["impedance", "--json"]).expect(0).json();
    let spectra = document["spectra"].as_array().unwrap();
    assert_eq!(spectra.len(), 6);
    for found in spectra {
        assert_eq!(
            (&found["frequencies"], &found["best"]),
            (&45.into(), &"lumped-2".into())
        );
    }
    let page = std::fs::read_to_string(folder.join("report/impedance.html")).unwrap();
    assert!(page.contains("Capacitance over voltage"));
    let titles: Vec<&str> = page
        .split("<h2")
        .skip(1)
        .filter(|part| part.contains("S1, air"))
        .collect();
    let titles: std::collections::BTreeSet<&str> = titles
        .iter()
        .filter_map(|part| part.split_once('>')?.1.split_once("</h2>"))
        .map(|own| own.0)
        .collect();
    assert_eq!(titles.len(), 6, "{titles:?}");
    let overview = std::fs::read_to_string(folder.join("report/index.html")).unwrap();
    assert!(
        overview.contains("6 impedance spectra; no run of a step."),
        "{overview}"
    );
}
