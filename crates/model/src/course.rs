//! The voltage that makes a linear strip follow a wanted course within limits: the inverse of the models.
//!
//! Between samples the voltage is held. What a strip with the step response h does at the samples is then
//! `y_j = SUM_(k<=j) p_(j-k) V_k` with the pulse response `p_m = h((m+1) dt) - h(m dt)`: a triangular system, solved
//! from the front where no limit stands in the way. A strip that changes meanwhile answers every pulse in its own way. Where one does, the sum of squares within the limits is a quadratic
//! programme, whose interior is followed to its least (Mehrotra, SIAM Journal on Optimization 2, 575, 1992): the prices
//! of the limits, which the search finds beside the voltages, say what no course within them goes below.

use ieap_numerics::sums::{add, dot};
use ieap_numerics::symmetric::Symmetric;

/// What the source may do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VoltageLimits {
    /// Lowest voltage, V.
    pub lowest_v: f64,
    /// Highest voltage, V.
    pub highest_v: f64,
    /// Largest change from one sample to the next, V; infinite where it may jump.
    pub change_v: f64,
    /// Voltage before the first sample, V.
    pub from_v: f64,
}

impl VoltageLimits {
    /// The voltage nearest to `wanted_v` that may follow `before_v`.
    fn nearest(&self, wanted_v: f64, before_v: f64) -> f64 {
        let reached = wanted_v.clamp(before_v - self.change_v, before_v + self.change_v);
        reached.clamp(self.lowest_v, self.highest_v)
    }

    /// A course put within the limits from its front on.
    fn within(&self, course_v: &[f64]) -> Vec<f64> {
        let mut before = self.from_v;
        let next = |wanted: &f64| {
            before = self.nearest(*wanted, before);
            before
        };
        course_v.iter().map(next).collect()
    }
}

/// Rounds of the search: it takes about twenty.
const ROUNDS: usize = 60;
/// Part of the squares at the start by which what was found and what is possible may differ in the end.
const NEAR: f64 = 1e-10;
/// Part of the way to the nearest limit that a round goes.
const SHORT_OF: f64 = 0.995;
/// Weight of changes of the voltage against the squares: between courses that do equally well, the calmer one.
const CALM: f64 = 1e-9;

/// A course of the voltage, and what no other within the limits goes below.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// Voltages, one a sample.
    pub voltage_v: Vec<f64>,
    /// Sum of squared errors, each times its weight squared, below which no course within the limits comes.
    pub least_square: f64,
}

/// What is wanted at each sample, with the weight of an error there.
#[derive(Debug, Clone, Copy)]
pub struct WantedAt<'a> {
    /// Values.
    pub value: &'a [f64],
    /// Weights.
    pub weight: &'a [f64],
}

/// What a volt that is held in a sample does at it and at those after it, for every sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Pulses(Vec<Vec<f64>>);

impl Pulses {
    /// Of a strip that answers in every sample as in the first: as many samples as the answer has.
    pub fn alike(pulse: &[f64]) -> Pulses {
        Pulses(
            (0..pulse.len())
                .map(|k| pulse[..pulse.len() - k].to_vec())
                .collect(),
        )
    }

    /// The answer to each sample, which has a value for it and for each after it.
    pub fn of(answers: Vec<Vec<f64>>) -> Pulses {
        Pulses(answers)
    }

    /// At sample `j` by one that is no later.
    fn at(&self, j: usize, k: usize) -> f64 {
        self.0[k][j - k]
    }
}

/// Response at the samples to held voltages.
pub fn response(pulses: &Pulses, course_v: &[f64]) -> Vec<f64> {
    let at = |j: usize| (0..=j).map(|k| pulses.at(j, k) * course_v[k]).sum();
    (0..course_v.len()).map(at).collect()
}

