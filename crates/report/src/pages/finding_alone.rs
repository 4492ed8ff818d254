//! The runs of a group by themselves, where no cause is found for all of them together.

use serde::Serialize;

use ieap_domain::diagnosis::{RIGHT_FROM, WRONG_BELOW};
use ieap_domain::finding_words::verdict_word;
use ieap_domain::number::probabilities::counted;
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
            Some(p) if p >= RIGHT_FROM => verdict_word(Verdict::Right),
            Some(p) if p >= WRONG_BELOW => verdict_word(Verdict::Undecided),
            Some(_) => "wrong",
        },
        p: counted(run.p_misfit, draws),
    };
    alone.iter().map(row).collect()
}
