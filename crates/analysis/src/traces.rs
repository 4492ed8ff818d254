//! Readings for other programs: one row a reading, written run by run so that memory stays small.

use std::io::Write;
use std::path::Path;

use polars::prelude::{Column, DataFrame, IntoColumn, NamedFrom, PolarsError, Series};
use polars_io::SerWriter;

use super::disk_file::{Buffered, DiskFile, Told};
use super::export::csv_writer;
use super::parquet_file::{About, Cells, ParquetFile};
use super::{ExportError, TableFormat};
use ieap_domain::safe_text::csv_text;
use ieap_domain::{Channel, Quantity};
use ieap_show::{Frame, FrameCells, FrameColumn};

/// Rows of a group in Parquet: readers take a group at a time, and every group costs them some 500 bytes of the file's end.
const GROUP_ROWS: usize = 131_072;

/// Writes channels as rows of run, quantity, unit, time, value and whether the reading is left out of fits.
pub struct TraceWriter {
    sink: Sink,
    told: Told,
    rows: usize,
    /// Columns of the group that is being filled.
    pending: Vec<(String, Cells)>,
    pending_rows: usize,
}

enum Sink {
    Csv(Buffered, TableFormat),
    Parquet(Box<ParquetFile<Buffered>>),
}

impl TraceWriter {
    /// Makes the file.
    ///
    /// # Errors
    /// [`ExportError::Write`] where it cannot be made.
    pub fn create(path: &Path, format: TableFormat, about: &About) -> Result<TraceWriter, ExportError> {
        let (file, told) = DiskFile::create(path)?;
        let sink = match format {
            TableFormat::Parquet => {
                let begun = ParquetFile::begin(file, &columns("", None), about);
                Sink::Parquet(Box::new(begun.map_err(|source| told.why(source))?))
            }
            _ => Sink::Csv(file, format),
        };
        Ok(TraceWriter {
            sink,
            told,
            rows: 0,
            pending: columns("", None),
            pending_rows: 0,
        })
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
            let written = match &mut self.sink {
                Sink::Csv(file, format) => rows(&csv_text(run), channel).and_then(|mut rows| {
                    csv_writer(file, *format)
                        .include_header(self.rows == 0)
                        .finish(&mut rows)
                }),
                Sink::Parquet(_) => {
                    for ((_, own), (_, more)) in self.pending.iter_mut().zip(columns(run, Some(channel))) {
                        own.append(more);
                    }
                    self.pending_rows += channel.len();
                    Ok(())
                }
            };
            written.map_err(|source| self.told.why(source))?;
            self.rows += channel.len();
            if self.pending_rows >= GROUP_ROWS {
                self.write_group()?;
            }
        }
        Ok(())
    }

    /// Writes the group that was filled.
    fn write_group(&mut self) -> Result<(), ExportError> {
        let group = std::mem::replace(&mut self.pending, columns("", None));
        self.pending_rows = 0;
        match &mut self.sink {
            Sink::Parquet(file) => file.write(group).map_err(|source| self.told.why(source)),
            Sink::Csv(..) => Ok(()),
        }
    }

    /// Ends the file; gives the number of rows.
    ///
    /// # Errors
    /// [`ExportError`] where the file cannot be written.
    pub fn finish(mut self) -> Result<usize, ExportError> {
        self.write_group()?;
        match self.sink {
            Sink::Csv(mut file, _) => file.flush().map_err(|source| self.told.failed(source))?,
            Sink::Parquet(parquet) => {
                let mut file = parquet.finish().map_err(|source| self.told.why(source))?;
                file.flush().map_err(|source| self.told.failed(source))?;
            }
        }
        Ok(self.rows)
    }
}

/// The columns of a channel's rows; without a channel they have no rows.
fn columns(run: &str, channel: Option<&Channel>) -> Vec<(String, Cells)> {
    let n = channel.map_or(0, Channel::len);
    let quantity = channel.map_or(Quantity::Other, |channel| channel.quantity);
    let text = |text: &str| Cells::Texts(vec![Some(text.to_owned()); n]);
    let numbers = |of: fn(&Channel) -> &[f64]| {
        Cells::Numbers(channel.map_or(&[][..], of).iter().copied().map(Some).collect())
    };
    let is_excluded =
        |index: usize| channel.map(|channel| channel.excluded.binary_search(&(index as u32)).is_ok());
    let columns = [
        ("run", text(run)),
        ("quantity", text(quantity.key())),
        ("unit", text(quantity.unit())),
        ("time_s", numbers(|channel| &channel.time_s)),
        ("value", numbers(|channel| &channel.values)),
        ("excluded", Cells::Flags((0..n).map(is_excluded).collect())),
    ];
    columns.map(|(name, cells)| (name.to_owned(), cells)).into()
}

/// The columns without rows: readings are too many for a table in memory.
pub fn head() -> Frame {
    let column = |(name, cells): (String, Cells)| FrameColumn {
        name,
        quantity: String::new(),
        headed_unit: String::new(),
        cells: match cells {
            Cells::Numbers(_) => FrameCells::Numbers(Vec::new()),
            Cells::Flags(_) => FrameCells::Flags(Vec::new()),
            _ => FrameCells::Texts(Vec::new()),
        },
    };
    columns("", None).into_iter().map(column).collect()
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
