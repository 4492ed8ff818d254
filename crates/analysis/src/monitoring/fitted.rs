//! One law of a trend fitted to a series, with its interval, and the laws compared.

use super::policy::{AS_GOOD, LARGEST};
use super::shape::{self, Bend, Law, Span, at_progress, is_of_amounts, progress};
use ieap_numerics::grouped::Grouped;
use ieap_numerics::line::{edge, golden};
use ieap_numerics::student::quantile_95;
use ieap_numerics::sums::dot;

/// Times that the bends about the best one are looked at more finely.
const FINER: usize = 2;

/// What laws are fitted to. Values are logarithms, or numbers as they are where some are not positive.
#[derive(Debug, Clone)]
pub struct Material<'a> {
    /// Values.
    pub y: &'a [f64],
    /// Variances, those that all share counted in.
    pub variance: &'a [f64],
    /// Group and other columns taken out of everything.
    pub nuisance: &'a Grouped,
    /// The number followed, its errors allowed for.
    pub x: &'a [f64],
    /// Its distinct levels, rising.
    pub levels: &'a [f64],
    /// Over which laws are stated.
    pub span: Span,
    /// Whether `y` is logarithms.
    pub is_log: bool,
    /// Independent readings that the criterion counts.
    pub readings: f64,
}

/// A number with its 95 % interval; an open end is none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Value.
    pub value: f64,
    /// Lower end.
    pub low_95: Option<f64>,
    /// Upper end.
    pub high_95: Option<f64>,
}

/// A fitted law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fitted {
    /// The law.
    pub law: Law,
    /// Logarithm of the ratio of the value at the high end to that at the low end; a difference on a plain scale.
    pub size: Interval,
    /// Threshold, knee, step or time constant in the covariate's unit, where the law has one.
    pub bend_at: Option<Interval>,
    /// Bend of the best fit.
    pub bend: Bend,
    /// Bayesian information criterion, with as many readings as are left free by groups and other columns.
    pub bic: f64,
}

/// The law at `x`: logarithm of the ratio to its start, or difference.
pub fn value_at(law: Law, size: f64, x: f64, span: Span, bend: Bend, is_log: bool) -> f64 {
    at_progress(size, progress(law, x, span, bend), is_log && is_of_amounts(law))
}

/// Fits every law that the values allow, the best by the criterion first.
pub fn compare(material: &Material, laws: &[Law]) -> Vec<Fitted> {
    let mut fitted: Vec<Fitted> = laws.iter().filter_map(|&law| fit(material, law)).collect();
    fitted.sort_by(|a, b| a.bic.total_cmp(&b.bic));
    // Of laws that are as good the plainest one gives the name.
    let as_good = fitted
        .iter()
        .take_while(|one| one.bic <= fitted[0].bic + AS_GOOD)
        .count();
    let plainest = (0..as_good).min_by_key(|&k| {
        let law = fitted[k].law;
        (law.paid_for(), laws.iter().position(|known| *known == law))
    });
    if let Some(plainest) = plainest {
        let chosen = fitted.remove(plainest);
        fitted.insert(0, chosen);
    }
    fitted
}

/// Bayesian information criterion of what leaves a `square`, for so many `parameters`.
fn criterion(square: f64, readings: f64, parameters: usize) -> f64 {
    let n = readings.max(1.0);
    n * (square.max(1e-12) / n).ln() + parameters as f64 * n.ln()
}

/// What laws leave of a series.
struct Left<'a> {
    material: &'a Material<'a>,
    /// What nuisance leaves of the values.
    left: Vec<f64>,
}

impl Left<'_> {
    /// Sum of squares that is left beside a curve.
    fn square(&self, curve: &[f64]) -> f64 {
        let column = self.material.nuisance.residual(curve);
        self.left.iter().zip(column).map(|(y, c)| (y - c).powi(2)).sum()
    }

    /// The factor of a curve that leaves least, and the curve's own square.
    fn factor(&self, curve: &[f64]) -> (f64, f64) {
        let column = self.material.nuisance.residual(curve);
        let square = dot(&column, &column);
        (dot(&column, &self.left) / square, square)
    }
}

