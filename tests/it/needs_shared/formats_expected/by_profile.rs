//! Tables without units or with a layout of their own, read by profiles written for them.

use std::path::Path;

use ieap::domain::unit::conversion;
use ieap::domain::{Quantity, RunStatus};
use ieap::ingest::Reading;
use ieap::ingest::formats::{ReadContext, ReadError};
use ieap::ingest::profiles::{Profile, from_text, read};
use serde_json::Value;

use super::held::{Held, columns};

const LASER: &str = "header_contains = \"Epoch time\"\n[time]\nbase = \"epoch\"\ncolumn = \"Epoch time (ms)\"\nunit = \"ms\"\n\
                     [[column]]\ncolumn = \"Distance1 (mm)\"\nquantity = \"tip_displacement\"\nunit = \"mm\"\n";
const CYCLER: &str =
    "header_contains = \"test_time\"\n[time]\nbase = \"elapsed\"\ncolumn = \"test_time\"\nunit = \"s\"\n";
const AMPS_VOLTS: &str = "[[column]]\ncolumn = 2\nquantity = \"current\"\nunit = \"A\"\n\
                          [[column]]\ncolumn = 3\nquantity = \"voltage\"\nunit = \"V\"\n";
const CURRENT_VOLTAGE: &str = "[[column]]\ncolumn = \"current\"\nquantity = \"current\"\nunit = \"A\"\n\
                               [[column]]\ncolumn = \"voltage\"\nquantity = \"voltage\"\nunit = \"V\"\n";
const DRY_CAL: &str = "header_contains = \"Temp. Deg C\"\n[time]\nbase = \"time-of-day\"\ncolumn = \"Time\"\n\
                       [[column]]\ncolumn = \"Temp. Deg C\"\nquantity = \"temperature\"\nunit = \"\u{b0}C\"\n\
                       [[column]]\ncolumn = \"Pressure mBar\"\nquantity = \"pressure\"\nunit = \"mbar\"\n";

/// The profile that reads a file: separator, decimal sign, and what follows in `[layout]`.
fn profile_of(file: &str) -> Option<Profile> {
    let sheet = |order: &str| {
        format!(
            "header_line = 1\nlines_after_header = 1\n[time]\nbase = \"clock\"\ncolumn = \"time\"\ndate_column = \"date\"\n\
             order = \"{order}\"\n[[column]]\ncolumn = \"float\"\nquantity = \"pressure\"\nunit = \"Pa\"\n"
        )
    };
    let (separator, decimal, rest) = match file {
        "synthetic_laser_semicolon_comma.csv" => ("semicolon", "comma", LASER.to_owned()),
        "synthetic_laser_semicolon_point.csv" => ("semicolon", "point", LASER.to_owned()),
        "synthetic_laser_tab_comma.csv" => ("tab", "comma", LASER.to_owned()),
        "headered.csv" | "preamble.csv" => ("comma", "point", format!("{CYCLER}{AMPS_VOLTS}")),
        "headerless.csv" => {
            let time = "header_line = 0\n[time]\nbase = \"elapsed\"\ncolumn = 1\nunit = \"s\"\n";
            let named = "[recognise]\nname = \"headerless*\"\n";
            ("comma", "point", format!("{time}{AMPS_VOLTS}{named}"))
        }
        "custom_good_small.csv" | "custom_nan_inf.csv" => {
            ("semicolon", "point", format!("{CYCLER}{CURRENT_VOLTAGE}"))
        }
        "20211011_DryCal_out.csv" | "flow_data.csv" => ("comma", "point", DRY_CAL.to_owned()),
        "case_uts_units.csv" => (
            "comma",
            "point",
            "header_line = 1\nlines_after_header = 1\n[time]\nbase = \"epoch\"\ncolumn = \"uts\"\nunit = \"s\"\n\
             [[column]]\ncolumn = \"T\"\nquantity = \"temperature\"\nunit = \"\u{b0}C\"\n\
             [[column]]\ncolumn = \"p\"\nquantity = \"pressure\"\nunit = \"atm\"\n"
                .to_owned(),
        ),
        "sheet.UK.tsv" => ("tab", "point", sheet("day-first")),
        "sheet.US.tsv" => ("tab", "point", sheet("month-first")),
        _ => return None,
    };
    let text = format!(
        "[profile]\nversion = 1\n[layout]\nseparator = \"{separator}\"\ndecimal = \"{decimal}\"\n{rest}"
    );
    Some(from_text(Path::new("test.toml"), &text).unwrap_or_else(|error| panic!("{file}: {error}")))
}

/// Reads a file by the profile written for it; none where there is none.
pub fn read_by_profile(file: &str, bytes: &[u8]) -> Option<Result<Reading, ReadError>> {
    let profiles = [profile_of(file)?];
    Some(read(&profiles, file, bytes, &ReadContext::default()).map(|(reading, _)| reading))
}

