//! An impedance spectrum: Nyquist plot, Bode plot and residuals, with the fitted circuits.

use plotters::element::{Circle, PathElement};
use plotters::style::Color;

use super::axis::{Axis, finite_range};
use super::canvas::{Area, Ink, TENTHS, svg};
use super::group::series;
use super::panel::{Chart, Margins, panel};
use ieap_domain::{CircuitFit, KramersKronig, Spectrum};

/// Size of the Nyquist plot, px.
const NYQUIST: (u32, u32) = (380, 330);
/// Width of the Bode plot and of the residuals, and the heights of a panel, px.
const WIDTH: u32 = super::shape::PAGE_WIDTH;
const PANEL_HEIGHT: u32 = 150;
const RESIDUAL_HEIGHT: u32 = 110;
/// Room under the lowest panel for its axis, px.
const AXIS_HEIGHT: u32 = 42;
/// Width of fitted lines, tenths of a px; dashes of the second line, so that lines are told apart without colour.
const LINE: u32 = 14;
/// Radius of a reading, tenths of a px.
const DOT: i32 = 22;

/// A fitted circuit as it is drawn.
pub struct DrawnFit<'a> {
    /// Its name for readouts.
    pub name: String,
    /// The fit.
    pub fit: &'a CircuitFit,
    /// Its colour.
    pub ink: Ink,
}

/// Draws -Z'' against Z', both to one scale.
///
/// # Errors
/// The message of the drawing library.
pub fn nyquist(spectrum: &Spectrum, fits: &[DrawnFit], title: &str, desc: &str) -> Result<String, String> {
    let points = |real: &[f64], imaginary: &[f64]| -> Vec<(f64, f64)> {
        real.iter().zip(imaginary).map(|(re, im)| (*re, -im)).collect()
    };
    let measured = points(&spectrum.real_ohm, &spectrum.imaginary_ohm);
    let (low_x, high_x) = finite_range(measured.iter().map(|point| point.0));
    let (low_y, high_y) = finite_range(measured.iter().map(|point| point.1));
    // One scale: the longer axis rules, and zero is shown.
    let span = 1.08 * (high_x - low_x.min(0.0)).max(high_y - low_y.min(0.0));
    let x = Axis::linear(low_x.min(0.0), low_x.min(0.0) + span, "Z′", "Ω", 5);
    let y = Axis::linear(low_y.min(0.0), low_y.min(0.0) + span, "−Z″", "Ω", 5);
    svg(NYQUIST, title, desc, |area| {
        let mut chart = panel(area, margins(true), &x, &y, true)?;
        for fit in fits {
            let line: Vec<(f64, f64)> = points(&fit.fit.real_ohm, &fit.fit.imaginary_ohm);
            let shown = line.into_iter().filter(|at| x.shows(at.0) && y.shows(at.1));
            draw_line(&mut chart, &fit.name, shown.collect(), fit.ink)?;
        }
        draw_dots(&mut chart, "Readings", measured, Ink::Text)
    })
}

/// Draws |Z| and the phase over frequency.
///
/// # Errors
/// The message of the drawing library.
pub fn bode(spectrum: &Spectrum, fits: &[DrawnFit], title: &str, desc: &str) -> Result<String, String> {
    let size = |real: &[f64], imaginary: &[f64]| -> Vec<f64> {
        real.iter().zip(imaginary).map(|(re, im)| re.hypot(*im)).collect()
    };
    let phase = |real: &[f64], imaginary: &[f64]| -> Vec<f64> {
        let angle = |(re, im): (&f64, &f64)| im.atan2(*re).to_degrees();
        real.iter().zip(imaginary).map(angle).collect()
    };
    let x = frequency_axis(spectrum);
    let sizes = size(&spectrum.real_ohm, &spectrum.imaginary_ohm);
    let (low, high) = finite_range(sizes.iter().copied());
    let upper = Axis::log(0.8 * low, 1.25 * high, "|Z|", "Ω");
    let phases = phase(&spectrum.real_ohm, &spectrum.imaginary_ohm);
    let (low, high) = finite_range(phases.iter().copied());
    let lower = Axis::linear(low.min(-90.0) - 3.0, high.max(0.0) + 3.0, "Phase (°)", "", 4);
    let height = 2 * PANEL_HEIGHT + AXIS_HEIGHT;
    svg((WIDTH, height), title, desc, |area| {
        let (above, below) = area.split_vertically(PANEL_HEIGHT as i32 * TENTHS);
        let draw = |area: &Area, y: &Axis, values: &[f64], fitted: &dyn Fn(&CircuitFit) -> Vec<f64>, last| {
            let mut chart = panel(area, margins(last), &x, y, last)?;
            for fit in fits {
                draw_line(
                    &mut chart,
                    &fit.name,
                    over(spectrum, &fitted(fit.fit), &x, y),
                    fit.ink,
                )?;
            }
            draw_dots(&mut chart, "Readings", over(spectrum, values, &x, y), Ink::Text)
        };
        draw(
            &above,
            &upper,
            &sizes,
            &|fit| size(&fit.real_ohm, &fit.imaginary_ohm),
            false,
        )?;
        draw(
            &below,
            &lower,
            &phases,
            &|fit| phase(&fit.real_ohm, &fit.imaginary_ohm),
            true,
        )
    })
}

