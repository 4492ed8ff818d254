//! Real instrument files with expected values that other readers found.

use std::fs;
use std::path::{Path, PathBuf};

use ieap::domain::{Channel, Quantity, RunStatus};
use ieap::ingest::formats::{ReadContext, ReadError, read};
use ieap::ingest::{Reading, RunTable};
use serde_json::Value;

use super::shared;

fn name_of(path: &Path) -> String {
    path.file_name().unwrap().to_string_lossy().into_owned()
}

fn read_file(path: &Path) -> Result<Reading, ReadError> {
    read(&name_of(path), &fs::read(path).unwrap(), &ReadContext::default())
}

/// Files of the folder that have expected values, in order, with those.
fn expected_files(folder: &Path) -> Vec<(PathBuf, Value)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let expected = PathBuf::from(format!("{}.expected.json", path.display()));
        if expected.is_file() {
            let values = serde_json::from_str(&fs::read_to_string(&expected).unwrap()).unwrap();
            found.push((path, values));
        }
    }
    found.sort_by(|a, b| a.0.cmp(&b.0));
    found
}

/// The channel of a raw column name, or the time column under that name.
fn channel<'a>(table: &'a RunTable, name: &str) -> Option<&'a Channel> {
    table.channels.iter().find(|channel| channel.raw_name == name)
}

fn close(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= 1e-12 * expected.abs()
}

#[test]
fn gamry_files_hold_what_other_readers_found() {
    let Some(folder) = shared("formats/gamry") else {
        return;
    };
    let mut files = 0;
    for (path, expected) in expected_files(&folder) {
        let bytes = fs::read(&path).unwrap();
        let cut_rows = usize::from(!bytes.ends_with(b"\n"));
        let expected = &expected["crosscheck"];
        let tables = expected["tables"].as_array().unwrap();
        let name = name_of(&path);
        if tables.is_empty() {
            assert!(read_file(&path).unwrap_err().is_pending(), "{name}");
            println!("{name}: no table, waits");
            files += 1;
            continue;
        }
        let reading = read_file(&path).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(reading.format, "gamry-dta", "{name}");
        assert_eq!(reading.technique.as_deref(), expected["tag"].as_str(), "{name}");
        assert_eq!(
            reading.status == RunStatus::Aborted,
            expected["aborted"].as_bool().unwrap(),
            "{name}"
        );
        let date = format!(
            "{} {}",
            expected["date"].as_str().unwrap(),
            expected["time"].as_str().unwrap()
        );
        let found_date = reading.started_at.as_ref().map_or("", |at| at.raw.as_str());
        assert_eq!(found_date, date.trim(), "{name}");
        assert_eq!(reading.tables.len(), tables.len(), "{name}");
        for (index, (table, expected)) in reading.tables.iter().zip(tables).enumerate() {
            let rows = expected["rows"].as_u64().unwrap() as usize;
            let is_last = index + 1 == tables.len();
            let lost = rows - table.rows;
            assert!(
                lost == 0 || (is_last && lost <= cut_rows),
                "{name} {}: {lost} rows lost",
                table.name
            );
            check_gamry_table(&name, table, expected, lost == 0);
        }
        let local = reading
            .started_at
            .and_then(|at| at.local)
            .unwrap_or_else(|| "no certain date".to_owned());
        println!(
            "{name}: {} table(s), {:?}, {local}",
            reading.tables.len(),
            reading.status
        );
        files += 1;
    }
    assert!(files >= 16, "{files} files");
}

fn check_gamry_table(name: &str, table: &RunTable, expected: &Value, is_whole: bool) {
    assert_eq!(table.name, expected["name"].as_str().unwrap());
    let columns = expected["columns"].as_array().unwrap();
    for (column, unit) in columns.iter().zip(expected["units"].as_array().unwrap()) {
        let column = column.as_str().unwrap();
        let summary = &expected["summary"][column];
        let place = format!("{name} {} {column}", table.name);
        let (first, last) = if table.time_column.as_ref().is_some_and(|(time, _)| time == column) {
            table.time_first_last_s.unwrap()
        } else if let Some(channel) = channel(table, column) {
            if unit.as_str().unwrap().is_ascii() {
                assert_eq!(channel.raw_unit, unit.as_str().unwrap(), "{place}");
            }
            if is_whole {
                let sum: f64 = channel.values.iter().sum();
                let magnitude: f64 = channel.values.iter().map(|value| value.abs()).sum();
                let expected_sum = summary["sum"].as_f64().unwrap();
                assert!(
                    (sum - expected_sum).abs() <= 1e-9 * magnitude,
                    "{place}: sum {sum}, {expected_sum}"
                );
            }
            (channel.values[0], channel.values[channel.len() - 1])
        } else {
            assert!(matches!(column, "Over" | "Temp"), "{place} is missing");
            continue;
        };
        assert!(
            close(first, summary["first"].as_f64().unwrap()),
            "{place}: first {first}"
        );
        if is_whole {
            assert!(
                close(last, summary["last"].as_f64().unwrap()),
                "{place}: last {last}"
            );
        }
    }
    if let Some(temperature) = table
        .channels
        .iter()
        .find(|c| c.quantity == Quantity::Temperature)
    {
        assert!(
            temperature.values.iter().all(|&celsius| celsius < 200.0),
            "{name}: a sentinel became a temperature"
        );
    }
}

