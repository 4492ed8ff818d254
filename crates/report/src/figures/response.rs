//! One response of a run: measured readings with the fitted curve, and the residuals under them.
//!
//! Where the drive is one step, all readings stand in one figure: time since the step is linear at first and then
//! logarithmic, so that charging (seconds) and creep (hours) get equal room, and what precedes the step stands linear in
//! a strip before it. A linear axis would hide the first seconds, in which the fit of R₁ and C₁ is decided; a second
//! figure of the same readings would double the bytes of a page. Where the drive changes again, a response is drawn over
//! the whole run in linear time, and over the logarithm of the time since the first step.

use plotters::element::{Circle, PathElement};
use plotters::series::LineSeries;
use plotters::style::Color;

use super::axis::{Axis, finite_range};
use super::canvas::{Area, Ink, TENTHS, svg};
use super::group::{grouped, readings, series};
use super::panel::{Chart, Margins, panel, pixels};
use super::thin;
use ieap_domain::RunCurve;
use ieap_domain::number::significant;

/// Width of one figure, px.
const WIDTH: u32 = super::shape::PAGE_WIDTH;
/// Height of the panel with the readings, px.
const READINGS_HEIGHT: u32 = 210;
/// Height of the panel with the residuals, px.
const RESIDUALS_HEIGHT: u32 = 120;
/// Room under the lowest panel for the time axis, px.
const TIME_AXIS_HEIGHT: u32 = 42;
/// Shortest time shown on a logarithmic axis, as a fraction of the longest.
const SHORTEST: f64 = 1e-6;

/// Radius of open dots, tenths of a pixel: large enough to be seen to be open.
const OPEN_RADIUS: i32 = 22;

/// Which times a figure shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TimeView {
    /// The whole run in linear time.
    Whole,
    /// The whole run in the time since its one step at `step_s`, over an axis that its responses share: see
    /// [`Axis::about_step`].
    AboutStep {
        /// Time of the step, s.
        step_s: f64,
        /// First time of any response, s.
        first_s: f64,
        /// First time of any response after the step, s.
        next_s: f64,
        /// Last time of any response, s.
        last_s: f64,
    },
    /// Logarithm of the time since the step at `step_s`, until the drive changes again.
    SinceStep {
        /// Time of the step, s.
        step_s: f64,
        /// Time of the next change of the drive, s; infinite where there is none.
        until_s: f64,
    },
}

/// A figure of a response.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ResponseFigure {
    /// The figure.
    pub svg: String,
    /// Readings that it shows.
    pub drawn: usize,
}

/// Draws `curve` over the times of `view`; none where no reading lies in them. Where it is set `aside`, because no result
/// is made from it, dots are open and the fit is pale and dashed.
///
/// # Errors
/// The message of the drawing library.
pub fn response(
    curve: &RunCurve,
    view: TimeView,
    title: &str,
    aside: bool,
) -> Result<Option<ResponseFigure>, String> {
    check_lengths(curve)?;
    let shown = shown_indices(curve, view);
    let Some(x) = time_axis(curve, view, &shown) else {
        return Ok(None);
    };
    let residuals = curve.residual_sigma.len() == curve.time_s.len();
    let height = READINGS_HEIGHT + TIME_AXIS_HEIGHT + if residuals { RESIDUALS_HEIGHT } else { 0 };
    let mut drawn = 0;
    let svg = svg((WIDTH, height), title, "", |area| {
        let drawing = Drawing {
            curve,
            view,
            aside,
            shown: &shown,
            x: &x,
        };
        drawn = thin::dots(&drawing.points(&curve.measured)).len();
        if !residuals {
            return drawing.readings(area, true);
        }
        let (above, below) = area.split_vertically(READINGS_HEIGHT as i32 * TENTHS);
        drawing.readings(&above, false)?;
        drawing.residuals(&below)
    })?;
    Ok(Some(ResponseFigure { svg, drawn }))
}

/// What both panels of a figure share.
struct Drawing<'a> {
    curve: &'a RunCurve,
    view: TimeView,
    aside: bool,
    shown: &'a [usize],
    x: &'a Axis,
}

