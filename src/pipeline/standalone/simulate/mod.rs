//! Writes run files of a model, of strips read at several places, and modulus logs, with noise and sampling, seeded: the same spec gives the same bytes.
//! Effects that the spec names are hidden in the runs by the truth simulator; truth.json says which.

mod answer_key;
mod dma_log;
mod dma_spec;
mod effect_spec;
mod noise_spec;
mod run_spec;
mod sampling;
mod spec;
mod strength;
mod strip_spec;
mod strip_table;
mod table;
#[cfg(test)]
mod tests;
mod wave;
mod wrong;

use std::path::{Path, PathBuf};

pub use crate::pipeline::infra::error::SpecError;
pub use answer_key::answer_key;
pub use dma_log::dma_log;
pub use dma_spec::{DmaNoise, DmaSpec, Hold, LogSpec};
pub use effect_spec::EffectSpec;
pub use noise_spec::Noise;
pub use run_spec::{Pulses, RunSpec, SegmentSpec, checked_run};
pub use sampling::Sampling;
pub use spec::{FolderTags, Simulation, Spec, hidden_effects};
pub use strip_spec::{StripParameters, StripSpec};
pub use strip_table::strip_table;
pub use table::{exact_responses, run_table};
pub use wave::Wave;

use crate::pipeline::infra::whole_file::put_bytes;
use crate::pipeline::{Observer, PipelineError, failed};

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
    /// Writes the run files and modulus logs, their sidecars, the folders' tags.toml, and the answer key truth.json beside the output
    /// folder; gives the paths written.
    ///
    /// # Errors
    /// The spec is wrong, a file is already there, or the disk refuses.
    pub fn run(&self, observer: &dyn Observer) -> Result<Vec<PathBuf>, PipelineError> {
        let mut spec = Spec::read(&self.spec)?;
        spec.simulation.seed = self.seed.unwrap_or(spec.simulation.seed);
        spec.resolve_strengths()
            .map_err(|wrong| Spec::bad_value(&self.spec, wrong))?;
        let root = self
            .spec
            .parent()
            .unwrap_or(Path::new(""))
            .join(&spec.simulation.folder);
        self.check_free(&spec, &root)?;
        let mut written = Vec::new();
        let logs = spec.dma.iter().map(|dma| dma.log.len()).sum::<usize>();
        observer.begin("simulating", (spec.run.len() + spec.strip.len() + logs) as u64);
        for folder in spec.folder.iter().filter(|folder| !folder.tags.is_empty()) {
            written.push(self.write(
                &root.join(&folder.path).join("tags.toml"),
                &folder.tags.to_string(),
            )?);
        }
        for (number, run) in spec.run.iter().enumerate() {
            let path = root.join(&run.file);
            let table = run_table(&spec, run, number);
            let table = table.map_err(|error| Spec::unsolved(&self.spec, &run.file, &error.to_string()))?;
            written.extend(self.with_sidecar(&path, &table, &run.tags)?);
            observer.advance();
        }
        for (number, strip) in spec.strip.iter().enumerate() {
            let table = strip_table(&spec, strip, number);
            let table = table.map_err(|error| Spec::unsolved(&self.spec, &strip.file, &error))?;
            written.extend(self.with_sidecar(&root.join(&strip.file), &table, &strip.tags)?);
            observer.advance();
        }
        if let Some(dma) = &spec.dma {
            let root = self.spec.parent().unwrap_or(Path::new("")).join(&dma.folder);
            for (number, log) in dma.log.iter().enumerate() {
                let text = dma_log(dma, log, number, spec.simulation.seed);
                written.extend(self.with_sidecar(&root.join(&log.file), &text, &log.tags)?);
                observer.advance();
            }
        }
        if !(spec.run.is_empty() && spec.strip.is_empty()) {
            let key = root.with_file_name("truth.json");
            written.push(self.write(&key, &answer_key(&spec, &self.spec))?);
        }
        observer.end();
        Ok(written)
    }

    /// Refuses before anything is written where a run's file is there already.
    fn check_free(&self, spec: &Spec, root: &Path) -> Result<(), PipelineError> {
        let runs = spec.run.iter().map(|run| &run.file);
        let mut files = runs.chain(spec.strip.iter().map(|strip| &strip.file));
        let there = files.find(|file| root.join(file).exists());
        match there.filter(|_| !self.overwrite) {
            Some(file) => Err(PipelineError::FileExists {
                path: root.join(file),
            }),
            None => Ok(()),
        }
    }

    fn with_sidecar(
        &self,
        path: &Path,
        text: &str,
        tags: &toml::Table,
    ) -> Result<Vec<PathBuf>, PipelineError> {
        let mut written = vec![self.write(path, text)?];
        if !tags.is_empty() {
            let mut sidecar = path.as_os_str().to_owned();
            sidecar.push(".toml");
            written.push(self.write(Path::new(&sidecar), &tags.to_string())?);
        }
        Ok(written)
    }

    fn write(&self, path: &Path, text: &str) -> Result<PathBuf, PipelineError> {
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)
                .map_err(failed(folder, "making the folder of a simulated run"))?;
        }
        put_bytes(path, self.overwrite, text.as_bytes())?;
        Ok(path.to_owned())
    }
}
