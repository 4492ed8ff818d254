//! A file that remembers why it could not be written: encoders of tables tell it in words of their own, or not at all.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use polars::prelude::PolarsError;

use super::ExportError;

/// What is written to, through a buffer.
pub type Buffered = BufWriter<DiskFile>;

/// A file that an encoder writes.
pub struct DiskFile {
    file: File,
    refusal: Arc<Mutex<Option<io::Error>>>,
}

/// What the disk said, kept apart from the file, which the encoder owns.
pub struct Told {
    path: PathBuf,
    refusal: Arc<Mutex<Option<io::Error>>>,
}

impl DiskFile {
    /// Makes the file.
    ///
    /// # Errors
    /// [`ExportError::Write`] where it cannot be made.
    pub fn create(path: &Path) -> Result<(Buffered, Told), ExportError> {
        let file = File::create(path).map_err(|source| ExportError::Write {
            path: path.to_owned(),
            source,
        })?;
        let told = Told {
            path: path.to_owned(),
            refusal: Arc::default(),
        };
        let refusal = told.refusal.clone();
        Ok((BufWriter::new(DiskFile { file, refusal }), told))
    }

    fn noted<T>(&self, outcome: io::Result<T>) -> io::Result<T> {
        outcome.inspect_err(|error| {
            if let Ok(mut refusal) = self.refusal.lock() {
                let again = || io::Error::new(error.kind(), error.to_string());
                refusal.get_or_insert_with(again);
            }
        })
    }
}

impl Write for DiskFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.file.write(bytes);
        self.noted(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        let flushed = self.file.flush();
        self.noted(flushed)
    }
}

impl Told {
    /// Why an encoder stopped: what the disk said, else what the encoder says.
    pub fn why(&self, encoder: PolarsError) -> ExportError {
        let refusal = self.refusal.lock().ok().and_then(|mut refusal| refusal.take());
        match (refusal, encoder) {
            (Some(source), _) => ExportError::Write {
                path: self.path.clone(),
                source,
            },
            (None, source) => ExportError::Table {
                table: self.path.display().to_string(),
                source,
            },
        }
    }

    /// The same of an error of the file itself.
    pub fn failed(&self, source: io::Error) -> ExportError {
        ExportError::Write {
            path: self.path.clone(),
            source,
        }
    }
}
