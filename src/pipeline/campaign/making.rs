//! How results are made of stored readings, whatever they are: readings are fetched one after the other, results made on all
//! cores, a few subjects at a time, and what was made before an interruption is kept.

use rayon::prelude::*;

use crate::numerics::interrupt;
use crate::pipeline::{Context, Observer, PipelineError};

/// The making of one kind of result.
pub(crate) struct Making<'a> {
    /// What is done, for the progress.
    pub doing: &'static str,
    /// Subjects between two commits: bounds memory, and what an interruption costs.
    pub at_once: usize,
    /// Hears of the progress.
    pub observer: &'a dyn Observer,
    /// Asked before each subject; none is begun after a no.
    pub may_go_on: &'a (dyn Fn() -> bool + Sync),
}

/// Goes on to the end.
pub(crate) const TO_THE_END: &(dyn Fn() -> bool + Sync) = &|| true;

impl Making<'_> {
    /// Makes what is due: `load` fetches a subject's readings, `make` is a pure function of both, `save` stores what was made
    /// of a batch, in its order.
    ///
    /// # Errors
    /// Of `load` and `save`; what cannot be made is a result, and no error.
    pub fn run<S: Sync, R: Send, M: Send>(
        &self,
        context: &mut Context,
        due: &[S],
        load: impl Fn(&Context, &S) -> Result<R, PipelineError>,
        make: impl Fn(&S, R) -> M + Sync,
        mut save: impl FnMut(&mut Context, Vec<(&S, M)>) -> Result<(), PipelineError>,
    ) -> Result<(), PipelineError> {
        if due.is_empty() {
            return Ok(());
        }
        self.observer.begin(self.doing, due.len() as u64);
        for batch in due.chunks(self.at_once) {
            if !(self.may_go_on)() {
                break;
            }
            let made = self.batch(context, batch, &load, &make)?;
            let made = batch.iter().zip(made);
            save(context, made.filter_map(|(of, made)| Some((of, made?))).collect())?;
            interrupt::check();
        }
        self.observer.end();
        Ok(())
    }

    /// The results of one batch in its order; none for what was not begun, or met by an interruption.
    ///
    /// # Errors
    /// Of `load`.
    pub fn batch<S: Sync, R: Send, M: Send>(
        &self,
        context: &Context,
        batch: &[S],
        load: impl Fn(&Context, &S) -> Result<R, PipelineError>,
        make: impl Fn(&S, R) -> M + Sync,
    ) -> Result<Vec<Option<M>>, PipelineError> {
        let loaded = batch.iter().map(|of| load(context, of));
        let loaded = loaded.collect::<Result<Vec<R>, _>>()?;
        let made = batch.par_iter().zip(loaded).map(|(of, readings)| {
            let made = (self.may_go_on)().then(|| interrupt::attempt(|| make(of, readings)));
            self.observer.advance();
            made.flatten()
        });
        Ok(made.collect())
    }
}
