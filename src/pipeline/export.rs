//! Writes tables for other programs.

use std::path::{Path, PathBuf};

use super::{Context, PipelineError};
use crate::analysis::{self, TableFormat};

/// What can be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Table {
    /// One row a run and parameter.
    Fits,
    /// One row a run.
    FitsWide,
    /// One row a condition.
    Conditions,
    /// One row a reading.
    Traces,
    /// One row a number of a modulus log.
    Dma,
}

/// The verb `export`.
#[derive(Debug, Clone)]
pub struct Export {
    /// What to write.
    pub table: Table,
    /// Where to; the ending tells the format.
    pub path: PathBuf,
    /// Whether a file that is there may be written over.
    pub overwrite: bool,
}

impl Export {
    /// Writes the table; gives the number of rows.
    ///
    /// # Errors
    /// The ending is not known, a file is there already, or the disk refuses.
    pub fn run(&self, context: &Context) -> Result<usize, PipelineError> {
        let format = format_of(&self.path)?;
        if self.path.exists() && !self.overwrite {
            return Err(PipelineError::FileExists {
                path: self.path.clone(),
            });
        }
        let runs = context.store.runs()?;
        let campaign = &context.campaign;
        let mut table = match self.table {
            Table::Fits => analysis::fits_long(&runs, campaign)?,
            Table::FitsWide => analysis::fits_wide(&runs, campaign)?,
            Table::Conditions => analysis::conditions_table(&runs, campaign)?,
            Table::Dma => analysis::dma::table::modulus_table(&context.store.modulus_logs()?, campaign)?,
            Table::Traces => {
                let mut writer = analysis::TraceWriter::create(&self.path, format)?;
                for run in &runs {
                    writer.write(&run.path, &context.store.channels(run.id)?)?;
                }
                return Ok(writer.finish()?);
            }
        };
        analysis::write_table(&mut table, format, &self.path)?;
        Ok(table.height())
    }
}

fn format_of(path: &Path) -> Result<TableFormat, PipelineError> {
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("csv") => Ok(TableFormat::Csv),
        Some("parquet") => Ok(TableFormat::Parquet),
        _ => Err(PipelineError::BadArgument {
            what: "--output",
            found: path.display().to_string(),
            needed: "a file that ends in .csv or .parquet".to_owned(),
        }),
    }
}
