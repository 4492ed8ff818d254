//! Noise of a channel without the circuit: size, memory, growth with the signal, steps of the converter.
//!
//! The smooth part is a free sum of exponentials (of either sign, spread over the record), which follows any
//! relaxation; what it leaves is judged by restricted likelihood, so that the smooth part costs no bias.

use crate::fit::sampled::{Sampled, Span};

use super::dense::Dense;
use super::whitening::{Memory, Whitener, innovation_share};

/// Correlations tried by reading order, and correlation times.
const CORRELATIONS: usize = 60;
const TIMES: usize = 12;
/// Exponentials of the smooth part per segment, at most, and the closest they lie in the logarithm of time.
const SHAPES: usize = 16;
const CLOSEST: f64 = 0.6;
/// Twice the gain in log likelihood that a further property of the noise must bring, beside BIC.
const EVIDENCE: f64 = 6.0;
/// Readings from which orders above one are looked at.
const ENOUGH_FOR_ORDER: usize = 300;

/// Noise of one channel.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::fit) struct Noise {
    /// Standard deviation of every reading.
    pub(in crate::fit) sd: Vec<f64>,
    /// Standard deviation where the signal is zero.
    pub(in crate::fit) floor: f64,
    /// Part of the standard deviation that goes with the signal, per signal; 0 for even noise.
    pub(in crate::fit) proportional: f64,
    /// Memory.
    pub(in crate::fit) memory: Memory,
    /// Step of the converter, 0 where none is seen.
    pub(in crate::fit) quantum: f64,
    /// Degrees of freedom that the size of slow noise is known with.
    pub(in crate::fit) freedom: f64,
}

impl Noise {
    /// Noise of the readings; never below `least`, the size of rounding.
    pub(in crate::fit) fn of(sampled: &Sampled, least: f64) -> Noise {
        let smooth = Smooth::of(sampled);
        let quantum = quantum(&sampled.values);
        let least = least.max(quantum / 12.0_f64.sqrt()).max(f64::MIN_POSITIVE);
        let shape = growth(&smooth, sampled);
        let (memory, floor, terms) = smooth.memory(sampled, &shape.scale);
        let floor = floor.max(least);
        let n = sampled.len() as f64;
        let (shortest_s, _) = sampled.time_scales_s();
        let crowding = memory.readings_per_independent(shortest_s).max(1.0);
        // The logarithm of slow noise's variance is known to 2/n from its size and, the correlation being
        // known to (1-rho2)/n, to 4 (1+rho)/(1-rho)/n from its memory.
        let from_size = (n - terms).max(1.0);
        let freedom = if memory == Memory::Order(Vec::new()) {
            from_size
        } else {
            from_size / (1.0 + 2.0 * crowding)
        };
        Noise {
            sd: shape.scale.iter().map(|scale| floor * scale).collect(),
            floor,
            proportional: floor * shape.per_signal,
            memory,
            quantum,
            freedom: freedom.max(1.0),
        }
    }

    /// The whitener that belongs to it.
    pub(in crate::fit) fn whitener(&self, sampled: &Sampled) -> Whitener {
        Whitener::new(sampled, &self.sd, &self.memory)
    }
}

/// Step of the converter: the readings are whole multiples of it and few levels are taken; 0 where they are not.
fn quantum(values: &[f64]) -> f64 {
    let mut levels: Vec<f64> = values.to_vec();
    levels.sort_unstable_by(f64::total_cmp);
    let span = levels
        .last()
        .zip(levels.first())
        .map_or(0.0, |(last, first)| last - first);
    let gaps: Vec<f64> = levels
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|gap| *gap > 1e-12 * span)
        .collect();
    // Free values hardly ever repeat: a converter's step shows where most readings share their level.
    if gaps.len() * 3 > values.len() * 2 || gaps.is_empty() {
        return 0.0;
    }
    let least = gaps.iter().copied().fold(f64::INFINITY, f64::min);
    let whole =
        |gap: &f64| (gap / least - (gap / least).round()).abs() < 0.02 * (gap / least).clamp(1.0, 20.0);
    if gaps.iter().all(whole) { least } else { 0.0 }
}

