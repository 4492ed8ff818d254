//! Curves of runs as several figures show them: measured as dots, simulated as a line of the same colour.

use plotters::element::Circle;
use plotters::series::LineSeries;
use plotters::style::Color;

use super::FigureInput;
use crate::domain::{Level, Quantity, RunCurve, RunRecord};
use crate::report::figures::axis::Axis;
use crate::report::figures::canvas::Area;
use crate::report::figures::comparison::{ink, marker};
use crate::report::figures::panel::{Margins, panel};

/// Room around a panel, px.
const MARGINS: Margins = Margins {
    left: 54,
    right: 12,
    top: 4,
    bottom: 44,
};
/// Markers on a simulated line: lines are told apart without colour.
const MARKERS: usize = 5;
const MILLI: f64 = 1e3;

/// One response of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Colour and marker.
    pub style: usize,
    /// Time since the step, s, and value as measured.
    pub measured: Vec<(f64, f64)>,
    /// The same as simulated; empty without a fit.
    pub fitted: Vec<(f64, f64)>,
}

/// Responses of a run of that quantity: currents per area in mA cm⁻², curvatures in cm⁻¹.
///
/// # Errors
/// The curves cannot be read.
pub fn lines(input: &FigureInput, run: usize, quantity: Quantity, style: usize) -> Result<Vec<Line>, String> {
    let record = &input.site.input.runs[run];
    let curves = input.curves.curves(record.id)?;
    let scale = match quantity {
        // Without an area there is nothing to normalise by, and no place beside the others.
        Quantity::Current => match record.area_cm2 {
            Some(area_cm2) => MILLI / area_cm2,
            None => return Ok(vec![]),
        },
        _ => 1.0,
    };
    let step_s = step_s(record);
    let of_quantity = curves.iter().filter(|curve| curve.quantity == quantity);
    Ok(of_quantity
        .map(|curve| line(curve, style, step_s, scale))
        .collect())
}

/// When the voltage first leaves the baseline, s.
fn step_s(run: &RunRecord) -> f64 {
    let Some(drive) = &run.drive else { return 0.0 };
    let leaves = |level: Level| matches!(level, Level::Voltage(volts) if volts != drive.baseline_v);
    let first = drive.segments.iter().find(|segment| leaves(segment.level));
    first.map_or(0.0, |segment| segment.start_s)
}

fn line(curve: &RunCurve, style: usize, step_s: f64, scale: f64) -> Line {
    let points = |values: &[f64]| -> Vec<(f64, f64)> {
        let pairs = curve.time_s.iter().zip(values);
        let points = pairs.map(|(time_s, value)| (time_s - step_s, value * scale));
        points
            .filter(|point| point.0.is_finite() && point.1.is_finite())
            .collect()
    };
    Line {
        style,
        measured: points(&curve.measured),
        fitted: points(&curve.fitted),
    }
}

/// Draws lines in a panel over the whole of `area`; what lies outside the axes is left out.
///
/// # Errors
/// The message of the drawing library.
pub fn draw_lines(area: &Area, x: &Axis, y: &Axis, lines: &[Line]) -> Result<(), String> {
    let mut chart = panel(area, MARGINS, x, y, true)?;
    let shown = |points: &[(f64, f64)]| -> Vec<(f64, f64)> {
        let within = points.iter().filter(|point| x.shows(point.0) && y.shows(point.1));
        within
            .map(|point| (x.position(point.0), y.position(point.1)))
            .collect()
    };
    for line in lines {
        let color = ink(line.style).color();
        let style = color.mix(0.45).filled();
        let dots = shown(&line.measured);
        chart
            .draw_series(dots.iter().map(|&point| Circle::new(point, 9, style)))
            .map_err(|error| error.to_string())?;
        let simulated = shown(&line.fitted);
        chart
            .draw_series(LineSeries::new(simulated.iter().copied(), color.stroke_width(14)))
            .map_err(|error| error.to_string())?;
        let marked = if simulated.is_empty() { &dots } else { &simulated };
        // Each line has its markers at other places, so that they do not hide each other.
        let spacing = (marked.len() / MARKERS).max(1);
        for &point in marked
            .iter()
            .skip(spacing * (line.style + 1) / 7)
            .step_by(spacing)
        {
            marker(&mut chart, point, line.style, true)?;
        }
    }
    Ok(())
}
