//! The laws: how a parameter may follow a number, as the logarithm of its ratio to its value at the low end.

use super::covariate::Covariate;
use super::policy::{STEP_PAID, STEP_SIDE};

/// A law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
pub enum Law {
    /// By the same factor for every unit.
    Exponential,
    /// By the same amount for every unit.
    Linear,
    /// By the same factor for every doubling.
    Power,
    /// Nothing up to a threshold, then by the same factor for every unit.
    Threshold,
    /// By the same amount for every unit of the square root.
    SquareRoot,
    /// Towards a final value, exponentially.
    Approach,
    /// By one factor for every unit up to a knee, by another after it.
    Knee,
    /// One value up to a place, another one from there on.
    Step,
    /// What a rest leaves: a factor that fades exponentially with the rest.
    Decay,
    /// A factor between names.
    Jump,
    /// Samples differ.
    Offset,
}

impl Law {
    /// Stored name.
    pub fn key(self) -> &'static str {
        match self {
            Law::Exponential => "exponential",
            Law::Linear => "linear",
            Law::Power => "power",
            Law::Threshold => "threshold",
            Law::SquareRoot => "square-root",
            Law::Approach => "approach",
            Law::Knee => "knee",
            Law::Step => "step",
            Law::Decay => "decay",
            Law::Jump => "jump",
            Law::Offset => "offset",
        }
    }

    /// Laws that are compared for a covariate, the plainest first.
    pub fn of(covariate: Covariate) -> &'static [Law] {
        match covariate {
            Covariate::RelativeHumidity | Covariate::Temperature => {
                &[Law::Exponential, Law::Linear, Law::Power, Law::Threshold]
            }
            Covariate::RestBefore => &[Law::Decay],
            Covariate::FirstRun | Covariate::Direction => &[Law::Jump],
            covariate if Covariate::OF_AGE.contains(&covariate) => &[
                Law::Linear,
                Law::SquareRoot,
                Law::Exponential,
                Law::Approach,
                Law::Step,
                Law::Knee,
            ],
            Covariate::TagNumber(_) => &[Law::Linear, Law::Exponential],
            Covariate::Batch | Covariate::Sample => &[Law::Offset],
            _ => &[Law::Jump],
        }
    }

    /// Number of free numbers.
    pub fn parameters(self) -> usize {
        match self {
            Law::Threshold | Law::Approach | Law::Decay | Law::Step => 2,
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

    /// Unit of the law's [`coefficient`], in words.
    pub fn coefficient_unit(self) -> &'static str {
        match self {
            Law::Exponential | Law::Threshold | Law::Knee => "ln ratio per unit",
            Law::Linear => "part of the value at the low end per unit",
            Law::Power => "exponent",
            Law::SquareRoot => "part of the value at the low end per root of the unit",
            Law::Approach => "part of the value at the low end, finally",
            Law::Decay => "ln ratio at the shortest rest",
            Law::Jump | Law::Step => "ln ratio",
            Law::Offset => "standard deviation of ln between samples",
        }
    }
}

/// The span over which a law is stated.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
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
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Bend {
    /// Threshold, knee, step, or time constant over the span's length.
    pub at: f64,
    /// Part of the change that falls before the knee at its rate.
    pub part: f64,
}

