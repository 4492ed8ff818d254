//! The profile likelihood of the parameters of every effect.

use rayon::prelude::*;

use crate::domain::{Estimate, StrengthProfile};
use crate::model::extended::ExtendedModel;

use super::fitted::Fitted;
use super::group::Group;
use super::problem::{Problem, Sought};

/// Strengths that are looked at on either side, in standard errors.
const AT: [f64; 4] = [0.5, 1.0, 2.0, 3.0];
/// Evaluations of each search, from the place that the covariance expects.
const SHORT: u64 = 6;
const SETTLE: f64 = 0.02;
/// Rise at the ends of a 95 % interval: chi-square of one degree of freedom.
const BOUNDS: f64 = 3.84;
/// The same where the covariance tells nothing, of so many degrees of freedom as the effect has parameters: they make up for
/// each other along valleys that bend, and an end that a search did not reach must not pass for one.
const TOGETHER: [f64; 3] = [3.84, 5.99, 7.81];
/// Where three standard errors do not reach it, steps that each go so many times farther, and how many of them.
const FARTHER: f64 = 1.6;
const FURTHER: usize = 9;
/// Parts of the way to a limit at which a parameter is looked at of which the covariance tells nothing.
const WAY: [f64; 9] = [0.01, 0.03, 0.07, 0.13, 0.22, 0.35, 0.52, 0.75, 1.0];
/// Evaluations of each search on that way: a valley that bends is followed slowly.
const LONG: u64 = 20;
/// Ends of an interval of a logarithmic parameter that are farther apart than this give no value, as with the covariance.
const DECADES: f64 = 100.0;

/// Profiles of every parameter of the effects that is searched, effect after effect.
pub(super) fn profiles(group: &Group, fitted: &Fitted) -> Vec<StrengthProfile> {
    let (slope, _) = fitted.problem.slope(&fitted.at, &[]);
    let inverse = slope.normal.inverse(1e-12);
    let effects = &fitted.problem.effects;
    let mut place = fitted.problem.base_len();
    let mut wanted = Vec::new();
    for (number, sought) in effects.iter().enumerate() {
        for parameter in (0..sought.limits.len()).filter(|&k| !sought.limits[k].held) {
            wanted.push(Which {
                number,
                parameter,
                place,
            });
            place += 1;
        }
    }
    let of = |which: Which| {
        let place = which.place;
        let sd = inverse.get(place, place).max(0.0).sqrt();
        let shift: Vec<f64> = (0..fitted.at.len())
            .map(|k| inverse.get(k, place) / (sd * sd))
            .collect();
        profile(group, fitted, which, sd, &shift)
    };
    wanted.into_par_iter().filter_map(of).collect()
}

/// A searched parameter of an effect of the model.
#[derive(Clone, Copy)]
struct Which {
    /// Place of the effect in the model.
    number: usize,
    /// Place of the parameter in the effect.
    parameter: usize,
    /// Place of its coordinate.
    place: usize,
}

