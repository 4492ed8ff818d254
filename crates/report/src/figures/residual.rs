//! One channel of one run of a diagnosis: what the base model leaves and what the extended one leaves, in units of the
//! noise, with the band that noise alone fills; and, above it, the readings with what both models say.

use plotters::element::{Circle, PathElement, Polygon};
use plotters::series::LineSeries;
use plotters::style::Color;

use super::axis::{Axis, finite_range};
use super::canvas::{Area, Ink, TENTHS, svg};
use super::group::series;
use super::panel::{Chart, Margins, panel, pixels};
use super::thin;
use ieap_domain::{Quantity, ResidualCurve};

/// Width of a figure, px.
const WIDTH: u32 = super::shape::PAGE_WIDTH;
/// Height of a figure of residuals alone, px.
const HEIGHT: u32 = 190;
/// Heights of the two panels of an overlay, px.
const READINGS_HEIGHT: u32 = 210;
const RESIDUALS_HEIGHT: u32 = 170;
/// Half width of the band: single readings stay within it in 95 of 100 cases.
pub(crate) const BAND_SIGMA: f64 = 2.0;
/// Shortest time that the axis tells apart, as a fraction of the longest.
const SHORTEST: f64 = 1e-5;

/// What the two models are called in the legend.
#[derive(Debug, Clone, Copy)]
pub struct Called<'a> {
    /// The base model.
    pub base: &'a str,
    /// What is held against it.
    pub extension: &'a str,
}

/// How the time of a run is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clock {
    /// Since the step, so that seconds and hours have equal room.
    SinceStep,
    /// Evenly, as a voltage that moves all the time asks for.
    Even,
}

/// Draws the residuals of `curve`, the models `called` so. None where there is too little to draw.
///
/// # Errors
/// The message of the drawing library, or of a curve of uneven lengths.
pub fn residual(
    curve: &ResidualCurve,
    called: Called,
    clock: Clock,
    title: &str,
    desc: &str,
) -> Result<Option<String>, String> {
    let Some(drawing) = Drawing::of(curve, called, clock)? else {
        return Ok(None);
    };
    let drawn = svg((WIDTH, HEIGHT), title, desc, |area| drawing.residuals(area))?;
    Ok(Some(drawn))
}

/// Draws the readings of `curve` with both models, and the residuals under them. None where there is too little to draw,
/// or the diagnosis is of a version that did not keep the readings.
///
/// # Errors
/// The message of the drawing library, or of a curve of uneven lengths.
pub fn overlay(
    curve: &ResidualCurve,
    called: Called,
    clock: Clock,
    title: &str,
    desc: &str,
) -> Result<Option<String>, String> {
    let drawing = match Drawing::of(curve, called, clock)? {
        Some(drawing) if !curve.measured.is_empty() => drawing,
        _ => return Ok(None),
    };
    let height = READINGS_HEIGHT + RESIDUALS_HEIGHT;
    let drawn = svg((WIDTH, height), title, desc, |area| {
        let (above, below) = area.split_vertically(READINGS_HEIGHT as i32 * TENTHS);
        drawing.readings(&above)?;
        drawing.residuals(&below)
    })?;
    Ok(Some(drawn))
}

/// What both panels share.
struct Drawing<'a> {
    curve: &'a ResidualCurve,
    called: Called<'a>,
    x: Axis,
}