/// Draws what the Kramers-Kronig test leaves of both parts, percent of |Z|.
///
/// # Errors
/// The message of the drawing library.
pub fn residuals(
    spectrum: &Spectrum,
    test: &KramersKronig,
    title: &str,
    desc: &str,
) -> Result<String, String> {
    let percent = |part: &[f64]| -> Vec<f64> { part.iter().map(|r| 100.0 * r).collect() };
    let (real, imaginary) = (percent(&test.residual_real), percent(&test.residual_imaginary));
    let largest = real
        .iter()
        .chain(&imaginary)
        .fold(1.0_f64, |most, r| most.max(r.abs()));
    let x = frequency_axis(spectrum);
    let y = Axis::linear(-1.1 * largest, 1.1 * largest, "Residual (%)", "", 4);
    svg((WIDTH, RESIDUAL_HEIGHT + AXIS_HEIGHT), title, desc, |area| {
        let mut chart = panel(area, margins(true), &x, &y, true)?;
        series(&mut chart, "", |chart| {
            let zero = PathElement::new(
                vec![(x.low, 0.0), (x.high, 0.0)],
                Ink::Muted.color().stroke_width(8),
            );
            chart
                .draw_series([zero])
                .map(|_| ())
                .map_err(|error| error.to_string())
        })?;
        for (name, values, ink) in [("Z′", &real, Ink::Blue), ("Z″", &imaginary, Ink::Vermillion)] {
            draw_line(&mut chart, "", over(spectrum, values, &x, &y), ink)?;
            draw_dots(&mut chart, name, over(spectrum, values, &x, &y), ink)?;
        }
        Ok(())
    })
}

fn frequency_axis(spectrum: &Spectrum) -> Axis {
    let (low, high) = spectrum.range_hz().unwrap_or((0.1, 10.0));
    Axis::log(low / 1.2, high * 1.2, "Frequency", "Hz")
}

/// Values over frequency as positions, in order of frequency; what an axis cannot show is left out.
fn over(spectrum: &Spectrum, values: &[f64], x: &Axis, y: &Axis) -> Vec<(f64, f64)> {
    let all = spectrum.frequency_hz.iter().zip(values);
    let shown = all.filter(|(hz, value)| x.shows(**hz) && y.shows(**value));
    let mut points: Vec<(f64, f64)> = shown
        .map(|(hz, value)| (x.position(*hz), y.position(*value)))
        .collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points
}

fn draw_line(chart: &mut Chart, name: &str, line: Vec<(f64, f64)>, ink: Ink) -> Result<(), String> {
    series(chart, name, |chart| {
        let path = PathElement::new(line, ink.color().stroke_width(LINE));
        chart
            .draw_series([path])
            .map(|_| ())
            .map_err(|error| error.to_string())
    })
}

fn draw_dots(chart: &mut Chart, name: &str, dots: Vec<(f64, f64)>, ink: Ink) -> Result<(), String> {
    series(chart, name, |chart| {
        let style = ink.color().stroke_width(9);
        let circles = dots.into_iter().map(|at| Circle::new(at, DOT, style));
        chart
            .draw_series(circles)
            .map(|_| ())
            .map_err(|error| error.to_string())
    })
}

fn margins(labels: bool) -> Margins {
    Margins {
        left: 62,
        right: 16,
        top: 8,
        bottom: if labels { AXIS_HEIGHT } else { 6 },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::Consistency;

    #[test]
    fn plots_have_axes_with_units_and_no_holes() {
        let frequency_hz: Vec<f64> = (0..30).map(|k| 10.0_f64.powf(4.0 - 0.2 * f64::from(k))).collect();
        let spectrum = Spectrum {
            real_ohm: frequency_hz.iter().map(|hz| 100.0 + 10.0 / hz).collect(),
            imaginary_ohm: frequency_hz.iter().map(|hz| -30.0 / hz).collect(),
            frequency_hz,
        };
        let fit = CircuitFit {
            circuit: "lumped-2".to_owned(),
            parameters: vec![],
            residual_rms_percent: 0.5,
            bic_above_best: 0.0,
            describes: true,
            real_ohm: spectrum.real_ohm.clone(),
            imaginary_ohm: spectrum.imaginary_ohm.clone(),
        };
        let fits = [DrawnFit {
            name: "lumped-2".to_owned(),
            fit: &fit,
            ink: Ink::Vermillion,
        }];
        let test = KramersKronig {
            verdict: Consistency::Consistent,
            elements: 7,
            mu: 0.8,
            scatter_percent: 0.1,
            residual_rms_percent: 0.1,
            off_hz: None,
            largest_mean_percent: 0.1,
            residual_real: vec![0.001; 30],
            residual_imaginary: vec![-0.002; 30],
        };
        let drawn = [
            nyquist(&spectrum, &fits, "t", "d").unwrap(),
            bode(&spectrum, &fits, "t", "d").unwrap(),
            residuals(&spectrum, &test, "t", "d").unwrap(),
        ];
        for (drawn, texts) in drawn.iter().zip([
            &["Z′", "−Z″"][..],
            &["Frequency (Hz)", "|Z| (Ω)", "Phase (°)"],
            &["Frequency (Hz)", "Residual (%)"],
        ]) {
            assert!(!drawn.contains("NaN"));
            texts
                .iter()
                .for_each(|text| assert!(drawn.contains(text), "{text}"));
        }
    }
}
