//! The verb `explain`: the runs, files, fits and versions behind one cell of a table.

use crate::domain::Estimate;
use crate::domain::number::significant;
use crate::domain::words::counted;
use schemars::JsonSchema;
use serde::Serialize;

use super::tables::{TableData, find_table};
use crate::analysis::tables::{Cell, Content, Source, SourceOrigin, Table};
use crate::domain::{Fit, ModelScore, ModulusAnalysis, RunComparison, RunFile, RunRecord};
use crate::pipeline::{Context, PipelineError};
use crate::report::tables::text_of;
use crate::store::{ResultDocument, ResultKind, ResultOrigin, StoredDiagnosis};

/// The document that `ieap explain --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Explanation {
    /// Always `ieap/explain/1`.
    pub schema: &'static str,
    /// Name of the table.
    pub table: String,
    /// Label of the row.
    pub row: String,
    /// Key of the column.
    pub column: String,
    /// What the column shows.
    pub quantity: String,
    /// Its unit.
    pub unit: String,
    /// The cell as it is printed.
    pub text: String,
    /// How its number came about, in words.
    pub how: String,
    /// The number without rounding; null where the cell has none.
    pub value: Option<f64>,
    /// Its standard error.
    pub standard_error: Option<f64>,
    /// Lower end of its 95 % interval, or lower bound.
    pub low_95: Option<f64>,
    /// Upper end.
    pub high_95: Option<f64>,
    /// Footnotes of the cell.
    pub notes: Vec<String>,
    /// What holds for the whole table.
    pub remarks: Vec<String>,
    /// What it was made from.
    pub from: Vec<Evidence>,
    /// Version of the program that explains, and state of the database.
    pub origin: String,
}

/// One thing that a cell was made from.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Evidence {
    /// `run`, `modulus log`, `diagnosis` or `file`.
    pub kind: &'static str,
    /// Path of the run or file, name of the group.
    pub name: String,
    /// Revision of the run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub revision: Option<u32>,
    /// Raw files with the BLAKE3 of their bytes: under that hash they lie in the archive.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<RunFile>,
    /// Format that they were read with, and version of the reader.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reader: Option<String>,
    /// Hash of the readings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub data_hash: Option<String>,
    /// The fit, analysis or diagnosis.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub result: Option<ResultEvidence>,
    /// Key of the stored number that was taken.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub key: Option<String>,
    /// That number, in the unit that the key names.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub estimate: Option<Estimate>,
    /// Why it was left out of the cell.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left_out: Option<String>,
}

/// A stored result.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ResultEvidence {
    /// Row id in the database; null for a diagnosis and for a comparison of models, which are told by their hashes.
    pub id: Option<i64>,
    /// Model or analysis, with its version.
    pub model: String,
    /// Hash of everything that it depends on.
    pub input_hash: String,
    /// Version of the program that made it.
    pub code_version: String,
    /// Commit that it was built from.
    pub built_from: String,
    /// When, RFC 3339 UTC.
    pub made_at: String,
}

/// Rows and columns of a table, to choose from.
///
/// # Errors
/// There is no table of that name, or the database cannot be read.
pub fn rows_and_columns(context: &Context, name: &str) -> Result<Table, PipelineError> {
    super::tables::table(context, name)
}

/// Explains the cell of `name` in the row and column that are given by number, label, key or a part of them.
///
/// # Errors
/// There is no such table, row or column (the message lists those there are), or the database cannot be read.
pub fn explain(context: &Context, name: &str, row: &str, column: &str) -> Result<Explanation, PipelineError> {
    let named = find_table(name)?;
    let data = TableData::current(context)?.read_for(context, named)?;
    let table = data.table(context, named);
    let row = table.row_named(row).map_err(PipelineError::NotInTable)?;
    let column = table.column_named(column).map_err(PipelineError::NotInTable)?;
    let (row, column, cell) = (
        &table.rows[row],
        &table.columns[column],
        &table.rows[row].cells[column],
    );
    let from = cell.sources.iter().map(|source| evidence(context, &data, source));
    let from: Result<Vec<Evidence>, PipelineError> = from.collect();
    let numbers = numbers(&cell.content);
    Ok(Explanation {
        schema: "ieap/explain/1",
        table: table.name.clone(),
        row: row.label.clone(),
        column: column.key.clone(),
        quantity: column.quantity.clone(),
        unit: column.unit.clone(),
        text: text_of(&cell.content),
        how: how(cell),
        value: numbers[0],
        standard_error: numbers[1],
        low_95: numbers[2],
        high_95: numbers[3],
        notes: cell
            .notes
            .iter()
            .filter_map(|&note| table.notes.get(note).cloned())
            .collect(),
        remarks: table.remarks.clone(),
        from: from?,
        origin: table.origin.clone(),
    })
}

fn numbers(content: &Content) -> [Option<f64>; 4] {
    match content {
        Content::Exact(number) | Content::Rough(number, _) | Content::Score(number) => {
            [Some(*number), None, None, None]
        }
        Content::Measured(measured) => [
            Some(measured.value),
            measured.standard_error,
            measured.low_95,
            measured.high_95,
        ],
        Content::Bound { low, high } => [None, None, *low, *high],
        Content::Text(_) | Content::NotDetermined | Content::Missing => [None; 4],
    }
}

