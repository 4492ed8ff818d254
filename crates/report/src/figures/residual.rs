//! One channel of one run of a diagnosis: what the base model leaves and what the extended one leaves, in units of the
//! noise, with the band that noise alone fills; and, above it, the readings with what both models say.

use ieap_domain::{Quantity, ResidualCurve};
use ieap_show::{Chart, Ink, Layer, Mark, Panel, Range};

use crate::blocks::chart::inline;
use crate::site::Clock;
use crate::sparkline::BAND_SIGMA;

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
    let Some(x) = time(curve, clock)? else {
        return Ok(None);
    };
    let chart = Chart::new(title, vec![residuals(curve, called, x)]);
    inline(&chart, title, desc).map(Some)
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
    let x = match time(curve, clock)? {
        Some(x) if !curve.measured.is_empty() => x,
        _ => return Ok(None),
    };
    let panels = vec![readings(curve, called, x.clone()), residuals(curve, called, x)];
    inline(&Chart::new(title, panels), title, desc).map(Some)
}

/// The axis of times; none where there is too little to draw.
fn time(curve: &ResidualCurve, clock: Clock) -> Result<Option<Range>, String> {
    check_lengths(curve)?;
    let last_s = curve.time_s.last().copied().unwrap_or(0.0);
    let after = curve.time_s.iter().filter(|t| **t > SHORTEST * last_s);
    if after.count() < 2 {
        return Ok(None);
    }
    Ok(Some(match clock {
        Clock::SinceStep => Range::since_step(curve.time_s.iter().copied(), SHORTEST),
        Clock::Even => Range::linear("Time", "s"),
    }))
}

/// The readings as dots, the models as lines.
fn readings(curve: &ResidualCurve, called: Called, x: Range) -> Panel {
    let (label, unit) = match curve.channel.as_str() {
        "current" => (Quantity::Current.label().to_owned(), Quantity::Current.unit()),
        "curvature" => (Quantity::Curvature.label().to_owned(), Quantity::Curvature.unit()),
        other => (other.to_owned(), ""),
    };
    let of = |name: &str, mark, ink, values: &[f64]| Layer::over(name, mark, ink, &curve.time_s, values);
    let mut layers = vec![
        of("Measured", Mark::Readings, Ink::Guide, &curve.measured),
        of(called.base, Mark::Line, Ink::SECOND, &curve.base),
    ];
    // Nothing of an extension whose residuals are withheld, because the finding is not about it.
    if !curve.after_sigma.is_empty() {
        layers.push(of(called.extension, Mark::Line, Ink::FIRST, &curve.extended));
    }
    let lines = layers.iter().flat_map(|own| &own.points).map(|at| at.1);
    let always = lines.filter(|value| value.is_finite()).collect();
    let y = Range {
        always,
        ..Range::linear(label, unit)
    };
    Panel { x, y, layers }
}

/// What both models leave over the noise, on the band that noise fills; the axis is symmetric and wide enough for it.
fn residuals(curve: &ResidualCurve, called: Called, x: Range) -> Panel {
    let all = curve.before_sigma.iter().chain(&curve.after_sigma);
    let most = all
        .filter(|sigma| sigma.is_finite())
        .fold(1.5 * BAND_SIGMA, |most: f64, sigma| most.max(sigma.abs()));
    let ends = [curve.time_s.first(), curve.time_s.last()].into_iter().flatten();
    let band = Layer::new("", Mark::Line, Ink::Guide, ends.map(|&t| (t, 0.0)));
    let of = |name: &str, mark, ink, values: &[f64]| Layer::over(name, mark, ink, &curve.time_s, values);
    let mut layers = vec![
        band.with_bars(vec![(-BAND_SIGMA, BAND_SIGMA); 2]),
        of(called.base, Mark::Readings, Ink::SECOND, &curve.before_sigma),
    ];
    if !curve.after_sigma.is_empty() {
        layers.push(of(called.extension, Mark::Line, Ink::FIRST, &curve.after_sigma));
    }
    Panel {
        x,
        y: Range::linear("Residual / σ", "").with(-most).with(most),
        layers,
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
