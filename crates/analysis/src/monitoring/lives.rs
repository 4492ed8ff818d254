//! What monitoring shows is made from.

use super::Monitoring;
use crate::condemned::Aside;
use crate::laws::doubt::Doubted;
use crate::laws::facts::RunFacts;
use crate::study::Study;
use crate::tables::TableInput;

/// What monitoring says of a campaign, and what stands beside it.
pub struct Lives<'a> {
    /// What it says.
    pub monitoring: &'a Monitoring,
    /// What the study says.
    pub study: &'a Study,
    /// Facts of the runs.
    pub facts: &'a [RunFacts],
    /// Groups whose fits are in doubt.
    pub doubted: &'a [Doubted],
    /// Runs whose readings are known to be wrong.
    pub aside: &'a [Aside],
    /// The campaign with its runs.
    pub of: TableInput<'a>,
}