/// One profile; `shift` is how the other coordinates follow the parameter's to first order.
fn profile(group: &Group, fitted: &Fitted, which: Which, sd: f64, shift: &[f64]) -> Option<StrengthProfile> {
    let along = Along {
        group,
        fitted,
        which,
        shift,
    };
    let Which {
        number,
        parameter,
        place,
    } = which;
    let best = (fitted.effect_values()[number][parameter], 0.0);
    let mut points = vec![best];
    // Intervals that the limits would cut anyway are no scale to look at.
    let (low, high) = fitted.problem.limits_of(place);
    let is_known = sd > 0.0 && 2.0 * AT[3] * sd < high - low;
    if !is_known {
        for end in [low, high] {
            points.extend(
                along
                    .to_the_limit(end - fitted.at[place])
                    .iter()
                    .map(Point::shown),
            );
        }
    }
    for side in [-1.0, 1.0].into_iter().filter(|_| is_known) {
        let mut last: Option<Point> = None;
        for at in AT {
            let step = side * at * sd;
            let is_outside = fitted.problem.is_outside(place, fitted.at[place] + step);
            let found = (!is_outside).then(|| along.expected(step)).flatten();
            points.extend(found.as_ref().map(Point::shown));
            last = found.or(last);
        }
        // A valley that bends, or goes on along a limit of another parameter, is followed from where it was left.
        let mut at = AT[AT.len() - 1];
        for _ in 0..FURTHER {
            let Some(before) = last.filter(|point| point.rise < BOUNDS) else {
                break;
            };
            at *= FARTHER;
            last = along.further(side * at * sd, &before, SHORT);
            points.extend(last.as_ref().map(Point::shown));
        }
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let about = fitted.problem.effects[number].effect.about();
    let (values, rises): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
    (values.len() > 2).then(|| StrengthProfile {
        effect: about.id.to_owned(),
        key: about.parameters[parameter].key.to_owned(),
        values,
        rises,
    })
}

/// One parameter of a fitted model, on its way.
struct Along<'a, 'g> {
    group: &'a Group<'g>,
    fitted: &'a Fitted<'g>,
    which: Which,
    shift: &'a [f64],
}

/// Where all else is at its best.
struct Point {
    model: ExtendedModel,
    value: f64,
    rise: f64,
}

impl Point {
    fn shown(&self) -> (f64, f64) {
        (self.value, self.rise)
    }
}

impl Along<'_, '_> {
    /// The rise at a step of the parameter's coordinate, all else searched from where the covariance expects it.
    fn expected(&self, step: f64) -> Option<Point> {
        let at: Vec<f64> = (self.fitted.at.iter().zip(self.shift))
            .map(|(x, s)| x + s * step)
            .collect();
        self.searched(self.fitted.problem.model(&at), SHORT)
    }

    fn together(&self) -> f64 {
        together(&self.fitted.problem.effects[self.which.number])
    }

    fn best(&self) -> Point {
        Point {
            model: self.fitted.problem.model(&self.fitted.at),
            value: self.fitted.effect_values()[self.which.number][self.which.parameter],
            rise: 0.0,
        }
    }

    /// Points on the way to a limit so far off, from one to the next, until the rise has passed that of an interval.
    fn to_the_limit(&self, reach: f64) -> Vec<Point> {
        let mut found: Vec<Point> = Vec::new();
        let best = self.best();
        for part in WAY {
            let before = found.last().unwrap_or(&best);
            if before.rise > self.together() {
                break;
            }
            match self.further(part * reach, before, LONG) {
                Some(point) => found.push(point),
                None => break,
            }
        }
        found
    }

    /// The same from where the search `before` ended, no further than the limit; none where that lies behind.
    fn further(&self, step: f64, before: &Point, evaluations: u64) -> Option<Point> {
        let problem = &self.fitted.problem;
        let Which {
            number,
            parameter,
            place,
        } = self.which;
        let mut at = self.fitted.at.clone();
        at[place] = problem.within(place, at[place] + step);
        let value = problem.model(&at).effects[number].parameters[parameter];
        let mut model = ExtendedModel {
            base: before.model.base.clone(),
            effects: before.model.effects.clone(),
        };
        model.effects[number].parameters[parameter] = value;
        let search = || self.searched(model, evaluations);
        (value != before.value).then(search).flatten()
    }

    fn searched(&self, from: ExtendedModel, evaluations: u64) -> Option<Point> {
        let Which {
            number, parameter, ..
        } = self.which;
        let mut all = self.fitted.problem.effects.clone();
        all[number] = held(&all[number], parameter, &from.effects[number].parameters);
        let problem = Problem::new(self.group, &from.base, all);
        let parameters: Vec<Vec<f64>> = from.effects.iter().map(|e| e.parameters.clone()).collect();
        let start = problem.coordinates(&from.base, &parameters);
        let bottom = problem.descend(&start, evaluations, SETTLE, &[]);
        bottom.slope.square.is_finite().then(|| Point {
            value: from.effects[number].parameters[parameter],
            rise: (bottom.slope.square - self.fitted.square).max(0.0),
            model: problem.model(&bottom.at),
        })
    }
}

/// The estimate with an interval that ends no sooner than its profile does: the covariance knows nothing of a valley that
/// bends.
pub(super) fn held_by(estimate: &Estimate, profile: &StrengthProfile) -> Estimate {
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
pub(super) fn told_by(
    estimate: &Estimate,
    profile: &StrengthProfile,
    best: f64,
    sought: &Sought,
    logarithmic: bool,
) -> Estimate {
    let rise = together(sought);
    let (below, above) = sides(profile, best);
    match (
        crossing(&below, rise, logarithmic),
        crossing(&above, rise, logarithmic),
    ) {
        (Some(low), Some(high)) if logarithmic && high > DECADES * low => Estimate {
            low_95: Some(low),
            high_95: Some(high),
            ..estimate.clone()
        },
        (Some(low), Some(high)) => Estimate::determined(best, 0.5 * (high - low) / HALF_95, low, high),
        (Some(low), None) => Estimate::above(low, NO_END),
        (None, Some(high)) => Estimate::below(high, NO_END),
        (None, None) => estimate.clone(),
    }
}

/// Rise at the ends of an interval of all parameters of an effect together.
fn together(sought: &Sought) -> f64 {
    TOGETHER[sought.free().clamp(1, TOGETHER.len()) - 1]
}

const NO_END: &str = "the readings fit as well with all values from there to the limit of what is sought";
/// Half of a 95 % interval in standard errors.
const HALF_95: f64 = 1.96;

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
    crossing(points, BOUNDS, false).unwrap_or_else(last)
}

fn crossing(points: &[(f64, f64)], bound: f64, logarithmic: bool) -> Option<f64> {
    let pair = points.windows(2).find(|pair| pair[1].1 >= bound)?;
    let ((x, rise), (further, higher)) = (pair[0], pair[1]);
    // Roots of rises go along straight lines where the profile is a parabola.
    let part = ((bound.sqrt() - rise.sqrt()) / (higher.sqrt() - rise.sqrt())).clamp(0.0, 1.0);
    Some(match logarithmic {
        true => x * (further / x).powf(part),
        false => x + part * (further - x),
    })
}

/// The effect with that parameter held.
fn held(sought: &Sought, parameter: usize, parameters: &[f64]) -> Sought {
    let mut limits = sought.limits.clone();
    limits[parameter].held = true;
    Sought::new(sought.effect, sought.variant, limits, parameters)
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
        let effect = crate::model::effects::effect("current-offset").unwrap();
        let limits = vec![crate::model::effects::Limits::linear(0.0, 1.0)];
        let one = Sought::new(effect, 0, limits, &[0.5]);
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
        let to_the_limit = [(0.5, 9.0), (1.0, 4.0), (2.0, 0.0), (3.0, 0.5), (5.0, 1.0)];
        assert_eq!(held_by(&strength, &profile(&to_the_limit)).high_95, Some(5.0));
    }
}