/// Voltages, one a sample, whose response comes nearest to what is wanted; as many as there are wanted values.
///
/// `pulses` are of as many samples; at its own sample none of them is zero.
pub fn course(pulse: &Pulses, wanted: WantedAt, limits: &VoltageLimits) -> Course {
    let (greedy, is_free) = forward(pulse, wanted.value, limits);
    if is_free || greedy.is_empty() {
        return Course {
            voltage_v: greedy,
            least_square: 0.0,
        };
    }
    let (inside, least_square) = search(pulse, wanted, limits);
    let searched = limits.within(&inside);
    let voltage_v = if miss(pulse, wanted, &searched) < miss(pulse, wanted, &greedy) {
        searched
    } else {
        greedy
    };
    Course {
        least_square: least_square.clamp(0.0, miss(pulse, wanted, &voltage_v)),
        voltage_v,
    }
}

fn miss(pulse: &Pulses, wanted: WantedAt, course_v: &[f64]) -> f64 {
    let reached = response(pulse, course_v).into_iter();
    let pairs = reached.zip(wanted.value.iter().zip(wanted.weight));
    pairs
        .map(|(reached, (wanted, weight))| (weight * (reached - wanted)).powi(2))
        .sum()
}

/// Every sample's voltage from those before it, as near as the limits allow; whether none stood in the way.
fn forward(pulse: &Pulses, wanted: &[f64], limits: &VoltageLimits) -> (Vec<f64>, bool) {
    let (mut course_v, mut is_free) = (Vec::with_capacity(wanted.len()), true);
    let mut before = limits.from_v;
    for (j, wanted) in wanted.iter().enumerate() {
        let so_far: f64 = (0..j).map(|k| pulse.at(j, k) * course_v[k]).sum();
        let needed = (wanted - so_far) / pulse.at(j, j);
        let allowed = limits.nearest(needed, before);
        is_free &= (allowed - needed).abs() <= 1e-12 * needed.abs();
        course_v.push(allowed);
        before = allowed;
    }
    (course_v, is_free)
}

/// The limits as rows `G v <= h`: each voltage from above and from below, then its changes where these are limited.
struct Rows {
    samples: usize,
    most: Vec<f64>,
}

impl Rows {
    fn of(limits: &VoltageLimits, samples: usize) -> Rows {
        let mut most = vec![limits.highest_v; samples];
        most.extend(vec![-limits.lowest_v; samples]);
        if limits.change_v.is_finite() {
            for sign in [1.0, -1.0] {
                most.push(limits.change_v + sign * limits.from_v);
                most.extend(vec![limits.change_v; samples - 1]);
            }
        }
        Rows { samples, most }
    }

    fn steers(&self) -> bool {
        self.most.len() > 2 * self.samples
    }

    fn times(&self, v: &[f64]) -> Vec<f64> {
        let mut rows: Vec<f64> = v.to_vec();
        rows.extend(v.iter().map(|v| -v));
        if self.steers() {
            let change = |k: usize| v[k] - if k == 0 { 0.0 } else { v[k - 1] };
            rows.extend((0..v.len()).map(change));
            rows.extend((0..v.len()).map(|k| -change(k)));
        }
        rows
    }

    fn transposed(&self, y: &[f64]) -> Vec<f64> {
        let n = self.samples;
        let level = |k: usize| y[k] - y[n + k];
        let change = |k: usize| {
            if self.steers() && k < n {
                y[2 * n + k] - y[3 * n + k]
            } else {
                0.0
            }
        };
        (0..n).map(|k| level(k) + change(k) - change(k + 1)).collect()
    }

    /// `H + G' diag(w) G`.
    fn added_to(&self, squares: &Symmetric, w: &[f64]) -> Symmetric {
        let n = self.samples;
        let mut sum = squares.clone();
        let change = |k: usize| {
            if self.steers() && k < n {
                w[2 * n + k] + w[3 * n + k]
            } else {
                0.0
            }
        };
        for k in 0..n {
            sum.add(k, k, w[k] + w[n + k] + change(k) + change(k + 1));
            if k + 1 < n {
                sum.set(k, k + 1, sum.get(k, k + 1) - change(k + 1));
            }
        }
        sum
    }
}

