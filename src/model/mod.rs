//! Models of an actuator: circuits, back-relaxation, the lumped electromechanical model.

pub mod lumped;
pub mod ode;
mod open_circuit;
pub mod registry;
pub mod relaxation;

pub use lumped::{Branch, LumpedModel};
pub use registry::{FitModel, ParameterDescription, fit_model, fit_models};
