//! What every candidate effect answers.

use std::fmt;

use super::about::About;
use super::search::{Scale, Search};
use crate::extended::{RunContext, System};

/// An effect that the model may be missing.
pub trait Effect: Sync {
    /// What is known of it.
    fn about(&self) -> &'static About;

    /// Where its parameters are sought in data of that scale, and the shapes at which its signature is looked for.
    fn search(&self, variant: usize, scale: &Scale) -> Search;

    /// Whether it changes the run at that place of its group.
    fn acts_in(&self, _parameters: &[f64], _run: usize) -> bool {
        true
    }

    /// Puts it into the system of a run. `parameters` are in the order of [`About::parameters`].
    fn apply(&self, variant: usize, parameters: &[f64], run: &RunContext, system: &mut System);
}

/// What the file of an effect of the list states.
pub(super) trait Equation: Sync {
    /// What is known of it.
    const ABOUT: &'static About;

    /// As [`Effect::search`]; of the bending where it was read.
    fn search(&self, variant: usize, scale: &Scale) -> Search;

    /// As [`Effect::acts_in`].
    fn acts_in(&self, _parameters: &[f64], _run: usize) -> bool {
        true
    }

    /// As [`Effect::apply`].
    fn apply(&self, variant: usize, parameters: &[f64], run: &RunContext, system: &mut System);
}

/// An effect with its parameters.
#[derive(Clone)]
pub struct Applied {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// Place in [`About::variants`]; 0 where it has none.
    pub variant: usize,
    /// Parameters in the order of [`About::parameters`].
    pub parameters: Vec<f64>,
}

impl Applied {
    /// The same effect in the same form with these parameters.
    pub fn with(&self, parameters: &[f64]) -> Applied {
        Applied {
            parameters: parameters.to_vec(),
            ..self.clone()
        }
    }
}

impl fmt::Debug for Applied {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let id = self.effect.about().id;
        write!(out, "{id} {} {:?}", self.variant, self.parameters)
    }
}

impl PartialEq for Applied {
    fn eq(&self, other: &Applied) -> bool {
        let all = |own: &Applied| (own.effect.about().id, own.variant);
        all(self) == all(other) && self.parameters == other.parameters
    }
}
