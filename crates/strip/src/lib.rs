//! The strip seen from its side: from a picture to its centre line and its curvature along it.
//!
//! Nothing here knows of files, campaigns or pages: bytes of a picture come in, geometry goes out. A strip is dark on
//! bright ground or the reverse, held at one side of the picture; it may turn through any angle. What cannot be traced
//! is refused with the reason ([`Untraceable`]).

mod believed;
mod bending;
mod curve;
mod decode;
mod edges;
mod first_curve;
mod gray;
mod ground;
mod march;
mod overlay;
mod refusal;
mod silhouette;
mod smooth;
mod spline;
mod steady;
mod thickness;
mod tip;
mod trace;
mod traced;

use serde::Deserialize;

pub use bending::{Bending, Initial, OtherLength, Positive, Reading, Scale};
pub use decode::{DecodeError, ENDINGS, decode, format};
pub use gray::{Crop, Gray};
pub use overlay::overlay;
pub use refusal::Untraceable;
pub use trace::trace;
pub use traced::Trace;

/// Version of what is traced: it rises where the same picture gives other numbers, so that folders are traced anew.
pub const VERSION: u32 = 2;

/// Whether the strip is darker or brighter than what lies behind it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Tone {
    /// A shadow before a lit ground.
    Dark,
    /// A lit strip before a dark ground.
    Bright,
}

impl Tone {
    /// Both.
    pub const ALL: [Tone; 2] = [Tone::Dark, Tone::Bright];

    /// `dark` or `bright`.
    pub fn key(self) -> &'static str {
        match self {
            Tone::Dark => "dark",
            Tone::Bright => "bright",
        }
    }
}

/// A side of the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// x = 0.
    Left,
    /// x = width.
    Right,
    /// y = 0.
    Top,
    /// y = height.
    Bottom,
}

impl Side {
    /// All four, in the order of their indices.
    pub const ALL: [Side; 4] = [Side::Left, Side::Right, Side::Top, Side::Bottom];

    /// `left`, `right`, `top` or `bottom`.
    pub fn key(self) -> &'static str {
        match self {
            Side::Left => "left",
            Side::Right => "right",
            Side::Top => "top",
            Side::Bottom => "bottom",
        }
    }

    /// Its place in [`Side::ALL`].
    fn index(self) -> usize {
        self as usize
    }

    /// Direction from the side into the picture.
    fn inward(self) -> (f64, f64) {
        match self {
            Side::Left => (1.0, 0.0),
            Side::Right => (-1.0, 0.0),
            Side::Top => (0.0, 1.0),
            Side::Bottom => (0.0, -1.0),
        }
    }

    /// Direction along the side.
    fn along(self) -> (f64, f64) {
        match self {
            Side::Left | Side::Right => (0.0, 1.0),
            Side::Top | Side::Bottom => (1.0, 0.0),
        }
    }
}

/// What is known of a view before it is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct View {
    /// The part of the picture with the free strip; none: all of it.
    pub crop: Option<Crop>,
    /// The side where the strip leaves the clamp; none: the only side that it reaches.
    pub clamp: Option<Side>,
    /// Dark or bright; none: what the picture shows.
    pub tone: Option<Tone>,
}
