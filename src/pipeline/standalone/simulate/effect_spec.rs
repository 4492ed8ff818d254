//! An effect of a spec, and which runs it is hidden in.

use std::collections::BTreeMap;
use std::path::Path;

use glob::Pattern;
use serde::Deserialize;

use super::run_spec::RunSpec;
use super::wrong::Wrong;
use crate::truth::HiddenEffect;
use crate::truth::catalogue::{KnownParameter, known};

/// An effect to hide: `[[effect]]` for the whole spec, `[[run.effect]]` for one run.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct EffectSpec {
    /// Id.
    pub id: String,
    /// Variant; none: the effect's first.
    pub variant: Option<String>,
    /// Foreign form; none: the effect's own law.
    pub form: Option<String>,
    /// Patterns of the run files that it is hidden in, such as `*plus*`; none: all.
    pub runs: Option<Vec<String>>,
    /// Strength as the norm, in standard deviations of the noise, of what the effect leaves in its runs after the base
    /// parameters are refitted, in place of the strength in its own unit; below zero for a strength below zero.
    pub strength_sigma: Option<f64>,
    /// All other keys: the effect's parameters.
    #[serde(flatten)]
    pub parameters: BTreeMap<String, f64>,
}

impl EffectSpec {
    /// The effect as the truth simulator takes it; a strength in standard deviations has an example in its place until
    /// it is resolved.
    pub fn hidden(&self) -> HiddenEffect {
        let mut parameters = self.parameters.clone();
        if let (Some(sigma), Some(strength)) = (self.strength_sigma, self.strength()) {
            let example = strength.example.abs().copysign(sigma);
            parameters.entry(strength.key.to_owned()).or_insert(example);
        }
        let variant = || self.variant.as_deref().unwrap_or_default();
        let in_form = self.form.as_ref().map(|form| format!("{}/{form}", variant()));
        HiddenEffect {
            id: self.id.clone(),
            variant: in_form.or_else(|| self.variant.clone()),
            parameters,
        }
    }

    /// The parameter that is the strength.
    pub(super) fn strength(&self) -> Option<&'static KnownParameter> {
        known(&self.id).and_then(|known| known.parameters.first())
    }

    /// Whether it is hidden in that run.
    pub(super) fn meets(&self, run: &RunSpec) -> bool {
        let file = slashed(&run.file);
        let fits = |pattern: &String| Pattern::new(pattern).is_ok_and(|pattern| pattern.matches(&file));
        self.runs
            .as_ref()
            .is_none_or(|patterns| patterns.iter().any(fits))
    }

    /// That a strength in standard deviations is one, and the only one.
    pub(super) fn check_strength(&self, place: &str) -> Result<(), Wrong> {
        let Some(sigma) = self.strength_sigma else {
            return Ok(());
        };
        let place = format!("{place}: strength_sigma");
        if sigma == 0.0 || !sigma.is_finite() {
            return Err(Wrong::new(&place, sigma.to_string(), "a number other than 0"));
        }
        match self.strength() {
            Some(strength) if self.parameters.contains_key(strength.key) => {
                let found = format!("{} beside it", strength.key);
                Err(Wrong::new(&place, found, "one of the two: they state the same"))
            }
            _ => Ok(()),
        }
    }

    /// That it is known and that each of its patterns means a run.
    pub(super) fn check(&self, runs: &[RunSpec]) -> Result<(), Wrong> {
        let place = format!("effect {}", self.id);
        self.check_strength(&place)?;
        self.hidden()
            .check()
            .map_err(|error| Wrong::told(&place, &error))?;
        for pattern in self.runs.iter().flatten() {
            let compiled = Pattern::new(pattern).map_err(|error| {
                Wrong::new(
                    &format!("{place}: runs"),
                    pattern.clone(),
                    &format!("a pattern: {error}"),
                )
            })?;
            let named = |run: &RunSpec| compiled.matches(&slashed(&run.file));
            if !runs.iter().any(named) {
                let found = format!("{pattern:?}, which no run's file matches");
                return Err(Wrong::new(
                    &format!("{place}: runs"),
                    found,
                    "a pattern of run files",
                ));
            }
        }
        Ok(())
    }
}

/// A path as patterns and the answer key write it.
pub(super) fn slashed(path: &Path) -> String {
    path.to_string_lossy().replace('\\', "/")
}
