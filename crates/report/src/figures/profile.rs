//! How the sum of squares rises as the strength of an effect leaves its best value, with the level that bounds a 95 %
//! interval.

use ieap_domain::quantiles::CHI_SQUARE_95_OF_ONE;
use ieap_domain::range_of;
use plotters::element::{Circle, PathElement};
use plotters::series::LineSeries;
use plotters::style::Color;

use super::axis::Axis;
use super::canvas::{Ink, svg};
use super::group::series;
use super::panel::{Margins, panel};
use ieap_domain::number::{decimal_exponent, superscript};

const WIDTH: u32 = super::shape::PAGE_WIDTH;
const HEIGHT: u32 = 210;
/// Rise that bounds a 95 % interval.
const BOUND: f64 = CHI_SQUARE_95_OF_ONE;
/// Rises beyond this many times the bound are not drawn: one far point would press the others flat.
const HIGHEST: f64 = 4.0;
/// Ends this far apart are drawn over the logarithm.
const DECADES: f64 = 30.0;

/// Draws `rises` over `values`, whose axis is called `quantity` in `unit`. None where there is too little to draw.
///
/// # Errors
/// The message of the drawing library, or of series of uneven lengths.
pub fn profile(
    (values, rises): (&[f64], &[f64]),
    (quantity, unit): (&str, &str),
    title: &str,
    desc: &str,
) -> Result<Option<String>, String> {
    if values.len() != rises.len() {
        return Err(format!(
            "a profile of {} strengths has {} rises",
            values.len(),
            rises.len()
        ));
    }
    let pairs = values.iter().copied().zip(rises.iter().copied());
    let points: Vec<(f64, f64)> = pairs.filter(|(x, y)| x.is_finite() && y.is_finite()).collect();
    let ends = range_of(points.iter().map(|(x, _)| *x));
    if points.len() < 3 || ends.0 >= ends.1 {
        return Ok(None);
    }
    let over_decades = ends.0 > 0.0 && ends.1 > DECADES * ends.0;
    // Decades are short by themselves.
    let exponent = if over_decades {
        0
    } else {
        decimal_exponent(ends.0.abs().max(ends.1.abs()))
    };
    let (points, ends, quantity) = in_short_numbers(points, ends, quantity, unit, exponent);
    let most = points.iter().fold(2.0 * BOUND, |most, (_, y)| most.max(*y));
    let most = most.min(HIGHEST * BOUND);
    let x = if over_decades {
        Axis::log(ends.0, ends.1, &quantity, "")
    } else {
        let margin = 0.04 * (ends.1 - ends.0);
        Axis::linear(ends.0 - margin, ends.1 + margin, &quantity, "", 4)
    };
    let y = Axis::linear(-0.03 * most, 1.05 * most, "Rise of the sum of squares", "", 5);
    let points: Vec<(f64, f64)> = points
        .into_iter()
        .map(|(v, rise)| (x.position(v), rise))
        .collect();
    let points = below(HIGHEST * BOUND, &points);
    let drawn = svg((WIDTH, HEIGHT), title, desc, |area| {
        let margins = Margins {
            left: 58,
            right: 16,
            top: 8,
            bottom: 42,
        };
        let mut chart = panel(area, margins, &x, &y, true)?;
        series(&mut chart, "", |chart| {
            let level = [(x.low, BOUND), (x.high, BOUND)];
            chart
                .draw_series([PathElement::new(level, Ink::Vermillion.color().stroke_width(10))])
                .map(|_| ())
                .map_err(|error| error.to_string())?;
            let line = LineSeries::new(points.clone(), Ink::Blue.color().stroke_width(16));
            chart
                .draw_series(line)
                .map(|_| ())
                .map_err(|error| error.to_string())
        })?;
        series(&mut chart, "Rise", |chart| {
            let style = Ink::Blue.color().filled();
            chart
                .draw_series(points.iter().map(|point| Circle::new(*point, 22, style)))
                .map(|_| ())
                .map_err(|error| error.to_string())
        })
    })?;
    Ok(Some(drawn))
}

/// Points and ends over a power of ten, where numbers of that exponent would have many digits, and the title that says so.
fn in_short_numbers(
    points: Vec<(f64, f64)>,
    ends: (f64, f64),
    quantity: &str,
    unit: &str,
    exponent: i32,
) -> (Vec<(f64, f64)>, (f64, f64), String) {
    let (factor, power) = match exponent {
        -2..=3 => (1.0, String::new()),
        far => (10f64.powi(-far), format!("10{}", superscript(far))),
    };
    let unit = match (power.is_empty(), unit.is_empty()) {
        (true, _) => unit.to_owned(),
        (false, true) => power,
        (false, false) => format!("{power} {unit}"),
    };
    let title = if unit.is_empty() {
        quantity.to_owned()
    } else {
        format!("{quantity} ({unit})")
    };
    let points = points.into_iter().map(|(x, y)| (factor * x, y)).collect();
    (points, (factor * ends.0, factor * ends.1), title)
}

/// The points up to `most`, with those where the line between neighbours passes it.
fn below(most: f64, points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let passes = |a: (f64, f64), b: (f64, f64)| (a.0 + (most - a.1) / (b.1 - a.1) * (b.0 - a.0), most);
    let mut kept: Vec<(f64, f64)> = Vec::new();
    for (k, &point) in points.iter().enumerate() {
        if k > 0 && (points[k - 1].1 > most) != (point.1 > most) {
            kept.push(passes(points[k - 1], point));
        }
        kept.extend((point.1 <= most).then_some(point));
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_far_point_is_cut_where_the_line_leaves_the_figure() {
        let cut = below(4.0, &[(0.0, 1004.0), (1.0, 3.0), (2.0, 0.0), (3.0, 8.0)]);
        assert_eq!(cut.len(), 4);
        assert!((cut[0].0 - 0.999).abs() < 1e-3 && cut[0].1 == 4.0 && cut[3] == (2.5, 4.0));
        assert_eq!(below(4.0, &[(0.0, 1.0), (1.0, 0.0)]), [(0.0, 1.0), (1.0, 0.0)]);
    }

    #[test]
    fn decades_are_drawn_over_the_logarithm() {
        let values: Vec<f64> = (-4..=4).map(|k| 10f64.powi(k)).collect();
        let rises: Vec<f64> = (-4..=4).map(|k| f64::from(k * k)).collect();
        let drawn = profile((&values, &rises), ("i0", "A/cm2"), "t", "d")
            .unwrap()
            .unwrap();
        let ticks = ["10⁻⁴<", "10⁻²<", ">1<", "10²<", "10⁴<"];
        assert!(ticks.iter().all(|tick| drawn.contains(tick)), "{drawn}");
    }

    #[test]
    fn a_parabola_is_drawn_and_too_little_is_not() {
        let values: Vec<f64> = (-4..=4).map(|k| 1.0 + 0.1 * f64::from(k)).collect();
        let rises: Vec<f64> = (-4..=4).map(|k| f64::from(k * k)).collect();
        let drawn = profile((&values, &rises), ("i0", "A/cm2"), "t", "d")
            .unwrap()
            .unwrap();
        assert!(drawn.contains("A/cm2") && drawn.len() < 12_000);
        assert_eq!(
            profile((&values[..2], &rises[..2]), ("i0", ""), "t", "d").unwrap(),
            None
        );
        assert!(profile((&values, &rises[1..]), ("i0", ""), "t", "d").is_err());
    }
}
