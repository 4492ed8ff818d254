//! Parquet as a run table: columns by name as in the plain table, units in the names.
//!
//! This file is a door of its own for polars, which is in the build for the export of tables: a second Parquet library
//! would cost build time and read the same bytes in another way. Nothing of polars leaves this file.

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

use polars::prelude::{ArrowDataType, Column, DataFrame, DataType, PolarsResult};
use polars_io::SerReader;
use polars_io::parquet::read::{ParallelStrategy, ParquetReader};

use super::assemble::{Raw, assemble};
use super::cells::CellTable;
use super::error::{ReadError, escaped, quoted};
use super::recognition::{FileHead, Match};
use super::{Format, ReadContext, plain_table};
use crate::domain::{Issue, RunStatus};
use crate::ingest::Reading;
use crate::ingest::text::Cell;
use crate::ingest::text::header::Header;

/// Reader of Parquet files.
pub struct Parquet;

/// What a Parquet file begins and ends with.
const MAGIC: &[u8] = b"PAR1";
/// Most cells that are read.
const MAX_CELLS: u64 = 50_000_000;

impl Format for Parquet {
    fn id(&self) -> &'static str {
        "parquet"
    }

    fn title(&self) -> &'static str {
        "Parquet with the columns of a run table, such as time_s or Current [mA] (.parquet)"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["parquet", "pq"]
    }

    fn version(&self) -> u32 {
        1
    }

    fn is_generic(&self) -> bool {
        true
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        match head.bytes.starts_with(MAGIC) {
            true => Match::Certain("the file begins with PAR1"),
            false => Match::No,
        }
    }

    fn read(&self, bytes: &[u8], context: &ReadContext) -> Result<Reading, ReadError> {
        if bytes.is_empty() {
            return Err(ReadError::Empty);
        }
        // The table of contents stands at the end, and so does the mark of a whole file.
        if bytes.len() < 12 || !bytes.ends_with(MAGIC) {
            return Err(ReadError::Structure {
                offset: bytes.len() as u64,
                found: "the file ends without PAR1".to_owned(),
                needed: "a whole Parquet file: its table of contents stands at the end",
            });
        }
        let mut issues = Vec::new();
        let frame = frame(bytes, context.max_unpacked_bytes, &mut issues)?;
        let (headers, cells) = table(&frame)?;
        let raw = Raw {
            time_zero_is_step: true,
            must_be_run: true,
            must_respond: context.needs_response,
            ..Raw::of_instrument(String::new(), headers, cells)
        };
        let table = assemble(raw, &mut issues)?;
        Ok(Reading {
            format: self.id(),
            reader_version: self.version(),
            technique: None,
            is_step_response: true,
            encoding: None,
            status: RunStatus::Complete,
            status_evidence: format!("the table of contents declares {} rows, all found", table.rows),
            started_at: None,
            header_tags: Vec::new(),
            tables: vec![table],
            original_metadata: Vec::new(),
            issues,
        })
    }
}

/// The columns that hold numbers or texts; others are named in an issue.
fn frame(bytes: &[u8], max_bytes: u64, issues: &mut Vec<Issue>) -> Result<DataFrame, ReadError> {
    // The library indexes into damaged records here and there; such a file is refused and stops no other one.
    let attempt = catch_unwind(AssertUnwindSafe(|| read_columns(bytes, max_bytes, issues)));
    attempt.unwrap_or_else(|_| Err(broken("its records contradict each other")))
}

fn read_columns(bytes: &[u8], max_bytes: u64, issues: &mut Vec<Issue>) -> Result<DataFrame, ReadError> {
    let mut reader = ParquetReader::new(Cursor::new(bytes));
    let failed = |error: polars::prelude::PolarsError| broken(&error.to_string());
    let metadata = reader.get_metadata().map_err(failed)?.clone();
    let unpacked: u64 = metadata
        .row_groups
        .iter()
        .map(|group| group.total_byte_size() as u64)
        .fold(0, u64::saturating_add);
    let too_large = |what: &str, found: u64, limit: u64| ReadError::TooLarge {
        what: what.to_owned(),
        found,
        limit,
    };
    if unpacked > max_bytes {
        return Err(too_large("the Parquet file unpacked", unpacked, max_bytes));
    }
    let schema = reader.schema().map_err(failed)?;
    let cells = (metadata.num_rows as u64).saturating_mul(schema.len() as u64);
    if cells > MAX_CELLS {
        return Err(too_large(
            "the Parquet file (rows times columns)",
            cells,
            MAX_CELLS,
        ));
    }
    let (readable, others): (Vec<_>, Vec<_>) =
        schema.iter_values().partition(|field| is_readable(field.dtype()));
    for field in others {
        let message = format!(
            "column {} holds {}, which is neither number nor text; it is left out",
            quoted(&field.name),
            quoted(&format!("{:?}", field.dtype()))
        );
        issues.push(Issue::note("text-column", message));
    }
    let names: Vec<String> = readable.iter().map(|field| field.name.to_string()).collect();
    reader
        .read_parallel(ParallelStrategy::None)
        .with_columns(Some(names))
        .finish()
        .map_err(failed)
}

fn is_readable(kind: &ArrowDataType) -> bool {
    use ArrowDataType as T;
    matches!(
        kind,
        T::Boolean
            | T::Int32
            | T::Int64
            | T::UInt32
            | T::UInt64
            | T::Float32
            | T::Float64
            | T::Utf8
            | T::LargeUtf8
            | T::Utf8View
    )
}

/// Headers and cells of the columns of numbers; texts are kept where flags may stand.
fn table(frame: &DataFrame) -> Result<(Vec<Header>, CellTable), ReadError> {
    let headers: Vec<Header> = frame.columns().iter().map(|c| Header::parse(c.name())).collect();
    let keep_text: Vec<bool> = headers.iter().map(plain_table::is_flag).collect();
    let rows = frame.height();
    let mut cells = CellTable::new(0, &keep_text, rows);
    for (column, found) in cells.columns.iter_mut().zip(frame.columns()) {
        let failed = |error: polars::prelude::PolarsError| broken(&error.to_string());
        fill(column, found).map_err(failed)?;
        if column.numbers.len() != rows {
            return Err(broken("its columns differ in length"));
        }
    }
    cells.line_of_row = (1..=rows as u32).collect();
    Ok((headers, cells))
}

fn fill(column: &mut super::cells::CellColumn, found: &Column) -> PolarsResult<()> {
    if found.dtype() == &DataType::String {
        for (row, text) in found.str()?.iter().enumerate() {
            let text = text.unwrap_or("");
            let cell = match text.trim().is_empty() {
                true => Cell::Empty,
                false => Cell::Text,
            };
            column.push(row + 1, cell, || text.to_owned());
        }
        return Ok(());
    }
    let numbers = found.cast(&DataType::Float64)?;
    for (row, number) in numbers.f64()?.iter().enumerate() {
        let cell = match number {
            None => Cell::Empty,
            Some(number) if number.is_finite() => Cell::Number(number),
            Some(_) => Cell::NotFinite,
        };
        column.push(row + 1, cell, || {
            number.map_or(String::new(), |number| number.to_string())
        });
    }
    Ok(())
}

fn broken(found: &str) -> ReadError {
    ReadError::BrokenContainer {
        kind: "Parquet file",
        found: escaped(found),
    }
}

#[cfg(test)]
mod tests {
    use polars::prelude::NamedFrom;
    use polars::prelude::Series;
    use polars_io::parquet::write::ParquetWriter;

    use super::*;
    use crate::domain::Quantity;
    use crate::ingest::formats::read;

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
}
