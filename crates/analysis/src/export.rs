//! Tables for other programs: fits and conditions as data frames, written as CSV or Parquet.
//!
//! Column names carry the unit. A missing number is an empty cell (CSV) or null (Parquet), never a zero.

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use polars::prelude::{Column, DataFrame, IntoColumn, NamedFrom, PolarsError, Series};
use polars_io::SerWriter;
use polars_io::csv::write::CsvWriter;

use super::conditions::{Conditions, conditions, material, nominal_voltage_v};
use super::disk_file::DiskFile;
use super::one_fit::SharedEstimate;
use super::parameters::{PARAMETERS, usable};
use super::parquet_file::{self, About};
use ieap_domain::number::to_digits;
use ieap_domain::safe_text::csv_text;
use ieap_domain::tag::keys;
use ieap_domain::{Campaign, Estimate, Parameter, RunRecord};

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

/// One row per run and parameter: value, standard error, 95 % interval and the reason for what is missing.
///
/// # Errors
/// [`ExportError::Table`]: a fault of the program.
pub fn fits_long(runs: &[RunRecord], campaign: &Campaign) -> Result<DataFrame, ExportError> {
    let rows: Vec<(&RunRecord, &Parameter)> = runs
        .iter()
        .filter_map(|run| Some((run, run.fit.as_ref()?)))
        .flat_map(|(run, fit)| fit.parameters.iter().map(move |parameter| (run, parameter)))
        .collect();
    let of_runs: Vec<&RunRecord> = rows.iter().map(|(run, _)| *run).collect();
    let mut columns = run_columns(&of_runs, campaign);
    let number = |name: &str, get: fn(&Estimate) -> Option<f64>| {
        numbers(name, rows.iter().map(|(_, parameter)| get(&parameter.estimate)))
    };
    columns.extend([
        texts(
            "parameter",
            rows.iter().map(|(_, parameter)| Some(parameter.key.clone())),
        ),
        number("value", |estimate| estimate.value),
        number("standard_error", |estimate| estimate.standard_error),
        number("low_95", |estimate| estimate.low_95),
        number("high_95", |estimate| estimate.high_95),
        flags(
            "converged",
            rows.iter()
                .map(|(run, _)| run.fit.as_ref().is_some_and(|fit| fit.converged)),
        ),
        flags(
            "at_bound",
            rows.iter().map(|(_, parameter)| parameter.estimate.at_bound),
        ),
        texts(
            "reason",
            rows.iter()
                .map(|(_, parameter)| parameter.estimate.reason.clone()),
        ),
    ]);
    frame("fits", columns)
}

/// One row per run, fitted or not: identity, tags, fit quality, and each parameter with its standard error.
///
/// # Errors
/// [`ExportError::Table`]: a fault of the program.
pub fn fits_wide(runs: &[RunRecord], campaign: &Campaign) -> Result<DataFrame, ExportError> {
    let all: Vec<&RunRecord> = runs.iter().collect();
    let mut columns = run_columns(&all, campaign);
    let of_fit = |name: &str, get: fn(&ieap_domain::Fit) -> Option<f64>| {
        numbers(name, runs.iter().map(|run| run.fit.as_ref().and_then(get)))
    };
    let converged: Vec<Option<bool>> = runs
        .iter()
        .map(|run| run.fit.as_ref().map(|fit| fit.converged))
        .collect();
    columns.extend([
        texts("state", runs.iter().map(|run| Some(run.state.key().to_owned()))),
        texts("status", runs.iter().map(|run| Some(run.status.key().to_owned()))),
        Series::new("converged".into(), converged).into_column(),
        of_fit("r_squared_current", |fit| fit.r_squared_current),
        of_fit("r_squared_curvature", |fit| fit.r_squared_curvature),
    ]);
    for key in parameter_keys(runs) {
        let estimate = |run: &RunRecord| run.fit.as_ref().and_then(|fit| fit.parameter(&key).cloned());
        let number = |suffix: &str, get: fn(&Estimate) -> Option<f64>| {
            let values = runs.iter().map(|run| estimate(run).as_ref().and_then(get));
            numbers(&format!("{key}{suffix}"), values)
        };
        columns.extend([
            number("", |estimate| estimate.value),
            number("_standard_error", |estimate| estimate.standard_error),
            number("_low_95", |estimate| estimate.low_95),
            number("_high_95", |estimate| estimate.high_95),
        ]);
    }
    frame("fits_wide", columns)
}

