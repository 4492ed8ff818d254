//! Where the strip lies at a few times, to scale: measured as broad lines, simulated as thin dashes over them.

use plotters::element::PathElement;
use plotters::style::Color;
use plotters_backend::BackendCoord;

use super::key;
use crate::figures::axis::Axis;
use crate::figures::canvas::{Area, Ink, TENTHS};
use crate::figures::group::series;
use crate::figures::panel::{Margins, panel};
use crate::figures::svg::path_data;
use ieap_analysis::along::seconds;
use ieap_domain::AlongStrip;

/// Lowest and highest plotting area, px.
const HEIGHTS: (f64, f64) = (130.0, 420.0);
const MARGINS: Margins = Margins {
    left: 50,
    right: 12,
    top: 8,
    bottom: 42,
};
/// Room around the shapes over their extent.
const ROOM: f64 = 0.05;
/// Length of a dash and of the gap behind it, tenths of a pixel.
const DASH: (f64, f64) = (55.0, 40.0);

/// Opacity of measured lines: dashes over them are seen on dark ones too.
const MEASURED: f64 = 0.6;

/// A point in mm, ahead of the clamp and sideways.
type Point = (f64, f64);

/// How millimetres become pixels: one scale for both directions.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    width: u32,
    key_height: u32,
    plot_height: u32,
    per_mm: f64,
    low: Point,
    high: Point,
    words: Vec<String>,
}

impl Layout {
    /// The layout of a drawing of that width, px; none without shapes. A moving picture stays within it.
    pub fn of(strip: &AlongStrip, width: u32) -> Option<Layout> {
        let curvature = strip.curvature.as_ref()?;
        strip.shapes.first()?;
        let all = strip.shapes.iter().chain(&strip.film);
        let points = all.flat_map(|shape| shape.measured_mm.iter().chain(&shape.fitted_mm));
        let (mut low, mut high) = ((0.0f64, 0.0f64), (0.0f64, 0.0f64));
        for (x, y) in points.filter(|(x, y)| x.is_finite() && y.is_finite()) {
            (low, high) = ((low.0.min(*x), low.1.min(*y)), (high.0.max(*x), high.1.max(*y)));
        }
        let extent = (high.0 - low.0).max(high.1 - low.1);
        let plot_width = f64::from(width - MARGINS.left - MARGINS.right);
        let room = ROOM * extent;
        (low, high) = ((low.0 - room, low.1 - room), (high.0 + room, high.1 + room));
        let per_mm = (plot_width / (high.0 - low.0)).min(HEIGHTS.1 / (high.1 - low.1));
        let plot_height = (per_mm * (high.1 - low.1)).max(HEIGHTS.0).round();
        // What room is left is given to both sides.
        let spare = |pixels: f64, from: f64, to: f64| 0.5 * (pixels / per_mm - (to - from)).max(0.0);
        let (across, up) = (
            spare(plot_width, low.0, high.0),
            spare(plot_height, low.1, high.1),
        );
        let words: Vec<String> = strip
            .shapes
            .iter()
            .map(|shape| seconds(curvature.time_s[shape.frame] - strip.step_s))
            .collect();
        Some(Layout {
            width,
            key_height: key::height(width, &words),
            plot_height: plot_height as u32,
            per_mm,
            low: (low.0 - across, low.1 - up),
            high: (high.0 + across, high.1 + up),
            words,
        })
    }

    /// Width and height of the drawing, px.
    pub fn size(&self) -> (u32, u32) {
        let height = self.key_height + MARGINS.top + self.plot_height + MARGINS.bottom;
        (self.width, height)
    }

    /// Places of a shape in the drawing, tenths of a pixel.
    fn placed(&self, shape: &[Point]) -> Vec<BackendCoord> {
        let tenths = f64::from(TENTHS);
        let left = tenths * f64::from(MARGINS.left);
        let bottom = tenths * f64::from(self.key_height + MARGINS.top + self.plot_height);
        let at = |(x, y): &Point| {
            let right = left + tenths * self.per_mm * (x - self.low.0);
            let down = bottom - tenths * self.per_mm * (y - self.low.1);
            (right.round() as i32, down.round() as i32)
        };
        shape.iter().map(at).collect()
    }
}

