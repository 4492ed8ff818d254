//! Readings and model values turned into numbers whose noise is white and of unit size.

use crate::sampled::{Sampled, Span};
use ieap_numerics::symmetric::Symmetric;

/// Sum of the logarithms; of a number that repeats itself it is taken once.
pub(super) fn sum_of_logs(values: impl Iterator<Item = f64>) -> f64 {
    let (mut last, mut times, mut sum) = (1.0_f64, 0.0, 0.0);
    for value in values {
        if value != last {
            sum += times * last.ln();
            (last, times) = (value, 0.0);
        }
        times += 1.0;
    }
    sum + times * last.ln()
}

/// How noise remembers.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Autocorrelation {
    /// Autoregression by reading order; coefficients of lag 1, 2, ...; none for white noise.
    Order(Vec<f64>),
    /// Ornstein-Uhlenbeck process: correlation falls as e^(-|dt|/time).
    Time {
        /// Correlation time, s.
        correlation_time_s: f64,
    },
    /// White noise beside such processes.
    Slow(Vec<Process>),
}

/// A part of a noise that dies away by itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Process {
    /// Correlation time, s.
    pub(crate) correlation_time_s: f64,
    /// Its part of the variance.
    pub(crate) part: f64,
}

/// The longest correlation time of processes, s.
pub(crate) fn longest_s(processes: &[Process]) -> Option<f64> {
    let times = processes.iter().map(|process| process.correlation_time_s);
    times.reduce(f64::max)
}

impl Autocorrelation {
    /// Numbers that describe it.
    pub(crate) fn parameters(&self) -> usize {
        match self {
            Autocorrelation::Order(coefficients) => coefficients.len(),
            Autocorrelation::Time { .. } => 1,
            Autocorrelation::Slow(_) => 2,
        }
    }

    /// (1+rho)/(1-rho) and its like: how many readings carry as much as one independent one, for readings `step_s` apart.
    pub(crate) fn readings_per_independent(&self, step_s: f64) -> f64 {
        match self {
            Autocorrelation::Order(coefficients) => {
                let left = (1.0 - coefficients.iter().sum::<f64>()).max(1e-6);
                innovation_share(coefficients) / (left * left)
            }
            Autocorrelation::Time { correlation_time_s } => {
                let rho = (-step_s / correlation_time_s).exp();
                (1.0 + rho) / (1.0 - rho).max(1e-9)
            }
            Autocorrelation::Slow(processes) => {
                let beyond = |process: &Process| {
                    let rho = (-step_s / process.correlation_time_s).exp();
                    process.part * 2.0 * rho / (1.0 - rho).max(1e-9)
                };
                1.0 + processes.iter().map(beyond).sum::<f64>()
            }
        }
    }
}

/// Predictors of order 0, 1, ... that belong to an autoregression (Levinson and Durbin, backwards), each with
/// the share of the variance that it leaves.
fn predictors(coefficients: &[f64]) -> Vec<(Vec<f64>, f64)> {
    let mut orders = vec![coefficients.to_vec()];
    while let Some(last) = orders.last().filter(|last| !last.is_empty()) {
        let p = last.len();
        let partial = last[p - 1];
        let below = (0..p - 1).map(|k| (last[k] + partial * last[p - 2 - k]) / (1.0 - partial * partial));
        orders.push(below.collect());
    }
    orders.reverse();
    let mut share = 1.0;
    let with_share = orders.into_iter().map(|order| {
        if let Some(partial) = order.last() {
            share *= 1.0 - partial * partial;
        }
        (order, share)
    });
    with_share.collect()
}

/// Share of the variance that is new at every reading.
pub(crate) fn innovation_share(coefficients: &[f64]) -> f64 {
    predictors(coefficients).last().map_or(1.0, |(_, share)| *share)
}

/// Makes series over the readings of one channel white; every span begins anew.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Whitener {
    /// One over the standard deviation of every reading.
    per_sd: Vec<f64>,
    rule: Rule,
}

