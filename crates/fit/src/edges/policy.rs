//! What decides about edges between readings: every number with its unit and where it comes from. What all of them together give,
//! `cargo run --release -p ieap-fit --example sampling_grid -- 40 5000` counts (docs/validation/fitting.md).

/// Part of the variance of what is not known of edges that they share. Chosen: the clock of the readings may be that of the
/// source, and then all edges are off alike, or another one; between the two neither is taken for granted.
pub(super) const SHARED_PART: f64 = 0.75;
/// Edges from which on a period is looked for. Chosen.
pub(super) const FEWEST_FOR_PERIOD: usize = 4;
/// Edges in a period at most. Chosen.
pub(super) const MOST_IN_PERIOD: usize = 12;
/// Levels of one place in the period differ by no more than this part of their range. Chosen.
pub(super) const SAME_LEVEL_PART: f64 = 0.02;