/// Rounds every number to six digits, standard errors to three: for tables that people read. The export keeps all.
///
/// # Errors
/// [`ExportError::Table`]: a fault of the program.
pub fn rounded(table: &DataFrame) -> Result<DataFrame, ExportError> {
    let round = |column: &Column| {
        let Ok(values) = column.f64() else {
            return column.clone();
        };
        let digits = if column.name().ends_with("_standard_error") {
            3
        } else {
            6
        };
        let of = |value: f64| to_digits(value, digits);
        numbers(column.name(), values.iter().map(|value| value.map(of)))
    };
    frame("rounded", table.columns().iter().map(round).collect())
}

/// One row per measured condition: numbers of runs, and per parameter how many runs determine it, their mean
/// and their standard deviation between runs (empty for fewer than two). Fits that did not converge are left
/// out of the parameters; runs with the one parameter set of a group count as one.
///
/// # Errors
/// [`ExportError::Table`]: a fault of the program.
pub fn conditions_table(runs: &[RunRecord], campaign: &Campaign) -> Result<DataFrame, ExportError> {
    let table = conditions(runs, campaign);
    let mut columns = condition_columns(&table);
    let counts = |counted: &dyn Fn(&RunRecord) -> bool| -> Vec<u32> {
        let of = |indices: &[usize]| indices.iter().filter(|&&index| counted(&runs[index])).count() as u32;
        table
            .measured
            .iter()
            .map(|condition| of(&condition.runs))
            .collect()
    };
    columns.push(Series::new("runs".into(), counts(&|_| true)).into_column());
    columns.push(Series::new("runs_fitted".into(), counts(&|run| run.fit.is_some())).into_column());
    for key in parameter_keys(runs) {
        let values: Vec<Vec<f64>> = table
            .measured
            .iter()
            .map(|condition| determined(runs, &condition.runs, &key))
            .collect();
        let determined: Vec<u32> = values.iter().map(|values| values.len() as u32).collect();
        columns.push(Series::new(format!("{key}_runs").into(), determined).into_column());
        columns.push(numbers(&format!("{key}_mean"), values.iter().map(|v| mean(v))));
        let between = values.iter().map(|v| standard_deviation(v));
        columns.push(numbers(&format!("{key}_standard_deviation"), between));
    }
    frame("conditions", columns)
}