/// Fits one law; none where its bends are not to be had or nothing is left free.
pub fn fit(material: &Material, law: Law) -> Option<Fitted> {
    let mut bends = shape::bends(law, material.levels, material.span);
    let freedom = material.nuisance.freedom().checked_sub(law.parameters())?;
    // A bend needs readings about it: three more for each number beyond the first.
    if bends.is_empty() || freedom + 2 < 3 * law.parameters() {
        return None;
    }
    let all = Left {
        material,
        left: material.nuisance.residual(material.y),
    };
    let made = |bends: &[Bend]| -> Vec<Shape> {
        bends
            .iter()
            .map(|&bend| Shape::new(material, law, bend))
            .collect()
    };
    let mut shapes = made(&bends);
    let best_of = |shapes: &[Shape]| -> Option<(f64, f64, usize)> {
        let each = shapes.iter().enumerate().map(|(k, shape)| {
            let (size, square) = shape.best(&all);
            (size, square, k)
        });
        each.min_by(|a, b| a.1.total_cmp(&b.1))
    };
    let (mut size, mut square, mut k) = best_of(&shapes)?;
    for _ in 0..FINER {
        let more = shape::finer(law, &bends, k);
        shapes.extend(made(&more));
        bends.extend(more);
        (size, square, k) = best_of(&shapes)?;
    }
    let spread = (square / freedom as f64).max(1.0);
    let allowed = square + quantile_95(freedom as f64).powi(2) * spread;
    let profile = |size: f64| -> f64 {
        let each = shapes.iter().map(|shape| shape.square(&all, size));
        each.fold(f64::INFINITY, f64::min)
    };
    let size = Interval {
        value: size,
        low_95: end(&profile, size, -1.0, allowed),
        high_95: end(&profile, size, 1.0, allowed),
    };
    let has_bend = law.parameters() > 1;
    Some(Fitted {
        law,
        size,
        bend_at: has_bend.then(|| bend_interval(material, law, (&bends, &shapes), &all, k, allowed)),
        bend: bends[k],
        bic: criterion(square, material.readings, law.paid_for()),
    })
}

/// A law with one bend: its progress at every value of the covariate.
struct Shape {
    progress: Vec<f64>,
    by_amount: bool,
}

impl Shape {
    fn new(material: &Material, law: Law, bend: Bend) -> Shape {
        let progress = |&x: &f64| progress(law, x, material.span, bend);
        Shape {
            progress: material.x.iter().map(progress).collect(),
            by_amount: material.is_log && is_of_amounts(law),
        }
    }

    /// Sum of squares with that size.
    fn square(&self, over: &Left, size: f64) -> f64 {
        let curve: Vec<f64> = (self.progress.iter())
            .map(|&g| at_progress(size, g, self.by_amount))
            .collect();
        over.square(&curve)
    }