/// Rows, first and last values; those of real files stand in their first and last lines.
pub fn generic(held: &mut Held, reading: &Reading, expected: &Value) {
    let table = &reading.tables[0];
    if reading.format != "profile" {
        // One line is the header, and the last one has no end.
        let lines = expected["lines"].as_u64().unwrap();
        held.same("rows", table.rows as u64, lines - 2);
        return;
    }
    if expected["rows"].is_u64() {
        held.rows(table, &expected["rows"]);
        let channel = &table.channels[0];
        let place = if channel.raw_name.starts_with("Distance") {
            channel
        } else {
            &table.channels[1]
        };
        held.close(
            "first distance",
            place.values[0],
            expected["first"][1].as_f64().unwrap(),
        );
        held.close(
            "last distance",
            place.values[place.len() - 1],
            expected["last"][1].as_f64().unwrap(),
        );
        let span_ms = expected["last"][0].as_f64().unwrap() - expected["first"][0].as_f64().unwrap();
        held.close("time span", table.time_first_last_s.unwrap().1, span_ms / 1000.0);
        held.same(
            "first moment",
            reading.started_at.as_ref().map(|at| at.raw.clone()),
            Some(expected["first"][0].as_f64().unwrap().to_string()),
        );
        return;
    }
    let cells = |line: &str| -> Vec<f64> {
        let cells = line.split([',', ';', '\t']);
        cells.filter_map(|cell| cell.trim().parse().ok()).collect()
    };
    let first: Vec<f64> = expected["first_lines"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|line| cells(line.as_str().unwrap()))
        .collect();
    let last = cells(expected["last_line"].as_str().unwrap());
    for column in columns(table) {
        if matches!(column.quantity, Quantity::Time | Quantity::Other) {
            continue;
        }
        let canonical = conversion(column.quantity, &column.unit).unwrap();
        let stands = |value: f64, among: &[f64]| among.iter().any(|cell| canonical.apply(*cell) == value);
        // A long preamble leaves no row of readings among the first lines.
        if first.len() >= 2 {
            held.same(
                &format!("the first of {} stands in the first lines", column.name),
                stands(column.first, &first),
                true,
            );
        }
        // A last line without its end is left out.
        if reading.status == RunStatus::Complete {
            held.same(
                &format!("the last of {} stands in the last line", column.name),
                stands(column.last, &last),
                true,
            );
        }
    }
}

/// Every column of a Parquet file with its first value, last value and sum.
pub fn parquet(held: &mut Held, reading: &Reading, expected: &Value) {
    let table = &reading.tables[0];
    held.rows(table, &expected["rows"]);
    for (name, summary) in expected["summary"].as_object().unwrap() {
        held.column(table, name, &summary["first"], &summary["last"]);
        if let Some(column) = columns(table)
            .iter()
            .find(|column| column.name == *name)
            .filter(|c| !c.sum.is_nan())
        {
            held.close(
                &format!("sum of {name}"),
                column.sum,
                summary["sum"].as_f64().unwrap(),
            );
        }
    }
}

/// Every table of a Gamry file: name, rows, first values; last ones where no line was cut.
pub fn gamry(held: &mut Held, reading: &Reading, expected: &Value) {
    let expected = &expected["crosscheck"];
    held.same(
        "technique",
        reading.technique.as_deref(),
        expected["tag"].as_str(),
    );
    let aborted = reading.status == RunStatus::Aborted;
    held.same("aborted", aborted, expected["aborted"].as_bool().unwrap());
    let is_cut = reading.issues.iter().any(|issue| issue.code == "file-cut");
    for (table, expected) in reading.tables.iter().zip(expected["tables"].as_array().unwrap()) {
        held.same("table", table.name.as_str(), expected["name"].as_str().unwrap());
        let is_whole = !is_cut || table.rows as u64 == expected["rows"].as_u64().unwrap();
        if is_whole {
            held.rows(table, &expected["rows"]);
        }
        for (name, summary) in expected["summary"].as_object().unwrap() {
            // Flags are no numbers, and a thermometer without a probe has no readings.
            if columns(table).iter().any(|column| column.name == *name) {
                let last = if is_whole { &summary["last"] } else { &Value::Null };
                held.column(table, name, &summary["first"], last);
            }
        }
    }
}

/// Every column of a NOVA export, or its rows.
pub fn nova(held: &mut Held, reading: &Reading, expected: &Value) {
    let table = &reading.tables[0];
    held.rows(table, &expected["rows"]);
    for (name, summary) in expected["summary"].as_object().into_iter().flatten() {
        held.column(table, name, &summary["first"], &summary["last"]);
    }
}
