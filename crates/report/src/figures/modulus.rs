//! Modulus logs: the normalised modulus of several under their humidity (the thesis's figure 24), and every channel
//! of one log over its time.

use plotters::element::Circle;
use plotters::series::LineSeries;
use plotters::style::Color;
use plotters::style::text_anchor::{HPos, VPos};

use super::axis::{Axis, finite_range};
use super::canvas::{Area, Drawing, Ink, TENTHS, drawing, svg};
use super::comparison::{ink, marker};
use super::group::series;
use super::panel::{Chart, Margins, TICK_SIZE, label, panel, pixels, text_style};
use super::positions::Positions;
use super::thin;
use ieap_domain::{Quantity, RunCurve};

/// Width of a figure, px.
const WIDTH: u32 = 760;
/// Height of the first panel of a figure, and of each below it, px.
const FIRST_HEIGHT: u32 = 230;
const FURTHER_HEIGHT: u32 = 100;
/// Room under the lowest panel for the time axis, px.
const TIME_AXIS_HEIGHT: u32 = 42;
/// Height of a row of the legend, and the width of one entry, px.
const LEGEND_ROW: u32 = 18;
const LEGEND_ENTRY: u32 = 230;
/// Markers on a line, so that lines are told apart without colour.
const MARKERS: usize = 9;
const SECONDS_PER_MINUTE: f64 = 60.0;

/// Places on a line, from left to right.
type Line = Vec<(f64, f64)>;

/// One log in the figure of several.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalisedLog<'a> {
    /// Name in the legend.
    pub name: String,
    /// |E*| over time.
    pub modulus: &'a RunCurve,
    /// Humidity over time, where there is any.
    pub humidity: Option<&'a RunCurve>,
    /// Time that is zero, s: the first humidity step.
    pub origin_s: f64,
    /// Value that is 100 %, MPa.
    pub whole_mpa: f64,
}

/// Draws |E*| relative to its value before the first humidity step, with the humidity below.
///
/// # Errors
/// The message of the drawing library.
pub fn normalised(logs: &[NormalisedLog], title: &str, desc: &str) -> Result<String, String> {
    Ok(super::svg::inline(&normalised_drawing(WIDTH, logs)?, title, desc))
}

/// The same `width` pixels wide, wherever it is shown.
///
/// # Errors
/// The message of the drawing library.
pub fn normalised_drawing(width: u32, logs: &[NormalisedLog]) -> Result<Drawing, String> {
    let minutes = |log: &NormalisedLog, time_s: f64| (time_s - log.origin_s) / SECONDS_PER_MINUTE;
    let modulus: Vec<Vec<(f64, f64)>> = logs
        .iter()
        .map(|log| {
            let percent = |value: f64| 100.0 * value / log.whole_mpa;
            points(log.modulus, |t| minutes(log, t), percent)
        })
        .collect();
    let humidity: Vec<Vec<(f64, f64)>> = logs
        .iter()
        .map(|log| {
            log.humidity
                .map_or_else(Vec::new, |curve| points(curve, |t| minutes(log, t), |v| v))
        })
        .collect();
    let time = finite_range(modulus.iter().flatten().map(|point| point.0));
    let x = time_axis(time, "Time since the first humidity step");
    let entries = (width.saturating_sub(62) / LEGEND_ENTRY).max(1);
    let rows = (logs.len() as u32).div_ceil(entries);
    let legend = rows * LEGEND_ROW;
    let with_humidity = humidity.iter().any(|points| !points.is_empty());
    let below = if with_humidity { FURTHER_HEIGHT } else { 0 };
    let size = (width, legend + FIRST_HEIGHT + below + TIME_AXIS_HEIGHT);
    drawing(size, |area| {
        let (top, rest) = area.split_vertically((legend + 4) as i32 * TENTHS);
        draw_legend(&top, logs, entries)?;
        let shown = || modulus.iter().flatten().map(|point| point.1);
        let y = value_axis(shown(), "|E*| relative to before", "%");
        if !with_humidity {
            return draw_lines(&rest, &x, &y, (&modulus, logs), true);
        }
        let (above, below) = rest.split_vertically(FIRST_HEIGHT as i32 * TENTHS);
        draw_lines(&above, &x, &y, (&modulus, logs), false)?;
        let y = value_axis(humidity.iter().flatten().map(|point| point.1), "RH", "%");
        draw_lines(&below, &x, &y, (&humidity, logs), true)
    })
}

