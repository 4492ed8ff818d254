//! How probable the readings are under everything that may be behind them, and what follows.
//!
//! Every hypothesis is asked the same: how probable are these readings under it? The base alone, the base with one or two
//! effects of the library, parameters that are not one number for the group, slow noise, something that has no name, and an
//! effect with such a thing beside it. No equation of an effect is exact, so that its trace may be off by a smooth factor
//! ([`form_error`]). What is believed before any reading stands in [`policy`], and the verdict follows from the masses.

mod form_error;
mod laplace;
mod own;
mod policy;
mod posterior;
mod shared;
mod smooth;
mod unnamed;
mod varies;
mod verdict;

pub(crate) use policy::log_odds_of_no_cause;
pub(crate) use posterior::{Asked, weigh};
pub(crate) use varies::follow_something;
pub use verdict::{by_evidence, set_of};
pub(crate) use verdict::{is_slow_noise, of_one_name};
