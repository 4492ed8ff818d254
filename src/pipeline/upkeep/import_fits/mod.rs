//! Brings results that were computed elsewhere into the campaign: each is held against its checksum and against the run that it
//! is of, a share of them is fitted again, and what holds is stored as if it had been computed here. Curves do not travel: they
//! are made where they are drawn.

mod again;
mod rows;
mod told;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use crate::domain::{AskedFit, Fit, Issue, MadeBy};
use crate::pipeline::campaign::context::CODE_VERSION;
use crate::pipeline::campaign::derived::{Holding, Inputs};
use crate::pipeline::fits::outcome::{NOT_FITTED, store};
use crate::pipeline::fits::plan::{Planned, fit_plan};
use crate::pipeline::fits::result::FitResult;
use crate::pipeline::fits::runs::Due;
use crate::pipeline::{Context, Observer, PipelineError, failed};
use crate::store::{NewResult, ResultKind, Subject};
use crate::system::fs;
use again::Again;

/// Rows stored in one step.
const BATCH: usize = 256;

/// The verb `import-fits`.
#[derive(Debug, Clone)]
pub struct ImportFits {
    /// Parquet files, or folders of them.
    pub files: Vec<PathBuf>,
}

/// What came in, and what did not.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, JsonSchema)]
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
    /// Fits among them that another version of the program made, counted by that version.
    pub of_other_versions: BTreeMap<String, usize>,
    /// Rows that were fitted again here before they were taken.
    pub fitted_again: usize,
    /// Rows that were not taken, with the reason.
    pub refused: Vec<RefusedRow>,
}

impl ImportSummary {
    fn refuse(&mut self, file: &Path, row: usize, run: Option<String>, reason: String) {
        let file = file.to_owned();
        self.refused.push(RefusedRow {
            file,
            row,
            run,
            reason,
        });
    }
}

/// A row that was not taken.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
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
    pub fn run(
        &self,
        context: &mut Context,
        observer: &dyn Observer,
    ) -> Result<ImportSummary, PipelineError> {
        let mut summary = ImportSummary::default();
        let (mut known, mut again) = (Known::default(), Again::default());
        for file in self.listed()? {
            let there = rows::read(&file)?;
            summary.files += 1;
            summary.rows += there.len();
            let mut rows = Vec::new();
            for (row, read) in (1..).zip(there) {
                let file = file.as_path();
                match read {
                    Ok(result) => rows.push(Row { file, row, result }),
                    Err((run, reason)) => summary.refuse(file, row, run, reason),
                }
            }
            let rows = of_campaign(context, rows, &mut known, &mut summary)?;
            let rows = again.held(context, rows, &mut known, &mut summary, observer)?;
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
            let failed = failed(given, "looking for results in it");
            let mut inside = Vec::new();
            for entry in fs::read_dir(given).map_err(&failed)? {
                let path = entry.map_err(&failed)?.path();
                inside.extend(
                    Some(path).filter(|path| path.extension().is_some_and(|found| found == "parquet")),
                );
            }
            inside.sort();
            if inside.is_empty() {
                return Err(PipelineError::BadArgument {
                    what: "FILES",
                    found: format!("{} without results", given.display()),
                    needed: "a folder with files that end in .parquet".to_owned(),
                });
            }
            listed.extend(inside);
        }
        Ok(listed)
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
                self.plans
                    .push((asked.clone(), fit_plan(context, asked)?.keyed()));
                self.plans.len() - 1
            }
        };
        Ok(self.plans[at].1.get(run))
    }

    /// What the fits that were asked for so far depend on now.
    fn inputs_now(&self, context: &Context) -> Result<BTreeSet<Inputs>, PipelineError> {
        let mut inputs = BTreeSet::new();
        for (asked, _) in &self.plans {
            let keyed = fit_plan(context, asked)?.keyed().into_values();
            inputs.extend(keyed.map(|(key, run)| (key, vec![run.task.run_id])));
        }
        Ok(inputs)
    }
}

