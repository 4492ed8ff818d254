//! The noise found again in other residuals at the same readings: what a simulation of the whole procedure needs many
//! times, with everything that does not change made once.

use crate::joint::whitening::{Autocorrelation, Whitener};
use crate::sampled::{Sampled, Span};
use ieap_numerics::symmetric::Symmetric;

use super::Noise;
use super::columns::inner;
use super::lagged::{Products, among, normal, normal_of, products, scaled, white};
use super::shared::together;
use super::smooth::Smooth;
use super::tried::{CORRELATIONS, FROM, TO, correlation_at, lowest};

/// Smooth shapes and scales of a channel, and the normal matrices of every memory that is tried.
pub(crate) struct Again {
    spans: Vec<SpanShapes>,
    /// Standard deviation of every reading in units of that at signal zero.
    scale: Vec<f64>,
    freedom: f64,
    how: How,
}

struct SpanShapes {
    span: Span,
    /// Scaled shapes.
    shapes: Vec<Vec<f64>>,
}

/// What is found again.
enum How {
    /// First-order memory by reading order, and the size.
    Correlation(Vec<Tried>),
    /// The size alone: memory of another kind is taken as it was found.
    Size {
        autocorrelation: Autocorrelation,
        whitener: Whitener,
        inverses: Vec<Symmetric>,
        white: Vec<Vec<Vec<f64>>>,
    },
}

/// One correlation that is tried.
struct Tried {
    place: f64,
    inverses: Vec<Symmetric>,
    determinant: f64,
}

impl Again {
    /// For the readings that `noise` was found in.
    pub(crate) fn new(sampled: &Sampled, noise: &Noise) -> Again {
        let smooth = Smooth::of(sampled);
        let floor = noise.floor.max(f64::MIN_POSITIVE);
        let scale: Vec<f64> = noise.sd.iter().map(|sd| sd / floor).collect();
        let freedom = (sampled.len() as f64 - smooth.terms()).max(1.0);
        let spans: Vec<SpanShapes> = sampled
            .spans
            .iter()
            .zip(smooth.shapes(sampled))
            .map(|(span, shapes)| SpanShapes {
                span: *span,
                shapes: shapes
                    .iter()
                    .map(|shape| scaled(shape, &scale[span.first..span.end]))
                    .collect(),
            })
            .collect();
        let how = match &noise.autocorrelation {
            Autocorrelation::Order(coefficients) if coefficients.len() <= 1 => {
                How::Correlation(tried(&spans))
            }
            autocorrelation => of_size(sampled, &spans, autocorrelation, &scale),
        };
        Again {
            spans,
            scale,
            freedom,
            how,
        }
    }

    /// Scale of every reading's noise, and the whitener of the memory that is taken as it was found, where one is.
    pub(crate) fn taken(&self) -> (&[f64], Option<&Autocorrelation>) {
        let autocorrelation = match &self.how {
            How::Correlation(_) => None,
            How::Size { autocorrelation, .. } => Some(autocorrelation),
        };
        (&self.scale, autocorrelation)
    }

    /// Standard deviation of every reading and memory of the noise, from `rest`, what a fit has left.
    pub(crate) fn find(&self, rest: &[f64]) -> (Vec<f64>, Autocorrelation) {
        match &self.how {
            How::Correlation(tried) => {
                let looked = self.looked(tried, rest);
                self.at(&looked, lowest(&deviances(&looked)).0)
            }
            How::Size {
                autocorrelation,
                whitener,
                inverses,
                white,
            } => {
                let mut square = 0.0;
                for ((span, inverse), shapes) in self.spans.iter().zip(inverses).zip(white) {
                    let mut own = self.rest_of(span, rest);
                    whitener.whiten(&span.span, &mut own);
                    let right: Vec<f64> = shapes.iter().map(|shape| inner(shape, &own)).collect();
                    square += inner(&own, &own) - inverse.form(&right, &right);
                }
                (self.sized(square / self.freedom), autocorrelation.clone())
            }
        }
    }

