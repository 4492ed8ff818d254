//! Noise that dies away by itself, over means of readings: its covariance is a product of two factors on either side of the
//! diagonal, so that a factorization and whitening cost as many steps as there are means.
//!
//! Foreman-Mackey, Agol, Ambikasaran and Angus, Astron. J. 154, 220 (2017), here with means for readings.

use super::bins::Bins;

/// What a process of unit variance does to the means of a channel.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Process {
    /// Correlation of a mean with the process at its first reading, and at its last.
    first: Vec<f64>,
    last: Vec<f64>,
    /// Variance of a mean.
    variance: Vec<f64>,
    /// What is left of the process from the first reading of a mean to its last.
    within: Vec<f64>,
    /// What is left from the last reading of the mean before; 0 for the first mean of a span.
    between: Vec<f64>,
}

impl Process {
    /// One whose correlation falls as e^(-|dt| / time).
    pub(super) fn dying(bins: &Bins, time_s: &[f64], correlation_time_s: f64) -> Process {
        let mut process = Process::empty(bins.len());
        let (mut step_s, mut kept) = (0.0, 1.0);
        let mut left = |from: usize, to: usize| {
            let dt = time_s[to] - time_s[from];
            if dt != step_s {
                (step_s, kept) = (dt, (-dt / correlation_time_s).exp());
            }
            kept
        };
        for &(from, to) in &bins.spans {
            for bin in from..to {
                let (first, end) = bins.parts()[bin];
                let count = (end - first) as f64;
                let between = if bin == from { 0.0 } else { left(first - 1, first) };
                // What readings before still count at the last one, and the last one at the first.
                let (mut behind, mut through, mut pairs, mut ahead) = (0.0, 1.0, 0.0, 1.0);
                for k in first + 1..end {
                    let kept = left(k - 1, k);
                    behind = kept * (behind + 1.0);
                    through *= kept;
                    pairs += behind;
                    ahead += through;
                }
                process.push(
                    (ahead / count, (behind + 1.0) / count),
                    (count + 2.0 * pairs) / (count * count),
                    (through, between),
                );
            }
        }
        process
    }

    /// A straight line over the record, of a slope that every span has anew.
    pub(super) fn line(bins: &Bins) -> Process {
        let (from_s, to_s) = (bins.time_s[0], bins.time_s[bins.len() - 1]);
        let width_s = (to_s - from_s).max(f64::MIN_POSITIVE);
        let mut process = Process::empty(bins.len());
        for &(from, to) in &bins.spans {
            for bin in from..to {
                let place = ((bins.time_s[bin] - from_s) / width_s - 0.5) * 12.0_f64.sqrt();
                let between = if bin == from { 0.0 } else { 1.0 };
                process.push((place, place), place * place, (1.0, between));
            }
        }
        process
    }

    fn empty(bins: usize) -> Process {
        let column = || Vec::with_capacity(bins);
        Process {
            first: column(),
            last: column(),
            variance: column(),
            within: column(),
            between: column(),
        }
    }

    fn push(&mut self, (first, last): (f64, f64), variance: f64, (within, between): (f64, f64)) {
        self.first.push(first);
        self.last.push(last);
        self.variance.push(variance);
        self.within.push(within);
        self.between.push(between);
    }
}

/// A covariance of the means: white noise of that variance at every reading, and processes with theirs.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Covariance {
    pub(super) white: f64,
    /// Variance of every process, 0 of one that is not there.
    pub(super) of_processes: Vec<f64>,
}

/// Makes series over the means white, in standard deviations.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BinWhitener {
    /// By mean: one over the standard deviation of what is new.
    per_new: Vec<f64>,
    /// By mean, of every process that is there.
    steps: Vec<Step>,
    processes: usize,
}

