//! The box that a search stays in.

/// The least and the greatest value of every coordinate.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Bounds {
    /// The least values.
    pub low: Vec<f64>,
    /// The greatest values.
    pub high: Vec<f64>,
}

impl Bounds {
    /// The same limits for so many coordinates.
    pub fn even(count: usize, low: f64, high: f64) -> Bounds {
        Bounds {
            low: vec![low; count],
            high: vec![high; count],
        }
    }

    /// Limits `reach` to either side of a place.
    pub fn about(at: &[f64], reach: f64) -> Bounds {
        Bounds {
            low: at.iter().map(|x| x - reach).collect(),
            high: at.iter().map(|x| x + reach).collect(),
        }
    }

    /// The place in the middle.
    pub fn middle(&self) -> Vec<f64> {
        let pairs = self.low.iter().zip(&self.high);
        pairs.map(|(low, high)| 0.5 * (low + high)).collect()
    }

    /// Number of coordinates.
    pub fn count(&self) -> usize {
        self.low.len()
    }

    /// Limits of one coordinate more.
    pub fn push(&mut self, low: f64, high: f64) {
        self.low.push(low);
        self.high.push(high);
    }

    /// Sets the limits of coordinate `k`.
    pub fn set(&mut self, k: usize, low: f64, high: f64) {
        (self.low[k], self.high[k]) = (low, high);
    }

    /// The value of coordinate `k`, or the limit that it passes; the lower one for what is no number.
    pub fn nearest(&self, k: usize, value: f64) -> f64 {
        value.max(self.low[k]).min(self.high[k])
    }

    /// Whether coordinate `k` may take that value.
    pub fn contain(&self, k: usize, value: f64) -> bool {
        value >= self.low[k] && value <= self.high[k]
    }
}
