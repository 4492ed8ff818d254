//! Curvature over time at a few places: readings as dots, simulated as lines.

use plotters::element::Circle;
use plotters::series::LineSeries;
use plotters::style::Color;

use super::frames::frames;
use super::shapes::inks;
use super::{key, millimetres};
use crate::figures::axis::Axis;
use crate::figures::canvas::{Area, TENTHS};
use crate::figures::group::series;
use crate::figures::panel::{Margins, panel, pixels};
use crate::figures::thin;
use ieap_domain::{AlongCurve, AlongStrip};

/// Places drawn at most: the map shows all.
const PLACES: usize = 6;
/// Height of the plotting area with its axis, px.
const HEIGHT: u32 = 250;
const MARGINS: Margins = Margins {
    left: 62,
    right: 12,
    top: 8,
    bottom: 42,
};

/// Places that are drawn: at most six, evenly among all, the outermost ones with them.
pub fn shown_places(curve: &AlongCurve) -> Vec<usize> {
    let last = curve.places().saturating_sub(1);
    let most = PLACES.min(curve.places());
    let mut shown: Vec<usize> = (0..most).map(|k| k * last / (most - 1).max(1)).collect();
    shown.dedup();
    shown
}

fn words(curve: &AlongCurve) -> Vec<String> {
    let places = shown_places(curve).into_iter();
    places
        .map(|place| millimetres(curve.position_mm[place]))
        .collect()
}

/// Height of a drawing of that width, px.
pub fn height(curve: &AlongCurve, width: u32) -> u32 {
    key::height(width, &words(curve)) + HEIGHT
}

/// Draws the curves over the whole of `area`; nothing where fewer than two frames can be shown.
///
/// # Errors
/// The message of the drawing library.
pub fn draw(area: &Area, strip: &AlongStrip, curve: &AlongCurve) -> Result<(), String> {
    let Some(frames) = frames(strip, curve) else {
        return Ok(());
    };
    let (places, words) = (shown_places(curve), words(curve));
    let width = area.dim_in_pixel().0 / TENTHS as u32;
    let (_, below) = area.split_vertically(key::height(width, &words) as i32 * TENTHS);
    let points = |values: &[f64]| -> Vec<(f64, f64)> {
        let at = frames.shown.iter().zip(&frames.at);
        let points = at.filter_map(|(&frame, &at)| Some((at, *values.get(frame)?)));
        points.filter(|(_, value)| value.is_finite()).collect()
    };
    let drawn: Vec<[Vec<(f64, f64)>; 2]> = places
        .iter()
        .map(|&place| [curve.measured_at(place), curve.fitted_at(place)].map(points))
        .collect();
    let all = drawn.iter().flatten().flatten().map(|point| point.1);
    let (low, high) = all.fold((0.0f64, 0.0f64), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    let margin = 0.05 * (high - low);
    let y = Axis::linear(low - margin, high + margin, "Curvature", "1/cm", 5);
    let mut chart = panel(&below, MARGINS, &frames.axis, &y, true)?;
    let inks = inks(places.len());
    key::draw(area, &words, &inks)?;
    for ((ink, word), [measured, fitted]) in inks.iter().zip(&words).zip(&drawn) {
        let style = ink.color().filled();
        series(&mut chart, &format!("{word}, measured"), |chart| {
            let dots = thin::dots(measured);
            let circles = dots.into_iter().map(|point| Circle::new(point, 14, style));
            chart
                .draw_series(circles)
                .map(|_| ())
                .map_err(|error| error.to_string())
        })?;
        if fitted.is_empty() {
            continue;
        }
        series(&mut chart, &format!("{word}, simulated"), |chart| {
            let line = thin::line(fitted, pixels(chart));
            let line = LineSeries::new(line, ink.color().stroke_width(12));
            chart
                .draw_series(line)
                .map(|_| ())
                .map_err(|error| error.to_string())
        })?;
    }
    Ok(())
}
