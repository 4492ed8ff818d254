//! Layouts of loggers of temperature and humidity.

use jiff::Timestamp;
use jiff::civil::{DateTime, date};

use crate::log_expected::{
    LogRow, is_climate, is_humidity, is_series, log_of, log_rows, log_table, only_series,
};
use crate::reads::{is_asked, local_start, moment_of_start, of, tells};

/// Where most logs begin: the night in which clocks go forward.
const NIGHT: DateTime = date(2026, 3, 28).at(23, 0, 0, 0);
/// Where the others do.
const EVENING: DateTime = date(2026, 3, 19).at(23, 0, 0, 0);
/// What a temperature may be off by that is written with one decimal, °C.
const ONE_DECIMAL: f64 = 0.05 + 1e-9;

/// 60 rows of 5 min.
fn night() -> Vec<LogRow> {
    log_rows(NIGHT, 60, 300)
}

#[test]
fn case_06b_an_offset_without_a_colon() {
    let text = log_table("time,temp_C,rh_percent", &night(), |row| {
        let moment = row.moment.strftime("%Y-%m-%dT%H:%M:%S+0200");
        format!("{moment},{:.2},{:.2}", row.celsius, row.percent)
    });
    let reading = of("log.csv", text);
    let start: Timestamp = "2026-03-28T21:00:00Z".parse().unwrap();
    assert_eq!(moment_of_start(&reading), Some(start));
    is_climate(&log_of(&reading), &night(), 0.0);
}

#[test]
fn case_10_two_transmitters_are_two_sensors() {
    let lines: Vec<String> = night()
        .iter()
        .enumerate()
        .map(|(j, row)| {
            let (name, percent) = if j % 2 == 0 {
                ("Box 2", row.percent)
            } else {
                ("Box 1", row.percent + 20.0)
            };
            let moment = row.moment.strftime("%Y-%m-%d %H:%M");
            format!("\"Lab\",\"{name}\",\"{moment}\",{:.2},{percent:.2}", row.celsius)
        })
        .collect();
    let names = "RECEIVER,TRANSMITTER,DATE,TEMPERATURE,HUMIDITY";
    let reading = of("log.csv", format!("{names}\n{}\n", lines.join("\n")));
    assert_eq!(local_start(&reading), Some("2026-03-28T23:00:00"));
    let log = log_of(&reading);
    for (sensor, first, more) in [("Box 2", 0, 0.0), ("Box 1", 1, 20.0)] {
        let rows: Vec<LogRow> = night().into_iter().skip(first).step_by(2).collect();
        let series = only_series(&log, sensor, "relative_humidity_percent");
        is_series(series, &rows, 0.0, |row| row.percent + more);
        is_series(only_series(&log, sensor, "temperature_c"), &rows, 0.0, |row| {
            row.celsius
        });
    }
}

/// A humidity between 0 and 1 without a unit.
pub fn fractions() -> String {
    log_table("timestamp,temperature_c,relative_humidity", &night(), |row| {
        let moment = row.moment.strftime("%Y-%m-%d %H:%M:%S");
        format!("{moment},{:.2},{:.4}", row.celsius, row.percent / 100.0)
    })
}

#[test]
fn case_11_a_humidity_between_0_and_1_is_asked() {
    is_asked("log.csv", &fractions(), "humidity", &["fraction", "percent"]);
}

/// Names with a channel behind their units, two of them of temperatures.
#[test]
fn case_12_a_channel_behind_the_unit() {
    let names = "Date Time\tTemperature (*C) c:1\tHigh-Res Temp (*C) c:1 2\tRH (%) c:3";
    let text = log_table(names, &night(), |row| {
        let moment = row.moment.strftime("%m/%d/%y %H:%M:%S.0");
        format!(
            "{moment}\t{:.1}\t{:.2}\t{:.1}",
            row.celsius, row.celsius, row.percent
        )
    });
    let reading = of("log.txt", text);
    assert_eq!(local_start(&reading), Some("2026-03-28T23:00:00"));
    is_humidity(&log_of(&reading), &night());
    let unread = reading.issues.iter().find(|issue| issue.code == "column-unread");
    assert_eq!(unread.map(|issue| issue.message.as_str()), None, "it is used");
}

#[test]
fn case_19_the_time_before_the_date() {
    let names = "\nDatabase Valid\n  Sensor:,Thermistor/RH\n  Serial No:,0000-00000\n  No. of Readings:,60\n\n\
                 Time, Temperature (C),Humidity (RH(%)),";
    let text = log_table(names, &night(), |row| {
        let moment = row.moment.strftime("%H:%M:%S %d/%b/%Y");
        format!("{moment},{:.1},{:.1},", row.celsius, row.percent)
    });
    let reading = of("log.csv", text);
    assert_eq!(local_start(&reading), Some("2026-03-28T23:00:00"));
    is_climate(&log_of(&reading), &night(), ONE_DECIMAL);
}