    /// The same for channels that share one correlation, each with its `rest`; none where one has memory of another kind.
    pub(crate) fn find_shared(all: &[(&Again, &[f64])]) -> Option<Vec<(Vec<f64>, Autocorrelation)>> {
        let looked: Option<Vec<Vec<(f64, f64)>>> = all
            .iter()
            .map(|(again, rest)| match &again.how {
                How::Correlation(tried) => Some(again.looked(tried, rest)),
                How::Size { .. } => None,
            })
            .collect();
        let looked = looked?;
        let curves: Vec<Vec<f64>> = looked.iter().map(|looked| deviances(looked)).collect();
        let (index, _) = together(&curves.iter().map(Vec::as_slice).collect::<Vec<_>>());
        let each = all.iter().zip(&looked);
        Some(each.map(|((again, _), looked)| again.at(looked, index)).collect())
    }

    /// Deviance and variance with every correlation that is tried.
    fn looked(&self, tried: &[Tried], rest: &[f64]) -> Vec<(f64, f64)> {
        let spans: Vec<(Vec<Products>, Products)> = self
            .spans
            .iter()
            .map(|span| {
                let own = self.rest_of(span, rest);
                let with = span.shapes.iter().map(|shape| products(shape, &own)).collect();
                (with, products(&own, &own))
            })
            .collect();
        let at = |tried: &Tried| {
            let rho = tried.place.tanh();
            let mut square = 0.0;
            for ((with, own), inverse) in spans.iter().zip(&tried.inverses) {
                let right: Vec<f64> = with.iter().map(|products| white(products, rho)).collect();
                square += white(own, rho) - inverse.form(&right, &right);
            }
            let variance = (square / self.freedom).max(f64::MIN_POSITIVE);
            (self.freedom * variance.ln() + tried.determinant, variance)
        };
        tried.iter().map(at).collect()
    }

    /// Standard deviation of every reading and memory at an index of what was looked at.
    fn at(&self, looked: &[(f64, f64)], index: f64) -> (Vec<f64>, Autocorrelation) {
        let before = (index as usize).min(looked.len() - 1);
        let after = (before + 1).min(looked.len() - 1);
        let part = index - before as f64;
        let variance = looked[before].1 + part * (looked[after].1 - looked[before].1);
        (
            self.sized(variance),
            Autocorrelation::Order(vec![correlation_at(index)]),
        )
    }

    /// What a fit has left of a span, scaled.
    fn rest_of(&self, span: &SpanShapes, rest: &[f64]) -> Vec<f64> {
        let Span { first, end, .. } = span.span;
        scaled(&rest[first..end], &self.scale[first..end])
    }

    fn sized(&self, variance: f64) -> Vec<f64> {
        let floor = variance.max(f64::MIN_POSITIVE).sqrt();
        self.scale.iter().map(|scale| floor * scale).collect()
    }
}

fn deviances(looked: &[(f64, f64)]) -> Vec<f64> {
    looked.iter().map(|(deviance, _)| *deviance).collect()
}

fn tried(spans: &[SpanShapes]) -> Vec<Tried> {
    let among: Vec<Vec<Vec<Products>>> = spans.iter().map(|span| among(&span.shapes)).collect();
    let one = |k: usize| {
        let place = FROM + (TO - FROM) * k as f64 / CORRELATIONS as f64;
        let rho = place.tanh();
        let mut determinant = 0.0;
        let mut inverses = Vec::with_capacity(spans.len());
        for (span, among) in spans.iter().zip(&among) {
            let normal = normal(among, among.len(), rho);
            let pairs = (span.span.end - span.span.first - 1) as f64;
            determinant += normal.log_determinant() + pairs * (1.0 - rho * rho).ln();
            inverses.push(normal.inverse(1e-14));
        }
        Tried {
            place,
            inverses,
            determinant,
        }
    };
    (0..=CORRELATIONS).map(one).collect()
}

