//! Candidate effects: what the lumped model may be missing. One file each, one list.
//!
//! An effect says where it acts in a [`System`], within which limits its parameters are sought, and at which
//! shapes its signature is looked for. At strength 0 (the first parameter) it is absent.

mod about;
mod contact_break;
mod faradaic_leak;
mod joule_heating;
mod mechanical_lag;
mod partial_relaxation;
mod search;
mod series_resistance;
mod slow_branch;
#[cfg(test)]
mod tests;
mod tip_formula;
mod voltage_dependent_capacitance;

pub use about::{About, Class, EffectParameter};
pub use search::{Limits, Scale, Search};

use super::extended::{RunContext, System};

/// An effect that the model may be missing.
pub trait Effect: Sync {
    /// What is known of it.
    fn about(&self) -> &'static About;

    /// Where its parameters are sought in data of that scale, and the shapes at which its signature is looked for.
    fn search(&self, variant: usize, scale: &Scale) -> Search;

    /// Puts it into the system of a run. `parameters` are in the order of [`About::parameters`].
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

/// Every effect that can be simulated and fitted, in the order of the catalogue.
pub static ALL: &[&dyn Effect] = &[
    &series_resistance::SeriesResistance,
    &slow_branch::SlowBranch,
    &voltage_dependent_capacitance::VoltageDependentCapacitance,
    &faradaic_leak::FaradaicLeak,
    &contact_break::ContactBreak,
    &partial_relaxation::PartialRelaxation,
    &mechanical_lag::MechanicalLag,
    &joule_heating::JouleHeating,
    &tip_formula::TipFormula,
];

/// The effect of that id.
pub fn effect(id: &str) -> Option<&'static dyn Effect> {
    ALL.iter().copied().find(|effect| effect.about().id == id)
}
