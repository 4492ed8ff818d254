//! Families of lines: panels, each with its own legend, of curves that are given as numbers.

use plotters::element::Circle;
use plotters::series::LineSeries;
use plotters::style::Color;

use super::grid::{Panel, draw_entries, grid};
use crate::figures::axis::Axis;
use crate::figures::canvas::{Area, Drawing, Ink, TENTHS};
use crate::figures::comparison::{ink, marker};
use crate::figures::panel::{Margins, panel};
use ieap_domain::range_of;

const MARGINS: Margins = Margins {
    left: 54,
    right: 12,
    top: 4,
    bottom: 44,
};
/// Markers on a line: lines are told apart without colour.
const MARKERS: usize = 5;
/// Opacity of measured dots.
const PALE: f64 = 0.45;

/// Several panels.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Family {
    /// Panels in reading order.
    pub panels: Vec<FamilyPanel>,
    /// Panels side by side at most.
    pub columns: usize,
    /// Height of a panel, px.
    pub panel_height: u32,
    /// Legend of all panels: name and style.
    pub legend: Vec<(String, usize)>,
    /// Notes below.
    pub notes: Vec<String>,
}

/// One panel.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FamilyPanel {
    /// Title.
    pub title: String,
    /// Quantity and unit of the horizontal axis.
    pub x: (String, String),
    /// The same of the vertical one.
    pub y: (String, String),
    /// Half height that is shown at least about zero, for residuals; none where the lines set the axis.
    pub about_zero: Option<f64>,
    /// Measured values: dots.
    pub dots: Vec<(f64, f64)>,
    /// Lines with their styles; a name stands in the panel's own legend.
    pub lines: Vec<FamilyLine>,
}

/// One line.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FamilyLine {
    /// Name in the panel's legend; empty where the family's names it.
    pub name: String,
    /// Colour and marker.
    pub style: usize,
    /// Its points.
    pub points: Vec<(f64, f64)>,
}

impl Family {
    /// Draws it, `width` px wide.
    ///
    /// # Errors
    /// There is no panel, or the message of the drawing library.
    pub fn draw(&self, width: u32) -> Result<Drawing, String> {
        let panels: Vec<Panel> = self
            .panels
            .iter()
            .map(|own| Panel {
                title: own.title.clone(),
                draw: Box::new(move |area| own.draw(area)),
            })
            .collect();
        let legend = self
            .legend
            .iter()
            .map(|(name, style)| (name.clone(), ink(*style)));
        let legend: Vec<(String, Ink)> = legend.collect();
        grid(
            width,
            self.columns,
            self.panel_height,
            &legend,
            &panels,
            &self.notes,
        )
    }
}

impl FamilyPanel {
    fn draw(&self, area: &Area) -> Result<(), String> {
        let (width, _) = area.dim_in_pixel();
        let legend: Vec<(String, Ink)> = self
            .lines
            .iter()
            .filter(|line| !line.name.is_empty())
            .map(|line| (line.name.clone(), ink(line.style)))
            .collect();
        let below = draw_entries(area, width as i32 / TENTHS, &legend)?;
        let (x, y) = self.axes();
        let mut chart = panel(&below, MARGINS, &x, &y, true)?;
        let shown = |points: &[(f64, f64)]| -> Vec<(f64, f64)> {
            let within = points.iter().filter(|point| x.shows(point.0) && y.shows(point.1));
            within
                .map(|point| (x.position(point.0), y.position(point.1)))
                .collect()
        };
        let pale = Ink::Muted.color().mix(PALE).filled();
        chart
            .draw_series(
                shown(&self.dots)
                    .into_iter()
                    .map(|point| Circle::new(point, 9, pale)),
            )
            .map_err(|error| error.to_string())?;
        for line in &self.lines {
            let points = shown(&line.points);
            let style = ink(line.style).color().stroke_width(14);
            chart
                .draw_series(LineSeries::new(points.iter().copied(), style))
                .map_err(|error| error.to_string())?;
            // Each line has its markers at other places, so that they do not hide each other.
            let spacing = (points.len() / MARKERS).max(1);
            let first = spacing * (line.style % 7 + 1) / 8;
            for &point in points.iter().skip(first).step_by(spacing) {
                marker(&mut chart, point, line.style, true)?;
            }
        }
        Ok(())
    }

    fn axes(&self) -> (Axis, Axis) {
        let points = || {
            let of_lines = self.lines.iter().flat_map(|line| &line.points);
            self.dots
                .iter()
                .chain(of_lines)
                .filter(|point| point.1.is_finite())
        };
        let (from, to) = range_of(points().map(|point| point.0));
        let (low, high) = match self.about_zero {
            Some(half) => (-half, half),
            None => range_of(points().map(|point| point.1)),
        };
        let margin = 0.04 * (high - low);
        (
            Axis::linear(from, to + 0.01 * (to - from), &self.x.0, &self.x.1, 4),
            Axis::linear(low - margin, high + margin, &self.y.0, &self.y.1, 4),
        )
    }
}