fn of_size(sampled: &Sampled, spans: &[SpanShapes], autocorrelation: &Autocorrelation, scale: &[f64]) -> How {
    // The series are scaled before: the whitener's own scale is one.
    let whitener = Whitener::new(sampled, &vec![1.0; scale.len()], autocorrelation);
    let white: Vec<Vec<Vec<f64>>> = spans
        .iter()
        .map(|span| {
            let whitened = |shape: &Vec<f64>| {
                let mut shape = shape.clone();
                whitener.whiten(&span.span, &mut shape);
                shape
            };
            span.shapes.iter().map(whitened).collect()
        })
        .collect();
    How::Size {
        autocorrelation: autocorrelation.clone(),
        inverses: white
            .iter()
            .map(|shapes| normal_of(shapes).inverse(1e-14))
            .collect(),
        whitener,
        white,
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use ieap_domain::{Channel, Drive, Level, Quantity, Segment};

    fn sampled(rho: f64, seed: u64) -> Sampled {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut state = 0.0;
        let time_s: Vec<f64> = (0..500).map(f64::from).collect();
        let values: Vec<f64> = time_s
            .iter()
            .map(|t| {
                let fresh: f64 = StandardNormal.sample(&mut random);
                state = rho * state + fresh;
                state + 100.0 * (-t / 40.0).exp()
            })
            .collect();
        let channel = Channel::new(Quantity::Current, time_s.into(), values.into());
        let drive = Drive {
            baseline_v: 0.0,
            segments: [(0.0, 1.0), (240.0, 0.0)]
                .map(|(start_s, volts)| Segment::at(start_s, Level::Voltage(volts)))
                .to_vec(),
        };
        Sampled::new(&channel, &drive, false)
    }

    #[test]
    fn it_finds_what_the_first_search_finds() {
        for (seed, rho) in [(1, 0.0), (2, 0.3), (3, 0.8)] {
            let sampled = sampled(rho, seed);
            let slow = Noise::of_rest(&sampled, &vec![1.0; sampled.len()], 0.0);
            let Autocorrelation::Order(slow_autocorrelation) = &slow.autocorrelation else {
                panic!("{slow:?}")
            };
            let even = Noise {
                autocorrelation: Autocorrelation::Order(vec![0.5]),
                ..slow.clone()
            };
            let (sd, autocorrelation) = Again::new(&sampled, &even).find(&sampled.values);
            let Autocorrelation::Order(found) = &autocorrelation else {
                panic!()
            };
            // The first search may go on to a second order, whose lag-1 coefficient is another number.
            if slow_autocorrelation.len() == 1 {
                assert!(
                    (found[0] - slow_autocorrelation[0]).abs() < 2e-3,
                    "{found:?} {slow_autocorrelation:?}"
                );
                assert!(
                    (sd[0] / slow.sd[0] - 1.0).abs() < 5e-3,
                    "{} {}",
                    sd[0],
                    slow.sd[0]
                );
            }
            let of_size = Noise {
                autocorrelation: Autocorrelation::Order(vec![rho, 0.05]),
                ..slow.clone()
            };
            let (sd, _) = Again::new(&sampled, &of_size).find(&sampled.values);
            let by_likelihood = Smooth::of(&sampled)
                .deviance(&sampled, &vec![1.0; sampled.len()], &of_size.autocorrelation)
                .1;
            assert!((sd[0] / by_likelihood.sqrt() - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn channels_that_share_a_correlation_find_one_between_their_own() {
        let sampled = [sampled(0.7, 4), sampled(0.7, 5)];
        let of = |sampled: &Sampled| {
            let slow = Noise::of_rest(sampled, &vec![1.0; sampled.len()], 0.0);
            let first = Noise {
                autocorrelation: Autocorrelation::Order(vec![0.5]),
                ..slow
            };
            Again::new(sampled, &first)
        };
        let again = [of(&sampled[0]), of(&sampled[1])];
        let rests = [&sampled[0].values[..], &sampled[1].values[..]];
        let first = |(_, autocorrelation): &(Vec<f64>, Autocorrelation)| match autocorrelation {
            Autocorrelation::Order(coefficients) => coefficients[0],
            _ => f64::NAN,
        };
        let [a, b] = [0, 1].map(|k| first(&again[k].find(rests[k])));
        let both = Again::find_shared(&[(&again[0], rests[0]), (&again[1], rests[1])]).unwrap();
        let shared = first(&both[0]);
        assert_eq!(shared, first(&both[1]));
        assert!(a.min(b) < shared && shared < a.max(b), "{a} {b} {shared}");
        // Alone it is what it is without others.
        let alone = Again::find_shared(&[(&again[0], rests[0])]).unwrap();
        assert!((first(&alone[0]) - a).abs() < 1e-12);
    }
}
