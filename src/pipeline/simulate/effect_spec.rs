//! An effect of a spec, and which runs it is hidden in.

use std::collections::BTreeMap;

use glob::Pattern;
use serde::Deserialize;

use super::run_spec::RunSpec;
use super::spec::{Spec, Wrong};
use crate::model::truth::HiddenEffect;

/// An effect to hide: `[[effect]]` for the whole spec, `[[run.effect]]` for one run.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct EffectSpec {
    /// Id.
    pub id: String,
    /// Variant; none: the effect's first.
    pub variant: Option<String>,
    /// Patterns of the run files that it is hidden in, such as `*plus*`; none: all.
    pub runs: Option<Vec<String>>,
    /// All other keys: the effect's parameters.
    #[serde(flatten)]
    pub parameters: BTreeMap<String, f64>,
}

impl EffectSpec {
    /// The effect as the truth simulator takes it.
    pub fn hidden(&self) -> HiddenEffect {
        HiddenEffect {
            id: self.id.clone(),
            variant: self.variant.clone(),
            parameters: self.parameters.clone(),
        }
    }

    /// Whether it is hidden in that run.
    fn meets(&self, run: &RunSpec) -> bool {
        let file = run.file.to_string_lossy().replace('\\', "/");
        let fits = |pattern: &String| Pattern::new(pattern).is_ok_and(|pattern| pattern.matches(&file));
        self.runs
            .as_ref()
            .is_none_or(|patterns| patterns.iter().any(fits))
    }

    /// That it is known and that each of its patterns means a run.
    pub(super) fn check(&self, runs: &[RunSpec]) -> Result<(), Wrong> {
        let place = format!("effect {}", self.id);
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
            let named = |run: &RunSpec| compiled.matches(&run.file.to_string_lossy().replace('\\', "/"));
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

/// The effects hidden in a run: those of the spec that mean it, then its own.
pub fn hidden_effects(spec: &Spec, run: &RunSpec) -> Vec<HiddenEffect> {
    let meant = spec.effect.iter().filter(|effect| effect.meets(run));
    meant.chain(&run.effect).map(EffectSpec::hidden).collect()
}