impl Drawing<'_> {
    fn readings(&self, area: &Area, x_labels: bool) -> Result<(), String> {
        let curve = self.curve;
        let fitted = |&index: &usize| curve.fitted.get(index).copied();
        let seen = self.shown.iter();
        let (low, high) = finite_range(
            seen.clone()
                .map(|&index| curve.measured[index])
                .chain(seen.filter_map(fitted)),
        );
        let margin = 0.05 * (high - low);
        let quantity = curve.quantity;
        let y = Axis::linear(low - margin, high + margin, quantity.label(), quantity.unit(), 4);
        let mut chart = panel(area, margins(x_labels), self.x, &y, x_labels)?;
        grouped(&mut chart, readings("Readings", false, self.aside), |chart| {
            self.dots(chart, &curve.measured, if self.aside { OPEN_RADIUS } else { 11 })
        })?;
        if curve.fitted.len() != curve.time_s.len() {
            return Ok(());
        }
        let points = thin::line(&self.points(&curve.fitted), pixels(&chart));
        grouped(&mut chart, readings("Fit", false, self.aside), |chart| {
            let line = LineSeries::new(points, Ink::Vermillion.color().stroke_width(16));
            chart
                .draw_series(line)
                .map(|_| ())
                .map_err(|error| error.to_string())
        })
    }

    fn residuals(&self, area: &Area) -> Result<(), String> {
        let residuals = &self.curve.residual_sigma;
        let (low, high) = finite_range(residuals.iter().copied());
        let reach = 1.05 * rounded_up(low.abs().max(high.abs()));
        let y = Axis::linear(-reach, reach, "Residual / σ", "", 5);
        let mut chart = panel(area, margins(true), self.x, &y, true)?;
        series(&mut chart, "", |chart| {
            let zero = [(self.x.low, 0.0), (self.x.high, 0.0)];
            chart
                .draw_series([PathElement::new(zero, Ink::Vermillion.color().stroke_width(10))])
                .map(|_| ())
                .map_err(|error| error.to_string())
        })?;
        grouped(&mut chart, readings("Residuals", true, self.aside), |chart| {
            self.dots(chart, residuals, if self.aside { OPEN_RADIUS } else { 12 })
        })
    }

    fn dots(&self, chart: &mut Chart, values: &[f64], radius: i32) -> Result<(), String> {
        let style = Ink::Muted.color().filled();
        let points = thin::dots(&self.points(values));
        chart
            .draw_series(points.into_iter().map(|point| Circle::new(point, radius, style)))
            .map(|_| ())
            .map_err(|error| error.to_string())
    }

    /// Positions of the readings shown, those that are no number left out.
    fn points(&self, values: &[f64]) -> Vec<(f64, f64)> {
        let points = self.shown.iter().map(|&index| (self.x_at(index), values[index]));
        points.filter(|(_, value)| value.is_finite()).collect()
    }

    fn x_at(&self, index: usize) -> f64 {
        let time_s = self.curve.time_s[index];
        match self.view {
            TimeView::Whole => time_s,
            TimeView::AboutStep { step_s, .. } | TimeView::SinceStep { step_s, .. } => {
                self.x.position(time_s - step_s)
            }
        }
    }
}

/// The next of few numbers, 3 at least: residuals of runs that stand beside each other have one axis.
fn rounded_up(sigmas: f64) -> f64 {
    if !sigmas.is_finite() || sigmas <= 3.0 {
        return 3.0;
    }
    let decade = 10f64.powf(sigmas.log10().floor());
    let steps = [1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];
    let step = steps.into_iter().find(|step| step * decade >= sigmas);
    step.unwrap_or(10.0) * decade
}

fn margins(x_labels: bool) -> Margins {
    Margins {
        left: 62,
        right: 16,
        top: 8,
        bottom: if x_labels { TIME_AXIS_HEIGHT } else { 6 },
    }
}

/// The source of the curves is outside this module: a series of another length must not end the program.
fn check_lengths(curve: &RunCurve) -> Result<(), String> {
    let n = curve.time_s.len();
    let fits = |series: &[f64]| series.is_empty() || series.len() == n;
    if curve.measured.len() == n && fits(&curve.fitted) && fits(&curve.residual_sigma) {
        Ok(())
    } else {
        Err(format!(
            "a curve of {n} times has {} measured, {} fitted and {} residual values",
            curve.measured.len(),
            curve.fitted.len(),
            curve.residual_sigma.len()
        ))
    }
}

/// Indices of the readings that a view shows.
fn shown_indices(curve: &RunCurve, view: TimeView) -> Vec<usize> {
    let all = 0..curve.time_s.len();
    match view {
        TimeView::Whole | TimeView::AboutStep { .. } => all.collect(),
        TimeView::SinceStep { step_s, until_s } => {
            let last_s = curve.time_s.last().copied().unwrap_or(step_s).min(until_s);
            let first_s = step_s + SHORTEST * (last_s - step_s);
            all.filter(|&index| {
                let time_s = curve.time_s[index];
                time_s > step_s && time_s >= first_s && time_s < until_s
            })
            .collect()
        }
    }
}

/// None where fewer than two readings are shown.
fn time_axis(curve: &RunCurve, view: TimeView, shown: &[usize]) -> Option<Axis> {
    let first_s = curve.time_s[*shown.first()?];
    let last_s = curve.time_s[*shown.last()?];
    if last_s <= first_s {
        return None;
    }
    Some(match view {
        TimeView::Whole => Axis::whole(first_s, last_s),
        TimeView::AboutStep {
            step_s,
            first_s,
            next_s,
            last_s,
        } => {
            let last_s = last_s - step_s;
            let unit_s = (next_s - step_s).max(SHORTEST * last_s);
            Axis::about_step((first_s - step_s).min(0.0), unit_s, last_s, &since(step_s))
        }
        TimeView::SinceStep { step_s, .. } => Axis::log(
            0.9 * (first_s - step_s),
            1.1 * (last_s - step_s),
            &since(step_s),
            "s",
        ),
    })
}

