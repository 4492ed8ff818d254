//! The runs of a group by themselves, where no cause is found for all of them together.

use ieap_domain::diagnosis::{RIGHT_FROM, WRONG_BELOW};
use ieap_domain::finding_words::verdict_word;
use ieap_domain::number::probabilities::counted;
use ieap_domain::{GroupDiagnosis, RunAlone, Verdict};
use ieap_show::{Block, Sheet, Source};

/// A row for each run; none where nothing was asked of them.
pub fn alone(found: &GroupDiagnosis) -> Option<Block> {
    let table = Sheet::<&RunAlone>::new("alone", "", 1)
        .remarks(
            "Each run by itself, with base parameters of its own. Its p is not corrected for the number of runs.",
            "",
        )
        .made_from(|run| vec![Source::file(&run.run)])
        .plain("Run", |run| run.run.as_str())
        .plain("Finding", |run| match run.p_misfit {
            None => verdict_word(Verdict::DataProblem),
            Some(p) if p >= RIGHT_FROM => verdict_word(Verdict::Right),
            Some(p) if p >= WRONG_BELOW => verdict_word(Verdict::Undecided),
            Some(_) => "wrong",
        })
        .plain("p", |run| counted(run.p_misfit, found.draws))
        .over(&found.alone);
    (!found.alone.is_empty()).then(|| Block::part("Each run by itself", vec![Block::Table(table)]))
}
