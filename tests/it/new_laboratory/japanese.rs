//! A Japanese laboratory in Shift-JIS: LabVIEW files, a laser's text, a logger with half-days in words and a footer, an analyser's
//! moduli, and a run sheet whose column of files is called after LabVIEW.

use std::fs;

use encoding_rs::SHIFT_JIS;

use super::truth::{Row, Truth, simulated, tip_mm};
use super::{Person, is_true, nothing_is_lost, story};

const LENGTH_MM: f64 = 8.0;
const WIDTH_MM: f64 = 2.0;
const FIRST_MIN: usize = 8 * 60;
const EVERY_MIN: usize = 10;

/// Atmosphere as the sheet says it, environment, humidity in percent.
const ATMOSPHERES: [(&str, &str, f64); 4] = [
    ("真空", "vacuum", 0.0),
    ("窒素", "窒素", 0.0),
    ("空気", "air", 30.0),
    ("空気", "air", 60.0),
];
const VOLTAGES: [f64; 3] = [2.0, -2.0, 1.0];
const REPEATS: usize = 2;

/// The runs of so many samples, each with the word of its atmosphere.
fn truths(samples: usize) -> Vec<(&'static str, Truth)> {
    let mut truths = Vec::new();
    for sample in 1..=samples {
        for (word, environment, humidity_percent) in ATMOSPHERES {
            for voltage_v in VOLTAGES {
                for _ in 0..REPEATS {
                    let wet = 1.0 + humidity_percent / 100.0;
                    let truth = Truth {
                        run: format!("runs/LabVIEW/M{:03}.lvm", truths.len() + 1),
                        sample: format!("PtNaf-{sample}"),
                        environment,
                        voltage_v,
                        humidity_percent,
                        parameters: [520.0, 0.02, 400.0, 0.06, 5600.0, 14.0 * wet, 4e-3 * wet],
                    };
                    truths.push((word, truth));
                }
            }
        }
    }
    truths
}

/// Day of March and minutes of the day of a run; each day has as many as fit.
fn moment(at: usize) -> (usize, usize) {
    let of_day = 12 * 60 / EVERY_MIN;
    (16 + at / of_day, FIRST_MIN + at % of_day * EVERY_MIN)
}

fn labview(at: usize, rows: &[Row]) -> String {
    let (day, minutes) = moment(at);
    let start = format!("{:02}:{:02}:00.0000000", minutes / 60, minutes % 60);
    let date = format!("2026/03/{day}");
    let n = rows.len();
    let head = format!(
        "LabVIEW Measurement\t\r\nWriter_Version\t2\r\nReader_Version\t2\r\nSeparator\tTab\r\nDecimal_Separator\t.\r\n\
         Multi_Headings\tNo\r\nX_Columns\tOne\r\nTime_Pref\tAbsolute\r\nOperator\t山田\r\nDate\t{date}\r\nTime\t{start}\r\n\
         ***End_of_Header***\t\r\n\t\r\nChannels\t2\t\t\r\nSamples\t{n}\t{n}\t\r\nDate\t{date}\t{date}\t\r\n\
         Time\t{start}\t{start}\t\r\nY_Unit_Label\tVolts\tAmps\t\r\nX_Dimension\tTime\tTime\t\r\nX0\t0.0\t0.0\t\r\n\
         Delta_X\t1.000000\t1.000000\t\r\n***End_of_Header***\t\t\t\r\nX_Value\t電圧\t電流\tComment\r\n"
    );
    let row = |[t, v, i, _]: &Row| format!("{t:.6}\t{v:.6}\t{i:.8}\r\n");
    head + &rows.iter().map(row).collect::<String>()
}

fn laser(rows: &[Row]) -> String {
    let row = |[t, _, _, kappa]: &Row| format!("{t:.2},{:+.5}\r\n", tip_mm(*kappa, LENGTH_MM));
    let rows: String = rows.iter().map(row).collect();
    format!("レーザ変位計 測定データ\r\nヘッド番号,1\r\n\r\n経過時間(s),OUT1 変位(mm)\r\n{rows}")
}

