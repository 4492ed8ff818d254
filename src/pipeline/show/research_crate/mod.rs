//! `ieap export --what crate`: a campaign as one ZIP that a repository takes: raw files, tables, figures, campaign.toml, and what
//! all of it is, as an RO-Crate 1.2 (<https://w3id.org/ro/crate/1.2>) and for DataCite.

mod datacite;
mod metadata;
mod part;

use std::io::{Seek, Write};
use std::path::{Path, PathBuf};

use zip::write::SimpleFileOptions;

use super::export::{Export, Table};
use super::figures::{self, MakeFigure};
use crate::analysis::TableFormat;
use crate::domain::FileState;
use crate::ingest::archive::Archive;
use crate::ingest::campaign_file;
use crate::pipeline::ground::whole_file::put_file;
use crate::pipeline::{Context, PipelineError};
use crate::system::fs;
use part::Part;

/// Resolution of figures; they are drawn as SVG, where it does not count.
const DOTS_PER_INCH: f64 = 300.0;

/// The verb.
#[derive(Debug, Clone)]
pub struct ExportCrate {
    /// File to write.
    pub path: PathBuf,
    /// Whether a file that is there may be written over.
    pub overwrite: bool,
}

/// What went in.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct CrateSummary {
    /// Files in the ZIP, the descriptions counted.
    pub files: usize,
    /// What is not in it, with the reason.
    pub left_out: Vec<(String, String)>,
}

impl ExportCrate {
    /// Writes the crate; the file appears whole or not at all.
    ///
    /// # Errors
    /// campaign.toml has no `[publication]` with a licence and an author; the disk refuses.
    pub fn run(&self, context: &Context) -> Result<CrateSummary, PipelineError> {
        let path = context.folder.join(campaign_file::FILE_NAME);
        let text = fs::read_stated_text(&path).map_err(|source| PipelineError::File {
            path: path.clone(),
            doing: "reading",
            source,
        })?;
        let stated = campaign_file::publication(&text, &path)?.unwrap_or_default();
        let publication = metadata::complete(context, stated)?;
        put_file(&self.path, self.overwrite, |part| {
            let failed = |error: zip::result::ZipError| self.failed(error.into());
            let file = fs::OpenOptions::new()
                .read(true)
                .write(true)
                .open(part)
                .map_err(|source| self.failed(source))?;
            let mut filled = Filled {
                zip: zip::ZipWriter::new(file),
                parts: Vec::new(),
                summary: CrateSummary::default(),
                target: &self.path,
            };
            filled.put(
                campaign_file::FILE_NAME,
                "What was measured, on what, and how",
                "application/toml",
                text.as_bytes(),
            )?;
            filled.raw_files(context)?;
            filled.tables(context)?;
            filled.figures(context)?;
            let descriptions = [
                (
                    metadata::FILE_NAME,
                    metadata::document(context, &publication, &filled.parts),
                ),
                (datacite::FILE_NAME, datacite::document(context, &publication)),
            ];
            for (name, document) in descriptions {
                filled.put(name, "", "application/json", format!("{document:#}\n").as_bytes())?;
            }
            filled.zip.finish().map_err(failed)?;
            Ok(filled.summary)
        })
    }

    fn failed(&self, source: std::io::Error) -> PipelineError {
        PipelineError::File {
            path: self.path.clone(),
            doing: "writing the crate",
            source,
        }
    }
}

/// A ZIP in the making.
struct Filled<'a, W: Write + Seek> {
    zip: zip::ZipWriter<W>,
    parts: Vec<Part>,
    summary: CrateSummary,
    target: &'a Path,
}

impl<W: Write + Seek> Filled<'_, W> {
    fn put(
        &mut self,
        path: &str,
        name: &str,
        media_type: &'static str,
        bytes: &[u8],
    ) -> Result<(), PipelineError> {
        let failed = |source| PipelineError::File {
            path: self.target.to_owned(),
            doing: "writing the crate",
            source,
        };
        // The same campaign gives the same bytes: no time of day stands with the files.
        let options = SimpleFileOptions::default().large_file(bytes.len() as u64 >= u64::from(u32::MAX));
        self.zip
            .start_file(path, options)
            .map_err(|error| failed(error.into()))?;
        self.zip.write_all(bytes).map_err(failed)?;
        self.summary.files += 1;
        self.parts.push(Part {
            path: path.to_owned(),
            name: name.to_owned(),
            media_type,
            bytes: bytes.len() as u64,
            blake3: blake3::hash(bytes).to_hex().to_string(),
        });
        Ok(())
    }

    /// Files that hold runs and logs, as the instruments wrote them.
    fn raw_files(&mut self, context: &Context) -> Result<(), PipelineError> {
        let archive = Archive::new(&context.folder);
        for file in context.store.files()? {
            let is_archived = matches!(file.state, FileState::Run | FileState::Alias | FileState::Log);
            match (&file.hash, is_archived) {
                (Some(hash), true) => {
                    let bytes = archive.read(hash)?;
                    self.put(
                        &file.path,
                        "Raw file of an instrument",
                        media_type(&file.path),
                        &bytes,
                    )?;
                }
                _ => {
                    let reason = format!("{}: it holds no run and no log", file.state.key());
                    self.summary.left_out.push((file.path.clone(), reason));
                }
            }
        }
        Ok(())
    }

    /// Every table, as Parquet and as CSV.
    fn tables(&mut self, context: &Context) -> Result<(), PipelineError> {
        for table in Table::ALL {
            let formats = [
                (TableFormat::Parquet, "parquet", "application/vnd.apache.parquet"),
                (TableFormat::Csv, "csv", "text/csv"),
            ];
            for (format, ending, media_type) in formats {
                let (bytes, rows) = Export::bytes(context, table, format)?;
                let name = format!("Table {}, {rows} rows", table.name());
                self.put(
                    &format!("tables/{}.{ending}", table.name()),
                    &name,
                    media_type,
                    &bytes,
                )?;
            }
        }
        Ok(())
    }

    /// Every figure that the campaign has the data for.
    fn figures(&mut self, context: &Context) -> Result<(), PipelineError> {
        for (name, _, _, about) in figures::listed().filter(|(name, ..)| !figures::needs_no_campaign(name)) {
            let figure = MakeFigure {
                name: name.to_owned(),
                format: "svg".to_owned(),
                width_mm: None,
                dots_per_inch: DOTS_PER_INCH,
                run: None,
                parameter: None,
            };
            let path = format!("figures/{name}.svg");
            match figure.run(context) {
                Ok(bytes) => self.put(&path, about, "image/svg+xml", &bytes)?,
                Err(PipelineError::Figure { reason, .. }) => self.summary.left_out.push((path, reason)),
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }
}

/// By the ending of a raw file; bytes where it says nothing.
fn media_type(path: &str) -> &'static str {
    let ending = path.rsplit('.').next().unwrap_or_default().to_lowercase();
    match ending.as_str() {
        "csv" => "text/csv",
        "tsv" => "text/tab-separated-values",
        "txt" | "dta" | "mpt" | "dat" | "asc" => "text/plain",
        "parquet" => "application/vnd.apache.parquet",
        "json" => "application/json",
        "zip" => "application/zip",
        _ => "application/octet-stream",
    }
}