impl Drawing<'_> {
    fn of<'a>(
        curve: &'a ResidualCurve,
        called: Called<'a>,
        clock: Clock,
    ) -> Result<Option<Drawing<'a>>, String> {
        check_lengths(curve)?;
        let last_s = curve.time_s.last().copied().unwrap_or(0.0);
        let after: Vec<f64> = curve
            .time_s
            .iter()
            .copied()
            .filter(|t| *t > SHORTEST * last_s)
            .collect();
        if after.len() < 2 {
            return Ok(None);
        }
        let (first_s, _) = finite_range(curve.time_s.iter().copied());
        let x = match clock {
            Clock::SinceStep => Axis::about_step(first_s.min(0.0), after[0], last_s, "Time since the step"),
            Clock::Even => Axis::linear(first_s, last_s, "Time", "s", 6),
        };
        Ok(Some(Drawing { curve, called, x }))
    }

    /// The readings as dots, the models as lines.
    fn readings(&self, area: &Area) -> Result<(), String> {
        let curve = self.curve;
        let extended = self.extended();
        let all = [&curve.measured[..], &curve.base, extended];
        let (low, high) = finite_range(all.into_iter().flatten().copied());
        let margin = 0.05 * (high - low);
        let (label, unit) = match curve.channel.as_str() {
            "current" => (Quantity::Current.label(), Quantity::Current.unit()),
            "curvature" => (Quantity::Curvature.label(), Quantity::Curvature.unit()),
            other => (other, ""),
        };
        let y = Axis::linear(low - margin, high + margin, label, unit, 4);
        let mut chart = panel(area, margins(false), &self.x, &y, false)?;
        series(&mut chart, "Measured", |chart| {
            dots(chart, &self.points(&curve.measured), Ink::Muted)
        })?;
        series(&mut chart, self.called.base, |chart| {
            line(chart, &self.points(&curve.base), Ink::Vermillion)
        })?;
        if extended.is_empty() {
            return Ok(());
        }
        series(&mut chart, self.called.extension, |chart| {
            line(chart, &self.points(extended), Ink::Blue)
        })
    }

    /// What the extended model says; nothing where its residuals are withheld, because the finding is not about it.
    fn extended(&self) -> &[f64] {
        if self.curve.after_sigma.is_empty() {
            &[]
        } else {
            &self.curve.extended
        }
    }

    fn residuals(&self, area: &Area) -> Result<(), String> {
        let (x, y) = (&self.x, &vertical(self.curve));
        let mut chart = panel(area, margins(true), x, y, true)?;
        series(&mut chart, "", |chart| band(chart, x))?;
        series(&mut chart, self.called.base, |chart| {
            dots(chart, &self.points(&self.curve.before_sigma), Ink::Vermillion)
        })?;
        if self.curve.after_sigma.is_empty() {
            return Ok(());
        }
        let after = thin::dots(&self.points(&self.curve.after_sigma));
        series(&mut chart, self.called.extension, |chart| {
            draw_line(chart, after, Ink::Blue)
        })
    }

    fn points(&self, values: &[f64]) -> Vec<(f64, f64)> {
        let at = self.curve.time_s.iter().map(|time_s| self.x.position(*time_s));
        at.zip(values.iter().copied())
            .filter(|(x, y)| x.is_finite() && y.is_finite())
            .collect()
    }
}

/// The source of the curves is outside this module: a series of another length must not end the program.
fn check_lengths(curve: &ResidualCurve) -> Result<(), String> {
    let n = curve.time_s.len();
    let even = |values: &Vec<f64>| [0, n].contains(&values.len());
    let rest = [&curve.after_sigma, &curve.measured, &curve.base, &curve.extended];
    if curve.before_sigma.len() == n && rest.into_iter().all(even) {
        Ok(())
    } else {
        Err(format!(
            "a residual of {n} times has {} and {} values, and {} readings",
            curve.before_sigma.len(),
            curve.after_sigma.len(),
            curve.measured.len()
        ))
    }
}

fn margins(x_labels: bool) -> Margins {
    Margins {
        left: 62,
        right: 16,
        top: 8,
        bottom: if x_labels { 42 } else { 6 },
    }
}

/// Symmetric, and wide enough for the band.
fn vertical(curve: &ResidualCurve) -> Axis {
    let all = curve.before_sigma.iter().chain(&curve.after_sigma);
    let most = all
        .filter(|sigma| sigma.is_finite())
        .fold(1.5 * BAND_SIGMA, |most: f64, sigma| most.max(sigma.abs()));
    Axis::linear(-1.05 * most, 1.05 * most, "Residual / σ", "", 5)
}

/// The band that noise fills, and its middle.
fn band(chart: &mut Chart, x: &Axis) -> Result<(), String> {
    let corners = vec![
        (x.low, -BAND_SIGMA),
        (x.high, -BAND_SIGMA),
        (x.high, BAND_SIGMA),
        (x.low, BAND_SIGMA),
    ];
    chart
        .draw_series([Polygon::new(corners, Ink::Muted.color().mix(0.16))])
        .map_err(|error| error.to_string())?;
    let zero = [(x.low, 0.0), (x.high, 0.0)];
    chart
        .draw_series([PathElement::new(zero, Ink::Muted.color().stroke_width(10))])
        .map(|_| ())
        .map_err(|error| error.to_string())
}

