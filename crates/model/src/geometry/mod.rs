//! Geometry and statics of a bent strip, thesis (3)-(11): what is measured at one point, and the whole shape.

pub mod arc;
pub mod blocking;
pub mod conversion;
pub mod shape;
pub mod stiffness;
pub mod strain;

pub use arc::{curvature_from_displacement, displacement_from_curvature};
pub use shape::Shape;
pub use stiffness::CrossSection;
