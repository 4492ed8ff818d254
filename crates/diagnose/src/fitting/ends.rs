//! Where intervals of parameters end: what their profiles tell, beside what the covariance does.

use ieap_domain::quantiles::{CHI_SQUARE_95, NORMAL_95_ROUNDED};
use ieap_domain::{Estimate, StrengthProfile};
use ieap_model::effects::Limits;

use crate::fitting::policy::{RISE_95, WIDEST_FACTOR};
use crate::fitting::problem::FreeEffect;

/// The estimate with an interval that ends no sooner than its profile does: the covariance knows nothing of a valley that
/// bends.
pub(crate) fn held_by(estimate: &Estimate, profile: &StrengthProfile) -> Estimate {
    let (Some(low), Some(high), Some(best)) = (estimate.low_95, estimate.high_95, estimate.value) else {
        return estimate.clone();
    };
    let before = high - low;
    let (below, above) = sides(profile, best);
    let (low, high) = (low.min(end(&below, best)), high.max(end(&above, best)));
    Estimate {
        standard_error: estimate.standard_error.map(|error| error * (high - low) / before),
        low_95: Some(low),
        high_95: Some(high),
        ..estimate.clone()
    }
}

/// What a profile alone tells of a parameter whose best value is `best` and of which the covariance tells nothing: an
/// interval where both ends are passed, a bound where one is, else `estimate` as it is.
pub(crate) fn told_by(
    estimate: &Estimate,
    profile: &StrengthProfile,
    best: f64,
    free_effect: &FreeEffect,
    logarithmic: bool,
) -> Estimate {
    let rise = together(free_effect);
    let (below, above) = sides(profile, best);
    match (
        crossing(&below, rise, logarithmic),
        crossing(&above, rise, logarithmic),
    ) {
        (Some(low), Some(high)) if logarithmic && high > WIDEST_FACTOR * low => Estimate {
            low_95: Some(low),
            high_95: Some(high),
            ..estimate.clone()
        },
        (Some(low), Some(high)) => {
            Estimate::determined(best, 0.5 * (high - low) / NORMAL_95_ROUNDED, low, high)
        }
        (Some(low), None) => Estimate::above(low, NO_END),
        (None, Some(high)) => Estimate::below(high, NO_END),
        (None, None) => estimate.clone(),
    }
}

/// A value at a limit of what is sought with an interval that goes beyond it is no value but a bound.
pub(crate) fn bounded_by(estimate: Estimate, limits: Limits) -> Estimate {
    match (estimate.low_95, estimate.high_95) {
        (Some(low), Some(high)) if estimate.at_bound && high > limits.high && low >= limits.low => {
            Estimate::above(low, AT_LIMIT)
        }
        (Some(low), Some(high)) if estimate.at_bound && low < limits.low && high <= limits.high => {
            Estimate::below(high, AT_LIMIT)
        }
        _ => estimate,
    }
}

/// Rise at the ends of an interval of all parameters of an effect together, where the covariance tells nothing: of so many
/// degrees of freedom as the effect has parameters, for they make up for each other along valleys that bend, and an end
/// that a search did not reach must not pass for one.
pub(crate) fn together(free_effect: &FreeEffect) -> f64 {
    CHI_SQUARE_95[free_effect.free().clamp(1, CHI_SQUARE_95.len()) - 1]
}

const NO_END: &str = "the readings fit as well with all values from there to the limit of what is sought";
const AT_LIMIT: &str = "what fits best lies at the limit of what is sought";

type Points = Vec<(f64, f64)>;

/// The points on either side of the best, from it outward.
fn sides(profile: &StrengthProfile, best: f64) -> (Points, Points) {
    let points: Points = (profile.values.iter().copied())
        .zip(profile.rises.iter().copied())
        .collect();
    let below = points.iter().rev().copied().filter(|(x, _)| *x <= best).collect();
    let above = points.into_iter().filter(|(x, _)| *x >= best).collect();
    (below, above)
}

/// Where the rise passes that of a 95 % interval, of points that go outward from the best; the last of them where it does
/// not.
fn end(points: &[(f64, f64)], best: f64) -> f64 {
    let last = || points.last().map_or(best, |(x, _)| *x);
    crossing(points, RISE_95, false).unwrap_or_else(last)
}

