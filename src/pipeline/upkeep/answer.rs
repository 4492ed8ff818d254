//! A person's answer to words that may be lost: looked after, so that nothing asks for them any more.

use crate::pipeline::campaign::context::now;
use crate::pipeline::{Context, PipelineError};
use crate::store::journal::Entry;

/// Records what came of looking, and who looked, where there is something to answer; gives what may have been lost, in words.
///
/// # Errors
/// Nothing is said; the database or the disk refuses.
pub fn answer(context: &mut Context, why: &str, by: String) -> Result<Vec<String>, PipelineError> {
    let why = why.trim().to_owned();
    if why.is_empty() {
        return Err(PipelineError::BadArgument {
            what: "--answer",
            found: "nothing".to_owned(),
            needed: "what you found in a few words, as in --answer \"said the two drops again\"".to_owned(),
        });
    }
    let lost = context.store.words_missed()?;
    if !lost.is_empty() {
        let answered = (now(), Entry::Answered { why, by });
        context.store.say(&now(), vec![answered])?;
    }
    Ok(lost)
}