/// Draws every curve of a log, the first with its fit, in panels over one time axis; lines at `steps_s`.
///
/// # Errors
/// The message of the drawing library.
pub fn log_panels(curves: &[&RunCurve], steps_s: &[f64], title: &str, desc: &str) -> Result<String, String> {
    let minutes = |time_s: f64| time_s / SECONDS_PER_MINUTE;
    let x = time_axis(
        finite_range(
            curves
                .iter()
                .flat_map(|curve| curve.time_s.iter().map(|&t| minutes(t))),
        ),
        "Time",
    );
    let further = FURTHER_HEIGHT * curves.len().saturating_sub(1) as u32;
    let size = (WIDTH, FIRST_HEIGHT + further + TIME_AXIS_HEIGHT);
    svg(size, title, desc, |area| {
        let mut rest = area.clone();
        for (at, curve) in curves.iter().enumerate() {
            let is_last = at + 1 == curves.len();
            let height = if at == 0 { FIRST_HEIGHT } else { FURTHER_HEIGHT };
            let (here, below) = if is_last {
                (rest.clone(), rest.clone())
            } else {
                rest.split_vertically(height as i32 * TENTHS)
            };
            rest = below;
            let all = curve.measured.iter().chain(&curve.fitted).copied();
            let (name, unit) = axis_name(curve.quantity);
            let y = value_axis(all, name, unit);
            let mut chart = panel(&here, margins(is_last), &x, &y, is_last)?;
            series(&mut chart, "", |chart| {
                let steps = steps_s.iter().map(|&t| minutes(t)).filter(|&t| x.shows(t));
                steps
                    .map(|step| [(step, y.low), (step, y.high)])
                    .try_for_each(|line| draw_line(chart, &line, Ink::Muted, 8))
            })?;
            let dots = thin::dots(&points(curve, minutes, |v| v));
            series(&mut chart, "Readings", |chart| {
                let style = Ink::Text.color().mix(0.6).filled();
                chart
                    .draw_series(dots.into_iter().map(|point| Circle::new(point, 9, style)))
                    .map(|_| ())
                    .map_err(|error| error.to_string())
            })?;
            let stretches = fitted_stretches(curve, minutes);
            if !stretches.is_empty() {
                series(&mut chart, "Fit", |chart| {
                    stretches.iter().try_for_each(|stretch| {
                        let corners = thin::line(stretch, pixels(chart));
                        draw_line(chart, &corners, Ink::Vermillion, 16)
                    })
                })?;
            }
        }
        Ok(())
    })
}

/// Short name and unit of an axis.
fn axis_name(quantity: Quantity) -> (&'static str, &'static str) {
    match quantity {
        Quantity::ComplexModulus => ("|E*|", "MPa"),
        Quantity::StorageModulus => ("E′", "MPa"),
        Quantity::LossModulus => ("E″", "MPa"),
        Quantity::LossFactor => ("tan δ", ""),
        Quantity::RelativeHumidity => ("RH", "%"),
        Quantity::Temperature => ("T", "°C"),
        other => (other.label(), other.unit()),
    }
}

/// Finite points of a curve.
fn points(curve: &RunCurve, x: impl Fn(f64) -> f64, y: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    let pairs = curve.time_s.iter().zip(&curve.measured);
    let all = pairs.map(|(&t, &v)| (x(t), y(v)));
    all.filter(|point| point.0.is_finite() && point.1.is_finite())
        .collect()
}

/// The fitted curve in stretches without a gap.
fn fitted_stretches(curve: &RunCurve, x: impl Fn(f64) -> f64) -> Vec<Vec<(f64, f64)>> {
    let mut stretches = vec![Vec::new()];
    for (&t, &value) in curve.time_s.iter().zip(&curve.fitted) {
        if value.is_finite() {
            if let Some(last) = stretches.last_mut() {
                last.push((x(t), value));
            }
        } else {
            stretches.push(Vec::new())
        }
    }
    stretches.retain(|stretch| stretch.len() > 1);
    stretches
}

fn draw_lines(
    area: &Area,
    x: &Axis,
    y: &Axis,
    (lines, logs): (&[Line], &[NormalisedLog]),
    x_labels: bool,
) -> Result<(), String> {
    let mut chart = panel(area, margins(x_labels), x, y, x_labels)?;
    for (style, (line, log)) in lines.iter().zip(logs).enumerate() {
        // Each line has its markers at other places, so that they do not hide each other.
        let spacing = (line.len() / MARKERS).max(1);
        let offset = spacing * (style + 1) / (lines.len() + 1);
        let thinned = thin::line(line, pixels(&chart));
        series(&mut chart, &log.name, |chart| {
            draw_line(chart, &thinned, ink(style), 14)
        })?;
        series(&mut chart, "", |chart| {
            let marked = line.iter().skip(offset).step_by(spacing);
            marked
                .copied()
                .try_for_each(|point| marker(chart, point, style, true))
        })?;
    }
    Ok(())
}

fn draw_line(chart: &mut Chart, line: &[(f64, f64)], ink: Ink, width: u32) -> Result<(), String> {
    let series = LineSeries::new(line.iter().copied(), ink.color().stroke_width(width));
    chart
        .draw_series(series)
        .map(|_| ())
        .map_err(|error| error.to_string())
}

