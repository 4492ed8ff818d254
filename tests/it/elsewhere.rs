//! Fits made elsewhere, as data frames on a cluster make them, and brought back.

use ieap::pipeline::fits::instruments::noise_of_others;
use ieap::pipeline::fits::result::FitResult;
use ieap::pipeline::standalone::in_memory::CampaignRow;
use ieap::pipeline::{Context, FitChoice};
use ieap::store::{ResultKind, Store};
use parquet::file::reader::{FileReader, SerializedFileReader};
use polars::prelude::{Column, DataFrame, NamedFrom, Series};
use serde_json::Value;

use crate::campaign::{CampaignFolder, counted, run_table};

/// A campaign with runs that are taken in and not fitted.
fn taken_in(runs: u32) -> CampaignFolder {
    let folder = CampaignFolder::new();
    for seed in 1..=runs {
        folder.write(&format!("runs/{seed}.csv"), run_table(seed));
    }
    folder.ieap(&["ingest"]).expect(0);
    folder
}

fn content_hash(folder: &CampaignFolder) -> String {
    let verified = folder.ieap(&["verify", "--deep", "--json"]).expect(0).json();
    verified["verify"]["content_hash"]
        .as_str()
        .expect("a hash")
        .to_owned()
}

/// The results of all runs, fitted outside of the campaign, with what a copy of it says that they are made from.
fn results(folder: &CampaignFolder, choice: &FitChoice) -> Vec<Value> {
    let copy = copied(folder);
    copy.ieap(&["fit"]).expect(0);
    let store = Store::open_read_only(copy.path()).unwrap().unwrap();
    let keys = store.result_keys(ResultKind::Fit).unwrap();
    let mut noise = noise_of_others(&Context::open_read_only(copy.path()).unwrap()).unwrap();
    let fitted = |task: ieap::store::FitTask| {
        let noise = noise.remove(&task.path).unwrap();
        // As it travels.
        let noise = serde_json::from_str(&serde_json::to_string(&noise).unwrap()).unwrap();
        let row = CampaignRow {
            channels: store.channels(task.run_id).unwrap(),
            run: task.path.clone(),
            data_hash: task.data_hash,
            input_hash: keys[&task.path].clone(),
            area_cm2: task.area_cm2,
            length_cm: task.length_cm,
            electrode_resistance_ohm_per_sq: task.electrode_resistance_ohm_per_sq,
            electrode_resistance_error_ohm_per_sq: task.electrode_resistance_error_ohm_per_sq,
            drive: task.drive,
            chosen: Default::default(),
            noise,
        };
        serde_json::to_value(row.fit(choice).1).unwrap()
    };
    store.fit_tasks().unwrap().into_iter().map(fitted).collect()
}

/// A row with a checksum of its own, as if it had been written so.
fn sealed(row: &Value) -> Value {
    let mut result: FitResult = serde_json::from_value(row.clone()).unwrap();
    result.checksum = result.sum();
    serde_json::to_value(&result).unwrap()
}

/// What a data frame writes: text columns, the fit as JSON in one of them.
fn table(rows: &[Value]) -> Vec<u8> {
    let column = |name: &str| {
        let text = |row: &Value| match &row[name] {
            Value::Null => None,
            Value::String(text) => Some(text.clone()),
            other => Some(other.to_string()),
        };
        let texts: Vec<Option<String>> = rows.iter().map(text).collect();
        Column::from(Series::new(name.into(), texts))
    };
    let columns = [
        "schema",
        "run",
        "data_hash",
        "input_hash",
        "code_version",
        "built_from",
        "asked",
        "fit",
        "issue",
        "checksum",
    ]
    .map(column);
    let mut frame = DataFrame::new(rows.len(), columns.to_vec()).unwrap();
    let mut bytes = Vec::new();
    polars_io::parquet::write::ParquetWriter::new(&mut bytes)
        .finish(&mut frame)
        .unwrap();
    bytes
}

