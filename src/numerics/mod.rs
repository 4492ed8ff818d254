//! Numerical methods that know nothing of actuators.
