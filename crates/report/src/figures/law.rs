//! A parameter against a covariate: points with error bars on both axes, samples told apart, and a law with its band.

use plotters::element::{Circle, PathElement, Polygon};
use plotters::style::Color;

use super::aside::{AsideMark, draw_aside};
use super::axis::Axis;
use super::canvas::{Area, Ink, svg};
use super::comparison::{ink, marker};
use super::group::{Group, grouped, series};
use super::panel::{Chart, Margins, panel, pixels};
use super::thin;

/// Size of one panel, px.
const SIZE: (u32, u32) = (400, 270);
const MARGINS: Margins = Margins {
    left: 66,
    right: 14,
    top: 10,
    bottom: 46,
};

/// Size of one panel of small multiples, px.
pub const SMALL: (u32, u32) = (400, 230);

/// A point with its 95 % interval and the standard error of where it stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mark {
    /// Covariate.
    pub x: f64,
    /// Half-length of the horizontal bar; 0 for none.
    pub x_error: f64,
    /// Parameter in its shown unit.
    pub y: f64,
    /// Ends of the vertical bar.
    pub bar: (f64, f64),
    /// Number of the sample: marker and colour.
    pub style: usize,
    /// Index of the run that it stands for.
    pub run: Option<usize>,
}

/// A law as it is drawn: at each place the value and the ends of the band.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Curve {
    /// Covariate, rising.
    pub x: Vec<f64>,
    /// Value.
    pub y: Vec<f64>,
    /// Band.
    pub band: Vec<(f64, f64)>,
}

/// What stands in a panel beside the points.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Beside {
    /// The law.
    pub law: Curve,
    /// What the model has without it, at the same places; empty for none.
    pub without: Vec<f64>,
    /// What readouts call the marks of each style.
    pub names: Vec<String>,
    /// Runs that no result is made from.
    pub aside: Vec<AsideMark>,
}

/// Draws one panel.
///
/// # Errors
/// The message of the drawing library.
pub fn law_panel(
    axes: (&Axis, &Axis),
    marks: &[Mark],
    beside: &Beside,
    title: &str,
    desc: &str,
) -> Result<String, String> {
    sized_panel(SIZE, axes, (marks, beside), (title, desc))
}

/// Draws one panel of `size` px.
///
/// # Errors
/// The message of the drawing library.
pub fn sized_panel(
    size: (u32, u32),
    (x, y): (&Axis, &Axis),
    (marks, beside): (&[Mark], &Beside),
    (title, desc): (&str, &str),
) -> Result<String, String> {
    svg(size, title, desc, |area| draw_on(area, (x, y), (marks, beside)))
}

fn draw_on(area: &Area, (x, y): (&Axis, &Axis), (marks, beside): (&[Mark], &Beside)) -> Result<(), String> {
    let mut chart = panel(area, MARGINS, x, y, true)?;
    series(&mut chart, "", |chart| draw_beside(chart, x, y, beside))?;
    let styles = marks.iter().map(|mark| mark.style + 1).max().unwrap_or(0);
    for style in 0..styles {
        let own: Vec<&Mark> = marks.iter().filter(|mark| mark.style == style).collect();
        let name = beside.names.get(style).map_or("Value", String::as_str);
        draw_marks(&mut chart, (x, y), &own, (style, name))?;
    }
    draw_aside(&mut chart, (x, y), &beside.aside)
}

/// The law with its band.
fn draw_beside(chart: &mut Chart, x: &Axis, y: &Axis, beside: &Beside) -> Result<(), String> {
    if beside.law.x.len() > 1 {
        let seen = pixels(chart);
        let curve = |value: &dyn Fn(usize) -> f64| {
            let points = (0..beside.law.x.len()).map(|k| (x.position(beside.law.x[k]), y.inside(value(k))));
            thin::line(&points.collect::<Vec<_>>(), seen)
        };
        let low = curve(&|k| beside.law.band[k].0);
        let high = curve(&|k| beside.law.band[k].1);
        let band = Polygon::new(
            low.into_iter().chain(high.into_iter().rev()).collect::<Vec<_>>(),
            Ink::Muted.color().mix(0.18).filled(),
        );
        chart.draw_series([band]).map_err(|error| error.to_string())?;
        if !beside.without.is_empty() {
            line(chart, curve(&|k| beside.without[k]), Ink::Muted, 10)?;
        }
        line(chart, curve(&|k| beside.law.y[k]), Ink::Text, 14)?;
    }
    Ok(())
}

