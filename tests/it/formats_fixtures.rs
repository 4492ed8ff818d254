//! Small files typed by hand, `tests/formats/<format>/<technique>.<oddity>.<ext>`, each with what must be read
//! from it in `<file>.expected.json`. `IEAP_UPDATE_EXPECTED=1` writes those that are missing, for review.

use std::fs;
use std::path::{Path, PathBuf};

use ieap::ingest::Reading;
use ieap::ingest::formats::{ALL, ReadContext, ReadError, read};
use serde_json::{Value, json};

/// Every fixture: format folder, path, bytes.
pub fn fixtures() -> Vec<(String, PathBuf, Vec<u8>)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/formats");
    let mut found = Vec::new();
    let entries = fs::read_dir(root).unwrap().map(|entry| entry.unwrap().path());
    for folder in entries.filter(|path| path.is_dir()) {
        for path in fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.extension().is_none_or(|extension| extension != "json") {
                let format = folder.file_name().unwrap().to_string_lossy().into_owned();
                let bytes = fs::read(&path).unwrap();
                found.push((format, path, bytes));
            }
        }
    }
    found.sort();
    found
}

fn describe(result: &Result<Reading, ReadError>) -> Value {
    match result {
        Err(error) => json!({
            "error": error.code(), "place": error.place(), "pending": error.is_pending(), "message": error.to_string(),
        }),
        Ok(reading) => json!({
            "format": reading.format,
            "technique": reading.technique,
            "is_step_response": reading.is_step_response,
            "encoding": reading.encoding,
            "status": reading.status,
            "status_evidence": reading.status_evidence,
            "started_at": reading.started_at,
            "header_tags": reading.header_tags,
            "tables": reading.tables.iter().map(|table| json!({
                "name": table.name, "rows": table.rows, "time_zero_is_step": table.time_zero_is_step,
                "columns": table.columns(),
            })).collect::<Vec<_>>(),
            "issues": reading.issues,
        }),
    }
}

#[test]
fn fixtures_read_as_expected() {
    let mut wrong = Vec::new();
    for (format, path, bytes) in fixtures() {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let result = read(&name, &bytes, &ReadContext::default());
        if let Ok(reading) = &result {
            assert_eq!(reading.format, format, "{name} stands in the wrong folder");
        }
        let expected_path = PathBuf::from(format!("{}.expected.json", path.display()));
        let found = describe(&result);
        if !expected_path.exists() && std::env::var_os("IEAP_UPDATE_EXPECTED").is_some() {
            fs::write(&expected_path, format!("{found:#}\n")).unwrap();
        }
        let expected =
            fs::read_to_string(&expected_path).unwrap_or_else(|_| panic!("{name} has no expected values"));
        if found != serde_json::from_str::<Value>(&expected).unwrap() {
            wrong.push(format!("{name}: found {found:#}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_text_format_has_fixtures() {
    let fixtures = fixtures();
    // These cannot be typed by hand: tests/it/samples.rs makes them.
    let binary = ["spreadsheet", "eplexor-xls", "parquet"];
    for format in ALL.iter().filter(|format| !binary.contains(&format.id())) {
        assert!(
            fixtures.iter().any(|(folder, _, _)| folder == format.id()),
            "{}",
            format.id()
        );
    }
}

/// Twins hold the same measurement in another spelling.
#[test]
fn twins_read_the_same_numbers() {
    let numbers = |file: &str| -> Vec<(f64, f64)> {
        let (_, _, bytes) = fixtures()
            .into_iter()
            .find(|(_, path, _)| path.ends_with(file))
            .unwrap();
        let reading = read(file, &bytes, &ReadContext::default()).unwrap();
        let current = reading.tables[0]
            .channels
            .iter()
            .find(|c| c.quantity.key() == "current")
            .unwrap();
        current
            .time_s
            .iter()
            .copied()
            .zip(current.values.iter().copied())
            .collect()
    };
    let canonical = numbers("step.canonical.csv");
    for twin in ["step.crlf.csv", "step.decimal_comma.csv"] {
        assert_eq!(numbers(twin), canonical, "{twin}");
    }
    let from_zero = canonical[1..].to_vec();
    for twin in [
        "step.tab_micro_1252.tsv",
        "step.micro_utf8_bom.csv",
        "step.utf16le.txt",
        "step.utf16be.txt",
        "step.blank_padded.dat",
    ] {
        assert_eq!(numbers(twin), from_zero, "{twin}");
    }
    for (file, twin) in [
        ("chronoa.complete.DTA", "chronoa.decimal_comma.DTA"),
        ("ca.complete_crlf.mpt", "ca.comma_lf.mpt"),
        ("ca.complete_crlf.mpt", "ca.utf8.mpt"),
        ("ca.complete_crlf.mpt", "ca.three_header_lines.mpt"),
        ("ca.complete_crlf.mpt", "ca.no_last_line_end.mpt"),
        ("ca.complete.mpr", "ca.long_headers.mpr"),
        ("ca.complete.mpr", "ca.version_2.mpr"),
        ("it.complete.txt", "it.tab_lf.txt"),
        ("ca.utf16.csv", "ca.utf8_lf.csv"),
        ("ca.utf16.csv", "ca.windows_1252.csv"),
        ("step.no_x_column.lvm", "step.decimal_comma.lvm"),
        ("step.big_endian.tdms", "step.interleaved.tdms"),
        ("step.vectors.mat", "step.vectors_packed.mat"),
        ("step.vectors.mat", "step.matrix_with_names.mat"),
    ] {
        assert_eq!(numbers(file), numbers(twin), "{twin}");
    }
}
