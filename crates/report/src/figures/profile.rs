//! How the sum of squares rises as the strength of an effect leaves its best value, with the level that bounds a 95 %
//! interval.

use ieap_domain::quantiles::CHI_SQUARE_95_OF_ONE;
use ieap_domain::range_of;
use ieap_show::{Chart, Ink, Layer, Mark, Panel, Range};

use crate::blocks::chart::inline;

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
    let (quantity, unit) = (quantity.to_owned(), unit.to_owned());
    let x = if ends.0 > 0.0 && ends.1 > DECADES * ends.0 {
        Range::log(quantity, unit)
    } else {
        Range::linear(quantity, unit)
    };
    let x = x.with(ends.0).with(ends.1);
    let y = Range::linear("Rise of the sum of squares", "")
        .with(0.0)
        .with(2.0 * BOUND);
    let layers = vec![
        Layer::new("", Mark::Level, Ink::Limit, [(ends.0, BOUND)]),
        Layer::new(
            "Rise",
            Mark::DottedLine,
            Ink::FIRST,
            below(HIGHEST * BOUND, &points),
        ),
    ];
    let chart = Chart::new(title, vec![Panel { x, y, layers }]);
    inline(&chart, title, desc).map(Some)
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
