//! What `--json` prints, from what is stored.

pub mod comparison;
pub mod diagnosis;
pub mod dma;
pub mod doubted;
pub mod fits;
pub mod group_lines;
pub mod groups;
pub mod lengthwise;
pub(super) mod shared_effects;
