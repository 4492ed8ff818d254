//! Writes run files of a model with noise and sampling, seeded: the same spec gives the same bytes. Effects that the
//! spec names are hidden in them by the truth simulator; truth.json says which.

mod answer_key;
mod effect_spec;
mod noise_spec;
mod run_spec;
mod spec;
mod table;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};

pub use answer_key::answer_key;
pub use effect_spec::{EffectSpec, hidden_effects};
pub use noise_spec::Noise;
pub use run_spec::{Pulses, RunSpec, SegmentSpec};
pub use spec::{FolderTags, Sampling, Simulation, Spec, SpecError};
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
    /// Writes the run files, their sidecars, the folders' tags.toml, and the answer key truth.json beside the output
    /// folder; gives the paths written.
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
            let table = run_table(&spec, run, number);
            let table = table.map_err(|error| Spec::unsolved(&self.spec, run, &error))?;
            written.push(self.write(&path, &table)?);
            if !run.tags.is_empty() {
                let mut sidecar = path.into_os_string();
                sidecar.push(".toml");
                written.push(self.write(Path::new(&sidecar), &run.tags.to_string())?);
            }
            observer.advance();
        }
        let key = root.with_file_name("truth.json");
        written.push(self.write(&key, &answer_key(&spec, &self.spec))?);
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
