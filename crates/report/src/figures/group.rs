//! What shapes belong together: panels with their axes, and series. A page's script reads numbers back from the
//! shapes by it, so that no number is stored twice; nothing of it is seen.

use plotters::element::{Drawable, PointCollection};
use plotters_backend::{BackendCoord, DrawingErrorKind};

use super::axis::Axis;
use super::canvas::{Canvas, Chart, Shape};

pub use super::shape::{Group, Span};

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
