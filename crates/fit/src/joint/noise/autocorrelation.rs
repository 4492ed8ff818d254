//! The memory of noise, by restricted likelihood beside the smooth part, so that the smooth part costs no bias.

use crate::joint::policy::MEMORY_OF_RECORD;
use crate::joint::whitening::{Autocorrelation, Whitener, sum_of_logs};
use crate::sampled::{Sampled, Span};
use ieap_numerics::correlation::{FEWEST_FOR_ORDER, NOISE_EVIDENCE, yule_walker};

use super::columns::inner;
use super::lagged::{Products, among, normal, normal_of, scaled, white};
use super::smooth::Smooth;
use super::tried::{CORRELATIONS, FROM, TO, lowest};

/// Correlation times that are tried.
const TIMES: usize = 12;

impl Smooth {
    /// Minus twice the restricted log likelihood of that memory, with the best size of the noise.
    pub(super) fn deviance(
        &self,
        sampled: &Sampled,
        scale: &[f64],
        autocorrelation: &Autocorrelation,
    ) -> (f64, f64) {
        let whitener = Whitener::new(sampled, scale, autocorrelation);
        let mut square = 0.0;
        let mut determinant = whitener.log_determinant(sampled);
        for (k, span) in sampled.spans.iter().enumerate() {
            let white = |column: &[f64]| {
                let mut column = column.to_vec();
                whitener.whiten(span, &mut column);
                column
            };
            let rest = white(&self.rest[span.first..span.end]);
            let short = self
                .short()
                .and_then(|short| short[k].white(span, &whitener, &rest));
            let (columns, short_rest) = short.unwrap_or_else(|| {
                let shapes = &self.shapes(sampled)[k];
                (shapes.iter().map(|shape| white(shape)).collect(), rest.clone())
            });
            let normal = normal_of(&columns);
            let right: Vec<f64> = columns.iter().map(|column| inner(column, &short_rest)).collect();
            let (solved, own) = normal.solve_with_log_determinant(&right);
            square += inner(&rest, &rest) - inner(&right, &solved);
            determinant += own;
        }
        let freedom = (sampled.len() as f64 - self.terms()).max(1.0);
        let variance = (square / freedom).max(f64::MIN_POSITIVE);
        (freedom * variance.ln() + determinant, variance)
    }

    /// The memory that the rest shows.
    pub(super) fn autocorrelation(&self, sampled: &Sampled, scale: &[f64]) -> FoundAutocorrelation {
        let lagged = self.lagged(sampled, scale);
        let mut best = (self.deviance_of(&lagged, 0.0), Autocorrelation::Order(Vec::new()));
        let unit: f64 = self.rest.iter().map(|r| r * r).sum();
        let freedom = sampled.len() as f64 - self.terms();
        if freedom < 4.0 || unit <= 0.0 {
            return FoundAutocorrelation::of(best, Vec::new());
        }
        let by_order = |x: f64| Autocorrelation::Order(vec![x.tanh()]);
        let (shortest_s, longest_s) = sampled.time_scales_s();
        let is_even = sampled.blocks.iter().all(|(_, block)| block.step_s.is_some());
        let with_prior =
            |(deviance, variance): (f64, f64), records: f64| (deviance + prior_deviance(records), variance);
        let of_order = |x: f64| {
            let readings = -1.0 / x.tanh().max(f64::MIN_POSITIVE).ln();
            with_prior(self.deviance_of(&lagged, x.tanh()), readings / lagged.readings)
        };
        let by_correlation;
        (best, by_correlation) = search(best, (FROM, TO, CORRELATIONS), by_order, of_order);
        if !is_even && shortest_s > 0.0 && shortest_s < longest_s {
            let span = (longest_s / shortest_s / 4.0).max(2.0).ln();
            let by_time = |x: f64| Autocorrelation::Time {
                correlation_time_s: shortest_s * (span * x).exp() / 2.0,
            };
            let of_time = |x: f64| {
                let records = shortest_s * (span * x).exp() / 2.0 / longest_s;
                with_prior(self.deviance(sampled, scale, &by_time(x)), records)
            };
            best = search(best, (0.0, 1.0, TIMES), by_time, of_time).0;
        }
        if sampled.len() >= FEWEST_FOR_ORDER && matches!(best.1, Autocorrelation::Order(_)) {
            best = self.higher_orders(sampled, scale, best);
        }
        FoundAutocorrelation::of(best, by_correlation)
    }

    /// Products of the scaled shapes and rest with each other.
    fn lagged(&self, sampled: &Sampled, scale: &[f64]) -> Lagged {
        let of_span = |(k, span): (usize, &Span)| {
            let scale = &scale[span.first..span.end];
            let rest = &self.rest[span.first..span.end];
            let is_even = scale.iter().all(|own| *own == scale[0]);
            let short = self.short().filter(|_| is_even);
            let short = short.and_then(|short| short[k].among(rest, scale[0]));
            let products = short.unwrap_or_else(|| {
                let shapes = &self.shapes(sampled)[k];
                let mut columns: Vec<Vec<f64>> = shapes.iter().map(|shape| scaled(shape, scale)).collect();
                columns.push(scaled(rest, scale));
                among(&columns)
            });
            (products, (span.end - span.first - 1) as f64)
        };
        Lagged {
            spans: sampled.spans.iter().enumerate().map(of_span).collect(),
            readings: sampled.len() as f64,
            determinant: 2.0 * sum_of_logs(scale.iter().copied()),
        }
    }

