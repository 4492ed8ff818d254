//! What a reader made of a table, held against what it holds.

use ieap_domain::{Channel, Issue, Quantity, Severity};
use ieap_ingest::formats::{ReadContext, read};
use ieap_ingest::{Reading, climate_log};

use crate::compare::{Found, fault};
use crate::expected::{Expected, Series};
use crate::start::start;
use crate::table::Expect;
use crate::write::Table;

/// Codes of refusals that ask for an answer.
const ASKED: [&str; 3] = ["ambiguous-numbers", "ambiguous-dates", "asked"];

/// What became of a table.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// All that was interpreted is right; so many measured columns were kept without their meaning.
    Right { uninterpreted: usize },
    /// Nothing entered, a question was put.
    Asked(String),
    /// Nothing entered.
    Refused(String),
    /// A temperature under a unit that no file names and a note tells: freezing air in °F looks like a room in °C.
    Told,
    /// What differs: its kind, and where.
    Wrong { kind: String, detail: String },
}

/// Reads a table and judges the reading.
pub fn judge(table: &Table, is_log: bool) -> Outcome {
    let reading = match read(table.file, &table.bytes, &ReadContext::default()) {
        Ok(reading) => reading,
        Err(error) if ASKED.contains(&error.code()) => return Outcome::Asked(error.code().to_owned()),
        Err(error) => return Outcome::Refused(error.code().to_owned()),
    };
    let expected = &table.expected;
    let found = if is_log {
        of_log(&reading, table.file)
    } else {
        Ok((of_run(&reading), Vec::new()))
    };
    let (found, more) = match found {
        Ok(found) => found,
        Err(issue) => return Outcome::Refused(issue.code),
    };
    let issues: Vec<Issue> = reading.issues.iter().chain(&more).cloned().collect();
    match wrong(expected, &reading, &found, &issues, is_log) {
        Some((kind, _)) if kind == "values of temperature are wrong" && is_freezing(expected, &issues) => {
            Outcome::Told
        }
        Some((kind, detail)) => Outcome::Wrong { kind, detail },
        None => {
            let count = |part: usize, quantity: Quantity| {
                found
                    .iter()
                    .filter(|f| f.part == part && f.quantity == quantity)
                    .count()
            };
            let expected_of = |one: &Series| {
                expected
                    .series
                    .iter()
                    .filter(|s| (s.part, s.quantity) == (one.part, one.quantity))
                    .count()
            };
            let lacks = |one: &&Series| count(one.part, one.quantity) < expected_of(one);
            Outcome::Right {
                uninterpreted: expected.series.iter().filter(lacks).count(),
            }
        }
    }
}

fn of_run(reading: &Reading) -> Vec<Found> {
    let mut all = Vec::new();
    for (part, table) in reading.tables.iter().enumerate() {
        for channel in table
            .channels
            .iter()
            .filter(|c| c.quantity != Quantity::Other && !c.is_empty())
        {
            let (time_s, values) = channel.included();
            all.push(Found {
                part,
                sensor: String::new(),
                quantity: if channel.quantity == Quantity::ControlVoltage {
                    Quantity::Voltage
                } else {
                    channel.quantity
                },
                time_s: time_s.to_vec(),
                values: values.to_vec(),
                is_rebuilt: table.printed_time.is_some(),
            });
        }
    }
    all
}

/// The series of a log that have a quantity of this generator, in its canonical units.
fn of_log(reading: &Reading, path: &str) -> Result<(Vec<Found>, Vec<Issue>), Issue> {
    let log = climate_log::log(reading, path)?;
    let is_rebuilt = reading.tables.iter().any(|table| table.printed_time.is_some());
    let quantity = |key: &str| match key {
        "temperature_c" => Some(Quantity::Temperature),
        "relative_humidity_percent" => Some(Quantity::RelativeHumidity),
        "pressure_pa" => Some(Quantity::Pressure),
        "dew_point_c" => None,
        _ => Some(Quantity::Other),
    };
    let found = log.series.iter().filter_map(|series| {
        Some(Found {
            part: 0,
            sensor: series.sensor.clone(),
            quantity: quantity(series.quantity.key())?,
            time_s: series.readings.elapsed_s.clone(),
            values: series.readings.values.clone(),
            is_rebuilt,
        })
    });
    Ok((found.collect(), log.issues.clone()))
}

/// Whether the true temperatures are below freezing and a note tells the unit that was taken.
fn is_freezing(expected: &Expected, issues: &[Issue]) -> bool {
    let is_cold = |one: &Series| {
        one.quantity == Quantity::Temperature
            && one
                .cells
                .iter()
                .any(|cell| matches!(cell, Expect::Reading(value) | Expect::Optional(value) if *value < 0.0))
    };
    expected.series.iter().any(is_cold) && issues.iter().any(|issue| issue.code == "unit-told")
}

/// Kind and detail of what differs.
pub type Fault = (String, String);

