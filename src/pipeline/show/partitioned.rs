//! Runs as a folder of Parquet files, one row a run, in the partitions that Hive began and Spark, DuckDB and pandas know:
//! `material=CNaf/environment=air/part-0.parquet`.

use std::collections::BTreeMap;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use super::export::about;
use crate::analysis::ExportError;
use crate::analysis::run_rows::{RunRow, RunRowWriter, Task};
use crate::domain::RunRecord;
use crate::domain::tag::keys;
use crate::fit::Steps;
use crate::pipeline::campaign::standing;
use crate::pipeline::fits::instruments::{NoiseOfOthers, Told};
use crate::pipeline::fits::plan::{Planned, fit_plan};
use crate::pipeline::fits::runs::FitRuns;
use crate::pipeline::infra::own_folder::{self, Fresh};
use crate::pipeline::{Context, PipelineError, failed};
use crate::system::fs;

/// Runs written between two looks at memory: a row group.
const BATCH: usize = 64;
/// The partition of runs for which nothing is stated, as Hive names it.
const NOTHING: &str = "__HIVE_DEFAULT_PARTITION__";

/// `ieap export --what traces --partitioned`.
#[derive(Debug, Clone)]
pub struct ExportPartitioned {
    /// Folder to write.
    pub folder: PathBuf,
    /// Whether one that is there, and that the program wrote, is replaced.
    pub overwrite: bool,
}

impl ExportPartitioned {
    /// Writes every run that results are made from; gives how many. The folder appears whole or not at all.
    ///
    /// # Errors
    /// The folder is there, or holds what the program did not write; the disk refuses.
    pub fn run(&self, context: &Context) -> Result<usize, PipelineError> {
        if self.folder.exists() && !self.overwrite {
            return Err(PipelineError::FileExists {
                path: self.folder.clone(),
            });
        }
        let nobodys = |_: &Path| false;
        own_folder::check(&self.folder, &nobodys)?;
        let parent = match self.folder.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
            _ => PathBuf::from("."),
        };
        let fresh = Fresh::begin(&parent, ".traces-").map_err(self.failed())?;
        let runs = standing::speaking(context)?;
        let tasks = tasks(context)?;
        for (partition, of_partition) in partitions(context, &runs) {
            let path = fresh.path().join(partition);
            fs::create_dir_all(&path).map_err(self.failed())?;
            self.write(context, &of_partition, &tasks, &path.join("part-0.parquet"))?;
        }
        fresh.finish().map_err(self.failed())?;
        fresh.put(&self.folder, &nobodys)?;
        Ok(runs.len())
    }

    fn failed(&self) -> impl Fn(std::io::Error) -> PipelineError + use<> {
        failed(&self.folder, "writing traces")
    }

    fn write(
        &self,
        context: &Context,
        runs: &[&RunRecord],
        tasks: &BTreeMap<String, Result<Task, String>>,
        path: &Path,
    ) -> Result<(), PipelineError> {
        let file = fs::OpenOptions::own()
            .write(true)
            .create_new(true)
            .open(path)
            .map_err(self.failed())?;
        let mut file = fill(context, runs, tasks, BufWriter::new(file))?;
        file.flush().map_err(self.failed())
    }
}

/// The bytes of one Parquet file with the runs of these names, one row a run; none named: of every run that results are made
/// from. What [`ExportPartitioned`] writes, without its folders.
///
/// # Errors
/// A name is that of no such run, or the database cannot be read.
pub fn run_rows_parquet(context: &Context, named: Option<&[String]>) -> Result<Vec<u8>, PipelineError> {
    let runs = standing::speaking(context)?;
    let one = |name: &String| {
        let found = runs.iter().find(|run| run.path == *name);
        found.ok_or_else(|| {
            PipelineError::bad_argument("runs", format!("{name:?}"), "runs that results are made from")
        })
    };
    let chosen: Vec<&RunRecord> = match named {
        Some(named) => named.iter().map(one).collect::<Result<_, _>>()?,
        None => runs.iter().collect(),
    };
    fill(context, &chosen, &tasks(context)?, Vec::new())
}

/// Writes runs into one file, a few at a time.
fn fill<W: Write>(
    context: &Context,
    runs: &[&RunRecord],
    tasks: &BTreeMap<String, Result<Task, String>>,
    out: W,
) -> Result<W, PipelineError> {
    let encoding = |source| {
        PipelineError::Export(ExportError::Table {
            table: "traces".to_owned(),
            source,
        })
    };
    let mut writer = RunRowWriter::begin(out, &about(context, "traces")).map_err(encoding)?;
    for batch in runs.chunks(BATCH) {
        let rows = batch.iter().map(|run| row(context, run, tasks));
        let rows: Vec<RunRow<'_>> = rows.collect::<Result<_, _>>()?;
        writer.write(&rows).map_err(encoding)?;
    }
    writer.finish().map_err(encoding)
}