#[test]
fn what_comes_back_is_what_the_campaign_would_have_stored() {
    let (whole, away) = (taken_in(5), taken_in(5));
    whole.ieap(&["fit"]).expect(0);
    let rows = results(&away, &FitChoice::default());
    away.write("results/part-0.parquet", table(&rows[..2]));
    away.write("results/part-1.parquet", table(&rows[2..]));
    away.write("results/_SUCCESS", "");
    let imported = away.ieap(&["import-fits", "results", "--json"]).expect(0).json();
    assert_eq!(imported["imported"]["imported"], 5);
    assert_eq!(content_hash(&away), content_hash(&whole), "to the bit");
    let again = away
        .ieap(&["import-fits", "results/part-0.parquet", "--json"])
        .expect(0)
        .json();
    assert_eq!(again["imported"]["imported"], 0);
    let left = away.ieap(&["fit"]).expect(0);
    assert!(left.stderr.contains("0 fitted, 5 up to date"), "{left:?}");
    // Curves did not travel, and are drawn all the same: dots and lines.
    assert!(
        rows.iter()
            .all(|row| row["fit"]["curves"] == Value::Array(vec![]))
    );
    let drawn = |of: &CampaignFolder| {
        of.ieap(&["figure", "currents", "-o", "currents.svg"]).expect(0);
        std::fs::read_to_string(of.join("currents.svg")).unwrap()
    };
    assert!(drawn(&away) == drawn(&whole), "the figures differ");
}

#[test]
fn fits_of_another_version_are_told_apart() {
    let folder = taken_in(2);
    let mut rows = results(&folder, &FitChoice::default());
    rows[1]["code_version"] = "0.0.9".into();
    rows[1] = sealed(&rows[1]);
    folder.write("fits.parquet", table(&rows));
    let ended = folder.ieap(&["import-fits", "fits.parquet", "--json"]).expect(0);
    let imported = &ended.json()["imported"];
    assert_eq!(imported["imported"], 2);
    assert_eq!(imported["of_other_versions"], serde_json::json!({ "0.0.9": 1 }));
    assert!(ended.stderr.contains("1 fit made by ieap 0.0.9"), "{ended:?}");
    let database = rusqlite::Connection::open(folder.join("campaign.db")).unwrap();
    let sql = "SELECT count(DISTINCT run) FROM fits_view WHERE code_version = '0.0.9'";
    let of_view: i64 = database.query_row(sql, [], |row| row.get(0)).unwrap();
    assert_eq!(of_view, 1);
}

#[test]
fn a_choice_that_was_asked_for_travels_with_the_results() {
    let folder = taken_in(1);
    let choice = FitChoice {
        model: Some("lumped-1".to_owned()),
        ..FitChoice::default()
    };
    folder.write("fits.parquet", table(&results(&folder, &choice)));
    folder.ieap(&["import-fits", "fits.parquet"]).expect(0);
    let fits = folder.ieap(&["fit", "--json"]).expect(0);
    assert!(fits.stderr.contains("model lumped-1"), "kept as asked: {fits:?}");
    assert_eq!(fits.json()["fits"][0]["model"], "lumped-1");
}

#[test]
fn a_row_that_cannot_be_used_stops_no_other_and_is_told() {
    let folder = taken_in(4);
    let whole = results(&folder, &FitChoice::default());
    let with = |key: &str, value: Value| {
        let mut row = whole[1].clone();
        row[key] = value;
        row
    };
    let mut other_model = whole[3].clone();
    other_model["fit"]["parameters"][0]["key"] = "beauty".into();
    let fit = whole[1]["fit"].to_string();
    let rows = [
        whole[0].clone(),
        with("fit", fit[..fit.len() / 2].into()),
        sealed(&with("data_hash", "0".into())),
        sealed(&with("input_hash", "0".into())),
        sealed(&with("run", "runs/nowhere.csv".into())),
        sealed(&with("fit", Value::Null)),
        sealed(&with("schema", "ieap/fit-result/9".into())),
        sealed(&other_model),
        whole[2].clone(),
    ];
    folder.write("results/part.parquet", table(&rows));
    let ended = folder.ieap(&["import-fits", "results", "--json"]).expect(3);
    let imported = ended.json()["imported"].clone();
    assert_eq!((&imported["rows"], &imported["imported"]), (&9.into(), &2.into()));
    let refused = imported["refused"].as_array().unwrap();
    let rows: Vec<u64> = refused.iter().map(|row| row["row"].as_u64().unwrap()).collect();
    assert_eq!(
        rows,
        [2, 6, 7, 3, 4, 5, 8],
        "what cannot be read first, then what does not fit"
    );
    let reason = |row: u64| {
        let found = refused.iter().find(|entry| entry["row"] == row).unwrap();
        found["reason"].as_str().unwrap().to_owned()
    };
    assert!(reason(3).contains("readings are others"), "{refused:?}");
    assert!(reason(4).contains("input_hash differs"), "{refused:?}");
    assert!(reason(5).contains("no run of that name"), "{refused:?}");
    assert!(reason(6).contains("either a fit or an issue"), "{refused:?}");
    assert!(reason(8).contains("beauty"), "{refused:?}");
    assert!(ended.stderr.contains("row 3, runs/"), "{ended:?}");
    folder.ieap(&["import-fits", "nothing.parquet"]).expect(4);
}

