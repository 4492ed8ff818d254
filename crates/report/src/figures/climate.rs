//! Climate: the air around one run, and the logs of a whole campaign.

use plotters::element::{PathElement, Rectangle};
use plotters::style::Color;
use plotters::style::text_anchor::{HPos, VPos};

use super::axis::{Axis, finite_range};
use super::calendar::calendar_axis;
use super::canvas::{Ink, TENTHS, svg};
use super::group::series;
use super::panel::{Chart, Margins, TICK_SIZE, label, panel, pixels, text_style};
use super::thin;
use ieap_analysis::zone::Zone;
use ieap_domain::climate::sensor_words;
use ieap_domain::{ClimateCurve, ClimateQuantity};

/// Width of the figure of one run, px.
const RUN_WIDTH: u32 = super::shape::PAGE_WIDTH;
/// Width of the overview, px.
const OVERVIEW_WIDTH: u32 = 1080;
/// Height of a panel without its time axis, px.
const PANEL_HEIGHT: u32 = 170;
/// Room for the time axis, px.
const TIME_AXIS_HEIGHT: u32 = 42;
/// A line is not drawn over a step this many times longer than most.
const GAP: f64 = 6.0;

/// The climate around a run, one panel a quantity; the run itself is shaded. None without readings.
///
/// # Errors
/// The message of the drawing library.
pub fn around_run(
    curves: &[ClimateCurve],
    length_s: f64,
    title: &str,
    desc: &str,
) -> Result<Option<String>, String> {
    let times = || {
        curves
            .iter()
            .flat_map(|curve| curve.time_s.iter().copied())
            .chain([0.0, length_s])
    };
    if curves.iter().all(|curve| curve.time_s.len() < 2) {
        return Ok(None);
    }
    let (low, high) = finite_range(times());
    let (unit, factor) = if high - low < 10_800.0 {
        ("min", 60.0)
    } else {
        ("h", 3600.0)
    };
    let x = Axis::linear(low / factor, high / factor, "Time since the start", "", 7);
    let x = Axis {
        title: format!("Time since the start of the run ({unit})"),
        ..x
    };
    let count = curves.len() as u32;
    let height = count * PANEL_HEIGHT + TIME_AXIS_HEIGHT;
    let drawn = svg((RUN_WIDTH, height), title, desc, |area| {
        let mut rest = area.clone();
        for (at, curve) in curves.iter().enumerate() {
            let is_last = at + 1 == curves.len();
            let own = if is_last {
                rest.clone()
            } else {
                let (above, below) = rest.split_vertically(PANEL_HEIGHT as i32 * TENTHS);
                rest = below;
                above
            };
            let y = value_axis(curve.quantity, curve.values.iter().copied());
            let mut chart = panel(&own, margins(is_last), &x, &y, is_last)?;
            series(&mut chart, "", |chart| {
                let shade = Rectangle::new(
                    [(0.0, y.low), (length_s / factor, y.high)],
                    Ink::Sky.color().mix(0.18).filled(),
                );
                chart
                    .draw_series([shade])
                    .map(|_| ())
                    .map_err(|error| error.to_string())
            })?;
            let time: Vec<f64> = curve.time_s.iter().map(|t| t / factor).collect();
            series(&mut chart, &curve.sensor, |chart| {
                lines(chart, &time, &curve.values, Ink::SERIES[at % 2])
            })?;
            let name = text_style(Ink::Muted, TICK_SIZE, HPos::Right, VPos::Top);
            label(
                &mut chart,
                (x.high, y.high),
                (-4, 3),
                &sensor_words(&curve.sensor),
                &name,
            )?;
        }
        Ok(())
    })?;
    Ok(Some(drawn))
}

/// A sensor's thinned readings in an overview.
#[derive(Debug, Clone, Copy)]
pub struct Drawn<'a> {
    /// Name of the sensor.
    pub name: &'a str,
    /// Time of each reading, s since 1970 UTC.
    pub times_s: &'a [f64],
    /// Readings.
    pub values: &'a [f64],
    /// Its colour: number of the series in [`Ink::SERIES`]; beyond them all are grey.
    pub style: usize,
}

