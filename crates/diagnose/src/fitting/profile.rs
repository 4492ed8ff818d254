//! The profile likelihood of the parameters of every effect.

use rayon::prelude::*;

use ieap_domain::StrengthProfile;
use ieap_model::extended::ExtendedModel;
use ieap_numerics::least_squares::Stop;

use crate::fitting::ends::together;
use crate::fitting::fitted::Fitted;
use crate::fitting::modes::{Mode, SETTLE, modes};
use crate::fitting::policy::RISE_95;
use crate::fitting::problem::{ExtendedProblem, FreeEffect};
use crate::fitting::scale::scale;
use crate::readings::group::RunGroup;

/// Strengths that are looked at on either side, in standard errors.
const AT: [f64; 4] = [0.5, 1.0, 2.0, 3.0];
/// Evaluations of each search, from the place that the covariance expects.
const SHORT: u64 = 6;
/// Where three standard errors do not reach it, steps that each go so many times farther, and how many of them.
const FARTHER: f64 = 1.6;
const FURTHER: i32 = 9;
/// Parts of the way to a limit at which a parameter is looked at of which the covariance tells nothing.
const WAY: [f64; 9] = [0.01, 0.03, 0.07, 0.13, 0.22, 0.35, 0.52, 0.75, 1.0];
/// Evaluations of each search on that way: a valley that bends is followed slowly.
const LONG: u64 = 20;
/// A rise so many times that of an end is a leap: the search may have lost its way, and goes half as far first.
const LEAP: f64 = 4.0;
/// Times that it may.
const HALVINGS: usize = 5;

