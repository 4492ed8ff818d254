//! Fits made elsewhere: in parts, on other computers, and brought back.

use ieap::pipeline::fits::result::{End, FitResult};
use parquet::file::reader::{FileReader, SerializedFileReader};
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

/// The lines of the results of all parts.
fn results(folder: &CampaignFolder, parts: u32) -> Vec<String> {
    let mut lines = Vec::new();
    for part in 1..=parts {
        folder
            .ieap(&["fit", "--shard", &format!("{part}/{parts}")])
            .expect(0);
        let text = std::fs::read_to_string(folder.join(&format!("fits-{part}-of-{parts}.jsonl"))).unwrap();
        let is_result = |line: &&str| !line.contains("fit-results-end");
        lines.extend(text.lines().filter(is_result).map(str::to_owned));
    }
    lines
}

/// A row with a checksum of its own, as if it had been written so.
fn sealed(row: &Value) -> String {
    let mut result: FitResult = serde_json::from_value(row.clone()).unwrap();
    result.checksum = result.sum();
    serde_json::to_string(&result).unwrap()
}

/// A part of these rows, with its end.
fn part(rows: &[String]) -> String {
    let text: String = rows.iter().map(|row| format!("{row}\n")).collect();
    let mut sum = blake3::Hasher::new();
    sum.update(text.as_bytes());
    text + &serde_json::to_string(&End::of(rows.len(), &sum)).unwrap() + "\n"
}

#[test]
fn parts_joined_are_what_one_program_would_have_stored() {
    let (whole, parted) = (taken_in(5), taken_in(5));
    whole.ieap(&["fit"]).expect(0);
    let before = std::fs::read(parted.join("campaign.db")).unwrap();
    assert_eq!(results(&parted, 3).len(), 5);
    assert_eq!(
        std::fs::read(parted.join("campaign.db")).unwrap(),
        before,
        "a part writes nothing into the campaign"
    );
    let files = ["fits-1-of-3.jsonl", "fits-2-of-3.jsonl", "fits-3-of-3.jsonl"];
    let imported = parted
        .ieap(&[&["import-fits", "--json"], &files[..]].concat())
        .expect(0)
        .json();
    assert_eq!(imported["imported"]["imported"], 5);
    assert_eq!(content_hash(&parted), content_hash(&whole), "to the bit");
    let again = parted
        .ieap(&["import-fits", "fits-1-of-3.jsonl", "--json"])
        .expect(0)
        .json();
    assert_eq!(again["imported"]["imported"], 0);
    let left = parted.ieap(&["fit"]).expect(0);
    assert!(left.stderr.contains("0 fitted, 5 up to date"), "{left:?}");
    let none = parted.ieap(&["fit", "--shard", "1/1", "--json"]).expect(0).json();
    assert_eq!(
        (&none["shard"]["fitted"], &none["shard"]["up_to_date"]),
        (&0.into(), &5.into())
    );
}

#[test]
fn a_choice_that_was_asked_for_travels_with_the_results() {
    let folder = taken_in(1);
    folder
        .ieap(&["fit", "--shard", "1/1", "--model", "lumped-1"])
        .expect(0);
    folder.ieap(&["import-fits", "fits-1-of-1.jsonl"]).expect(0);
    let fits = folder.ieap(&["fit", "--json"]).expect(0);
    assert!(fits.stderr.contains("model lumped-1"), "kept as asked: {fits:?}");
    assert_eq!(fits.json()["fits"][0]["model"], "lumped-1");
}

#[test]
fn a_row_that_cannot_be_used_stops_no_other_and_is_told() {
    let folder = taken_in(4);
    let lines = results(&folder, 1);
    let changed = |line: &str, key: &str, value: Value| {
        let mut object: Value = serde_json::from_str(line).unwrap();
        object[key] = value;
        sealed(&object)
    };
    let mut other_model: Value = serde_json::from_str(&lines[3]).unwrap();
    other_model["fit"]["parameters"][0]["key"] = "beauty".into();
    let rows = [
        lines[0].clone(),
        lines[1][..lines[1].len() / 2].to_owned(),
        changed(&lines[1], "data_hash", "0".into()),
        changed(&lines[1], "input_hash", "0".into()),
        changed(&lines[1], "run", "runs/nowhere.csv".into()),
        changed(&lines[1], "fit", Value::Null),
        changed(&lines[1], "schema", "ieap/fit-result/9".into()),
        sealed(&other_model),
        lines[2].clone(),
    ];
    folder.write("results/part.jsonl", part(&rows));
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
    folder.ieap(&["import-fits", "nothing.jsonl"]).expect(4);
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

/// Bits all over a part, one at a time: what came of another number is never stored.
#[test]
fn a_part_that_was_damaged_on_its_way_brings_no_other_number() {
    let folder = taken_in(2);
    let whole = part(&results(&folder, 1)).into_bytes();
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
        folder.write("part.jsonl", &flipped);
        let ended = folder.ieap(&["import-fits", "part.jsonl", "--json"]).expect(3);
        assert!(ended.json()["imported"]["imported"].as_u64().unwrap() <= 2);
        folder.ieap(&["fit"]).expect(0);
        assert_eq!(fits(&folder), sound, "byte {at}");
    }
}

