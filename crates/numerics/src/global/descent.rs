//! Damped Gauss-Newton descent from the promising places of a coarse look.

use super::{Effort, Landscape, Method};
use crate::least_squares::{Levenberg, Minimum, Stop};

/// Part of the sum of squares at which descents settle that only compare valleys.
const SETTLE_COARSE: f64 = 1e-3;
/// Evaluations allowed to one descent.
const LIMIT: u64 = 80;

/// Descends from every start a little and from the best of them to the bottom.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Descent;

impl Method for Descent {
    fn id(&self) -> &'static str {
        "variable-projection"
    }

    fn name(&self) -> &'static str {
        "variable projection"
    }

    fn description(&self) -> &'static str {
        "coarse look at the whole box, then damped Gauss-Newton descent with the linear parameters eliminated"
    }

    fn is_random(&self) -> bool {
        false
    }

    fn minimise(&self, landscape: &dyn Landscape, effort: Effort) -> Minimum {
        let resolution = 4.0 * f64::EPSILON * landscape.size();
        let mut evaluations = 0;
        let mut descend = |start: &[f64], settle: f64| {
            let found = Levenberg::by_region(LIMIT, settle, resolution).search(landscape, start);
            evaluations += found.evaluations;
            found
        };
        let mut best: Option<Minimum> = None;
        for start in landscape.starts() {
            let found = descend(&start, SETTLE_COARSE.max(effort.settle));
            if (best.as_ref()).is_none_or(|least| found.local.square < least.local.square) {
                best = Some(found);
            }
        }
        let start = match best {
            // A sum that is no number stays none wherever the search goes on.
            Some(found) if effort.settle >= SETTLE_COARSE || found.stop == Stop::NotFinite => {
                return Minimum { evaluations, ..found };
            }
            Some(found) => found.at,
            None => landscape.bounds().middle(),
        };
        let found = descend(&start, effort.settle);
        Minimum { evaluations, ..found }
    }
}