/// The room's logger: its humidity is that of the runs in air, whatever surrounds the strip.
fn logger(truths: &[(&str, Truth)]) -> String {
    let mut text = String::from("機種名,TR-72\r\n設置場所,B棟201\r\n\r\n日時,温度(℃),湿度(%)\r\n");
    for (at, (_, truth)) in truths.iter().enumerate() {
        let (day, first) = moment(at);
        let humidity = if truth.environment == "air" {
            truth.humidity_percent
        } else {
            45.0
        };
        for minutes in first..first + EVERY_MIN {
            let half = if minutes < 12 * 60 { "午前" } else { "午後" };
            let (hour, minute) = (minutes / 60 % 12, minutes % 60);
            text += &format!(
                "2026/03/{day} {half}{hour}:{minute:02}:00,21.5,{:.1}\r\n",
                humidity + 0.3
            );
        }
    }
    text + "\r\n記録終了\r\n"
}

/// An analyser's log of one strip at three humidities.
fn moduli() -> String {
    let mut text =
        String::from("時間 (min)\t温度 (℃)\t貯蔵弾性率 E' (MPa)\t損失弾性率 E\" (MPa)\t湿度 (%RH)\r\n");
    for step in 0..360 {
        let humidity = 40 * (step / 120);
        let modulus = 120.0 - 0.4 * f64::from(humidity);
        let noise = 0.05 * (f64::from(step) * 1.7).sin();
        text += &format!(
            "{:.1}\t25.0\t{:.3}\t{:.3}\t{humidity}\r\n",
            f64::from(step) * 0.5,
            modulus + noise,
            modulus / 10.0
        );
    }
    text
}

fn run_sheet(truths: &[(&str, Truth)]) -> String {
    let mut text =
        String::from("IPMC 実験記録,,,,,,\r\n番号,試料,雰囲気,湿度(%),電圧(V),LabVIEWファイル,備考\r\n");
    for (at, (word, truth)) in truths.iter().enumerate() {
        let number = at + 1;
        text += &format!(
            "{number},{},{word},{},{},M{number:03},\r\n",
            truth.sample, truth.humidity_percent, truth.voltage_v
        );
    }
    text
}

fn from_folder_to_report(samples: usize) {
    let person = Person::new("Asia/Tokyo");
    let truths = truths(samples);
    let tables = simulated(&truths, 63, (LENGTH_MM * WIDTH_MM / 100.0, 15.0));
    let write = |name: &str, text: &str| person.puts("測定", name, SHIFT_JIS, text);
    for (at, rows) in tables.iter().enumerate() {
        write(&format!("LabVIEW/M{:03}.lvm", at + 1), &labview(at, rows));
        write(&format!("変位計/M{:03}.csv", at + 1), &laser(rows));
    }
    write("温湿度/おんどとり.csv", &logger(&truths));
    write("DMA/PtNaf-1.txt", &moduli());
    write("実験記録.csv", &run_sheet(&truths));
    write(
        "メモ.txt",
        "測定メモ：湿度が高い日は除く。\r\n明日もう一度測る。\r\n",
    );

    let runs = format!("{} runs in two files each", truths.len());
    person.makes(
        "kenkyu",
        "測定",
        &[&runs, "1 climate log", "1 modulus log", "1 run sheet", "メモ.txt"],
        (LENGTH_MM, WIDTH_MM),
    );
    person.types(&["run", "kenkyu", "--no-diagnose"]).expect(0);
    // What is no data was said, and is not copied.
    fs::remove_file(person.path("測定/メモ.txt")).unwrap();
    let stories = person.stories("kenkyu");
    nothing_is_lost(&stories, &person.path("測定"));
    assert_eq!(
        story(&stories, "runs/LabVIEW/M004.lvm")["became"],
        "half of a run"
    );
    let status = person.looks(&["status", "kenkyu", "--json"]).expect(0).json();
    assert_eq!(
        status["status"]["modulus_logs_by_state"],
        serde_json::json!({ "analysed": 1 }),
        "{status:#}"
    );
    is_true(&person, "kenkyu", (&truths, &[]));
    person.was_quick("kenkyu");
}

#[test]
fn a_japanese_laboratory_goes_from_its_folder_to_a_true_report() {
    from_folder_to_report(1);
}

/// docs/validation/readers.md states what this holds.
#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn two_hundred_japanese_files_go_to_a_true_report() {
    from_folder_to_report(4);
}
