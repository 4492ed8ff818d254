//! What monitoring shows is made from.

use super::Monitoring;
use crate::condemned::Aside;
use crate::laws::CampaignLaws;
use crate::tables::TableInput;

/// What monitoring says of a campaign, and what stands beside it.
pub struct Lives<'a> {
    /// What it says.
    pub monitoring: &'a Monitoring,
    /// What holds across runs.
    pub laws: &'a CampaignLaws,
    /// Runs whose readings are known to be wrong.
    pub aside: &'a [Aside],
    /// The campaign with its runs.
    pub of: TableInput<'a>,
}