/// Profiles of every parameter of the effects that is searched, effect after effect; none of what is known before any reading,
/// whose Gaussian says as much.
pub(crate) fn profiles(group: &RunGroup, fitted: &Fitted) -> Vec<StrengthProfile> {
    let (slope, _) = fitted.problem.slope(&fitted.at);
    let inverse = slope.normal.inverse(1e-12);
    let effects = &fitted.problem.effects;
    let scale = scale(group, &fitted.problem, &fitted.at);
    let is_asked = |number: usize| effects[number].known.is_empty();
    let modes: Vec<Vec<Mode>> = (0..effects.len())
        .map(|number| {
            if is_asked(number) {
                modes(group, fitted, number, &scale)
            } else {
                Vec::new()
            }
        })
        .collect();
    let mut place = fitted.problem.base_len();
    let mut wanted = Vec::new();
    for (number, free_effect) in effects.iter().enumerate() {
        for parameter in (0..free_effect.limits.len()).filter(|&k| !free_effect.limits[k].held) {
            if is_asked(number) {
                wanted.push(Which {
                    number,
                    parameter,
                    place,
                });
            }
            place += 1;
        }
    }
    let of = |which: Which| {
        let place = which.place;
        let sd = inverse.error(place);
        let shift: Vec<f64> = (0..fitted.at.len())
            .map(|k| inverse.get(k, place) / (sd * sd))
            .collect();
        let along = Along {
            group,
            fitted,
            which,
            shift: &shift,
        };
        along.profile(sd, &modes[which.number])
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

/// One parameter of a fitted model, on its way.
struct Along<'a, 'g> {
    group: &'a RunGroup<'g>,
    fitted: &'a Fitted<'g>,
    which: Which,
    shift: &'a [f64],
}

/// A way from the best: to the limit so far off, or by standard deviations of the covariance where they are known.
struct Toward {
    side: f64,
    sd: Option<f64>,
    limit: f64,
    bound: f64,
}

impl Toward {
    /// Steps of the coordinate from `first` on.
    fn steps(&self, first: f64) -> Vec<f64> {
        match self.sd {
            Some(sd) => (0..FURTHER)
                .map(|n| first + self.side * sd * FARTHER.powi(n))
                .collect(),
            None => WAY
                .iter()
                .map(|part| first + part * (self.limit - first))
                .collect(),
        }
    }
}

/// Where all else is at its best.
#[derive(Clone)]
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
    /// The profile of a parameter whose coordinate the covariance gives the standard deviation `sd`, by way of other places
    /// where the effect explains the readings as well.
    fn profile(&self, sd: f64, modes: &[Mode]) -> Option<StrengthProfile> {
        let Which {
            number,
            parameter,
            place,
        } = self.which;
        let (low, high) = self.fitted.problem.limits_of(place);
        // Intervals that the limits would cut anyway are no scale to look at.
        let is_known = sd > 0.0 && 2.0 * AT[3] * sd < high - low;
        let mut points = vec![self.best().shown()];
        for (side, limit) in [(-1.0, low), (1.0, high)] {
            let toward = Toward {
                side,
                sd: is_known.then_some(sd),
                limit: limit - self.fitted.at[place],
                bound: if is_known { RISE_95 } else { self.together() },
            };
            points.extend(self.side(&toward, modes).iter().map(Point::shown));
        }
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points.dedup_by(|a, b| a.0 == b.0);
        let about = self.fitted.problem.effects[number].effect.about();
        let (values, rises): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
        (values.len() > 2).then(|| StrengthProfile {
            effect: about.id.to_owned(),
            key: about.parameters[parameter].key.to_owned(),
            values,
            rises,
        })
    }

    /// Points on one side of the best.
    fn side(&self, toward: &Toward, modes: &[Mode]) -> Vec<Point> {
        let mut found = match toward.sd {
            Some(sd) => self.by_covariance(toward, sd),
            None => self.outward(self.best(), &toward.steps(0.0), toward.bound, LONG),
        };
        let out = |point: &Point| toward.side * self.step_to(point);
        let within = found.iter().filter(|point| point.rise < toward.bound);
        let reached = within.map(out).fold(0.0, f64::max);
        let others = modes.iter().filter(|mode| mode.rise < toward.bound);
        let farthest = others
            .map(|mode| self.at_mode(mode))
            .filter(|point| out(point) > reached)
            .max_by(|a, b| out(a).total_cmp(&out(b)));
        if let Some(mode) = farthest {
            let steps = toward.steps(self.step_to(&mode));
            found.push(mode.clone());
            found.extend(self.outward(mode, &steps, toward.bound, LONG));
        }
        found
    }

    /// Points where the covariance expects them, and farther where the rise does not pass the bound there.
    fn by_covariance(&self, toward: &Toward, sd: f64) -> Vec<Point> {
        let Which { place, .. } = self.which;
        let mut found: Vec<Point> = Vec::new();
        for at in AT {
            let step = toward.side * at * sd;
            let is_outside = self
                .fitted
                .problem
                .is_outside(place, self.fitted.at[place] + step);
            found.extend((!is_outside).then(|| self.expected(step)).flatten());
        }
        // A valley that bends, or goes on along a limit of another parameter, is followed from where it was left.
        if let Some(last) = found.last().filter(|point| point.rise < RISE_95) {
            let farthest = toward.side * AT[AT.len() - 1] * sd;
            let steps: Vec<f64> = (1..=FURTHER).map(|n| farthest * FARTHER.powi(n)).collect();
            let farther = self.outward(last.clone(), &steps, RISE_95, SHORT);
            found.extend(farther);
        }
        found
    }

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

    fn at_mode(&self, mode: &Mode) -> Point {
        let Which {
            number, parameter, ..
        } = self.which;
        Point {
            model: mode.model.clone(),
            value: mode.model.effects[number].parameters[parameter],
            rise: mode.rise,
        }
    }

    /// Points at `steps` of the parameter's coordinate outward of `first`, each searched from where the one before ended,
    /// until the rise has passed `bound`; where it leaps past it, points between are looked at first.
    fn outward(&self, first: Point, steps: &[f64], bound: f64, evaluations: u64) -> Vec<Point> {
        let mut found: Vec<Point> = Vec::new();
        let mut ahead: Vec<f64> = steps.iter().rev().copied().collect();
        let (mut at, mut halvings) = (self.step_to(&first), HALVINGS);
        while let Some(step) = ahead.pop() {
            let before = found.last().unwrap_or(&first);
            let Some(point) = self.further(step, before, evaluations) else {
                break;
            };
            if point.rise > LEAP * bound && halvings > 0 {
                halvings -= 1;
                ahead.extend([step, 0.5 * (at + step)]);
                continue;
            }
            let is_past = point.rise > bound;
            found.push(point);
            at = step;
            if is_past {
                break;
            }
        }
        found
    }

    /// How far the parameter's coordinate is from the best there.
    fn step_to(&self, point: &Point) -> f64 {
        let Which {
            number,
            parameter,
            place,
        } = self.which;
        let free_effect = &self.fitted.problem.effects[number];
        free_effect.coordinate(parameter, point.value) - self.fitted.at[place]
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
        let mut model = before.model.clone();
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
        let problem = ExtendedProblem::new(self.group, &from.base, all);
        let parameters: Vec<Vec<f64>> = from.effects.iter().map(|e| e.parameters.clone()).collect();
        let start = problem.coordinates(&from.base, &parameters);
        let mut bottom = problem.search(&start, evaluations, SETTLE, &[]);
        if bottom.stop == Stop::EvaluationLimit && bottom.local.square - self.fitted.square > self.together()
        {
            bottom = problem.search(&bottom.at, LONG, SETTLE, &[]);
        }
        bottom.local.square.is_finite().then(|| Point {
            value: from.effects[number].parameters[parameter],
            rise: (bottom.local.square - self.fitted.square).max(0.0),
            model: problem.model(&bottom.at),
        })
    }
}

/// The effect with that parameter held.
fn held(free_effect: &FreeEffect, parameter: usize, parameters: &[f64]) -> FreeEffect {
    let mut limits = free_effect.limits.clone();
    limits[parameter].held = true;
    FreeEffect::new(free_effect.effect, free_effect.variant, limits, parameters)
}
