//! Brings results that were computed elsewhere into the campaign: each is held against the run that it is of, and stored as if
//! it had been computed here.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::context::now;
use super::fit::{Due, FitRuns, NOT_FITTED, input_hash};
use super::fit_plan::fit_plan;
use super::fit_result::{FitResult, SCHEMA};
use super::{Context, PipelineError};
use crate::domain::{AskedFit, Fit, Issue};
use crate::ingest::parquet_texts;
use crate::store::FitStamp;
use crate::system::fs;

/// Rows stored in one step.
const BATCH: usize = 256;

/// The verb `import-fits`.
#[derive(Debug, Clone)]
pub struct ImportFits {
    /// Files (`.jsonl`, `.parquet`), or folders of them.
    pub files: Vec<PathBuf>,
}

/// What came in, and what did not.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct ImportSummary {
    /// Files read.
    pub files: usize,
    /// Rows in them.
    pub rows: usize,
    /// Fits stored.
    pub imported: usize,
    /// Rows whose result is in the campaign already.
    pub up_to_date: usize,
    /// Runs that could not be fitted elsewhere, with the reason, which is stored.
    pub failed: Vec<(String, Issue)>,
    /// Rows that were not taken, with the reason.
    pub refused: Vec<RefusedRow>,
}

/// A row that was not taken.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct RefusedRow {
    /// The file.
    pub file: PathBuf,
    /// Its row, from 1.
    pub row: usize,
    /// The run that it names; none where it names none.
    pub run: Option<String>,
    /// Why.
    pub reason: String,
}

/// A row that was read.
struct Row<'a> {
    file: &'a Path,
    row: usize,
    result: FitResult,
}

impl ImportFits {
    /// Reads every file and stores what fits the campaign's runs. A row that cannot be used stops no other.
    ///
    /// # Errors
    /// A file cannot be read at all, or the database fails.
    pub fn run(&self, context: &mut Context) -> Result<ImportSummary, PipelineError> {
        let mut summary = ImportSummary::default();
        let mut known = Known::default();
        for file in self.listed()? {
            summary.files += 1;
            let texts = rows_of(&file)?;
            let mut rows = Vec::new();
            for (at, text) in texts.into_iter().enumerate() {
                summary.rows += 1;
                match text.and_then(|text| read(&text)) {
                    Ok(result) => rows.push(Row {
                        file: &file,
                        row: at + 1,
                        result,
                    }),
                    Err((run, reason)) => summary.refused.push(RefusedRow {
                        file: file.clone(),
                        row: at + 1,
                        run,
                        reason,
                    }),
                }
            }
            for batch in rows.chunks(BATCH) {
                take(context, batch, &mut known, &mut summary)?;
            }
        }
        Ok(summary)
    }

    /// The files, those in folders by name.
    fn listed(&self) -> Result<Vec<PathBuf>, PipelineError> {
        let mut listed = Vec::new();
        for given in &self.files {
            if !given.is_dir() {
                listed.push(given.clone());
                continue;
            }
            let failed = |source| PipelineError::File {
                path: given.clone(),
                doing: "looking for results in it",
                source,
            };
            let mut inside = Vec::new();
            for entry in fs::read_dir(given).map_err(failed)? {
                let path = entry.map_err(failed)?.path();
                inside.extend(
                    Some(path)
                        .filter(|path| ["jsonl", "parquet"].iter().any(|ending| has_ending(path, ending))),
                );
            }
            inside.sort();
            if inside.is_empty() {
                return Err(PipelineError::BadArgument {
                    what: "FILES",
                    found: format!("{} without results", given.display()),
                    needed: "a folder with files that end in .jsonl or .parquet".to_owned(),
                });
            }
            listed.extend(inside);
        }
        Ok(listed)
    }
}

fn has_ending(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|found| found == ending)
}

/// Why a row cannot be used, with the run that it names.
type Refusal = (Option<String>, String);

/// The rows of a file, each as the JSON of a [`FitResult`].
fn rows_of(file: &Path) -> Result<Vec<Result<String, Refusal>>, PipelineError> {
    let bytes = fs::read(file).map_err(|source| PipelineError::File {
        path: file.to_owned(),
        doing: "reading results",
        source,
    })?;
    if has_ending(file, "parquet") {
        let table = parquet_texts::read(&bytes).map_err(|reason| PipelineError::BadArgument {
            what: "FILES",
            found: format!("{}: {reason}", file.display()),
            needed:
                "a Parquet file with the text columns run, data_hash, input_hash, code_version, fit and issue"
                    .to_owned(),
        })?;
        return Ok(table.into_iter().map(of_columns).collect());
    }
    let lines = bytes.split(|byte| *byte == b'\n');
    let is_blank = |line: &&[u8]| line.iter().all(u8::is_ascii_whitespace);
    let text = |line: &[u8]| {
        String::from_utf8(line.to_vec()).map_err(|_| {
            (
                None,
                "found bytes that are no UTF-8; needed a line of JSON".to_owned(),
            )
        })
    };
    Ok(lines.filter(|line| !is_blank(line)).map(text).collect())
}

/// A row of texts by column as the JSON of a [`FitResult`]: `fit`, `issue` and `asked` hold JSON themselves.
fn of_columns(columns: BTreeMap<String, String>) -> Result<String, Refusal> {
    let run = columns.get("run").cloned();
    let mut object = serde_json::Map::new();
    object.insert("schema".to_owned(), SCHEMA.into());
    for (name, text) in columns {
        let value = match name.as_str() {
            "fit" | "issue" | "asked" => serde_json::from_str(&text)
                .map_err(|error| (run.clone(), format!("column {name}: {error}; needed JSON")))?,
            _ => text.into(),
        };
        object.insert(name, value);
    }
    Ok(serde_json::Value::Object(object).to_string())
}

