//! How a strip is looked at: which part of the picture, from which side it comes, before which ground.

use serde::Deserialize;

use super::gray::Crop;

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
    pub(super) fn index(self) -> usize {
        self as usize
    }

    /// Direction from the side into the picture.
    pub(super) fn inward(self) -> (f64, f64) {
        match self {
            Side::Left => (1.0, 0.0),
            Side::Right => (-1.0, 0.0),
            Side::Top => (0.0, 1.0),
            Side::Bottom => (0.0, -1.0),
        }
    }

    /// Direction along the side.
    pub(super) fn along(self) -> (f64, f64) {
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
