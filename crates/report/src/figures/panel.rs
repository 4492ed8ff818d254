//! A panel: grid, ticks, axis titles and a chart to draw series in.

use plotters::prelude::{ChartBuilder, EmptyElement, IntoFont, PathElement, Text, TextStyle};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontTransform};

use super::axis::Axis;
use super::canvas::{Area, Ink, TENTHS};
use super::group::{Group, grouped, open_panel};
use super::positions::Positions;
use super::thin::Pixels;

pub use super::canvas::Chart;

/// Size of tick labels, px.
pub const TICK_SIZE: i32 = 11;
/// Size of axis titles, px.
pub const TITLE_SIZE: i32 = 12;

/// Room around the plotting area, px.
#[derive(Debug, Clone, Copy)]
pub struct Margins {
    /// Left of it: tick labels and title.
    pub left: u32,
    /// Right of it: half a tick label.
    pub right: u32,
    /// Above it.
    pub top: u32,
    /// Below it: tick labels and title.
    pub bottom: u32,
}

/// A text style in `ink`, `size` px, anchored there.
pub fn text_style(ink: Ink, size: i32, horizontal: HPos, vertical: VPos) -> TextStyle<'static> {
    ("sans-serif", size * TENTHS)
        .into_font()
        .color(&ink.color())
        .pos(Pos::new(horizontal, vertical))
}

/// Builds a panel on `area`: grid, tick labels and titles; the axis line at the bottom where the horizontal axis has labels.
///
/// # Errors
/// The message of the drawing library.
pub fn panel<'a, 'b>(
    area: &'a Area<'b>,
    margins: Margins,
    x: &Axis,
    y: &Axis,
    x_labels: bool,
) -> Result<Chart<'a, 'b>, String> {
    let tenths = |pixels: u32| pixels as i32 * TENTHS;
    let mut chart = ChartBuilder::on(area)
        .margin_left(tenths(margins.left))
        .margin_right(tenths(margins.right))
        .margin_top(tenths(margins.top))
        .margin_bottom(tenths(margins.bottom))
        .build_cartesian_2d(Positions::from(x), Positions::from(y))
        .map_err(|error| error.to_string())?;
    open_panel(&mut chart, x, y)?;
    let axis = |level: bool, axis: &Axis| Group::Axes {
        level,
        span: axis.into(),
    };
    grouped(&mut chart, axis(false, y), |chart| upright(chart, x, y, margins))?;
    if x_labels {
        grouped(&mut chart, axis(true, x), |chart| level(chart, x, y))?;
    }
    Ok(chart)
}

/// The vertical axis: grid lines, their labels and the title.
fn upright(chart: &mut Chart, x: &Axis, y: &Axis, margins: Margins) -> Result<(), String> {
    let grid = y.ticks.iter().map(|tick| {
        let across = vec![(x.low, tick.at), (x.high, tick.at)];
        PathElement::new(across, Ink::Grid.color().stroke_width(10))
    });
    chart.draw_series(grid).map_err(|error| error.to_string())?;
    let right = text_style(Ink::Muted, TICK_SIZE, HPos::Right, VPos::Center);
    for tick in y.ticks.iter().filter(|tick| !tick.label.is_empty()) {
        label(chart, (x.low, tick.at), (-6, 0), &tick.label, &right)?;
    }
    if y.title.is_empty() {
        return Ok(());
    }
    let rotated = ("sans-serif", TITLE_SIZE * TENTHS)
        .into_font()
        .transform(FontTransform::Rotate270)
        .color(&Ink::Text.color())
        .pos(Pos::new(HPos::Center, VPos::Top));
    let left = -(margins.left as i32) + 2;
    label(
        chart,
        (x.low, 0.5 * (y.low + y.high)),
        (left, 0),
        &y.title,
        &rotated,
    )
}

/// The horizontal axis: its line with tick marks, their labels and the title.
fn level(chart: &mut Chart, x: &Axis, y: &Axis) -> Result<(), String> {
    let muted = Ink::Muted.color().stroke_width(10);
    let bottom = PathElement::new(vec![(x.low, y.low), (x.high, y.low)], muted);
    chart.draw_series([bottom]).map_err(|error| error.to_string())?;
    let marks = x
        .ticks
        .iter()
        .map(|tick| EmptyElement::at((tick.at, y.low)) + PathElement::new([(0, 0), (0, 4 * TENTHS)], muted));
    chart.draw_series(marks).map_err(|error| error.to_string())?;
    let below = text_style(Ink::Muted, TICK_SIZE, HPos::Center, VPos::Top);
    for tick in x.ticks.iter().filter(|tick| !tick.label.is_empty()) {
        label(chart, (tick.at, y.low), (0, 7), &tick.label, &below)?;
    }
    if x.title.is_empty() {
        return Ok(());
    }
    let title = text_style(Ink::Text, TITLE_SIZE, HPos::Center, VPos::Top);
    label(chart, (0.5 * (x.low + x.high), y.low), (0, 24), &x.title, &title)
}

/// Pixels per unit of the positions in `chart`.
pub fn pixels(chart: &Chart) -> Pixels {
    let (width, height) = chart.plotting_area().dim_in_pixel();
    let (across, up) = (chart.x_range(), chart.y_range());
    Pixels {
        across: f64::from(width) / f64::from(TENTHS) / (across.end - across.start),
        up: f64::from(height) / f64::from(TENTHS) / (up.end - up.start),
    }
}

/// Writes `text` at a position, moved by `shift` px (right, down).
///
/// # Errors
/// The message of the drawing library.
pub fn label(
    chart: &mut Chart,
    at: (f64, f64),
    shift: (i32, i32),
    text: &str,
    style: &TextStyle<'static>,
) -> Result<(), String> {
    let moved = (shift.0 * TENTHS, shift.1 * TENTHS);
    let element = EmptyElement::at(at) + Text::new(text.to_owned(), moved, style.clone());
    chart
        .draw_series([element])
        .map(|_| ())
        .map_err(|error| error.to_string())
}
