//! What a drawing consists of: shapes, counted in tenths of a pixel, and the groups that they belong to.

use plotters_backend::text_anchor::HPos;
use plotters_backend::{BackendColor, BackendCoord};

use super::axis::{Axis, Scale};
use super::cells::Cells;

/// Width of a figure on a page, px: on a telephone, which leaves it some 380, its labels still have 10 px.
pub const PAGE_WIDTH: u32 = 410;
/// Canvas units per pixel.
pub const TENTHS: i32 = 10;

/// A finished drawing.
#[derive(Clone)]
pub struct Drawing {
    /// Width and height, tenths of a pixel.
    pub size: (u32, u32),
    /// Shapes from back to front.
    pub shapes: Vec<Shape>,
}

/// One shape; positions and widths in tenths of a pixel.
#[derive(Clone)]
pub enum Shape {
    /// An open line.
    Stroke {
        /// Corners.
        points: Vec<BackendCoord>,
        /// Width.
        width: u32,
        /// Colour with opacity.
        color: BackendColor,
    },
    /// A filled polygon.
    Fill {
        /// Corners.
        points: Vec<BackendCoord>,
        /// Colour with opacity.
        color: BackendColor,
    },
    /// A filled circle.
    Dot {
        /// Centre.
        at: BackendCoord,
        /// Radius.
        radius: u32,
        /// Colour with opacity.
        color: BackendColor,
    },
    /// A circle's line.
    Ring {
        /// Centre.
        at: BackendCoord,
        /// Radius.
        radius: u32,
        /// Width.
        width: u32,
        /// Colour with opacity.
        color: BackendColor,
    },
    /// Cells of a map.
    Cells(Cells),
    /// One line of text.
    Text(Label),
    /// The shapes up to its [`Shape::Close`], or of a panel up to the next panel, belong together. Nothing is seen of it.
    Open(Group),
    /// Ends the innermost group that is no panel.
    Close,
}

/// One line of text.
#[derive(Clone)]
pub struct Label {
    /// Text as it came, nothing escaped.
    pub text: String,
    /// Position of the anchor on the base line, before turning.
    pub at: BackendCoord,
    /// Size, tenths of a pixel.
    pub size: f64,
    /// Which end of the text the anchor is.
    pub anchor: HPos,
    /// Whether it runs upward.
    pub upward: bool,
    /// Colour with opacity.
    pub color: BackendColor,
}

/// A group of shapes.
#[derive(Debug, Clone, PartialEq)]
pub enum Group {
    /// A panel: its plotting area and what its ends mean.
    Panel {
        /// Left, top, right and bottom of the plotting area, tenths of a pixel.
        frame: [i32; 4],
        /// Horizontal axis.
        x: Span,
        /// Vertical axis.
        y: Span,
    },
    /// One axis, vertical or horizontal: grid or line, ticks, their labels and the title. Its lines and labels are drawn
    /// anew when a panel shows another range.
    Axes {
        /// Whether it is the horizontal one.
        level: bool,
        /// The range that it shows.
        span: Span,
    },
    /// One series.
    Series {
        /// What readouts call it; empty for what has no numbers to read, as a band or a limit.
        name: String,
        /// Index of the run that each point stands for; empty where points are readings of one run.
        runs: Vec<usize>,
        /// Which form its dots have, from round on: see [`super::svg::FORMS`].
        form: usize,
        /// Whether dots stand on whole pixels: for scatter, whose places nobody reads finer.
        to_the_pixel: bool,
        /// Whether no result is made from it: its dots are open, and a line is pale and dashed.
        aside: bool,
    },
}

/// The range that an axis shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// How numbers become positions.
    pub scale: Scale,
    /// Number at the left or lower end, in the title's unit; its logarithm on a log axis.
    pub low: f64,
    /// Number at the other end.
    pub high: f64,
}

impl From<&Axis> for Span {
    fn from(axis: &Axis) -> Span {
        Span {
            scale: axis.scale,
            low: axis.low * axis.shown_factor,
            high: axis.high * axis.shown_factor,
        }
    }
}
