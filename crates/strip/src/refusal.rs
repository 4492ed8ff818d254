//! Why a strip cannot be traced in a picture. A frame is refused rather than guessed.

use ieap_domain::number::fixed;
use thiserror::Error;

/// What is wrong with the view, with what would mend it. Places are pixels of the whole picture, from the top left.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Untraceable {
    /// The crop reaches beyond the picture.
    #[error(
        "the crop of {width} x {height} pixels at ({left}, {top}) reaches beyond the picture of {picture_width} x {picture_height} pixels. Mend `crop_px`"
    )]
    Crop {
        /// First column asked for.
        left: usize,
        /// First row asked for.
        top: usize,
        /// Columns asked for.
        width: usize,
        /// Rows asked for.
        height: usize,
        /// Columns there are.
        picture_width: usize,
        /// Rows there are.
        picture_height: usize,
    },
    /// Too few pixels to look for anything.
    #[error("the picture has {width} x {height} pixels, needed {needed} or more to a side")]
    TooSmall {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// Columns and rows needed.
        needed: usize,
    },
    /// Nothing stands out from the ground.
    #[error(
        "nothing in the picture stands out from its ground: the contrast is {} of the full scale and the noise {}. Is the strip in view, and lit from behind?",
        fixed(*.contrast, 3),
        fixed(*.noise, 3)
    )]
    Empty {
        /// Contrast found, share of the full scale.
        contrast: f64,
        /// Noise of the ground, share of the full scale.
        noise: f64,
    },
    /// As much is brighter than the ground as is darker.
    #[error(
        "as much in the picture is brighter than its ground as is darker. Say `strip = \"dark\"` or \"bright\", or crop the picture to the strip"
    )]
    Tone,
    /// What stands out most reaches no side.
    #[error(
        "the strip reaches no side of the picture: the largest thing lies around ({}, {}). Crop the picture (`crop_px`) so that one side is where the strip leaves the clamp",
        fixed(*.x, 0),
        fixed(*.y, 0)
    )]
    NoSide {
        /// Column of its middle.
        x: f64,
        /// Row of its middle.
        y: f64,
    },
    /// It reaches several sides, and nobody said which is the clamp.
    #[error(
        "the strip reaches {sides}: say which is the clamp (`clamp`), or crop the picture so that the strip ends inside"
    )]
    SeveralSides {
        /// The sides.
        sides: String,
    },
    /// Nothing reaches the side of the clamp.
    #[error("no strip leaves the {side} side, which is said to be the clamp. Mend `clamp` or `crop_px`")]
    NotAtClamp {
        /// The side.
        side: &'static str,
    },
    /// More than one strip, or something as large beside it.
    #[error(
        "two things may be the strip: one around ({}, {}) and one around ({}, {}). Crop the picture to the strip",
        fixed(*.x, 0),
        fixed(*.y, 0),
        fixed(*.other_x, 0),
        fixed(*.other_y, 0)
    )]
    TwoThings {
        /// Column of the middle of the first.
        x: f64,
        /// Its row.
        y: f64,
        /// Column of the middle of the second.
        other_x: f64,
        /// Its row.
        other_y: f64,
    },
    /// Too short against its thickness to have a centre line.
    #[error(
        "what leaves the clamp is {} pixels long and {} thick: that is no strip. Is the clamp itself in view? Crop it away (`crop_px`)",
        fixed(*.length, 0),
        fixed(*.width, 0)
    )]
    NoStrip {
        /// Length that could be followed, pixels.
        length: f64,
        /// Thickness, pixels.
        width: f64,
    },
    /// Thicker at the clamp than further out: the clamp is in view.
    #[error(
        "what leaves the {side} side is {} pixels thick there and {} further out: the clamp is in view. Crop it away (`crop_px`)",
        fixed(*.at_side, 0),
        fixed(*.further, 0)
    )]
    ClampInView {
        /// The side.
        side: &'static str,
        /// Thickness at the side, pixels.
        at_side: f64,
        /// Thickness of the strip, pixels.
        further: f64,
    },
    /// The tip is not in the picture.
    #[error("the strip leaves the picture at ({}, {}): its tip is not in view", fixed(*.x, 0), fixed(*.y, 0))]
    LeavesPicture {
        /// Column.
        x: f64,
        /// Row.
        y: f64,
    },
    /// The strip does not end as a strip does.
    #[error(
        "the strip has no clear end around ({}, {}): something lies at its tip, or it fades out",
        fixed(*.x, 0),
        fixed(*.y, 0)
    )]
    NoTip {
        /// Column.
        x: f64,
        /// Row.
        y: f64,
    },
    /// Too long a stretch is hidden.
    #[error(
        "the strip is not seen for {} of its {} pixels around ({}, {}): a reflection, or something before it",
        fixed(*.gap, 0),
        fixed(*.length, 0),
        fixed(*.x, 0),
        fixed(*.y, 0)
    )]
    Hidden {
        /// Length of the longest stretch that is not seen, pixels.
        gap: f64,
        /// Length of the strip, pixels.
        length: f64,
        /// Column of its middle.
        x: f64,
        /// Row of its middle.
        y: f64,
    },
    /// Its edges are too uneven to follow.
    #[error(
        "the edges of the strip scatter by {} pixels about a smooth line, more than {}: the picture is blurred, or this is no strip",
        fixed(*.scatter, 1),
        fixed(*.allowed, 1)
    )]
    Scatter {
        /// Scatter, pixels.
        scatter: f64,
        /// What is allowed, pixels.
        allowed: f64,
    },
    /// A good part of what is connected with the strip does not lie along the traced line.
    #[error(
        "{} % of what is connected with the traced strip does not lie along it, around ({}, {}): crop it away, or look at the picture",
        fixed(*.percent, 0),
        fixed(*.x, 0),
        fixed(*.y, 0)
    )]
    Branches {
        /// Share of its pixels, percent.
        percent: f64,
        /// Column of the middle of that part.
        x: f64,
        /// Its row.
        y: f64,
    },
}

impl Untraceable {
    /// The same with its places moved by the corner of a crop, so that they are those of the whole picture.
    pub(super) fn moved(mut self, (left, top): (f64, f64)) -> Untraceable {
        use Untraceable as U;
        match &mut self {
            U::NoSide { x, y }
            | U::LeavesPicture { x, y }
            | U::NoTip { x, y }
            | U::Hidden { x, y, .. }
            | U::Branches { x, y, .. } => {
                *x += left;
                *y += top;
            }
            U::TwoThings {
                x,
                y,
                other_x,
                other_y,
            } => {
                *x += left;
                *y += top;
                *other_x += left;
                *other_y += top;
            }
            _ => {}
        }
        self
    }
}
