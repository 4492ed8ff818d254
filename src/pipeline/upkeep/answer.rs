//! A person's answer to words that may be lost: looked after, so that nothing asks for them any more.

use schemars::JsonSchema;
use serde::Serialize;

use crate::pipeline::campaign::context::now;
use crate::pipeline::{Context, PipelineError};
use crate::store::journal::Entry;

/// The verb `answer`.
#[derive(Debug, Clone)]
pub struct Answer {
    /// What came of looking.
    pub why: String,
    /// Who looked.
    pub by: String,
}

/// What was answered.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Answered {
    /// What may have been lost, in words.
    pub lost: Vec<String>,
}

impl Answer {
    /// Records the answer, where there is something to answer.
    ///
    /// # Errors
    /// There is no reason; the database or the disk refuses.
    pub fn run(&self, context: &mut Context) -> Result<Answered, PipelineError> {
        let why = self.why.trim();
        if why.is_empty() {
            return Err(PipelineError::BadArgument {
                what: "--why",
                found: "nothing".to_owned(),
                needed: "what you found in a few words, as in --why \"said the two drops again\"".to_owned(),
            });
        }
        let lost = context.store.words_missed()?;
        if !lost.is_empty() {
            let (why, by) = (why.to_owned(), self.by.clone());
            let answered = (now(), Entry::Answered { why, by });
            context.store.say(&now(), vec![answered])?;
        }
        Ok(Answered { lost })
    }
}
