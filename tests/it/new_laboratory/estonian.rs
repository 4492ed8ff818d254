//! An Estonian laboratory: numbered files of a CH Instruments potentiostat that state their end, a camera's table under
//! numbers of its own, in the folders of two instruments; a run sheet as text says what each was.

use std::fs;

use super::truth::{Row, Truth, comma, simulated, tip_mm};
use super::{Person, is_true, nothing_is_lost, story};

const LENGTH_MM: f64 = 10.0;
const WIDTH_MM: f64 = 1.5;
const FIRST_MIN: usize = 10 * 60;
const EVERY_MIN: usize = 20;
/// The camera was started so long before the potentiostat, s.
const CAMERA_AHEAD_S: f64 = 15.0;

const KEYS: [(&str, &str, f64); 3] = [
    ("vaakum", "vacuum", 0.0),
    ("argoon", "argoon", 0.0),
    ("õhk", "air", 35.0),
];
const VOLTAGES: [f64; 2] = [2.0, -1.5];

fn truths() -> Vec<(&'static str, Truth)> {
    let mut truths = Vec::new();
    for sample in ["CDC-3", "CDC-4"] {
        for (word, environment, humidity_percent) in KEYS {
            for voltage_v in VOLTAGES {
                let number = truths.len() + 1;
                let truth = Truth {
                    run: format!("runs/vool/{number:04}.txt"),
                    sample: sample.to_owned(),
                    environment,
                    voltage_v,
                    humidity_percent,
                    parameters: [300.0, 0.03, 500.0, 0.05, 6500.0, 12.0, 5e-3],
                };
                truths.push((word, truth));
            }
        }
    }
    truths
}

/// A CH Instruments text: its date is the end of the record, of 400 s.
fn chi(start_min: usize, voltage_v: f64, rows: &[Row]) -> String {
    let end_s = start_min * 60 + 400;
    let head = format!(
        "March 17, 2026   {:02}:{:02}:{:02}\r\nAmperometric i-t Curve\r\nFile: c:\\data\\it.bin\r\nData Source:  Experiment\r\n\
         Instrument Model:  CHI660E\r\nHeader: \r\nNote: \r\n\r\nInit E (V) = {voltage_v}\r\nSample Interval (s) = 1\r\n\
         Run Time (sec) = 400\r\nQuiet Time (sec) = 0\r\nSensitivity (A/V) = 1e-3\r\n\r\nTime/sec, Current/A\r\n\r\n",
        end_s / 3600,
        end_s / 60 % 60,
        end_s % 60
    );
    let rows = rows
        .iter()
        .filter(|row| row[0] > 0.0)
        .map(|[t, _, i, _]| format!("{t:.3e}, {i:.5e}\r\n"));
    head + &rows.collect::<String>()
}

/// The camera's table on its own clock, with the moment of its start.
fn camera(start_min: usize, rows: &[Row]) -> String {
    let began_s = start_min * 60 - CAMERA_AHEAD_S as usize;
    let rows = rows.iter().filter(|row| row[0] > -CAMERA_AHEAD_S);
    let rows = rows.map(|[t, _, _, kappa]| {
        format!(
            "{}\t{}\n",
            comma(t + CAMERA_AHEAD_S, 2),
            comma(tip_mm(*kappa, LENGTH_MM), 5)
        )
    });
    format!(
        "Algus: 17.03.2026 {:02}:{:02}:{:02}\nAeg (s)\tSiire (mm)\n{}",
        began_s / 3600,
        began_s / 60 % 60,
        began_s % 60,
        rows.collect::<String>()
    )
}

fn logger(runs: usize) -> String {
    let mut text = String::from("Kuupäev;Kellaaeg;Temperatuur (°C);Suhteline niiskus (%)\n");
    for minutes in (FIRST_MIN - 30)..(FIRST_MIN + EVERY_MIN * runs + 60) {
        text += &format!(
            "17.03.2026;{:02}:{:02}:00;22,1;{}\n",
            minutes / 60,
            minutes % 60,
            comma(35.4, 1)
        );
    }
    text
}

#[test]
fn an_estonian_laboratory_goes_from_its_folder_to_a_true_report() {
    let person = Person::new("Europe/Tallinn");
    let truths = truths();
    let tables = simulated(&truths, 62, (LENGTH_MM * WIDTH_MM / 100.0, 20.0));
    let write = |name: &str, content: &str| {
        let path = person.path("katsed").join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, content).unwrap();
    };
    let mut sheet = String::from("Nr;Fail;Proov;Keskkond;Niiskus (%);Pinge (V);Märkused\n");
    for (at, ((word, truth), rows)) in truths.iter().zip(&tables).enumerate() {
        let start_min = FIRST_MIN + EVERY_MIN * at;
        write(
            &format!("vool/{:04}.txt", at + 1),
            &chi(start_min, truth.voltage_v, rows),
        );
        write(&format!("kaamera/M{}.csv", at + 117), &camera(start_min, rows));
        sheet += &format!(
            "{};{:04}.txt;{};{word};{};{};\n",
            at + 1,
            at + 1,
            truth.sample,
            comma(truth.humidity_percent, 0),
            comma(truth.voltage_v, 1)
        );
    }
    write("Katsete leht.csv", &sheet);
    write("niiskus/ruum.csv", &logger(truths.len()));

    let shown = person.makes(
        "uuring",
        "katsed",
        &[
            "12 runs",
            "12 runs in two files each",
            "1 climate log",
            "1 run sheet",
        ],
        (LENGTH_MM, WIDTH_MM),
    );
    // Numbers of records say nothing of a run.
    assert!(!shown.contains("name_pattern"), "{shown}");
    person.types(&["run", "uuring", "--no-diagnose"]).expect(0);

    let stories = person.stories("uuring");
    nothing_is_lost(&stories, &person.path("katsed"));
    let half = story(&stories, "runs/vool/0004.txt");
    assert_eq!(half["partner"], "runs/kaamera/M120.csv, by their times");
    assert_eq!(half["words"], serde_json::json!([]));
    let tags = half["tags"].as_array().unwrap();
    let start = tags.iter().find(|tag| tag["key"] == "started_at").unwrap();
    assert!(
        start["value"].as_str().unwrap().starts_with("2026-03-17T1"),
        "{start:#}"
    );
    is_true(&person, "uuring", (&truths, &[]));
    person.was_quick("uuring");
}