/// Draws the shapes over the whole of `area`, which has the size of the layout.
///
/// # Errors
/// The message of the drawing library.
pub fn draw(area: &Area, strip: &AlongStrip, layout: &Layout) -> Result<(), String> {
    let (_, below) = area.split_vertically(layout.key_height as i32 * TENTHS);
    let wanted = |pixels: f64| ((pixels / 60.0) as usize).clamp(3, 7);
    let across = layout.high.0 - layout.low.0;
    let up = layout.high.1 - layout.low.1;
    // Both axes have the steps of the longer one, so that a square is seen to be one.
    let x = Axis::linear(
        layout.low.0,
        layout.high.0,
        "Ahead of the clamp",
        "mm",
        wanted(layout.per_mm * across),
    );
    let y = Axis::linear(
        layout.low.1,
        layout.high.1,
        "Sideways",
        "mm",
        wanted(layout.per_mm * up),
    );
    let mut chart = panel(&below, MARGINS, &x, &y, true)?;
    let inks = inks(strip.shapes.len());
    key::draw(area, &layout.words, &inks)?;
    let line = |points: Vec<BackendCoord>, ink: Ink, opacity: f64, width: u32| {
        let style = ink.color().mix(opacity).stroke_width(width);
        area.draw(&PathElement::new(points, style))
            .map_err(|error| error.to_string())
    };
    let clamp = layout.placed(&[(0.0, 0.0)])[0];
    line(
        vec![(clamp.0, clamp.1 - 70), (clamp.0, clamp.1 + 70)],
        Ink::Text,
        1.0,
        30,
    )?;
    // One group, which the page's script dims while the strip moves.
    series(&mut chart, "", |_| {
        for (shape, ink) in strip.shapes.iter().zip(&inks) {
            line(layout.placed(&shape.measured_mm), *ink, MEASURED, 34)?;
            for dash in dashes(&layout.placed(&shape.fitted_mm)) {
                line(dash, Ink::Text, 1.0, 9)?;
            }
        }
        Ok(())
    })
}

/// Inks for `count` series in order: the first and the last of few are as far apart as those of many.
pub fn inks(count: usize) -> Vec<Ink> {
    (0..count).map(|at| Ink::ordered(at, count)).collect()
}

/// The frames of a moving picture in the drawing: `time|measured|simulated` of each, joined by semicolons; the last two
/// are path data.
pub fn film(strip: &AlongStrip, layout: &Layout) -> String {
    let Some(curvature) = &strip.curvature else {
        return String::new();
    };
    let frame = |shape: &ieap_domain::StripShape| {
        let time = seconds(curvature.time_s[shape.frame] - strip.step_s);
        let [measured, fitted] =
            [&shape.measured_mm, &shape.fitted_mm].map(|points| path_data(&layout.placed(points)));
        format!("{time}|{measured}|{fitted}")
    };
    strip.film.iter().map(frame).collect::<Vec<_>>().join(";")
}

/// A line as dashes.
fn dashes(points: &[BackendCoord]) -> Vec<Vec<BackendCoord>> {
    let mut found: Vec<Vec<BackendCoord>> = Vec::new();
    let (mut drawn, mut left) = (true, DASH.0);
    let mut dash: Vec<BackendCoord> = points.first().copied().into_iter().collect();
    for ends in points.windows(2) {
        let (from, to) = (ends[0], ends[1]);
        let length = f64::from(to.0 - from.0).hypot(f64::from(to.1 - from.1));
        let mut done = 0.0;
        while length - done > left {
            done += left;
            let share = done / length;
            let between = |a: i32, b: i32| a + (f64::from(b - a) * share).round() as i32;
            let here = (between(from.0, to.0), between(from.1, to.1));
            if drawn {
                dash.push(here);
                found.push(std::mem::take(&mut dash));
            } else {
                dash = vec![here];
            }
            drawn = !drawn;
            left = if drawn { DASH.0 } else { DASH.1 };
        }
        left -= length - done;
        if drawn {
            dash.push(to);
        }
    }
    if drawn && dash.len() > 1 {
        found.push(dash);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_have_their_length_around_corners() {
        let found = dashes(&[(0, 0), (30, 0), (30, 200)]);
        assert_eq!(found[0], [(0, 0), (30, 0), (30, 25)]);
        assert_eq!(found[1], [(30, 65), (30, 120)]);
        assert_eq!(found[2], [(30, 160), (30, 200)]);
        assert!(dashes(&[]).is_empty());
    }

    #[test]
    fn few_series_use_the_whole_of_the_inks() {
        assert_eq!(inks(2), [Ink::First, Ink::Sixth]);
        assert_eq!(inks(6), Ink::ORDERED);
        assert_eq!(inks(1), [Ink::First]);
    }
}
