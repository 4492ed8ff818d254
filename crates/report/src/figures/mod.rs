//! Figures as inline SVG, drawn by plotters: one file per kind.

pub mod along;
pub mod aside;
pub mod axis;
pub mod calendar;
pub mod canvas;
pub mod cells;
pub mod colors;
pub mod comparison;
pub mod drive;
pub mod group;
mod ink;
pub mod law;
pub mod overlaid;
pub mod panel;
mod positions;
pub mod profile;
pub mod residual;
pub mod response;
mod shape;
pub mod svg;
pub mod thin;

pub use canvas::{Ink, svg};
