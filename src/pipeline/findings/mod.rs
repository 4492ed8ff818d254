//! From readings and fits to what is found: misfits and causes, models compared, moduli, spectra, what holds across runs.

pub(super) mod adopt;
pub mod alarms;
pub mod blocked;
pub(super) mod compare;
pub mod current;
pub(super) mod diagnose;
pub(super) mod frequency;
pub mod impedance;
pub(crate) mod kept;
pub(super) mod model_free;
pub(super) mod modulus;
pub mod next_runs;
pub mod one_likelihood;
pub mod reductions;
pub mod strip_modulus;
pub mod study;
pub mod study_plan;
