//! The zero of an instrument, which is fitted wherever readings tell it.

use crate::policy::TOLD_ZERO_SIGMAS;

/// The zero of an instrument as a fit has it, in the unit of its channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Zero {
    pub(crate) value: f64,
    pub(crate) standard_error: f64,
}

impl Zero {
    /// Whether it is so far off that a note tells it; it is fitted all the same where it is not.
    pub(crate) fn is_plain(&self) -> bool {
        self.value.abs() > TOLD_ZERO_SIGMAS * self.standard_error && self.value != 0.0
    }
}