impl TimeView {
    /// The view about the one step at `step_s` of all these responses; none where no reading follows it.
    pub fn about_step(step_s: f64, curves: &[RunCurve]) -> Option<TimeView> {
        let times = || curves.iter().flat_map(|curve| curve.time_s.iter().copied());
        let (first_s, last_s) = finite_range(times());
        let (next_s, _) = finite_range(times().filter(|&time_s| time_s > step_s));
        next_s.is_finite().then_some(TimeView::AboutStep {
            step_s,
            first_s,
            next_s,
            last_s,
        })
    }
}

/// Title of an axis of times since a step.
fn since(step_s: f64) -> String {
    if step_s == 0.0 {
        "Time since the step".to_owned()
    } else {
        format!("Time since the step at {} s", significant(step_s, 4))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::svg::dot_markers;
    use ieap_domain::Quantity;

    fn curve(n: usize, fitted: bool) -> RunCurve {
        let time_s: Vec<f64> = (0..n).map(|k| 1e-2 * 1.026f64.powi(k as i32) - 0.02).collect();
        let measured: Vec<f64> = time_s
            .iter()
            .map(|t| 2e-3 * (-t.max(0.0) / 30.0).exp() + 1e-5)
            .collect();
        RunCurve {
            quantity: Quantity::Current,
            fitted: if fitted { measured.clone() } else { vec![] },
            residual_sigma: if fitted {
                time_s.iter().map(|t| (17.0 * t).sin()).collect()
            } else {
                vec![]
            },
            measured,
            time_s,
            readings: 10 * n,
        }
    }

    #[test]
    fn a_figure_of_450_readings_stays_small() {
        for view in [
            TimeView::Whole,
            TimeView::about_step(0.0, &[curve(450, true)]).unwrap(),
            TimeView::SinceStep {
                step_s: 0.0,
                until_s: f64::INFINITY,
            },
        ] {
            let figure = response(&curve(450, true), view, "t", false).unwrap().unwrap();
            let bytes = figure.svg.len();
            assert!(bytes < 6_500, "{bytes} bytes");
            assert!(figure.drawn > 400, "{}", figure.drawn);
        }
    }

    #[test]
    fn what_no_result_is_made_from_has_open_dots_and_a_marked_line() {
        let drawn = |aside| {
            response(&curve(50, true), TimeView::Whole, "t", aside)
                .unwrap()
                .unwrap()
                .svg
        };
        let aside = drawn(true);
        assert_eq!(aside.matches("data-aside=\"1\"").count(), 3, "{aside}");
        assert!(
            aside.contains("dots dot-k-muted-o") && !aside.contains("dot-k-muted-0"),
            "{aside}"
        );
        assert_eq!(dot_markers([aside].iter())[0].id, "dot-k-muted-o");
        assert!(!drawn(false).contains("data-aside") && !drawn(false).contains("muted-o"));
    }

    #[test]
    fn residuals_have_one_of_few_ranges() {
        let rounded = [0.4, 3.1, 4.0, 6.2, 9.0, 11.0, 99.0, f64::NEG_INFINITY].map(rounded_up);
        assert_eq!(rounded, [3.0, 4.0, 4.0, 8.0, 10.0, 12.0, 100.0, 3.0]);
    }

    #[test]
    fn a_curve_of_uneven_lengths_is_an_error() {
        let mut uneven = curve(50, true);
        uneven.fitted.pop();
        let refused = response(&uneven, TimeView::Whole, "t", false);
        assert!(refused.is_err_and(|reason| reason.contains("49 fitted")));
    }

    #[test]
    fn an_unfitted_run_has_readings_only() {
        let drawn = response(&curve(50, false), TimeView::Whole, "t", false)
            .unwrap()
            .unwrap()
            .svg;
        assert!(!drawn.contains("Residual"));
        assert!(drawn.contains("Current (mA)"));
    }

    #[test]
    fn the_view_since_the_step_leaves_out_what_precedes_it_and_what_follows_the_next() {
        let curve = curve(300, false);
        let view = TimeView::SinceStep {
            step_s: 0.0,
            until_s: 5.0,
        };
        let shown = shown_indices(&curve, view);
        assert!(
            shown
                .iter()
                .all(|&index| curve.time_s[index] > 0.0 && curve.time_s[index] < 5.0)
        );
        let empty = TimeView::SinceStep {
            step_s: 1e9,
            until_s: f64::INFINITY,
        };
        assert_eq!(response(&curve, empty, "t", false).unwrap(), None);
    }
}