fn read(text: &str) -> Result<FitResult, Refusal> {
    let result: FitResult = serde_json::from_str(text).map_err(|error| {
        let read: Option<serde_json::Value> = serde_json::from_str(text).ok();
        let run = read
            .as_ref()
            .and_then(|value| value["run"].as_str())
            .map(str::to_owned);
        (run, format!("{error}; needed a result of a fit ({SCHEMA})"))
    })?;
    let refused = |reason: &str| Err((Some(result.run.clone()), reason.to_owned()));
    match result.outcome() {
        _ if result.schema != SCHEMA => {
            refused(&format!("found schema {:?}, needed {SCHEMA:?}", result.schema))
        }
        None => refused("needed either a fit or an issue that says why there is none"),
        Some(_) => Ok(result),
    }
}

/// What the campaign would fit, by how it is asked for; and what came in already.
#[derive(Default)]
struct Known {
    plans: Vec<(AskedFit, BTreeMap<String, Due>)>,
    taken: BTreeSet<String>,
}

impl Known {
    /// How the campaign would fit that run where it is asked for like this.
    fn due(&mut self, context: &Context, asked: &AskedFit, run: &str) -> Result<Option<&Due>, PipelineError> {
        let at = match self.plans.iter().position(|(known, _)| known == asked) {
            Some(at) => at,
            None => {
                let plan = fit_plan(context, asked, &BTreeMap::new())?;
                let hashed = plan.single.into_iter().map(|planned| {
                    let hash = input_hash(&planned.task, &planned.chosen.options);
                    (planned.task.path.clone(), (hash, planned))
                });
                self.plans.push((asked.clone(), hashed.collect()));
                self.plans.len() - 1
            }
        };
        Ok(self.plans[at].1.get(run))
    }
}

/// Stores what of a batch is of this campaign.
fn take(
    context: &mut Context,
    batch: &[Row<'_>],
    known: &mut Known,
    summary: &mut ImportSummary,
) -> Result<(), PipelineError> {
    let now = now();
    let mut fits: Vec<(FitStamp, Fit)> = Vec::new();
    for Row { file, row, result } in batch {
        let already = known.taken.contains(&result.run);
        let mut refuse = |reason: String| {
            summary.refused.push(RefusedRow {
                file: file.to_path_buf(),
                row: *row,
                run: Some(result.run.clone()),
                reason,
            });
        };
        let due = match known.due(context, &result.asked, &result.run) {
            Ok(Some(due)) => due,
            Ok(None) => {
                refuse("the campaign has no run of that name that is fitted by itself; needed the name as `ieap fit --json` has it".to_owned());
                continue;
            }
            // How it was asked for makes no sense here: an unknown model is that row's fault alone.
            Err(error) if !error.is_storage() => {
                refuse(error.to_string());
                continue;
            }
            Err(error) => return Err(error),
        };
        if let Err(reason) = is_of(due, result) {
            refuse(reason);
            continue;
        }
        if already || FitRuns::default().is_done(due) {
            summary.up_to_date += 1;
            continue;
        }
        let stamp = FitStamp {
            run_id: due.1.task.run_id,
            input_hash: result.input_hash.clone(),
            code_version: result.code_version.clone(),
            asked: due.1.chosen.asked.clone(),
        };
        match (&result.fit, &result.issue) {
            (Some(fit), _) => fits.push((stamp, fit.clone())),
            // A fault of the program elsewhere says nothing of the run.
            (None, Some(issue)) if issue.code != NOT_FITTED => {
                refuse(format!("not fitted there: {}", issue.message));
                continue;
            }
            (None, Some(issue)) => {
                context.store.save_fit_failure(&now, &stamp, issue)?;
                summary.failed.push((result.run.clone(), issue.clone()));
            }
            (None, None) => {}
        }
        known.taken.insert(result.run.clone());
    }
    summary.imported += fits.len();
    Ok(context.store.save_fits(&now, &fits)?)
}

/// Whether a result is of that run as it is now, fitted as the campaign would fit it.
fn is_of((hash, planned): &Due, result: &FitResult) -> Result<(), String> {
    if result.data_hash != planned.task.data_hash {
        return Err("the run's readings are others now (data_hash differs); fit it again".to_owned());
    }
    if result.input_hash != *hash {
        return Err(
            "the run's drive, dimensions, model or method are others now (input_hash differs); fit it again"
                .to_owned(),
        );
    }
    let Some(fit) = &result.fit else { return Ok(()) };
    let model = planned.chosen.options.model;
    if (fit.model.as_str(), fit.model_version) != (model.id, model.version) {
        return Err(format!(
            "found a fit of {} version {}, needed {} version {}",
            fit.model, fit.model_version, model.id, model.version
        ));
    }
    if fit.parameters.is_empty() {
        return Err("found a fit without parameters".to_owned());
    }
    let unknown = |key: &str| !model.parameters.iter().any(|known| known.key == key);
    match fit.parameters.iter().find(|parameter| unknown(&parameter.key)) {
        Some(parameter) => Err(format!(
            "found the parameter {:?}, which {} has not",
            parameter.key, model.id
        )),
        None => Ok(()),
    }
}