#[test]
fn nova_files_hold_what_other_readers_found() {
    let Some(folder) = shared("formats/autolab") else {
        return;
    };
    let mut files = 0;
    for (path, expected) in expected_files(&folder) {
        let name = name_of(&path);
        if !expected["rows"].is_u64() {
            println!("{name}: impedance, refused: {}", read_file(&path).unwrap_err());
            continue;
        }
        let reading = read_file(&path).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(reading.format, "autolab-nova", "{name}");
        let table = &reading.tables[0];
        assert_eq!(table.rows as u64, expected["rows"].as_u64().unwrap(), "{name}");
        let (time, unit) = table.time_column.clone().unwrap();
        assert_eq!(unit, "s", "{name}");
        if let Some(summary) = expected["summary"].as_object() {
            assert_eq!(
                time.starts_with("Corrected"),
                summary.contains_key("Corrected time (s)"),
                "{name}"
            );
            for (column, summary) in summary {
                let (first, last) = match channel(table, column) {
                    Some(channel) => (channel.values[0], channel.values[channel.len() - 1]),
                    None => table.time_first_last_s.unwrap(),
                };
                assert!(
                    close(first, summary["first"].as_f64().unwrap()),
                    "{name} {column}: first {first}"
                );
                assert!(
                    close(last, summary["last"].as_f64().unwrap()),
                    "{name} {column}: last {last}"
                );
            }
        } else {
            let found: Vec<f64> = table.channels.iter().map(|channel| channel.values[0]).collect();
            let expected: Vec<f64> = expected["first"]
                .as_array()
                .unwrap()
                .iter()
                .map(|v| v.as_f64().unwrap())
                .collect();
            assert_eq!(
                found,
                [expected[0], expected[1], expected[2], expected[4]],
                "{name}"
            );
            assert_eq!(time, "Corrected time (s)", "{name}");
        }
        assert_eq!(reading.is_step_response, !name.contains("cv"), "{name}");
        println!("{name}: {} rows, time from {time}", table.rows);
        files += 1;
    }
    assert!(files >= 6, "{files} files");
}

#[test]
fn generic_files_are_read_or_refused_with_a_reason() {
    let Some(folder) = shared("formats/generic_csv") else {
        return;
    };
    for (path, _) in expected_files(&folder) {
        let name = name_of(&path);
        match read_file(&path) {
            Ok(reading) => println!(
                "{name}: {} rows, {} issues",
                reading.tables[0].rows,
                reading.issues.len()
            ),
            Err(error) => println!("{name}: {} at {:?}", error, error.place()),
        }
        match name.as_str() {
            "bad.xlsx" => assert_eq!(read_file(&path), Err(ReadError::Empty)),
            "sample.bdf.csv" => assert_eq!(
                read_file(&path).unwrap().tables[0].rows,
                2,
                "the last line has no end"
            ),
            // Dates beside temperatures with their units: logs of a climate.
            "case_custom_ts.tsv" | "case_date_time_iso.csv" | "case_uts_units.csv" => {
                assert_eq!(read_file(&path).unwrap().format, "climate-table", "{name}");
            }
            _ => assert!(
                read_file(&path).is_err(),
                "{name} names no unit of time or no response"
            ),
        }
    }
}

/// Run files of a campaign, in order.
fn run_files(campaign: &str) -> Option<Vec<PathBuf>> {
    let folder = shared(&format!("campaigns/{campaign}/runs"))?;
    let is_run = |path: &PathBuf| path.extension().is_none_or(|extension| extension != "toml");
    let mut files: Vec<PathBuf> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(is_run)
        .collect();
    files.sort();
    Some(files)
}

