//! Writes tables for other programs.

use std::path::{Path, PathBuf};

use super::columns::columns_table;
use super::found_tables;
pub use crate::analysis::TableFormat;
use crate::analysis::dma::table::modulus_table;
use crate::analysis::laws::doubt::{Doubts, Findings};
use crate::analysis::laws::facts::facts;
use crate::analysis::monitoring::{Evidence, Monitoring, monitor};
use crate::analysis::{self, About, ExportError, TraceWriter, run_tables, tables, traces};
use crate::domain::{Campaign, ModulusLog, RunRecord, string_enum};
use crate::pipeline::campaign::context::CODE_VERSION;
use crate::pipeline::campaign::standing;
use crate::pipeline::findings::current::{CurrentFindings, current_findings};
use crate::pipeline::findings::kept;
use crate::pipeline::findings::model_free::{WithoutModel, without_model};
use crate::pipeline::findings::study::{self, Study};
use crate::pipeline::infra::fault::step;
use crate::pipeline::infra::whole_file::put_file;
use crate::pipeline::{Context, PipelineError, failed};
use crate::show::Frame;
use crate::system::passing::Passing;

string_enum! {
    /// What can be written.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Table {
        /// Runs.
        Runs = "runs" => "One row a run: tags, state, files with hashes, quality of the fit",
        /// Tags.
        Tags = "tags" => "One row a run and tag, with its source",
        /// Parameters.
        Fits = "fits" => "One row a run and parameter: value, standard error, interval",
        /// The same, side by side.
        FitsWide = "fits-wide" => "One row a run, parameters side by side",
        /// Conditions.
        Conditions = "conditions" => "One row a condition: runs, mean and spread of each parameter",
        /// Readings.
        Traces = "traces" => "One row a reading",
        /// Modulus logs.
        Dma = "dma" => "One row a modulus log, humidity step and number",
        /// Findings.
        Findings = "findings" => "One row a finding of the diagnosis, of a group of runs or of a run by itself, with the gain on held-out readings",
        /// Laws.
        Laws = "laws" => "One row a law that was asked for: its change over the range, per unit, and of the material",
        /// Long-term monitoring.
        Monitoring = "monitoring" => "One row a sample and parameter that is watched",
        /// Numbers without a model.
        ModelFree = "model-free" => "One row a run whose voltage is stepped and held: numbers without a model, energies",
        /// Trains.
        Cycles = "cycles" => "One row a cycle of a train",
        /// Columns.
        Columns = "columns" => "One row a column of the others, with unit and meaning",
    }
}

/// The verb `export`.
#[derive(Debug, Clone)]
pub struct Export {
    /// What to write.
    pub table: Table,
    /// Where to; the ending tells the format.
    pub path: PathBuf,
    /// How; by the ending of the file where nothing is said.
    pub format: Option<TableFormat>,
    /// Whether a file that is there may be written over.
    pub overwrite: bool,
}

impl Export {
    /// Writes the table; gives the number of rows. The file appears whole or not at all.
    ///
    /// # Errors
    /// The ending is not known, a file is there already, or the disk refuses.
    pub fn run(&self, context: &Context) -> Result<usize, PipelineError> {
        let format = self.format.map_or_else(|| format_of(&self.path), Ok)?;
        if self.path.exists() && !self.overwrite {
            return Err(PipelineError::FileExists {
                path: self.path.clone(),
            });
        }
        if (self.table, format) == (Table::Traces, TableFormat::Json) {
            return Err(PipelineError::BadArgument {
                what: "--output",
                found: self.path.display().to_string(),
                needed: "a file that ends in .parquet or .csv: readings are too many for JSON".to_owned(),
            });
        }
        put_file(&self.path, self.overwrite, |part| {
            self.write(context, format, part)
                .map_err(|error| self.of_target(error))
        })
    }

    /// The file that a user knows in place of the temporary.
    fn of_target(&self, error: PipelineError) -> PipelineError {
        match error {
            PipelineError::Export(ExportError::Write { source, .. }) => failed(&self.path, "writing")(source),
            error => error,
        }
    }

    /// The table as bytes, for who hands it on.
    ///
    /// # Errors
    /// As of [`Export::run`].
    pub fn bytes(
        context: &Context,
        table: Table,
        format: TableFormat,
    ) -> Result<(Vec<u8>, usize), PipelineError> {
        let failed = failed(&std::env::temp_dir(), "writing what goes to stdout");
        let made = Passing::made(tempfile::tempdir, |folder| folder.path().to_owned());
        let (folder, _passing) = made.map_err(&failed)?;
        let export = Export {
            table,
            path: folder.path().join(table.key()),
            format: Some(format),
            overwrite: false,
        };
        let rows = export.run(context)?;
        Ok((crate::system::fs::read(&export.path).map_err(failed)?, rows))
    }

