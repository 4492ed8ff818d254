//! Runs that no result is made from, in figures: an open circle that is crossed, grey, over the pale bar of its interval.
//! No other mark is crossed, so that it is told without colour and in print.
//!
//! Axes take no notice of such a run: one whose unit is wrong lies a thousand times off, and would leave one line of all
//! others. What lies beyond an axis stands at its end with an arrow, has no readout, and its number is said in words.

use plotters::element::{Circle, EmptyElement, PathElement};
use plotters::style::Color;

use super::axis::Axis;
use super::canvas::Ink;
use super::group::aside_series;
use super::panel::Chart;

/// Radius of the circle, and half the width of the stroke across it, tenths of a pixel.
const RADIUS: i32 = 38;
const ACROSS: i32 = 44;
/// Width of the lines, tenths of a pixel.
const LINE: u32 = 12;
/// Opacity of the bar.
const PALE: f64 = 0.5;
/// Distance of a mark with an arrow from the end of the axis, tenths of a pixel.
const INWARD: i32 = 140;

/// A run that no result is made from, with its 95 % interval.
#[derive(Debug, Clone, PartialEq)]
pub struct AsideMark {
    /// Its number among all runs that have a page.
    pub run: usize,
    /// Number on the horizontal axis.
    pub x: f64,
    /// Value in the shown unit.
    pub y: f64,
    /// Ends of the interval.
    pub bar: (f64, f64),
    /// What readouts call it.
    pub name: String,
}

impl AsideMark {
    /// Whether it lies outside the axes.
    pub fn is_beyond(&self, x: &Axis, y: &Axis) -> bool {
        self.way((x, y)) != (0, 0)
    }

    /// To which side it lies outside: right and up are 1.
    fn way(&self, (x, y): (&Axis, &Axis)) -> (i32, i32) {
        (x.way(self.x), y.way(self.y))
    }
}

/// Draws the marks, each a series of its own.
///
/// # Errors
/// The message of the drawing library.
pub fn draw_aside(chart: &mut Chart, axes: (&Axis, &Axis), marks: &[AsideMark]) -> Result<(), String> {
    for mark in marks {
        let way = mark.way(axes);
        let name = if way == (0, 0) { mark.name.as_str() } else { "" };
        let at = (axes.0.inside(mark.x), axes.1.inside(mark.y));
        aside_series(chart, name, |chart| match way {
            (0, 0) => {
                let ends = [mark.bar.0, mark.bar.1].map(|end| (at.0, axes.1.inside(end)));
                let style = Ink::Muted.color().mix(PALE).stroke_width(LINE);
                let bar = PathElement::new(ends, style);
                chart.draw_series([bar]).map_err(|error| error.to_string())?;
                crossed(chart, at, (0, 0))
            }
            way => {
                crossed(chart, at, (-way.0 * INWARD, way.1 * INWARD))?;
                arrow(chart, at, way)
            }
        })?;
    }
    Ok(())
}

/// An open circle with a stroke across it, `off` tenths of a pixel (right, down) from a position.
fn crossed(chart: &mut Chart, at: (f64, f64), off: (i32, i32)) -> Result<(), String> {
    let style = Ink::Muted.color().stroke_width(LINE);
    let across = [(off.0 - ACROSS, off.1 + ACROSS), (off.0 + ACROSS, off.1 - ACROSS)];
    let mark = EmptyElement::at(at) + Circle::new(off, RADIUS, style) + PathElement::new(across, style);
    let drawn = chart.draw_series([mark]);
    drawn.map(|_| ()).map_err(|error| error.to_string())
}

/// An arrow from the mark to the end of the axis, and its tip.
fn arrow(chart: &mut Chart, at: (f64, f64), (right, up): (i32, i32)) -> Result<(), String> {
    /// How far the tip stays from the end, where the arrow begins, and the length of its barbs.
    const TIP: i32 = 10;
    const FROM: i32 = 85;
    const BARB: i32 = 35;
    let style = Ink::Muted.color().stroke_width(LINE);
    let back = |by: i32, aside: i32| (-right * by - up * aside, up * by - right * aside);
    let shaft = [back(FROM, 0), back(TIP, 0)];
    let barbs = [back(TIP + BARB, BARB), back(TIP, 0), back(TIP + BARB, -BARB)];
    let arrow = EmptyElement::at(at) + PathElement::new(shaft, style) + PathElement::new(barbs, style);
    let drawn = chart.draw_series([arrow]);
    drawn.map(|_| ()).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::law::{Beside, law_panel};

    fn drawn(x: f64, y: f64) -> String {
        let mark = AsideMark {
            run: 0,
            x,
            y,
            bar: (0.9 * y, 1.1 * y),
            name: "a.csv, set aside".to_owned(),
        };
        let beside = Beside {
            aside: vec![mark],
            ..Beside::default()
        };
        let across = Axis::linear(20.0, 80.0, "Relative humidity", "%", 5);
        let up = Axis::log(1e-4, 1e-2, "λ", "s⁻¹");
        law_panel((&across, &up), &[], &beside, "t", "d").unwrap()
    }

    /// Number of strokes of the group.
    fn strokes(svg: &str) -> usize {
        let (_, group) = svg.split_once("data-aside=\"1\">").expect("a group");
        let group = group.split("</g>").next().unwrap_or_default();
        group.replace("muted", "").matches(['M', 'm']).count()
    }

    #[test]
    fn a_run_set_aside_is_an_open_crossed_circle_over_its_bar() {
        let inside = drawn(40.0, 1e-3);
        assert!(
            inside.contains("data-s=\"a.csv, set aside\" data-aside=\"1\""),
            "{inside}"
        );
        assert_eq!(inside.matches("<circle class=\"s k-muted\"").count(), 1);
        // The bar and the stroke across.
        assert_eq!(strokes(&inside), 2, "{inside}");
    }

    #[test]
    fn what_lies_beyond_stands_at_the_end_with_an_arrow_and_has_no_readout() {
        let frame = |svg: &str| svg.split("data-s").next().unwrap_or_default().to_owned();
        for (x, y) in [(40.0, 1.0), (40.0, 1e-9), (40.0, -1.0), (90.0, 1e-3), (5.0, 1.0)] {
            let beyond = drawn(x, y);
            assert!(beyond.contains("data-s=\"\" data-aside=\"1\""), "{beyond}");
            // The stroke across, the shaft and the tip; nothing is written as no number, and the axes are those without it.
            assert_eq!(strokes(&beyond), 3, "{beyond}");
            assert!(!beyond.contains("NaN") && !beyond.contains("inf"), "{beyond}");
            assert_eq!(frame(&beyond), frame(&drawn(40.0, 1e-3)));
        }
    }
}
