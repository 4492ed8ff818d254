//! Parquet files as polars writes them, whole, cut, changed and declared otherwise than they are.

use polars::prelude::{Column, DataFrame, NamedFrom, Series};
use polars_io::parquet::write::{ParquetCompression, ParquetWriter};

use super::*;
use crate::formats::read;
use ieap_domain::Quantity;

fn written(columns: Vec<Series>) -> Vec<u8> {
    let columns: Vec<Column> = columns.into_iter().map(Into::into).collect();
    let height = columns[0].len();
    let mut frame = DataFrame::new(height, columns).unwrap();
    let mut bytes = Vec::new();
    ParquetWriter::new(&mut bytes).finish(&mut frame).unwrap();
    bytes
}

fn run() -> Vec<u8> {
    written(vec![
        Series::new("Time [s]".into(), [0.0, 0.5, 1.0]),
        Series::new("Current [mA]".into(), [Some(1.5), None, Some(0.5)]),
        Series::new("cycle".into(), [1i64, 1, 2]),
        Series::new("note".into(), ["a", "b", "c"]),
    ])
}

#[test]
fn columns_are_read_by_their_names() {
    let reading = read("run.parquet", &run(), &ReadContext::default()).unwrap();
    let table = &reading.tables[0];
    assert_eq!((reading.format, table.rows), ("parquet", 3));
    let current = &table.channels[0];
    assert_eq!(
        (current.quantity, &current.values[..]),
        (Quantity::Current, &[1.5e-3, 5e-4][..])
    );
    assert_eq!(&current.time_s[..], [0.0, 1.0]);
    assert_eq!(
        (table.channels.len(), table.channels[1].raw_name.as_str()),
        (2, "cycle")
    );
    assert!(reading.issues.iter().any(|issue| issue.code == "text-column"));
}

#[test]
fn a_cut_at_any_byte_is_refused() {
    let bytes = run();
    for end in 1..bytes.len() {
        let cut = read("run.parquet", &bytes[..end], &ReadContext::default());
        assert!(cut.is_err(), "cut at {end} of {} was read", bytes.len());
    }
}

#[test]
fn a_table_without_a_time_is_refused_with_its_columns() {
    let bytes = written(vec![Series::new("Current [mA]".into(), [1.0, 2.0])]);
    let error = read("run.parquet", &bytes, &ReadContext::default()).unwrap_err();
    assert!(error.to_string().contains("Current [mA]"), "{error}");
}

#[test]
fn every_kind_of_number_keeps_its_value_and_empty_cells_stay_empty() {
    let bytes = written(vec![
        Series::new("time_s".into(), [0.0f32, 0.5, 1.0]),
        Series::new("current_a".into(), [Some(-1.5f64), None, Some(f64::NAN)]),
        Series::new("raw".into(), [u32::MAX, 0, 7]),
        Series::new("count".into(), [-5i32, 0, i32::MAX]),
        Series::new("long".into(), [u64::MAX, 0, 1]),
        Series::new("on".into(), [Some(true), Some(false), None]),
    ]);
    let reading = read("run.parquet", &bytes, &ReadContext::default()).unwrap();
    let values = |name: &str| {
        let of_name = |channel: &&ieap_domain::Channel| channel.raw_name.as_str() == name;
        let channel = reading.tables[0].channels.iter().find(of_name).unwrap();
        channel.values.to_vec()
    };
    assert_eq!(values("current_a"), [-1.5]);
    assert_eq!(values("raw"), [f64::from(u32::MAX), 0.0, 7.0]);
    assert_eq!(values("count"), [-5.0, 0.0, f64::from(i32::MAX)]);
    assert_eq!(values("long"), [u64::MAX as f64, 0.0, 1.0]);
    assert_eq!(values("on"), [1.0, 0.0]);
}

#[test]
fn many_rows_in_several_groups_and_pages_are_all_there() {
    let rows = 20_000;
    let time: Vec<f64> = (0..rows).map(|row| f64::from(row) * 0.01).collect();
    let current: Vec<f64> = (0..rows).map(|row| f64::from(row % 7) * 1e-3).collect();
    let columns = vec![
        Column::from(Series::new("time_s".into(), time.clone())),
        Column::from(Series::new("current_a".into(), current.clone())),
    ];
    let mut frame = DataFrame::new(rows as usize, columns).unwrap();
    for compression in [
        ParquetCompression::Uncompressed,
        ParquetCompression::Snappy,
        ParquetCompression::Gzip(None),
        ParquetCompression::Lz4Raw,
        ParquetCompression::Zstd(None),
    ] {
        let mut bytes = Vec::new();
        ParquetWriter::new(&mut bytes)
            .with_compression(compression)
            .with_row_group_size(Some(6_000))
            .with_data_page_size(Some(4_096))
            .finish(&mut frame)
            .unwrap();
        let reading = read("run.parquet", &bytes, &ReadContext::default()).unwrap();
        let channel = &reading.tables[0].channels[0];
        assert_eq!(channel.time_s.to_vec(), time, "{compression:?}");
        assert_eq!(channel.values.to_vec(), current, "{compression:?}");
    }
}

#[test]
fn a_page_that_declares_more_than_the_table_of_contents_is_refused_before_it_is_unpacked() {
    let times: Vec<f64> = (0..100).map(f64::from).collect();
    let bytes = written(vec![Series::new("time_s".into(), times)]);
    // The head of the first page: field 1 (its kind), field 2 (bytes unpacked) and field 3 (bytes packed).
    let head = &bytes[4..];
    assert_eq!(
        (head[0], head[1], head[2]),
        (0x15, 0, 0x15),
        "the head looks otherwise now"
    );
    assert!(
        head[3] & 0x80 != 0 && head[4] & 0x80 == 0,
        "its second number has another length now"
    );
    let mut worse = bytes.clone();
    (worse[4 + 3], worse[4 + 4]) = (0xfe, 0x7f);
    let error = read("run.parquet", &worse, &ReadContext::default()).unwrap_err();
    let text = error.to_string();
    assert!(text.contains("bytes unpacked, the table of contents"), "{text}");
}

#[test]
fn what_is_compressed_with_brotli_is_not_called_damaged() {
    let mut frame = DataFrame::new(1, vec![Series::new("time_s".into(), [0.0]).into()]).unwrap();
    let mut bytes = Vec::new();
    ParquetWriter::new(&mut bytes)
        .with_compression(ParquetCompression::Brotli(None))
        .finish(&mut frame)
        .unwrap();
    let error = read("run.parquet", &bytes, &ReadContext::default()).unwrap_err();
    assert!(error.to_string().contains("compressed with Brotli"), "{error}");
    assert!(error.mend().contains("Snappy"));
}
