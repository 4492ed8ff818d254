//! A Chinese laboratory in GBK: tables of a potentiostat and of a laser under the same numbers, a logger with date and time apart
//! and a footer, a run sheet.

use encoding_rs::GBK;

use super::truth::{Row, Truth, simulated, tip_mm};
use super::{Person, is_true, nothing_is_lost};

const LENGTH_MM: f64 = 10.0;
const WIDTH_MM: f64 = 2.0;
const FIRST_MIN: usize = 9 * 60;
const EVERY_MIN: usize = 15;

const ATMOSPHERES: [(&str, &str, f64); 3] = [
    ("真空", "vacuum", 0.0),
    ("氩气", "氩气", 0.0),
    ("空气", "air", 50.0),
];
const VOLTAGES: [f64; 3] = [1.5, -1.5, 2.0];

fn truths() -> Vec<(&'static str, Truth)> {
    let mut truths = Vec::new();
    for sample in ["CNT-1", "CNT-2"] {
        for (word, environment, humidity_percent) in ATMOSPHERES {
            for voltage_v in VOLTAGES {
                let truth = Truth {
                    run: format!("runs/电化学/{:03}.csv", truths.len() + 1),
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

fn clock(minutes: usize) -> String {
    let half = if minutes < 12 * 60 { "上午" } else { "下午" };
    format!("{half} {}:{:02}:00", (minutes / 60 + 11) % 12 + 1, minutes % 60)
}

fn potentiostat(start_min: usize, rows: &[Row]) -> String {
    let row = |[t, v, i, _]: &Row| format!("{t:.2},{v:.4},{:.5}\r\n", i * 1e3);
    let rows: String = rows.iter().map(row).collect();
    format!(
        "仪器型号,CS350\r\n开始时间,2026年3月18日 {:02}:{:02}:00\r\n采样间隔,1 s\r\n\r\n时间(s),电压(V),电流(mA)\r\n{rows}",
        start_min / 60,
        start_min % 60
    )
}

fn laser(rows: &[Row]) -> String {
    let row = |[t, _, _, kappa]: &Row| format!("{t:.2}\t{:.5}\r\n", tip_mm(*kappa, LENGTH_MM));
    let rows: String = rows.iter().map(row).collect();
    format!("激光位移传感器\r\n时间(秒)\t位移(毫米)\r\n{rows}")
}

fn logger(truths: &[(&str, Truth)]) -> String {
    let mut text = String::from("设备名称：温湿度记录仪\r\n序号,日期,时间,温度(℃),相对湿度(%RH)\r\n");
    for minutes in FIRST_MIN - 20..FIRST_MIN + EVERY_MIN * truths.len() {
        let at = minutes.saturating_sub(FIRST_MIN) / EVERY_MIN;
        let humidity = truths[at].1.humidity_percent.max(35.0);
        let number = minutes + 21 - FIRST_MIN;
        text += &format!("{number},2026-03-18,{},22.4,{humidity:.1}\r\n", clock(minutes));
    }
    text + "平均值,,,22.4,41.2\r\n导出结束\r\n"
}

fn run_sheet(truths: &[(&str, Truth)]) -> String {
    let mut text = String::from("编号,样品,气氛,湿度(%),电压(V),数据文件,操作者,备注\r\n");
    for (at, (word, truth)) in truths.iter().enumerate() {
        let number = at + 1;
        text += &format!(
            "{number},{},{word},{},{},{number:03}.csv,李,\r\n",
            truth.sample, truth.humidity_percent, truth.voltage_v
        );
    }
    text
}

#[test]
fn a_chinese_laboratory_goes_from_its_folder_to_a_true_report() {
    let person = Person::new("Asia/Shanghai");
    let truths = truths();
    let tables = simulated(&truths, 64, (LENGTH_MM * WIDTH_MM / 100.0, 20.0));
    let write = |name: &str, text: &str| person.puts("数据", name, GBK, text);
    for (at, rows) in tables.iter().enumerate() {
        let name = format!("{:03}", at + 1);
        write(
            &format!("电化学/{name}.csv"),
            &potentiostat(FIRST_MIN + EVERY_MIN * at, rows),
        );
        write(&format!("位移/{name}.txt"), &laser(rows));
    }
    write("温湿度记录.csv", &logger(&truths));
    write("实验记录.csv", &run_sheet(&truths));

    person.makes(
        "yanjiu",
        "数据",
        &["18 runs in two files each", "1 climate log", "1 run sheet"],
        (LENGTH_MM, WIDTH_MM),
    );
    person.types(&["run", "yanjiu", "--no-diagnose"]).expect(0);
    nothing_is_lost(&person.stories("yanjiu"), &person.path("数据"));
    is_true(&person, "yanjiu", (&truths, &[]));
    person.was_quick("yanjiu");
}