/// Writes `table` to `path`; Parquet also holds what is said about it. The bytes depend on these only.
///
/// # Errors
/// [`ExportError::Write`] where the file cannot be written, [`ExportError::Table`] where it cannot be encoded.
pub fn write_table(
    table: &DataFrame,
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
        TableFormat::Json => super::json_rows::write(table, &mut file),
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
fn for_spreadsheets(table: &DataFrame) -> Result<DataFrame, PolarsError> {
    let safe = |column: &Column| {
        let name = csv_text(column.name());
        match column.str() {
            Ok(cells) => texts(&name, cells.iter().map(|cell| Some(csv_text(cell?).into_owned()))),
            Err(_) => column.clone().with_name(name.as_ref().into()),
        }
    };
    DataFrame::new(table.height(), table.columns().iter().map(safe).collect())
}

/// Columns that say which run a row is about.
pub(super) fn run_columns(runs: &[&RunRecord], campaign: &Campaign) -> Vec<Column> {
    let tag = |name: &str, key: &str| texts(name, runs.iter().map(|run| run.tag(key).map(str::to_owned)));
    let number = |key: &str| numbers(key, runs.iter().map(|run| run.tag_number(key)));
    vec![
        texts("run", runs.iter().map(|run| Some(run.path.clone()))),
        Series::new(
            "revision".into(),
            runs.iter().map(|run| run.revision).collect::<Vec<_>>(),
        )
        .into_column(),
        tag("sample", keys::SAMPLE),
        texts(
            "material",
            runs.iter().map(|run| material(run, campaign).map(str::to_owned)),
        ),
        tag("environment", keys::ENVIRONMENT),
        number(keys::RELATIVE_HUMIDITY_PERCENT),
        number(keys::TEMPERATURE_C),
        numbers(keys::VOLTAGE_V, runs.iter().map(|run| nominal_voltage_v(run))),
        tag("started_at", keys::STARTED_AT),
        texts(
            "model",
            runs.iter()
                .map(|run| run.fit.as_ref().map(|fit| fit.model.clone())),
        ),
    ]
}

fn condition_columns(table: &Conditions) -> Vec<Column> {
    let measured = || table.measured.iter();
    let humidity = |get: fn(super::HumidityLevel) -> f64| {
        measured().map(move |condition| table.surroundings[condition.surroundings].humidity.map(get))
    };
    vec![
        texts(
            "material",
            measured().map(|c| Some(table.materials[c.material].clone())),
        ),
        texts(
            "environment",
            measured().map(|c| Some(table.surroundings[c.surroundings].environment.clone())),
        ),
        numbers(
            "relative_humidity_low_percent",
            humidity(|level| level.low_percent),
        ),
        numbers(
            "relative_humidity_high_percent",
            humidity(|level| level.high_percent),
        ),
        numbers("voltage_v", measured().map(|c| Some(table.voltages_v[c.voltage]))),
    ]
}

/// Keys that occur in any fit: those of the lumped model in its order, then the others by name.
fn parameter_keys(runs: &[RunRecord]) -> Vec<String> {
    let fits = runs.iter().filter_map(|run| run.fit.as_ref());
    let mut keys: Vec<&str> = fits
        .flat_map(|fit| fit.parameters.iter().map(|parameter| parameter.key.as_str()))
        .collect();
    let rank = |key: &str| {
        PARAMETERS
            .iter()
            .position(|known| known.key == key)
            .unwrap_or(PARAMETERS.len())
    };
    keys.sort_by_key(|key| (rank(key), *key));
    keys.dedup();
    keys.into_iter().map(str::to_owned).collect()
}

/// Determined values of a condition's runs; one that the fit of a group gave to several of them counts once.
fn determined(runs: &[RunRecord], indices: &[usize], key: &str) -> Vec<f64> {
    let mut counted = BTreeSet::new();
    let value = |&index: &usize| {
        let estimate = usable(&runs[index], key)?;
        let is_new = SharedEstimate::of(&runs[index], estimate).is_none_or(|shared| counted.insert(shared));
        estimate.value.filter(|_| is_new)
    };
    indices.iter().filter_map(value).collect()
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Between runs, with n - 1.
fn standard_deviation(values: &[f64]) -> Option<f64> {
    let mean = mean(values).filter(|_| values.len() > 1)?;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    Some((squares / (values.len() - 1) as f64).sqrt())
}

pub(super) fn texts(name: &str, values: impl Iterator<Item = Option<String>>) -> Column {
    Series::new(name.into(), values.collect::<Vec<_>>()).into_column()
}

pub(super) fn numbers(name: &str, values: impl Iterator<Item = Option<f64>>) -> Column {
    Series::new(name.into(), values.collect::<Vec<_>>()).into_column()
}

pub(super) fn flags(name: &str, values: impl Iterator<Item = bool>) -> Column {
    Series::new(name.into(), values.collect::<Vec<_>>()).into_column()
}

pub(super) fn frame(table: &str, columns: Vec<Column>) -> Result<DataFrame, ExportError> {
    DataFrame::new_infer_height(columns).map_err(|source| ExportError::Table {
        table: table.to_owned(),
        source,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::testing::{campaign, fit, known, run};

    fn fitted(name: &str, alpha: Estimate) -> RunRecord {
        let mut fitted = run(name, "CNaf-01", "air", Some(34.0), 2.5);
        fitted.fit = Some(fit(&[
            ("r1_ohm_cm2", known(100.0, 0.01)),
            ("alpha_per_c_cm", alpha),
        ]));
        fitted
    }

    fn csv(table: DataFrame) -> String {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        write_table(&table, TableFormat::Csv, &About::default(), &path).unwrap();
        std::fs::read_to_string(path).unwrap()
    }

    #[test]
    fn a_missing_value_is_an_empty_cell_with_its_reason() {
        let runs = [fitted("a", Estimate::not_determined("no curvature channel"))];
        let text = csv(fits_long(&runs, &campaign()).unwrap());
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 3, "{text}");
        assert!(
            lines[0].ends_with("parameter,value,standard_error,low_95,high_95,converged,at_bound,reason")
        );
        assert!(
            lines[2].ends_with("alpha_per_c_cm,,,,,true,false,no curvature channel"),
            "{text}"
        );
    }

    #[test]
    fn wide_table_has_one_row_per_run_and_keeps_hostile_names() {
        let runs = [
            fitted("a,\"b\"\n", known(12.0, 0.1)),
            run("unfitted", "CNaf-01", "air", None, 1.2),
        ];
        let text = csv(fits_wide(&runs, &campaign()).unwrap());
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        assert_eq!(rows.len(), 2);
        assert_eq!(&rows[0][0], "runs/a,\"b\"\n.csv");
    }

    #[test]
    fn conditions_count_runs_and_spread_needs_two() {
        let runs = [
            fitted("a", known(10.0, 0.1)),
            fitted("b", known(14.0, 0.1)),
            fitted("c", Estimate::below(3.0, "search limit")),
            run("d", "CPvf-01", "air", Some(34.0), 2.5),
        ];
        let table = conditions_table(&runs, &campaign()).unwrap();
        let number = |column: &str, row| table.column(column).unwrap().f64().unwrap().get(row);
        assert_eq!(table.height(), 2);
        assert_eq!(number("alpha_per_c_cm_mean", 0), Some(12.0));
        assert_eq!(number("alpha_per_c_cm_standard_deviation", 0), Some(8f64.sqrt()));
        assert_eq!(number("alpha_per_c_cm_mean", 1), None);
        assert_eq!(
            table.column("alpha_per_c_cm_runs").unwrap().u32().unwrap().get(0),
            Some(2)
        );
    }

    #[test]
    fn one_parameter_set_of_a_group_counts_once() {
        let mut runs = [10.0, 10.0, 14.0].map(|value| fitted("a", known(value, 0.1)));
        for run in &mut runs[..2] {
            run.fit.as_mut().unwrap().model = "lumped-2 + faradaic-leak".to_owned();
        }
        let table = conditions_table(&runs, &campaign()).unwrap();
        let count = table.column("alpha_per_c_cm_runs").unwrap().u32().unwrap().get(0);
        let mean = table.column("alpha_per_c_cm_mean").unwrap().f64().unwrap().get(0);
        assert_eq!((count, mean), (Some(2), Some(12.0)));
    }

    #[test]
    fn parquet_reads_back() {
        use parquet::file::reader::{FileReader, SerializedFileReader};
        let table = fits_long(&[fitted("a", known(12.0, 0.1))], &campaign()).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fits.parquet");
        write_table(&table, TableFormat::Parquet, &About::default(), &path).unwrap();
        let read = SerializedFileReader::new(std::fs::File::open(&path).unwrap()).unwrap();
        let rows: Vec<_> = read.get_row_iter(None).unwrap().map(Result::unwrap).collect();
        assert_eq!(rows.len(), table.height());
        let values = table.column("value").unwrap().f64().unwrap();
        let at = table.get_column_index("value").unwrap();
        for (row, value) in rows.iter().zip(values.iter()) {
            let (name, field) = row.get_column_iter().nth(at).unwrap();
            assert_eq!(
                (name.as_str(), Some(field)),
                ("value", value.map(parquet::record::Field::Double).as_ref())
            );
        }
    }
}
