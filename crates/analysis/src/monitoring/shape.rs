//! The laws of a trend: how a parameter may go on, as the logarithm of its ratio to its value at the low end.

use super::policy::{STEP_PAID, STEP_SIDE};

/// A law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Law {
    /// By the same factor for every unit.
    Exponential,
    /// By the same amount for every unit.
    Linear,
    /// By the same amount for every unit of the square root.
    SquareRoot,
    /// Towards a final value, exponentially.
    Approach,
    /// By one factor for every unit up to a knee, by another after it.
    Knee,
    /// One value up to a place, another one from there on.
    Step,
}

impl Law {
    /// Stored name.
    pub fn key(self) -> &'static str {
        match self {
            Law::Exponential => "exponential",
            Law::Linear => "linear",
            Law::SquareRoot => "square-root",
            Law::Approach => "approach",
            Law::Knee => "knee",
            Law::Step => "step",
        }
    }

    /// Number of free numbers.
    pub fn parameters(self) -> usize {
        match self {
            Law::Approach | Law::Step => 2,
            Law::Knee => 3,
            _ => 1,
        }
    }

    /// Numbers that the law pays for in a comparison: those that are free, the place of a step counted twice. Nothing is
    /// smooth about it, so that looking for it anywhere gains as much as two smooth numbers do (Zhang and Siegmund 2007).
    pub fn paid_for(self) -> usize {
        match self {
            Law::Step => STEP_PAID,
            law => law.parameters(),
        }
    }
}

/// The span over which a law is stated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Smallest value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
}

impl Span {
    /// Of values.
    pub fn of(x: &[f64]) -> Span {
        Span {
            low: x.iter().copied().fold(f64::INFINITY, f64::min),
            high: x.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        }
    }

    /// Length.
    pub fn length(self) -> f64 {
        self.high - self.low
    }
}

/// What shapes a law beside its size: fractions of the span.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bend {
    /// Knee, step, or time constant over the span's length.
    pub at: f64,
    /// Part of the change that falls before the knee at its rate.
    pub part: f64,
}

/// Bends that are tried for a law on values `x` (distinct, rising), as fractions of the span.
pub fn bends(law: Law, levels: &[f64], span: Span) -> Vec<Bend> {
    let plain = vec![Bend { at: 0.0, part: 1.0 }];
    let fractions: Vec<f64> = levels.iter().map(|x| (x - span.low) / span.length()).collect();
    match law {
        // A knee outside of the inner levels is none: below the second it is a slope, above the last but one it rests on one
        // level.
        Law::Knee if fractions.len() < 4 => Vec::new(),
        Law::Knee => {
            let (first, last) = (fractions[1], fractions[fractions.len() - 2]);
            even(first, last, 11)
                .flat_map(|at| even(-0.4, 0.8, 7).map(move |part| Bend { at, part }))
                .collect()
        }
        Law::Step if fractions.len() < 2 * STEP_SIDE => Vec::new(),
        Law::Step => (STEP_SIDE..=fractions.len() - STEP_SIDE)
            .map(|k| Bend {
                at: 0.5 * (fractions[k - 1] + fractions[k]),
                part: 0.0,
            })
            .collect(),
        Law::Approach if fractions.len() < 4 => Vec::new(),
        Law::Approach => (0..15)
            .map(|k| Bend {
                at: 0.03 * 33f64.powf(f64::from(k) / 14.0),
                part: 0.0,
            })
            .collect(),
        _ => plain,
    }
}

/// Bends about the one at `best`, between its neighbours among those tried.
pub fn finer(law: Law, tried: &[Bend], best: usize) -> Vec<Bend> {
    if law.parameters() < 2 {
        return Vec::new();
    }
    let center = tried[best];
    let others = || tried.iter().map(|bend| bend.at);
    let below = others()
        .filter(|at| *at < center.at)
        .reduce(f64::max)
        .unwrap_or(center.at);
    let above = others()
        .filter(|at| *at > center.at)
        .reduce(f64::min)
        .unwrap_or(center.at);
    even(below, above, 7)
        .filter(|at| *at != center.at && *at != below && *at != above)
        .map(|at| Bend { at, ..center })
        .collect()
}

fn even(from: f64, to: f64, count: usize) -> impl Iterator<Item = f64> + Clone {
    (0..count).map(move |k| from + (to - from) * k as f64 / (count - 1) as f64)
}

/// How far along the law is at `x`: 0 at one end of the span, 1 at the other.
pub fn progress(law: Law, x: f64, span: Span, bend: Bend) -> f64 {
    let u = (x - span.low) / span.length();
    match law {
        Law::Exponential | Law::Linear => u,
        Law::SquareRoot => u.max(0.0).sqrt(),
        Law::Approach => (1.0 - (-u / bend.at).exp()) / (1.0 - (-1.0 / bend.at).exp()),
        Law::Knee => bend.part * u + (1.0 - bend.part) * (u - bend.at).max(0.0) / (1.0 - bend.at),
        Law::Step => f64::from(u >= bend.at),
    }
}

/// Whether amounts, not factors, go with the progress.
pub fn is_of_amounts(law: Law) -> bool {
    matches!(law, Law::Linear | Law::SquareRoot | Law::Approach)
}

/// Logarithm of the ratio at progress `g`, where it is `size` at progress 1. `by_amount` is
/// [`is_of_amounts`] on a logarithmic scale, false elsewhere.
pub fn at_progress(size: f64, g: f64, by_amount: bool) -> f64 {
    if by_amount {
        (1.0 + size.exp_m1() * g).max(1e-12).ln()
    } else {
        size * g
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_law_is_0_at_its_start_and_its_size_at_its_end() {
        let span = Span {
            low: 10.0,
            high: 90.0,
        };
        let levels = [10.0, 30.0, 50.0, 60.0, 70.0, 90.0];
        for law in [
            Law::Exponential,
            Law::Linear,
            Law::SquareRoot,
            Law::Approach,
            Law::Step,
            Law::Knee,
        ] {
            for bend in bends(law, &levels, span) {
                let at = |x| at_progress(0.7, progress(law, x, span, bend), is_of_amounts(law));
                assert!(
                    at(10.0).abs() < 1e-12 && (at(90.0) - 0.7).abs() < 1e-9,
                    "{law:?} {bend:?}"
                );
            }
        }
    }

    #[test]
    fn few_levels_show_no_knee() {
        let span = Span {
            low: 20.0,
            high: 80.0,
        };
        assert!(bends(Law::Knee, &[20.0, 50.0, 80.0], span).is_empty());
        assert!(
            bends(
                Law::Step,
                &[1.0, 2.0, 3.0, 4.0, 5.0],
                Span { low: 1.0, high: 5.0 }
            )
            .is_empty()
        );
    }
}
