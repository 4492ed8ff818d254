//! Impedance spectra beside the steps of the same sample: is it the same circuit?
//!
//! A step and a spectrum ask the same strip at other voltages, times and currents. Where they disagree, which numbers
//! do says which effect is at work: a leak above an onset is seen by the step alone, a series resistance stands in the
//! spectrum first.

mod beside;
mod one_likelihood;
mod words;

pub use beside::{BesideRow, Comparison, StepSide, comparisons};
pub use one_likelihood::{Both, OneLikelihood};
pub use words::describe;
