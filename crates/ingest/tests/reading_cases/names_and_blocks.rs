//! What columns and lines are: names in other encodings, roles, blocks side by side, marks of columns, feet.

use encoding_rs::{BIG5, SHIFT_JIS, WINDOWS_1250, WINDOWS_1251};
use ieap_domain::Quantity;

use crate::base_run::{base, table};
use crate::expected::Expected;
use crate::reads::{local_start, of, only_channel, only_table, refused, tells};

#[test]
fn names_in_the_encodings_of_laboratories() {
    for (encoding, names) in [
        (SHIFT_JIS, "経過時間（秒）,電圧（Ｖ）,電流（ｍＡ）"),
        (BIG5, "時間(秒),電壓(V),電流(mA)"),
        (WINDOWS_1250, "Czas [s],Napięcie [V],Prąd [mA]"),
        (WINDOWS_1251, "Время (с),Напряжение (В),Ток (мА)"),
    ] {
        let text = table(names, &base(), |row| {
            format!("{:.1},{:.1},{:.5}", row.t, row.volts, row.ma)
        });
        Expected::run(&base(), 0.0).is_all_of(&of("run.csv", encoding.encode(&text).0));
    }
}

#[test]
fn blocks_of_columns_under_the_same_names_are_runs() {
    let names = "first,,,second,,\nTime (s),Voltage (V),Current (mA),Time (s),Voltage (V),Current (mA)";
    let text = table(names, &base(), |row| {
        let (t, ma) = (row.t, row.ma);
        format!("{t:.1},{:.1},{ma:.5},{t:.1},3.0,{:.5}", row.volts, 2.0 * ma)
    });
    let reading = of("run.csv", text);
    let found: Vec<(&str, f64)> = (reading.tables.iter())
        .map(|table| {
            (
                table.name.as_str(),
                only_channel(table, Quantity::Current).values[4],
            )
        })
        .collect();
    assert_eq!(found, [("first", 9.4e-3), ("second", 18.8e-3)]);
    tells(&reading, &["blocks-side-by-side"]);
}

#[test]
fn a_column_has_its_own_decimal_mark() {
    let text = table("Time (s)\tVoltage (V)\tCurrent (mA)", &base(), |row| {
        let volts = format!("{:.2}", row.volts).replace('.', ",");
        format!("{:.1}\t{volts}\t{:.5}", row.t, row.ma)
    });
    let reading = of("run.txt", text);
    Expected::run(&base(), 0.0).is_all_of(&reading);
    tells(&reading, &["decimal-marks-differ"]);
}

#[test]
fn two_columns_of_one_current_that_differ_are_refused_with_both_named() {
    let text = table("Time (s),Voltage (V),Current (mA),Current (A)", &base(), |row| {
        format!("{:.1},{:.1},{:.5},{:.5}", row.t, row.volts, row.ma, row.ma)
    });
    let error = refused("run.csv", text).to_string();
    assert!(
        error.contains("Current (mA)") && error.contains("Current (A)"),
        "{error}"
    );
}

#[test]
fn names_that_stand_again_while_the_time_goes_on_start_no_run() {
    let text = table("Time (s),Voltage (V),Current (mA)", &base(), |row| {
        let again = if row.t == 8.0 {
            "Time (s),Voltage (V),Current (mA)\n"
        } else {
            ""
        };
        format!("{again}{:.1},{:.1},{:.5}", row.t, row.volts, row.ma)
    });
    Expected::run(&base(), 0.0).is_all_of(&of("run.csv", text));
}

#[test]
fn a_table_on_its_side_is_told_so() {
    let text = "Time (s),0,1,2,3\nVoltage (V),0,2,2,2\nCurrent (mA),0,9,5,3\n";
    let error = refused("run.csv", text).to_string();
    assert!(error.contains("on its side"), "{error}");
    assert!(!error.contains("decimal sign"), "{error}");
}

#[test]
fn names_above_others_reach_over_all_columns() {
    for names in [
        "series 7\nTime,Electrode,\n[s],Voltage [V],Current [mA]",
        "series 7,,\nTime,Signals\n[s],Voltage [V],Current [mA]",
    ] {
        let text = table(names, &base(), |row| {
            format!("{:.1},{:.1},{:.5}", row.t, row.volts, row.ma)
        });
        Expected::run(&base(), 0.0).is_all_of(&of("run.csv", text));
    }
}

