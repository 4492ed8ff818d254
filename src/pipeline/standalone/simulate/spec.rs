//! What is to be simulated: SPEC.toml.

use crate::domain::number::digits;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::dma_spec::DmaSpec;
use super::effect_spec::EffectSpec;
use super::noise_spec::Noise;
use super::run_spec::RunSpec;
use super::sampling::Sampling;
use super::strip_spec::{NO_EFFECTS, StripSpec};
use super::wrong::{Wrong, above_zero, from_zero};
use crate::pipeline::infra::error::SpecError;
use crate::truth::HiddenEffect;

/// A file that says which runs to write.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spec {
    /// What holds for all runs.
    pub simulation: Simulation,
    /// Standard deviations and correlation of the noise.
    #[serde(default)]
    pub noise: Noise,
    /// How the potentiostat samples after the step, in order of time.
    #[serde(default)]
    pub sampling: Vec<Sampling>,
    /// How the camera samples after the step; empty: with the potentiostat.
    #[serde(default)]
    pub camera: Vec<Sampling>,
    /// Folders below the output folder that get a tags.toml.
    #[serde(default)]
    pub folder: Vec<FolderTags>,
    /// Effects hidden in all runs, or in those that an effect names.
    #[serde(default)]
    pub effect: Vec<EffectSpec>,
    /// The runs.
    #[serde(default)]
    pub run: Vec<RunSpec>,
    /// Runs that are read at places along the strip.
    #[serde(default)]
    pub strip: Vec<StripSpec>,
    /// Modulus logs.
    pub dma: Option<DmaSpec>,
}

/// What holds for all runs.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Simulation {
    /// Seed of the noise.
    pub seed: u64,
    /// Folder to write into, relative to the spec.
    pub folder: PathBuf,
    /// Lines that open every file: that it is simulated, and from what.
    pub statement: Vec<String>,
    /// Recorded time before the step, s.
    #[serde(default)]
    pub baseline_s: f64,
    /// Sampling before the step, s.
    #[serde(default = "one_second")]
    pub baseline_every_s: f64,
    /// Whether a run's file says which effects are hidden in it; the answer key says it always.
    #[serde(default)]
    pub tell: bool,
}

/// Readings of a run at most.
const MOST_ROWS: f64 = 1e7;

fn one_second() -> f64 {
    1.0
}

/// Tags for a folder.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FolderTags {
    /// Folder below the output folder.
    pub path: PathBuf,
    /// Its tags.
    pub tags: toml::Table,
}

impl Spec {
    /// Reads and checks a spec.
    ///
    /// # Errors
    /// See [`SpecError`].
    pub fn read(path: &Path) -> Result<Spec, SpecError> {
        let text = std::fs::read_to_string(path).map_err(|source| SpecError::Unreadable {
            path: path.to_owned(),
            source,
        })?;
        let spec: Spec = toml::from_str(&text).map_err(|e| SpecError::Malformed {
            path: path.to_owned(),
            detail: e.to_string(),
        })?;
        spec.check().map_err(|wrong| Spec::bad_value(path, wrong))?;
        Ok(spec)
    }

    pub(super) fn bad_value(path: &Path, wrong: Wrong) -> SpecError {
        SpecError::BadValue {
            path: path.to_owned(),
            place: wrong.place,
            found: wrong.found,
            needed: wrong.needed,
        }
    }

