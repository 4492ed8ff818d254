//! Readings for other programs: one row a reading, written run by run so that memory stays small.

use std::io::Write;
use std::path::Path;

use polars::prelude::{
    Column, DataFrame, DataType, Field, IntoColumn, NamedFrom, PolarsError, Schema, Series,
};
use polars_io::SerWriter;
use polars_io::csv::write::CsvWriter;
use polars_io::parquet::write::{BatchedWriter, ParquetWriter};

use super::disk_file::{Buffered, DiskFile, Told};
use super::{ExportError, TableFormat};
use ieap_domain::safe_text::csv_text;
use ieap_domain::{Channel, Quantity};

/// Writes channels as rows of run, quantity, unit, time, value and whether the reading is left out of fits.
pub struct TraceWriter {
    sink: Sink,
    told: Told,
    rows: usize,
}

enum Sink {
    Csv(Buffered),
    Parquet(Box<BatchedWriter<Buffered>>),
}

impl TraceWriter {
    /// Makes the file.
    ///
    /// # Errors
    /// [`ExportError::Write`] where it cannot be made.
    pub fn create(path: &Path, format: TableFormat) -> Result<TraceWriter, ExportError> {
        let (file, told) = DiskFile::create(path)?;
        let sink = match format {
            TableFormat::Parquet => {
                let batched = ParquetWriter::new(file).batched(&schema());
                Sink::Parquet(Box::new(batched.map_err(|source| told.why(source))?))
            }
            _ => Sink::Csv(file),
        };
        Ok(TraceWriter { sink, told, rows: 0 })
    }

    /// Adds the channels of a run; columns that are not interpreted are left out.
    ///
    /// # Errors
    /// [`ExportError`] where the file cannot be written.
    pub fn write(&mut self, run: &str, channels: &[Channel]) -> Result<(), ExportError> {
        for channel in channels
            .iter()
            .filter(|c| c.quantity != Quantity::Other && !c.is_empty())
        {
            let name = match self.sink {
                Sink::Csv(_) => csv_text(run),
                Sink::Parquet(_) => run.into(),
            };
            let mut rows = rows(&name, channel).map_err(|source| self.told.why(source))?;
            let written = match &mut self.sink {
                Sink::Csv(file) => CsvWriter::new(file)
                    .include_header(self.rows == 0)
                    .finish(&mut rows),
                Sink::Parquet(batched) => batched.write_batch(&rows),
            };
            written.map_err(|source| self.told.why(source))?;
            self.rows += rows.height();
        }
        Ok(())
    }

    /// Ends the file; gives the number of rows.
    ///
    /// # Errors
    /// [`ExportError`] where the file cannot be written.
    pub fn finish(self) -> Result<usize, ExportError> {
        match self.sink {
            Sink::Csv(mut file) => file.flush().map_err(|source| self.told.failed(source))?,
            Sink::Parquet(batched) => {
                batched.finish().map_err(|source| self.told.why(source))?;
            }
        }
        Ok(self.rows)
    }
}

fn schema() -> Schema {
    let field = |name: &str, kind: DataType| Field::new(name.into(), kind);
    Schema::from_iter([
        field("run", DataType::String),
        field("quantity", DataType::String),
        field("unit", DataType::String),
        field("time_s", DataType::Float64),
        field("value", DataType::Float64),
        field("excluded", DataType::Boolean),
    ])
}

fn rows(run: &str, channel: &Channel) -> Result<DataFrame, PolarsError> {
    let n = channel.len();
    let text = |name: &str, text: &str| Series::new(name.into(), vec![text; n]).into_column();
    let numbers = |name: &str, values: &[f64]| Series::new(name.into(), values).into_column();
    let is_excluded = |index: usize| channel.excluded.binary_search(&(index as u32)).is_ok();
    let excluded: Vec<bool> = (0..n).map(is_excluded).collect();
    let columns: Vec<Column> = vec![
        text("run", run),
        text("quantity", channel.quantity.key()),
        text("unit", channel.quantity.unit()),
        numbers("time_s", &channel.time_s),
        numbers("value", &channel.values),
        Series::new("excluded".into(), excluded).into_column(),
    ];
    DataFrame::new(n, columns)
}
