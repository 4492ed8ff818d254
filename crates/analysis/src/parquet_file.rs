//! Parquet with types that other programs know: whole counts, moments in UTC, lists. Units stand with each column, the campaign
//! with the file.

use std::collections::BTreeMap;
use std::io::Write;
use std::sync::Arc;

use polars::prelude::{PlSmallStr, PolarsError};
use polars_arrow::array::{Array, BooleanArray, ListArray, PrimitiveArray, Utf8Array};
use polars_arrow::bitmap::Bitmap;
use polars_arrow::datatypes::{ArrowDataType, ArrowSchema, ArrowSchemaRef, Field, Metadata, TimeUnit};
use polars_arrow::offset::Offsets;
use polars_arrow::record_batch::RecordBatchT;
use polars_parquet::write::{
    CompressionOptions, Encoding, FileWriter, KeyValue, StatisticsOptions, Version, WriteOptions,
    get_dtype_encoding, row_group_iter, schema_to_metadata_key,
};

use ieap_domain::unit_of_key;
use ieap_show::{FrameCells, FrameColumn};

/// Columns of texts that are moments.
const MOMENTS: [&str; 2] = ["started_at", "ingested_at"];

/// What the cells of a column are.
#[derive(Debug, Clone, PartialEq)]
pub enum Cells {
    /// Words.
    Texts(Vec<Option<String>>),
    /// Numbers in the unit that the column's name ends in.
    Numbers(Vec<Option<f64>>),
    /// Whole numbers.
    Counts(Vec<Option<i64>>),
    /// Yes or no.
    Flags(Vec<Option<bool>>),
    /// Moments, microseconds since 1970 in UTC.
    Moments(Vec<Option<i64>>),
    /// Lists of numbers; a number may be missing in a list.
    Lists(Vec<Option<Vec<Option<f64>>>>),
}

/// What is said of a file as a whole: `ieap.campaign`, `ieap.table`, ...
pub type About = BTreeMap<String, String>;

impl Cells {
    /// Adds the cells of another part of the same column; of another kind nothing is added.
    pub fn append(&mut self, other: Cells) {
        match (self, other) {
            (Cells::Texts(own), Cells::Texts(other)) => own.extend(other),
            (Cells::Numbers(own), Cells::Numbers(other)) => own.extend(other),
            (Cells::Counts(own), Cells::Counts(other)) | (Cells::Moments(own), Cells::Moments(other)) => {
                own.extend(other);
            }
            (Cells::Flags(own), Cells::Flags(other)) => own.extend(other),
            (Cells::Lists(own), Cells::Lists(other)) => own.extend(other),
            _ => {}
        }
    }

    fn len(&self) -> usize {
        match self {
            Cells::Texts(cells) => cells.len(),
            Cells::Numbers(cells) => cells.len(),
            Cells::Counts(cells) | Cells::Moments(cells) => cells.len(),
            Cells::Flags(cells) => cells.len(),
            Cells::Lists(cells) => cells.len(),
        }
    }

    fn kind(&self) -> ArrowDataType {
        match self {
            Cells::Texts(_) => ArrowDataType::LargeUtf8,
            Cells::Numbers(_) => ArrowDataType::Float64,
            Cells::Counts(_) => ArrowDataType::Int64,
            Cells::Flags(_) => ArrowDataType::Boolean,
            Cells::Moments(_) => ArrowDataType::Timestamp(TimeUnit::Microsecond, Some("UTC".into())),
            Cells::Lists(_) => ListArray::<i64>::default_datatype(ArrowDataType::Float64),
        }
    }

    fn array(self) -> Box<dyn Array> {
        let kind = self.kind();
        match self {
            Cells::Texts(cells) => Utf8Array::<i64>::from(cells).boxed(),
            Cells::Numbers(cells) => PrimitiveArray::<f64>::from(cells).boxed(),
            Cells::Counts(cells) | Cells::Moments(cells) => {
                PrimitiveArray::<i64>::from(cells).to(kind).boxed()
            }
            Cells::Flags(cells) => BooleanArray::from(cells).boxed(),
            Cells::Lists(cells) => {
                let lengths = cells.iter().map(|list| list.as_ref().map_or(0, Vec::len));
                // A sum of lengths that are in memory cannot overflow.
                let offsets = Offsets::<i64>::try_from_lengths(lengths).unwrap_or_default();
                let is_there: Bitmap = cells.iter().map(Option::is_some).collect();
                let numbers: Vec<Option<f64>> = cells.into_iter().flatten().flatten().collect();
                let numbers = PrimitiveArray::<f64>::from(numbers).boxed();
                ListArray::<i64>::new(kind, offsets.into(), numbers, Some(is_there)).boxed()
            }
        }
    }
}

