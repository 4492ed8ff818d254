//! A French laboratory: potentiostat text here, laser there, the room's logger in local time, and a run sheet as a workbook
//! with merged cells. Among the runs lie a cut one, one whose laser wrote micrometres, a copy, a half without partner.

use std::fs;

use super::truth::{Row, Truth, comma, simulated, tip_mm};
use super::{Person, is_true, nothing_is_lost, story};
use crate::sheet_writer::Xml::{None as Gap, Number, Text};
use crate::sheet_writer::{Xml, merged_workbook, sheet};

const LENGTH_MM: f64 = 8.0;
const WIDTH_MM: f64 = 2.0;
/// The first run began then, minutes after midnight of 16 March 2026 in Paris; the others follow every quarter of an hour.
const FIRST_MIN: usize = 9 * 60;
const EVERY_MIN: usize = 15;

/// Atmosphere as the sheet says it, environment, humidity in percent, run number in the name.
const ATMOSPHERES: [(&str, &str, f64, usize); 4] = [
    ("vide", "vacuum", 0.0, 1),
    ("argon", "argon", 0.0, 1),
    ("air", "air", 40.0, 1),
    ("air", "air", 60.0, 2),
];
const VOLTAGES: [(f64, &str); 3] = [(2.0, "+2V"), (-2.0, "-2V"), (1.0, "+1V")];

fn truths() -> Vec<(String, Truth)> {
    let mut truths = Vec::new();
    for (s, sample) in ["PtNaf1", "PtNaf2"].into_iter().enumerate() {
        for (word, environment, humidity_percent, number) in ATMOSPHERES {
            for (voltage_v, volts) in VOLTAGES {
                let of_sample = 1.0 + 0.1 * s as f64;
                let wet = 1.0 + humidity_percent / 100.0;
                let stem = format!("{sample}_{word}_{volts}_{number}");
                let truth = Truth {
                    run: format!("runs/potentiostat/{stem}.txt"),
                    sample: sample.to_owned(),
                    environment,
                    voltage_v,
                    humidity_percent,
                    parameters: [
                        520.0 * of_sample,
                        0.02,
                        400.0,
                        0.06,
                        5600.0,
                        14.0 * wet,
                        4e-3 * wet,
                    ],
                };
                truths.push((stem, truth));
            }
        }
    }
    truths
}

fn moment(minutes: usize) -> String {
    format!("16/03/2026 {:02}:{:02}:00", minutes / 60, minutes % 60)
}

fn potentiostat(start_min: usize, rows: &[Row]) -> String {
    let rows = rows
        .iter()
        .map(|[t, v, i, _]| format!("{}\t{}\t{}\r\n", comma(*t, 2), comma(*v, 3), comma(i * 1e3, 5)));
    format!(
        "Potentiostat du laboratoire\r\nDébut : {}\r\n\r\nTemps (s)\tTension (V)\tCourant (mA)\r\n{}",
        moment(start_min),
        rows.collect::<String>()
    )
}

fn laser(rows: &[Row], unit_per_mm: f64) -> String {
    let row = |[t, _, _, kappa]: &Row| {
        format!(
            "{};{}\n",
            comma(*t, 2),
            comma(tip_mm(*kappa, LENGTH_MM) * unit_per_mm, 5)
        )
    };
    format!(
        "Temps (s);Déplacement (mm)\n{}",
        rows.iter().map(row).collect::<String>()
    )
}

/// The room's logger: its humidity is that of the runs in air, whatever surrounds the strip.
fn logger(truths: &[(String, Truth)]) -> String {
    let mut text = String::from("Date;Heure;Température [°C];Humidité [%HR]\n");
    for minutes in (FIRST_MIN - 30..FIRST_MIN + EVERY_MIN * truths.len() + 60).step_by(1) {
        let at = minutes.saturating_sub(FIRST_MIN) / EVERY_MIN;
        let truth = &truths[at.min(truths.len() - 1)].1;
        let room = if truth.environment == "air" {
            truth.humidity_percent
        } else {
            45.0
        };
        let (date, time) = moment(minutes)
            .split_once(' ')
            .map(|(d, t)| (d.to_owned(), t.to_owned()))
            .unwrap();
        text += &format!("{date};{time};{};{}\n", comma(21.5, 1), comma(room + 0.3, 1));
    }
    text
}

/// The run sheet: sample and atmosphere are merged over their runs.
fn run_sheet(truths: &[(String, Truth)]) -> Vec<u8> {
    let files: Vec<String> = truths.iter().map(|(stem, _)| format!("{stem}.txt")).collect();
    let words: Vec<&str> = truths
        .iter()
        .map(|(stem, _)| stem.split('_').nth(1).unwrap())
        .collect();
    let mut rows: Vec<Vec<Xml<'_>>> = vec![
        vec![Text("Feuille de route, mars 2026")],
        vec![],
        vec![
            Text("N°"),
            Text("Échantillon"),
            Text("Atmosphère"),
            Text("HR (%)"),
            Text("Tension (V)"),
            Text("Fichier"),
            Text("Opérateur"),
            Text("Remarques"),
        ],
    ];
    let mut merged = vec!["A1:H1".to_owned()];
    for (at, (_, truth)) in truths.iter().enumerate() {
        let of_atmosphere = |cell| if at % 3 == 0 { cell } else { Gap };
        rows.push(vec![
            Number(at as f64 + 1.0),
            if at % 12 == 0 { Text(&truth.sample) } else { Gap },
            of_atmosphere(Text(words[at])),
            of_atmosphere(Number(truth.humidity_percent)),
            Number(truth.voltage_v),
            Text(&files[at]),
            if at == 0 { Text("Anaïs") } else { Gap },
            Gap,
        ]);
        let row = rows.len();
        if at % 3 == 0 {
            merged.extend(["C", "D"].map(|column| format!("{column}{row}:{column}{}", row + 2)));
        }
        if at % 12 == 0 {
            merged.push(format!("B{row}:B{}", row + 11));
        }
        if at == 0 {
            merged.push(format!("G{row}:G{}", row + truths.len() - 1));
        }
    }
    let rows: Vec<&[Xml<'_>]> = rows.iter().map(Vec::as_slice).collect();
    merged_workbook(&[sheet(&rows)], &merged.join(" "))
}

