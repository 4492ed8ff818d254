//! Runs with all that a fit is made from, one row a run: readings as lists, the drive as lists, dimensions and hashes. A program
//! that has a row needs nothing else of the campaign.

use std::io::Write;

use polars::prelude::PolarsError;

use super::parquet_file::{About, Cells, ParquetFile, moment_us};
use ieap_domain::tag::keys;
use ieap_domain::{Channel, Edge, Quantity, RunRecord};

/// Channels that have columns of their own; how many others a run has is counted.
pub const LISTED: [Quantity; 6] = [
    Quantity::Voltage,
    Quantity::Current,
    Quantity::CurrentDensity,
    Quantity::Curvature,
    Quantity::TipDisplacement,
    Quantity::BlockingForce,
];

/// How the campaign fits a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Task {
    /// Free length, cm.
    pub length_cm: Option<f64>,
    /// Resistance of both electrodes along the strip, Ohm per square.
    pub electrode_resistance_ohm_per_sq: Option<f64>,
    /// Its standard error, where a probe measured it, Ohm per square.
    pub electrode_resistance_error_ohm_per_sq: Option<f64>,
    /// Hash of everything that the fit depends on.
    pub input_hash: String,
    /// Id of the model.
    pub model: String,
    /// Id of the method that searches the minimum.
    pub method: String,
    /// Whether current and curvature are fitted together.
    pub simultaneous: bool,
    /// What other runs of its instrument tell of its noise, JSON; none where nobody does.
    pub instrument_noise: Option<String>,
}

/// A run to be written.
#[derive(Debug, Clone)]
pub struct RunRow<'a> {
    /// The run.
    pub run: &'a RunRecord,
    /// Its channels.
    pub channels: Vec<Channel>,
    /// How it is fitted by itself, or why it is not.
    pub task: Result<Task, String>,
}

/// Writes runs into one file, a part at a time.
pub struct RunRowWriter<W: Write> {
    file: ParquetFile<W>,
}

impl<W: Write> RunRowWriter<W> {
    /// Begins the file.
    ///
    /// # Errors
    /// The disk refuses.
    pub fn begin(out: W, about: &About) -> Result<RunRowWriter<W>, PolarsError> {
        Ok(RunRowWriter {
            file: ParquetFile::begin(out, &columns(&[]), about)?,
        })
    }