/// A file that is written in parts with the same columns.
pub struct ParquetFile<W: Write> {
    writer: FileWriter<W>,
    schema: ArrowSchemaRef,
    about: About,
}

impl<W: Write> ParquetFile<W> {
    /// Begins a file with these columns; of `columns` only names and kinds are looked at.
    ///
    /// # Errors
    /// The encoder refuses the columns: a fault of the program.
    pub fn begin(out: W, columns: &[(String, Cells)], about: &About) -> Result<ParquetFile<W>, PolarsError> {
        ParquetFile::begin_in_units(out, columns, about, |name| unit_of_key(name).map(str::to_owned))
    }

    fn begin_in_units(
        out: W,
        columns: &[(String, Cells)],
        about: &About,
        unit: impl Fn(&str) -> Option<String>,
    ) -> Result<ParquetFile<W>, PolarsError> {
        let fields = columns.iter().map(|(name, cells)| field(name, cells, unit(name)));
        let schema: ArrowSchema = fields.collect();
        Ok(ParquetFile {
            writer: FileWriter::try_new(out, schema.clone(), options())?,
            about: with_units(
                about,
                columns
                    .iter()
                    .filter_map(|(name, _)| Some((name.as_str(), unit(name)?))),
            ),
            schema: Arc::new(schema),
        })
    }

    /// Adds rows; the columns are those that the file began with.
    ///
    /// # Errors
    /// The disk refuses, or the columns are others.
    pub fn write(&mut self, columns: Vec<(String, Cells)>) -> Result<(), PolarsError> {
        let height = columns.first().map_or(0, |(_, cells)| cells.len());
        if height == 0 {
            return Ok(());
        }
        let arrays = columns.into_iter().map(|(_, cells)| cells.array()).collect();
        let batch = RecordBatchT::try_new(height, self.schema.clone(), arrays)?;
        let encodings: Vec<Vec<Encoding>> = self
            .schema
            .iter_values()
            .map(|field| get_dtype_encoding(&field.dtype))
            .collect();
        let fields = self.writer.parquet_schema().fields().to_vec();
        let group = row_group_iter(batch, encodings.into(), fields, options());
        self.writer.write(height as u64, group)
    }

    /// Ends the file.
    ///
    /// # Errors
    /// The disk refuses.
    pub fn finish(mut self) -> Result<W, PolarsError> {
        let mut said = vec![schema_to_metadata_key(&self.schema)];
        said.extend(self.about.into_iter().map(|(key, value)| KeyValue {
            key,
            value: Some(value),
        }));
        self.writer.end(Some(said))?;
        Ok(self.writer.into_inner())
    }
}

/// Writes a whole table.
///
/// # Errors
/// The disk refuses.
pub fn write<W: Write>(out: W, table: &[FrameColumn], about: &About) -> Result<W, PolarsError> {
    let columns: Vec<(String, Cells)> = table.iter().map(cells).collect();
    let unit = |name: &str| {
        table
            .iter()
            .find(|column| column.name == name)?
            .unit()
            .map(str::to_owned)
    };
    let mut file = ParquetFile::begin_in_units(out, &columns, about, unit)?;
    file.write(columns)?;
    file.finish()
}

/// The moment that a text in RFC 3339 tells, microseconds since 1970 in UTC.
pub fn moment_us(text: &str) -> Option<i64> {
    let moment: jiff::Timestamp = text.parse().ok()?;
    Some(moment.as_microsecond())
}

fn options() -> WriteOptions {
    WriteOptions {
        statistics: StatisticsOptions::default(),
        compression: CompressionOptions::Zstd(None),
        version: Version::V1,
        data_page_size: None,
    }
}

