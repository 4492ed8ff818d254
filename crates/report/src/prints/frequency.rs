//! Amplitude and phase of current and bending per volt against frequency: measured with 95 % intervals, and the fitted
//! model's line.

use plotters::element::PathElement;
use plotters::series::LineSeries;
use plotters::style::Color;

use super::FigureInput;
use super::grid::{Panel, grid};
use crate::figures::axis::Axis;
use crate::figures::canvas::{Area, Drawing};
use crate::figures::comparison::{ink, marker};
use crate::figures::panel::{Margins, panel};
use crate::site::Site;
use ieap_analysis::frequency::{FrequencyPoint, FrequencyRun, PerVolt};
use ieap_domain::range_of;

const MARGINS: Margins = Margins {
    left: 58,
    right: 12,
    top: 4,
    bottom: 44,
};
/// Height of a panel, px.
const HEIGHT: u32 = 210;
/// Colours and markers that are told apart.
const STYLES: usize = 7;
/// mA/V of A/V.
const MILLI: f64 = 1e3;

/// One of the two responses.
struct Response {
    name: &'static str,
    unit: &'static str,
    factor: f64,
    of: fn(&FrequencyPoint) -> Option<PerVolt>,
}

const RESPONSES: [Response; 2] = [
    Response {
        name: "Current per volt",
        unit: "mA/V",
        factor: MILLI,
        of: |point| point.current,
    },
    Response {
        name: "Curvature per volt",
        unit: "cm⁻¹ V⁻¹",
        factor: 1.0,
        of: |point| point.curvature,
    },
];

/// A measured value with the ends of its interval, and the frequency.
type Bar = (f64, f64, f64, f64);

/// What one run shows in a panel.
struct Drawn {
    style: usize,
    bars: Vec<Bar>,
    line: Vec<(f64, f64)>,
}

/// Draws it.
pub fn draw(input: &FigureInput, width: u32) -> Result<Drawing, String> {
    drawn(input.site, width)
}

/// The same for a page.
pub fn drawn(site: &Site, width: u32) -> Result<Drawing, String> {
    let runs = &site.input.frequency;
    let shown: Vec<&Response> = RESPONSES
        .iter()
        .filter(|response| {
            runs.iter()
                .flat_map(|run| &run.measured)
                .any(|point| (response.of)(point).is_some())
        })
        .collect();
    let amplitudes = shown.iter().map(|response| amplitude_panel(response, runs));
    let phases = shown.iter().map(|response| phase_panel(response, runs));
    let panels: Vec<Panel> = amplitudes.chain(phases).collect();
    let named = |(at, run): (usize, &FrequencyRun)| (format!("{}, {}", run.path, run.waveform), at % STYLES);
    let legend: Vec<(String, usize)> = runs.iter().enumerate().map(named).collect();
    let notes = ["Marks: measured, bars 95 %. Lines: the fitted model. A response with a phase above 0° is ahead of the voltage.".to_owned()];
    if panels.is_empty() {
        return Err("no run has a sine or a chirp for its voltage".to_owned());
    }
    grid(width, shown.len(), HEIGHT, &legend, &panels, &notes)
}

fn amplitude_panel<'a>(response: &'a Response, runs: &[FrequencyRun]) -> Panel<'a> {
    let bar = |point: &FrequencyPoint| {
        let found = (response.of)(point)?;
        let (value, half) = (
            response.factor * found.amplitude(),
            response.factor * found.half_95,
        );
        Some((point.frequency_hz, value, value - half, value + half))
    };
    let line = |point: &FrequencyPoint| {
        Some((
            point.frequency_hz,
            response.factor * (response.of)(point)?.amplitude(),
        ))
    };
    let drawn = all(runs, bar, line);
    let (low, high) = range_of(values(&drawn).filter(|value| *value > 0.0));
    let y = Axis::log(low / 1.2, high * 1.2, "Amplitude", response.unit);
    Panel {
        title: response.name.to_owned(),
        draw: Box::new(move |area| draw_panel(area, &y, &drawn)),
    }
}

fn phase_panel<'a>(response: &'a Response, runs: &[FrequencyRun]) -> Panel<'a> {
    let bar = |point: &FrequencyPoint| {
        let found = (response.of)(point)?;
        let (value, half) = (found.phase_deg(), found.phase_half_deg()?);
        Some((point.frequency_hz, value, value - half, value + half))
    };
    let line = |point: &FrequencyPoint| Some((point.frequency_hz, (response.of)(point)?.phase_deg()));
    let drawn = all(runs, bar, line);
    let (low, high) = range_of(values(&drawn));
    let y = Axis::linear_rounded(low, high, "Phase", "°", 4);
    Panel {
        title: format!("{}, phase", response.name),
        draw: Box::new(move |area| draw_panel(area, &y, &drawn)),
    }
}

fn all(
    runs: &[FrequencyRun],
    bar: impl Fn(&FrequencyPoint) -> Option<Bar>,
    line: impl Fn(&FrequencyPoint) -> Option<(f64, f64)>,
) -> Vec<Drawn> {
    let of_run = |(at, run): (usize, &FrequencyRun)| Drawn {
        style: at % STYLES,
        bars: run.measured.iter().filter_map(&bar).collect(),
        line: run.line.iter().filter_map(&line).collect(),
    };
    runs.iter().enumerate().map(of_run).collect()
}

fn values(drawn: &[Drawn]) -> impl Iterator<Item = f64> {
    let measured = drawn.iter().flat_map(|own| own.bars.iter().map(|bar| bar.1));
    measured.chain(drawn.iter().flat_map(|own| own.line.iter().map(|point| point.1)))
}

fn draw_panel(area: &Area, y: &Axis, drawn: &[Drawn]) -> Result<(), String> {
    let measured = drawn.iter().flat_map(|own| own.bars.iter().map(|bar| bar.0));
    let lines = drawn.iter().flat_map(|own| own.line.iter().map(|point| point.0));
    let (low, high) = range_of(measured.chain(lines));
    let x = Axis::log(low / 1.2, high * 1.2, "Frequency", "Hz");
    let mut chart = panel(area, MARGINS, &x, y, true)?;
    let told = |error: &dyn std::fmt::Display| error.to_string();
    for own in drawn {
        let color = ink(own.style).color();
        let points = own.line.iter().filter(|point| y.shows(point.1));
        let points = points.map(|point| (x.position(point.0), y.position(point.1)));
        let line = LineSeries::new(points, color.stroke_width(14));
        chart.draw_series(line).map_err(|error| told(&error))?;
        for &(frequency_hz, value, low, high) in &own.bars {
            if !y.shows(value) {
                continue;
            }
            let at = x.position(frequency_hz);
            // What reaches beyond the axis ends at it; below zero nothing has a logarithm.
            let end = |value: f64, edge: f64| if y.shows(value) { y.position(value) } else { edge };
            let bar = PathElement::new(
                vec![(at, end(low, y.low)), (at, end(high, y.high))],
                color.stroke_width(8),
            );
            chart.draw_series([bar]).map_err(|error| told(&error))?;
            marker(&mut chart, (at, y.position(value)), own.style, true)?;
        }
    }
    Ok(())
}