#[test]
fn a_response_that_holds_text_is_told_with_it() {
    let text = table("Time (s),Voltage (V),Current (A)", &base(), |row| {
        format!("{:.1},{:.1},{:.3}m", row.t, row.volts, row.ma)
    });
    let error = refused("run.csv", text).to_string();
    assert!(
        error.contains("\"Current (A)\" (85 cells hold text, first \"0.000m\")"),
        "{error}"
    );
}

/// Sixty rows of a log, five minutes apart.
fn log(names: &str, row: impl Fn(usize, &str) -> String) -> String {
    let rows: Vec<String> = (0..60)
        .map(|k| row(k, &format!("2026-03-19 {:02}:{:02}:00", 11 + k / 12, k % 12 * 5)))
        .collect();
    format!("{names}\n{}\n", rows.join("\n"))
}

#[test]
fn a_set_point_and_an_alarm_are_no_readings_of_the_air() {
    let names = "Time,Humidity set (%),Humidity value (%),Temperature alarm (°C),Temperature (Celcius)";
    let text = log(names, |k, time| {
        format!("{time},50.0,{:.1},30.0,{:.2}", 45.0 + 0.1 * k as f64, 21.0)
    });
    let reading = of("log.csv", text);
    let table = only_table(&reading);
    assert_eq!(only_channel(table, Quantity::RelativeHumidity).values[0], 45.0);
    assert_eq!(only_channel(table, Quantity::Temperature).values[0], 21.0);
    tells(&reading, &["column-not-measured"]);
}

#[test]
fn a_foot_is_no_row_and_serial_numbers_tell_sensors_apart() {
    let text = log("Serial number,Time,RH (%)", |k, time| {
        let sensor = if k % 3 == 0 { "B22" } else { "A17" };
        format!("{sensor},{time},{:.1}", if k % 3 == 0 { 65.0 } else { 45.0 })
    });
    let reading = of("log.csv", text + "Checksum: 91823\n");
    let found: Vec<(&str, usize)> = reading
        .tables
        .iter()
        .map(|table| (table.name.as_str(), table.rows))
        .collect();
    assert_eq!(found, [("A17", 40), ("B22", 20)]);
    tells(&reading, &["lines-between"]);
}

#[test]
fn what_a_sensor_that_is_off_writes_is_left_out_of_all_it_measures() {
    let text = log(
        "time,temperature_c,relative_humidity_percent",
        |k, time| match k {
            5 | 6 => format!("{time},998.0,998.0"),
            _ => format!("{time},21.0,45.0"),
        },
    );
    let reading = of("log.csv", text);
    for quantity in [Quantity::Temperature, Quantity::RelativeHumidity] {
        assert_eq!(only_channel(only_table(&reading), quantity).len(), 58);
    }
}

#[test]
fn a_column_of_quantities_beside_one_of_values() {
    let text = log("Date/Time,Unit,Value", |k, time| {
        format!("{time},%RH,{:.1}", 45.0 + 0.1 * k as f64)
    });
    let reading = of("log.csv", text);
    assert_eq!(
        only_channel(only_table(&reading), Quantity::RelativeHumidity).values[0],
        45.0
    );
}

#[test]
fn moments_in_words_and_from_other_zeros() {
    let text = "日時,湿度(%)\n2026年3月19日 午前11時40分00秒,45\n2026年3月19日 午後0時20分00秒,46\n";
    let reading = of("log.csv", SHIFT_JIS.encode(text).0);
    assert_eq!(local_start(&reading), Some("2026-03-19T11:40:00"));
    assert_eq!(only_table(&reading).time_first_last_s, Some((0.0, 2400.0)));
    for (name, first, step) in [
        ("Time (s)", 3_856_766_400.0, 0.5),
        ("datenum", 740_060.5, 0.5 / 86_400.0),
    ] {
        let text = table(&format!("{name},Voltage (V),Current (mA)"), &base(), |row| {
            let time = first + (row.t + 2.0) / 0.5 * step;
            format!("{time:.9},{:.1},{:.5}", row.volts, row.ma)
        });
        assert_eq!(
            local_start(&of("run.csv", text)),
            Some("2026-03-19T12:00:00"),
            "{name}"
        );
    }
}
