//! What is sealed: sets of rows that are read together.

use std::fmt;

use rusqlite::Connection;
use rusqlite::types::Value;

/// A set of rows that is read together.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Subject {
    /// Which runs and modulus logs are current, in order of their names.
    Runs,
    /// A run but for its readings.
    Run(i64),
    /// Readings of a run.
    Readings(i64),
    /// Climate around a run, to draw.
    ClimateCurves(i64),
    /// What people said of runs.
    RunWords,
    /// How people asked runs to be fitted.
    AskedFits,
    /// Marks of readings, by which runs with the same ones are found.
    Marks,
    /// Runs whose readings stand in other runs.
    SameReadings,
    /// Which climate logs are current.
    Logs,
    /// A climate log but for its readings.
    Log(i64),
    /// Readings of a series of a climate log: the log and the series' place in it.
    Series(i64, i64),
    /// What the climate logs come to.
    Assessment,
    /// Tags of a run set by hand.
    HandTags(String),
    /// A file of the campaign folder.
    File(String),
    /// Alarms that were told.
    Alarms,
    /// The last line of the journal, and those that say that words may be lost. Each line has a checksum of its own.
    JournalEnd,
    /// How often the database changed, and when last.
    Changes,
}

const RUN: [&str; 10] = [
    "SELECT * FROM run WHERE id = ?1",
    "SELECT run_file.*, content.* FROM run_file LEFT JOIN content ON content.hash = run_file.hash
     WHERE run_id = ?1 ORDER BY ordinal",
    "SELECT ordinal, quantity, raw_name, raw_unit, position_mm, readings, excluded, first_time_s, last_time_s,
            first_value, last_value, time_of FROM channel WHERE run_id = ?1 ORDER BY ordinal",
    "SELECT * FROM tag WHERE run_id = ?1 ORDER BY ordinal",
    "SELECT * FROM run_issue WHERE run_id = ?1 ORDER BY ordinal",
    "SELECT * FROM run_clock WHERE run_id = ?1 ORDER BY ordinal",
    "SELECT * FROM clock_offset WHERE run_id = ?1 ORDER BY clock, source",
    "SELECT * FROM sample_flag WHERE run_id = ?1 ORDER BY ordinal",
    "SELECT run_profile.*, profile.* FROM run_profile LEFT JOIN profile ON profile.digest = run_profile.digest
     WHERE run_id = ?1 ORDER BY ordinal",
    "SELECT * FROM run_climate WHERE run_id = ?1 ORDER BY ordinal",
];
const LOG: [&str; 2] = [
    "SELECT * FROM climate_log WHERE id = ?1",
    "SELECT ordinal, sensor, quantity, raw_name, raw_unit, not_used, readings, interval_s, first_s, length_s, time_of
     FROM climate_series WHERE log_id = ?1 ORDER BY ordinal",
];