/// Orthonormal smooth shapes per span, and what they leave.
struct Smooth {
    shapes: Vec<Vec<Vec<f64>>>,
    level: Vec<f64>,
    rest: Vec<f64>,
}

impl Smooth {
    fn of(sampled: &Sampled) -> Smooth {
        let mut smooth = Smooth {
            shapes: Vec::new(),
            level: vec![0.0; sampled.len()],
            rest: sampled.values.to_vec(),
        };
        for span in &sampled.spans {
            let elapsed_s = &sampled.elapsed_s[span.first..span.end];
            let shapes = if span.segment.is_some() {
                shapes(elapsed_s)
            } else {
                orthonormal(vec![vec![1.0; elapsed_s.len()]])
            };
            let rest = &mut smooth.rest[span.first..span.end];
            let level = &mut smooth.level[span.first..span.end];
            for shape in &shapes {
                let part = inner(shape, rest);
                for ((rest, level), s) in rest.iter_mut().zip(level.iter_mut()).zip(shape) {
                    *rest -= part * s;
                    *level += part * s;
                }
            }
            smooth.shapes.push(shapes);
        }
        smooth
    }

    fn terms(&self) -> f64 {
        self.shapes.iter().map(Vec::len).sum::<usize>() as f64
    }

    /// Minus twice the restricted log likelihood of that memory, with the best size of the noise.
    fn deviance(&self, sampled: &Sampled, scale: &[f64], memory: &Memory) -> (f64, f64) {
        let whitener = Whitener::new(sampled, scale, memory);
        let mut square = 0.0;
        let mut determinant = whitener.log_determinant(sampled);
        for (span, shapes) in sampled.spans.iter().zip(&self.shapes) {
            let white = |column: &[f64]| {
                let mut column = column.to_vec();
                whitener.whiten(span, &mut column);
                column
            };
            let columns: Vec<Vec<f64>> = shapes.iter().map(|shape| white(shape)).collect();
            let rest = white(&self.rest[span.first..span.end]);
            let mut normal = Dense::zero(columns.len());
            for (a, left) in columns.iter().enumerate() {
                for (b, right) in columns[..=a].iter().enumerate() {
                    let product = inner(left, right);
                    normal.add(a, b, product);
                    if a != b {
                        normal.add(b, a, product);
                    }
                }
            }
            let right: Vec<f64> = columns.iter().map(|column| inner(column, &rest)).collect();
            let solved = normal.solve(&right, 1e-14);
            square += inner(&rest, &rest) - inner(&right, &solved);
            determinant += normal.log_determinant();
        }
        let freedom = (sampled.len() as f64 - self.terms()).max(1.0);
        let variance = (square / freedom).max(f64::MIN_POSITIVE);
        (freedom * variance.ln() + determinant, variance)
    }

    /// The memory that the rest shows, the standard deviation, and the smooth terms.
    fn memory(&self, sampled: &Sampled, scale: &[f64]) -> (Memory, f64, f64) {
        let white = Memory::Order(Vec::new());
        let mut best = (self.deviance(sampled, scale, &white), white);
        let unit: f64 = self.rest.iter().map(|r| r * r).sum();
        let freedom = sampled.len() as f64 - self.terms();
        if freedom < 4.0 || unit <= 0.0 {
            return (best.1, best.0.1.sqrt(), self.terms());
        }
        let by_order = |x: f64| Memory::Order(vec![x.tanh()]);
        let (shortest_s, longest_s) = sampled.time_scales_s();
        let is_even = sampled.blocks.iter().all(|(_, block)| block.step_s.is_some());
        let lagged = self.lagged(sampled, scale);
        let of_order = |x: f64| self.deviance_of(&lagged, x.tanh());
        best = search(best, (-0.7, 3.4, CORRELATIONS), by_order, of_order);
        if !is_even && shortest_s > 0.0 && shortest_s < longest_s {
            let span = (longest_s / shortest_s / 4.0).max(2.0).ln();
            let by_time = |x: f64| Memory::Time {
                correlation_time_s: shortest_s * (span * x).exp() / 2.0,
            };
            let of_time = |x: f64| self.deviance(sampled, scale, &by_time(x));
            best = search(best, (0.0, 1.0, TIMES), by_time, of_time);
        }
        if sampled.len() >= ENOUGH_FOR_ORDER && matches!(best.1, Memory::Order(_)) {
            best = self.higher_orders(sampled, scale, best);
        }
        (best.1, best.0.1.sqrt(), self.terms())
    }

