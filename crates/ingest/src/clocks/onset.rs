//! Where the bending leaves its resting level.

use super::Moment;
use crate::clocks::policy::{
    BEGINNING_SHARE, DEPARTURE_SHARE, DRIFT_OVER_NOISE, DRIFT_SHARE, FEWEST_STRAIGHT, LARGEST_OVER_LEAST,
};
use crate::drive::policy::{DEPARTURE_OVER_NOISE, FEWEST_AT_REST};
use ieap_domain::{Channel, Edge};
use ieap_numerics::robust::{sd_on_a_slope, upper_median};

/// The moment from which the strip bends: where the straight beginning of the departure meets the resting level.
pub(super) fn of_bending(bending: &Channel) -> Result<Moment, String> {
    let (time_s, values) = bending.included();
    if values.len() < 4 * FEWEST_AT_REST {
        return Err(format!("the bending has {} readings only", values.len()));
    }
    let noise = sd_on_a_slope(&values);
    let rest = middle(&values[..FEWEST_AT_REST]);
    let largest = values
        .iter()
        .fold(0.0_f64, |most, value| most.max((value - rest).abs()));
    let threshold = (DEPARTURE_OVER_NOISE * noise).max(DEPARTURE_SHARE * largest);
    let departs = |at: usize| values[at..].iter().take(3).all(|v| (v - rest).abs() > threshold);
    let first = (0..values.len().saturating_sub(2)).find(|&at| departs(at));
    let first = match first {
        Some(first) if largest > LARGEST_OVER_LEAST * threshold => first,
        _ => return Err("the bending does not leave its noise".to_owned()),
    };
    if first < FEWEST_AT_REST {
        return Err(format!(
            "{first} readings at rest stand before the bending, {FEWEST_AT_REST} are needed"
        ));
    }
    // The last readings before the threshold may be on their way already.
    let resting = &values[..(4 * first).div_ceil(5)];
    let (early, late) = resting.split_at(resting.len() / 2);
    let drift = (middle(late) - middle(early)).abs();
    if drift > (DRIFT_SHARE * threshold).max(DRIFT_OVER_NOISE * noise) {
        return Err("the strip is not at rest before the bending".to_owned());
    }
    let level = middle(resting);
    let level_error = noise / (resting.len() as f64).sqrt();
    let straight = values[first..]
        .iter()
        .take_while(|value| (*value - level).abs() <= BEGINNING_SHARE * largest)
        .count();
    let between = Moment::from(Edge::between(time_s[first - 1], time_s[first]));
    if straight < FEWEST_STRAIGHT {
        return Ok(between);
    }
    let of = |count: usize| {
        let readings = first..first + count;
        meeting(
            &time_s[readings.clone()],
            &values[readings],
            level,
            noise,
            level_error,
        )
    };
    let (whole, half) = (of(straight), of(straight.div_ceil(2).max(3)));
    // A beginning that is not straight shows by how much its first half disagrees.
    let bent = (whole.time_s - half.time_s).abs();
    Ok(Moment {
        time_s: whole.time_s,
        standard_error_s: whole.standard_error_s.hypot(bent).hypot(between.standard_error_s),
    })
}

/// Where the least-squares line through readings meets `level`.
fn meeting(time_s: &[f64], values: &[f64], level: f64, noise: f64, level_error: f64) -> Moment {
    let count = values.len() as f64;
    let (mean_t, mean_v) = (
        time_s.iter().sum::<f64>() / count,
        values.iter().sum::<f64>() / count,
    );
    let spread: f64 = time_s.iter().map(|t| (t - mean_t).powi(2)).sum();
    let pairs = time_s.iter().zip(values);
    let slope = pairs.map(|(t, v)| (t - mean_t) * (v - mean_v)).sum::<f64>() / spread;
    let back_s = (level - mean_v) / slope;
    let variance = noise * noise * (1.0 / count + back_s * back_s / spread) + level_error * level_error;
    Moment {
        time_s: mean_t + back_s,
        standard_error_s: variance.sqrt() / slope.abs(),
    }
}

/// The middle one of `values`.
fn middle(values: &[f64]) -> f64 {
    upper_median(&mut values.to_vec()).unwrap_or(0.0)
}
