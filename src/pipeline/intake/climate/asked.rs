//! What the climate of a run depends on, beside the logs and campaign.toml.

use crate::analysis::climate::Window;
use crate::domain::Channel;

/// Least time drawn before and after a run, s.
pub(super) const SURROUNDINGS_S: f64 = 3600.0;

/// What is known of the start of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    /// A moment.
    Known,
    /// A day without a time.
    Day,
    /// Something is stated that is no moment: an issue of the run says why.
    NotUsable,
    /// Nothing is stated.
    NotStated,
}

/// A run, and what is known of it before its climate is.
#[derive(Debug, Clone, Copy)]
pub struct Asked<'a> {
    /// When it was measured; none where its start is not known.
    pub window: Option<Window>,
    /// What is known of its start.
    pub start: Start,
    /// First and last time of its readings, s.
    pub times: Option<(f64, f64)>,
    /// Columns of its file that may hold its climate.
    pub own: &'a [Channel],
    /// Its environment, as tagged.
    pub environment: Option<&'a str>,
    /// Its sample, as tagged.
    pub sample: Option<&'a str>,
}

/// Time around a run that its readings are gathered of, s.
pub(super) fn margin(window: Window) -> f64 {
    (0.5 * (window.to_s - window.from_s)).max(SURROUNDINGS_S)
}
