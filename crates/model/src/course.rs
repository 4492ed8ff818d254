//! The voltage that makes a linear strip follow a wanted course within limits: the inverse of the models.
//!
//! Between samples the voltage is held. What a strip with the step response h does at the samples is then
//! `y_j = SUM_(k<=j) p_(j-k) V_k` with the pulse response `p_m = h((m+1) dt) - h(m dt)`: a triangular system, solved
//! from the front where no limit stands in the way. Where one does, the sum of squares is lowered within the limits by
//! the alternating direction method of multipliers (Boyd et al., Foundations and Trends in Machine Learning 3, 1,
//! 2010), and the result put exactly within them.

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

/// Rounds of the search, and how near to the wanted course it stops, as a share of what the largest voltage does.
const ROUNDS: usize = 3000;
const NEAR: f64 = 1e-9;
/// Weight of the limits against the squares, both made comparable by the largest diagonal entry.
const PENALTY: f64 = 0.5;
/// Weight of changes of the voltage against the squares: between courses that do equally well, the calmer one.
const CALM: f64 = 1e-9;

/// Response at the samples to held voltages.
pub fn response(pulse: &[f64], course_v: &[f64]) -> Vec<f64> {
    let at = |j: usize| (0..=j).map(|k| pulse[j - k] * course_v[k]).sum();
    (0..course_v.len()).map(at).collect()
}

/// Voltages, one a sample, whose response comes nearest to `wanted`; as many as there are wanted values.
///
/// `pulse` has at least as many values, the first of them not zero.
pub fn course(pulse: &[f64], wanted: &[f64], limits: &VoltageLimits) -> Vec<f64> {
    let (greedy, is_free) = forward(pulse, wanted, limits);
    if is_free || wanted.is_empty() {
        return greedy;
    }
    let searched = limits.within(&search(pulse, wanted, limits, &greedy));
    match miss(pulse, wanted, &searched) < miss(pulse, wanted, &greedy) {
        true => searched,
        false => greedy,
    }
}

fn miss(pulse: &[f64], wanted: &[f64], course_v: &[f64]) -> f64 {
    let pairs = response(pulse, course_v).into_iter().zip(wanted);
    pairs.map(|(reached, wanted)| (reached - wanted).powi(2)).sum()
}

/// Every sample's voltage from those before it, as near as the limits allow; whether none stood in the way.
fn forward(pulse: &[f64], wanted: &[f64], limits: &VoltageLimits) -> (Vec<f64>, bool) {
    let (mut course_v, mut is_free) = (Vec::with_capacity(wanted.len()), true);
    let mut before = limits.from_v;
    for (j, wanted) in wanted.iter().enumerate() {
        let so_far: f64 = (0..j).map(|k| pulse[j - k] * course_v[k]).sum();
        let needed = (wanted - so_far) / pulse[0];
        let allowed = limits.nearest(needed, before);
        is_free &= (allowed - needed).abs() <= 1e-12 * needed.abs();
        course_v.push(allowed);
        before = allowed;
    }
    (course_v, is_free)
}

