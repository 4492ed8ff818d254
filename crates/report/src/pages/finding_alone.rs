//! The runs of a group by themselves, where no cause is found for all of them together.

use serde::Serialize;

use super::finding_words::{counted_from_draws, proved_or_not};
use ieap_domain::RunAlone;

/// A run diagnosed by itself.
#[derive(Debug, Serialize)]
pub struct AloneRow {
    name: String,
    verdict: &'static str,
    p: String,
    set: String,
}

/// A row for each run.
pub fn alone_rows(alone: &[RunAlone]) -> Vec<AloneRow> {
    let row = |run: &RunAlone| AloneRow {
        name: run.run.clone(),
        verdict: proved_or_not(run.verdict, run.gains_clearly),
        p: counted_from_draws(run.p_misfit, None).0,
        set: run.set.join(", "),
    };
    alone.iter().map(row).collect()
}
