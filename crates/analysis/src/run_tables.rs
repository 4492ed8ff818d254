//! Runs and tags as tables for other programs.

use polars::prelude::{DataFrame, IntoColumn, NamedFrom, Series};

use super::export::{ExportError, flags, frame, numbers, run_columns, texts};
use ieap_domain::{Campaign, RunRecord, Severity, Tag};

/// One row per run: identity, tags, state, files with their hashes, quality of the fit, number of warnings.
///
/// # Errors
/// [`ExportError::Table`]: a fault of the program.
pub fn runs_table(runs: &[RunRecord], campaign: &Campaign) -> Result<DataFrame, ExportError> {
    let all: Vec<&RunRecord> = runs.iter().collect();
    let mut columns = run_columns(&all, campaign);
    let text = |name: &str, of: &dyn Fn(&RunRecord) -> Option<String>| texts(name, runs.iter().map(of));
    let fit = |name: &str, of: fn(&ieap_domain::Fit) -> Option<f64>| {
        numbers(name, runs.iter().map(|run| run.fit.as_ref().and_then(of)))
    };
    let count = |name: &str, of: fn(&ieap_domain::Fit) -> u32| {
        let counts: Vec<Option<u32>> = runs.iter().map(|run| run.fit.as_ref().map(of)).collect();
        Series::new(name.into(), counts).into_column()
    };
    let joined = |of: fn(&ieap_domain::RunFile) -> &str| {
        move |run: &RunRecord| Some(run.files.iter().map(of).collect::<Vec<_>>().join(" "))
    };
    let warnings: Vec<u32> = runs.iter().map(warnings).collect();
    let converged: Vec<Option<bool>> = runs
        .iter()
        .map(|run| run.fit.as_ref().map(|fit| fit.converged))
        .collect();
    columns.extend([
        text("state", &|run| Some(run.state.key().to_owned())),
        text("standing", &|run| Some(run.standing.key().to_owned())),
        text("standing_reason", &|run| {
            Some(run.standing.reason()).filter(|reason| !reason.is_empty())
        }),
        text("status", &|run| Some(run.status.key().to_owned())),
        text("technique", &|run| run.technique.clone()),
        text("format", &|run| Some(run.format.clone())),
        text("files", &joined(|file| &file.path)),
        text("file_hashes_blake3", &joined(|file| &file.hash)),
        text("data_hash", &|run| Some(run.data_hash.clone())),
        text("ingested_at", &|run| Some(run.ingested_at.clone())),
        numbers("area_cm2", runs.iter().map(|run| run.area_cm2)),
        count("model_version", |fit| fit.model_version),
        Series::new("converged".into(), converged).into_column(),
        count("readings_fitted", |fit| fit.n_samples as u32),
        fit("r_squared_current", |fit| fit.r_squared_current),
        fit("r_squared_curvature", |fit| fit.r_squared_curvature),
        Series::new("warnings".into(), warnings).into_column(),
    ]);
    frame("runs", columns)
}

/// Issues of a run and its fit that are more than notes.
fn warnings(run: &RunRecord) -> u32 {
    let of_fit = run.fit.iter().flat_map(|fit| &fit.issues);
    let issues = run.issues.iter().chain(of_fit);
    issues.filter(|issue| issue.severity >= Severity::Warning).count() as u32
}

/// One row per run and tag, from every source; `chosen` tells which value of a key holds.
///
/// # Errors
/// [`ExportError::Table`]: a fault of the program.
pub fn tags_table(runs: &[RunRecord]) -> Result<DataFrame, ExportError> {
    let rows: Vec<(&RunRecord, &Tag, bool)> = runs.iter().flat_map(tags).collect();
    let text = |name: &str, of: fn(&(&RunRecord, &Tag, bool)) -> String| {
        texts(name, rows.iter().map(move |row| Some(of(row))))
    };
    let columns = vec![
        text("run", |(run, ..)| run.path.clone()),
        text("key", |(_, tag, _)| tag.key.clone()),
        text("value", |(_, tag, _)| tag.value.clone()),
        text("source", |(_, tag, _)| tag.source.key().to_owned()),
        text("detail", |(_, tag, _)| tag.detail.clone()),
        flags("chosen", rows.iter().map(|(.., chosen)| *chosen)),
    ];
    frame("tags", columns)
}

/// The chosen tag of each key stands first.
fn tags(run: &RunRecord) -> impl Iterator<Item = (&RunRecord, &Tag, bool)> {
    run.tags.iter().enumerate().map(move |(at, tag)| {
        let earlier = run.tags[..at].iter().any(|other| other.key == tag.key);
        (run, tag, !earlier)
    })
}
