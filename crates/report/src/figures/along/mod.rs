//! What is drawn of a strip and is no chart: maps of curvature over place and time, shapes.

pub mod frames;
pub mod key;
pub mod map;
pub mod shapes;
