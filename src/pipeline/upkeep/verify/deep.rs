//! Every current number derived again: readings from the raw bytes, results from the readings.

use crate::domain::words::counted;
use crate::system::passing::Passing;
use std::collections::BTreeMap;
use std::path::Path;

use rayon::prelude::*;

use super::part::Part;
use crate::domain::data_hash::data_hash;
use crate::domain::{FileState, Issue, RunKind, RunRecord};
use crate::ingest::Reading;
use crate::ingest::climate_log;
use crate::numerics::interrupt;
use crate::pipeline::campaign::context::CODE_VERSION;
use crate::pipeline::intake::ingest::{Outcome, joined, run_parts};
use crate::pipeline::upkeep::rebuild::archived::ArchivedFiles;
use crate::pipeline::{AnalyseModulus, Context, DiagnoseRuns, FitRuns, Observer, PipelineError};
use crate::store::ResultKind;
use crate::store::journal::NamedBytes;

/// Reads the raw bytes of every current run and log again.
///
/// # Errors
/// The database cannot be read.
pub fn readings(context: &Context, observer: &dyn Observer) -> Result<Part, PipelineError> {
    let runs: Vec<RunRecord> = (context.store.runs()?.into_iter())
        .chain(context.store.dma_logs()?)
        .chain(context.store.spectra()?)
        .collect();
    let archived = ArchivedFiles::of(context);
    observer.begin("reading raw files again", runs.len() as u64);
    let found: Vec<Option<Issue>> = runs
        .par_iter()
        .map(|run| {
            let found = run_differs(&archived, run);
            observer.advance();
            found
        })
        .collect();
    observer.end();
    interrupt::check();
    let logs = logs(context)?;
    let of_logs = logs.iter().filter_map(|log| log_differs(&archived, log));
    Ok(Part {
        part: "readings",
        looked_at: format!(
            "raw bytes of {} and {} read again",
            counted(runs.len(), "run"),
            counted(logs.len(), "log")
        ),
        findings: found.into_iter().flatten().chain(of_logs).collect(),
    })
}

/// What is wrong with the readings of a run, as its raw files have them.
fn run_differs(archived: &ArchivedFiles<'_>, run: &RunRecord) -> Option<Issue> {
    let mut readings: Vec<Reading> = Vec::new();
    for file in &run.files {
        let named = NamedBytes {
            path: file.path.clone(),
            hash: file.hash.clone(),
        };
        match archived.read(&named, run.kind, &run.format) {
            Err(issue) => return Some(issue),
            Ok(prepared) => match prepared.outcome {
                Outcome::Read(reading) => readings.push(*reading),
                _ => return None,
            },
        }
    }
    let parts = match readings.as_slice() {
        [single] => run_parts(single, run.kind),
        several => vec![joined(&several.iter().collect::<Vec<_>>()).0],
    };
    let is_same = parts
        .iter()
        .any(|part| data_hash(&part.channels) == run.data_hash);
    (!is_same).then(|| differs(&run.path, run.reader_version))
}

fn differs(path: &str, reader_version: u32) -> Issue {
    let found = format!(
        "the raw bytes give other readings than are stored (they were read by version {reader_version} of the reader)"
    );
    Issue::error("readings-differ", found)
        .at(path)
        .mend("where the program is newer than the readings, the next `ieap run` reads the file anew; else report it with the file")
}

/// A current climate log.
struct StoredLog {
    file: NamedBytes,
    data_hash: String,
}

fn logs(context: &Context) -> Result<Vec<StoredLog>, PipelineError> {
    let files = context.store.files()?.into_iter();
    let hashes: BTreeMap<String, String> = files
        .filter(|file| file.state == FileState::Log)
        .filter_map(|file| Some((file.path, file.hash?)))
        .collect();
    let series = context.store.log_series()?.into_iter();
    let by_path: BTreeMap<String, String> = series.map(|series| (series.path, series.data_hash)).collect();
    let of = |(path, data_hash): (String, String)| {
        let hash = hashes.get(&path)?.clone();
        Some(StoredLog {
            file: NamedBytes { path, hash },
            data_hash,
        })
    };
    Ok(by_path.into_iter().filter_map(of).collect())
}