/// All sensors of one quantity over time on the clock of `zone`, with a mark at each of `runs` (start and end, s since 1970 UTC). None
/// without readings.
///
/// # Errors
/// The message of the drawing library.
pub fn overview(
    quantity: ClimateQuantity,
    sensors: &[Drawn<'_>],
    runs: &[(f64, f64)],
    zone: &Zone,
    (title, desc): (&str, &str),
) -> Result<Option<String>, String> {
    let times = || sensors.iter().flat_map(|sensor| sensor.times_s.iter().copied());
    if times().next().is_none() {
        return Ok(None);
    }
    let (low, high) = finite_range(times());
    let margin = 0.01 * (high - low);
    let x = calendar_axis(low - margin, high + margin, 9, zone);
    let y = value_axis(
        quantity,
        sensors.iter().flat_map(|sensor| sensor.values.iter().copied()),
    );
    let drawn = svg(
        (OVERVIEW_WIDTH, PANEL_HEIGHT + 50 + TIME_AXIS_HEIGHT),
        title,
        desc,
        |area| {
            let mut chart = panel(area, margins(true), &x, &y, true)?;
            let height = 0.03 * (y.high - y.low);
            let within = runs.iter().filter(|(from, to)| *to >= x.low && *from <= x.high);
            let marks = within.map(|&(from, to)| {
                let width = (to - from).max(0.0015 * (x.high - x.low));
                let right = (from.max(x.low) + width).min(x.high);
                Rectangle::new(
                    [(from.max(x.low), y.low), (right, y.low + height)],
                    Ink::Text.color().filled(),
                )
            });
            series(&mut chart, "", |chart| {
                chart
                    .draw_series(marks)
                    .map(|_| ())
                    .map_err(|error| error.to_string())
            })?;
            // The last drawn lies on top: the coloured ones over the grey ones.
            for sensor in sensors.iter().rev() {
                let ink = Ink::SERIES.get(sensor.style).copied().unwrap_or(Ink::Muted);
                series(&mut chart, sensor.name, |chart| {
                    lines(chart, sensor.times_s, sensor.values, ink)
                })?;
            }
            Ok(())
        },
    )?;
    Ok(Some(drawn))
}

/// An axis over the values with some room; a steady climate is not blown up to fill it.
fn value_axis(quantity: ClimateQuantity, values: impl Iterator<Item = f64>) -> Axis {
    let (low, high) = finite_range(values);
    let least_span = match quantity {
        ClimateQuantity::RelativeHumidity => 4.0,
        ClimateQuantity::Pressure => (0.02 * high.abs()).max(1e-6),
        ClimateQuantity::Oxygen | ClimateQuantity::Water => 0.1,
        _ => 2.0,
    };
    let room = (0.08 * (high - low)).max(0.5 * (least_span - (high - low)));
    let mut axis = Axis::linear(low - room, high + room, quantity.label(), "", 5);
    axis.title = format!("{} ({})", quantity.label(), quantity.unit());
    axis
}

/// Lines through readings, broken at gaps; a reading between two gaps is a short stroke.
fn lines(chart: &mut Chart, times: &[f64], values: &[f64], ink: Ink) -> Result<(), String> {
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    let usual = steps.get(steps.len() * 3 / 4).copied().unwrap_or(0.0);
    let mut start = 0;
    for at in 1..=times.len() {
        if at < times.len() && times[at] - times[at - 1] <= GAP * usual {
            continue;
        }
        let points: Vec<(f64, f64)> = (start..at).map(|k| (times[k], values[k])).collect();
        if !points.is_empty() {
            let points = thin::line(&points, pixels(chart));
            let line = PathElement::new(points, ink.color().stroke_width(13));
            chart.draw_series([line]).map_err(|error| error.to_string())?;
        }
        start = at;
    }
    Ok(())
}

fn margins(x_labels: bool) -> Margins {
    Margins {
        left: 62,
        right: 24,
        top: 8,
        bottom: if x_labels { TIME_AXIS_HEIGHT } else { 8 },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(quantity: ClimateQuantity) -> ClimateCurve {
        ClimateCurve {
            sensor: "<b>10173910".into(),
            quantity,
            time_s: (-60..120).map(|k| f64::from(k) * 60.0).collect(),
            values: (-60..120).map(|k| 50.0 + f64::from(k) / 50.0).collect(),
        }
    }

    #[test]
    fn a_run_has_a_panel_a_quantity_with_units() {
        let curves = [
            curve(ClimateQuantity::RelativeHumidity),
            curve(ClimateQuantity::Temperature),
        ];
        let drawn = around_run(&curves, 3600.0, "t", "d").unwrap().unwrap();
        for text in [
            "Relative humidity (%)",
            "Temperature (°C)",
            "Time since the start of the run (min)",
            "10173910",
        ] {
            assert!(drawn.contains(text), "{text}");
        }
        assert!(!drawn.contains("<b>"));
        assert_eq!(around_run(&[], 10.0, "t", "d").unwrap(), None);
    }

    #[test]
    fn an_overview_breaks_its_lines_at_gaps() {
        let times: Vec<f64> = (0..200)
            .map(|k| 1.7e9 + f64::from(k) * 600.0 + if k > 99 { 5e5 } else { 0.0 })
            .collect();
        let values = vec![40.0; 200];
        let sensor = Drawn {
            name: "a",
            times_s: &times,
            values: &values,
            style: 0,
        };
        let drawn = overview(
            ClimateQuantity::RelativeHumidity,
            &[sensor],
            &[(1.7e9, 1.70001e9)],
            &Zone::utc(),
            ("t", "d"),
        );
        let drawn = drawn.unwrap().unwrap();
        let line = drawn.split("s k-1").nth(1).unwrap().split("/>").next().unwrap();
        assert_eq!(line.matches(['M', 'm']).count(), 2, "{line}");
        assert!(drawn.contains("Time (UTC)"));
        assert_eq!(
            overview(ClimateQuantity::Temperature, &[], &[], &Zone::utc(), ("t", "d")).unwrap(),
            None
        );
    }
}
