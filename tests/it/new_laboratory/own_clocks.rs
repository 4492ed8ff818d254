//! Laboratories with two instruments, each with a clock and names of its own: no name pairs their files, the words for a start are
//! of any language, and strips are called N1 and N2. As delivered they go to a true report.

use encoding_rs::{EUC_KR, Encoding, GBK, SHIFT_JIS, WINDOWS_1250};
use jiff::ToSpan;
use jiff::civil::DateTime;

use super::truth::{Row, Truth, comma, simulated, tip_mm};
use super::{Person, is_true, nothing_is_lost};
use crate::sheet_writer::Xml::{None as Gap, Number, Text};
use crate::sheet_writer::{Xml, merged_workbook, sheet};

const LENGTH_MM: f64 = 10.0;
const WIDTH_MM: f64 = 2.0;
const BASELINE_S: f64 = 20.0;

/// How a laboratory writes.
struct Laboratory {
    zone: &'static str,
    encoding: &'static Encoding,
    folder: &'static str,
    strips: &'static [&'static str],
    /// Its word for an atmosphere, environment, humidity in percent.
    airs: &'static [(&'static str, &'static str, f64)],
    voltages: &'static [f64],
    /// Folder of the files with the current.
    electrical: &'static str,
    /// By how much the clock of the laser is ahead, s.
    ahead_s: i64,
    /// Name and text of the file with the current, of one with the bending.
    current: fn(usize, DateTime, &[Row]) -> (String, String),
    bending: fn(usize, &str, DateTime, &[Row]) -> (String, String),
}

impl Laboratory {
    fn truths(&self) -> Vec<(&'static str, Truth)> {
        let mut truths = Vec::new();
        for (word, environment, humidity_percent) in self.airs {
            for sample in self.strips {
                for voltage_v in self.voltages {
                    let wet = 1.0 + humidity_percent / 100.0;
                    let (name, _) = (self.current)(truths.len(), DateTime::default(), &[]);
                    let truth = Truth {
                        run: format!("runs/{}/{name}", self.electrical),
                        sample: (*sample).to_owned(),
                        environment,
                        voltage_v: *voltage_v,
                        humidity_percent: *humidity_percent,
                        parameters: [300.0, 0.03, 500.0, 0.05, 6500.0, 12.0 * wet, 5e-3 * wet],
                    };
                    truths.push((*word, truth));
                }
            }
        }
        truths
    }

    /// Its files but the sheet, and a name and a truth a run with the name of its bending.
    fn delivers(&self, person: &Person) -> Vec<(&'static str, Truth, String)> {
        let truths = self.truths();
        let tables = simulated(&truths, 88, (LENGTH_MM * WIDTH_MM / 100.0, BASELINE_S));
        let mut at: DateTime = "2026-06-13T09:02:11".parse().unwrap();
        let mut of_runs = Vec::new();
        for (k, (rows, (word, truth))) in tables.iter().zip(truths).enumerate() {
            at = at
                .checked_add((700 + 97 * (k as i64 * 13 % 11)).seconds())
                .unwrap();
            // The laser is begun by hand, some seconds before the step.
            let late_s = 11 + k as i64 * 7 % 6;
            let (name, text) = (self.current)(k, at, rows);
            person.puts(
                self.folder,
                &format!("{}/{name}", self.electrical),
                self.encoding,
                &text,
            );
            let began = at.checked_add((late_s + self.ahead_s).seconds()).unwrap();
            let shifted: Vec<Row> = rows[late_s as usize..]
                .iter()
                .map(|[t, v, i, kappa]| [t - rows[late_s as usize][0], *v, *i, *kappa])
                .collect();
            let (name, text) = (self.bending)(k, &truth.sample, began, &shifted);
            person.puts(self.folder, &format!("laser/{name}"), self.encoding, &text);
            of_runs.push((word, truth, name));
        }
        of_runs
    }

