//! From one strip to another of the same laminate: what carries over, and what a strip of another size will do.
//!
//! Areal resistances and capacitances, the electrodes' resistance per square and the relaxation rate belong to the
//! laminate. Alpha per total charge belongs to one strip (see `coupling`): it carries over with the inverse area.
//! The dimensions' own errors enter where a number depends on them, and only there.

mod carry_over;
pub mod prediction;
pub mod propagation;
mod size;

pub use carry_over::{ScalingError, lumped_model};
pub use prediction::{CarriedBy, Prediction, Series, predict};
pub use propagation::Identified;
pub use size::StripSize;
