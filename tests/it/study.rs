//! What the study asked, from files to the terminal, the document, the table and the page.

use std::fmt::Write as _;

use serde_json::Value;

use crate::campaign::CampaignFolder;

/// Two materials, two strips each, in vacuum and in air at 1 and 2 V, twice: bending of PVdF halves in vacuum.
fn folder() -> CampaignFolder {
    let folder = CampaignFolder::new();
    std::fs::remove_file(folder.join("runs/tags.toml")).unwrap();
    let mut toml = String::from("[campaign]\nid = \"study\"\n");
    let mut number = 0.0;
    for (material, strip) in [("Nafion", 1), ("Nafion", 2), ("PVdF", 1), ("PVdF", 2)] {
        write!(
            toml,
            "[[sample]]\nid = \"{material}-{strip}\"\nmaterial = \"{material}\"\nlength_mm = 5.0\nwidth_mm = 2.0\n"
        )
        .unwrap();
        for (environment, voltage_v, repeat) in [
            ("vacuum", 1, 1),
            ("air", 1, 1),
            ("air", 2, 1),
            ("vacuum", 2, 1),
            ("vacuum", 1, 2),
            ("air", 2, 2),
        ] {
            let halved = material == "PVdF" && environment == "vacuum";
            number += 1.0;
            let alpha = 20.0 * if halved { 0.5 } else { 1.0 } * (1.0 + 0.02 * f64::sin(number));
            folder.write(
                &format!("runs/{material}-{strip}_{environment}_ignored_{voltage_v}V_{repeat}.csv"),
                run(f64::from(voltage_v), alpha, number),
            );
        }
    }
    toml += "[runs]\nname_pattern = \"{sample}_{environment}_{_}_{voltage_v}V_{cycle}\"\n";
    folder.write("campaign.toml", toml);
    folder
}

/// A step of a strip with two branches; a noise that only `seed` decides.
fn run(volts: f64, alpha: f64, seed: f64) -> String {
    let mut text = String::from("time_s,voltage_v,current_a,curvature_per_cm\n");
    let (area_cm2, relaxation_per_s) = (0.1, 1e-4);
    let branches = [(100.0, 0.05), (400.0, 0.1)];
    for k in 0..140 {
        let t = if k < 10 {
            f64::from(k) - 10.0
        } else {
            0.1 * 1.075_f64.powi(k - 10)
        };
        let on = t >= 0.0;
        let part = |(r, c): (f64, f64)| {
            let (tau, relaxed) = (r * c, (-relaxation_per_s * t).exp());
            let gone = (-t / tau).exp();
            (
                volts / r * gone,
                c * volts / (1.0 - relaxation_per_s * tau) * (relaxed - gone),
            )
        };
        let (mut current, mut charge) = (volts / 3e4, 0.0);
        for own in branches.map(part) {
            (current, charge) = (current + own.0, charge + own.1);
        }
        let noise = |rate: f64| (seed + rate * f64::from(k)).sin();
        let (volts, amperes, bent) = if on {
            (volts, area_cm2 * current, alpha * area_cm2 * charge)
        } else {
            (0.0, 0.0, 0.0)
        };
        writeln!(
            text,
            "{t:.4},{volts},{:.9},{:.6}",
            amperes + 1e-6 * noise(12.9898),
            bent + 2e-3 * noise(78.233)
        )
        .unwrap();
    }
    text
}