/// The rows that are of runs of this campaign, as they are now, and whose results it does not have yet.
fn of_campaign<'a>(
    context: &Context,
    rows: Vec<Row<'a>>,
    known: &mut Known,
    summary: &mut ImportSummary,
) -> Result<Vec<Row<'a>>, PipelineError> {
    let stored = context.store.result_keys(ResultKind::Fit)?;
    let mut of_campaign = Vec::new();
    for row in rows {
        let reason = match known.due(context, &row.result.asked, &row.result.run) {
            Ok(Some(due)) => match is_of(due, &row.result) {
                Ok(()) if stored.get(&row.result.run) == Some(&due.0) || !known.taken.insert(row.result.run.clone()) => {
                    summary.up_to_date += 1;
                    continue;
                }
                Ok(()) => {
                    of_campaign.push(row);
                    continue;
                }
                Err(reason) => reason,
            },
            Ok(None) => "the campaign has no run of that name that is fitted by itself; needed the name as `ieap fit --json` has it".to_owned(),
            // How it was asked for makes no sense here: an unknown model is that row's fault alone.
            Err(error) if !error.is_storage() => error.to_string(),
            Err(error) => return Err(error),
        };
        summary.refuse(row.file, row.row, Some(row.result.run), reason);
    }
    Ok(of_campaign)
}

/// Stores a batch.
fn take(
    context: &mut Context,
    batch: &[Row<'_>],
    known: &mut Known,
    summary: &mut ImportSummary,
) -> Result<(), PipelineError> {
    let mut of_each = Vec::new();
    for row in batch {
        let due = known.due(context, &row.result.asked, &row.result.run)?;
        let both = due.and_then(|due| Some((due.1.clone(), row.result.outcome()?)));
        of_each.extend(both.map(|(planned, found)| (row, planned, found)));
    }
    let kept =
        Holding::of(|context: &Context| known.inputs_now(context)).step(context, |context, inputs| {
            let holds = |(row, run): (&Row, &Planned)| {
                inputs.contains(&(row.result.input_hash.clone(), vec![run.task.run_id]))
            };
            let is_so: Vec<bool> = of_each.iter().map(|(row, run, _)| holds((row, run))).collect();
            let holding = || of_each.iter().zip(&is_so).filter(|(_, is_so)| **is_so);
            let own: Vec<([i64; 1], MadeBy)> = holding()
                .map(|((row, run, _), _)| ([run.task.run_id], row.result.made_by()))
                .collect();
            let results = holding()
                .zip(&own)
                .map(|(((row, _, found), _), (ids, made_by))| NewResult {
                    of: Subject::Run(ids[0]),
                    made_from: ids,
                    key: &row.result.input_hash,
                    made_by,
                    found: *found,
                });
            let results: Vec<NewResult<'_, Fit>> = results.collect();
            let mut kept = store(context, &results, holding().map(|((_, run, _), _)| run))?.into_iter();
            let kept: Vec<bool> = is_so
                .iter()
                .map(|is_so| *is_so && kept.next() == Some(true))
                .collect();
            Ok(kept)
        })?;
    for (kept, (row, _, found)) in kept.into_iter().zip(&of_each) {
        match found {
            _ if !kept => {
                let reason = "the run changed while its fit was taken in; import it again".to_owned();
                summary.refuse(row.file, row.row, Some(row.result.run.clone()), reason);
            }
            Ok(_) => {
                summary.imported += 1;
                if row.result.code_version != CODE_VERSION {
                    *(summary.of_other_versions)
                        .entry(row.result.code_version.clone())
                        .or_default() += 1;
                }
            }
            Err(issue) => summary.failed.push((row.result.run.clone(), (*issue).clone())),
        }
    }
    Ok(())
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
    // A fault of the program elsewhere says nothing of the run.
    if let Some(issue) = result.issue.as_ref().filter(|issue| issue.code != NOT_FITTED) {
        return Err(format!("not fitted there: {}", issue.message));
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