impl Subject {
    /// Its stored name.
    pub fn name(&self) -> &'static str {
        match self {
            Subject::Runs => "runs",
            Subject::Run(_) => "run",
            Subject::Readings(_) => "readings",
            Subject::ClimateCurves(_) => "climate curves",
            Subject::RunWords => "run words",
            Subject::AskedFits => "asked fits",
            Subject::Marks => "marks",
            Subject::SameReadings => "same readings",
            Subject::Logs => "logs",
            Subject::Log(_) => "log",
            Subject::Series(..) => "series",
            Subject::Assessment => "assessment",
            Subject::HandTags(_) => "hand tags",
            Subject::File(_) => "file",
            Subject::Alarms => "alarms",
            Subject::JournalEnd => "journal end",
            Subject::Changes => "changes",
        }
    }

    /// Values that its queries are asked with.
    pub fn keys(&self) -> Vec<Value> {
        use Subject as S;
        match self {
            S::Runs
            | S::RunWords
            | S::AskedFits
            | S::Marks
            | S::SameReadings
            | S::Logs
            | S::Assessment
            | S::Alarms
            | S::JournalEnd
            | S::Changes => Vec::new(),
            S::Run(id) | S::Readings(id) | S::ClimateCurves(id) | S::Log(id) => vec![Value::Integer(*id)],
            S::Series(log, ordinal) => vec![Value::Integer(*log), Value::Integer(*ordinal)],
            S::HandTags(path) | S::File(path) => vec![Value::Text(path.clone())],
        }
    }

    /// What tells it from others of its name.
    pub fn id(&self) -> Value {
        match self {
            Subject::Series(log, ordinal) => Value::Text(format!("{log}/{ordinal}")),
            _ => self.keys().into_iter().next().unwrap_or(Value::Integer(0)),
        }
    }

    /// The queries that give its rows in order. All columns of a table belong to it, so that only a migration, which seals
    /// everything anew, changes what a seal is over.
    pub fn queries(&self) -> &'static [&'static str] {
        match self {
            Subject::Runs => &["SELECT id FROM run WHERE superseded_at IS NULL ORDER BY path"],
            Subject::Run(_) => &RUN,
            Subject::Readings(_) => &[
                "SELECT ordinal, time_of, time_blob, value_blob, excluded_blob FROM channel
                 WHERE run_id = ?1 ORDER BY ordinal",
            ],
            Subject::ClimateCurves(_) => {
                &["SELECT * FROM run_climate_curve WHERE run_id = ?1 ORDER BY ordinal"]
            }
            Subject::RunWords => &["SELECT * FROM run_word ORDER BY id"],
            Subject::AskedFits => &["SELECT * FROM asked_fit ORDER BY run_path"],
            Subject::Marks => &["SELECT * FROM run_marks ORDER BY run_id"],
            Subject::SameReadings => &["SELECT * FROM same_readings ORDER BY run_id, in_run_id"],
            Subject::Logs => &["SELECT id FROM climate_log WHERE superseded_at IS NULL ORDER BY path"],
            Subject::Log(_) => &LOG,
            Subject::Series(..) => &[
                "SELECT own.time_of, coalesce(own.time_blob, shared.time_blob), own.value_blob
                 FROM climate_series AS own
                 JOIN climate_series AS shared ON shared.log_id = own.log_id AND shared.ordinal = own.time_of
                 WHERE own.log_id = ?1 AND own.ordinal = ?2",
            ],
            Subject::Assessment => &["SELECT * FROM climate_assessment"],
            Subject::HandTags(_) => &["SELECT * FROM hand_tag WHERE run_path = ?1 ORDER BY id"],
            Subject::File(_) => &["SELECT * FROM source_file WHERE path = ?1"],
            Subject::Alarms => &["SELECT * FROM alarm ORDER BY id"],
            Subject::JournalEnd => &[
                "SELECT * FROM journal_line ORDER BY n DESC LIMIT 1",
                "SELECT * FROM journal_line WHERE is_lost = 1 ORDER BY n",
            ],
            Subject::Changes => &["SELECT * FROM change_count"],
        }
    }

    /// Everything that a database holds.
    pub fn all(connection: &Connection) -> rusqlite::Result<Vec<Subject>> {
        use Subject as S;
        let mut all = vec![
            S::Runs,
            S::RunWords,
            S::AskedFits,
            S::Marks,
            S::SameReadings,
            S::Logs,
            S::Assessment,
            S::Alarms,
            S::JournalEnd,
            S::Changes,
        ];
        let mut of_ids = |table: &str, of: &[fn(i64) -> Subject]| -> rusqlite::Result<()> {
            let mut statement = connection.prepare(&format!("SELECT id FROM {table} ORDER BY id"))?;
            for id in statement.query_map([], |row| row.get(0))? {
                let id = id?;
                all.extend(of.iter().map(|of| of(id)));
            }
            Ok(())
        };
        of_ids("run", &[S::Run, S::Readings, S::ClimateCurves])?;
        of_ids("climate_log", &[S::Log])?;
        let mut statement = connection.prepare("SELECT log_id, ordinal FROM climate_series")?;
        for series in statement.query_map([], |row| Ok(S::Series(row.get(0)?, row.get(1)?)))? {
            all.push(series?);
        }
        for (sql, of) in [
            (
                "SELECT DISTINCT run_path FROM hand_tag",
                S::HandTags as fn(String) -> Subject,
            ),
            ("SELECT path FROM source_file", S::File as fn(String) -> Subject),
        ] {
            for path in connection.prepare(sql)?.query_map([], |row| row.get(0))? {
                all.push(of(path?));
            }
        }
        Ok(all)
    }
}

impl fmt::Display for Subject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Subject::Runs => write!(f, "the list of runs"),
            Subject::RunWords => write!(f, "what was said of runs"),
            Subject::AskedFits => write!(f, "how runs were asked to be fitted"),
            Subject::Marks => write!(f, "the marks of readings"),
            Subject::SameReadings => write!(f, "the list of runs with the same readings"),
            Subject::Logs => write!(f, "the list of climate logs"),
            Subject::Assessment => write!(f, "what the climate logs come to"),
            Subject::Alarms => write!(f, "the list of alarms that were told"),
            Subject::JournalEnd => write!(f, "the end of the journal in it"),
            Subject::Changes => write!(f, "the count of changes"),
            Subject::HandTags(path) => write!(f, "what was tagged by hand of {path}"),
            Subject::File(path) => write!(f, "what is known of the file {path}"),
            Subject::Series(log, ordinal) => write!(f, "series {ordinal} of climate log {log}"),
            other => match other.id() {
                Value::Integer(id) => write!(f, "{} {id}", other.name()),
                _ => write!(f, "{}", other.name()),
            },
        }
    }
}
