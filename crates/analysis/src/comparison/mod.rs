//! Comparison of conditions: parameters against covariates, ratios to a reference condition, and what is not measured.

pub mod against;
pub mod coverage;
pub mod ratios;
