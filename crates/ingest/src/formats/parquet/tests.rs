//! Parquet files as polars writes them, whole, cut, changed and declared otherwise than they are.

use std::sync::Arc;

use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, DoubleType, FixedLenByteArray, FixedLenByteArrayType, Int64Type};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
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

/// Columns of one row group: their types and their cells.
enum Cells {
    Whole(Vec<i64>),
    Bytes(Vec<Vec<u8>>),
    Double(Vec<f64>),
}

fn plain(name: &str, physical: Physical) -> Type {
    let built = Type::primitive_type_builder(name, physical);
    built.with_repetition(Repetition::REQUIRED).build().unwrap()
}

/// A file that the format's own library writes, with Arrow's schema beside it.
fn by_its_own_library(columns: &[(Type, Cells)], arrow_schema: Option<&str>) -> Vec<u8> {
    let fields = columns.iter().map(|(own, _)| Arc::new(own.clone())).collect();
    let schema = Type::group_type_builder("m").with_fields(fields).build().unwrap();
    let said = arrow_schema.map(|text| vec![KeyValue::new("ARROW:schema".to_owned(), text.to_owned())]);
    let settings = WriterProperties::builder().set_key_value_metadata(said).build();
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, Arc::new(schema), Arc::new(settings)).unwrap();
    let mut group = writer.next_row_group().unwrap();
    for (_, cells) in columns {
        let mut column = group.next_column().unwrap().unwrap();
        let written = match cells {
            Cells::Whole(numbers) => column.typed::<Int64Type>().write_batch(numbers, None, None),
            Cells::Double(numbers) => column.typed::<DoubleType>().write_batch(numbers, None, None),
            Cells::Bytes(cells) => {
                let cells: Vec<FixedLenByteArray> = cells
                    .iter()
                    .map(|own| ByteArray::from(own.clone()).into())
                    .collect();
                column
                    .typed::<FixedLenByteArrayType>()
                    .write_batch(&cells, None, None)
            }
        };
        written.unwrap();
        column.close().unwrap();
    }
    group.close().unwrap();
    writer.close().unwrap();
    bytes
}

/// What pyarrow 26 and polars 1 write beside durations: Parquet itself has no word for them.
const OF_PYARROW: &str = "/////9gAAAAQAAAAAAAKAAwABgAFAAgACgAAAAABBAAMAAAACAAIAAAABAAIAAAABAAAAAMAAAB0AAAAOAAAAAQAAACo////AAABAxAAAAAcAAAABAAAAAAAAAAJAAAAY3VycmVudF9hAAAAnv///wAAAgDY////AAABEhAAAAAUAAAABAAAAAAAAAADAAAAbGFnAMb///8AAAAAEAAUAAgABgAHAAwAAAAQABAAAAAAAAESEAAAABwAAAAEAAAAAAAAAAQAAAB0aW1lAAAGAAgABgAGAAAAAAACAAAAAAA=";
const OF_POLARS: &str = "/////20AAAAEAAAA8v///xQAAAAEAAEAAAAKAAsACAAKAAQA+P///wwAAAAIAAgAAAAEAAEAAAAEAAAA7P///ywAAAAgAAAAGAAAAAESAAAQABIABAAQABEACAAAAAwAAAAAAPz///8EAAQABAAAAHQvbXMA";

#[test]
fn durations_are_seconds_whatever_their_unit_is() {
    for (arrow_schema, name, per_s) in [(OF_PYARROW, "time", 1_000_000), (OF_POLARS, "t/ms", 1_000)] {
        let whole = |name| plain(name, Physical::INT64);
        let current = plain("current_a", Physical::DOUBLE);
        let columns = [
            (whole(name), Cells::Whole(vec![0, per_s / 2, 90_000 * per_s])),
            (whole("lag"), Cells::Whole(vec![0, 1, 2])),
            (current, Cells::Double(vec![1.0, 2.0, 3.0])),
        ];
        let bytes = by_its_own_library(&columns, Some(arrow_schema));
        let reading = read("run.parquet", &bytes, &ReadContext::default()).unwrap();
        let channels = &reading.tables[0].channels;
        let current = channels
            .iter()
            .find(|channel| channel.quantity == Quantity::Current);
        assert_eq!(current.unwrap().time_s.to_vec(), [0.0, 0.5, 90_000.0], "{name}");
        // Without it nothing says what they are, and a time without a unit is refused.
        let bytes = by_its_own_library(&columns, None);
        let plain = read("run.parquet", &bytes, &ReadContext::default());
        match name {
            "time" => assert!(plain.is_err(), "{plain:?}"),
            _ => assert_eq!(plain.unwrap().tables[0].channels[0].time_s[1], 0.5),
        }
    }
}

#[test]
fn a_schema_of_arrow_that_cannot_be_read_is_told() {
    let columns = [
        (
            plain("time_s", Physical::DOUBLE),
            Cells::Double(vec![0.0, 1.0, 2.0]),
        ),
        (
            plain("current_a", Physical::DOUBLE),
            Cells::Double(vec![1.0, 2.0, 3.0]),
        ),
    ];
    for (said, is_told) in [
        (OF_PYARROW, false),
        ("no base64!", true),
        (&OF_POLARS[..40], true),
    ] {
        let bytes = by_its_own_library(&columns, Some(said));
        let reading = read("run.parquet", &bytes, &ReadContext::default()).unwrap();
        let told = reading
            .issues
            .iter()
            .any(|issue| issue.code == "arrow-schema-unread");
        assert_eq!(told, is_told, "{said}: {:?}", reading.issues);
    }
}

#[test]
fn numbers_of_fixed_point_and_of_two_bytes_keep_their_value() {
    let required =
        |name, physical| Type::primitive_type_builder(name, physical).with_repetition(Repetition::REQUIRED);
    let decimal = |name, physical, digits| {
        let built = required(name, physical).with_logical_type(Some(LogicalType::decimal(digits, 18)));
        built
            .with_precision(18)
            .with_scale(digits)
            .with_length(9)
            .build()
            .unwrap()
    };
    let half = required("curvature_per_cm", Physical::FIXED_LEN_BYTE_ARRAY);
    let half = half
        .with_length(2)
        .with_logical_type(Some(LogicalType::Float16))
        .build()
        .unwrap();
    let long = |number: i128| number.to_be_bytes()[7..].to_vec();
    let columns = [
        (
            plain("time_s", Physical::DOUBLE),
            Cells::Double(vec![0.0, 1.0, 2.0]),
        ),
        (
            decimal("voltage_v", Physical::INT64, 3),
            Cells::Whole(vec![125, -1_500, 1_000_000]),
        ),
        (
            decimal("current_a", Physical::FIXED_LEN_BYTE_ARRAY, 6),
            Cells::Bytes(vec![long(1_250), long(-3), long(7_000_000_000_000_000)]),
        ),
        (
            half,
            Cells::Bytes(vec![vec![0x00, 0x38], vec![0x00, 0xc0], vec![0x01, 0x00]]),
        ),
    ];
    let reading = read(
        "run.parquet",
        &by_its_own_library(&columns, None),
        &ReadContext::default(),
    )
    .unwrap();
    let values: Vec<_> = reading.tables[0]
        .channels
        .iter()
        .map(|own| own.values.to_vec())
        .collect();
    assert_eq!(
        values,
        [
            vec![0.125, -1.5, 1e3],
            vec![1.25e-3, -3e-6, 7e9],
            vec![0.5, -2.0, 2f64.powi(-24)]
        ]
    );
}