fn how(cell: &Cell) -> String {
    match &cell.content {
        Content::Measured(measured) => match &measured.pooled {
            None => "the estimate of one run".to_owned(),
            Some(mean) => {
                let spread = |sd: Option<f64>| sd.map_or("not known".to_owned(), |sd| significant(sd, 3));
                format!(
                    "random-effects mean of {} of {}; standard error from the fits alone {}, standard deviation between runs {}, between samples {}",
                    counted(mean.runs, "run"),
                    counted(mean.samples, "sample"),
                    significant(mean.fit_standard_error, 3),
                    spread(mean.between_runs),
                    spread(mean.between_samples)
                )
            }
        },
        Content::Bound { .. } => "the bound that holds for every run".to_owned(),
        Content::NotDetermined => "no run determines it".to_owned(),
        Content::Missing => "nothing was measured, or the run has no such number".to_owned(),
        Content::Score(_) => "mean of the runs' coefficients of determination".to_owned(),
        Content::Text(_) | Content::Exact(_) | Content::Rough(..) => {
            "a tag, a count, or words that follow from the numbers below by the table's rules".to_owned()
        }
    }
}

fn evidence(context: &Context, data: &TableData, source: &Source) -> Result<Evidence, PipelineError> {
    let bare = Evidence {
        kind: "file",
        name: source.name.clone(),
        revision: None,
        files: vec![],
        reader: None,
        data_hash: None,
        result: None,
        key: source.key.clone(),
        estimate: source.estimate.clone(),
        left_out: source.left_out.clone(),
    };
    Ok(match source.origin {
        SourceOrigin::File | SourceOrigin::Strip => bare,
        SourceOrigin::Diagnosis => Evidence {
            kind: "diagnosis",
            result: diagnosis(context, &source.name)?,
            ..bare
        },
        SourceOrigin::Run(id) => {
            let run = data.run(id);
            let fit = run.and_then(|run| run.fit.as_ref());
            let model = fit.map(|fit| format!("{} v{}", fit.model, fit.model_version));
            let origin = origin::<Fit>(context, ResultKind::Fit, run)?;
            Evidence {
                kind: "run",
                result: model.zip(origin).map(|(model, origin)| result(model, origin)),
                ..of_run(bare, run)
            }
        }
        SourceOrigin::Comparison(id) => {
            let compared = data.comparison(&source.name).map(models_of);
            let origin = origin::<RunComparison>(context, ResultKind::Comparison, data.run(id))?;
            let result = compared.zip(origin).map(|(model, origin)| ResultEvidence {
                id: None,
                ..result(model, origin)
            });
            Evidence {
                kind: "run",
                result,
                ..of_run(bare, data.run(id))
            }
        }
        SourceOrigin::ModulusLog(id) => {
            let log = data.modulus_log(id);
            let analysis = log.and_then(|log| log.analysis.as_ref());
            let model = analysis.map(|found| format!("modulus analysis v{}", found.version));
            let origin = origin::<ModulusAnalysis>(context, ResultKind::Modulus, log.map(|log| &log.run))?;
            Evidence {
                kind: "modulus log",
                result: model.zip(origin).map(|(model, origin)| result(model, origin)),
                ..of_run(bare, log.map(|log| &log.run))
            }
        }
    })
}

/// The models that were held against each other on a run.
fn models_of(compared: &RunComparison) -> String {
    let one = |score: &ModelScore| format!("{} v{}", score.model, score.version);
    let models: Vec<String> = compared.models.iter().map(one).collect();
    format!("comparison of {}", models.join(", "))
}

fn of_run(bare: Evidence, run: Option<&RunRecord>) -> Evidence {
    let Some(run) = run else { return bare };
    Evidence {
        revision: Some(run.revision),
        files: run.files.clone(),
        reader: Some(format!("{} v{}", run.format, run.reader_version)),
        data_hash: Some(run.data_hash.clone()),
        ..bare
    }
}

/// Where the current result of a run came from.
fn origin<T: ResultDocument>(
    context: &Context,
    kind: ResultKind,
    run: Option<&RunRecord>,
) -> Result<Option<ResultOrigin>, PipelineError> {
    let Some(run) = run else { return Ok(None) };
    Ok(context
        .store
        .result::<T>(kind, &run.path)?
        .map(|stored| stored.origin))
}

fn result(model: String, origin: ResultOrigin) -> ResultEvidence {
    ResultEvidence {
        id: Some(origin.id),
        model,
        input_hash: origin.key,
        code_version: origin.made_by.version.into_owned(),
        built_from: origin.made_by.built_from.into_owned(),
        made_at: origin.made_at,
    }
}

fn diagnosis(context: &Context, group: &str) -> Result<Option<ResultEvidence>, PipelineError> {
    let stored = context.store.diagnoses()?;
    let found = stored
        .into_iter()
        .find(|d| d.kind == ResultKind::Group && d.origin.name == group);
    Ok(found.map(
        |StoredDiagnosis {
             origin, diagnosed, ..
         }| {
            let model = format!(
                "diagnosis of {}, seed {}, {} draws",
                diagnosed.found.base_model, diagnosed.seed, diagnosed.draws
            );
            ResultEvidence {
                id: None,
                ..result(model, origin)
            }
        },
    ))
}