fn dots(chart: &mut Chart, points: &[(f64, f64)], ink: Ink) -> Result<(), String> {
    let points = thin::dots(points);
    let style = ink.color().filled();
    chart
        .draw_series(points.into_iter().map(|point| Circle::new(point, 15, style)))
        .map(|_| ())
        .map_err(|error| error.to_string())
}

fn line(chart: &mut Chart, points: &[(f64, f64)], ink: Ink) -> Result<(), String> {
    let points = thin::line(points, pixels(chart));
    draw_line(chart, points, ink)
}

fn draw_line(chart: &mut Chart, points: Vec<(f64, f64)>, ink: Ink) -> Result<(), String> {
    chart
        .draw_series(LineSeries::new(points, ink.color().stroke_width(16)))
        .map(|_| ())
        .map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    const CALLED: Called = Called {
        base: "before",
        extension: "after",
    };

    fn curve(n: usize) -> ResidualCurve {
        let time_s: Vec<f64> = (0..n).map(|k| 0.5 + k as f64).collect();
        ResidualCurve {
            run: "runs/a.csv".into(),
            channel: "current".into(),
            before_sigma: time_s.iter().map(|t| 3.0 * (0.01 * t).sin()).collect(),
            after_sigma: vec![0.1; n],
            measured: time_s.iter().map(|t| 2e-3 * (-t / 20.0).exp()).collect(),
            base: time_s.iter().map(|t| 2.1e-3 * (-t / 20.0).exp()).collect(),
            extended: time_s.iter().map(|t| 2e-3 * (-t / 20.0).exp()).collect(),
            time_s,
        }
    }

    #[test]
    fn a_figure_of_160_points_stays_small() {
        let drawn = residual(&curve(160), CALLED, Clock::SinceStep, "t", "d")
            .unwrap()
            .unwrap();
        assert!(drawn.len() < 8_000, "{} bytes", drawn.len());
    }

    #[test]
    fn too_little_and_uneven_are_said() {
        assert_eq!(
            residual(&curve(1), CALLED, Clock::SinceStep, "t", "d").unwrap(),
            None
        );
        let mut uneven = curve(20);
        uneven.before_sigma.pop();
        assert!(
            residual(&uneven, CALLED, Clock::SinceStep, "t", "d").is_err_and(|reason| reason.contains("19"))
        );
        let mut earlier = curve(20);
        earlier.measured.clear();
        assert_eq!(
            overlay(&earlier, CALLED, Clock::SinceStep, "t", "d").unwrap(),
            None
        );
    }

    #[test]
    fn an_overlay_has_readings_two_models_and_what_they_leave() {
        let drawn = overlay(&curve(160), CALLED, Clock::SinceStep, "t", "d")
            .unwrap()
            .unwrap();
        assert!(
            drawn.contains("Current (mA)") && drawn.contains("Residual"),
            "{drawn}"
        );
        let of = |name: &str| drawn.matches(&format!("data-s=\"{name}\"")).count();
        assert_eq!([of("Measured"), of("before"), of("after")], [1, 2, 2]);
        assert!(drawn.len() < 12_000, "{} bytes", drawn.len());
    }

    #[test]
    fn a_moving_voltage_is_drawn_over_an_even_clock() {
        let of = |clock| overlay(&curve(160), CALLED, clock, "t", "d").unwrap().unwrap();
        assert!(of(Clock::SinceStep).contains("Time since the step"));
        let even = of(Clock::Even);
        assert!(even.contains("Time (s)") && !even.contains("since"), "{even}");
    }

    #[test]
    fn an_extension_that_is_not_the_finding_is_not_drawn() {
        let withheld = ResidualCurve {
            after_sigma: vec![],
            extended: vec![1.0; 200],
            ..curve(200)
        };
        let drawn = overlay(&withheld, CALLED, Clock::SinceStep, "t", "d").unwrap();
        assert!(!drawn.unwrap_or_default().contains("data-s=\"after\""));
    }

    #[test]
    fn numbers_that_are_none_are_left_out() {
        let mut curve = curve(20);
        curve.before_sigma[3] = f64::NAN;
        curve.after_sigma[4] = f64::INFINITY;
        assert!(
            residual(&curve, CALLED, Clock::SinceStep, "t", "d")
                .unwrap()
                .is_some()
        );
    }
}