fn field(name: &str, cells: &Cells, unit: Option<String>) -> Field {
    let field = Field::new(name.into(), cells.kind(), true);
    match unit {
        None => field,
        Some(unit) => {
            let said: (PlSmallStr, PlSmallStr) = ("unit".into(), unit.into());
            field.with_metadata(Metadata::from([said]))
        }
    }
}

/// What is said of a file, with the units of its columns: some programs show this and not what stands with the columns.
fn with_units<'a>(about: &About, units: impl Iterator<Item = (&'a str, String)>) -> About {
    let units: BTreeMap<&str, String> = units.collect();
    let mut about = about.clone();
    about.insert("ieap.units".to_owned(), serde_json::json!(units).to_string());
    about
}

/// A column of a frame with its cells.
fn cells(column: &FrameColumn) -> (String, Cells) {
    let cells = match column.cells.clone() {
        FrameCells::Texts(texts) if MOMENTS.contains(&column.name.as_str()) => {
            Cells::Moments(texts.iter().map(|text| moment_us(text.as_ref()?)).collect())
        }
        FrameCells::Texts(cells) => Cells::Texts(cells),
        FrameCells::Flags(cells) => Cells::Flags(cells),
        FrameCells::Counts(cells) => Cells::Counts(cells),
        FrameCells::Numbers(cells) => Cells::Numbers(cells),
    };
    (column.name.clone(), cells)
}

#[cfg(test)]
mod tests {
    use super::*;
    use parquet::basic::{LogicalType, TimeUnit as Unit, Type};
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field as Read;

    fn columns() -> Vec<(String, Cells)> {
        vec![
            ("run".to_owned(), Cells::Texts(vec![Some("a".to_owned()), None])),
            ("voltage_v".to_owned(), Cells::Numbers(vec![Some(2.5), None])),
            ("warnings".to_owned(), Cells::Counts(vec![Some(3), None])),
            ("converged".to_owned(), Cells::Flags(vec![Some(true), None])),
            (
                "started_at".to_owned(),
                Cells::Moments(vec![moment_us("2026-11-20T08:00:00.5+02:00"), None]),
            ),
            (
                "drive_v".to_owned(),
                Cells::Lists(vec![Some(vec![Some(2.0), None]), None]),
            ),
        ]
    }

    fn reader() -> SerializedFileReader<bytes::Bytes> {
        let about = About::from([("ieap.campaign".to_owned(), "humidity".to_owned())]);
        let mut file = ParquetFile::begin(Vec::new(), &columns(), &about).unwrap();
        file.write(columns()).unwrap();
        file.write(columns()).unwrap();
        SerializedFileReader::new(bytes::Bytes::from(file.finish().unwrap())).unwrap()
    }

    #[test]
    fn another_library_reads_types_and_values() {
        let reader = reader();
        let schema = reader.metadata().file_metadata().schema_descr_ptr();
        let moment = schema.column(4);
        assert_eq!(schema.column(2).physical_type(), Type::INT64);
        assert_eq!(
            moment.logical_type_ref(),
            Some(&LogicalType::timestamp(true, Unit::MICROS)),
            "UTC"
        );
        let rows: Vec<_> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
        assert_eq!(rows.len(), 4);
        let of = |row: usize| -> Vec<Read> {
            rows[row]
                .get_column_iter()
                .map(|(_, field)| field.clone())
                .collect()
        };
        assert_eq!(
            of(0)[..5],
            [
                Read::Str("a".to_owned()),
                Read::Double(2.5),
                Read::Long(3),
                Read::Bool(true),
                Read::TimestampMicros(1_795_154_400_500_000),
            ]
        );
        assert_eq!(of(0)[5].to_string(), "[2.0, null]");
        assert!(of(1).iter().all(|field| *field == Read::Null));
    }

    #[test]
    fn the_file_says_campaign_and_units() {
        let reader = reader();
        let said = reader.metadata().file_metadata().key_value_metadata().unwrap();
        let of = |key: &str| {
            said.iter()
                .find(|entry| entry.key == key)
                .and_then(|entry| entry.value.clone())
        };
        assert_eq!(of("ieap.campaign").as_deref(), Some("humidity"));
        assert_eq!(
            of("ieap.units").as_deref(),
            Some(r#"{"drive_v":"V","voltage_v":"V"}"#)
        );
        assert!(
            of("ARROW:schema").is_some(),
            "units of columns, as Arrow stores them"
        );
    }
}