#[test]
fn case_19b_what_is_measured_stands_in_a_row_of_properties() {
    let names = ",Time,1,2\nS/N,,000000,000000\nType,,TGU-4500,TGU-4500\nDescription,,Lab,Lab\n\
                 Property,,Temperature,Humidity";
    let lines: Vec<String> = night()
        .iter()
        .enumerate()
        .map(|(j, row)| {
            let moment = row.moment.strftime("%Y-%m-%d %H:%M:%S");
            format!("{},{moment},{:.3},{:.1}", j + 1, row.celsius, row.percent)
        })
        .collect();
    let reading = of("log.csv", format!("{names}\n{}\n", lines.join("\n")));
    assert_eq!(local_start(&reading), Some("2026-03-28T23:00:00"));
    is_climate(&log_of(&reading), &night(), 0.0);
}

#[test]
fn case_19c_units_stand_above_the_table() {
    let rows = log_rows(EVENING, 40, 1800);
    let names = "\u{feff}[#I]Device Description,,,\nBox1,,,\n,,,\n[#S]Device Information,,,\n\
                 Serial Number = A00000000,,,\nLog Interval = 00:30:00,,,\n,,,\n[#1],,,\nHumidity = %rh,,,\n,,,\n\
                 [#2],,,\nTemperature = C,,,\n,,,\n[#H],,,\nDate,Time,Humidity,Temperature\n,,,\n[#D],,,";
    let text = log_table(names, &rows, |row| {
        let moment = row.moment.strftime("%d/%m/%Y,%H:%M:%S");
        format!("{moment},{:.1},{:.2}", row.percent, row.celsius)
    });
    let reading = of("log.csv", text);
    assert_eq!(local_start(&reading), Some("2026-03-19T23:00:00"));
    is_climate(&log_of(&reading), &rows, 0.0);
}

#[test]
fn case_19d_seconds_since_1970_beside_the_local_time() {
    let utc = |row: &LogRow| row.moment.to_zoned(jiff::tz::TimeZone::UTC).unwrap().timestamp();
    let names = "sep=;\nEpoch_UTC;Local_Date_Time;T_SHT40 [°C];RH_SHT40 [%]";
    let text = log_table(names, &night(), |row| {
        let local = row.moment.strftime("%Y-%m-%dT%H:%M:%S");
        let epoch = utc(row).as_millisecond();
        format!("{epoch};{local};{:.2};{:.2}", row.celsius, row.percent)
    });
    let reading = of("log.csv", text);
    assert_eq!(local_start(&reading), Some("2026-03-28T23:00:00"));
    is_climate(&log_of(&reading), &night(), 0.0);
}

#[test]
fn case_19e_units_stand_in_a_row_of_their_own() {
    let rows = log_rows(EVENING, 40, 300);
    let fahrenheit = |row: &LogRow| 70.0 + 10.0 * (row.celsius - 21.0);
    let text = log_table("Time;Temperature;Humidity\n;°F;%RH", &rows, |row| {
        let moment = row.moment.strftime("%Y-%m-%d %H:%M");
        format!("{moment};{:.1};{:.1}", fahrenheit(row), row.percent)
    });
    let reading = of("log.csv", text);
    assert_eq!(local_start(&reading), Some("2026-03-19T23:00:00"));
    let log = log_of(&reading);
    is_humidity(&log, &rows);
    let series = only_series(&log, "", "temperature_c");
    is_series(series, &rows, 0.0, |row| (fahrenheit(row) - 32.0) / 1.8);
}

#[test]
fn case_19f_the_newest_row_comes_first() {
    let rows = log_rows(EVENING, 60, 300);
    let newest_first: Vec<LogRow> = rows.iter().rev().copied().collect();
    let names = "timestamp,temperature_c,relative_humidity_percent";
    let text = log_table(names, &newest_first, |row| {
        let moment = row.moment.strftime("%Y-%m-%d %H:%M:%S");
        format!("{moment},{:.2},{:.2}", row.celsius, row.percent)
    });
    let reading = of("log.csv", text);
    tells(&reading, &["newest-first"]);
    assert_eq!(local_start(&reading), Some("2026-03-19T23:00:00"));
    is_climate(&log_of(&reading), &rows, 0.0);
}