/// A process at one mean, whose state goes from the last reading of the mean before to the last of this one.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Step {
    /// What is left of the state at the first reading of the mean.
    between: f64,
    /// The part that this has in the mean.
    part: f64,
    /// What is left of it at the last reading.
    within: f64,
    /// By how much what is new in the mean moves it.
    gain: f64,
}

impl BinWhitener {
    pub(super) fn new(bins: &Bins, processes: &[Process], covariance: &Covariance) -> BinWhitener {
        let there: Vec<(&Process, f64)> = processes
            .iter()
            .zip(&covariance.of_processes)
            .filter(|(_, variance)| **variance > 0.0)
            .map(|(process, variance)| (process, *variance))
            .collect();
        let count = there.len();
        let mut whitener = BinWhitener {
            per_new: Vec::with_capacity(bins.len()),
            steps: vec![Step::default(); bins.len() * count],
            processes: count,
        };
        // Covariance of the states, as the means before tell them, at the last reading of the mean before.
        let mut told = vec![0.0; count * count];
        let mut shared = vec![0.0; count];
        for bin in 0..bins.len() {
            let (first, end) = bins.parts()[bin];
            let steps = &mut whitener.steps[bin * count..(bin + 1) * count];
            for (step, (process, _)) in steps.iter_mut().zip(&there) {
                step.between = process.between[bin];
                step.part = process.first[bin];
                step.within = process.within[bin];
            }
            for row in 0..count {
                for column in 0..count {
                    told[row * count + column] *= there[row].0.between[bin] * there[column].0.between[bin];
                }
            }
            let mut new = covariance.white / (end - first) as f64;
            for row in 0..count {
                let line = &told[row * count..(row + 1) * count];
                shared[row] = line
                    .iter()
                    .zip(steps.iter())
                    .map(|(told, step)| told * step.part)
                    .sum();
                new += there[row].1 * there[row].0.variance[bin] - shared[row] * steps[row].part;
            }
            let new = new.max(f64::MIN_POSITIVE);
            for (row, (process, variance)) in there.iter().enumerate() {
                let gain = variance * process.last[bin] - process.within[bin] * shared[row];
                steps[row].gain = gain / new;
            }
            for row in 0..count {
                for column in 0..count {
                    let within = there[row].0.within[bin] * there[column].0.within[bin];
                    let told = &mut told[row * count + column];
                    *told = within * *told + steps[row].gain * steps[column].gain * new;
                }
            }
            whitener.per_new.push(new.sqrt().recip());
        }
        whitener
    }

    /// Logarithm of the determinant of the covariance.
    pub(super) fn log_determinant(&self) -> f64 {
        -2.0 * self.per_new.iter().map(|per_new| per_new.ln()).sum::<f64>()
    }

    /// Whitens a series over the means `first..`, which begin a span.
    pub(crate) fn whiten(&self, first: usize, series: &mut [f64]) {
        let count = self.processes;
        let mut states = [0.0; MOST_PROCESSES];
        for (value, bin) in series.iter_mut().zip(first..) {
            let steps = &self.steps[bin * count..(bin + 1) * count];
            let mut expected = 0.0;
            for (state, step) in states.iter_mut().zip(steps) {
                *state *= step.between;
                expected += step.part * *state;
            }
            let new = *value - expected;
            for (state, step) in states.iter_mut().zip(steps) {
                *state = step.within * *state + step.gain * new;
            }
            *value = new * self.per_new[bin];
        }
    }
}

impl BinWhitener {
    /// Whitens series that stand side by side, `width` values a mean.
    pub(super) fn whiten_beside(&self, bins: &Bins, series: &mut [f64], width: usize) {
        let count = self.processes;
        let mut states = vec![0.0; count * width];
        for &(from, to) in &bins.spans {
            states.fill(0.0);
            for bin in from..to {
                let row = &mut series[bin * width..(bin + 1) * width];
                let steps = &self.steps[bin * count..(bin + 1) * count];
                for (step, states) in steps.iter().zip(states.chunks_exact_mut(width)) {
                    for (state, value) in states.iter_mut().zip(row.iter_mut()) {
                        *state *= step.between;
                        *value -= step.part * *state;
                    }
                }
                for (step, states) in steps.iter().zip(states.chunks_exact_mut(width)) {
                    for (state, value) in states.iter_mut().zip(row.iter()) {
                        *state = step.within * *state + step.gain * value;
                    }
                }
                row.iter_mut().for_each(|value| *value *= self.per_new[bin]);
            }
        }
    }
}