#[derive(Debug, Clone, PartialEq)]
enum Rule {
    /// Correlation with the reading before (0 for the first of a span), and one over the root of what is new.
    Pairs(Vec<(f64, f64)>),
    /// Predictors by the number of readings behind.
    Orders(Vec<(Vec<f64>, f64)>),
    /// White noise beside processes, by Kalman's filter.
    Filter(Vec<Filtered>),
}

/// What a reading tells of processes: how far each is moved by what is new, what is left of each at the next reading (0 behind
/// the last of a span), and one over the root of the variance of what is new.
#[derive(Debug, Clone, PartialEq)]
struct Filtered {
    gains: Vec<f64>,
    kept: Vec<f64>,
    per_new: f64,
}

/// The filter over the readings of a span at these times.
fn filter(time_s: &[f64], processes: &[Process]) -> Vec<Filtered> {
    let white = 1.0 - processes.iter().map(|process| process.part).sum::<f64>();
    let mut expected = Symmetric::from_fn(
        processes.len(),
        |a, b| if a == b { processes[a].part } else { 0.0 },
    );
    let all = vec![1.0; processes.len()];
    let of_reading = |k: usize| {
        let shared = expected.times(&all);
        let new = shared.iter().sum::<f64>() + white;
        let gains: Vec<f64> = shared.iter().map(|own| own / new).collect();
        let left = |process: &Process| {
            let next_s = time_s.get(k + 1);
            next_s.map_or(0.0, |next_s| {
                (-(next_s - time_s[k]) / process.correlation_time_s).exp()
            })
        };
        let kept: Vec<f64> = processes.iter().map(left).collect();
        expected = Symmetric::from_fn(processes.len(), |a, b| {
            let own = kept[a] * kept[b] * (expected.get(a, b) - gains[a] * shared[b]);
            own + if a == b {
                (1.0 - kept[a] * kept[a]) * processes[a].part
            } else {
                0.0
            }
        });
        Filtered {
            gains,
            kept,
            per_new: new.sqrt().recip(),
        }
    };
    (0..time_s.len()).map(of_reading).collect()
}

/// A rule that is the same for all readings that have so many before them as it has coefficients.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Steady {
    /// What is predicted from each of the readings before, the last one first.
    pub(crate) coefficients: Vec<f64>,
    /// What is new, times this, is of unit size.
    size: f64,
}

impl Steady {
    /// By what an exponential is multiplied that falls by `e^-fall` from reading to reading.
    pub(crate) fn gain(&self, fall: f64) -> f64 {
        let each = self.coefficients.iter().zip(1..);
        let predicted: f64 = each.map(|(own, lag)| own * (fall * f64::from(lag)).exp()).sum();
        self.size * (1.0 - predicted)
    }
}

impl Filtered {
    /// The states of the processes after a surprise, at the next reading.
    fn go_on(&self, states: &mut [f64], surprise: f64) {
        for ((state, gain), kept) in states.iter_mut().zip(&self.gains).zip(&self.kept) {
            *state = kept * (*state + gain * surprise);
        }
    }
}

impl Whitener {
    /// For noise of standard deviation `sd` (one for every reading) and that memory.
    pub(crate) fn new(sampled: &Sampled, sd: &[f64], autocorrelation: &Autocorrelation) -> Whitener {
        let per_sd = sd.iter().map(|sd| sd.recip()).collect();
        let pair = |rho: f64| (rho, (1.0 - rho * rho).sqrt().recip());
        let rule = match autocorrelation {
            Autocorrelation::Order(coefficients) if coefficients.len() > 1 => Rule::Orders(
                predictors(coefficients)
                    .into_iter()
                    .map(|(order, share)| (order, share.sqrt().recip()))
                    .collect(),
            ),
            Autocorrelation::Order(coefficients) => {
                let rho = coefficients.first().copied().unwrap_or(0.0);
                let mut pairs = vec![pair(rho); sampled.len()];
                sampled
                    .spans
                    .iter()
                    .for_each(|span| pairs[span.first] = (0.0, 1.0));
                Rule::Pairs(pairs)
            }
            Autocorrelation::Time { correlation_time_s } => {
                let mut pairs = vec![(0.0, 1.0); sampled.len()];
                for span in &sampled.spans {
                    let times = &sampled.time_s[span.first..span.end];
                    let later = pairs[span.first..span.end].iter_mut().skip(1);
                    for (own, two) in later.zip(times.windows(2)) {
                        *own = pair((-(two[1] - two[0]) / correlation_time_s).exp().min(0.9999));
                    }
                }
                Rule::Pairs(pairs)
            }
            Autocorrelation::Slow(processes) => {
                let of_span = |span: &Span| filter(&sampled.time_s[span.first..span.end], processes);
                Rule::Filter(sampled.spans.iter().flat_map(of_span).collect())
            }
        };
        Whitener { per_sd, rule }
    }

