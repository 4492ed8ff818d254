//! Verbs that need no campaign: readings at hand, simulations, forecasts, plans of a run, looks at files.

pub mod convert;
pub mod forward;
pub mod in_memory;
pub(super) mod init;
pub mod inspect;
pub mod preflight;
pub mod profile;
pub mod simulate;
