//! Chances below which something is said: the levels that a diagnosis decides by.

/// The simulation is called wrong below this p ...
pub(crate) const WRONG: f64 = 0.01;
/// ... and right from this one on; between the two nothing is said.
pub(crate) const RIGHT: f64 = 0.05;

/// A candidate is taken where chance gives as much in fewer groups than this, and one that follows a tag where chance does in
/// fewer deals.
pub(crate) const TAKEN: f64 = 0.01;
