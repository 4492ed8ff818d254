//! Positions on a panel as pixels, as plotters has them, but for numbers far outside the panel: a reading may be any number,
//! and pixels are counted in 32 bits.

use std::ops::Range;

use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};

use super::axis::Axis;

/// A point that lies farther away than this many lengths of the axis is drawn there: nobody sees it in either place.
const FARTHEST: f64 = 1e3;

/// The positions along an axis.
#[derive(Clone)]
pub struct Positions {
    low: f64,
    high: f64,
}

impl From<&Axis> for Positions {
    fn from(axis: &Axis) -> Positions {
        Positions {
            low: axis.low,
            high: axis.high,
        }
    }
}

impl Ranged for Positions {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, position: &f64, (from, to): (i32, i32)) -> i32 {
        let length = to - from;
        if self.high == self.low {
            return length / 2;
        }
        let along = (position - self.low) / (self.high - self.low);
        let along = along.clamp(-FARTHEST, FARTHEST) * f64::from(length);
        // The small number keeps a position on a whole pixel there in spite of rounding.
        if length > 0 {
            from + (along + 1e-3).floor() as i32
        } else {
            from + (along - 1e-3).ceil() as i32
        }
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        // Ticks are the axis's own.
        Vec::new()
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plotters::coord::types::RangedCoordf64;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn positions_in_sight_are_those_of_plotters(low in -1e6..1e6f64, span in 1e-6..1e6f64, at in -2.0..3.0f64) {
            let own = Positions { low, high: low + span };
            let theirs = RangedCoordf64::from(low..low + span);
            for limit in [(0, 5300), (2100, 0), (7, 7)] {
                let position = low + at * span;
                prop_assert_eq!(own.map(&position, limit), theirs.map(&position, limit));
            }
        }

        #[test]
        fn any_number_has_a_pixel(low in any::<f64>(), high in any::<f64>(), at in any::<f64>()) {
            let pixel = Positions { low, high }.map(&at, (2100, 0));
            prop_assert!(pixel.abs() <= 3_000_000, "{}", pixel);
        }
    }
}
