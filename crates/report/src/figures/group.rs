//! What shapes belong together: panels with their axes, and series. A page's script reads numbers back from the
//! shapes by it, so that no number is stored twice; nothing of it is seen.

use plotters::element::{Drawable, PointCollection};
use plotters_backend::{BackendCoord, DrawingErrorKind};

use super::axis::{Axis, Scale};
use super::canvas::{Canvas, Shape};
use super::panel::Chart;

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

/// Opens the panel of `chart`.
///
/// # Errors
/// The message of the drawing library.
pub fn open_panel(chart: &mut Chart, x: &Axis, y: &Axis) -> Result<(), String> {
    let (across, down) = chart.plotting_area().get_pixel_range();
    let group = Group::Panel {
        frame: [across.start, down.start, across.end, down.end],
        x: x.into(),
        y: y.into(),
    };
    note(chart, Shape::Open(group))
}

/// Draws a group.
///
/// # Errors
/// The message of the drawing library, or of `draw`.
pub fn grouped<'a, 'b>(
    chart: &mut Chart<'a, 'b>,
    group: Group,
    draw: impl FnOnce(&mut Chart<'a, 'b>) -> Result<(), String>,
) -> Result<(), String> {
    note(chart, Shape::Open(group))?;
    draw(chart)?;
    note(chart, Shape::Close)
}

/// Draws a series that readouts call `name`.
///
/// # Errors
/// The message of the drawing library, or of `draw`.
pub fn series<'a, 'b>(
    chart: &mut Chart<'a, 'b>,
    name: &str,
    draw: impl FnOnce(&mut Chart<'a, 'b>) -> Result<(), String>,
) -> Result<(), String> {
    grouped(chart, readings(name, false, false), draw)
}

/// Draws a series that no result is made from.
///
/// # Errors
/// The message of the drawing library, or of `draw`.
pub fn aside_series<'a, 'b>(
    chart: &mut Chart<'a, 'b>,
    name: &str,
    draw: impl FnOnce(&mut Chart<'a, 'b>) -> Result<(), String>,
) -> Result<(), String> {
    grouped(chart, readings(name, false, true), draw)
}

/// A series whose points lead to no runs; `aside` where no result is made from it.
pub fn readings(name: &str, to_the_pixel: bool, aside: bool) -> Group {
    Group::Series {
        name: name.to_owned(),
        runs: Vec::new(),
        form: 0,
        to_the_pixel,
        aside,
    }
}

/// Puts a shape on the canvas as it is.
///
/// # Errors
/// The message of the drawing library.
pub fn note(chart: &mut Chart, shape: Shape) -> Result<(), String> {
    let corner = (chart.x_range().start, chart.y_range().start);
    let note = Note { corner, shape };
    let drawn = chart.plotting_area().draw(&note);
    drawn.map_err(|error| error.to_string())
}

/// Hands a shape to the canvas as it is.
struct Note {
    corner: (f64, f64),
    shape: Shape,
}

impl<'a> PointCollection<'a, (f64, f64)> for &'a Note {
    type Point = &'a (f64, f64);
    type IntoIter = std::iter::Once<&'a (f64, f64)>;

    fn point_iter(self) -> Self::IntoIter {
        std::iter::once(&self.corner)
    }
}

impl<'b> Drawable<Canvas<'b>> for Note {
    fn draw<I: Iterator<Item = BackendCoord>>(
        &self,
        _at: I,
        canvas: &mut Canvas<'b>,
        _size: (u32, u32),
    ) -> Result<(), DrawingErrorKind<std::convert::Infallible>> {
        canvas.shapes.push(self.shape.clone());
        Ok(())
    }
}
