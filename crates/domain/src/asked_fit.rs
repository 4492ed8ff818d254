//! How fits were asked for, where it was not left to the program.

use std::fmt;

use crate::KnownParameter;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What was said of how to fit; what is open is decided elsewhere.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AskedFit {
    /// Model, with the effects that extend it.
    pub model: Option<String>,
    /// Id of the method that searches minima.
    pub method: Option<String>,
    /// Whether current and curvature are fitted together instead of one after the other.
    pub simultaneous: Option<bool>,
    /// Seed of a random method.
    pub seed: Option<u64>,
    /// What is known of parameters.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub known: Vec<KnownParameter>,
}

impl AskedFit {
    /// Whether nothing was said of model, method, steps or parameters; a seed alone asks for nothing.
    pub fn is_open(&self) -> bool {
        self.model.is_none() && self.method.is_none() && self.simultaneous.is_none() && self.known.is_empty()
    }

    /// The same with what is open taken from `other`.
    #[must_use]
    pub fn or(&self, other: &AskedFit) -> AskedFit {
        AskedFit {
            model: self.model.clone().or_else(|| other.model.clone()),
            method: self.method.clone().or_else(|| other.method.clone()),
            simultaneous: self.simultaneous.or(other.simultaneous),
            seed: self.seed.or(other.seed),
            known: if self.known.is_empty() {
                other.known.clone()
            } else {
                self.known.clone()
            },
        }
    }
}

impl fmt::Display for AskedFit {
    /// `model lumped-3, method differential-evolution, both responses at once`.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let steps = |together: bool| {
            if together {
                "both responses at once"
            } else {
                "one response after the other"
            }
        };
        let parts = [
            self.model.as_ref().map(|model| format!("model {model}")),
            self.method.as_ref().map(|method| format!("method {method}")),
            self.simultaneous.map(|together| steps(together).to_owned()),
        ];
        let known = self.known.iter().map(KnownParameter::to_string);
        let parts: Vec<String> = parts.into_iter().flatten().chain(known).collect();
        formatter.write_str(&parts.join(", "))
    }
}
