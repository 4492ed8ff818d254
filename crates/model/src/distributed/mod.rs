//! The distributed model, thesis (21)-(26): electrodes that resist along the strip, so that it charges from the
//! clamp and bends unevenly.
//!
//! Per unit length an R-C chain beside R_ss lies between electrodes of resistance R_e (both together). A step V0
//! at the clamp of the discharged strip is solved in closed form (`series`), any piecewise-constant drive by a
//! chain of cells (`ladder`), any number of branches under
//! held drives in modes that are lumped circuits (`branched`), a strip whose electrodes resist more beyond a place by modes (`broken`); `criterion` says when the lumped model is enough.

pub mod branched;
pub mod broken;
pub mod criterion;
pub mod driven;
pub mod field;
mod heads;
mod kernel;
pub mod ladder;
mod model;
mod partial;
pub mod series;
#[cfg(test)]
mod tests;

pub use broken::BrokenStrip;
pub use criterion::LumpedError;
pub use driven::DrivenStrip;
pub use field::StripField;
pub use ladder::{Ladder, LadderError, LadderResponse};
pub use model::{DistributedModel, Laminate};