/// The marks of one sample over their bars.
fn draw_marks(
    chart: &mut Chart,
    (x, y): (&Axis, &Axis),
    marks: &[&Mark],
    (style, name): (usize, &str),
) -> Result<(), String> {
    let (within, beyond): (Vec<&Mark>, Vec<&Mark>) = marks.iter().partition(|mark| y.shows(mark.y));
    if marks.is_empty() {
        return Ok(());
    }
    let group = Group::Series {
        name: name.to_owned(),
        runs: within.iter().chain(&beyond).filter_map(|mark| mark.run).collect(),
        form: style,
        to_the_pixel: false,
        aside: false,
    };
    let color = ink(style);
    let seen = pixels(chart);
    grouped(chart, group, |chart| {
        for mark in marks {
            let (across, up) = (x.position(mark.x), y.inside(mark.y));
            let ends = [y.inside(mark.bar.0), y.inside(mark.bar.1)];
            // What is shorter than a pixel lies within the mark.
            if (ends[1] - ends[0]).abs() * seen.up >= 1.0 {
                line(chart, ends.map(|end| (across, end)).to_vec(), color, 10)?;
            }
            let ends = [mark.x - mark.x_error, mark.x + mark.x_error]
                .map(|end| x.position(end).clamp(x.low, x.high));
            if mark.x_error > 0.0 && (ends[1] - ends[0]) * seen.across >= 1.0 {
                line(chart, ends.map(|end| (end, up)).to_vec(), color, 10)?;
            }
        }
        let dots = within.iter().map(|mark| {
            let at = (x.position(mark.x), y.position(mark.y));
            Circle::new(at, 36, color.color().filled())
        });
        chart.draw_series(dots).map_err(|error| error.to_string())?;
        let mut beyond = beyond.into_iter();
        beyond.try_for_each(|mark| marker(chart, (x.position(mark.x), y.inside(mark.y)), style, false))
    })
}

/// A line through `points`.
///
/// # Errors
/// The message of the drawing library.
pub fn line(chart: &mut Chart, points: Vec<(f64, f64)>, ink: Ink, width: u32) -> Result<(), String> {
    let path = PathElement::new(points, ink.color().stroke_width(width));
    chart
        .draw_series([path])
        .map(|_| ())
        .map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_stand_on_both_axes_and_the_band_behind() {
        let x = Axis::linear(20.0, 80.0, "Relative humidity", "%", 5);
        let y = Axis::log(1e-4, 1e-2, "λ", "s⁻¹");
        let mark = Mark {
            x: 40.0,
            x_error: 2.0,
            y: 1e-3,
            bar: (8e-4, 1.2e-3),
            style: 1,
            run: None,
        };
        let law = Curve {
            x: vec![20.0, 50.0, 80.0],
            y: vec![5e-4, 1e-3, 2e-3],
            band: vec![(4e-4, 6e-4), (9e-4, 1.1e-3), (1e-3, 5e-1)],
        };
        let beside = Beside {
            law,
            names: vec!["CNaf-1".into(), "CNaf-2".into()],
            ..Beside::default()
        };
        let drawn = law_panel((&x, &y), &[mark], &beside, "t", "d").unwrap();
        assert!(drawn.contains("class=\"f k-muted\" opacity=\"0.18\""), "{drawn}");
        // Both bars in one path; the mark with the form of its sample.
        assert_eq!(drawn.matches("s k-2").count(), 1, "{drawn}");
        assert_eq!(drawn.matches("dots dot-k-2-1").count(), 1, "{drawn}");
        assert!(!drawn.contains("NaN") && !drawn.contains("inf"));
    }
}
