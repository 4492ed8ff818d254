//! Models of an actuator: geometry, circuits, back-relaxation, the lumped and the distributed electromechanical
//! model, and the rival models that they are compared with. The classical ones are built for tests, which hold the laws of
//! bending against them.

pub mod bending;
pub mod changing;
pub mod choice;
pub mod circuit;
#[cfg(test)]
mod classical;
pub mod coupling;
pub mod course;
pub mod distributed;
pub mod effects;
pub mod extended;
pub mod frequency;
pub mod geometry;
pub mod impedance;
pub mod lumped;
pub mod ode;
mod open_circuit;
pub mod registry;
pub mod relaxation;
pub mod scaling;

pub use bending::{BendingLaw, bending_law, rival_law};
pub use choice::{ChoiceError, ModelChoice};
pub use circuit::EquivalentCircuit;
pub use distributed::{DistributedModel, Laminate};
pub use lumped::{Branch, LumpedModel};
pub use registry::{FitModel, ParameterDescription, fit_model, fit_models, law_of_parameter};
