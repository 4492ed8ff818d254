//! The search for a break of the electrodes.
//!
//! What a break at each of some places would add to the readings is asked of the residuals of the even strip, beside
//! what its refitted parameters take. The largest answer counts, and chance is asked for its largest answer over the
//! same places. Curvatures are asked for their course in time only: what each place adds for good, and a coupling of
//! its own, are taken out. Where the answer asks for it, factor and place are fitted with everything else.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{ChiSquared, Distribution, StandardNormal};

use ieap_numerics::sums::{about_mean, add, dot, square};
use ieap_numerics::symmetric::Symmetric;

use super::contact_break::ContactBreak;
use super::described::{self, Break, Described, electrical_parameters};
use super::estimates::tells_electrodes;
use super::identified::Identified;
use super::input::DistributedInput;
use super::jointly::parts;
use super::mechanical::Mechanical;
use super::policy::{BREAK_BELOW, BREAK_DRAWS, BREAK_FITTED_FROM, BREAK_PLACES, BREAK_SEED};
use super::readings::{Kind, Readings};
use super::squares::{Fitted, StripProblem, product, scatter};

/// Half of the step of differences in the logarithm of the factor.
const STEP: f64 = 0.05;
/// Looks for a break; what was identified is replaced where one is found.
pub(super) fn look(found: &mut Identified) {
    let several = found
        .readings
        .groups
        .iter()
        .any(|group| group.kind != Kind::Current && group.values.len() > 1);
    // Electrodes that cannot be told from perfect ones cannot be told to resist more from a place on.
    if !several || !tells_electrodes(found) {
        return;
    }
    if let Some((broken, electrical, mechanical)) = sought(found) {
        found.electrical = electrical;
        found.mechanical = mechanical;
        found.contact_break = Some(broken);
    }
}

type Found = (ContactBreak, Fitted, Option<Mechanical>);

fn sought(found: &Identified) -> Option<Found> {
    let (input, readings) = (&found.input, &found.readings);
    let scale = found.mechanical.as_ref().map(|m| m.scale);
    let mut at = found.electrical.at.clone();
    if let Some(mechanical) = &found.mechanical {
        at.extend(&mechanical.fitted.at);
    }
    let even = problem(input, readings, scale, at.len());
    let residuals = even.residuals(&at);
    let asked = Asked::new(&even, &at, &residuals);
    let directions: Vec<Vec<Vec<f64>>> = (1..=BREAK_PLACES)
        .map(|k| asked.beside(direction(&even, &at, k as f64 / (BREAK_PLACES + 1) as f64)))
        .collect();
    let plain: Vec<f64> = directions
        .iter()
        .map(|d| product(d, &residuals) / product(d, d).max(f64::MIN_POSITIVE).sqrt())
        .collect();
    let best = (0..BREAK_PLACES).max_by(|&a, &b| plain[a].abs().total_cmp(&plain[b].abs()))?;
    if plain[best].powi(2) < BREAK_FITTED_FROM {
        return None;
    }
    let share = (best + 1) as f64 / (BREAK_PLACES + 1) as f64;
    let fitted = search(input, readings, scale, &at, share, plain[best].signum());
    let rich = problem(input, readings, scale, fitted.at.len());
    let noise = rich.noise(&rich.residuals(&fitted.at));
    let scattered: Vec<Vec<Vec<f64>>> = directions.iter().map(|d| scatter(&noise, d)).collect();
    let sd: Vec<f64> = (0..BREAK_PLACES)
        .map(|k| {
            product(&directions[k], &scattered[k])
                .max(f64::MIN_POSITIVE)
                .sqrt()
        })
        .collect();
    let answers = (0..BREAK_PLACES).map(|k| (product(&directions[k], &residuals) / sd[k]).abs());
    let largest = answers.fold(0.0f64, f64::max);
    let alike = |a: usize, b: usize| product(&directions[a], &scattered[b]) / (sd[a] * sd[b]);
    let p = chance(largest, alike, fitted.freedom);
    let broken = ContactBreak {
        p,
        gain: even.square(&at) - fitted.square,
        length_cm: input.strip.length_cm,
        fitted,
    };
    if p >= BREAK_BELOW || broken.gain <= 0.0 || !broken.is_crack() {
        return None;
    }
    let electrical: Vec<usize> = (0..electrical_parameters(&input.strip)).collect();
    let (electrical, mechanical) = match scale {
        Some(scale) => {
            let (electrical, mechanical) = parts(input, readings, &broken.fitted, scale);
            (electrical, Some(mechanical))
        }
        None => (broken.fitted.part(&electrical), None),
    };
    Some((broken, electrical, mechanical))
}

/// All readings against what describes an even strip and, where there are two parameters more, a break.
fn problem<'a>(
    input: &'a DistributedInput<'a>,
    readings: &'a Readings,
    scale: Option<f64>,
    parameters: usize,
) -> StripProblem<'a> {
    let kinds: &[Kind] = match scale {
        Some(_) => &[Kind::Voltage, Kind::Current, Kind::Curvature],
        None => &[Kind::Voltage, Kind::Current],
    };
    StripProblem::new(input, readings, kinds, parameters, move |at| {
        describe(input, at, scale)
    })
}