#[test]
fn numbers_that_no_fit_of_the_run_has_are_found_by_fitting_it_again() {
    let folder = taken_in(4);
    let lines = results(&folder, 1);
    for factor in [1.1, 1e308] {
        let folder = copied(&folder);
        let mut rows = lines.clone();
        let mut wrong: Value = serde_json::from_str(&rows[2]).unwrap();
        for name in ["value", "standard_error", "low_95", "high_95"] {
            let number = &mut wrong["fit"]["parameters"][0]["estimate"][name];
            *number = (number.as_f64().unwrap() * factor).min(f64::MAX).into();
        }
        rows[2] = sealed(&wrong);
        folder.write("part.jsonl", part(&rows));
        let ended = folder.ieap(&["import-fits", "part.jsonl", "--json"]).expect(3);
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
fn parts_of_an_earlier_version_and_cut_ones_are_told_with_the_mend() {
    let folder = taken_in(2);
    let lines = results(&folder, 1);
    let old = lines.iter().map(|line| {
        let mut row: Value = serde_json::from_str(line).unwrap();
        row.as_object_mut().unwrap().remove("checksum");
        row.to_string()
    });
    folder.write("old.jsonl", old.collect::<Vec<String>>().join("\n"));
    let ended = folder.ieap(&["import-fits", "old.jsonl", "--json"]).expect(3);
    let imported = ended.json()["imported"].clone();
    assert_eq!(imported["imported"], 0);
    let reason = imported["refused"][0]["reason"].as_str().unwrap();
    assert!(reason.contains("an earlier version"), "{imported}");
    // Cut at the end of a line: what is there is sound, and that something is lost is said.
    folder.write("cut.jsonl", format!("{}\n", lines[0]));
    let ended = folder.ieap(&["import-fits", "cut.jsonl", "--json"]).expect(3);
    let imported = ended.json()["imported"].clone();
    assert_eq!(imported["imported"], 1);
    let reason = imported["damaged_files"][0]["reason"].as_str().unwrap();
    assert!(
        reason.contains("its end is missing") && reason.contains("ieap fit --shard"),
        "{imported}"
    );
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
    let ended = folder.ieap(&["fit", "--shard", "1/1", "--json"]).expect(0);
    assert_eq!(ended.json()["shard"]["failed"][0][0], "runs/short.csv");
    let imported = folder
        .ieap(&["import-fits", "fits-1-of-1.jsonl", "--json"])
        .expect(0)
        .json();
    assert_eq!(imported["imported"]["failed"][0][0], "runs/short.csv");
    let fits = folder.ieap(&["fit", "--json"]).expect(0).json();
    assert_eq!(fits["not_fitted"][0]["run"], "runs/short.csv");
    assert_eq!(fits["fits"].as_array().unwrap().len(), 1);
}

/// What a data frame on a cluster writes: text columns, the fit as JSON in one of them.
#[test]
fn results_come_back_from_parquet() {
    use polars::prelude::{Column, DataFrame, NamedFrom, Series};
    let folder = taken_in(2);
    let lines: Vec<Value> = results(&folder, 1)
        .iter()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    let column = |name: &str| {
        let texts: Vec<String> = lines
            .iter()
            .map(|line| match &line[name] {
                Value::String(text) => text.clone(),
                other => other.to_string(),
            })
            .collect();
        Column::from(Series::new(name.into(), texts))
    };
    let columns = [
        "run",
        "data_hash",
        "input_hash",
        "code_version",
        "fit",
        "checksum",
    ]
    .map(column);
    let mut table = DataFrame::new(2, columns.to_vec()).unwrap();
    let mut bytes = Vec::new();
    polars_io::parquet::write::ParquetWriter::new(&mut bytes)
        .finish(&mut table)
        .unwrap();
    folder.write("from-spark/part-0.parquet", bytes);
    folder.write("from-spark/_SUCCESS", "");
    let imported = folder
        .ieap(&["import-fits", "from-spark", "--json"])
        .expect(0)
        .json();
    assert_eq!(imported["imported"]["imported"], 2);
    let direct = taken_in(2);
    direct.ieap(&["fit"]).expect(0);
    assert_eq!(
        content_hash(&folder),
        content_hash(&direct),
        "numbers come back to the bit"
    );
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
    let results = results(&folder, 1);
    let hashes: Vec<String> = results
        .iter()
        .map(|line| {
            serde_json::from_str::<Value>(line).unwrap()["input_hash"]
                .as_str()
                .unwrap()
                .to_owned()
        })
        .collect();
    let parquet::record::Field::Str(hash) = of(&vacuum[0], "input_hash") else {
        panic!("no hash");
    };
    assert!(hashes.contains(&hash), "the hash under which a result comes back");
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
