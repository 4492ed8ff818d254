//! Writes tables for other programs. A missing number is an empty cell (CSV) or null, never a zero.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use polars::prelude::{DataFrame, IntoColumn, NamedFrom, PolarsError, Series};
use polars_io::SerWriter;
use polars_io::csv::write::CsvWriter;

use super::disk_file::DiskFile;
use super::parquet_file::{self, About};
use ieap_domain::number::to_digits;
use ieap_domain::safe_text::csv_text;
use ieap_show::{FrameCells, FrameColumn};

/// File format of an exported table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableFormat {
    /// Comma-separated, UTF-8, one header line.
    Csv,
    /// The same with decimal commas, and semicolons between fields.
    CsvWithDecimalComma,
    /// Apache Parquet.
    Parquet,
    /// One JSON array with an object a row.
    Json,
}

/// Why a table could not be made or written.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The file could not be written.
    #[error("cannot write {path}: {source}; check that the folder exists, may be written and has room")]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// The table could not be built or encoded.
    #[error("cannot build or encode table {table}: {source}")]
    Table {
        /// Which table.
        table: String,
        /// What polars says.
        source: PolarsError,
    },
}

/// Rounds every number to six digits, standard errors to three: for tables that people read. The export keeps all.
pub fn rounded(table: Vec<FrameColumn>) -> Vec<FrameColumn> {
    let round = |mut column: FrameColumn| {
        let is_error = column.name.ends_with("_standard_error");
        let digits = if is_error { 3 } else { 6 };
        if let FrameCells::Numbers(cells) = &mut column.cells {
            for number in cells.iter_mut().flatten() {
                *number = to_digits(*number, digits);
            }
        }
        column
    };
    table.into_iter().map(round).collect()
}

/// Writes `table` to `path`; Parquet also holds what is said about it. The bytes depend on these only.
///
/// # Errors
/// [`ExportError::Write`] where the file cannot be written, [`ExportError::Table`] where it cannot be encoded.
pub fn write_table(
    table: &[FrameColumn],
    format: TableFormat,
    about: &About,
    path: &Path,
) -> Result<(), ExportError> {
    let (mut file, told) = DiskFile::create(path)?;
    let written = match format {
        TableFormat::Csv | TableFormat::CsvWithDecimalComma => {
            for_spreadsheets(table).and_then(|mut table| csv_writer(&mut file, format).finish(&mut table))
        }
        TableFormat::Parquet => parquet_file::write(&mut file, table, about).map(|_| ()),
        TableFormat::Json => super::json_rows::write(table, &mut file).map_err(PolarsError::from),
    };
    written.map_err(|source| told.why(source))?;
    file.flush().map_err(|source| told.failed(source))
}

/// A writer of CSV in that notation.
pub(super) fn csv_writer<W: Write>(file: W, format: TableFormat) -> CsvWriter<W> {
    let writer = CsvWriter::new(file);
    match format {
        TableFormat::CsvWithDecimalComma => writer.with_separator(b';').with_decimal_comma(true),
        _ => writer,
    }
}

/// The table with texts and names of columns that a spreadsheet does not calculate; numbers stay what they are.
fn for_spreadsheets(table: &[FrameColumn]) -> Result<DataFrame, PolarsError> {
    let safe = |column: &FrameColumn| {
        let name = csv_text(&column.name).as_ref().into();
        let series = match &column.cells {
            FrameCells::Numbers(cells) => Series::new(name, cells),
            FrameCells::Counts(cells) => Series::new(name, cells),
            FrameCells::Flags(cells) => Series::new(name, cells),
            FrameCells::Texts(cells) => {
                let safe = cells.iter().map(|cell| cell.as_deref().map(csv_text));
                Series::new(name, safe.collect::<Vec<_>>())
            }
        };
        series.into_column()
    };
    DataFrame::new_infer_height(table.iter().map(safe).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::doubt::Doubts;
    use crate::tables::{TableInput, named};
    use ieap_domain::testing::{campaign, fit, known, run};
    use ieap_domain::{Estimate, RunRecord};
    use ieap_show::Frame;

    fn fitted(name: &str, alpha: Estimate) -> RunRecord {
        let mut fitted = run(name, "CNaf-01", "air", Some(34.0), 2.5);
        fitted.fit = Some(fit(&[
            ("r1_ohm_cm2", known(100.0, 0.01)),
            ("alpha_per_c_cm", alpha),
        ]));
        fitted
    }

    fn frame(name: &str, runs: &[RunRecord]) -> Frame {
        let (campaign, doubts) = (campaign(), Doubts::default());
        let table = named(name).unwrap();
        table.frame(&TableInput::new(&campaign, runs, &doubts))
    }

    fn csv(table: Frame) -> String {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        write_table(&table, TableFormat::Csv, &About::default(), &path).unwrap();
        std::fs::read_to_string(path).unwrap()
    }

    #[test]
    fn a_missing_value_is_an_empty_cell_with_its_reason() {
        let runs = [fitted("a", Estimate::not_determined("no curvature channel"))];
        let text = csv(frame("fits", &runs));
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 3, "{text}");
        assert!(
            lines[0]
                .ends_with("parameter,role,value,standard_error,low_95,high_95,converged,at_bound,reason")
        );
        assert!(
            lines[2].ends_with("alpha_per_c_cm,parameter,,,,,true,false,no curvature channel"),
            "{text}"
        );
    }

    #[test]
    fn wide_table_has_one_row_per_run_and_keeps_hostile_names() {
        let runs = [
            fitted("a,\"b\"\n", known(12.0, 0.1)),
            run("unfitted", "CNaf-01", "air", None, 1.2),
        ];
        let text = csv(frame("fits-wide", &runs));
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        assert_eq!(rows.len(), 2);
        assert_eq!(&rows[0][0], "runs/a,\"b\"\n.csv");
    }

    #[test]
    fn parquet_reads_back() {
        use parquet::file::reader::{FileReader, SerializedFileReader};
        let table = frame("fits", &[fitted("a", known(12.0, 0.1))]);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fits.parquet");
        write_table(&table, TableFormat::Parquet, &About::default(), &path).unwrap();
        let read = SerializedFileReader::new(std::fs::File::open(&path).unwrap()).unwrap();
        let rows: Vec<_> = read.get_row_iter(None).unwrap().map(Result::unwrap).collect();
        let at = table.iter().position(|column| column.name == "value").unwrap();
        let FrameCells::Numbers(values) = &table[at].cells else {
            panic!("{:?}", table[at])
        };
        assert_eq!(rows.len(), values.len());
        for (row, value) in rows.iter().zip(values.iter()) {
            let (name, field) = row.get_column_iter().nth(at).unwrap();
            assert_eq!(
                (name.as_str(), Some(field)),
                ("value", value.map(parquet::record::Field::Double).as_ref())
            );
        }
    }
}