/// `H = P' W^2 P` with the calm added.
fn squares(pulse: &Pulses, weight: &[f64]) -> Symmetric {
    let n = weight.len();
    let product = |a: usize, b: usize| -> f64 {
        (a.max(b)..n)
            .map(|j| weight[j] * weight[j] * pulse.at(j, a) * pulse.at(j, b))
            .sum()
    };
    let mut squares = Symmetric::from_fn(n, product);
    let calm = CALM * (0..n).map(|k| squares.get(k, k)).fold(0.0, f64::max);
    for k in 0..n {
        let is_last = k + 1 == n;
        squares.add(k, k, if is_last { calm } else { 2.0 * calm });
        if !is_last {
            squares.set(k, k + 1, squares.get(k, k + 1) - calm);
        }
    }
    squares
}

/// Voltages within the limits whose squares are least, and what is found to be possible at best.
fn search(pulse: &Pulses, wanted: WantedAt, limits: &VoltageLimits) -> (Vec<f64>, f64) {
    let n = wanted.value.len();
    let (squares, rows) = (squares(pulse, wanted.weight), Rows::of(limits, n));
    let weighed: Vec<f64> = wanted
        .weight
        .iter()
        .zip(wanted.value)
        .map(|(w, y)| w * w * y)
        .collect();
    let pull: Vec<f64> = (0..n).map(|k| dot(&pulse.0[k], &weighed[k..])).collect();
    let all: f64 = weighed.iter().zip(wanted.value).map(|(a, b)| a * b).sum();
    let mut v = vec![0.0; n];
    let largest = limits.highest_v.abs().max(limits.lowest_v.abs());
    let slack = |most: &f64| most.max(0.1 * largest);
    let mut room: Vec<f64> = rows.most.iter().map(slack).collect();
    let price = all.max(f64::MIN_POSITIVE) / (largest * n as f64);
    let mut prices = vec![price; rows.most.len()];
    let mut least = 0.0_f64;
    let own = squares.cholesky(0.0);
    for _ in 0..ROUNDS {
        let (towards, used) = (squares.times(&v), rows.times(&v));
        let priced = rows.transposed(&prices);
        let slope: Vec<f64> = (0..n).map(|k| towards[k] - pull[k] + priced[k]).collect();
        let over: Vec<f64> = (0..used.len())
            .map(|r| used[r] + room[r] - rows.most[r])
            .collect();
        let gap = dot(&room, &prices);
        let excess: f64 = (0..used.len())
            .map(|r| prices[r] * (used[r] - rows.most[r]))
            .sum();
        // What the prices say of all courses (weak duality): of the one that they would lead to.
        let possible = dot(&v, &towards) - 2.0 * dot(&v, &pull) + all + 2.0 * excess;
        if let Some(own) = &own {
            least = least.max(possible - dot(&slope, &own.solve(&slope)));
        }
        let is_within = over.iter().all(|over| over.abs() <= NEAR * largest);
        if is_within && 2.0 * gap <= NEAR * all {
            break;
        }
        let ratio: Vec<f64> = prices.iter().zip(&room).map(|(z, s)| z / s).collect();
        let Some(factor) = rows.added_to(&squares, &ratio).cholesky(0.0) else {
            break;
        };
        // A step that brings every product of room and price to what is asked.
        let step = |asked: &dyn Fn(usize) -> f64| {
            let drawn: Vec<f64> = (0..used.len())
                .map(|r| (asked(r) + prices[r] * over[r]) / room[r])
                .collect();
            let side: Vec<f64> = rows
                .transposed(&drawn)
                .iter()
                .zip(&slope)
                .map(|(d, s)| -s - d)
                .collect();
            let dv = factor.solve(&side);
            let moved = rows.times(&dv);
            let of_room: Vec<f64> = (0..used.len()).map(|r| -over[r] - moved[r]).collect();
            let of_prices: Vec<f64> = (0..used.len())
                .map(|r| (asked(r) - prices[r] * of_room[r]) / room[r])
                .collect();
            (dv, of_room, of_prices)
        };
        let (_, to_room, to_prices) = step(&|r| -room[r] * prices[r]);
        let far = reach(&room, &to_room).min(reach(&prices, &to_prices));
        let left: f64 = (0..used.len())
            .map(|r| (room[r] + far * to_room[r]) * (prices[r] + far * to_prices[r]))
            .sum();
        let kept = (left / gap).powi(3) * gap / used.len() as f64;
        let (dv, to_room, to_prices) = step(&|r| kept - room[r] * prices[r] - to_room[r] * to_prices[r]);
        let far = (SHORT_OF * reach(&room, &to_room).min(reach(&prices, &to_prices))).min(1.0);
        for (x, dx) in [(&mut v, &dv), (&mut room, &to_room), (&mut prices, &to_prices)] {
            add(x, far, dx);
        }
    }
    (v, least)
}