/// A copy of a campaign.
fn copied(of: &CampaignFolder) -> CampaignFolder {
    let copy = CampaignFolder::new();
    let made = std::process::Command::new("cp")
        .arg("-a")
        .arg(format!("{}/.", of.path().display()))
        .arg(copy.path())
        .status();
    assert!(made.unwrap().success());
    copy
}

/// Bits all over a file, one at a time: what came of another number is never stored.
#[test]
fn a_file_that_was_damaged_on_its_way_brings_no_other_number() {
    let folder = taken_in(2);
    let whole = table(&results(&folder, &FitChoice::default()));
    let direct = copied(&folder);
    direct.ieap(&["fit"]).expect(0);
    let fits = |folder: &CampaignFolder| {
        folder
            .ieap(&["export", "--what", "fits", "--json"])
            .expect(0)
            .stdout
    };
    let sound = fits(&direct);
    for turn in 0..counted(24, 2000) {
        let folder = copied(&folder);
        let mut flipped = whole.clone();
        let at = (turn * 7919 + 13) % flipped.len();
        flipped[at] ^= 1 << (turn % 8);
        folder.write("part.parquet", &flipped);
        // A bit that says nothing of a row, or a file that cannot be read at all: whatever it ends with.
        let _ = folder.ieap(&["import-fits", "part.parquet"]);
        folder.ieap(&["fit"]).expect(0);
        assert_eq!(fits(&folder), sound, "byte {at}");
    }
}

#[test]
fn numbers_that_no_fit_of_the_run_has_are_found_by_fitting_it_again() {
    let folder = taken_in(4);
    let whole = results(&folder, &FitChoice::default());
    for factor in [1.1, 1e308] {
        let folder = copied(&folder);
        let mut rows = whole.clone();
        let mut wrong = rows[2].clone();
        for name in ["value", "standard_error", "low_95", "high_95"] {
            let number = &mut wrong["fit"]["parameters"][0]["estimate"][name];
            *number = (number.as_f64().unwrap() * factor).min(f64::MAX).into();
        }
        rows[2] = sealed(&wrong);
        folder.write("part.parquet", table(&rows));
        let ended = folder.ieap(&["import-fits", "part.parquet", "--json"]).expect(3);
        let imported = ended.json()["imported"].clone();
        assert_eq!(
            (&imported["imported"], &imported["fitted_again"]),
            (&3.into(), &4.into()),
            "{imported}"
        );
        let reason = imported["refused"][0]["reason"].as_str().unwrap().to_owned();
        assert!(
            reason.contains("fitted again here") && reason.contains("the row says"),
            "{reason}"
        );
        let left = folder.ieap(&["fit"]).expect(0);
        assert!(left.stderr.contains("1 fitted, 3 up to date"), "{left:?}");
    }
}

#[test]
fn a_run_that_cannot_be_fitted_gives_a_row_with_the_reason() {
    let folder = taken_in(1);
    // Too few readings for any model.
    folder.write(
        "runs/short.csv",
        "time_s,voltage_v,current_a\n-2,0,0\n-1,0,0\n0,2,0.001\n1,2,0.0009\n2,2,0.0008\n",
    );
    folder.ieap(&["ingest"]).expect(0);
    folder.write("fits.parquet", table(&results(&folder, &FitChoice::default())));
    let imported = folder
        .ieap(&["import-fits", "fits.parquet", "--json"])
        .expect(0)
        .json();
    assert_eq!(imported["imported"]["failed"][0][0], "runs/short.csv");
    let fits = folder.ieap(&["fit", "--json"]).expect(0).json();
    assert_eq!(fits["not_fitted"][0]["run"], "runs/short.csv");
    assert_eq!(fits["fits"].as_array().unwrap().len(), 1);
}

