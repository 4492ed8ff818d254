//! What runs are fitted with, as a person writes it: a model, and effects that extend it.

use std::fmt;

use thiserror::Error;

use super::effects::{ALL, Effect, effect};
use super::registry::{FitModel, fit_model, fit_models};

/// Effects that a model may be extended by at most: more are not told apart by the runs of a group.
pub const MOST_EFFECTS: usize = 3;

/// A model of the registry with the effects that extend it, `lumped-2 + faradaic-leak`.
#[derive(Clone)]
pub struct ModelChoice {
    /// The base model.
    pub base: &'static FitModel,
    /// Effects in the order written; empty for the base model alone.
    pub effects: Vec<&'static dyn Effect>,
}

/// Why a text names no model.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum ChoiceError {
    /// The first part is no model.
    #[error("there is no model \"{found}\"; known are {known}")]
    Model {
        /// The part found.
        found: String,
        /// Ids that exist.
        known: String,
    },
    /// A part after a `+` is no effect.
    #[error("there is no effect \"{found}\" to extend the model by; `ieap list effects` lists them{near}")]
    Effect {
        /// The part found.
        found: String,
        /// An id that is spelt like it, in words; empty where there is none.
        near: String,
    },
    /// An effect twice, or too many.
    #[error("\"{found}\" names {what}: a model takes each effect once, and at most {MOST_EFFECTS}")]
    Effects {
        /// The whole text.
        found: String,
        /// What is wrong.
        what: &'static str,
    },
    /// A model that cannot be extended.
    #[error("\"{base}\" cannot be extended: effects are added to the lumped models, {known}")]
    NotLumped {
        /// The base named.
        base: &'static str,
        /// Ids of lumped models.
        known: String,
    },
}

impl ModelChoice {
    /// Reads `lumped-2` or `lumped-2 + faradaic-leak + precurvature`.
    ///
    /// # Errors
    /// [`ChoiceError`] says which part is not known.
    pub fn parse(text: &str) -> Result<ModelChoice, ChoiceError> {
        let mut parts = text.split('+').map(str::trim);
        let first = parts.next().unwrap_or_default();
        let base = fit_model(first).ok_or_else(|| ChoiceError::Model {
            found: first.to_owned(),
            known: ids(|_| true),
        })?;
        let effects = parts.map(named).collect::<Result<Vec<_>, _>>()?;
        let id = |k: usize| effects[k].about().id;
        if !effects.is_empty() && !base.id.starts_with("lumped") {
            return Err(ChoiceError::NotLumped {
                base: base.id,
                known: ids(|model| model.id.starts_with("lumped")),
            });
        }
        let twice = (1..effects.len()).any(|k| (0..k).any(|j| id(j) == id(k)));
        let what = if twice {
            Some("an effect twice")
        } else {
            (effects.len() > MOST_EFFECTS).then_some("too many effects")
        };
        match what {
            Some(what) => Err(ChoiceError::Effects {
                found: text.to_owned(),
                what,
            }),
            None => Ok(ModelChoice { base, effects }),
        }
    }

    /// Whether effects extend the base.
    pub fn is_extended(&self) -> bool {
        !self.effects.is_empty()
    }
}

impl fmt::Display for ModelChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.base.id)?;
        self.effects
            .iter()
            .try_for_each(|effect| write!(f, " + {}", effect.about().id))
    }
}

impl fmt::Debug for ModelChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "ModelChoice({self})")
    }
}

fn ids(wanted: impl Fn(&FitModel) -> bool) -> String {
    let known: Vec<&str> = fit_models()
        .iter()
        .filter(|model| wanted(model))
        .map(|model| model.id)
        .collect();
    known.join(", ")
}

fn named(id: &str) -> Result<&'static dyn Effect, ChoiceError> {
    let shared = |other: &str| other.chars().zip(id.chars()).take_while(|(a, b)| a == b).count();
    let near = || {
        let nearest = ALL
            .iter()
            .map(|effect| effect.about().id)
            .max_by_key(|other| shared(other));
        let near = nearest.filter(|other| shared(other) >= 4);
        near.map_or_else(String::new, |other| format!(" (did you mean \"{other}\"?)"))
    };
    effect(id).ok_or_else(|| ChoiceError::Effect {
        found: id.to_owned(),
        near: near(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_choice_is_read_and_written_back() {
        for text in [
            "lumped-2",
            "lumped-1 + faradaic-leak",
            "lumped-2 + faradaic-leak + precurvature",
        ] {
            assert_eq!(ModelChoice::parse(text).unwrap().to_string(), text);
        }
        assert_eq!(
            ModelChoice::parse(" lumped-2+faradaic-leak ")
                .unwrap()
                .to_string(),
            "lumped-2 + faradaic-leak"
        );
    }

    #[test]
    fn what_names_no_model_says_what_would() {
        let said = |text: &str| ModelChoice::parse(text).unwrap_err().to_string();
        assert!(said("lumped-9").contains("known are lumped-1"));
        assert!(said("lumped-2 + faradaic").contains("did you mean \"faradaic-leak\""));
        assert!(said("lumped-2 +").contains("no effect \"\""));
        assert!(said("distributed + faradaic-leak").contains("lumped-1"));
        assert!(said("lumped-2 + precurvature + precurvature").contains("twice"));
    }
}
