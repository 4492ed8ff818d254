//! Where each state stands in the vector that is integrated.

/// Hands out places, with the state's value at the first edge of the drive.
#[derive(Debug, Clone, Default)]
pub(super) struct States {
    start: Vec<f64>,
}

impl States {
    /// A state that starts at `value`.
    pub fn add(&mut self, value: f64) -> usize {
        self.start.push(value);
        self.start.len() - 1
    }

    /// All states at the first edge.
    pub fn start(self) -> Vec<f64> {
        self.start
    }
}