/// The same beyond the last point inside: a rise between two places that explain the readings as well ends nothing.
fn crossing(points: &[(f64, f64)], bound: f64, logarithmic: bool) -> Option<f64> {
    let inside = points.iter().rposition(|(_, rise)| *rise < bound)?;
    let ((x, rise), (further, higher)) = (points[inside], *points.get(inside + 1)?);
    // Roots of rises go along straight lines where the profile is a parabola.
    let part = ((bound.sqrt() - rise.sqrt()) / (higher.sqrt() - rise.sqrt())).clamp(0.0, 1.0);
    Some(if logarithmic {
        x * (further / x).powf(part)
    } else {
        x + part * (further - x)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn profile(points: &[(f64, f64)]) -> StrengthProfile {
        let (values, rises) = points.iter().copied().unzip();
        StrengthProfile {
            effect: "e".to_owned(),
            key: "k".to_owned(),
            values,
            rises,
        }
    }

    #[test]
    fn a_profile_tells_what_the_covariance_does_not() {
        let nothing = Estimate::not_determined("flat");
        let effect = ieap_model::effects::effect("current-offset").unwrap();
        let limits = vec![Limits::linear(0.0, 1.0)];
        let one = FreeEffect::new(effect, 0, limits, &[0.5]);
        let told =
            |points: &[(f64, f64)], logarithmic| told_by(&nothing, &profile(points), 1.0, &one, logarithmic);
        let both = told(
            &[(0.5, 5.0), (0.7, 2.0), (1.0, 0.0), (2.0, 1.0), (3.0, 9.0)],
            false,
        );
        assert!(both.value == Some(1.0) && both.low_95.unwrap() > 0.5 && both.high_95.unwrap() < 3.0);
        let open = told(&[(0.5, 5.0), (0.7, 2.0), (1.0, 0.0), (2.0, 1.0)], false);
        assert!(open.value.is_none() && open.high_95.is_none() && open.low_95.is_some_and(|low| low > 0.5));
        assert_eq!(told(&[(0.5, 1.0), (1.0, 0.0), (2.0, 1.0)], false), nothing);
        // Known to three decades only: both ends, and no value.
        let wide = told(
            &[(0.01, 9.0), (0.1, 1.0), (1.0, 0.0), (30.0, 2.0), (300.0, 9.0)],
            true,
        );
        assert!(wide.value.is_none() && wide.low_95.unwrap() > 0.01 && wide.high_95.unwrap() < 300.0);
    }

    #[test]
    fn a_value_at_a_limit_is_a_bound_where_its_interval_goes_beyond() {
        let limits = Limits::linear(-1.0, 2.0);
        let at = |value: f64, low: f64, high: f64, at_bound: bool| {
            let estimate = Estimate {
                at_bound,
                ..Estimate::determined(value, 0.1, low, high)
            };
            bounded_by(estimate, limits)
        };
        let high = at(2.0, 1.8, 2.2, true);
        assert_eq!((high.value, high.low_95, high.high_95), (None, Some(1.8), None));
        let low = at(-1.0, -1.2, -0.8, true);
        assert_eq!((low.value, low.low_95, low.high_95), (None, None, Some(-0.8)));
        assert!(high.reason.is_some() && low.reason.is_some());
        // Not at the limit, or nothing known on either side: as it was.
        assert_eq!(at(1.95, 1.8, 2.1, false).value, Some(1.95));
        assert_eq!(at(2.0, -1.5, 5.5, true).value, Some(2.0));
    }

    #[test]
    fn a_parabola_leaves_the_interval_and_a_bent_valley_widens_it() {
        let strength = Estimate::determined(2.0, 0.5, 1.02, 2.98);
        let parabola = [-1.5, -1.0, 0.0, 1.0, 1.5].map(|x| (2.0 + x, (x / 0.5) * (x / 0.5)));
        let same = held_by(&strength, &profile(&parabola));
        assert!((same.low_95.unwrap() - 1.02).abs() < 1e-3 && (same.high_95.unwrap() - 2.98).abs() < 1e-3);
        let bent = [
            (0.5, 9.0),
            (1.0, 4.0),
            (2.0, 0.0),
            (3.0, 0.96),
            (4.0, 2.0),
            (8.0, 5.76),
        ];
        let wide = held_by(&strength, &profile(&bent));
        assert!((wide.low_95.unwrap() - 1.02).abs() < 0.01, "{wide:?}");
        assert!((4.0..8.0).contains(&wide.high_95.unwrap()), "{wide:?}");
        assert!(wide.standard_error.unwrap() > 0.5);
        // A rise between two places that explain the readings as well ends nothing.
        let humped = [
            (0.5, 9.0),
            (1.0, 4.0),
            (2.0, 0.0),
            (3.0, 7.0),
            (5.0, 1.0),
            (6.0, 9.0),
        ];
        let high = held_by(&strength, &profile(&humped)).high_95.unwrap();
        assert!((5.0..6.0).contains(&high), "{high}");
        let to_the_limit = [(0.5, 9.0), (1.0, 4.0), (2.0, 0.0), (3.0, 0.5), (5.0, 1.0)];
        assert_eq!(held_by(&strength, &profile(&to_the_limit)).high_95, Some(5.0));
    }
}
