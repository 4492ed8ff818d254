//! Times since a start: minutes and seconds, more than a day, clocks that begin anew.

use ieap_domain::Quantity;

use crate::base_run::{base, power, rows, table};
use crate::expected::Expected;
use crate::reads::{is_asked, of, only_channel, only_table, tells};

#[test]
fn case_01_minutes_and_seconds_as_the_name_says() {
    let text = table("Elapsed time (mm:ss),Voltage (V),Current (mA)", &base(), |row| {
        format!("00:{:04.1},{:.1},{:.5}", row.t + 2.0, row.volts, row.ma)
    });
    Expected::run(&base(), 2.0).is_all_of(&of("run.csv", text));
}

/// 122 rows of 1 s whose times may be minutes and seconds, or hours and minutes.
pub fn two_fields() -> String {
    table("Time,Voltage (V),Current (mA)", &rows(122, -2.0, 1.0), |row| {
        let second = (row.t + 2.0) as u32;
        format!(
            "{}:{:02},{:.1},{:.5}",
            second / 60,
            second % 60,
            row.volts,
            row.ma
        )
    })
}

#[test]
fn case_01b_two_fields_are_asked() {
    is_asked("run.csv", &two_fields(), "clock", &["mm:ss", "hh:mm"]);
}

#[test]
fn case_02_the_clock_starts_anew_at_the_step() {
    let text = table("Step,Time (s),Voltage (V),Current (A)", &base(), |row| {
        let (step, time) = if row.t < 0.0 { (1, row.t + 2.0) } else { (2, row.t) };
        format!("{step},{time:.1},{:.3},{}", row.volts, power(row.amperes()))
    });
    let reading = of("run.csv", text);
    tells(&reading, &["clock-starts-anew"]);
    Expected::run(&base(), 2.0).is_all_of(&reading);
}

/// `23:59:50.5` of seconds; days before a point where there are any and `day_mark` says so.
fn clock(seconds: f64, decimals: usize, has_days: bool) -> String {
    let whole = seconds as u32;
    let (hours, minutes) = (whole / 3600, whole / 60 % 60);
    let width = decimals + 3;
    let rest = format!("{minutes:02}:{:0width$.decimals$}", seconds % 60.0);
    match (has_days, hours / 24) {
        (true, days @ 1..) => format!("{days}.{:02}:{rest}", hours % 24),
        _ => format!("{hours:02}:{rest}"),
    }
}

/// Of a run that begins 10 s before a day is over.
fn past_a_day(decimals: usize, has_days: bool) -> String {
    table("Elapsed Time,Voltage (V),Current (mA)", &base(), |row| {
        let time = clock(86_392.0 + row.t, decimals, has_days);
        format!("\"{time}\",{:.1},{:.5}", row.volts, row.ma)
    })
}

#[test]
fn case_07_hours_beyond_a_day() {
    let text = past_a_day(1, false);
    assert!(text.contains("\"24:00:32.0\""), "{text}");
    Expected::run(&base(), 86_392.0).is_all_of(&of("run.csv", text));
}

#[test]
fn case_07b_days_before_a_point() {
    let text = past_a_day(7, true);
    assert!(text.contains("\"1.00:00:32.0000000\""), "{text}");
    Expected::run(&base(), 86_392.0).is_all_of(&of("run.csv", text));
}

#[test]
fn case_18b_a_counter_of_32_bits_wraps() {
    let text = table("time_us,voltage_V,current_mA", &base(), |row| {
        let count = 4_274_967_295 + ((row.t + 2.0) * 1e6) as u64;
        format!("{},{:.1},{:.5}", count % (1 << 32), row.volts, row.ma)
    });
    let reading = of("run.csv", text);
    tells(&reading, &["counter-wrapped"]);
    Expected::run(&base(), 2.0).is_all_of(&reading);
}

#[test]
fn case_20_frequencies_under_one_time_are_a_spectrum() {
    let (series, parallel, tau_s) = (50.0, 500.0, 0.01);
    let x = |frequency: f64| std::f64::consts::TAU * frequency * tau_s;
    let frequencies: Vec<f64> = (0..31).map(|k| 10f64.powf(5.0 - 0.2 * f64::from(k))).collect();
    let real: Vec<f64> = frequencies
        .iter()
        .map(|f| series + parallel / (1.0 + x(*f).powi(2)))
        .collect();
    let imaginary: Vec<f64> = frequencies
        .iter()
        .map(|f| -parallel * x(*f) / (1.0 + x(*f).powi(2)))
        .collect();
    assert!((real[0] - 50.0).abs() < 0.005 && (real[30] - 549.98).abs() < 0.005);
    let lines: Vec<String> = (0..31)
        .map(|k| format!("{:.6},0,{:.6},{:.6}", frequencies[k], real[k], imaginary[k]))
        .collect();
    let names = "Frequency (Hz),Time (s),Zre (Ohm),Zim (Ohm)";
    let reading = of("spectrum.csv", format!("{names}\n{}\n", lines.join("\n")));
    let table = only_table(&reading);
    assert_eq!(table.rows, 31);
    for (quantity, expected) in [
        (Quantity::Frequency, frequencies),
        (Quantity::ImpedanceReal, real),
        (Quantity::ImpedanceImaginary, imaginary),
    ] {
        let found = &only_channel(table, quantity).values;
        assert_eq!(found.len(), expected.len(), "{quantity:?}");
        for (found, expected) in found.iter().zip(expected) {
            assert!(
                (found - expected).abs() < 1e-6,
                "{quantity:?}: found {found}, expected {expected}"
            );
        }
    }
}