fn describe(input: &DistributedInput, at: &[f64], scale: Option<f64>) -> Described {
    let strip = &input.strip;
    let mut described = match scale {
        Some(scale) => described::whole(strip, at, scale),
        None => described::electrical(strip, at),
    };
    let even = electrical_parameters(strip) + 2 * usize::from(scale.is_some());
    described.contact_break = at.get(even..even + 2).map(|broken| Break {
        factor: broken[0].exp(),
        place_cm: broken[1] * strip.length_cm,
    });
    described
}

/// What a weak break at that share of the length adds, over the noise.
fn direction(even: &StripProblem, at: &[f64], share: f64) -> Vec<Vec<f64>> {
    let with = |log: f64| {
        let mut at = at.to_vec();
        at.extend([log, share]);
        even.residuals(&at)
    };
    let (mut up, down) = (with(STEP), with(-STEP));
    for (up, down) in up.iter_mut().zip(&down) {
        up.iter_mut()
            .zip(down)
            .for_each(|(up, down)| *up = (down - *up) / (2.0 * STEP));
    }
    up
}

/// Searches factor and place with everything else, from both a weak and a strong break.
fn search(
    input: &DistributedInput,
    readings: &Readings,
    scale: Option<f64>,
    at: &[f64],
    share: f64,
    sign: f64,
) -> Fitted {
    let within = |problem: &StripProblem, start: &[f64]| {
        let mut bounds = problem.limits(start);
        let last = start.len() - 1;
        bounds.set(last - 1, -5.0, 5.0);
        bounds.set(last, 0.01, 0.99);
        problem.search_within(start, &bounds)
    };
    let coarse_readings = readings.thinned();
    let coarse = problem(input, &coarse_readings, scale, at.len() + 2);
    let from = |log: f64| {
        let mut start = at.to_vec();
        start.extend([log, share]);
        within(&coarse, &start)
    };
    let (weak, strong) = (from(0.4 * sign), from(1.5 * sign));
    let best = if weak.square <= strong.square {
        weak
    } else {
        strong
    };
    within(&problem(input, readings, scale, at.len() + 2), &best.at)
}

/// What is taken out of the residuals before they are asked: at each place of the curvatures a constant and the course
/// of the prediction there, then what the parameters of the even strip would take.
struct Asked {
    patterns: Vec<Option<Vec<f64>>>,
    times: Vec<usize>,
    slopes: Vec<Vec<Vec<f64>>>,
    inverse: Symmetric,
}

impl Asked {
    fn new(even: &StripProblem, at: &[f64], residuals: &[Vec<f64>]) -> Asked {
        debug_assert_eq!(residuals.len(), even.groups.len());
        let predicted = even.predicted(at);
        let groups = even.groups.iter().zip(predicted);
        let mut asked = Asked {
            patterns: groups
                .map(|(group, predicted)| (group.kind == Kind::Curvature).then_some(predicted))
                .collect(),
            times: even.groups.iter().map(|group| group.time_s.len()).collect(),
            slopes: Vec::new(),
            inverse: Symmetric::zero(0),
        };
        let slopes = even.slopes(at);
        asked.slopes = slopes
            .into_iter()
            .map(|slope| asked.without_patterns(slope))
            .collect();
        asked.inverse = even.inverse_normal(&asked.slopes);
        asked
    }

    /// A direction less all that is taken out.
    fn beside(&self, direction: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        let mut rest = self.without_patterns(direction);
        let along: Vec<f64> = self.slopes.iter().map(|slope| product(slope, &rest)).collect();
        for (row, slope) in self.slopes.iter().enumerate() {
            let part: f64 = (0..along.len())
                .map(|k| self.inverse.get(row, k) * along[k])
                .sum();
            for (rest, slope) in rest.iter_mut().zip(slope) {
                add(rest, -part, slope);
            }
        }
        rest
    }

    fn without_patterns(&self, mut column: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        for ((column, pattern), times) in column.iter_mut().zip(&self.patterns).zip(&self.times) {
            let Some(pattern) = pattern else { continue };
            for (row, pattern) in column.chunks_exact_mut(*times).zip(pattern.chunks_exact(*times)) {
                let shape = about_mean(pattern);
                row.copy_from_slice(&about_mean(row));
                let norm = square(&shape);
                let part = if norm > 0.0 { dot(row, &shape) / norm } else { 0.0 };
                add(row, -part, &shape);
            }
        }
        column
    }
}

/// Chance that the largest of answers with these correlations, their noise known with `freedom`, reaches `largest`.
fn chance(largest: f64, alike: impl Fn(usize, usize) -> f64, freedom: f64) -> f64 {
    let (values, vectors) = Symmetric::from_fn(BREAK_PLACES, alike).eigen();
    let factors: Vec<f64> = values.iter().map(|value| value.max(0.0).sqrt()).collect();
    let mut random = ChaCha8Rng::seed_from_u64(BREAK_SEED);
    let known = ChiSquared::new(freedom.max(1.0)).ok();
    let mut as_large = 1;
    for _ in 0..BREAK_DRAWS {
        let normal: Vec<f64> = factors
            .iter()
            .map(|factor| -> f64 {
                let drawn: f64 = StandardNormal.sample(&mut random);
                factor * drawn
            })
            .collect();
        let spread = known.map_or(1.0, |known| (known.sample(&mut random) / freedom.max(1.0)).sqrt());
        let answers = vectors.iter().map(|row| dot(row, &normal).abs());
        as_large += usize::from(answers.fold(0.0f64, f64::max) >= largest * spread);
    }
    as_large as f64 / (BREAK_DRAWS + 1) as f64
}
