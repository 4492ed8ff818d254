//! Impedance spectra: each by itself, and beside the steps of the same sample: is it the same circuit?
//!
//! A step and a spectrum ask the same strip at other voltages, times and currents. Where they disagree, which numbers
//! do says which effect is at work: a leak above an onset is seen by the step alone, a series resistance stands in the
//! spectrum first.

mod beside;
mod charts;
mod document;
mod one_likelihood;
pub mod sheet;
mod view;
mod words;

pub use beside::{BesideRow, Comparison, StepSide, comparisons};
pub use document::{Spectra, SweepDocument};
pub use one_likelihood::{Both, OneLikelihood};
pub use view::{findings, view};
pub use words::describe;
