//! What the model says of a group of series.

use ieap_domain::Drive;
use ieap_model::distributed::DrivenStrip;

use super::described::Described;
use super::readings::SeriesGroup;

/// Values of every series of the group, one after the other, each over all times.
pub(super) fn predicted(described: &Described, drive: &Drive, group: &SeriesGroup) -> Vec<f64> {
    let at = described.contact_break.map(|at| (at.place_cm, at.factor));
    let strip = DrivenStrip::new(&described.model, described.mu_per_c, at);
    strip.respond(group.kind.quantity(), drive, &group.positions_cm, &group.time_s)
}