/// Bends that are tried for a law on values `x` (distinct, rising), as fractions of the span.
pub fn bends(law: Law, levels: &[f64], span: Span) -> Vec<Bend> {
    let plain = vec![Bend { at: 0.0, part: 1.0 }];
    let fractions: Vec<f64> = levels.iter().map(|x| (x - span.low) / span.length()).collect();
    match law {
        // A threshold outside of the inner levels is no threshold: below the second it is a slope, above the last but
        // one it rests on one level.
        Law::Threshold | Law::Knee if fractions.len() < 4 => Vec::new(),
        Law::Threshold => {
            let (first, last) = (fractions[1], fractions[fractions.len() - 2]);
            even(first, last, 17).map(|at| Bend { at, part: 0.0 }).collect()
        }
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
        Law::Decay => (0..15)
            .map(|k| Bend {
                at: 0.05 * 40f64.powf(f64::from(k) / 14.0),
                part: 0.0,
            })
            .collect(),
        Law::Power if span.low <= 0.0 => Vec::new(),
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
        Law::Exponential | Law::Linear | Law::Jump | Law::Offset => u,
        Law::Power => (x / span.low).max(f64::MIN_POSITIVE).ln() / (span.high / span.low).ln(),
        Law::Threshold => (u - bend.at).max(0.0) / (1.0 - bend.at),
        Law::SquareRoot => u.max(0.0).sqrt(),
        Law::Approach => (1.0 - (-u / bend.at).exp()) / (1.0 - (-1.0 / bend.at).exp()),
        Law::Knee => bend.part * u + (1.0 - bend.part) * (u - bend.at).max(0.0) / (1.0 - bend.at),
        Law::Step => f64::from(u >= bend.at),
        Law::Decay => (-u / bend.at).exp(),
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

/// The law's coefficient in [`Law::coefficient_unit`] for a size: `b` of [`form`].
pub fn coefficient(law: Law, size: f64, span: Span, bend: Bend, is_log: bool) -> f64 {
    let length = span.length();
    let amount = if is_log { size.exp_m1() } else { size };
    match law {
        Law::Exponential => size / length,
        Law::Linear => amount / length,
        Law::Power => size / (span.high / span.low).ln(),
        Law::Threshold => size / (length * (1.0 - bend.at)),
        Law::SquareRoot => amount / length.sqrt(),
        Law::Approach => amount / (1.0 - (-1.0 / bend.at).exp()),
        Law::Knee => size * (bend.part + (1.0 - bend.part) / (1.0 - bend.at)) / length,
        Law::Decay | Law::Jump | Law::Step | Law::Offset => size,
    }
}

/// How `y` follows `x` by a law: `λ = a exp(b (RH − RH₀))`, with `a` at the low end of the span, the coefficient `b`, and the
/// threshold, knee, step or time constant `c`.
pub fn form(law: Law, y: &str, x: &str, is_log: bool) -> String {
    let from_start = format!("({x} − {x}₀)");
    let along = match law {
        Law::Exponential | Law::Linear => from_start,
        Law::SquareRoot => format!("√{from_start}"),
        Law::Threshold => format!("max(0, {x} − c)"),
        Law::Approach => format!("(1 − exp(−{from_start}/c))"),
        Law::Decay => format!("exp(−{from_start}/c)"),
        Law::Power if is_log => return format!("{y} = a ({x}/{x}₀)^b"),
        Law::Power => format!("ln({x}/{x}₀)"),
        Law::Step => format!("from {x} = c on"),
        Law::Jump => String::new(),
        Law::Knee if is_log => {
            return format!("ln {y} rises by b per unit of {x} from c on, otherwise before");
        }
        Law::Knee => return format!("{y} rises by b per unit of {x} from c on, otherwise before"),
        Law::Offset if is_log => return format!("ln {y} differs between samples, standard deviation b"),
        Law::Offset => return format!("{y} differs between samples, standard deviation b"),
    };
    let change = format!("b {along}");
    let change = change.trim_end();
    match (law, is_log) {
        (Law::Step, true) => format!("{y} = a, a exp(b) {along}"),
        (Law::Step, false) => format!("{y} = a, a + b {along}"),
        (_, false) => format!("{y} = a + {change}"),
        (law, true) if is_of_amounts(law) => format!("{y} = a (1 + {change})"),
        (_, true) => format!("{y} = a exp({change})"),
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
            Law::Power,
            Law::Threshold,
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
                assert!(coefficient(law, 0.7, span, bend, true).is_finite());
            }
        }
        let bend = bends(Law::Decay, &levels, span)[3];
        assert_eq!(progress(Law::Decay, 10.0, span, bend), 1.0);
    }

    #[test]
    fn few_levels_show_no_threshold() {
        let span = Span {
            low: 20.0,
            high: 80.0,
        };
        assert!(bends(Law::Threshold, &[20.0, 50.0, 80.0], span).is_empty());
        assert!(
            bends(
                Law::Step,
                &[1.0, 2.0, 3.0, 4.0, 5.0],
                Span { low: 1.0, high: 5.0 }
            )
            .is_empty()
        );
        assert!(bends(Law::Power, &[0.0, 50.0], Span { low: 0.0, high: 50.0 }).is_empty());
    }

    #[test]
    fn the_form_and_its_coefficient_give_the_law() {
        let (span, size) = (
            Span {
                low: 10.0,
                high: 60.0,
            },
            0.7,
        );
        let bend = Bend { at: 0.3, part: 0.0 };
        let (x, u) = (45.0, 45.0 - span.low);
        let c = 0.3 * span.length();
        let b = |law, is_log| coefficient(law, size, span, bend, is_log);
        // As `form` says it, with a = 1 on a logarithmic scale, else a = 0.
        let factors = [
            (Law::Exponential, (b(Law::Exponential, true) * u).exp()),
            (Law::Linear, 1.0 + b(Law::Linear, true) * u),
            (Law::Power, (x / span.low).powf(b(Law::Power, true))),
            (Law::Threshold, (b(Law::Threshold, true) * (u - c)).exp()),
            (Law::SquareRoot, 1.0 + b(Law::SquareRoot, true) * u.sqrt()),
            (
                Law::Approach,
                1.0 + b(Law::Approach, true) * (1.0 - (-u / c).exp()),
            ),
            (Law::Decay, (b(Law::Decay, true) * (-u / c).exp()).exp()),
        ];
        for (law, factor) in factors {
            let is = at_progress(size, progress(law, x, span, bend), is_of_amounts(law));
            assert!((is - factor.ln()).abs() < 1e-12, "{law:?}");
        }
        let plain = at_progress(size, progress(Law::Linear, x, span, bend), false);
        assert!((plain - b(Law::Linear, false) * u).abs() < 1e-12);
        assert_eq!(form(Law::Exponential, "λ", "RH", true), "λ = a exp(b (RH − RH₀))");
        assert_eq!(form(Law::Linear, "α", "T", false), "α = a + b (T − T₀)");
        assert_eq!(form(Law::Jump, "α", "x", true), "α = a exp(b)");
    }
}
