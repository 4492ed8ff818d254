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
/// Rise at the ends of a 95 % interval.
const BOUNDS: f64 = 3.84;
/// Where three standard errors do not reach it, steps that each go so many times farther, and how many of them.
const FARTHER: f64 = 1.6;
const FURTHER: usize = 9;

/// Profiles of every parameter of the effects that is searched and has a standard error, effect after effect.
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
    if !(sd > 0.0 && sd.is_finite()) {
        return None;
    }
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
    let mut points = vec![(fitted.effect_values()[number][parameter], 0.0)];
    for side in [-1.0, 1.0] {
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
            last = along.further(side * at * sd, &before);
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
        self.searched(self.fitted.problem.model(&at))
    }

    /// The same from where the search `before` ended, no further than the limit; none where that lies behind.
    fn further(&self, step: f64, before: &Point) -> Option<Point> {
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
        (value != before.value).then(|| self.searched(model)).flatten()
    }

    fn searched(&self, from: ExtendedModel) -> Option<Point> {
        let Which {
            number, parameter, ..
        } = self.which;
        let mut all = self.fitted.problem.effects.clone();
        all[number] = held(&all[number], parameter, &from.effects[number].parameters);
        let problem = Problem::new(self.group, &from.base, all);
        let parameters: Vec<Vec<f64>> = from.effects.iter().map(|e| e.parameters.clone()).collect();
        let start = problem.coordinates(&from.base, &parameters);
        let bottom = problem.descend(&start, SHORT, SETTLE, &[]);
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
    let points: Vec<(f64, f64)> = (profile.values.iter().copied())
        .zip(profile.rises.iter().copied())
        .collect();
    let below: Vec<(f64, f64)> = points.iter().rev().copied().filter(|(x, _)| *x <= best).collect();
    let above: Vec<(f64, f64)> = points.into_iter().filter(|(x, _)| *x >= best).collect();
    let (low, high) = (low.min(end(&below, best)), high.max(end(&above, best)));
    Estimate {
        standard_error: estimate.standard_error.map(|error| error * (high - low) / before),
        low_95: Some(low),
        high_95: Some(high),
        ..estimate.clone()
    }
}

/// Where the rise passes that of a 95 % interval, of points that go outward from the best; the last of them where it does
/// not.
fn end(points: &[(f64, f64)], best: f64) -> f64 {
    let steps = points.windows(2).find(|pair| pair[1].1 >= BOUNDS);
    if let Some(&[(x, rise), (further, higher)]) = steps {
        // Roots of rises go along straight lines where the profile is a parabola.
        let part = (BOUNDS.sqrt() - rise.sqrt()) / (higher.sqrt() - rise.sqrt());
        return x + part.clamp(0.0, 1.0) * (further - x);
    }
    points.last().map_or(best, |(x, _)| *x)
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
