//! Whether places along the strip differ as the electrodes' resistance makes them.
//!
//! Both descriptions are held against the differences between places, readings less what all places have in common at
//! each time: a strip without resistance along its electrodes predicts none, whatever its laminate does in time, so
//! that a wrong law in time is not taken for resistance. One direction is asked, that of the fitted distributed model,
//! and its share in the noise is known from the residuals' covariance. What each place adds to a curvature for good,
//! an error of its initial shape, is taken out first.
//!
//! Unevenness that keeps its pattern while the strip bends may as well be a coupling that differs from place to place.
//! The resistance alone lets some places follow later than others: that part is asked by itself.

use ieap_numerics::chance::chi_square_chance;
use ieap_numerics::student::one_sided_chance;
use ieap_numerics::sums::{about_mean, add, dot, square};

use super::described::{Described, electrical_parameters};
use super::identified::Identified;
use super::policy::LEAST_REACH_ASKED;
use super::readings::{Kind, SeriesGroup};
use super::response;
use super::squares::{StripProblem, freedom, product, scatter};

/// What the differences between places say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unevenness {
    /// Places that were compared, over voltages and curvatures.
    pub places: usize,
    /// Fall of the sum of squares of the differences between places, in units of the noise, from the strip without
    /// resistance along its electrodes to the distributed one.
    pub gain: f64,
    /// That sum without resistance.
    pub uneven: f64,
    /// Independent readings that the noise of the differences is known from.
    pub independent_readings: f64,
    /// Chance of differences at least as much like those that resistance makes, where there is none.
    pub p: f64,
    /// The same for what does not keep its pattern: places that follow later than others.
    pub p_later: f64,
}

/// The evidence of a run; none where no kind of reading stands at two places.
pub(super) fn unevenness(found: &Identified) -> Option<Unevenness> {
    let input = &found.input;
    let described = found.described();
    let with_readings = |group: &&SeriesGroup| group.values.len() > 1 && group.kind != Kind::Current;
    let groups: Vec<&SeriesGroup> = found.readings.groups.iter().filter(with_readings).collect();
    let bends = described.mu_per_c != 0.0;
    let groups: Vec<&SeriesGroup> = groups
        .into_iter()
        .filter(|group| bends || group.kind == Kind::Voltage)
        .collect();
    if groups.is_empty() {
        return None;
    }
    let problem = StripProblem::of_groups(
        input,
        groups,
        electrical_parameters(&input.strip) + 2 * usize::from(bends),
        move |_| described.clone(),
    );
    let residuals = problem.residuals(&[]);
    let noise = problem.noise(&residuals);
    let measured = between(
        &problem.groups,
        over_noise(&problem.groups, |group, place| group.values[place].to_vec()),
    );
    let predicted = between(
        &problem.groups,
        predicted(&problem.groups, &found.described(), found),
    );
    let direction = between(&problem.groups, predicted_at_least(&problem.groups, found));
    let independent: f64 = noise.iter().map(|noise| noise.independent_readings()).sum();
    // Of voltages alone the shape of the direction is found in the same differences, by three parameters: chance then has
    // three directions to answer in. A current or a curvature knows the laminate's times without them.
    let is_sought = !bends && found.readings.count(Kind::Current) == 0;
    let chance = |direction: &[Vec<f64>]| {
        let scattered = scatter(&noise, direction);
        let freedom = freedom(&noise, direction, &scattered, problem.parameters());
        let spread = product(direction, &scattered).max(0.0).sqrt();
        let along = product(direction, &measured);
        match (spread > 0.0 && along > 0.0, is_sought) {
            (false, _) => 1.0,
            (true, true) => chi_square_chance((along / spread).powi(2), 3),
            (true, false) => one_sided_chance(along / spread, freedom),
        }
    };
    let uneven = product(&measured, &measured);
    let left: f64 = measured
        .iter()
        .zip(&predicted)
        .map(|(m, p)| m.iter().zip(p).map(|(m, p)| (m - p).powi(2)).sum::<f64>())
        .sum();
    Some(Unevenness {
        places: problem
            .groups
            .iter()
            .map(|group| group.values.len())
            .max()
            .unwrap_or(0),
        gain: uneven - left,
        uneven,
        independent_readings: independent,
        p: chance(&direction),
        p_later: chance(&without_patterns(&problem.groups, direction.clone())),
    })
}

/// Series of every group over their noise, one after the other.
fn over_noise(groups: &[&SeriesGroup], of: impl Fn(&SeriesGroup, usize) -> Vec<f64>) -> Vec<Vec<f64>> {
    let series = |group: &&SeriesGroup| {
        let places = 0..group.values.len();
        places
            .flat_map(|place| {
                let noise = group.noise[place];
                of(group, place).into_iter().map(move |value| value / noise)
            })
            .collect()
    };
    groups.iter().map(series).collect()
}

fn predicted(groups: &[&SeriesGroup], described: &Described, found: &Identified) -> Vec<Vec<f64>> {
    let of = |group: &&SeriesGroup| {
        let mut values = response::predicted(described, found.input.drive, group);
        for (place, row) in values.chunks_exact_mut(group.time_s.len()).enumerate() {
            row.iter_mut().for_each(|value| *value /= group.noise[place]);
        }
        values
    };
    groups.iter().map(of).collect()
}

/// Predictions with at least the least reach.
fn predicted_at_least(groups: &[&SeriesGroup], found: &Identified) -> Vec<Vec<f64>> {
    let mut described = found.described();
    described.reach_at_least(LEAST_REACH_ASKED);
    predicted(groups, &described, found)
}

/// What places do not have in common: at every time the part along the inverse noises is taken out, and of curvatures
/// what is constant over all times.
fn between(groups: &[&SeriesGroup], mut columns: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    for (group, column) in groups.iter().zip(&mut columns) {
        let times = group.time_s.len();
        if group.kind == Kind::Curvature {
            for row in column.chunks_exact_mut(times) {
                row.copy_from_slice(&about_mean(row));
            }
        }
        let common: Vec<f64> = group.noise.iter().map(|noise| noise.recip()).collect();
        let norm = square(&common);
        for time in 0..times {
            let part = common
                .iter()
                .enumerate()
                .map(|(place, c)| c * column[place * times + time])
                .sum::<f64>();
            for (place, c) in common.iter().enumerate() {
                column[place * times + time] -= c * part / norm;
            }
        }
    }
    columns
}

/// A column less what follows, at each place by its own factor, what all places have in common.
fn without_patterns(groups: &[&SeriesGroup], mut columns: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    for (group, column) in groups.iter().zip(&mut columns) {
        if group.kind != Kind::Curvature {
            continue;
        }
        let pattern = common(group);
        let norm = square(&pattern);
        for row in column.chunks_exact_mut(group.time_s.len()) {
            let part = if norm > 0.0 {
                dot(row, &pattern) / norm
            } else {
                0.0
            };
            add(row, -part, &pattern);
        }
    }
    columns
}

/// What all places of a group have in common over time, less its mean.
fn common(group: &SeriesGroup) -> Vec<f64> {
    let weights: Vec<f64> = group.noise.iter().map(|noise| noise.powi(-2)).collect();
    let total: f64 = weights.iter().sum();
    let pattern: Vec<f64> = (0..group.time_s.len())
        .map(|time| {
            let weighted = group
                .values
                .iter()
                .zip(&weights)
                .map(|(values, w)| values[time] * w);
            weighted.sum::<f64>() / total
        })
        .collect();
    about_mean(&pattern)
}
