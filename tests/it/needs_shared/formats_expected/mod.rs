//! Every real instrument file beside the project: read, refused with a reason, or not applicable, one line each, and
//! held against what other readers found in it.

use std::fs;
use std::path::{Path, PathBuf};

use ieap::ingest::Reading;
use ieap::ingest::formats::{ReadContext, ReadError, read};
use serde_json::Value;

use super::shared;

mod by_profile;
mod climate;
mod held;
mod labview;
mod potentiostats;
mod thermal;

use by_profile::read_by_profile;
use held::Held;

fn files(root: &Path) -> Vec<(String, PathBuf)> {
    let mut found = Vec::new();
    for folder in fs::read_dir(root).unwrap().map(|entry| entry.unwrap().path()) {
        let vendor = folder.file_name().unwrap().to_string_lossy().into_owned();
        for path in fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()) {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if !name.ends_with(".expected.json") && name != "PROVENANCE.md" {
                found.push((format!("{vendor}/{name}"), path));
            }
        }
    }
    found.sort();
    found
}

fn outcome(result: &Result<Reading, ReadError>) -> String {
    match result {
        Ok(reading) => {
            let rows: Vec<usize> = reading.tables.iter().map(|table| table.rows).collect();
            let local = reading.started_at.as_ref().and_then(|at| at.local.as_deref());
            format!(
                "read as {}: {rows:?} rows, {}, {}, technique {:?}, issues {:?}",
                reading.format,
                reading.status.key(),
                local.unwrap_or("no certain date"),
                reading.technique.as_deref().unwrap_or(""),
                reading
                    .issues
                    .iter()
                    .map(|issue| issue.code.as_str())
                    .collect::<Vec<_>>(),
            )
        }
        Err(error) if error.is_sidecar() => format!("not applicable: {error}"),
        Err(error) if error.is_pending() => format!("waits: {error}"),
        Err(error) => format!("refused: {error}"),
    }
}

/// Holds one file against its expected values; none where nothing of it is a number that can be held.
fn hold(name: &str, reading: &Reading, expected: &Value) -> Option<Held> {
    let mut held = Held::new(name);
    match name.split('/').next().unwrap() {
        "ivium" => potentiostats::ivium(&mut held, reading, expected),
        "biologic" => potentiostats::biologic(&mut held, reading, expected),
        "chi" => potentiostats::chi(&mut held, reading, expected),
        "palmsens" => potentiostats::palmsens(&mut held, reading, expected),
        "labview_lvm" => labview::lvm(&mut held, reading, expected),
        "labview_tdms" => labview::tdms(&mut held, reading, expected),
        "netzsch" => thermal::netzsch(&mut held, reading, expected),
        "ta_trios" => thermal::trios(&mut held, reading, expected),
        "rh_loggers" => climate::loggers(&mut held, reading, expected),
        "gamry" => by_profile::gamry(&mut held, reading, expected),
        "autolab" => by_profile::nova(&mut held, reading, expected),
        "hdf5_parquet" => by_profile::parquet(&mut held, reading, expected),
        "generic_csv" => by_profile::generic(&mut held, reading, expected),
        _ => return None,
    }
    Some(held)
}

/// Files with expected values that hold no readings, or that are refused.
const WITHOUT_READINGS: [&str; 17] = [
    // A needed column is gone; no column of times; times that repeat in half of the rows.
    "generic_csv/custom_missing_column.csv",
    "generic_csv/results_for_testing_parameters.csv",
    "generic_csv/sheet.UK.tsv",
    "generic_csv/sheet.US.tsv",
    // NetCDF-4, which is refused by its name.
    "hdf5_parquet/yadg_data_2.nc",
    // Impedance of NOVA, which has no time.
    "autolab/exampleDataAutolab.txt",
    // A header without rows: it waits.
    "gamry/cv_data_incompleteheader.dta",
    // No byte.
    "generic_csv/bad.xlsx",
    // Refused: no unit of time, or no response, and no profile is written for them here.
    "generic_csv/case_custom_ts.tsv",
    "generic_csv/case_date_time_iso.csv",
    "generic_csv/case_time_custom.csv",
    "generic_csv/case_timestamp.ssv",
    // EC-Lab's pauses.
    "biologic/wait.mpr",
    "biologic/wait.mpt",
    "biologic/wait.old.mpt",
    // A binary file of NETZSCH, for which there is no reader.
    "netzsch/01_Messung_Probe_G_300_Grad_Ar.ngb-ds3",
    // No byte.
    "labview_tdms/synthetic_zero.tdms",
];

#[test]
fn every_file_is_read_and_held_or_refused_with_a_reason() {
    let Some(root) = shared("formats") else {
        return;
    };
    let (mut files_held, mut values_held, mut wrong) = (0, 0, Vec::new());
    for (name, path) in files(&root) {
        let bytes = fs::read(&path).unwrap();
        let file = name.rsplit('/').next().unwrap();
        let result =
            read_by_profile(file, &bytes).unwrap_or_else(|| read(file, &bytes, &ReadContext::default()));
        let expected_path = PathBuf::from(format!("{}.expected.json", path.display()));
        let expected = fs::read_to_string(expected_path).ok();
        // Python writes NaN, which JSON does not have.
        let expected: Option<Value> =
            expected.map(|text| serde_json::from_str(&text.replace(" NaN", " null")).unwrap());
        let held = match (&result, &expected) {
            (Ok(reading), Some(expected)) => hold(&name, reading, expected),
            _ => None,
        };
        let Some(held) = held else {
            println!("{name}: {}", outcome(&result));
            let must_read = expected.is_some() && !WITHOUT_READINGS.contains(&name.as_str());
            if must_read {
                wrong.push(format!("{name}: {}", outcome(&result)));
            }
            continue;
        };
        println!("{name}: {}; {} values held", outcome(&result), held.count);
        files_held += 1;
        values_held += held.count;
        if held.count == 0 {
            wrong.push(format!("{name}: nothing was held against it"));
        }
        wrong.extend(held.wrong);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    println!("{values_held} values of {files_held} files");
    assert!(
        files_held >= 65 && values_held > 2000,
        "{values_held} values of {files_held} files"
    );
}
