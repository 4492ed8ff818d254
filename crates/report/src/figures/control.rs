//! The control chart of a series: the statistic with its centre, its limits, and what lies beyond them.

use plotters::element::Circle;
use plotters::style::Color;
use plotters::style::text_anchor::{HPos, VPos};

use super::axis::{Axis, Scale, Tick};
use super::canvas::{Area, Ink, svg};
use super::group::{grouped, readings, series};
use super::law::line;
use super::panel::{Margins, TICK_SIZE, label, panel, pixels, text_style};
use super::thin;
use ieap_domain::number::fixed;

/// Width, px: that of the figure of the life above it.
const WIDTH: u32 = 400;
/// Height of the chart without its axis, px.
const CHART_HEIGHT: u32 = 78;
/// Room for the axis under it, px.
const AXIS_HEIGHT: u32 = 40;
/// Room beyond the limit where nothing lies there, as a share of the limit.
const BEYOND: f64 = 1.25;

/// One chart.
#[derive(Debug, Clone, PartialEq)]
pub struct ControlChart<'a> {
    /// `EWMA`.
    pub name: &'a str,
    /// Place on the axis and statistic of each reading.
    pub points: Vec<(f64, f64)>,
    /// Limit on either side of the centre, which is 0.
    pub limit: f64,
    /// What stands beside the first reading beyond it, as its date.
    pub first_beyond: String,
}

/// Draws `chart` over the axis `x`. None where it has no two readings.
///
/// # Errors
/// The message of the drawing library.
pub fn control_chart(
    chart: &ControlChart,
    x: &Axis,
    title: &str,
    desc: &str,
) -> Result<Option<String>, String> {
    if chart.points.len() < 2 {
        return Ok(None);
    }
    let size = (WIDTH, CHART_HEIGHT + AXIS_HEIGHT);
    svg(size, title, desc, |area| draw(area, chart, x)).map(Some)
}

fn draw(area: &Area, of: &ControlChart, x: &Axis) -> Result<(), String> {
    let margins = Margins {
        left: 66,
        right: 14,
        top: 6,
        bottom: AXIS_HEIGHT,
    };
    let y = vertical(of);
    let mut chart = panel(area, margins, x, &y, true)?;
    series(&mut chart, "", |chart| {
        for limit in [-of.limit, of.limit] {
            line(chart, vec![(x.low, limit), (x.high, limit)], Ink::Vermillion, 10)?;
        }
        line(chart, vec![(x.low, 0.0), (x.high, 0.0)], Ink::Muted, 10)
    })?;
    let place = |point: &(f64, f64)| (x.position(point.0), point.1);
    let all: Vec<(f64, f64)> = of.points.iter().map(place).collect();
    series(&mut chart, of.name, |chart| {
        let points = thin::line(&all, pixels(chart));
        line(chart, points, Ink::Blue, 12)
    })?;
    let beyond: Vec<(f64, f64)> = all
        .iter()
        .copied()
        .filter(|point| point.1.abs() > of.limit)
        .collect();
    let Some(&first) = beyond.first() else {
        return Ok(());
    };
    grouped(&mut chart, readings("", false, false), |chart| {
        let style = Ink::Vermillion.color().filled();
        chart
            .draw_series(beyond.iter().map(|point| Circle::new(*point, 26, style)))
            .map(|_| ())
            .map_err(|error| error.to_string())
    })?;
    // The text stands on the side of the point that has room.
    let (anchor, shift) = if first.0 < 0.5 * (x.low + x.high) {
        (HPos::Left, 6)
    } else {
        (HPos::Right, -6)
    };
    let style = text_style(Ink::Text, TICK_SIZE, anchor, VPos::Center);
    label(&mut chart, first, (shift, 0), &of.first_beyond, &style)
}

/// Centre and limits are its ticks.
fn vertical(of: &ControlChart) -> Axis {
    let most = of.points.iter().filter(|point| point.1.is_finite());
    let most = most.fold(BEYOND * of.limit, |most: f64, point| {
        most.max(1.08 * point.1.abs())
    });
    let tick = |at: f64| Tick {
        at,
        label: fixed(at, 1),
    };
    Axis {
        scale: Scale::Linear,
        low: -most,
        high: most,
        ticks: [-of.limit, 0.0, of.limit].map(tick).to_vec(),
        title: of.name.to_owned(),
        shown_factor: 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(statistic: &[f64]) -> ControlChart<'static> {
        ControlChart {
            name: "EWMA",
            points: statistic
                .iter()
                .enumerate()
                .map(|(k, y)| (k as f64, *y))
                .collect(),
            limit: 4.8,
            first_beyond: "12 Mar 2026".to_owned(),
        }
    }

    #[test]
    fn what_lies_beyond_the_limit_is_marked_and_dated() {
        let x = Axis::linear(0.0, 5.0, "Cycle", "", 5);
        let drawn = |statistic: &[f64]| control_chart(&chart(statistic), &x, "t", "d").unwrap().unwrap();
        let alarm = drawn(&[0.0, 1.0, 3.0, 5.2, 6.0]);
        assert!(alarm.contains("12 Mar 2026") && alarm.contains("4.8"), "{alarm}");
        assert_eq!(alarm.matches("dot-k-2-0").count(), 1, "{alarm}");
        let quiet = drawn(&[0.0, 1.0, -1.0, 2.0]);
        assert!(
            !quiet.contains("12 Mar 2026") && !quiet.contains("dot-k-2-0"),
            "{quiet}"
        );
        assert_eq!(control_chart(&chart(&[0.0]), &x, "t", "d").unwrap(), None);
    }
}