    /// Whitens `column`, the values at the readings of `span`, in place.
    pub(crate) fn whiten(&self, span: &Span, column: &mut [f64]) {
        for (value, per_sd) in column.iter_mut().zip(&self.per_sd[span.first..span.end]) {
            *value *= per_sd;
        }
        match &self.rule {
            Rule::Pairs(pairs) => {
                let mut before = 0.0;
                for (value, (rho, per_new)) in column.iter_mut().zip(&pairs[span.first..span.end]) {
                    let own = *value;
                    *value = (own - rho * before) * per_new;
                    before = own;
                }
            }
            Rule::Orders(orders) => {
                for k in (0..column.len()).rev() {
                    let (order, per_new) = &orders[k.min(orders.len() - 1)];
                    let predicted: f64 = order.iter().enumerate().map(|(j, a)| a * column[k - 1 - j]).sum();
                    column[k] = (column[k] - predicted) * per_new;
                }
            }
            Rule::Filter(filter) => {
                let rules = &filter[span.first..span.end];
                let mut states = vec![0.0; rules.first().map_or(0, |rule| rule.gains.len())];
                for (value, rule) in column.iter_mut().zip(rules) {
                    let surprise = *value - states.iter().sum::<f64>();
                    *value = surprise * rule.per_new;
                    rule.go_on(&mut states, surprise);
                }
            }
        }
    }

    /// The inverse of [`Whitener::whiten`]: white noise becomes noise of that size and memory.
    pub(crate) fn colour(&self, span: &Span, column: &mut [f64]) {
        match &self.rule {
            Rule::Pairs(pairs) => {
                let mut before = 0.0;
                for (value, (rho, per_new)) in column.iter_mut().zip(&pairs[span.first..span.end]) {
                    before = *value / per_new + rho * before;
                    *value = before;
                }
            }
            Rule::Orders(orders) => {
                for k in 0..column.len() {
                    let (order, per_new) = &orders[k.min(orders.len() - 1)];
                    let predicted: f64 = order.iter().enumerate().map(|(j, a)| a * column[k - 1 - j]).sum();
                    column[k] = column[k] / per_new + predicted;
                }
            }
            Rule::Filter(filter) => {
                let rules = &filter[span.first..span.end];
                let mut states = vec![0.0; rules.first().map_or(0, |rule| rule.gains.len())];
                for (value, rule) in column.iter_mut().zip(rules) {
                    let surprise = *value / rule.per_new;
                    *value = surprise + states.iter().sum::<f64>();
                    rule.go_on(&mut states, surprise);
                }
            }
        }
        for (value, per_sd) in column.iter_mut().zip(&self.per_sd[span.first..span.end]) {
            *value /= per_sd;
        }
    }