    /// Products of the scaled shapes and rest with each other, at the same reading and at neighbours.
    fn lagged(&self, sampled: &Sampled, scale: &[f64]) -> Lagged {
        let scaled = |column: &[f64], span: &Span| -> Vec<f64> {
            column
                .iter()
                .zip(&scale[span.first..span.end])
                .map(|(v, s)| v / s)
                .collect()
        };
        let mut lagged = Lagged {
            spans: Vec::new(),
            readings: sampled.len() as f64,
            determinant: scale.iter().map(|s| 2.0 * s.ln()).sum(),
        };
        for (span, shapes) in sampled.spans.iter().zip(&self.shapes) {
            let mut columns: Vec<Vec<f64>> = shapes.iter().map(|shape| scaled(shape, span)).collect();
            columns.push(scaled(&self.rest[span.first..span.end], span));
            let last = span.end - span.first - 1;
            let mut products = [(); 4].map(|()| Dense::zero(columns.len()));
            for (a, x) in columns.iter().enumerate() {
                for (b, y) in columns[..=a].iter().enumerate() {
                    let later = inner(&x[1..], &y[1..]);
                    let ends = x[0] * y[0] - x[last] * y[last];
                    let across = inner(&x[1..], &y[..last]) + inner(&x[..last], &y[1..]);
                    for (product, value) in
                        products
                            .iter_mut()
                            .zip([x[0] * y[0], later, later + ends, across])
                    {
                        product.add(a, b, value);
                        if a != b {
                            product.add(b, a, value);
                        }
                    }
                }
            }
            lagged.spans.push((products, last as f64));
        }
        lagged
    }

    /// As [`Smooth::deviance`] for a first-order autoregression by reading order, from sums made before.
    fn deviance_of(&self, lagged: &Lagged, rho: f64) -> (f64, f64) {
        let new = 1.0 - rho * rho;
        let mut square = 0.0;
        let mut determinant = lagged.determinant;
        for ([first, later, earlier, both], pairs) in &lagged.spans {
            let white = |a: usize, b: usize| {
                let after = later.get(a, b) + rho * rho * earlier.get(a, b) - rho * both.get(a, b);
                first.get(a, b) + after / new
            };
            let count = first.order() - 1;
            let mut normal = Dense::zero(count);
            for a in 0..count {
                for b in 0..count {
                    normal.add(a, b, white(a, b));
                }
            }
            let right: Vec<f64> = (0..count).map(|a| white(a, count)).collect();
            let solved = normal.solve(&right, 1e-14);
            square += white(count, count) - inner(&right, &solved);
            determinant += normal.log_determinant() + pairs * new.ln();
        }
        let freedom = (lagged.readings - self.terms()).max(1.0);
        let variance = (square / freedom).max(f64::MIN_POSITIVE);
        (freedom * variance.ln() + determinant, variance)
    }

    /// Orders two and three where BIC asks for them.
    fn higher_orders(&self, sampled: &Sampled, scale: &[f64], first: Candidate) -> Candidate {
        let mut best = first;
        let penalty = (sampled.len() as f64).ln().max(EVIDENCE);
        let lags = self.autocovariances(sampled, scale, &best.1);
        for order in 2..=3 {
            let Some(coefficients) = yule_walker(&lags[..=order]) else {
                break;
            };
            let memory = Memory::Order(coefficients);
            let found = self.deviance(sampled, scale, &memory);
            if found.0 + penalty < best.0.0 {
                best = (found, memory);
            }
        }
        best
    }

