//! Numerical methods that know nothing of actuators.

pub mod active_set;
pub mod chance;
pub mod column_memory;
pub mod complex;
pub mod control_chart;
pub mod correlation;
pub mod decay;
pub mod discrete_gauss;
pub mod global;
pub mod gram;
pub mod grouped;
pub mod harmonic;
pub mod householder;
pub mod interrupt;
pub mod least_squares;
pub mod line;
pub mod linear;
pub mod local_parabola;
pub mod mixed;
pub mod noise;
pub mod ode;
#[cfg(test)]
mod problems;
pub mod products;
pub mod random_effects;
pub mod robust;
pub mod rosenbrock;
pub mod slopes;
pub mod student;
pub mod sums;
pub mod symmetric;
pub mod waveform;
