//! Numerical methods that know nothing of actuators.

pub mod ode;
pub mod symmetric;
