//! Runs that no campaign holds: readings that a caller has at hand, read, fitted, diagnosed and simulated as the verbs do it.
//!
//! What follows from readings and from what is stated of them is made by the same functions as in a campaign, so that the
//! same readings give the same bytes in both.

mod campaign_row;
mod criteria;
mod diagnose;
mod exact;
mod fit;
mod needed;
mod read;
mod run;
mod simulate;
#[cfg(test)]
mod tests;
mod without_model;

pub use campaign_row::CampaignRow;
pub use criteria::{Criteria, criteria};
pub use diagnose::diagnose;
pub use fit::{FitAtHand, drive_as_fitted, fit, fit_options};
pub use needed::{fitted_places_mm, needed_keys};
pub use read::{Column, ReadTable, arrays, read, unit_of};
pub use run::{RunAtHand, Stated, Strip};
pub use simulate::{Curvature, Curves, CurvesAsked, simulate};
pub use without_model::{cycles, impedance};