fn search(pulse: &[f64], wanted: &[f64], limits: &VoltageLimits, start: &[f64]) -> Vec<f64> {
    let n = wanted.len();
    let column = |k: usize, j: usize| if j >= k { pulse[j - k] } else { 0.0 };
    let product = |a: usize, b: usize| -> f64 { (a.max(b)..n).map(|j| column(a, j) * column(b, j)).sum() };
    let mut normal: Vec<Vec<f64>> = (0..n).map(|a| (0..n).map(|b| product(a, b)).collect()).collect();
    let scale = (0..n).map(|k| normal[k][k]).fold(0.0, f64::max);
    let weight = PENALTY * scale;
    let steered = limits.change_v.is_finite();
    // Limits on the voltages, and on their changes: D v has v_0 first.
    for k in 0..n {
        let last = k + 1 == n;
        let changes = if last { 1.0 } else { 2.0 };
        let of_changes = CALM * scale + if steered { weight } else { 0.0 };
        normal[k][k] += weight + of_changes * changes;
        if !last {
            normal[k][k + 1] -= of_changes;
            normal[k + 1][k] -= of_changes;
        }
    }
    let factor = cholesky(normal);
    let right: Vec<f64> = (0..n)
        .map(|k| (k..n).map(|j| pulse[j - k] * wanted[j]).sum())
        .collect();
    let difference = |v: &[f64], k: usize| v[k] - if k == 0 { 0.0 } else { v[k - 1] };
    let mut v = start.to_vec();
    let mut level = v.clone();
    let mut change: Vec<f64> = (0..n).map(|k| difference(&v, k)).collect();
    let (mut level_dual, mut change_dual) = (vec![0.0; n], vec![0.0; n]);
    let largest = limits.highest_v.abs().max(limits.lowest_v.abs());
    for _ in 0..ROUNDS {
        let push: Vec<f64> = (0..n).map(|k| change[k] - change_dual[k]).collect();
        let of_change = |k: usize| push[k] - if k + 1 < n { push[k + 1] } else { 0.0 };
        let side: Vec<f64> = (0..n)
            .map(|k| {
                let steering = if steered { of_change(k) } else { 0.0 };
                right[k] + weight * (level[k] - level_dual[k] + steering)
            })
            .collect();
        v = solve(&factor, side);
        // Settled where the voltages are within their limits and the limited ones have ceased to move.
        let (mut apart, before) = (0.0_f64, level.clone());
        for k in 0..n {
            level[k] = (v[k] + level_dual[k]).clamp(limits.lowest_v, limits.highest_v);
            level_dual[k] += v[k] - level[k];
            apart = apart
                .max((v[k] - level[k]).abs())
                .max((level[k] - before[k]).abs());
            if steered {
                let now = difference(&v, k);
                let from = if k == 0 { limits.from_v } else { 0.0 };
                change[k] = (now + change_dual[k]).clamp(from - limits.change_v, from + limits.change_v);
                change_dual[k] += now - change[k];
                apart = apart.max((now - change[k]).abs());
            }
        }
        if apart <= NEAR * largest {
            break;
        }
    }
    v
}

/// Lower factor of a positive definite matrix, in its own place.
fn cholesky(mut matrix: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    for row in 0..matrix.len() {
        for column in 0..=row {
            let dot: f64 = (0..column).map(|k| matrix[row][k] * matrix[column][k]).sum();
            let rest = matrix[row][column] - dot;
            matrix[row][column] = match row == column {
                true => rest.max(f64::MIN_POSITIVE).sqrt(),
                false => rest / matrix[column][column],
            };
        }
    }
    matrix
}

fn solve(factor: &[Vec<f64>], mut x: Vec<f64>) -> Vec<f64> {
    let n = x.len();
    for row in 0..n {
        let dot: f64 = (0..row).map(|k| factor[row][k] * x[k]).sum();
        x[row] = (x[row] - dot) / factor[row][row];
    }
    for row in (0..n).rev() {
        let dot: f64 = (row + 1..n).map(|k| factor[k][row] * x[k]).sum();
        x[row] = (x[row] - dot) / factor[row][row];
    }
    x
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

    fn times(samples: usize) -> Vec<f64> {
        (1..=samples).map(|k| EVERY_S * k as f64).collect()
    }

    fn pulse(samples: usize) -> Vec<f64> {
        let step = cnaf().curvature_per_cm(&Drive::step(1.0), 0.1, &times(samples));
        let before = std::iter::once(0.0).chain(step.iter().copied());
        step.iter()
            .zip(before)
            .map(|(now, before)| now - before)
            .collect()
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
        let found = course(&pulse(100), &wanted, &FREE);
        for (reached, wanted) in simulated(&found).iter().zip(&wanted) {
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
        let found = course(&pulse, &wanted, &limits);
        let (greedy, is_free) = forward(&pulse, &wanted, &limits);
        assert!(!is_free);
        let mut before = 0.0;
        for volts in &found {
            assert!((-1.0..=1.2).contains(volts) && (volts - before).abs() <= 0.1 + 1e-12);
            before = *volts;
        }
        let best = miss(&pulse, &wanted, &found);
        assert!(best < 0.9 * miss(&pulse, &wanted, &greedy), "{best}");
        // Bumps of every place and width that the limits allow do not lower it by more than a thousandth.
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
                    assert!(other > 0.999 * best, "{start} {width} {height}: {other} {best}");
                }
            }
        }
    }
}
