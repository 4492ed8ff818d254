//! Numerical methods that know nothing of actuators.

pub mod correlation;
pub mod decay;
pub mod gram;
pub mod jacobi;
pub mod levenberg;
pub mod noise;
pub mod nonnegative;
pub mod ode;
pub mod student;
pub mod symmetric;
