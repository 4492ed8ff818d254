//! How probable the readings are under what may be behind them: an equation at the place where it fits best, parameters that are
//! not one number for the group, slow noise. What is believed before any reading stands in
//! [`policy`].

pub(crate) mod by_voltage;
mod laplace;
mod own;
mod policy;
mod shared;
mod slow_noise;
mod smooth;
mod varies;

pub(crate) use laplace::log_evidence;
pub(crate) use policy::{SIZES, grid, log_mean, log_sum};
pub(crate) use slow_noise::{Parts, slow_noise};
pub(crate) use smooth::{Column, Process};
pub(crate) use varies::Varying;
