//! Channels of the strip as a whole that follow from what was measured.

use ieap_domain::{Channel, Drive, OpenZero, Quantity, range_of};
use ieap_numerics::robust::median;

/// The channels of the strip as a whole, with a curvature added where none was measured:
/// - from the tip displacement, kappa = 2 d / (L^2 + d^2), equation \[3\] of the thesis, for a strip of free
///   length `length_cm`; d counts from where the tip stood at rest ([`rest_mm`]), for the zero of a displacement sensor is
///   arbitrary and the formula is not linear: a zero that is off would bend the scale. What is left open of it goes with the
///   channel;
/// - else the mean of the curvatures measured along the strip, where they were sampled together.
///
/// Without a length, or with curvatures of different times, nothing is added.
pub fn responses(channels: &[Channel], length_cm: Option<f64>, drive: Option<&Drive>) -> Vec<Channel> {
    let whole = |channel: &&Channel| channel.position_mm.is_none();
    let mut all: Vec<Channel> = channels.iter().filter(whole).cloned().collect();
    if all.iter().any(|c| c.is_whole(Quantity::Curvature)) {
        return all;
    }
    let tip = all.iter().find(|c| c.is_whole(Quantity::TipDisplacement));
    let from_tip = tip
        .zip(length_cm)
        .map(|(tip, length_cm)| curvature_of_tip(tip, length_cm, drive));
    all.extend(from_tip.or_else(|| mean_curvature(channels)));
    all
}

/// Where the tip of a strip without voltage stood before the first edge, mm: the median of the readings there, which neither an
/// outlier moves nor a clock that reads the edge a little late. None where the record begins under voltage, or with it.
pub fn rest_mm(tip: &Channel, drive: &Drive) -> Option<f64> {
    let edge = drive.segments.first()?.edge;
    let (time_s, values) = tip.included();
    let before = time_s.partition_point(|&t| t <= edge.no_earlier_s && t < edge.no_later_s);
    median(&values[..before]).filter(|_| drive.baseline_v == 0.0)
}

/// Curvature, 1/cm, of a strip of that free length whose tip is seen so far aside (equation \[3\] of the thesis).
pub fn curvature_of_displacement(displacement_mm: f64, length_cm: f64) -> f64 {
    let d_cm = displacement_mm / 10.0;
    2.0 * d_cm / (length_cm * length_cm + d_cm * d_cm)
}

fn curvature_of_tip(tip: &Channel, length_cm: f64, drive: Option<&Drive>) -> Channel {
    let zero = drive.map_or(TipZero::default(), |drive| TipZero::of(tip, drive));
    let curvature = |d_mm: &f64| curvature_of_displacement(d_mm - zero.mm, length_cm);
    let rise = |d_mm: f64| rise_of_curvature(d_mm - zero.mm, length_cm);
    let error = |d_mm: &f64| zero.error_mm * (rise(*d_mm) - rise(zero.mm));
    let open_zero = (zero.error_mm > 0.0 || zero.is_free).then(|| OpenZero {
        error: tip.values.iter().map(error).collect(),
        is_free: zero.is_free,
    });
    Channel {
        quantity: Quantity::Curvature,
        values: tip.values.iter().map(curvature).collect(),
        open_zero,
        ..tip.clone()
    }
}

/// Where a sensor of the displacement has its zero, as its readings tell.
#[derive(Debug, Clone, Copy, Default)]
struct TipZero {
    mm: f64,
    error_mm: f64,
    is_free: bool,
}

impl TipZero {
    fn of(tip: &Channel, drive: &Drive) -> TipZero {
        if let Some(mm) = rest_mm(tip, drive) {
            // A sensor that was not zeroed is taken; a strip that was bent so, or as far as it moves, is as likely: half of the square
            // of that lies between.
            let (_, values) = tip.included();
            let (low, high) = range_of(values.iter().copied());
            let error_mm = mm.abs().min(high - low) / 2.0_f64.sqrt();
            return TipZero {
                mm,
                error_mm,
                is_free: false,
            };
        }
        let (time_s, values) = tip.included();
        let edge = drive.segments.first().map(|segment| segment.edge);
        let begins_behind =
            edge.is_some_and(|edge| time_s.first().is_some_and(|first| *first >= edge.no_later_s));
        match values[..] {
            [first, second, ..] if begins_behind && drive.baseline_v == 0.0 && !drive.moves() => {
                // The edge lies within the interval before the first reading: by then it moved as in the next, or not at all.
                let half_mm = 0.5 * (second - first);
                TipZero {
                    mm: first - half_mm,
                    error_mm: half_mm.abs(),
                    is_free: true,
                }
            }
            _ => TipZero::default(),
        }
    }
}

/// Change of that curvature with the displacement, 1/cm for each mm.
fn rise_of_curvature(displacement_mm: f64, length_cm: f64) -> f64 {
    let (d_cm, square) = (displacement_mm / 10.0, length_cm * length_cm);
    0.2 * (square - d_cm * d_cm) / (square + d_cm * d_cm).powi(2)
}

fn mean_curvature(channels: &[Channel]) -> Option<Channel> {
    let along: Vec<&Channel> = channels
        .iter()
        .filter(|c| c.quantity == Quantity::Curvature && c.position_mm.is_some())
        .collect();
    let first = along.first()?;
    if along.iter().any(|channel| channel.time_s != first.time_s) {
        return None;
    }
    let count = along.len() as f64;
    let mean = |index: usize| along.iter().map(|channel| channel.values[index]).sum::<f64>() / count;
    Some(Channel {
        raw_name: format!("mean of {} positions", along.len()),
        position_mm: None,
        values: (0..first.len()).map(mean).collect(),
        ..(*first).clone()
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    #[test]
    fn a_half_circle_has_twice_the_inverse_length() {
        // A tip that has moved by L at distance L: 2 L / (2 L^2) = 1/L.
        let tip = Channel::new(
            Quantity::TipDisplacement,
            Arc::from([0.0, 1.0]),
            Arc::from([0.0, 5.0]),
        );
        let all = responses(std::slice::from_ref(&tip), Some(0.5), None);
        assert_eq!(all[1].quantity, Quantity::Curvature);
        assert!((all[1].values[1] - 2.0).abs() < 1e-12);
        assert_eq!(responses(&[tip], None, None).len(), 1);
    }

    #[test]
    fn curvatures_along_the_strip_are_averaged() {
        let at = |position_mm: f64, values: [f64; 2]| Channel {
            position_mm: Some(position_mm),
            ..Channel::new(Quantity::Curvature, Arc::from([0.0, 1.0]), Arc::from(values))
        };
        let all = responses(&[at(1.0, [1.0, 3.0]), at(2.0, [2.0, 5.0])], None, None);
        assert_eq!(all.len(), 1);
        assert_eq!((&all[0].values[..], all[0].position_mm), (&[1.5, 4.0][..], None));
        let mut later = at(3.0, [0.0, 0.0]);
        later.time_s = Arc::from([0.0, 1.5]);
        assert!(responses(&[at(1.0, [1.0, 3.0]), later], None, None).is_empty());
    }
}