fn row<'a>(
    context: &Context,
    run: &'a RunRecord,
    tasks: &BTreeMap<String, Result<Task, String>>,
) -> Result<RunRow<'a>, PipelineError> {
    let why_not = || {
        let said: Vec<&str> = run.issues.iter().map(|issue| issue.message.as_str()).collect();
        if said.is_empty() {
            format!(
                "the run is {} and is not fitted by itself",
                run.state.key().replace('_', " ")
            )
        } else {
            said.join("; ")
        }
    };
    let channels = context.store.channels(run.id)?;
    let is_along = channels.iter().any(|channel| channel.position_mm.is_some());
    let task = match tasks.get(&run.path) {
        Some(_) if is_along => {
            Err("readings along the strip are not in this table: fit the run in the campaign".to_owned())
        }
        Some(task) => task.clone(),
        None => Err(why_not()),
    };
    Ok(RunRow { run, channels, task })
}

/// How each run is fitted, by its name.
fn tasks(context: &Context) -> Result<BTreeMap<String, Result<Task, String>>, PipelineError> {
    let plan = fit_plan(context, &FitRuns::default().choice.asked())?;
    let told = Told::default();
    let task = |planned: Planned| {
        let input_hash = planned.input_hash();
        let of_others = told.to(context, &planned)?;
        let options = &planned.chosen.options;
        let task = Task {
            length_cm: planned.task.length_cm,
            electrode_resistance_ohm_per_sq: planned.task.electrode_resistance_ohm_per_sq,
            electrode_resistance_error_ohm_per_sq: planned.task.electrode_resistance_error_ohm_per_sq,
            input_hash,
            model: options.model.id.to_owned(),
            method: options.method.id().to_owned(),
            simultaneous: options.steps == Steps::Simultaneous,
            instrument_noise: in_a_cell(&of_others)?,
        };
        let task = if planned.known().is_empty() {
            Ok(task)
        } else {
            Err(
                "what is known of its parameters is not in this table: fit the run in the campaign"
                    .to_owned(),
            )
        };
        Ok((planned.task.path, task))
    };
    plan.single.into_iter().map(task).collect()
}

/// What others tell of a run's noise, as JSON; none where nobody does.
fn in_a_cell(of_others: &NoiseOfOthers) -> Result<Option<String>, PipelineError> {
    if of_others.made_from.is_empty() {
        return Ok(None);
    }
    let text = serde_json::to_string(of_others).map_err(|source| PipelineError::Fault {
        step: "what other runs tell of a run's noise".to_owned(),
        reason: source.to_string(),
    })?;
    Ok(Some(text))
}

/// Runs by the folder of their partition.
fn partitions<'a>(context: &Context, runs: &'a [RunRecord]) -> BTreeMap<PathBuf, Vec<&'a RunRecord>> {
    let mut partitions: BTreeMap<PathBuf, Vec<&RunRecord>> = BTreeMap::new();
    for run in runs {
        let sample = run.tag(keys::SAMPLE).and_then(|id| context.campaign.sample(id));
        let material = sample.map(|sample| sample.material.as_str());
        let folder = PathBuf::from(format!("material={}", value(material)))
            .join(format!("environment={}", value(run.tag(keys::ENVIRONMENT))));
        partitions.entry(folder).or_default().push(run);
    }
    partitions
}

/// A value as part of a folder's name: what a path or a reader of partitions would misread is written `%2F`, as Hive does.
fn value(text: Option<&str>) -> String {
    let Some(text) = text.filter(|text| !text.is_empty()) else {
        return NOTHING.to_owned();
    };
    let is_special = |c: char| c.is_control() || "\"#%'*/:<>=?\\{}[]^|\u{7f}".contains(c);
    let escaped = text.chars().map(|c| match c {
        c if is_special(c) => c.to_string().bytes().map(|byte| format!("%{byte:02X}")).collect(),
        c => c.to_string(),
    });
    // A name of dots alone would be another folder.
    match escaped.collect::<String>() {
        dots if dots.chars().all(|c| c == '.') => dots.replace('.', "%2E"),
        name => name,
    }
}

#[cfg(test)]
mod tests {
    use super::value;

    #[test]
    fn a_partition_is_one_folder_whatever_its_value() {
        assert_eq!(value(Some("CNaf")), "CNaf");
        assert_eq!(value(Some("EMI/TFS = 1:2")), "EMI%2FTFS %3D 1%3A2");
        assert_eq!(value(Some("..")), "%2E%2E");
        assert_eq!(value(Some("õhk")), "õhk");
        assert_eq!(value(None), "__HIVE_DEFAULT_PARTITION__");
    }
}