/// How much of a step keeps all values positive.
fn reach(values: &[f64], step: &[f64]) -> f64 {
    let pairs = values.iter().zip(step).filter(|(_, step)| **step < 0.0);
    pairs
        .map(|(value, step)| -value / step)
        .fold(1.0 / SHORT_OF, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LumpedModel;
    use ieap_domain::testing::branch;
    use ieap_domain::{Drive, Level, Segment};

    const EVERY_S: f64 = 2.0;
    const FREE: VoltageLimits = VoltageLimits {
        lowest_v: -100.0,
        highest_v: 100.0,
        change_v: f64::INFINITY,
        from_v: 0.0,
    };

    /// CNaf in air at 2 V, thesis table 5.
    fn cnaf() -> LumpedModel {
        LumpedModel {
            branches: vec![branch(521.4, 0.098), branch(2629.9, 0.13)],
            steady_state_resistance_ohm_cm2: 5660.0,
            charge_to_curvature_per_c_cm: 13.88,
            relaxation_rate_per_s: 3.8e-4,
        }
    }

    fn even(wanted: &[f64]) -> (&[f64], Vec<f64>) {
        (wanted, vec![1.0; wanted.len()])
    }

    fn course(pulse: &Pulses, (value, weight): (&[f64], Vec<f64>), limits: &VoltageLimits) -> Course {
        let weight = &weight;
        super::course(pulse, WantedAt { value, weight }, limits)
    }

    fn miss(pulse: &Pulses, value: &[f64], course_v: &[f64]) -> f64 {
        let weight = &vec![1.0; value.len()];
        super::miss(pulse, WantedAt { value, weight }, course_v)
    }

    fn times(samples: usize) -> Vec<f64> {
        (1..=samples).map(|k| EVERY_S * k as f64).collect()
    }

    fn pulse(samples: usize) -> Pulses {
        let step = cnaf().curvature_per_cm(&Drive::step(1.0), 0.1, &times(samples));
        let before = std::iter::once(0.0).chain(step.iter().copied());
        let pulse = step.iter().zip(before).map(|(now, before)| now - before);
        Pulses::alike(&pulse.collect::<Vec<f64>>())
    }

    fn simulated(course_v: &[f64]) -> Vec<f64> {
        let segment = |(k, volts): (usize, &f64)| Segment::at(EVERY_S * k as f64, Level::Voltage(*volts));
        let drive = Drive {
            baseline_v: 0.0,
            segments: course_v.iter().enumerate().map(segment).collect(),
        };
        cnaf().curvature_per_cm(&drive, 0.1, &times(course_v.len()))
    }

    #[test]
    fn pulses_add_up_to_what_the_model_does() {
        let course_v: Vec<f64> = (0..60).map(|k| (0.1 * f64::from(k)).sin()).collect();
        for (a, b) in response(&pulse(60), &course_v).iter().zip(simulated(&course_v)) {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
    }

    #[test]
    fn a_course_without_limits_is_reached_at_every_sample() {
        let wanted: Vec<f64> = times(100)
            .iter()
            .map(|t| 0.05 * (t / 40.0).sin() + 2e-4 * t)
            .collect();
        let found = course(&pulse(100), even(&wanted), &FREE);
        for (reached, wanted) in simulated(&found.voltage_v).iter().zip(&wanted) {
            assert!((reached - wanted).abs() < 1e-10, "{reached} {wanted}");
        }
    }

    #[test]
    fn limits_hold_exactly_and_no_course_near_by_does_better() {
        let samples = 80;
        let limits = VoltageLimits {
            lowest_v: -1.0,
            highest_v: 1.2,
            change_v: 0.1,
            from_v: 0.0,
        };
        // A jump, a rest and a jump back: what limits of the slope make a forward course overshoot.
        let wanted: Vec<f64> = (0..samples).map(|k| if k < 40 { 0.04 } else { 0.0 }).collect();
        let pulse = pulse(samples);
        let Course {
            voltage_v: found,
            least_square,
        } = course(&pulse, even(&wanted), &limits);
        let (greedy, is_free) = forward(&pulse, &wanted, &limits);
        assert!(!is_free);
        let mut before = 0.0;
        for volts in &found {
            assert!((-1.0..=1.2).contains(volts) && (volts - before).abs() <= 0.1 + 1e-12);
            before = *volts;
        }
        let best = miss(&pulse, &wanted, &found);
        assert!(best < 0.9 * miss(&pulse, &wanted, &greedy), "{best}");
        // What the prices of the limits say is possible is reached.
        assert!(
            least_square <= best && best - least_square < 1e-7 * best,
            "{best} {least_square}"
        );
        // Bumps of every place and width that the limits allow do not lower it.
        for start in 0..samples {
            for width in [1, 3, 10, 30] {
                for height in [-0.02, 0.02] {
                    let bumped = |(k, volts): (usize, &f64)| {
                        volts
                            + if (start..start + width).contains(&k) {
                                height
                            } else {
                                0.0
                            }
                    };
                    let bumped: Vec<f64> = found.iter().enumerate().map(bumped).collect();
                    let other = miss(&pulse, &wanted, &limits.within(&bumped));
                    assert!(
                        other > (1.0 - 1e-7) * best,
                        "{start} {width} {height}: {other} {best}"
                    );
                }
            }
        }
    }

    /// Against projected gradients, which know nothing of prices: from any start they end at the same squares.
    #[test]
    fn weights_count_and_another_search_ends_at_the_same_squares() {
        let samples = 40;
        let limits = VoltageLimits {
            lowest_v: -1.2,
            highest_v: 1.2,
            ..FREE
        };
        let pulse = pulse(samples);
        let wanted: Vec<f64> = (0..samples).map(|k| if k < 20 { 0.06 } else { -0.01 }).collect();
        let weight: Vec<f64> = (0..samples).map(|k| 1.0 + 0.1 * k as f64).collect();
        let found = course(&pulse, (&wanted, weight.clone()), &limits);
        let asked = WantedAt {
            value: &wanted,
            weight: &weight,
        };
        let squares = squares(&pulse, &weight);
        let most: f64 = (0..samples)
            .map(|a| (0..samples).map(|b| squares.get(a, b).abs()).sum::<f64>())
            .fold(0.0, f64::max);
        let mut v = vec![0.0; samples];
        for _ in 0..200_000 {
            let reached = response(&pulse, &v);
            let off: Vec<f64> = (0..samples)
                .map(|j| weight[j] * weight[j] * (reached[j] - wanted[j]))
                .collect();
            let slope = |k: usize| dot(&pulse.0[k], &off[k..]);
            v = (0..samples)
                .map(|k| (v[k] - slope(k) / most).clamp(-1.2, 1.2))
                .collect();
        }
        let (here, there) = (
            super::miss(&pulse, asked, &found.voltage_v),
            super::miss(&pulse, asked, &v),
        );
        assert!(here > 0.0 && (here / there - 1.0).abs() < 1e-5, "{here} {there}");
        assert!(
            found.least_square <= there * (1.0 + 1e-9),
            "{} {there}",
            found.least_square
        );
    }
}
