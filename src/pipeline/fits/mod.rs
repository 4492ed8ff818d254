//! From stored readings to fits.

pub(super) mod along;
pub(super) mod choice;
pub(super) mod drawn;
pub(super) mod extended;
pub(super) mod groups;
pub(super) mod input_hash;
pub mod instruments;
pub(super) mod outcome;
pub(super) mod plan;
pub mod result;
pub(super) mod runs;
