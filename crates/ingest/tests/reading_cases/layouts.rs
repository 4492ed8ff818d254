//! Where names, units and other things stand in files of runs.

use ieap_domain::Quantity;

use crate::base_run::{base, noisy, power, table};
use crate::expected::Expected;
use crate::reads::{of, refused};

#[test]
fn case_05_the_climate_of_a_run_stands_in_its_own_columns() {
    let names = "Time (s),Voltage (V),Current (mA),RH (%),T (°C)";
    let text = table(names, &noisy(), |row| {
        format!("{},{:.1},{},45.2,23.1", row.t, row.volts, power(row.ma))
    });
    let always = |value: f64| noisy().into_iter().map(move |row| (row.t, value));
    Expected::run(&noisy(), 0.0)
        .with(Quantity::RelativeHumidity, 0.0, always(45.2))
        .with(Quantity::Temperature, 0.0, always(23.1))
        .is_all_of(&of("run.csv", text));
}

/// The fit of this run is tested where runs are fitted; here it must come whole.
#[test]
fn case_14_a_clear_bending_is_read() {
    let names = "time_s,voltage_v,current_a,tip_displacement_mm";
    let text = table(names, &noisy(), |row| {
        format!(
            "{},{:.1},{},{:.5}",
            row.t,
            row.volts,
            power(row.amperes()),
            row.tip_mm
        )
    });
    Expected::run(&noisy(), 0.0)
        .with_tip(&noisy(), 0.0, 0.5e-5)
        .is_all_of(&of("run.csv", text));
}

/// What an oscilloscope writes into the first columns, beside the first readings.
const SETTINGS: [&str; 18] = [
    "Record Length,8.500000e+01",
    "Sample Interval,5.000000e-01",
    "Trigger Point,4.0e+00",
    ",",
    ",",
    ",",
    "Source,CH1",
    "Vertical Units,V",
    "Vertical Scale,1.0e+00",
    "Vertical Offset,0.0e+00",
    "Horizontal Units,s",
    "Horizontal Scale,4.0e+00",
    "Pt Fmt,Y",
    "Yzero,0.0e+00",
    "Probe Atten,1.0e+00",
    "Model Number,X2024",
    "Serial Number,C000000",
    "Firmware Version,FV:v12",
];

/// Nothing in it names a current, so that it is no run; it must not become one by its settings.
#[test]
fn case_22_settings_beside_readings_that_nothing_names() {
    let settings = SETTINGS.iter().copied().chain(std::iter::repeat(","));
    let lines: Vec<String> = base()
        .iter()
        .zip(settings)
        .map(|(row, settings)| format!("{settings},,{:.8}, {:.6},", row.t, row.volts))
        .collect();
    let error = refused("scope.csv", lines.join("\n") + "\n");
    assert_eq!(error.code(), "no-header", "{error}");
}

#[test]
fn case_23_names_in_a_comment_line() {
    let text = table("# Time (s),Voltage (V),Current (mA)", &base(), |row| {
        format!("{:.1},{:.1},{:.5}", row.t, row.volts, row.ma)
    });
    Expected::run(&base(), 0.0).is_all_of(&of("run.csv", text));
}

#[test]
fn case_25_a_row_of_units_and_a_delimiter_behind_every_row() {
    let text = table("Time;Voltage;Current;\ns;V;mA;", &base(), |row| {
        format!("{:.1};{:.1};{:.5};", row.t, row.volts, row.ma)
    });
    Expected::run(&base(), 0.0).is_all_of(&of("run.csv", text));
}
