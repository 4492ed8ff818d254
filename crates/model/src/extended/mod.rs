//! The lumped model with effects added: simulated under any piecewise-constant drive by exact steps of its linear
//! parts, the rest held at the middle of each step.
//!
//! Without effects every step is exact, so the result is the closed form; with them the error falls with the square
//! of the step and with the strength of the effect.

mod grid;
mod knots;
mod model;
mod node;
mod source;
mod stepper;
mod system;
#[cfg(test)]
pub(crate) mod tests;

pub use grid::Grids;
pub use model::ExtendedModel;
pub use stepper::Responses;
pub use system::{
    BranchLaw, CameraClock, Coefficients, Law, Now, Observation, RelaxationMode, RunContext, System, TagAt,
    Written,
};