    /// Autocovariances of the scaled rest up to lag 3, put right for the slow part that the shapes removed.
    fn autocovariances(&self, sampled: &Sampled, scale: &[f64], memory: &Memory) -> [f64; 4] {
        let n = sampled.len() as f64;
        let rest: Vec<f64> = self.rest.iter().zip(scale).map(|(r, s)| r / s).collect();
        let lag = |lag: usize| {
            let of_span = |span: &Span| {
                let values = &rest[span.first..span.end];
                values
                    .iter()
                    .zip(values.iter().skip(lag))
                    .map(|(a, b)| a * b)
                    .sum::<f64>()
            };
            sampled.spans.iter().map(of_span).sum::<f64>() / n
        };
        let removed = self.terms() / n * memory.readings_per_independent(1.0);
        let variance = lag(0) / (1.0 - removed.min(0.5));
        std::array::from_fn(|k| lag(k) + removed.min(0.5) * variance)
    }
}

/// Sums from which the likelihood of any first-order autoregression follows.
struct Lagged {
    /// Per span the products at the first reading, at later ones, at those before them, and across; and the
    /// number of pairs of neighbours.
    spans: Vec<([Dense; 4], f64)>,
    readings: f64,
    determinant: f64,
}

/// A deviance with the variance of the noise, and the memory they belong to.
type Candidate = ((f64, f64), Memory);

/// The best memory along a line of them: a look at evenly spaced ones, then a parabola through the best three.
///
/// Memory costs one parameter and is taken even on weak evidence: leaving it out makes intervals too short,
/// while taking it in vain costs next to nothing.
fn search(
    best: Candidate,
    (low, high, count): (f64, f64, usize),
    memory: impl Fn(f64) -> Memory,
    deviance: impl Fn(f64) -> (f64, f64),
) -> Candidate {
    let step = (high - low) / count as f64;
    let looked: Vec<f64> = (0..=count).map(|k| deviance(low + step * k as f64).0).collect();
    let least = (0..looked.len())
        .min_by(|&a, &b| looked[a].total_cmp(&looked[b]))
        .unwrap_or(0);
    let mut x = low + step * least as f64;
    if least > 0 && least < count {
        let [a, b, c] = [looked[least - 1], looked[least], looked[least + 1]];
        let bend = a - 2.0 * b + c;
        if bend > 0.0 {
            x += step * 0.5 * (a - c) / bend;
        }
    }
    let found = deviance(x);
    if found.0 < best.0.0 {
        (found, memory(x))
    } else {
        best
    }
}

/// Coefficients of the autoregression with those autocovariances; none where it would not be stationary.
fn yule_walker(lags: &[f64]) -> Option<Vec<f64>> {
    let mut coefficients: Vec<f64> = Vec::new();
    let mut variance = lags[0];
    for k in 1..lags.len() {
        let known: f64 = coefficients
            .iter()
            .enumerate()
            .map(|(j, a)| a * lags[k - 1 - j])
            .sum();
        let partial = (lags[k] - known) / variance;
        if partial.is_nan() || partial.abs() >= 0.98 {
            return None;
        }
        let turned: Vec<f64> = coefficients.iter().rev().copied().collect();
        coefficients
            .iter_mut()
            .zip(turned)
            .for_each(|(a, b)| *a -= partial * b);
        coefficients.push(partial);
        variance *= 1.0 - partial * partial;
    }
    (coefficients.iter().sum::<f64>() < 0.985 && innovation_share(&coefficients) > 0.0)
        .then_some(coefficients)
}

/// How the noise grows with the signal.
struct Growth {
    /// Standard deviation of every reading in units of that at signal zero.
    scale: Vec<f64>,
    per_signal: f64,
}