    /// Best size, with its sum of squares.
    fn best(&self, over: &Left) -> (f64, f64) {
        let (linear, plain) = over.factor(&self.progress);
        if plain <= 1e-14 {
            return (0.0, self.square(over, 0.0));
        }
        if !self.by_amount {
            return (linear, self.square(over, linear));
        }
        let square = |size: f64| self.square(over, size);
        let coarse = (-24..=24).map(|k| 0.5 * f64::from(k));
        let start = coarse
            .chain([linear.clamp(-LARGEST, LARGEST)])
            .map(|size| (size, square(size)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map_or(0.0, |(size, _)| size);
        let size = golden(square, start - 0.5, start + 0.5);
        (size, square(size))
    }
}

/// Where the profile reaches `allowed` in one direction; none where it does not within [`LARGEST`].
fn end(profile: &dyn Fn(f64) -> f64, from: f64, direction: f64, allowed: f64) -> Option<f64> {
    let (mut inside, mut step) = (from, 1e-4_f64);
    while step <= 2.0 * LARGEST {
        let next = from + direction * step;
        if profile(next) > allowed {
            return Some(edge(inside, next, 30, |size| profile(size) <= allowed));
        }
        inside = next;
        step *= 1.7;
    }
    None
}

fn bend_interval(
    material: &Material,
    law: Law,
    (bends, shapes): (&[Bend], &[Shape]),
    all: &Left,
    best: usize,
    allowed: f64,
) -> Interval {
    let span = material.span;
    let in_unit = |at: f64| match law {
        Law::Knee | Law::Step => span.low + at * span.length(),
        _ => at * span.length(),
    };
    let held: Vec<f64> = bends
        .iter()
        .zip(shapes)
        .filter(|(_, shape)| shape.best(all).1 <= allowed)
        .map(|(bend, _)| bend.at)
        .collect();
    let (low, high) = (
        held.iter().copied().fold(f64::INFINITY, f64::min),
        held.iter().copied().fold(f64::NEG_INFINITY, f64::max),
    );
    // The ends lie between what holds and what does not; where nothing beyond was tried, the end is open.
    let below = bends
        .iter()
        .map(|bend| bend.at)
        .filter(|at| *at < low)
        .reduce(f64::max);
    let above = bends
        .iter()
        .map(|bend| bend.at)
        .filter(|at| *at > high)
        .reduce(f64::min);
    Interval {
        value: in_unit(bends[best].at),
        low_95: below.map(in_unit),
        high_95: above.map(in_unit),
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    /// Eight samples at nine humidities with offsets; the law hidden in them.
    fn hidden(law: Law, size: f64, bend: Bend, sigma: f64, seed: u64) -> (Vec<f64>, Vec<f64>, Vec<usize>) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let span = Span {
            low: 10.0,
            high: 90.0,
        };
        let (mut x, mut y, mut sample) = (Vec::new(), Vec::new(), Vec::new());
        for s in 0..8 {
            let offset = 0.4 * normal();
            for k in 0..9 {
                let humidity = 10.0 + 10.0 * f64::from(k);
                x.push(humidity);
                y.push(offset + value_at(law, size, humidity, span, bend, true) + sigma * normal());
                sample.push(s);
            }
        }
        (x, y, sample)
    }

    fn compared(x: &[f64], y: &[f64], sample: &[usize], sigma: f64, laws: &[Law]) -> Vec<Fitted> {
        let variance = vec![sigma * sigma; y.len()];
        let nuisance = Grouped::new(&variance, sample, &[]);
        let mut levels = x.to_vec();
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        let material = Material {
            y,
            variance: &variance,
            nuisance: &nuisance,
            x,
            levels: &levels,
            span: Span::of(x),
            is_log: true,
            readings: nuisance.freedom() as f64,
        };
        compare(&material, laws)
    }

    #[test]
    fn the_law_that_was_hidden_is_chosen() {
        let plain = Bend { at: 0.0, part: 1.0 };
        for (law, size, bend) in [(Law::Exponential, 2.5, plain), (Law::Linear, 2.5, plain)] {
            let (x, y, sample) = hidden(law, size, bend, 0.1, 5);
            let found = compared(&x, &y, &sample, 0.1, &[Law::Exponential, Law::Linear]);
            assert_eq!(found[0].law, law, "{found:#?}");
            let size_found = found[0].size;
            assert!((size_found.value - size).abs() < 0.15, "{law:?} {size_found:?}");
        }
    }

    #[test]
    fn a_trend_bends_where_it_was_bent() {
        let knee = Bend { at: 0.5, part: 0.0 };
        let (x, y, sample) = hidden(Law::Knee, -1.0, knee, 0.05, 9);
        let found = compared(
            &x,
            &y,
            &sample,
            0.05,
            &[
                Law::Linear,
                Law::SquareRoot,
                Law::Exponential,
                Law::Approach,
                Law::Step,
                Law::Knee,
            ],
        );
        assert_eq!(found[0].law, Law::Knee);
        let at = found[0].bend_at.unwrap();
        assert!(
            at.low_95.unwrap() <= 50.0 && at.high_95.unwrap() >= 50.0,
            "{at:?}"
        );
    }

    #[test]
    fn intervals_hold_the_truth_as_often_as_they_say() {
        let plain = Bend { at: 0.0, part: 1.0 };
        let tries = if std::env::var_os("IEAP_LONG").is_some() {
            1000
        } else {
            150
        };
        for law in [Law::Exponential, Law::Linear] {
            let mut held = 0;
            for seed in 0..tries {
                let (x, y, sample) = hidden(law, 0.6, plain, 0.3, 100 + seed);
                let found = compared(&x, &y, &sample, 0.3, &[law])[0].size;
                held += u64::from(found.low_95.unwrap() <= 0.6 && 0.6 <= found.high_95.unwrap());
            }
            let part = held as f64 / tries as f64;
            println!(
                "{law:?}: {:.1} % of {tries} intervals hold the truth",
                100.0 * part
            );
            assert!(
                (0.95 - part).abs() < 3.5 * (0.05 * 0.95 / tries as f64).sqrt(),
                "{law:?} {part}"
            );
        }
    }
}
