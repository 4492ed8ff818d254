//! Curves of runs as several figures show them: measured as dots, simulated as a line of the same colour.

use std::collections::BTreeMap;

use plotters::element::Circle;
use plotters::series::{DashedLineSeries, LineSeries};
use plotters::style::Color;

use super::FigureInput;
use crate::figures::axis::Axis;
use crate::figures::canvas::Area;
use crate::figures::comparison::{ink, marker};
use crate::figures::panel::{Chart, Margins, panel};
use crate::site::Site;
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
/// Opacity of dots and of what is set aside.
const PALE: f64 = 0.45;
/// Open dots of a line, about.
const MOST_OPEN: usize = 60;
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
    /// Number of the run among all that have a page.
    pub run: usize,
    /// Whether no result is made from it: it is drawn with open dots and a pale dashed line, and sets no axis.
    pub aside: bool,
}

/// Responses of a run of that quantity: currents per area in mA cm⁻², curvatures in cm⁻¹, displacements in mm.
///
/// Fits are of curvatures, so that displacements are those of the strip's circle at its free length.
///
/// # Errors
/// The curves cannot be read.
pub fn lines(input: &FigureInput, run: usize, quantity: Quantity, style: usize) -> Result<Vec<Line>, String> {
    let record = input.site.input.record(run);
    let curves = input.curves.curves(record.id)?;
    let step_s = step_s(record);
    let of = |drawn: Quantity, shown: &dyn Fn(f64) -> f64| -> Vec<Line> {
        let of_quantity = curves.iter().filter(|curve| curve.quantity == drawn);
        of_quantity
            .map(|curve| Line {
                run,
                aside: !record.standing.speaks(),
                ..line(curve, style, step_s, shown)
            })
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

/// Responses of the condemned runs that `style` gives a style from the indices of their material, surroundings and voltage.
///
/// # Errors
/// The curves cannot be read.
pub fn aside_lines(
    input: &FigureInput,
    quantity: Quantity,
    style: impl Fn((usize, usize, usize)) -> Option<usize>,
) -> Result<Vec<Line>, String> {
    let mut found = Vec::new();
    for aside in &input.site.aside {
        if let Some(style) = aside.condition.and_then(&style) {
            found.extend(lines(input, aside.run, quantity, style)?);
        }
    }
    Ok(found)
}

/// Lines that results are made from: those that set the axes.
pub fn speaking(lines: &[Line]) -> impl Iterator<Item = &Line> {
    lines.iter().filter(|line| !line.aside)
}

/// Notes which of the lines are of runs set aside, with whether most of them lies within the axes.
pub fn note_aside(seen: &mut BTreeMap<usize, bool>, (x, y): (&Axis, &Axis), lines: &[Line]) {
    for line in lines.iter().filter(|line| line.aside) {
        let points = || line.measured.iter().chain(&line.fitted);
        let inside = points().filter(|point| x.shows(point.0) && y.shows(point.1));
        let within = 2 * inside.count() > points().count();
        *seen.entry(line.run).or_default() |= within;
    }
}

/// What a figure says of the runs set aside that were noted for it; nothing where there are none.
pub fn aside_words(site: &Site, seen: &BTreeMap<usize, bool>) -> Vec<String> {
    let said = |(&run, &within): (&usize, &bool)| {
        let (name, reason) = (site.run_name(run), site.input.record(run).standing.reason());
        if within {
            format!("Open dots, dashed: set aside, in no result: {name} ({reason}).")
        } else {
            format!("Set aside, mostly outside the axes: {name} ({reason}).")
        }
    };
    seen.iter().map(said).collect()
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
    first.map_or(0.0, |segment| segment.start_s())
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
        run: 0,
        aside: false,
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
        let style = color.mix(PALE).filled();
        let dots = shown(&line.measured);
        if line.aside {
            draw_aside(&mut chart, line.style, &dots, &shown(&line.fitted))?;
            continue;
        }
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

/// A run that no result is made from: open dots and a dashed line, both pale.
fn draw_aside(
    chart: &mut Chart,
    style: usize,
    dots: &[(f64, f64)],
    simulated: &[(f64, f64)],
) -> Result<(), String> {
    let pale = ink(style).color().mix(PALE);
    // Open dots are large, and so fewer of them are told apart.
    let every = (dots.len() / MOST_OPEN).max(1);
    let open = dots.iter().step_by(every);
    chart
        .draw_series(open.map(|&point| Circle::new(point, 20, pale.stroke_width(8))))
        .map_err(|error| error.to_string())?;
    let (dash, gap) = (60, 45);
    let line = DashedLineSeries::new(simulated.iter().copied(), dash, gap, pale.stroke_width(14));
    let drawn = chart.draw_series(line);
    drawn.map(|_| ()).map_err(|error| error.to_string())
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