fn wrong(
    expected: &Expected,
    reading: &Reading,
    found: &[Found],
    issues: &[Issue],
    is_log: bool,
) -> Option<Fault> {
    let faults = joined(expected, reading, issues).or_else(|| series(expected, reading, found, issues));
    if expected.contradicts {
        let is_told = issues
            .iter()
            .any(|issue| issue.severity != Severity::Note && issue_names(issue, &["time", "clock", "date"]));
        let kind = "contradicting clocks are read without a word".to_owned();
        return match faults {
            None if is_told => start(expected, reading, is_log),
            None => Some((kind, "by the date".to_owned())),
            Some((_, detail)) => Some((kind, detail)),
        };
    }
    faults.or_else(|| start(expected, reading, is_log))
}

/// Two runs of a file whose header stands twice are not one.
fn joined(expected: &Expected, reading: &Reading, issues: &[Issue]) -> Option<Fault> {
    let rows: usize = expected.series.first().map_or(0, |s| s.cells.len());
    let joined = expected.parts > 1 && reading.tables.len() == 1 && reading.tables[0].rows > rows + 1;
    let is_told = issues
        .iter()
        .any(|issue| issue_names(issue, &["header", "restart", "run"]));
    (joined && !is_told).then(|| {
        (
            "two runs are joined into one".to_owned(),
            format!("{} rows", reading.tables[0].rows),
        )
    })
}

fn series(expected: &Expected, reading: &Reading, found: &[Found], issues: &[Issue]) -> Option<Fault> {
    let mut taken: Vec<(usize, String)> = Vec::new();
    let mut used = vec![false; expected.series.len()];
    for one in found {
        let fitting = (0..used.len()).filter(|&i| {
            !used[i] && expected.series[i].quantity == one.quantity && expected.series[i].part == one.part
        });
        let faults: Vec<(usize, Option<Fault>)> = fitting
            .map(|i| (i, fault(&expected.series[i], one, expected, issues)))
            .collect();
        if faults.is_empty() {
            return Some((
                format!("{} is read where none is", one.quantity.key()),
                format!("sensor {:?}", one.sensor),
            ));
        }
        let rows_of_one = faults.iter().map(|(i, _)| expected.series[*i].cells.len()).max();
        let is_merged = faults.len() > 1 && rows_of_one.is_some_and(|rows| one.values.len() > rows + 2);
        match faults.iter().find(|(_, fault)| fault.is_none()) {
            Some((at, _)) => {
                used[*at] = true;
                taken.push((expected.series[*at].sensor, one.sensor.clone()));
            }
            None if is_merged => {
                return Some((
                    "two sensors are merged into one series".to_owned(),
                    one.quantity.key().to_owned(),
                ));
            }
            None => return faults.into_iter().next().and_then(|(_, fault)| fault),
        }
    }
    let mixed = taken
        .iter()
        .any(|(sensor, name)| taken.iter().any(|(other, same)| name == same && sensor != other));
    if mixed {
        return Some((
            "quantities of two sensors bear one name".to_owned(),
            format!("{taken:?}"),
        ));
    }
    let lost = (0..used.len())
        .filter(|i| !used[*i])
        .map(|i| &expected.series[i])
        .find(|s| !is_kept(s, reading, issues));
    lost.map(|s| {
        (
            format!("{} is lost without a word", s.quantity.key()),
            format!("{} of part {}", s.name, s.part),
        )
    })
}

/// Whether a column that was not interpreted is still there, by its name or by its numbers, or its loss is told.
fn is_kept(series: &Series, reading: &Reading, issues: &[Issue]) -> bool {
    let bare = |text: &str| {
        text.chars()
            .filter(|c| c.is_alphanumeric())
            .collect::<String>()
            .to_lowercase()
    };
    let name = bare(&series.name);
    let of_part = reading
        .tables
        .get(series.part)
        .map_or(&[][..], |table| &table.channels);
    let readings: Vec<f64> = series
        .cells
        .iter()
        .filter_map(|cell| {
            if let Expect::Reading(value) = cell {
                Some(*value)
            } else {
                None
            }
        })
        .collect();
    let is_multiple = |values: &[f64]| {
        let ratios: Vec<f64> = readings
            .iter()
            .zip(values)
            .filter(|(r, _)| **r != 0.0)
            .take(9)
            .map(|(r, v)| v / r)
            .collect();
        ratios.len() > 3 && ratios.iter().all(|ratio| (ratio / ratios[0] - 1.0).abs() < 1e-6)
    };
    let is_it = |channel: &Channel| bare(&channel.raw_name).contains(&name) || is_multiple(&channel.values);
    let is_there = of_part
        .iter()
        .any(|channel| !channel.is_empty() && is_it(channel));
    is_there || readings.is_empty() || tells_of_loss(issues, &series.name)
}

/// Whether an issue tells that readings are left out: it names the column, or rows, lines or cells.
pub fn tells_of_loss(issues: &[Issue], name: &str) -> bool {
    let words = [
        "row", "line", "cell", "reading", "column", "table", "left out", "cut", "header",
    ];
    issues
        .iter()
        .any(|issue| issue_names(issue, &words) || issue_names(issue, &[&name.to_lowercase()]))
}

fn issue_names(issue: &Issue, words: &[&str]) -> bool {
    let text = format!("{} {} {}", issue.code, issue.place, issue.message).to_lowercase();
    words.iter().any(|word| text.contains(word))
}
