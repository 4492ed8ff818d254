//! A number along a line: where something begins to hold, where a sum of squares is least, and how far to either side of that
//! it is as good.

/// Halvings of the stretch in which the least, or an end, is sought.
const HALVED: usize = 8;
/// Cuts of a golden section: what is left is a part of 3e-8.
const GOLDEN_CUTS: usize = 36;

/// Halves the stretch from a place `inside`, where something holds, to one `outside`, where it does not, so many times: what is
/// then left of it, the end inside first.
pub fn halved(inside: f64, outside: f64, times: usize, mut holds: impl FnMut(f64) -> bool) -> (f64, f64) {
    let (mut inside, mut outside) = (inside, outside);
    for _ in 0..times {
        let middle = 0.5 * (inside + outside);
        if holds(middle) {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    (inside, outside)
}

/// The same to a place between the two that are then left.
pub fn edge(inside: f64, outside: f64, times: usize, holds: impl FnMut(f64) -> bool) -> f64 {
    let (inside, outside) = halved(inside, outside, times, holds);
    0.5 * (inside + outside)
}

/// Where something with one bottom between `low` and `high` is least, by the golden section.
pub fn golden(of: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let ratio = 0.5 * (5f64.sqrt() - 1.0);
    let (mut a, mut b) = (high - ratio * (high - low), low + ratio * (high - low));
    let (mut at_a, mut at_b) = (of(a), of(b));
    for _ in 0..GOLDEN_CUTS {
        if at_a < at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - ratio * (high - low);
            at_a = of(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + ratio * (high - low);
            at_b = of(b);
        }
    }
    0.5 * (low + high)
}

/// Where a sum of squares is least, and the ends within which it rises by no more than was allowed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Where it is least.
    pub best: f64,
    /// The sum of squares there.
    pub least: f64,
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

impl Line {
    /// Of the sum of squares `square` between the first and the last of `tried`, which rise and hold its valley between two
    /// neighbours of one of them; none where it is nowhere a number.
    pub fn of(tried: &[f64], square: impl Fn(f64) -> f64, allowed: impl Fn(f64) -> f64) -> Option<Line> {
        let squares: Vec<f64> = tried.iter().map(|at| square(*at)).collect();
        let near = (0..tried.len()).min_by(|a, b| squares[*a].total_cmp(&squares[*b]))?;
        if !squares[near].is_finite() {
            return None;
        }
        let last = tried.len() - 1;
        let (mut low, mut high) = (tried[near.saturating_sub(1)], tried[(near + 1).min(last)]);
        let (mut best, mut least) = (tried[near], squares[near]);
        for _ in 0..HALVED {
            for at in [0.5 * (low + best), 0.5 * (best + high)] {
                let found = square(at);
                if found < least {
                    (least, best) = (found, at);
                }
            }
            (low, high) = (0.5 * (low + best), 0.5 * (best + high));
        }
        let rise = allowed(best);
        let is_as_good = |own: f64| own - least <= rise;
        let end = |places: &mut dyn Iterator<Item = usize>| {
            let mut inside = best;
            for place in places {
                if is_as_good(squares[place]) {
                    inside = tried[place];
                    continue;
                }
                return halved(inside, tried[place], HALVED, |at| is_as_good(square(at))).0;
            }
            inside
        };
        Some(Line {
            best,
            least,
            low: end(&mut (0..=last).rev().filter(|place| tried[*place] < best)),
            high: end(&mut (0..=last).filter(|place| tried[*place] > best)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_and_bottoms_are_found_to_what_is_left_of_the_stretch() {
        assert!((edge(0.0, 3.0, 50, |x| x * x < 2.0) - 2f64.sqrt()).abs() < 1e-14);
        // The place inside may lie on either side.
        let (inside, outside) = halved(3.0, 0.0, 20, |x| x * x > 2.0);
        assert!(inside > 2f64.sqrt() && outside < 2f64.sqrt() && inside - outside < 1e-5);
        assert!((golden(|x| (x - 0.3).powi(2), -1.0, 2.0) - 0.3).abs() < 1e-6);
    }

    #[test]
    fn a_valley_is_found_with_its_ends() {
        let tried: Vec<f64> = (0..12).map(|k| 0.01 * 2_f64.powi(k)).collect();
        let square = |at: f64| 3.0 + 4.0 * (at - 0.7).powi(2);
        let line = Line::of(&tried, square, |_| 1.0).unwrap();
        assert!(
            (line.best - 0.7).abs() < 2e-3 && (line.least - 3.0).abs() < 1e-4,
            "{line:?}"
        );
        assert!(
            (line.low - 0.2).abs() < 5e-3 && (line.high - 1.2).abs() < 5e-3,
            "{line:?}"
        );
        assert_eq!(Line::of(&tried, |_| f64::INFINITY, |_| 1.0), None);
        // A valley that goes on: the end is the last that was tried.
        let open = Line::of(&tried, |at| (-at).exp(), |_| 1.0).unwrap();
        assert_eq!(open.high, tried[11]);
    }
}