/// Processes at most.
pub(super) const MOST_PROCESSES: usize = 24;

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::{Channel, Drive, Quantity};
    use ieap_numerics::symmetric::Symmetric;

    use crate::sampled::Sampled;

    /// Whitened unit series have inner products that are the inverse of the covariance of means of readings, summed reading by
    /// reading.
    #[test]
    fn the_whitener_is_the_inverse_of_the_covariance_of_the_means() {
        let time_s: Vec<f64> = (0..160)
            .map(|k| f64::from(k - 20) + 0.2 * (f64::from(k)).sin())
            .collect();
        let values = vec![1.0; time_s.len()];
        let channel = Channel::new(Quantity::Current, time_s.into(), values.into());
        let sampled = Sampled::new(&channel, &Drive::step(1.0), false);
        let bins = Bins::of(&sampled);
        let scales_s = [3.0, 50.0];
        let mut processes: Vec<Process> = scales_s
            .iter()
            .map(|scale| Process::dying(&bins, &sampled.time_s, *scale))
            .collect();
        processes.push(Process::line(&bins));
        let covariance = Covariance {
            white: 0.7,
            of_processes: vec![0.4, 1.3, 0.9],
        };
        let whitener = BinWhitener::new(&bins, &processes, &covariance);
        let n = bins.len();
        let span_of = |bin: usize| {
            bins.spans
                .iter()
                .position(|(from, to)| (*from..*to).contains(&bin))
        };
        let entry = |a: usize, b: usize| {
            if span_of(a) != span_of(b) {
                return 0.0;
            }
            let ((from_a, to_a), (from_b, to_b)) = (bins.parts()[a], bins.parts()[b]);
            let mut sum = 0.0;
            for j in from_a..to_a {
                for k in from_b..to_b {
                    let apart_s = (sampled.time_s[j] - sampled.time_s[k]).abs();
                    sum += if j == k { 0.7 } else { 0.0 };
                    sum += 0.4 * (-apart_s / 3.0).exp() + 1.3 * (-apart_s / 50.0).exp();
                }
            }
            let line = 0.9 * processes[2].first[a] * processes[2].first[b];
            sum / ((to_a - from_a) * (to_b - from_b)) as f64 + line
        };
        let expected = Symmetric::from_fn(n, entry).inverse(1e-14);
        let white = |bin: usize| {
            let mut unit = vec![0.0; n];
            unit[bin] = 1.0;
            for &(from, to) in &bins.spans {
                whitener.whiten(from, &mut unit[from..to]);
            }
            unit
        };
        let columns: Vec<Vec<f64>> = (0..n).map(white).collect();
        let mut beside: Vec<f64> = (0..n * n).map(|k| f64::from(u8::from(k / n == k % n))).collect();
        whitener.whiten_beside(&bins, &mut beside, n);
        for (k, value) in beside.iter().enumerate() {
            assert!((value - columns[k % n][k / n]).abs() < 1e-12, "{k}");
        }
        for a in 0..n {
            for b in 0..=a {
                let found: f64 = columns[a].iter().zip(&columns[b]).map(|(a, b)| a * b).sum();
                assert!(
                    (found - expected.get(a, b)).abs() < 1e-8,
                    "{a} {b}: {found} {}",
                    expected.get(a, b)
                );
            }
        }
        let determinant = Symmetric::from_fn(n, entry).log_determinant();
        assert!((whitener.log_determinant() - determinant).abs() < 1e-8);
    }
}
