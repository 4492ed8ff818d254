//! Residuals of one channel of one run in units of the noise: what the base model leaves and what the extended
//! one leaves, over time and over the logarithm of time, with the band that noise alone fills.

use plotters::element::{Circle, PathElement, Polygon};
use plotters::series::LineSeries;
use plotters::style::Color;

use super::axis::Axis;
use super::canvas::{Area, Ink, TENTHS, svg};
use super::group::series;
use super::panel::{Chart, Margins, panel, pixels};
use super::thin;
use ieap_domain::ResidualCurve;

/// Width of each half, px.
const HALF_WIDTH: u32 = 440;
const HEIGHT: u32 = 190;
/// Half width of the band: single readings stay within it in 95 of 100 cases.
const BAND_SIGMA: f64 = 2.0;
/// Shortest time on the logarithmic axis, as a fraction of the longest.
const SHORTEST: f64 = 1e-5;

/// Draws `curve`, its line called `extension`; over the logarithm of time alone where `whole` is false. None where there
/// is too little to draw.
///
/// # Errors
/// The message of the drawing library, or of a curve of uneven lengths.
pub fn residual(
    curve: &ResidualCurve,
    extension: &str,
    whole: bool,
    title: &str,
    desc: &str,
) -> Result<Option<String>, String> {
    let n = curve.time_s.len();
    let even = curve.before_sigma.len() == n && [0, n].contains(&curve.after_sigma.len());
    if !even {
        return Err(format!(
            "a residual of {n} times has {} and {} values",
            curve.before_sigma.len(),
            curve.after_sigma.len()
        ));
    }
    let last_s = curve.time_s.last().copied().unwrap_or(0.0);
    let since: Vec<usize> = (0..n).filter(|&k| curve.time_s[k] > SHORTEST * last_s).collect();
    if since.len() < 2 {
        return Ok(None);
    }
    let y = vertical(curve);
    let first_s = curve.time_s[since[0]];
    let logarithmic = Axis::log(0.9 * first_s, 1.1 * last_s, "Time since the step", "s");
    let width = if whole { 2 * HALF_WIDTH } else { HALF_WIDTH };
    let drawn = svg((width, HEIGHT), title, desc, |area| {
        if !whole {
            return Half {
                curve,
                extension,
                x: &logarithmic,
                y: &y,
            }
            .draw(area, &since);
        }
        let (left, right) = area.split_horizontally(HALF_WIDTH as i32 * TENTHS);
        let margin = 0.015 * (last_s - curve.time_s[0]);
        let linear = Axis::linear(curve.time_s[0] - margin, last_s + margin, "Time", "s", 6);
        let all: Vec<usize> = (0..n).collect();
        Half {
            curve,
            extension,
            x: &logarithmic,
            y: &y,
        }
        .draw(&left, &since)?;
        Half {
            curve,
            extension,
            x: &linear,
            y: &y,
        }
        .draw(&right, &all)
    })?;
    Ok(Some(drawn))
}

/// Symmetric, and wide enough for the band.
fn vertical(curve: &ResidualCurve) -> Axis {
    let all = curve.before_sigma.iter().chain(&curve.after_sigma);
    let most = all
        .filter(|sigma| sigma.is_finite())
        .fold(1.5 * BAND_SIGMA, |most: f64, sigma| most.max(sigma.abs()));
    Axis::linear(-1.05 * most, 1.05 * most, "Residual / σ", "", 5)
}

struct Half<'a> {
    curve: &'a ResidualCurve,
    extension: &'a str,
    x: &'a Axis,
    y: &'a Axis,
}

impl Half<'_> {
    fn draw(&self, area: &Area, shown: &[usize]) -> Result<(), String> {
        let margins = Margins {
            left: 58,
            right: 14,
            top: 8,
            bottom: 42,
        };
        let mut chart = panel(area, margins, self.x, self.y, true)?;
        series(&mut chart, "", |chart| self.band(chart))?;
        let before = thin::dots(&self.points(&self.curve.before_sigma, shown), pixels(&chart));
        series(&mut chart, "Base model", |chart| {
            let style = Ink::Vermillion.color().filled();
            chart
                .draw_series(before.into_iter().map(|point| Circle::new(point, 15, style)))
                .map(|_| ())
                .map_err(|error| error.to_string())
        })?;
        if self.curve.after_sigma.is_empty() {
            return Ok(());
        }
        let after = thin::dots(&self.points(&self.curve.after_sigma, shown), pixels(&chart));
        series(&mut chart, self.extension, |chart| {
            chart
                .draw_series(LineSeries::new(after, Ink::Blue.color().stroke_width(16)))
                .map(|_| ())
                .map_err(|error| error.to_string())
        })
    }

    /// The band that noise fills, and its middle.
    fn band(&self, chart: &mut Chart) -> Result<(), String> {
        let (low, high) = (self.x.low, self.x.high);
        let corners = vec![
            (low, -BAND_SIGMA),
            (high, -BAND_SIGMA),
            (high, BAND_SIGMA),
            (low, BAND_SIGMA),
        ];
        chart
            .draw_series([Polygon::new(corners, Ink::Muted.color().mix(0.16))])
            .map_err(|error| error.to_string())?;
        let zero = [(low, 0.0), (high, 0.0)];
        chart
            .draw_series([PathElement::new(zero, Ink::Muted.color().stroke_width(10))])
            .map(|_| ())
            .map_err(|error| error.to_string())
    }

    fn points(&self, sigma: &[f64], shown: &[usize]) -> Vec<(f64, f64)> {
        shown
            .iter()
            .map(|&k| (self.x.position(self.curve.time_s[k]), sigma[k]))
            .filter(|(x, y)| x.is_finite() && y.is_finite())
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(n: usize) -> ResidualCurve {
        let time_s: Vec<f64> = (0..n).map(|k| 0.5 + k as f64).collect();
        ResidualCurve {
            run: "runs/a.csv".into(),
            channel: "current".into(),
            before_sigma: time_s.iter().map(|t| 3.0 * (0.01 * t).sin()).collect(),
            after_sigma: vec![0.1; n],
            time_s,
        }
    }

    #[test]
    fn a_figure_of_160_points_stays_small() {
        let drawn = residual(&curve(160), "after", true, "t", "d").unwrap().unwrap();
        assert!(drawn.len() < 16_000, "{} bytes", drawn.len());
        let half = residual(&curve(160), "after", false, "t", "d").unwrap().unwrap();
        assert!(half.len() < drawn.len());
    }

    #[test]
    fn too_little_and_uneven_are_said() {
        assert_eq!(residual(&curve(1), "after", true, "t", "d").unwrap(), None);
        let mut uneven = curve(20);
        uneven.before_sigma.pop();
        assert!(residual(&uneven, "after", true, "t", "d").is_err_and(|reason| reason.contains("19")));
    }

    #[test]
    fn numbers_that_are_none_are_left_out() {
        let mut curve = curve(20);
        curve.before_sigma[3] = f64::NAN;
        curve.after_sigma[4] = f64::INFINITY;
        assert!(residual(&curve, "after", true, "t", "d").unwrap().is_some());
    }
}