    /// The transpose of [`Whitener::whiten`]: the inner product of `column` with any whitened series is that of what it
    /// becomes with the series itself.
    pub(crate) fn transpose(&self, span: &Span, column: &mut [f64]) {
        match &self.rule {
            Rule::Pairs(pairs) => {
                let mut after = 0.0;
                for (value, (rho, per_new)) in column.iter_mut().zip(&pairs[span.first..span.end]).rev() {
                    let own = *value * per_new;
                    *value = own - after;
                    after = rho * own;
                }
            }
            Rule::Orders(orders) => {
                for k in 0..column.len() {
                    let (order, per_new) = &orders[k.min(orders.len() - 1)];
                    let own = column[k] * per_new;
                    column[k] = own;
                    for (j, a) in order.iter().enumerate() {
                        column[k - 1 - j] -= a * own;
                    }
                }
            }
            Rule::Filter(filter) => {
                let rules = &filter[span.first..span.end];
                let mut later = vec![0.0; rules.first().map_or(0, |rule| rule.gains.len())];
                for (value, rule) in column.iter_mut().zip(rules).rev() {
                    let moved = later.iter_mut().zip(&rule.kept).zip(&rule.gains);
                    let through = moved.map(|((later, kept), gain)| {
                        *later *= kept;
                        *later * gain
                    });
                    let own = *value * rule.per_new + through.sum::<f64>();
                    *value = own;
                    later.iter_mut().for_each(|later| *later -= own);
                }
            }
        }
        for (value, per_sd) in column.iter_mut().zip(&self.per_sd[span.first..span.end]) {
            *value *= per_sd;
        }
    }

    /// Logarithm of the determinant of the covariance of all readings.
    pub(crate) fn log_determinant(&self, sampled: &Sampled) -> f64 {
        let scales = -2.0 * sum_of_logs(self.per_sd.iter().copied());
        let autocorrelation: f64 = match &self.rule {
            Rule::Pairs(pairs) => -2.0 * sum_of_logs(pairs.iter().map(|(_, per_new)| *per_new)),
            Rule::Filter(filter) => filter.iter().map(|rule| -2.0 * rule.per_new.ln()).sum(),
            Rule::Orders(orders) => {
                let of_span = |span: &Span| {
                    let each = (0..span.end - span.first).map(|k| orders[k.min(orders.len() - 1)].1);
                    -2.0 * sum_of_logs(each)
                };
                sampled.spans.iter().map(of_span).sum()
            }
        };
        scales + autocorrelation
    }

    /// The rule behind the first readings of a span, where it is the same for all of them; none where it changes, or
    /// remembers without end.
    pub(crate) fn steady(&self, span: &Span) -> Option<Steady> {
        let per_sd = &self.per_sd[span.first..span.end];
        if per_sd.iter().any(|own| *own != per_sd[0]) {
            return None;
        }
        let (coefficients, per_new) = match &self.rule {
            Rule::Pairs(pairs) => {
                let later = &pairs[span.first + 1..span.end];
                let (rho, per_new) = later.first().copied().unwrap_or((0.0, 1.0));
                if later.iter().any(|own| *own != (rho, per_new)) {
                    return None;
                }
                (vec![rho], per_new)
            }
            Rule::Orders(orders) => orders.last()?.clone(),
            Rule::Filter(_) => return None,
        };
        Some(Steady {
            coefficients,
            size: per_sd[0] * per_new,
        })
    }

