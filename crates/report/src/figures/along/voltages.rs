//! Voltage between the electrodes along the strip at a few times: readings as dots, simulated as lines.

use plotters::element::Circle;
use plotters::series::LineSeries;
use plotters::style::Color;

use super::shapes::inks;
use super::{key, seconds};
use crate::figures::axis::Axis;
use crate::figures::canvas::{Area, TENTHS};
use crate::figures::group::series;
use crate::figures::panel::{Margins, panel, pixels};
use crate::figures::thin;
use ieap_domain::{AlongCurve, AlongStrip};

/// Height of the plotting area with its axis, px.
const HEIGHT: u32 = 250;
const MARGINS: Margins = Margins {
    left: 62,
    right: 12,
    top: 8,
    bottom: 42,
};

fn words(strip: &AlongStrip, voltage: &AlongCurve) -> Vec<String> {
    let frames = strip.voltage_frames.iter();
    frames
        .map(|&frame| seconds(voltage.time_s[frame] - strip.step_s))
        .collect()
}

/// Height of a drawing of that width, px.
pub fn height(strip: &AlongStrip, voltage: &AlongCurve, width: u32) -> u32 {
    key::height(width, &words(strip, voltage)) + HEIGHT
}

/// Draws the voltages over the whole of `area`.
///
/// # Errors
/// The message of the drawing library.
pub fn draw(area: &Area, strip: &AlongStrip, voltage: &AlongCurve) -> Result<(), String> {
    let words = words(strip, voltage);
    let width = area.dim_in_pixel().0 / TENTHS as u32;
    let (_, below) = area.split_vertically(key::height(width, &words) as i32 * TENTHS);
    let measured = |frame: usize| -> Vec<(f64, f64)> { profile(voltage, frame, AlongCurve::measured_at) };
    // Where the model speaks of all places its line is smooth; else it joins the places of the readings.
    let simulated = |frame: usize| -> Vec<(f64, f64)> {
        let even = strip
            .voltage_profile
            .as_ref()
            .filter(|even| even.time_s == voltage.time_s);
        profile(even.unwrap_or(voltage), frame, AlongCurve::fitted_at)
    };
    let drawn: Vec<[Vec<(f64, f64)>; 2]> = strip
        .voltage_frames
        .iter()
        .map(|&frame| [measured(frame), simulated(frame)])
        .collect();
    let all = drawn.iter().flatten().flatten().map(|point| point.1);
    let (low, high) = all.fold((0.0f64, 0.0f64), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    let margin = 0.05 * (high - low);
    let last_mm = voltage.position_mm[voltage.places() - 1];
    let x = Axis::linear(
        0.0,
        strip.length_mm.unwrap_or(last_mm).max(last_mm),
        "Position",
        "mm",
        6,
    );
    let y = Axis::linear(low - margin, high + margin, "Voltage", "V", 5);
    let mut chart = panel(&below, MARGINS, &x, &y, true)?;
    let inks = inks(words.len());
    key::draw(area, &words, &inks)?;
    for ((ink, word), [measured, simulated]) in inks.iter().zip(&words).zip(drawn) {
        series(&mut chart, &format!("{word}, simulated"), |chart| {
            let line = thin::line(&simulated, pixels(chart));
            let line = LineSeries::new(line, ink.color().stroke_width(12));
            chart
                .draw_series(line)
                .map(|_| ())
                .map_err(|error| error.to_string())
        })?;
        let style = ink.color().filled();
        series(&mut chart, &format!("{word}, measured"), |chart| {
            let circles = measured.into_iter().map(|point| Circle::new(point, 26, style));
            chart
                .draw_series(circles)
                .map(|_| ())
                .map_err(|error| error.to_string())
        })?;
    }
    Ok(())
}

fn profile(
    curve: &AlongCurve,
    frame: usize,
    values_at: for<'a> fn(&'a AlongCurve, usize) -> &'a [f64],
) -> Vec<(f64, f64)> {
    let values = (0..curve.places()).filter_map(|place| {
        let value = *values_at(curve, place).get(frame)?;
        Some((curve.position_mm[place], value))
    });
    values.filter(|(_, value)| value.is_finite()).collect()
}
