//! One response of all runs of a group on one axis, a line for each.

use plotters::series::LineSeries;
use plotters::style::Color;

use super::axis::{Axis, finite_range};
use super::canvas::{Ink, svg};
use super::group::series;
use super::panel::{Margins, panel, pixels};
use super::thin;
use ieap_domain::RunCurve;

/// Size, px.
const SIZE: (u32, u32) = (super::shape::PAGE_WIDTH, 220);
const MARGINS: Margins = Margins {
    left: 62,
    right: 16,
    top: 8,
    bottom: 42,
};
/// Shortest time that the axis tells apart, as a fraction of the longest.
const SHORTEST: f64 = 1e-6;

/// A run in the figure.
#[derive(Debug, Clone, Copy)]
pub struct Line<'a> {
    /// What its key says: the voltage.
    pub name: &'a str,
    /// Colour.
    pub ink: Ink,
    /// Its response.
    pub curve: &'a RunCurve,
    /// When its voltage stepped, s.
    pub step_s: f64,
}

impl Line<'_> {
    /// What is drawn: the fit, where there is one, for readings of several runs would hide each other.
    fn values(&self) -> &[f64] {
        if self.curve.fitted.len() == self.curve.time_s.len() {
            &self.curve.fitted
        } else {
            &self.curve.measured
        }
    }

    fn after_step(&self) -> impl Iterator<Item = (f64, f64)> {
        let times = self.curve.time_s.iter().map(|time_s| time_s - self.step_s);
        times
            .zip(self.values().iter().copied())
            .filter(|(t, y)| *t >= 0.0 && y.is_finite())
    }
}

/// Draws `lines`, which are of one quantity. None where there are fewer than two to draw.
///
/// # Errors
/// The message of the drawing library.
pub fn overlaid(lines: &[Line], title: &str, desc: &str) -> Result<Option<String>, String> {
    let lines: Vec<&Line> = lines
        .iter()
        .filter(|line| line.after_step().count() > 1)
        .collect();
    let Some(first) = lines.first().filter(|_| lines.len() > 1) else {
        return Ok(None);
    };
    let points = || lines.iter().flat_map(|line| line.after_step());
    let (_, last_s) = finite_range(points().map(|(t, _)| t));
    let (next_s, _) = finite_range(points().map(|(t, _)| t).filter(|t| *t > 0.0));
    let (low, high) = finite_range(points().map(|(_, y)| y));
    let unit_s = next_s.max(SHORTEST * last_s);
    let x = Axis::about_step(0.0, unit_s, last_s, "Time since the step");
    let quantity = first.curve.quantity;
    let margin = 0.05 * (high - low);
    let y = Axis::linear(low - margin, high + margin, quantity.label(), quantity.unit(), 4);
    let drawn = svg(SIZE, title, desc, |area| {
        let mut chart = panel(area, MARGINS, &x, &y, true)?;
        for line in &lines {
            let points: Vec<(f64, f64)> = line.after_step().map(|(t, y)| (x.position(t), y)).collect();
            let points = thin::line(&points, pixels(&chart));
            series(&mut chart, line.name, |chart| {
                let style = line.ink.color().stroke_width(14);
                chart
                    .draw_series(LineSeries::new(points, style))
                    .map(|_| ())
                    .map_err(|error| error.to_string())
            })?;
        }
        Ok(())
    })?;
    Ok(Some(drawn))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::Quantity;

    fn curve(level: f64) -> RunCurve {
        let time_s: Vec<f64> = (0..200).map(|k| f64::from(k) - 2.0).collect();
        RunCurve {
            quantity: Quantity::Current,
            measured: time_s
                .iter()
                .map(|t| level * (-t.max(0.0) / 30.0).exp())
                .collect(),
            time_s,
            fitted: Vec::new(),
            residual_sigma: Vec::new(),
            readings: 200,
        }
    }

    #[test]
    fn every_run_is_a_line_on_one_axis() {
        let curves = [curve(1e-3), curve(2e-3)];
        let line = |name, at: usize| Line {
            name,
            ink: Ink::ORDERED[at],
            curve: &curves[at],
            step_s: 0.0,
        };
        let drawn = overlaid(&[line("1.2 V", 0), line("2.0 V", 1)], "t", "d")
            .unwrap()
            .unwrap();
        for name in ["1.2 V", "2.0 V"] {
            assert_eq!(drawn.matches(&format!("data-s=\"{name}\"")).count(), 1, "{drawn}");
        }
        assert_eq!(drawn.matches("data-f=").count(), 1);
        assert!(drawn.len() < 3_000, "{} bytes", drawn.len());
        assert_eq!(overlaid(&[line("1.2 V", 0)], "t", "d").unwrap(), None);
    }
}