    /// As [`Smooth::deviance`] for a first-order autoregression by reading order, from sums made before.
    fn deviance_of(&self, lagged: &Lagged, rho: f64) -> (f64, f64) {
        let mut square = 0.0;
        let mut determinant = lagged.determinant;
        for (products, pairs) in &lagged.spans {
            let count = products.len() - 1;
            let normal = normal(products, count, rho);
            let right: Vec<f64> = products[count][..count].iter().map(|p| white(p, rho)).collect();
            let (solved, own) = normal.solve_with_log_determinant(&right);
            square += white(&products[count][count], rho) - inner(&right, &solved);
            determinant += own + pairs * (1.0 - rho * rho).ln();
        }
        let freedom = (lagged.readings - self.terms()).max(1.0);
        let variance = (square / freedom).max(f64::MIN_POSITIVE);
        (freedom * variance.ln() + determinant, variance)
    }

    /// Orders two and three where BIC asks for them.
    fn higher_orders(&self, sampled: &Sampled, scale: &[f64], first: Candidate) -> Candidate {
        let mut best = first;
        let penalty = (sampled.len() as f64).ln().max(NOISE_EVIDENCE);
        let lags = self.autocovariances(sampled, scale, &best.1);
        for order in 2..=3 {
            let Some((coefficients, _)) = yule_walker(&lags[..=order]) else {
                break;
            };
            let autocorrelation = Autocorrelation::Order(coefficients);
            let found = self.deviance(sampled, scale, &autocorrelation);
            if found.0 + penalty < best.0.0 {
                best = (found, autocorrelation);
            }
        }
        best
    }

    /// Autocovariances of the scaled rest up to lag 3, put right for the slow part that the shapes removed.
    fn autocovariances(
        &self,
        sampled: &Sampled,
        scale: &[f64],
        autocorrelation: &Autocorrelation,
    ) -> [f64; 4] {
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
        let removed = self.terms() / n * autocorrelation.readings_per_independent(1.0);
        let variance = lag(0) / (1.0 - removed.min(0.5));
        std::array::from_fn(|k| lag(k) + removed.min(0.5) * variance)
    }

    /// Readings per independent one, from the lag-1 correlation of the rest: what evidence must be divided by.
    pub(super) fn autocorrelation_of_rest(&self, sampled: &Sampled) -> f64 {
        let lags = self.autocovariances(
            sampled,
            &vec![1.0; sampled.len()],
            &Autocorrelation::Order(Vec::new()),
        );
        let rho = if lags[0] > 0.0 {
            (lags[1] / lags[0]).clamp(0.0, 0.95)
        } else {
            0.0
        };
        (1.0 + rho * rho) / (1.0 - rho * rho)
    }
}

/// What was found.
pub(super) struct FoundAutocorrelation {
    pub(super) autocorrelation: Autocorrelation,
    pub(super) standard_deviation: f64,
    /// Minus twice the log likelihood of every correlation that was tried; empty where the memory is of another kind.
    pub(super) by_correlation: Vec<f64>,
}

impl FoundAutocorrelation {
    fn of(((_, variance), autocorrelation): Candidate, by_correlation: Vec<f64>) -> FoundAutocorrelation {
        let is_correlation =
            matches!(&autocorrelation, Autocorrelation::Order(coefficients) if coefficients.len() <= 1);
        FoundAutocorrelation {
            autocorrelation,
            standard_deviation: variance.sqrt(),
            by_correlation: if is_correlation {
                by_correlation
            } else {
                Vec::new()
            },
        }
    }
}

/// Sums from which the likelihood of any first-order autoregression follows.
struct Lagged {
    /// Per span the products of shapes and rest, the rest last, and the number of pairs of neighbours.
    spans: Vec<(Vec<Vec<Products>>, f64)>,
    readings: f64,
    determinant: f64,
}

/// What the prior of a memory adds to the deviance, of a correlation time in records: a record cannot show a memory as long as
/// itself, and what looks like one is its transient.
fn prior_deviance(records: f64) -> f64 {
    2.0 * records.max(0.0) / MEMORY_OF_RECORD
}

/// A deviance with the variance of the noise, and the memory they belong to.
type Candidate = ((f64, f64), Autocorrelation);

/// The best memory along a line of them, with the deviances on the line: a look at evenly spaced ones, then a parabola
/// through the best three.
///
/// Memory costs one parameter and is taken even on weak evidence: leaving it out makes intervals too short,
/// while taking it in vain costs next to nothing.
fn search(
    best: Candidate,
    (low, high, count): (f64, f64, usize),
    autocorrelation: impl Fn(f64) -> Autocorrelation,
    deviance: impl Fn(f64) -> (f64, f64),
) -> (Candidate, Vec<f64>) {
    let step = (high - low) / count as f64;
    let looked: Vec<f64> = (0..=count).map(|k| deviance(low + step * k as f64).0).collect();
    let x = low + step * lowest(&looked).0;
    let found = deviance(x);
    let best = if found.0 < best.0.0 {
        (found, autocorrelation(x))
    } else {
        best
    };
    (best, looked)
}