#[test]
fn a_french_laboratory_goes_from_its_folder_to_a_true_report() {
    let person = Person::new("Europe/Paris");
    let truths = truths();
    let tables = simulated(&truths, 61, (LENGTH_MM * WIDTH_MM / 100.0, 15.0));
    let write = |name: &str, content: &[u8]| {
        let path = person.path("mesures").join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, content).unwrap();
    };
    let (cut, micrometres, lone) = ("PtNaf1_argon_-2V_1", "PtNaf2_vide_+1V_1", "PtNaf2_air_-2V_2");
    for (at, ((stem, _), rows)) in truths.iter().zip(&tables).enumerate() {
        let mut text = potentiostat(FIRST_MIN + EVERY_MIN * at, rows);
        if stem == cut {
            // The computer was switched off in the middle of a row.
            text.truncate(text.len() * 3 / 4);
        }
        write(&format!("potentiostat/{stem}.txt"), text.as_bytes());
        if stem == lone {
            continue;
        }
        let unit = if stem == micrometres { 1000.0 } else { 1.0 };
        let name = stem.replace("+", "p").replace('-', "m");
        write(&format!("laser/laser_{name}.csv"), laser(rows, unit).as_bytes());
    }
    let copied = fs::read(person.path("mesures/potentiostat/PtNaf1_vide_+2V_1.txt")).unwrap();
    write("potentiostat/PtNaf1_vide_+2V_1 (copie).txt", &copied);
    write("testo/salle_B12.csv", logger(&truths).as_bytes());
    write("feuille de route.xlsx", &run_sheet(&truths));
    write("notes.docx", b"PK not really");

    // Everything is shown before it is taken.
    let document = person
        .looks(&["init", "etude", "--from", "mesures", "--json"])
        .expect(0)
        .json();
    assert!(document.to_string().contains("same-bytes"));
    person.makes(
        "etude",
        "mesures",
        &[
            "24 runs", // the lone half among them
            "23 runs in two files each",
            "1 climate log",
            "1 run sheet",
            "1 copy of a run's file",
            "waits for laser/laser_PtNaf2_air_m2V_2.csv with the bending",
        ],
        (LENGTH_MM, WIDTH_MM),
    );
    let first = person.types(&["run", "etude", "--no-diagnose"]);
    assert_eq!(first.status, 3, "{first:#?}");
    // One tip moves further than its strip is long.
    let status = person.types(&["status", "etude"]);
    assert!(
        status.stdout.contains("the strip is 8 mm long"),
        "{}",
        status.stdout
    );
    let name = format!("{micrometres}.txt");
    person
        .types(&["drop", &name, "etude", "--why", "laser en micromètres"])
        .expect(0);
    person.types(&["run", "etude", "--no-diagnose"]);

    let stories = person.stories("etude");
    nothing_is_lost(&stories, &person.path("mesures"));
    let of = |stem: &str| story(&stories, &format!("runs/potentiostat/{stem}.txt"));
    let half = of("PtNaf1_vide_-2V_1");
    assert_eq!(half["became"], "half of a run");
    assert_eq!(
        half["partner"],
        "runs/laser/laser_PtNaf1_vide_m2V_1.csv, by the words of their names"
    );
    let words: Vec<String> = half["words"]
        .as_array()
        .unwrap()
        .iter()
        .map(|word| {
            format!(
                "{}: {}",
                word["word"].as_str().unwrap(),
                word["taken_for"].as_str().unwrap()
            )
        })
        .collect();
    assert_eq!(words[..2], ["PtNaf1: sample", "vide: environment = vacuum"]);
    let tag = |key: &str| {
        let tags = half["tags"].as_array().unwrap();
        let found = tags.iter().find(|tag| tag["key"] == key).unwrap();
        (
            found["value"].as_str().unwrap().to_owned(),
            found["from"].as_str().unwrap().to_owned(),
        )
    };
    assert_eq!(tag("environment").0, "vacuum");
    assert!(
        tag("environment")
            .1
            .starts_with("run sheet: runs/feuille de route.xlsx"),
        "{:?}",
        tag("environment")
    );
    assert_eq!(tag("operator").0, "Anaïs");
    assert!(
        tag("started_at").0.starts_with("2026-03-16T09:15:00"),
        "{:?}",
        tag("started_at")
    );
    assert_eq!(of(lone)["became"], "half without partner");
    assert_eq!(of("PtNaf1_vide_+2V_1 (copie)")["became"], "copy of a file");
    let page = fs::read_to_string(person.path("etude/report/files.html")).unwrap();
    assert!(page.contains("laser_PtNaf1_vide_m2V_1.csv") && page.contains("notes.docx"));

    // The half without bending is a run of its current: it is fitted, and tells no alpha.
    let kept: Vec<(String, Truth)> = truths
        .into_iter()
        .filter(|(stem, _)| stem != micrometres && stem != lone)
        .collect();
    let lone_run = format!("runs/potentiostat/{lone}.txt");
    is_true(&person, "etude", (&kept, &[&lone_run]));
    person.was_quick("etude");
}