fn log_differs(archived: &ArchivedFiles<'_>, log: &StoredLog) -> Option<Issue> {
    let prepared = match archived.read(&log.file, RunKind::Actuation, "") {
        Ok(prepared) => prepared,
        Err(issue) => return Some(issue),
    };
    let Outcome::Read(reading) = &prepared.outcome else {
        return None;
    };
    match climate_log::log(reading, &log.file.path) {
        Ok(made) if made.data_hash() == log.data_hash => None,
        Ok(_) => Some(differs(&log.file.path, reading.reader_version)),
        Err(issue) => Some(issue.at(&log.file.path)),
    }
}

/// Makes every result again in a copy of the database, and holds the two against each other.
///
/// # Errors
/// The copy cannot be made, or a model is not known.
pub fn results(context: &Context, diagnoses: bool, observer: &dyn Observer) -> Result<Part, PipelineError> {
    let made = Passing::made(tempfile::tempdir, |folder| folder.path().to_owned());
    let (folder, _passing) = made.map_err(|source| PipelineError::File {
        path: std::env::temp_dir(),
        doing: "making a folder for a copy of the database",
        source,
    })?;
    let mut copy = copy_of(context, folder.path())?;
    let before = inputs(&copy)?;
    let fits = FitRuns {
        again: true,
        ..FitRuns::default()
    }
    .run(&mut copy, observer)?;
    let modulus = AnalyseModulus { again: true }.run(&mut copy, observer)?;
    let mut looked_at = format!(
        "{} and {} made again",
        counted(fits.fitted + fits.failed.len(), "fit"),
        counted(modulus.analysed + modulus.failed.len(), "modulus analysis")
    );
    if diagnoses {
        let again = DiagnoseRuns {
            again: true,
            ..DiagnoseRuns::default()
        };
        let found = again.run(&mut copy, observer)?;
        looked_at += &format!(", {}", counted(found.diagnosed, "diagnosis"));
    }
    let after = inputs(&copy)?;
    let differences = context.store.content()?.differences(&copy.store.content()?);
    let is_result = |kind: &str| ["fit", "modulus analysis", "diagnosis"].contains(&kind);
    let findings = differences
        .into_iter()
        .filter(|(kind, _)| is_result(kind))
        .map(|(kind, name)| {
            let part = (kind, name.clone());
            finding(kind, &name, before.get(&part) == after.get(&part))
        });
    Ok(Part {
        part: "results",
        looked_at,
        findings: findings.collect(),
    })
}

fn copy_of(context: &Context, folder: &Path) -> Result<Context, PipelineError> {
    context.with_store(context.store.copy_in(folder)?)
}

/// Hashes of what the results were made from, by kind and name.
fn inputs(context: &Context) -> Result<BTreeMap<(&'static str, String), String>, PipelineError> {
    let mut inputs = BTreeMap::new();
    for (kind, words) in [
        (ResultKind::Fit, "fit"),
        (ResultKind::Modulus, "modulus analysis"),
        (ResultKind::Group, "diagnosis"),
        (ResultKind::Run, "diagnosis"),
    ] {
        for (name, key) in context.store.result_keys(kind)? {
            let name = if words == "diagnosis" {
                format!("{} {name}", kind.key())
            } else {
                name
            };
            inputs.insert((words, name), key);
        }
    }
    Ok(inputs)
}

fn finding(kind: &'static str, name: &str, same_inputs: bool) -> Issue {
    if same_inputs {
        Issue::error(
            "result-differs",
            format!("made again by this program (version {CODE_VERSION}), the {kind} has other numbers"),
        )
        .at(name)
        .mend(
            "if another version of the program made it, `ieap fit --again` or `ieap diagnose --again` makes it \
             anew; else report it with the campaign",
        )
    } else {
        Issue::note(
            "result-out-of-date",
            format!("the {kind} was made from other readings, tags or options than hold now"),
        )
        .at(name)
        .mend("`ieap run` makes it anew")
    }
}
