//! Writes run files of a model with noise and sampling, seeded: the same spec gives the same bytes.

mod spec;
mod table;

use std::path::{Path, PathBuf};

pub use spec::{Spec, SpecError};
pub use table::run_table;

use super::{Observer, PipelineError};

/// The verb `simulate`.
#[derive(Debug, Clone)]
pub struct Simulate {
    /// The spec.
    pub spec: PathBuf,
    /// Seed in place of the spec's.
    pub seed: Option<u64>,
    /// Write over files that are there.
    pub overwrite: bool,
}

impl Simulate {
    /// Writes the run files, their sidecars and the folders' tags.toml; gives the paths written.
    ///
    /// # Errors
    /// The spec is wrong, a file is already there, or the disk refuses.
    pub fn run(&self, observer: &dyn Observer) -> Result<Vec<PathBuf>, PipelineError> {
        let mut spec = Spec::read(&self.spec)?;
        spec.simulation.seed = self.seed.unwrap_or(spec.simulation.seed);
        let root = self
            .spec
            .parent()
            .unwrap_or(Path::new(""))
            .join(&spec.simulation.folder);
        let mut written = Vec::new();
        observer.begin("simulating", spec.run.len() as u64);
        for folder in spec.folder.iter().filter(|folder| !folder.tags.is_empty()) {
            written.push(self.write(
                &root.join(&folder.path).join("tags.toml"),
                &folder.tags.to_string(),
            )?);
        }
        for (number, run) in spec.run.iter().enumerate() {
            let path = root.join(&run.file);
            written.push(self.write(&path, &run_table(&spec, run, number))?);
            if !run.tags.is_empty() {
                let mut sidecar = path.into_os_string();
                sidecar.push(".toml");
                written.push(self.write(Path::new(&sidecar), &run.tags.to_string())?);
            }
            observer.advance();
        }
        observer.end();
        Ok(written)
    }

    fn write(&self, path: &Path, text: &str) -> Result<PathBuf, PipelineError> {
        if path.exists() && !self.overwrite {
            return Err(PipelineError::FileExists {
                path: path.to_owned(),
            });
        }
        let failed = |source| PipelineError::File {
            path: path.to_owned(),
            doing: "writing a simulated run",
            source,
        };
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(failed)?;
        }
        std::fs::write(path, text).map_err(failed)?;
        Ok(path.to_owned())
    }
}