    fn check(&self) -> Result<(), Wrong> {
        if self.run.is_empty()
            && self.strip.is_empty()
            && self.dma.as_ref().is_none_or(|dma| dma.log.is_empty())
        {
            let needed = "a [[run]], a [[strip]] or a [[dma.log]]";
            return Err(Wrong::new("spec", "nothing to simulate".into(), needed));
        }
        self.dma.as_ref().map_or(Ok(()), DmaSpec::check)?;
        self.noise.check()?;
        let own = self.strip.iter().flat_map(|strip| &strip.sampling);
        let all = self.sampling.iter().chain(&self.camera).chain(own);
        let all = all.map(|sampling| ("sampling.every_s", sampling.every_s));
        Wrong::unless_all(all, |every_s| every_s > 0.0, "a time above 0")?;
        self.check_readings()?;
        let safe = |path: &Path| {
            path.components()
                .all(|c| matches!(c, std::path::Component::Normal(_)))
        };
        let paths = self
            .run
            .iter()
            .map(|run| run.file.as_path())
            .chain(self.folder.iter().map(|folder| folder.path.as_path()))
            .chain(self.strip.iter().map(|strip| strip.file.as_path()))
            .chain(self.dma.iter().flat_map(DmaSpec::paths));
        for path in paths.chain([self.simulation.folder.as_path()]) {
            if !safe(path) {
                let place = path.display().to_string();
                return Err(Wrong::new(
                    &place,
                    "a path out of the folder".into(),
                    "a path below it",
                ));
            }
        }
        self.check_files()?;
        self.run.iter().try_for_each(RunSpec::check)?;
        self.strip.iter().try_for_each(StripSpec::check)?;
        self.check_effects()
    }

    /// That a baseline and every list of samplings have a number of rows that a file can hold.
    fn check_readings(&self) -> Result<(), Wrong> {
        let simulation = &self.simulation;
        let (long_s, every_s) = (simulation.baseline_s, simulation.baseline_every_s);
        if !(from_zero(long_s) && above_zero(every_s)) {
            let found = format!("{long_s} s, every {every_s} s");
            let needed = "a time of 0 or above, and an interval above 0";
            return Err(Wrong::new("simulation.baseline_s", found, needed));
        }
        let own = self.strip.iter().map(|strip| &strip.sampling);
        for stretches in [&self.sampling, &self.camera].into_iter().chain(own) {
            let mut from_s = 0.0;
            let mut rows = long_s / every_s;
            for stretch in stretches {
                rows += ((stretch.until_s - from_s) / stretch.every_s).max(0.0);
                from_s = stretch.until_s;
            }
            if !(rows <= MOST_ROWS && from_s.is_finite()) {
                let found = format!("{} readings until {from_s} s", digits(rows, 0));
                let needed = format!("at most {MOST_ROWS} readings");
                return Err(Wrong::new("sampling", found, &needed));
            }
        }
        Ok(())
    }

    /// That no two runs are written to one file.
    fn check_files(&self) -> Result<(), Wrong> {
        let runs = self.run.iter().map(|run| &run.file);
        let mut files: Vec<&PathBuf> = runs.chain(self.strip.iter().map(|strip| &strip.file)).collect();
        files.sort();
        match files.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => Err(Wrong::new(
                &pair[0].display().to_string(),
                "two runs of that file".into(),
                "a file for each run",
            )),
            None => Ok(()),
        }
    }

    /// That every effect is known, meets a run, and can act in it.
    fn check_effects(&self) -> Result<(), Wrong> {
        if let (Some(effect), true) = (self.effect.first(), self.run.is_empty() && !self.strip.is_empty()) {
            let place = format!("effect {}", effect.id);
            return Err(Wrong::new(&place, "no [[run]]".into(), NO_EFFECTS));
        }
        for effect in &self.effect {
            effect.check(&self.run)?;
        }
        for (number, run) in self.run.iter().enumerate() {
            let place = format!("run {}", run.file.display());
            for effect in &run.effect {
                effect.check_strength(&format!("{place}: effect {}", effect.id))?;
            }
            let effects = hidden_effects(self, run);
            if effects.is_empty() {
                continue;
            }
            let checked = run.truth(effects).check(&run.drive(), number);
            checked.map_err(|error| Wrong::told(&place, &error))?;
        }
        Ok(())
    }

    /// That a run could not be simulated, though its values may stand there.
    pub(super) fn unsolved(path: &Path, run: &Path, error: &str) -> SpecError {
        SpecError::Malformed {
            path: path.to_owned(),
            detail: format!("run {}: {error}", run.display()),
        }
    }
}

/// The effects hidden in a run: those of the spec that mean it, then its own.
pub fn hidden_effects(spec: &Spec, run: &RunSpec) -> Vec<HiddenEffect> {
    let meant = spec.effect.iter().filter(|effect| effect.meets(run));
    meant.chain(&run.effect).map(EffectSpec::hidden).collect()
}