    /// Whether the whitened value of a smooth series varies smoothly from reading `k - 1` to `k` of a span that
    /// starts at `first`: the same rule holds for both.
    pub(crate) fn is_even(&self, first: usize, k: usize) -> bool {
        match &self.rule {
            Rule::Pairs(pairs) => k > first + 1 && (pairs[k].0 - pairs[k - 1].0).abs() <= 1e-3,
            Rule::Orders(orders) => k >= first + orders.len(),
            Rule::Filter(filter) => {
                let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-3);
                let (before, own) = (&filter[k - 1], &filter[k]);
                k > first + 1 && near(&before.gains, &own.gains) && near(&before.kept, &own.kept)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::{Channel, Drive, Quantity};

    fn process(correlation_time_s: f64, part: f64) -> Process {
        Process {
            correlation_time_s,
            part,
        }
    }

    fn sampled(time_s: &[f64]) -> Sampled {
        let channel = Channel::new(Quantity::Curvature, time_s.into(), vec![0.0; time_s.len()].into());
        Sampled::new(&channel, &Drive::step(1.0), true)
    }

    /// Whitening W of a covariance V must give W V W' = 1.
    fn assert_whitens(
        time_s: &[f64],
        autocorrelation: &Autocorrelation,
        covariance: impl Fn(usize, usize) -> f64,
    ) {
        let sampled = sampled(time_s);
        let n = time_s.len();
        let whitener = Whitener::new(&sampled, &vec![2.0; n], autocorrelation);
        let span = sampled.spans[0];
        let whitened_rows = |matrix: Vec<Vec<f64>>| -> Vec<Vec<f64>> {
            let columns = (0..n).map(|c| {
                let mut column: Vec<f64> = (0..n).map(|r| matrix[r][c]).collect();
                whitener.whiten(&span, &mut column);
                column
            });
            columns.collect()
        };
        let v = (0..n)
            .map(|r| (0..n).map(|c| 4.0 * covariance(r, c)).collect())
            .collect();
        let both = whitened_rows(whitened_rows(v));
        for (r, row) in both.iter().enumerate() {
            for (c, value) in row.iter().enumerate() {
                let expected = if r == c { 1.0 } else { 0.0 };
                assert!((value - expected).abs() < 1e-10, "{r} {c}: {value}");
            }
        }
    }

    #[test]
    fn colouring_undoes_whitening_and_the_transpose_moves_across_a_product() {
        let time_s = [0.0, 0.1, 0.5, 2.0, 2.1, 7.0, 7.5];
        let sampled = sampled(&time_s);
        let span = sampled.spans[0];
        let sd: Vec<f64> = (1..8).map(|k| 0.3 * f64::from(k)).collect();
        let autocorrelations = [
            Autocorrelation::Order(Vec::new()),
            Autocorrelation::Order(vec![0.6]),
            Autocorrelation::Order(vec![0.5, 0.3]),
            Autocorrelation::Time {
                correlation_time_s: 1.5,
            },
            Autocorrelation::Slow(vec![process(1.5, 0.4), process(6.0, 0.2)]),
        ];
        let x = [1.0, -2.0, 0.5, 3.0, 0.0, -1.0, 4.0];
        let y = [0.2, 1.0, -1.0, 2.0, 5.0, 0.3, -0.7];
        for autocorrelation in autocorrelations {
            let whitener = Whitener::new(&sampled, &sd, &autocorrelation);
            let (mut white, mut back) = (x.to_vec(), y.to_vec());
            whitener.whiten(&span, &mut white);
            whitener.transpose(&span, &mut back);
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            assert!(
                (dot(&white, &y) - dot(&x, &back)).abs() < 1e-12,
                "{autocorrelation:?}"
            );
            whitener.colour(&span, &mut white);
            assert!(
                white.iter().zip(&x).all(|(a, b)| (a - b).abs() < 1e-12),
                "{autocorrelation:?}"
            );
        }
    }

    #[test]
    fn correlated_noise_becomes_white() {
        let even: Vec<f64> = (0..9).map(f64::from).collect();
        let rho = 0.7_f64;
        assert_whitens(&even, &Autocorrelation::Order(vec![rho]), |r, c| {
            rho.powi(r.abs_diff(c) as i32)
        });
        let uneven = [0.0, 0.1, 0.5, 2.0, 2.1, 7.0];
        let time = Autocorrelation::Time {
            correlation_time_s: 1.5,
        };
        assert_whitens(&uneven, &time, |r, c| {
            (-(uneven[r] - uneven[c]).abs() / 1.5_f64).exp()
        });
        let slow = Autocorrelation::Slow(vec![process(1.5, 0.4), process(6.0, 0.2)]);
        assert_whitens(&uneven, &slow, |r, c| {
            let white = if r == c { 0.4 } else { 0.0 };
            let apart_s = (uneven[r] - uneven[c]).abs();
            white + 0.4 * (-apart_s / 1.5).exp() + 0.2 * (-apart_s / 6.0).exp()
        });
        // Second order: autocorrelations by Yule and Walker.
        let (a, b) = (0.5, 0.3);
        let mut lags = vec![1.0, a / (1.0 - b)];
        for k in 2..9 {
            lags.push(a * lags[k - 1] + b * lags[k - 2]);
        }
        assert_whitens(&even, &Autocorrelation::Order(vec![a, b]), |r, c| {
            lags[r.abs_diff(c)]
        });
    }
}