    fn write(&self, context: &Context, format: TableFormat, path: &Path) -> Result<usize, PipelineError> {
        let about = about(context, self.table.key());
        if self.table == Table::Traces {
            let mut writer = TraceWriter::create(path, format, &about)?;
            for run in &standing::runs(context)?.speaking {
                writer.write(&run.path, &context.store.channels(run.id)?)?;
            }
            return Ok(writer.finish()?);
        }
        let frame = self.table.frame(context)?;
        analysis::write_table(&frame, format, &about, path)?;
        Ok(frame.first().map_or(0, |column| column.cells.len()))
    }
}

impl Table {
    /// The table as it is now; none of readings, which are too many for memory.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn frame(self, context: &Context) -> Result<Frame, PipelineError> {
        let all = standing::all(context)?;
        let runs = speaking(&all);
        let mut made = Made::default();
        match self {
            Table::Dma => made.logs = standing::modulus_logs(context)?.0,
            Table::Findings | Table::Laws | Table::Monitoring => made.found = current_findings(context)?,
            Table::ModelFree | Table::Cycles => {
                made.without_model = without_model(context, &runs, &kept::values(context))?;
            }
            _ => {}
        }
        if self == Table::Laws {
            made.study = study::of_runs(context, &runs, &made.found, &[], &kept::values(context));
        }
        if self == Table::Monitoring {
            let facts = facts(&runs, &context.campaign);
            let findings = Findings {
                groups: &made.found.groups,
                runs: &made.found.runs,
            };
            let evidence = Evidence {
                runs: &runs,
                campaign: &context.campaign,
                facts: &facts,
                doubts: &Doubts::new(findings, &runs),
            };
            made.monitoring = step("monitoring", || Ok(monitor(evidence)))?;
        }
        Ok(self.of(&all, &context.campaign, &made))
    }

    /// The table of these runs alone, of no campaign.
    #[cfg(test)]
    pub(super) fn of_runs(self, runs: &[RunRecord]) -> Frame {
        self.of(runs, &crate::domain::testing::campaign(), &Made::default())
    }

    /// The table of these runs, and of what was made from them.
    fn of(self, all: &[RunRecord], campaign: &Campaign, made: &Made) -> Frame {
        // The list of runs and their tags hold every run, results only those that speak.
        let runs = speaking(all);
        match self {
            Table::Runs => run_tables::runs_table(all, campaign),
            Table::Tags => run_tables::tags_table(all),
            Table::Fits => run_tables::fits_long(&runs, campaign),
            Table::FitsWide => run_tables::fits_wide(&runs, campaign),
            Table::Conditions => run_tables::conditions_table(&runs, campaign),
            Table::Traces => traces::head(),
            Table::Dma => modulus_table(&made.logs, campaign),
            Table::Findings => {
                found_tables::findings_table((&made.found.groups, &made.found.runs), &runs, campaign)
            }
            Table::Laws => found_tables::laws_table(&made.study),
            Table::Monitoring => found_tables::monitoring_table(&made.monitoring),
            Table::ModelFree => tables::model_free::frame(&made.without_model.steps, &runs, campaign),
            Table::Cycles => tables::cycles::frame(&made.without_model.trains, &runs, campaign),
            Table::Columns => {
                // Which columns there are, the runs tell; what was made from them only fills rows.
                let others = Table::ALL.into_iter().filter(|table| *table != Table::Columns);
                let head = |table: Table| (table.key(), table.of(all, campaign, &Made::default()));
                let own = (Table::Columns.key(), columns_table(Vec::new()));
                columns_table(others.map(head).chain([own]).collect())
            }
        }
    }
}

/// What tables are made from beside the runs.
#[derive(Default)]
struct Made {
    logs: Vec<ModulusLog>,
    found: CurrentFindings,
    study: Study,
    monitoring: Monitoring,
    without_model: WithoutModel,
}

fn speaking(all: &[RunRecord]) -> Vec<RunRecord> {
    let speaking = all.iter().filter(|run| run.standing.speaks());
    speaking.cloned().collect()
}

/// What a Parquet file says of itself.
pub(crate) fn about(context: &Context, table: &str) -> About {
    let campaign = &context.campaign;
    let mut about = About::from([
        ("ieap.table".to_owned(), table.to_owned()),
        ("ieap.campaign".to_owned(), campaign.id.clone()),
        ("ieap.title".to_owned(), campaign.title.clone()),
        ("ieap.program".to_owned(), format!("ieap {CODE_VERSION}")),
    ]);
    let notice = campaign.notice.iter().cloned();
    about.extend(notice.map(|notice| ("ieap.notice".to_owned(), notice)));
    about
}

fn format_of(path: &Path) -> Result<TableFormat, PipelineError> {
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("csv") => Ok(TableFormat::Csv),
        Some("parquet") => Ok(TableFormat::Parquet),
        Some("json") => Ok(TableFormat::Json),
        _ => Err(PipelineError::BadArgument {
            what: "--output",
            found: path.display().to_string(),
            needed: "a file that ends in .csv, .parquet or .json".to_owned(),
        }),
    }
}
