//! A quantity along the strip and in time.

/// Values at positions along the strip (fastest index) and at times.
#[derive(Debug, Clone, PartialEq)]
pub struct StripField {
    /// Number of positions.
    pub positions: usize,
    /// Values, one row of positions per time.
    pub values: Vec<f64>,
    /// Bound on what the omitted terms of the series add to any value, same unit; none where the field does not
    /// come from a series.
    pub truncation_bound: Option<f64>,
}

impl StripField {
    /// The profile along the strip at the time of that index.
    pub fn profile(&self, time: usize) -> &[f64] {
        &self.values[time * self.positions..(time + 1) * self.positions]
    }

    /// The value at the time and the position of these indices.
    pub fn at(&self, time: usize, position: usize) -> f64 {
        self.profile(time)[position]
    }
}
