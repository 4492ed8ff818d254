//! How numbers are written: marks between thousands, signs, what stands for an overload.

use ieap_domain::Quantity;

use crate::base_run::{Row, base, noisy, power, rows, table};
use crate::expected::Expected;
use crate::reads::{of, tells};

/// Half of 1 uA, A.
const HALF_A_MICROAMPERE: f64 = 0.5e-6;

/// A number without decimals, with a mark between its thousands.
fn grouped(number: f64, mark: char) -> String {
    let whole = number.round() as u32;
    if whole < 1000 {
        whole.to_string()
    } else {
        format!("{}{mark}{:03}", whole / 1000, whole % 1000)
    }
}

/// 60 rows of 1 s, the step at the fourth.
fn whole_seconds() -> Vec<Row> {
    rows(60, -3.0, 1.0)
}

#[test]
fn case_08_a_comma_between_thousands() {
    let text = table("Time (s);Voltage (V);Current (uA)", &whole_seconds(), |row| {
        format!("{};{};{}", row.t + 3.0, row.volts, grouped(row.ma * 1000.0, ','))
    });
    assert!(text.contains("3;2;9,400\n") && text.contains("10;2;945\n") && text.ends_with(";211\n"));
    Expected::run(&whole_seconds(), 3.0)
        .with_currents_to(HALF_A_MICROAMPERE)
        .is_all_of(&of("run.csv", text));
}

#[test]
fn case_08b_a_point_between_thousands() {
    let text = table("Zeit (ms);Spannung (mV);Strom (uA)", &whole_seconds(), |row| {
        let time = grouped((row.t + 4.0) * 1000.0, '.');
        let volts = grouped(row.volts * 1000.0, '.');
        format!("{time};{volts};{}", grouped(row.ma * 1000.0, '.'))
    });
    assert!(text.contains("\n4.000;2.000;9.400\n") && text.contains("\n60.000;"));
    Expected::run(&whole_seconds(), 4.0)
        .with_currents_to(HALF_A_MICROAMPERE)
        .is_all_of(&of("run.csv", text));
}

#[test]
fn case_08c_a_comma_between_thousands_and_decimals() {
    let text = table("Time (s);Voltage (V);Current (uA)", &whole_seconds(), |row| {
        let hundredths = (row.ma * 1e5).round();
        let decimals = hundredths as u32 % 100;
        let whole = grouped((hundredths / 100.0).floor(), ',');
        format!("{};{};{whole}.{decimals:02}", row.t + 3.0, row.volts)
    });
    assert!(text.contains("4;2;5,411.39\n") && text.contains("10;2;944.87\n"));
    Expected::run(&whole_seconds(), 3.0).is_all_of(&of("run.csv", text));
}

#[test]
fn case_09_an_overload_written_as_a_number_is_left_out() {
    let text = table("Time (s),Voltage (V),Current (A)", &base(), |row| {
        let is_over = row.t == 0.0 || row.t == 0.5;
        let current = power(if is_over { 9.9e37 } else { row.amperes() });
        format!("{:.1},{:.1},{}", row.t, row.volts, current.to_uppercase())
    });
    assert!(text.contains("\n0.5,2.0,9.900000E+37\n"));
    let reading = of("run.csv", text);
    tells(&reading, &["impossible-reading"]);
    let issue = reading
        .issues
        .iter()
        .find(|issue| issue.code == "impossible-reading");
    assert!(issue.unwrap().message.starts_with("2 of 85 "), "{issue:?}");
    Expected::run(&base(), 0.0)
        .without(Quantity::Current, &[0.0, 0.5])
        .is_all_of(&reading);
}

#[test]
fn case_27_an_overload_of_the_voltage_is_no_step() {
    let names = "time_s,voltage_v,current_a,tip_displacement_mm";
    let text = table(names, &noisy(), |row| {
        let volts = if row.t == 20.0 {
            "9.9E+37".to_owned()
        } else {
            format!("{:.1}", row.volts)
        };
        format!("{},{volts},{},{:.4}", row.t, power(row.amperes()), row.tip_mm)
    });
    assert!(text.contains("\n20,9.9E+37,"));
    let reading = of("run.csv", text);
    tells(&reading, &["impossible-reading"]);
    Expected::run(&noisy(), 0.0)
        .with_tip(&noisy(), 0.0, 0.5e-4)
        .without(Quantity::Voltage, &[20.0])
        .is_all_of(&reading);
}

#[test]
fn case_15_a_minus_in_the_name_turns_the_sign() {
    let text = table("Time (s),Voltage (V),-I (mA)", &base(), |row| {
        format!("{:.1},{:.1},{:.5}", row.t, row.volts, -row.ma)
    });
    assert!(text.contains("\n0.0,2.0,-9.40000\n"));
    Expected::run(&base(), 0.0).is_all_of(&of("run.csv", text));
}

#[test]
fn case_16_the_minus_of_typographers() {
    let turned: Vec<Row> = base()
        .into_iter()
        .map(|row| Row {
            volts: -row.volts,
            ma: -row.ma,
            ..row
        })
        .collect();
    let rows = table("", &turned, |row| {
        format!("{:.1},{:.1},{}", row.t, row.volts, power(row.amperes()))
    });
    let text = format!("time_s,voltage_v,current_a{}", rows.replace('-', "\u{2212}"));
    assert!(text.contains("\n0.0,\u{2212}2.0,\u{2212}9.400000e\u{2212}03\n"));
    Expected::run(&turned, 0.0).is_all_of(&of("run.csv", text));
}

#[test]
fn case_34_readings_at_the_end_of_a_range_are_left_out_and_said() {
    let (rows, full_ma) = (rows(421, -2.0, 0.1), 5.0);
    let text = table("Time (s),Voltage (V),Current (mA)", &rows, |row| {
        format!("{:.2},{:.1},{:.4}", row.t, row.volts, row.ma.min(full_ma))
    });
    let reading = of("run.csv", text);
    tells(&reading, &["range-exceeded"]);
    let channels = &reading.tables[0].channels;
    let current = channels
        .iter()
        .find(|of| of.quantity == Quantity::Current)
        .unwrap();
    let at_end: Vec<u32> = (0..)
        .zip(&rows)
        .filter(|(_, row)| row.ma > full_ma)
        .map(|(k, _)| k)
        .collect();
    assert!(at_end.len() > 5);
    assert_eq!(*current.excluded, at_end);
}
