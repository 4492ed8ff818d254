//! Writes tables for other programs.

use std::path::{Path, PathBuf};

use super::columns;
pub use super::columns::TRACES;
use super::plain_tables::plain_table;
pub use crate::analysis::TableFormat;
use crate::analysis::tables::TABLES;
use crate::analysis::{self, About, ExportError, TraceWriter};
use crate::pipeline::campaign::context::CODE_VERSION;
use crate::pipeline::campaign::standing;
use crate::pipeline::infra::whole_file::put_file;
use crate::pipeline::{Context, PipelineError, failed};
use crate::system::passing::Passing;

/// Name of every table that is written, and what it shows.
pub fn written() -> impl Iterator<Item = (&'static str, &'static str)> {
    let tables = TABLES.iter().filter(|table| table.is_written());
    let tables = tables.map(|table| (table.name, table.about));
    tables.chain([(TRACES, "Every reading"), columns::LISTED])
}

/// The verb `export`.
#[derive(Debug, Clone)]
pub struct Export {
    /// What to write: one of [`written`].
    pub table: &'static str,
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
        if (self.table, format) == (TRACES, TableFormat::Json) {
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
        table: &'static str,
        format: TableFormat,
    ) -> Result<(Vec<u8>, usize), PipelineError> {
        let failed = failed(&std::env::temp_dir(), "writing what goes to stdout");
        let made = Passing::made(tempfile::tempdir, |folder| folder.path().to_owned());
        let (folder, _passing) = made.map_err(&failed)?;
        let export = Export {
            table,
            path: folder.path().join(table),
            format: Some(format),
            overwrite: false,
        };
        let rows = export.run(context)?;
        Ok((crate::system::fs::read(&export.path).map_err(failed)?, rows))
    }

    fn write(&self, context: &Context, format: TableFormat, path: &Path) -> Result<usize, PipelineError> {
        let about = about(context, self.table);
        if self.table == TRACES {
            let mut writer = TraceWriter::create(path, format, &about)?;
            for run in &standing::runs(context)?.speaking {
                writer.write(&run.path, &context.store.channels(run.id)?)?;
            }
            return Ok(writer.finish()?);
        }
        let frame = plain_table(context, self.table)?;
        analysis::write_table(&frame, format, &about, path)?;
        Ok(frame.first().map_or(0, |column| column.cells.len()))
    }
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
