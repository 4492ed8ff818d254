//! Files that a program or a disk did not finish as it began them.

use ieap_domain::RunStatus;

use crate::base_run::{Row, base, noisy, power, table};
use crate::expected::Expected;
use crate::reads::{of, tells};

/// A row under `time_s,voltage_v,current_a`.
fn plain(row: &Row) -> String {
    format!("{:.1},{:.1},{}", row.t, row.volts, power(row.amperes()))
}

#[test]
fn case_17_nul_bytes_of_a_disk_that_lost_its_power() {
    let whole = table("time_s,voltage_v,current_a", &base(), plain);
    let (kept, _) = whole.split_once("39.5,").unwrap();
    let bytes = [kept.as_bytes(), b"39.5,2.0,2.446", &[0; 512]].concat();
    let reading = of("run.csv", bytes);
    tells(&reading, &["file-cut", "nul-bytes"]);
    assert_eq!(reading.status, RunStatus::Cut);
    let nul = reading
        .issues
        .iter()
        .find(|issue| issue.code == "nul-bytes")
        .unwrap();
    let place = format!("{} {}", nul.place, nul.message);
    assert!(place.contains("line 85"), "{place}");
    Expected::run(&base()[..83], 0.0).is_all_of(&reading);
}

#[test]
fn case_17b_a_byte_order_mark_in_every_line() {
    let text = table("Time (s),Voltage (V),Current (mA)", &base(), |row| {
        format!("{:.1},{:.1},{:.5}", row.t, row.volts, row.ma)
    });
    let marked: String = text.lines().map(|line| format!("\u{feff}{line}\n")).collect();
    Expected::run(&base(), 0.0).is_all_of(&of("run.csv", marked));
}

#[test]
fn case_18_a_restarted_logger_wrote_two_runs() {
    let run = |count: usize| {
        table("time_s,voltage_v,current_a", &base()[..count], |row| {
            plain(&Row {
                t: row.t + 2.0,
                ..*row
            })
        })
    };
    let text = format!("{}Logging to: LD0029.CSV\n{}", run(40), run(30));
    let reading = of("run.csv", text);
    tells(&reading, &["logger-restarted"]);
    assert_eq!(reading.tables.len(), 2);
    for (table, count) in reading.tables.iter().zip([40, 30]) {
        Expected::run(&base()[..count], 2.0).is(table);
    }
}

/// The fit of this run is tested where runs are fitted; here it must come whole, with its glitch.
#[test]
fn case_26_a_glitch_of_the_current_is_read() {
    let run: Vec<Row> = noisy()
        .into_iter()
        .map(|row| {
            if row.t == 20.0 {
                Row { ma: 50.0, ..row }
            } else {
                row
            }
        })
        .collect();
    let text = table("time_s,voltage_v,current_a", &run, |row| {
        format!("{},{:.1},{}", row.t, row.volts, power(row.amperes()))
    });
    assert!(text.contains("\n20,2.0,5.000000e-02\n"));
    Expected::run(&run, 0.0).is_all_of(&of("run.csv", text));
}
