//! How probable the readings are under everything that may be behind them.
//!
//! Every hypothesis is asked the same: how probable are these readings under it? The base alone, the base with one or more
//! effects of the library, parameters that are not one number for the group, slow noise, something that has no name, and an
//! effect with such a thing beside it. They exclude each other, and their probabilities sum to one. No equation of an effect
//! is exact, so that effects are held against each other at a [temperature](policy::temperature). What is believed before any
//! reading stands in [`policy`]; what is said of it all is decided in [`super::decide`].

mod laplace;
mod own;
mod policy;
mod posterior;
mod shared;
mod smooth;
mod unnamed;
mod varies;

pub(crate) use laplace::log_evidence;
pub(crate) use policy::{LARGEST_SET, SURE, grid, log_mean, log_odds_of_no_cause, log_sum};
pub(crate) use posterior::{Asked, Standing, Weighed, weigh};
pub(crate) use smooth::{Column, Process};
pub(crate) use unnamed::{Nameless, Parts};
pub(crate) use varies::{Varying, follow_something};