fn draw_legend(area: &Area, logs: &[NormalisedLog], entries: u32) -> Result<(), String> {
    let (width, height) = area.dim_in_pixel();
    // Places in pixels, from the top left corner.
    let in_pixels = |low: f64, high: f64| Axis {
        ticks: Vec::new(),
        title: String::new(),
        ..Axis::linear(low, high, "", "", 2)
    };
    let x = in_pixels(0.0, f64::from(width) / f64::from(TENTHS));
    let y = in_pixels(-f64::from(height) / f64::from(TENTHS), 0.0);
    let none = Margins {
        left: 0,
        right: 0,
        top: 0,
        bottom: 0,
    };
    let mut chart = plain_chart(area, none, &x, &y)?;
    let columns = entries as usize;
    let text = text_style(Ink::Text, TICK_SIZE, HPos::Left, VPos::Center);
    for (style, log) in logs.iter().enumerate() {
        let left = 62.0 + f64::from(LEGEND_ENTRY) * (style % columns) as f64;
        let middle = -f64::from(LEGEND_ROW) * ((style / columns) as f64 + 0.5);
        draw_line(
            &mut chart,
            &[(left, middle), (left + 24.0, middle)],
            ink(style),
            14,
        )?;
        marker(&mut chart, (left + 12.0, middle), style, true)?;
        label(
            &mut chart,
            (left + 30.0, middle),
            (0, 0),
            &shortened(&log.name),
            &text,
        )?;
    }
    Ok(())
}

/// A name that fits into an entry of the legend.
fn shortened(name: &str) -> String {
    const LONGEST: usize = 32;
    if name.chars().count() > LONGEST {
        name.chars().take(LONGEST - 1).chain(['…']).collect()
    } else {
        name.to_owned()
    }
}

/// A chart without grid or axes.
fn plain_chart<'a, 'b>(
    area: &'a Area<'b>,
    margins: Margins,
    x: &Axis,
    y: &Axis,
) -> Result<Chart<'a, 'b>, String> {
    let tenths = |pixels: u32| pixels as i32 * TENTHS;
    plotters::prelude::ChartBuilder::on(area)
        .margin(tenths(margins.top))
        .build_cartesian_2d(Positions::from(x), Positions::from(y))
        .map_err(|error| error.to_string())
}

fn margins(x_labels: bool) -> Margins {
    Margins {
        left: 62,
        right: 16,
        top: 8,
        bottom: if x_labels { TIME_AXIS_HEIGHT } else { 6 },
    }
}

/// The unit stands in the title: a prefix before minutes would be read by nobody.
fn time_axis((low, high): (f64, f64), title: &str) -> Axis {
    let margin = 0.015 * (high - low);
    Axis::linear(low - margin, high + margin, &format!("{title} (min)"), "", 8)
}

fn value_axis(values: impl Iterator<Item = f64>, name: &str, unit: &str) -> Axis {
    let (low, high) = finite_range(values);
    let margin = 0.06 * (high - low).max(1e-3 * high.abs());
    let title = match unit {
        "" => name.to_owned(),
        unit => format!("{name} ({unit})"),
    };
    Axis::linear(low - margin, high + margin, &title, "", 4)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(quantity: Quantity, values: impl Fn(f64) -> f64, fitted: bool) -> RunCurve {
        let time_s: Vec<f64> = (0..300).map(|k| 60.0 * f64::from(k)).collect();
        let measured: Vec<f64> = time_s.iter().map(|&t| values(t)).collect();
        let after = |(&t, &v): (&f64, &f64)| if t > 3600.0 { v } else { f64::NAN };
        RunCurve {
            quantity,
            fitted: if fitted {
                time_s.iter().zip(&measured).map(after).collect()
            } else {
                Vec::new()
            },
            residual_sigma: Vec::new(),
            readings: time_s.len(),
            time_s,
            measured,
        }
    }

    #[test]
    fn several_logs_share_their_axes_and_have_a_legend() {
        let modulus = curve(Quantity::ComplexModulus, |t| 460.0 - t / 100.0, false);
        let humidity = curve(
            Quantity::RelativeHumidity,
            |t| if t > 3600.0 { 40.0 } else { 0.0 },
            false,
        );
        let log = |name: &str, humidity| NormalisedLog {
            name: name.to_owned(),
            modulus: &modulus,
            humidity,
            origin_s: 3600.0,
            whole_mpa: 424.0,
        };
        let logs = [
            log("dry", Some(&humidity)),
            log("<b>wet</b>", None),
            log(&"long ".repeat(20), None),
            log("fourth", None),
        ];
        let drawn = normalised(&logs, "t", "d").unwrap();
        for text in ["RH (%)", "|E*| relative to before (%)", "(min)", "dry", "…"] {
            assert!(drawn.contains(text), "{text}");
        }
        assert!(!drawn.contains("<b>") && !drawn.contains("NaN"));
        let without = normalised(&logs[1..2], "t", "d").unwrap();
        assert!(!without.contains("RH (%)"));
    }

    #[test]
    fn a_log_is_drawn_with_every_channel_and_its_fit_in_stretches() {
        let modulus = curve(Quantity::ComplexModulus, |t| 70.0 - t / 1000.0, true);
        let factor = curve(Quantity::LossFactor, |_| 0.1, false);
        let drawn = log_panels(&[&modulus, &factor], &[3600.0], "t", "d").unwrap();
        assert!(drawn.contains("|E*| (MPa)") && drawn.contains("tan δ"));
        assert!(!drawn.contains("NaN"), "{drawn}");
        assert_eq!(fitted_stretches(&modulus, |t| t).len(), 1);
    }
}
