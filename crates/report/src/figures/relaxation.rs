//! The distribution of relaxation times of a spectrum.

use plotters::element::{Circle, PathElement};
use plotters::style::Color;

use super::axis::Axis;
use super::canvas::{Ink, svg};
use super::group::series;
use super::panel::{Margins, panel};
use ieap_domain::RelaxationTimes;

/// Size, px.
const SIZE: (u32, u32) = (super::shape::PAGE_WIDTH, 192);
/// Widths of lines, tenths of a px.
const LINE: u32 = 14;
const LIMIT: u32 = 8;
/// Radius of a peak's dot, tenths of a px.
const DOT: i32 = 30;
/// Room above the largest value, so that dots are not cut.
const ABOVE: f64 = 1.12;

/// Draws gamma over the time constants, with its peaks and the limits of what the frequencies tell of.
///
/// # Errors
/// The message of the drawing library.
pub fn relaxation(found: &RelaxationTimes, title: &str, desc: &str) -> Result<String, String> {
    let (first, last) = ieap_domain::range_of(found.tau_s.iter().copied());
    let largest = found.gamma_ohm.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let x = Axis::log(first, last, "Time constant", "s");
    let y = Axis::linear(0.0, ABOVE * largest, "γ", "Ω", 4);
    svg(SIZE, title, desc, |area| {
        let margins = Margins {
            left: 62,
            right: 16,
            top: 8,
            bottom: 42,
        };
        let mut chart = panel(area, margins, &x, &y, true)?;
        let draw = |error: &dyn std::fmt::Display| error.to_string();
        series(&mut chart, "", |chart| {
            let limits = [found.told_s.0, found.told_s.1]
                .into_iter()
                .flat_map(|tau_s| dashes(x.position(tau_s), y.high));
            let lines = limits.map(|line| PathElement::new(line, Ink::Muted.color().stroke_width(LIMIT)));
            chart.draw_series(lines).map(|_| ()).map_err(|error| draw(&error))
        })?;
        series(&mut chart, "γ(ln τ)", |chart| {
            let all = found.tau_s.iter().zip(&found.gamma_ohm);
            let line: Vec<(f64, f64)> = all.map(|(tau, gamma)| (x.position(*tau), *gamma)).collect();
            let path = PathElement::new(line, Ink::Blue.color().stroke_width(LINE));
            chart
                .draw_series([path])
                .map(|_| ())
                .map_err(|error| draw(&error))
        })?;
        series(&mut chart, "Peaks", |chart| {
            let at = |tau_s: f64| (x.position(tau_s), nearest(found, tau_s));
            let dots = found
                .peaks
                .iter()
                .map(|peak| Circle::new(at(peak.tau_s), DOT, Ink::Vermillion.color().filled()));
            chart.draw_series(dots).map(|_| ()).map_err(|error| draw(&error))
        })
    })
}

/// The value at the time that is nearest to a peak's.
fn nearest(found: &RelaxationTimes, tau_s: f64) -> f64 {
    let away = |k: &usize| (found.tau_s[*k] / tau_s).ln().abs();
    let at = (0..found.tau_s.len()).min_by(|a, b| away(a).total_cmp(&away(b)));
    at.map_or(0.0, |k| found.gamma_ohm[k])
}

/// An upright line in dashes.
fn dashes(at: f64, high: f64) -> Vec<Vec<(f64, f64)>> {
    const DASHES: u32 = 12;
    let place = |part: f64| (at, high * part / f64::from(DASHES));
    (0..DASHES)
        .map(|k| vec![place(f64::from(k)), place(f64::from(k) + 0.6)])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::RelaxationPeak;

    #[test]
    fn the_distribution_has_its_axes_and_a_dot_for_each_peak() {
        let tau_s: Vec<f64> = (0..40).map(|k| 10f64.powf(f64::from(k) / 8.0 - 3.0)).collect();
        let gamma_ohm = tau_s
            .iter()
            .map(|tau: &f64| 80.0 * (-(tau / 0.5).ln().powi(2)).exp())
            .collect();
        let peak = RelaxationPeak {
            tau_s: 0.5,
            resistance_ohm: 140.0,
            from_s: 1e-3,
            to_s: 50.0,
        };
        let found = RelaxationTimes {
            regularisation: 0.01,
            scatter_percent: 0.5,
            residual_rms_percent: 0.5,
            describes: true,
            told_s: (1e-2, 20.0),
            series_ohm: 50.0,
            series_h: 0.0,
            series_f: None,
            faster_ohm: 0.0,
            slower_ohm: 0.0,
            peaks: vec![peak],
            tau_s,
            gamma_ohm,
        };
        let drawn = relaxation(&found, "t", "d").unwrap();
        assert!(!drawn.contains("NaN"));
        for text in ["Time constant (s)", "γ (Ω)"] {
            assert!(drawn.contains(text), "{text}: {drawn}");
        }
        let without = RelaxationTimes {
            peaks: vec![],
            ..found
        };
        let bare = relaxation(&without, "t", "d").unwrap();
        assert!(drawn.len() > bare.len(), "a peak has a dot");
    }
}