/// Even noise unless the likelihood asks for `sqrt(1 + (b signal)^2)`.
fn growth(smooth: &Smooth, sampled: &Sampled) -> Growth {
    let n = sampled.len() as f64;
    let peak = smooth.level.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let even = Growth {
        scale: vec![1.0; sampled.len()],
        per_signal: 0.0,
    };
    if n < 100.0 || peak <= 0.0 {
        return even;
    }
    let scale = |b: f64| -> Vec<f64> {
        let ratio = |level: &f64| (1.0 + (b * level / peak).powi(2)).sqrt();
        smooth.level.iter().map(ratio).collect()
    };
    let deviance = |scale: &[f64]| {
        let square: f64 = smooth.rest.iter().zip(scale).map(|(r, s)| (r / s).powi(2)).sum();
        n * (square / n).max(f64::MIN_POSITIVE).ln() + scale.iter().map(|s| 2.0 * s.ln()).sum::<f64>()
    };
    let memory = smooth.memory_of_rest(sampled);
    let (mut best, mut chosen) = (deviance(&even.scale) - (n.ln() + EVIDENCE) * memory, even);
    for power in -2..=12 {
        let b = 2.0_f64.powf(f64::from(power) / 2.0);
        let scale = scale(b);
        let found = deviance(&scale);
        if found < best {
            best = found;
            chosen = Growth {
                scale,
                per_signal: b / peak,
            };
        }
    }
    chosen
}

impl Smooth {
    /// Readings per independent one, from the lag-1 correlation of the rest: what evidence must be divided by.
    fn memory_of_rest(&self, sampled: &Sampled) -> f64 {
        let lags = self.autocovariances(sampled, &vec![1.0; sampled.len()], &Memory::Order(Vec::new()));
        let rho = if lags[0] > 0.0 {
            (lags[1] / lags[0]).clamp(0.0, 0.95)
        } else {
            0.0
        };
        (1.0 + rho * rho) / (1.0 - rho * rho)
    }
}

/// A constant and exponentials whose time constants are spread over the segment.
fn shapes(elapsed_s: &[f64]) -> Vec<Vec<f64>> {
    let n = elapsed_s.len();
    let longest_s = elapsed_s.last().copied().unwrap_or(0.0);
    let step_s = elapsed_s
        .windows(3)
        .map(|three| (three[2] - three[0]) / 2.0)
        .fold(f64::INFINITY, f64::min);
    let mut columns = vec![vec![1.0; n]];
    if n >= 6 && longest_s > 0.0 && step_s > 0.0 {
        let (fast, slow) = ((step_s * 2.0).ln(), (longest_s / 1.5).ln());
        let room = ((slow - fast) / CLOSEST).max(0.0) as usize + 1;
        let count = (n / 8).min(room).clamp(2, SHAPES);
        for k in 0..count {
            let tau_s = (slow + (fast - slow) * k as f64 / (count - 1) as f64).exp();
            columns.push(elapsed_s.iter().map(|t| (-t / tau_s).exp()).collect());
        }
    }
    orthonormal(columns)
}

/// Gram and Schmidt, twice; dependent columns fall out.
fn orthonormal(columns: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let mut found: Vec<Vec<f64>> = Vec::new();
    for mut column in columns {
        let before = inner(&column, &column).sqrt();
        for _ in 0..2 {
            for shape in &found {
                let part = inner(shape, &column);
                column.iter_mut().zip(shape).for_each(|(c, s)| *c -= part * s);
            }
        }
        let norm = inner(&column, &column).sqrt();
        if norm > 1e-6 * before && norm.is_finite() {
            column.iter_mut().for_each(|c| *c /= norm);
            found.push(column);
        }
    }
    found
}

/// Inner product in eight running sums, which the compiler turns into vector instructions.
fn inner(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (left, right) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = left
        .remainder()
        .iter()
        .zip(right.remainder())
        .map(|(a, b)| a * b)
        .sum();
    for (left, right) in left.zip(right) {
        for (lane, sum) in sums.iter_mut().enumerate() {
            *sum += left[lane] * right[lane];
        }
    }
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests;