    /// Adds runs.
    ///
    /// # Errors
    /// The disk refuses.
    pub fn write(&mut self, rows: &[RunRow<'_>]) -> Result<(), PolarsError> {
        self.file.write(columns(rows))
    }

    /// Ends the file.
    ///
    /// # Errors
    /// The disk refuses.
    pub fn finish(self) -> Result<W, PolarsError> {
        self.file.finish()
    }
}

fn columns(rows: &[RunRow<'_>]) -> Vec<(String, Cells)> {
    let mut columns = of_runs(rows);
    columns.extend(of_tasks(rows));
    columns.extend(of_drives(rows));
    for quantity in LISTED {
        columns.extend(of_channels(rows, quantity));
    }
    let others = rows.iter().map(|row| {
        let listed = LISTED
            .iter()
            .filter(|quantity| whole(row, **quantity).is_some())
            .count();
        Some((row.channels.len() - listed) as i64)
    });
    columns.push(named("other_channels", Cells::Counts(others.collect())));
    columns
}

fn of_runs(rows: &[RunRow<'_>]) -> Vec<(String, Cells)> {
    let text = |of: &dyn Fn(&RunRecord) -> Option<String>| {
        Cells::Texts(rows.iter().map(|row| of(row.run)).collect())
    };
    let number =
        |of: &dyn Fn(&RunRecord) -> Option<f64>| Cells::Numbers(rows.iter().map(|row| of(row.run)).collect());
    let started = rows.iter().map(|row| moment_us(row.run.tag(keys::STARTED_AT)?));
    let tag = |key: &'static str| number(&move |run| run.tag_number(key));
    vec![
        named("run", text(&|run| Some(run.path.clone()))),
        named(
            "revision",
            Cells::Counts(rows.iter().map(|row| Some(row.run.revision.into())).collect()),
        ),
        named("sample", text(&|run| run.tag(keys::SAMPLE).map(str::to_owned))),
        named(keys::VOLTAGE_V, tag(keys::VOLTAGE_V)),
        named(
            keys::RELATIVE_HUMIDITY_PERCENT,
            tag(keys::RELATIVE_HUMIDITY_PERCENT),
        ),
        named(keys::TEMPERATURE_C, tag(keys::TEMPERATURE_C)),
        named("started_at", Cells::Moments(started.collect())),
        named("data_hash", text(&|run| Some(run.data_hash.clone()))),
        named("area_cm2", number(&|run| run.area_cm2)),
    ]
}

fn of_tasks(rows: &[RunRow<'_>]) -> Vec<(String, Cells)> {
    let task = |row: &'_ RunRow<'_>| row.task.clone().ok();
    let text = |of: fn(Task) -> String| Cells::Texts(rows.iter().map(|row| task(row).map(of)).collect());
    let number =
        |of: fn(Task) -> Option<f64>| Cells::Numbers(rows.iter().map(|row| of(task(row)?)).collect());
    let together = rows.iter().map(|row| Some(task(row)?.simultaneous));
    let noise = rows.iter().map(|row| task(row)?.instrument_noise);
    let reason = rows.iter().map(|row| row.task.clone().err());
    vec![
        named("length_cm", number(|task| task.length_cm)),
        named(
            "electrode_resistance_ohm_per_sq",
            number(|task| task.electrode_resistance_ohm_per_sq),
        ),
        named(
            "electrode_resistance_error_ohm_per_sq",
            number(|task| task.electrode_resistance_error_ohm_per_sq),
        ),
        named("input_hash", text(|task| task.input_hash)),
        named("model", text(|task| task.model)),
        named("method", text(|task| task.method)),
        named("simultaneous", Cells::Flags(together.collect())),
        named("instrument_noise", Cells::Texts(noise.collect())),
        named("reason", Cells::Texts(reason.collect())),
    ]
}

fn of_drives(rows: &[RunRow<'_>]) -> Vec<(String, Cells)> {
    let drive = |row: &'_ RunRow<'_>| row.run.drive.clone();
    let baseline = rows.iter().map(|row| Some(drive(row)?.baseline_v));
    let starts = rows.iter().map(|row| {
        let segments = drive(row)?.segments;
        Some(segments.iter().map(|segment| Some(segment.start_s())).collect())
    });
    let before = |edge: &Edge| (!edge.is_stated()).then_some(edge.no_earlier_s);
    let before = rows.iter().map(|row| {
        let segments = drive(row)?.segments;
        Some(segments.iter().map(|segment| before(&segment.edge)).collect())
    });
    let levels = rows
        .iter()
        .map(|row| Some(drive(row)?.levels().map(|(_, volts)| volts).collect()));
    vec![
        named("baseline_v", Cells::Numbers(baseline.collect())),
        named("drive_start_s", Cells::Lists(starts.collect())),
        named("drive_last_before_s", Cells::Lists(before.collect())),
        named("drive_v", Cells::Lists(levels.collect())),
    ]
}

/// Readings, their times, and the places of those that are no measurement.
fn of_channels(rows: &[RunRow<'_>], quantity: Quantity) -> Vec<(String, Cells)> {
    let list = |of: &dyn Fn(&Channel) -> Vec<f64>| {
        let lists = rows.iter().map(|row| {
            let numbers = of(whole(row, quantity)?);
            Some(numbers.into_iter().map(Some).collect())
        });
        Cells::Lists(lists.collect())
    };
    let key = quantity.key();
    vec![
        named(&format!("{key}_time_s"), list(&|channel| channel.time_s.to_vec())),
        named(
            &format!("{}_readings", quantity.column()),
            list(&|channel| channel.values.to_vec()),
        ),
        named(
            &format!("{key}_excluded"),
            list(&|channel| channel.excluded.iter().map(|&index| f64::from(index)).collect()),
        ),
    ]
}

/// The first channel of a quantity of the strip as a whole.
fn whole<'a>(row: &'a RunRow<'_>, quantity: Quantity) -> Option<&'a Channel> {
    row.channels.iter().find(|channel| channel.is_whole(quantity))
}

fn named(name: &str, cells: Cells) -> (String, Cells) {
    (name.to_owned(), cells)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::Drive;
    use ieap_domain::testing::run;
    use parquet::file::reader::{FileReader, SerializedFileReader};

    #[test]
    fn a_row_holds_what_a_fit_is_made_from_or_why_there_is_none() {
        let mut measured = run("a", "CNaf-01", "air", Some(34.0), 2.5);
        measured.drive = Some(Drive::step(2.5));
        let untagged = run("b", "CNaf-01", "air", None, 2.5);
        let mut current = Channel::new(Quantity::Current, [0.5, 1.0].into(), [1e-3, 0.1 + 0.2].into());
        current.excluded = [1].into();
        let along = Channel {
            position_mm: Some(2.0),
            ..Channel::new(Quantity::Curvature, [0.0].into(), [0.5].into())
        };
        let task = Task {
            length_cm: Some(0.5),
            electrode_resistance_ohm_per_sq: None,
            electrode_resistance_error_ohm_per_sq: None,
            input_hash: "i".to_owned(),
            model: "lumped-2".to_owned(),
            method: "variable-projection".to_owned(),
            simultaneous: false,
            instrument_noise: None,
        };
        let rows = [
            RunRow {
                run: &measured,
                channels: vec![current, along],
                task: Ok(task),
            },
            RunRow {
                run: &untagged,
                channels: vec![],
                task: Err("no sample".to_owned()),
            },
        ];
        let mut writer = RunRowWriter::begin(Vec::new(), &About::default()).unwrap();
        writer.write(&rows).unwrap();
        let bytes = writer.finish().unwrap();
        let read = SerializedFileReader::new(bytes::Bytes::from(bytes)).unwrap();
        let read: Vec<_> = read.get_row_iter(None).unwrap().map(Result::unwrap).collect();
        let of = |row: usize, name: &str| {
            let mut cells = read[row].get_column_iter();
            cells
                .find(|(found, _)| *found == name)
                .map(|(_, field)| field.to_string())
                .expect(name)
        };
        assert_eq!(of(0, "current_a_readings"), "[0.001, 0.30000000000000004]");
        assert_eq!(
            (of(0, "current_time_s"), of(0, "current_excluded")),
            ("[0.5, 1.0]".into(), "[1.0]".into())
        );
        assert_eq!(
            (of(0, "drive_start_s"), of(0, "drive_v")),
            ("[0E0]".into(), "[2.5]".into())
        );
        assert_eq!(
            of(0, "curvature_per_cm_readings"),
            "null",
            "readings along the strip are not of the strip as a whole"
        );
        assert_eq!(of(0, "other_channels"), "1");
        assert_eq!(
            (of(1, "reason"), of(1, "input_hash")),
            ("\"no sample\"".into(), "null".into())
        );
    }
}
