//! A number that the readings tell through all else that is fitted: where the sum of squares along it is least, and how far to
//! either side it is as good.

/// Halvings of the stretch in which the least, or an end, is sought.
const HALVED: usize = 8;

/// Where a sum of squares is least, and the ends within which it rises by no more than was allowed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Line {
    pub(crate) best: f64,
    pub(crate) least: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Line {
    /// Of the sum of squares `square` between the first and the last of `tried`, which rise and hold its valley between two
    /// neighbours of one of them; none where it is nowhere a number.
    pub(crate) fn of(
        tried: &[f64],
        square: impl Fn(f64) -> f64,
        allowed: impl Fn(f64) -> f64,
    ) -> Option<Line> {
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
                let mut outside = tried[place];
                for _ in 0..HALVED {
                    let middle = 0.5 * (inside + outside);
                    if is_as_good(square(middle)) {
                        inside = middle;
                    } else {
                        outside = middle;
                    }
                }
                break;
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
