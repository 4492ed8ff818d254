//! Which parameter follows which covariate from run to run, and by which law.
//!
//! The fitted parameters of all runs of a material are compared, as logarithms: runs within samples where a covariate
//! differs there, samples where it does not. Covariates that the design ties together are one question. Environment
//! and voltage are factors of the design and are taken out; samples have a level of their own.

pub mod chance_of;
pub mod covariate;
pub mod dependence;
pub mod design;
pub mod doubt;
pub mod facts;
pub mod find;
pub mod fitted;
pub mod jump;
pub mod matrix;
pub mod offset;
pub mod parts;
pub mod policy;
mod resolution;
pub mod rivals;
pub mod samples;
pub mod selection;
pub mod shape;
pub mod table;
pub mod values;
pub mod words;

#[cfg(test)]
mod hidden_tests;
#[cfg(test)]
mod rivals_tests;

pub use covariate::Covariate;
pub use dependence::Dependence;
pub use find::{CampaignLaws, Evidence, OfHumidity, find};
pub use selection::Attempt;