#[test]
fn capacitor_tables_are_read_whole() {
    for path in run_files("capacitors").unwrap_or_default() {
        let reading = read_file(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let table = &reading.tables[0];
        let lines = fs::read_to_string(&path).unwrap().lines().count();
        assert_eq!(table.rows, lines - 1);
        assert_eq!(
            (table.channels[0].quantity, table.channels[1].quantity),
            (Quantity::Voltage, Quantity::Current)
        );
        assert!(table.time_zero_is_step && table.channels.iter().all(|channel| channel.len() == table.rows));
        assert!(std::sync::Arc::ptr_eq(
            &table.channels[0].time_s,
            &table.channels[1].time_s
        ));
        println!(
            "{}: {} rows, issues {:?}",
            name_of(&path),
            table.rows,
            codes(&reading)
        );
    }
}

#[test]
fn spreadsheets_of_diffusion_steps_exclude_their_overloads() {
    for path in run_files("diffusion-steps").unwrap_or_default() {
        let reading = read_file(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let table = &reading.tables[0];
        let current = table
            .channels
            .iter()
            .find(|channel| channel.quantity == Quantity::Current)
            .unwrap();
        assert!(table.rows > 100 && reading.is_step_response);
        assert_eq!(table.time_column.as_ref().unwrap().0, "Corrected time (s)");
        assert!(current.excluded.len() <= 3, "{} excluded", current.excluded.len());
        println!(
            "{}: {} rows, {} excluded, issues {:?}",
            name_of(&path),
            table.rows,
            current.excluded.len(),
            codes(&reading)
        );
    }
}

#[test]
fn the_gamry_campaign_knows_its_potentials_and_dates() {
    for (index, path) in run_files("electrolysis-onset")
        .unwrap_or_default()
        .iter()
        .enumerate()
    {
        let reading = read_file(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert_eq!(
            (reading.status, reading.tables[0].rows),
            (RunStatus::Complete, 106)
        );
        assert!(reading.is_step_response);
        let number: f64 = name_of(path)
            .trim_end_matches(".DTA")
            .rsplit_once('n')
            .unwrap()
            .1
            .parse()
            .unwrap();
        let (_, volts, _) = reading
            .header_tags
            .iter()
            .find(|(key, _, _)| key == "voltage_v")
            .unwrap();
        assert!(
            (volts.parse::<f64>().unwrap() + 0.05 * (number - 1.0)).abs() < 1e-9,
            "{volts}"
        );
        let local = reading.started_at.as_ref().unwrap().local.clone().unwrap();
        assert!(
            local.starts_with(if number >= 13.0 {
                "2024-02-13"
            } else {
                "2024-07-17"
            }),
            "{local}"
        );
        println!(
            "{index} {}: {volts} V at {local}, issues {:?}",
            name_of(path),
            codes(&reading)
        );
    }
}

fn codes(reading: &Reading) -> Vec<&str> {
    reading.issues.iter().map(|issue| issue.code.as_str()).collect()
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn a_cut_of_a_real_file_never_changes_a_number() {
    // Each with the least number of cuts that can be read.
    for (file, least) in [
        ("gamry/CHRONOPOINTS_1_16.DTA", 1500),
        ("gamry/cv_data.dta", 4000),
        ("autolab/synthetic_nova_ca_semicolon_comma.txt", 3000),
        ("ivium/synthetic_export_extra_column.txt", 2500),
        ("biologic/vsp_ocv_with.mpt", 800),
        ("biologic/vsp_ocv_with.mpr", 250),
        ("chi/mshi_ocp_unhealthy_p2_trial4.txt", 2000),
        ("palmsens/ps_single.csv", 3000),
        ("labview_lvm/with_comments.lvm", 250),
        ("labview_tdms/raw_timestamps.tdms", 1000),
        ("labview_tdms/synthetic_incremental_metadata.tdms", 1400),
        ("labview_tdms/synthetic_multichunk_one_segment.tdms", 1400),
        ("netzsch/excerpt_sta449f3_point_semicolon.txt", 250),
    ]
    .into_iter()
    .step_by(crate::campaign::counted(4, 1))
    {
        let Some(folder) = shared("formats") else { return };
        let bytes = fs::read(folder.join(file)).unwrap();
        let name = file.rsplit('/').next().unwrap();
        let survived = crate::formats_properties::cuts(name, &bytes);
        println!("{file}: {survived} of {} cuts read", bytes.len());
        assert!(
            survived >= least,
            "{file}: {survived} of {} cuts read",
            bytes.len()
        );
    }
}
