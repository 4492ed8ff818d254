//! What the simulation gets wrong: shown, named, put right, and the gain measured.
//!
//! A group of runs of one sample in one condition is fitted with one parameter set of the base model. The refitted
//! residuals are asked for every known effect's signature and for any smooth shape; how large the answers become
//! by chance is simulated. Where that is too much, every law of the model is asked as a smooth function of every variable, beside
//! the library's equations, runs that differ and what has no name. What is said follows from how large the misfit is, what of it
//! each explanation takes, how probable each is, and whether it predicts held-out readings.
//!
//! The rooms in this order, each of which uses those before it: `readings`, `fitting`, `misfit`, `cause`, `missing`, `outcome`.
//! Beside them `extended`, where the effects are given, and `benchmark`, what a diagnosis is held against.

mod benchmark;
mod cause;
mod diagnosis;
mod draws;
mod extended;
mod fitting;
mod levels;
mod misfit;
mod missing;
mod options;
mod outcome;
mod readings;
#[cfg(test)]
mod tests;

pub use benchmark::effect_size::{
    DesignRun, KnownNoise, base_columns, in_units_of_noise, sigmas_after_refit,
};
pub use diagnosis::{condemned, diagnose_group};
pub use draws::Draws;
pub use extended::fits::{fit_extended, model_version};
pub use extended::from_others::{FromOthersFall, fall_from_others};
pub use extended::laws::laws_of;
pub use options::{AbsentLaw, DiagnoseOptions, VERSION};
pub use outcome::lengthwise::with_places;
pub use outcome::next_run::proposals;
pub use readings::group::RunInput;