#[test]
fn the_question_of_the_study_leads_in_every_medium() {
    let folder = folder();
    folder.ieap(&["run", "--no-diagnose", "--quiet"]).expect(0);
    let document: Value = folder.ieap(&["study", "--json"]).expect(0).json();
    assert_eq!(document["schema"], "ieap/study/1");
    let answers = document["answers"].as_array().unwrap();
    let asked = |material: &str, parameter: &str| {
        let is_asked = |own: &&Value| {
            own["is_of_study"] == true
                && own["kind"] == "environment"
                && own["material"] == material
                && own["parameter"] == parameter
        };
        answers.iter().find(is_asked).unwrap()
    };
    let alpha = |material| asked(material, "alpha_per_c_cm");
    let (halved, alike) = (alpha("PVdF"), alpha("Nafion"));
    assert_eq!(
        (&halved["verdict"], &halved["upper"], &halved["lower"]),
        (&"differs".into(), &"air".into(), &"vacuum".into())
    );
    let ends = [&halved["low_95"], &halved["high_95"]].map(|end| end.as_f64().unwrap());
    assert!(ends[0] < 2.0 && 2.0 < ends[1] && ends[1] < 2.5, "{halved}");
    assert_eq!(alike["verdict"], "alike", "{alike}");
    assert!(alike["no_more_than"].as_f64().unwrap() < 20.0, "{alike}");
    // The whole curve of bending is 1 against 0.5: two thirds of the 0.75 in the middle.
    let bent = asked("PVdF", "bending_curve");
    let largest = bent["value"].as_f64().unwrap();
    assert!(
        bent["verdict"] == "differs" && (largest - 66.7).abs() < 4.0,
        "{bent}"
    );
    for own in [asked("Nafion", "bending_curve"), asked("PVdF", "current_curve")] {
        assert!(
            own["verdict"] == "alike" && own["no_more_than"].as_f64().unwrap() < 20.0,
            "{own}"
        );
    }
    let line = "In air, against vacuum, PVdF's coupling α rises 2.0-fold (";
    let said = folder.ieap(&["study"]).expect(0).stdout;
    assert!(said.contains(line), "{said}");
    for page in ["index.html", "study.html"] {
        assert!(folder.report(page).replace("&#39;", "'").contains(line), "{page}");
    }
    let table: Value = folder
        .ieap(&["table", "contrasts", "--format", "json"])
        .expect(0)
        .json();
    assert_eq!(table["rows"].as_array().unwrap().len(), answers.len());
}

#[test]
fn what_a_study_cannot_ask_is_refused_with_what_it_can() {
    let folder = folder();
    // A study reads what is stored.
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let toml = std::fs::read_to_string(folder.path().join("campaign.toml")).unwrap();
    for (rule, needed) in [
        (
            "compare = [\"colour\"]",
            "environment, humidity, voltage, material",
        ),
        ("within = [\"sample\"]", "none of material"),
        ("at_equal = [\"humidity\"]", "none of voltage"),
        ("scatter_percent = -1", "above 0"),
    ] {
        folder.write("campaign.toml", format!("{toml}\n[study]\n{rule}\n"));
        let refused = folder.ieap(&["study"]);
        assert!(
            refused.status != 0 && refused.stderr.contains(needed),
            "{rule}: {refused:?}"
        );
    }
    folder.write(
        "campaign.toml",
        format!("{toml}\n[study]\ncompares = [\"humidity\"]\n"),
    );
    let warned = folder.ieap(&["study"]);
    assert!(
        warned.stderr.contains("compares") && warned.stderr.contains("compare"),
        "{warned:?}"
    );
}

/// The report keeps what the study answered: whoever asks afterwards is told the same as without it, and as before a report that
/// somebody altered.
#[test]
fn what_a_report_keeps_is_what_is_told_without_it() {
    let folder = folder();
    folder.ieap(&["fit"]).expect(0);
    let told = || -> Vec<String> {
        let asked: [&[&str]; 4] = [
            &["study", "--json"],
            &["table", "contrasts", "--json"],
            &["table", "laws", "--json"],
            &["next", "--json"],
        ];
        asked.map(|words| folder.ieap(words).expect(0).stdout).into()
    };
    let without = told();
    folder.ieap(&["report"]).expect(0);
    assert_eq!(told(), without);
    let kept = folder.join("report/.values");
    let bytes = std::fs::read(&kept).unwrap();
    // A number of a kept answer, one digit off: it would be read, and be wrong.
    let mut altered = bytes.clone();
    let last = altered.len() - 9;
    altered[last] ^= 1;
    std::fs::write(&kept, &altered).unwrap();
    assert_eq!(told(), without);
    // A run more is in none of the kept answers.
    std::fs::write(&kept, bytes).unwrap();
    folder.write("runs/PVdF-2_air_ignored_1V_3.csv", run(1.0, 31.0, 99.0));
    folder.ieap(&["fit"]).expect(0);
    assert_ne!(told()[0], without[0]);
}
