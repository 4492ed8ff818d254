//! Curves of runs as several figures show them: measured as dots, simulated as a line of the same colour.

use plotters::element::Circle;
use plotters::series::LineSeries;
use plotters::style::Color;

use super::FigureInput;
use crate::figures::axis::Axis;
use crate::figures::canvas::Area;
use crate::figures::comparison::{ink, marker};
use crate::figures::panel::{Margins, panel};
use ieap_domain::tag::keys;
use ieap_domain::{Level, Quantity, RunCurve, RunRecord};

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

/// Responses of a run of that quantity: currents per area in mA cm⁻², curvatures in cm⁻¹, displacements in mm.
///
/// Fits are of curvatures, so that displacements are those of the strip's circle at its free length.
///
/// # Errors
/// The curves cannot be read.
pub fn lines(input: &FigureInput, run: usize, quantity: Quantity, style: usize) -> Result<Vec<Line>, String> {
    let record = &input.site.input.runs[run];
    let curves = input.curves.curves(record.id)?;
    let step_s = step_s(record);
    let of = |drawn: Quantity, shown: &dyn Fn(f64) -> f64| -> Vec<Line> {
        let of_quantity = curves.iter().filter(|curve| curve.quantity == drawn);
        of_quantity
            .map(|curve| line(curve, style, step_s, shown))
            .collect()
    };
    Ok(match quantity {
        // Without an area or a length there is nothing to relate to, and no place beside the others.
        Quantity::Current => (record.area_cm2).map_or(vec![], |area_cm2| {
            of(Quantity::Current, &|ampere| ampere * MILLI / area_cm2)
        }),
        Quantity::TipDisplacement => length_cm(input, record).map_or(vec![], |length_cm| {
            of(Quantity::Curvature, &|per_cm| displacement_mm(per_cm, length_cm))
        }),
        _ => of(quantity, &|value| value),
    })
}

/// Free length of the run's sample, cm.
fn length_cm(input: &FigureInput, run: &RunRecord) -> Option<f64> {
    let sample = run.tag(keys::SAMPLE)?;
    let sample = input.site.input.campaign.sample(sample)?;
    sample.length_mm.map(|length_mm| length_mm / 10.0)
}

/// Displacement beside a point `length_cm` ahead of the clamp, mm: the thesis's (3) turned round on the first quarter of
/// the circle, which gives a displacement that the curvature was made of back. NaN where the circle does not reach it.
fn displacement_mm(curvature_per_cm: f64, length_cm: f64) -> f64 {
    let turn = curvature_per_cm * length_cm;
    10.0 * turn * length_cm / (1.0 + ((1.0 - turn) * (1.0 + turn)).sqrt())
}

/// When the voltage first leaves the baseline, s.
fn step_s(run: &RunRecord) -> f64 {
    let Some(drive) = &run.drive else { return 0.0 };
    let leaves = |level: Level| matches!(level, Level::Voltage(volts) if volts != drive.baseline_v);
    let first = drive.segments.iter().find(|segment| leaves(segment.level));
    first.map_or(0.0, |segment| segment.start_s)
}

fn line(curve: &RunCurve, style: usize, step_s: f64, shown: &dyn Fn(f64) -> f64) -> Line {
    let points = |values: &[f64]| -> Vec<(f64, f64)> {
        let pairs = curve.time_s.iter().zip(values);
        let points = pairs.map(|(time_s, value)| (time_s - step_s, shown(*value)));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_displacement_comes_back_from_the_curvature_it_was_made_of() {
        for (d_cm, length_cm) in [(0.02, 0.5), (-0.3, 0.5), (0.5, 0.5)] {
            let curvature = 2.0 * d_cm / (length_cm * length_cm + d_cm * d_cm);
            let back = displacement_mm(curvature, length_cm);
            assert!((back - 10.0 * d_cm).abs() < 1e-7, "{back} of {d_cm}");
        }
        assert!(displacement_mm(2.1, 0.5).is_nan());
    }
}
