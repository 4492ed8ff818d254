//! Predicted courses: each response over time as a line in the band that a further run lies in.

use plotters::element::{PathElement, Polygon};
use plotters::series::{DashedLineSeries, LineSeries};
use plotters::style::Color;

use super::grid::{Panel, grid};
use crate::figures::axis::Axis;
use crate::figures::canvas::{Area, Drawing, Ink};
use crate::figures::panel::{Margins, panel};
use ieap_domain::range_of;

/// Height of a panel, px.
const HEIGHT: u32 = 165;
const MARGINS: Margins = Margins {
    left: 58,
    right: 26,
    top: 4,
    bottom: 44,
};
/// Part of the height that an axis does not go below zero for.
const LITTLE: f64 = 0.02;
/// Opacity of a band.
const PALE: f64 = 0.2;

/// One response over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// Quantity.
    pub quantity: String,
    /// Unit, as printed.
    pub unit: String,
    /// Time, s, and value.
    pub points: Vec<(f64, f64)>,
    /// Lower and upper end of the interval at each; empty where there is none.
    pub band: Vec<(f64, f64)>,
    /// What was wanted, over time; empty where nothing was.
    pub wanted: Vec<(f64, f64)>,
}

/// Draws courses below each other, those without points left out.
///
/// # Errors
/// There is none to draw, or the message of the drawing library.
pub fn courses(width: u32, all: &[Course]) -> Result<Drawing, String> {
    let drawn = all.iter().filter(|course| course.points.len() > 1);
    let panels: Vec<Panel> = drawn
        .map(|course| Panel {
            title: course.quantity.clone(),
            draw: Box::new(move |area| draw(area, course)),
        })
        .collect();
    let mut notes = vec!["Band: a further run lies in it in 95 of 100 cases.".to_owned()];
    if all.iter().any(|course| !course.wanted.is_empty()) {
        notes.push("Dashed: wanted.".to_owned());
    }
    grid(width, 1, HEIGHT, &[], &panels, &notes)
}

fn draw(area: &Area, course: &Course) -> Result<(), String> {
    let (from, to) = range_of(course.points.iter().map(|point| point.0));
    let ends = course.band.iter().flat_map(|(low, high)| [*low, *high]);
    let values = course.points.iter().chain(&course.wanted).map(|point| point.1);
    let (low, high) = range_of(values.chain(ends).chain([0.0]));
    // Rounding below zero, and a band that hardly reaches there, ask for no room.
    let low = if low > -LITTLE * high { 0.0 } else { low };
    let x = Axis::linear_rounded(from, to, "Time", "s", 5);
    // The title of the panel says what it is.
    let y = Axis::linear_rounded(low, high, &course.unit, "", 4);
    let mut chart = panel(area, MARGINS, &x, &y, true)?;
    let edge = |which: &dyn Fn(&(f64, f64)) -> f64| -> Vec<(f64, f64)> {
        let pairs = course.points.iter().zip(&course.band);
        pairs.map(|(point, ends)| (point.0, which(ends))).collect()
    };
    let (lower, upper) = (edge(&|ends| ends.0), edge(&|ends| ends.1));
    if !lower.is_empty() {
        let around: Vec<(f64, f64)> = lower.into_iter().chain(upper.into_iter().rev()).collect();
        let band = Polygon::new(around, Ink::Blue.color().mix(PALE).filled());
        chart.draw_series([band]).map_err(|error| error.to_string())?;
    }
    if low < 0.0 {
        let zero = PathElement::new([(x.low, 0.0), (x.high, 0.0)], Ink::Muted.color().stroke_width(8));
        chart.draw_series([zero]).map_err(|error| error.to_string())?;
    }
    let line = LineSeries::new(course.points.iter().copied(), Ink::Blue.color().stroke_width(14));
    chart.draw_series(line).map_err(|error| error.to_string())?;
    let dashed = Ink::Text.color().stroke_width(10);
    let wanted = DashedLineSeries::new(course.wanted.iter().copied(), 50, 40, dashed);
    chart.draw_series(wanted).map_err(|error| error.to_string())?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_course_has_its_band_and_what_was_wanted() {
        let course = Course {
            quantity: "Tip displacement".to_owned(),
            unit: "mm".to_owned(),
            points: vec![(0.0, 0.0), (10.0, 1.0), (20.0, 0.8)],
            band: vec![(0.0, 0.0), (0.9, 1.1), (0.6, 1.0)],
            wanted: vec![(0.0, 1.0), (20.0, 1.0)],
        };
        let empty = Course {
            points: Vec::new(),
            ..course.clone()
        };
        let drawing = courses(240, &[course.clone(), empty.clone()]).unwrap();
        let (width, height) = drawing.size;
        assert_eq!(width, 10 * 240);
        assert!((10 * HEIGHT..20 * HEIGHT).contains(&height), "{height}");
        assert!(courses(240, &[empty]).is_err());
    }
}
