//! The runs of a group by themselves, where no cause is found for all of them together.

use serde::Serialize;

use super::finding_words::{counted_from_draws, verdict_word};
use ieap_domain::diagnosis::{RIGHT_FROM, WRONG_BELOW};
use ieap_domain::{RunAlone, Verdict};

/// What a run leaves by itself.
#[derive(Debug, Serialize)]
pub struct AloneRow {
    name: String,
    verdict: &'static str,
    p: String,
}

/// A row for each run; chances are counted from so many draws.
pub fn alone_rows(alone: &[RunAlone], draws: usize) -> Vec<AloneRow> {
    let row = |run: &RunAlone| AloneRow {
        name: run.run.clone(),
        verdict: match run.p_misfit {
            None => verdict_word(Verdict::DataProblem),
            Some(p) if p >= RIGHT_FROM => verdict_word(Verdict::Consistent),
            Some(p) if p >= WRONG_BELOW => verdict_word(Verdict::Undecided),
            Some(_) => "wrong",
        },
        p: counted_from_draws(run.p_misfit, None, draws).0,
    };
    alone.iter().map(row).collect()
}