    /// From the folder to a report, by few commands, and with no question.
    fn goes_to_a_true_report(
        &self,
        sheet: impl Fn(&[(&str, Truth, String)]) -> (&'static str, Vec<u8>),
        are_sizes_told: bool,
    ) {
        let person = Person::new(self.zone);
        let of_runs = self.delivers(&person);
        let (name, bytes) = sheet(&of_runs);
        std::fs::write(person.path(self.folder).join(name), bytes).unwrap();
        let runs = format!("{} runs in two files each", of_runs.len());
        let shown = if are_sizes_told {
            let from = ["init", "study", "--from", self.folder, "--yes"];
            person.types(&from[..4]).expect(0);
            person.types(&from).expect(0).stdout
        } else {
            person.makes("study", self.folder, &[], (LENGTH_MM, WIDTH_MM))
        };
        assert!(shown.contains(&runs) && shown.contains("1 run sheet"), "{shown}");
        assert!(shown.lines().count() <= 60, "{shown}");
        person.types(&["run", "study", "--no-diagnose"]).expect(0);
        let status = person.types(&["status", "study"]).expect(0).stdout;
        assert!(status.lines().count() <= 40, "{status}");
        nothing_is_lost(&person.stories("study"), &person.path(self.folder));
        let truths: Vec<(&str, Truth)> = of_runs
            .into_iter()
            .map(|(word, truth, _)| (word, truth))
            .collect();
        is_true(&person, "study", (&truths, &[]));
        person.was_quick("study");
    }

    /// A sheet as a text: a row of names, and a row of a run.
    fn text_sheet(
        &self,
        names: &str,
        row: impl Fn(usize, &str, &Truth, &str, &str) -> String,
        runs: &[(&str, Truth, String)],
    ) -> Vec<u8> {
        let mut text = names.to_owned();
        for (k, (word, truth, bending)) in runs.iter().enumerate() {
            let current = truth.run.rsplit('/').next().unwrap();
            text += &row(k, word, truth, current, bending);
        }
        self.encoding.encode(&text).0.into_owned()
    }
}

fn lines(rows: &[Row], line: impl Fn(&Row) -> String) -> String {
    rows.iter().map(line).collect()
}

#[test]
fn a_chinese_laboratory_with_merged_cells_and_two_makes_of_potentiostats() {
    let laboratory = Laboratory {
        zone: "Asia/Shanghai",
        encoding: GBK,
        folder: "数据",
        strips: &["N1", "N2", "N3", "P1", "P2"],
        airs: &[("真空", "vacuum", 0.0), ("空气", "air", 55.0)],
        voltages: &[1.0, -1.0],
        electrical: "电化学",
        ahead_s: -83,
        current: |k, at, rows| {
            let last_s = rows.last().map_or(0, |row| row[0] as i64);
            // One make states the start in its language, the other the end of the record.
            let text = if k % 2 == 0 {
                let start = at.strftime("%Y/%m/%d %H:%M:%S");
                let rows = lines(rows, |[t, v, i, _]| format!("{t:.2}\t{v:.3}\t{:.5}\r\n", i * 1e3));
                format!(
                    "电化学工作站 CS350\r\n测量开始日期时间 {start}\r\n\r\n时间(s)\t电位(V)\t电流(mA)\r\n{rows}"
                )
            } else {
                let end = at
                    .checked_add(last_s.seconds())
                    .unwrap()
                    .strftime("%b. %-d, %Y   %H:%M:%S");
                let rows = lines(rows, |[t, v, i, _]| format!("{t:.3e}, {v:.3}, {i:.4e}\r\n"));
                format!(
                    "{end}\r\nMulti-Potential Steps\r\nFile: a\r\nData Source:  Experiment\r\nInstrument Model:  CHI660E\r\n\
                     Header: \r\nNote: \r\n\r\nInit E (V) = 0\r\n\r\nTime/sec, Potential/V, Current/A\r\n\r\n{rows}"
                )
            };
            (format!("{:03}.txt", k + 1), text)
        },
        bending: |k, sample, at, rows| {
            let start = at.strftime("%Y/%m/%d %H:%M:%S");
            let rows = lines(rows, |[t, _, _, kappa]| {
                format!("{t:.2},{:.5}\r\n", tip_mm(*kappa, LENGTH_MM))
            });
            (
                format!("{sample}-{:02}.csv", k + 1),
                format!("激光位移计\r\n采样开始,{start}\r\n\r\n时间(s),位移(mm)\r\n{rows}"),
            )
        },
    };
    laboratory.goes_to_a_true_report(
        |runs| {
            let names: Vec<(&str, String)> = runs
                .iter()
                .map(|(_, truth, other)| (truth.run.rsplit('/').next().unwrap(), other.clone()))
                .collect();
            let mut rows: Vec<Vec<Xml<'_>>> = vec![
                vec![
                    Text("样品"),
                    Text("数据文件"),
                    Gap,
                    Text("电压 (V)"),
                    Text("气氛"),
                    Text("湿度 (%)"),
                ],
                vec![Gap, Text("电流"), Text("位移"), Gap, Gap, Gap],
            ];
            for ((word, truth, _), (current, bending)) in runs.iter().zip(&names) {
                let (v, h) = (Number(truth.voltage_v), Number(truth.humidity_percent));
                rows.push(vec![
                    Text(&truth.sample),
                    Text(current),
                    Text(bending),
                    v,
                    Text(word),
                    h,
                ]);
            }
            let mut sizes = vec![vec![Text("样品"), Text("长度 (mm)"), Text("宽度 (mm)")]];
            sizes.extend(
                laboratory
                    .strips
                    .iter()
                    .map(|strip| vec![Text(strip), Number(LENGTH_MM), Number(WIDTH_MM)]),
            );
            let of = |rows: &[Vec<Xml<'_>>]| sheet(&rows.iter().map(Vec::as_slice).collect::<Vec<_>>());
            (
                "实验记录.xlsx",
                merged_workbook(&[of(&rows), of(&sizes)], "A1:A2 B1:C1"),
            )
        },
        true,
    );
}

#[test]
fn a_korean_laboratory_that_numbers_its_files_apart() {
    let laboratory = Laboratory {
        zone: "Asia/Seoul",
        encoding: EUC_KR,
        folder: "자료",
        strips: &["S1", "S2"],
        airs: &[("진공", "vacuum", 0.0), ("공기", "air", 40.0)],
        voltages: &[1.0, 2.0, -2.0],
        electrical: "전류",
        ahead_s: 127,
        current: |k, at, rows| {
            let start = at.strftime("%Y-%m-%d %H:%M:%S");
            let rows = lines(rows, |[t, v, i, _]| format!("{t:.2},{v:.3},{:.5}\r\n", i * 1e3));
            (
                format!("EC{k:03}.csv"),
                format!("장비,ZIVE\r\n측정 시작,{start}\r\n\r\n시간(s),전압(V),전류(mA)\r\n{rows}"),
            )
        },
        bending: |k, _, at, rows| {
            let start = at.strftime("%Y-%m-%d %H:%M:%S");
            let rows = lines(rows, |[t, _, _, kappa]| {
                format!("{t:.2}\t{:.5}\r\n", tip_mm(*kappa, LENGTH_MM))
            });
            (
                format!("laser_{:02}.csv", 99 - k),
                format!("레이저 변위 센서\r\n측정 일시: {start}\r\n\r\n시간(초)\t변위(mm)\r\n{rows}"),
            )
        },
    };
    laboratory.goes_to_a_true_report(
        |runs| {
            let row = |_, word: &str, truth: &Truth, current: &str, bending: &str| {
                format!(
                    "{},{current},{bending},{word},{},{}\r\n",
                    truth.sample, truth.humidity_percent, truth.voltage_v
                )
            };
            (
                "실험일지.csv",
                laboratory.text_sheet("시료,전류 파일,변위 파일,분위기,습도(%),전압(V)\r\n", row, runs),
            )
        },
        false,
    );
}

#[test]
fn a_czech_laboratory_with_decimal_commas() {
    let laboratory = Laboratory {
        zone: "Europe/Prague",
        encoding: WINDOWS_1250,
        folder: "data",
        // A word for an atmosphere that is not known stays one.
        strips: &["V1", "V2"],
        airs: &[("vakuum", "vacuum", 0.0), ("vzduch", "air", 50.0)],
        voltages: &[1.5, -1.5, 2.0],
        electrical: "proud",
        ahead_s: 41,
        current: |k, at, rows| {
            let start = at.strftime("%d.%m.%Y %H:%M:%S");
            let rows = lines(rows, |[t, v, i, _]| {
                format!("{}\t{}\t{}\r\n", comma(*t, 2), comma(*v, 3), comma(i * 1e3, 5))
            });
            (
                format!("proud_{k:02}.txt"),
                format!(
                    "Přístroj: A\r\nZačátek měření: {start}\r\n\r\nČas (s)\tNapětí (V)\tProud (mA)\r\n{rows}"
                ),
            )
        },
        bending: |k, _, at, rows| {
            let start = at.strftime("%d.%m.%Y %H:%M:%S");
            let rows = lines(rows, |[t, _, _, kappa]| {
                format!("{};{}\r\n", comma(*t, 2), comma(tip_mm(*kappa, LENGTH_MM), 5))
            });
            (
                format!("{}_{k}.csv", at.strftime("%d%m%y")),
                format!("Laser;opto\r\nZáznam spuštěn;{start}\r\n\r\nČas [s];Průhyb [mm]\r\n{rows}"),
            )
        },
    };
    laboratory.goes_to_a_true_report(
        |runs| {
            let row = |_, word: &str, truth: &Truth, current: &str, bending: &str| {
                format!(
                    "{};{current};{bending};{word};{};{}\r\n",
                    truth.sample,
                    truth.humidity_percent,
                    comma(truth.voltage_v, 1)
                )
            };
            (
                "deník.csv",
                laboratory.text_sheet(
                    "Vzorek;Soubor proud;Soubor průhyb;Prostředí;Vlhkost (%);Napětí (V)\r\n",
                    row,
                    runs,
                ),
            )
        },
        false,
    );
}

#[test]
fn a_japanese_laboratory_whose_sheet_names_one_of_the_two_files() {
    let laboratory = Laboratory {
        zone: "Asia/Tokyo",
        encoding: SHIFT_JIS,
        folder: "測定",
        strips: &["N1", "N2", "N3"],
        airs: &[("真空", "vacuum", 0.0), ("空気", "air", 60.0)],
        voltages: &[2.0, -2.0],
        electrical: "電流",
        ahead_s: -53,
        current: |k, at, rows| {
            let (date, time) = (at.strftime("%Y/%m/%d"), at.strftime("%H:%M:%S"));
            let rows = lines(rows, |[t, v, i, _]| format!("{t:.2},{v:.3},{:.5}\r\n", i * 1e3));
            (
                format!("M{k:03}.csv"),
                format!(
                    "機種名,HA\r\n測定日,{date}\r\n測定時刻,{time}\r\n\r\n時間(s),電圧(V),電流(mA)\r\n{rows}"
                ),
            )
        },
        bending: |k, sample, at, rows| {
            let start = at.strftime("%Y/%m/%d %H:%M:%S");
            let rows = lines(rows, |[t, _, _, kappa]| {
                format!("{t:.2}\t{:+.5}\r\n", tip_mm(*kappa, LENGTH_MM))
            });
            (
                format!("{sample}_{k:02}.txt"),
                format!("レーザ変位計\r\nトリガ日時\t{start}\r\n\r\n経過時間(s)\tOUT1 変位(mm)\r\n{rows}"),
            )
        },
    };
    laboratory.goes_to_a_true_report(
        |runs| {
            let row = |k, word: &str, truth: &Truth, current: &str, _: &str| {
                let name = current.trim_end_matches(".csv");
                format!(
                    "{k},{},{word},{},{},{name}\r\n",
                    truth.sample, truth.humidity_percent, truth.voltage_v
                )
            };
            (
                "実験記録.csv",
                laboratory.text_sheet(
                    "IPMC 実験記録,,,,,\r\n番号,試料,雰囲気,湿度(%),電圧(V),ファイル\r\n",
                    row,
                    runs,
                ),
            )
        },
        false,
    );
}
