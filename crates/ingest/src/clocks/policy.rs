//! What decides between clocks of a run, and where a record leaves its rest: every number with its unit and where it comes from.

/// An estimated offset differs from the one in use by more than this many standard errors. Chosen.
pub(super) const OFF_SIGMAS: f64 = 3.0;
/// An offset that headers state differs from the one in use by more than this, s. Chosen.
pub(super) const OFF_BY_HEADER_S: f64 = 1.0;

/// A departure of the bending exceeds this share of the largest departure. Chosen.
pub(super) const DEPARTURE_SHARE: f64 = 0.01;
/// The largest departure must be this many times the least that counts: else the bending does not leave its noise. Chosen.
pub(super) const LARGEST_OVER_LEAST: f64 = 2.0;
/// Most that the resting level may drift, as a share of the departure that counts. Chosen.
pub(super) const DRIFT_SHARE: f64 = 0.25;
/// Most that it may drift in any case, in standard deviations of a reading. Chosen.
pub(super) const DRIFT_OVER_NOISE: f64 = 1.5;
/// The straight beginning is taken up to this share of the largest departure. Chosen.
pub(super) const BEGINNING_SHARE: f64 = 0.15;
/// Readings that a straight beginning needs. Chosen.
pub(super) const FEWEST_STRAIGHT: usize = 4;