/// The tables that clusters read have readings of the strip as a whole only: a fit elsewhere would lack the others.
#[test]
fn a_run_with_readings_along_the_strip_is_left_to_the_campaign() {
    let folder = taken_in(1);
    let line = |(at, line): (usize, &str)| match at {
        0 => format!("{line},curvature_per_cm@2.0\n"),
        _ => format!("{line},0.1\n"),
    };
    let table = run_table(2);
    folder.write(
        "runs/along.csv",
        table.lines().enumerate().map(line).collect::<String>(),
    );
    folder.ieap(&["ingest"]).expect(0);
    folder
        .ieap(&["export", "--what", "traces", "--partitioned", "-o", "traces"])
        .expect(0);
    let path = folder.join("traces/material=CNaf/environment=air/part-0.parquet");
    let reader = SerializedFileReader::new(std::fs::File::open(path).unwrap()).unwrap();
    let reasons: Vec<Option<String>> = reader
        .get_row_iter(None)
        .unwrap()
        .map(|row| {
            let row = row.unwrap();
            let mut cells = row.get_column_iter();
            match cells.find(|(name, _)| *name == "reason") {
                Some((_, parquet::record::Field::Str(said))) => Some(said.clone()),
                _ => None,
            }
        })
        .collect();
    let left = |reason: &Option<String>| {
        reason
            .as_ref()
            .is_some_and(|said| said.contains("along the strip"))
    };
    assert!(reasons.contains(&None) && reasons.iter().any(left), "{reasons:?}");
}

#[test]
fn a_partitioned_export_has_one_row_a_run_in_the_folders_of_hive() {
    let folder = taken_in(2);
    folder.write(
        "runs/vacuum/tags.toml",
        "sample = \"S1\"\nenvironment = \"vacuum\"\n",
    );
    folder.write("runs/vacuum/3.csv", run_table(3));
    folder.ieap(&["ingest"]).expect(0);
    let exported = folder
        .ieap(&[
            "export",
            "--what",
            "traces",
            "--partitioned",
            "-o",
            "traces",
            "--json",
        ])
        .expect(0)
        .json();
    assert_eq!(exported["rows"], 3);
    let read = |path: &str| {
        let file = std::fs::File::open(folder.join(path)).unwrap();
        let reader = SerializedFileReader::new(file).unwrap();
        let said = reader
            .metadata()
            .file_metadata()
            .key_value_metadata()
            .cloned()
            .unwrap_or_default();
        assert!(
            said.iter()
                .any(|entry| entry.key == "ieap.campaign" && entry.value.as_deref() == Some("test"))
        );
        let rows: Vec<parquet::record::Row> =
            reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
        rows
    };
    let air = read("traces/material=CNaf/environment=air/part-0.parquet");
    let vacuum = read("traces/material=CNaf/environment=vacuum/part-0.parquet");
    assert_eq!((air.len(), vacuum.len()), (2, 1));
    let of = |row: &parquet::record::Row, name: &str| {
        let mut cells = row.get_column_iter();
        cells
            .find(|(found, _)| *found == name)
            .map(|(_, field)| field.clone())
            .expect(name)
    };
    let parquet::record::Field::ListInternal(readings) = of(&vacuum[0], "current_a_readings") else {
        panic!("{:?}", of(&vacuum[0], "current_a_readings"));
    };
    assert_eq!(readings.elements().len(), 320);
    let results = results(&folder, &FitChoice::default());
    let parquet::record::Field::Str(hash) = of(&vacuum[0], "input_hash") else {
        panic!("no hash");
    };
    assert!(
        results.iter().any(|row| row["input_hash"] == *hash),
        "the hash under which a result comes back"
    );
    let again = folder
        .ieap(&["export", "--what", "traces", "--partitioned", "-o", "traces"])
        .expect(2);
    assert!(again.stderr.contains("--overwrite"), "{again:?}");
    folder
        .ieap(&[
            "export",
            "--what",
            "traces",
            "--partitioned",
            "-o",
            "traces",
            "--overwrite",
        ])
        .expect(0);
    folder.write("traces/mine.txt", "work");
    folder
        .ieap(&[
            "export",
            "--what",
            "traces",
            "--partitioned",
            "-o",
            "traces",
            "--overwrite",
        ])
        .expect(4);
    assert!(folder.join("traces/mine.txt").exists());
}
