//! How results are made of stored readings, whatever they are: readings are fetched a few subjects at a time, and results made
//! of them on all cores. [`Making::run`] stores what it makes and keeps what was made before an interruption,
//! [`Making::look`] hands it on, and [`compute`] is for what is made anew whenever somebody looks.

use rayon::prelude::*;

use crate::numerics::interrupt;
use crate::pipeline::{Context, Observer, PipelineError, Silent};

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
        self.batches(due, |batch| {
            let made = self.batch(context, batch, &load, &make)?;
            save(context, pairs(batch, made))
        })
    }

    /// The same for what is not stored: `take` gets what was made of a batch, in its order.
    ///
    /// # Errors
    /// Of `load` and `take`.
    pub fn look<S: Sync, R: Send, M: Send>(
        &self,
        context: &Context,
        due: &[S],
        load: impl Fn(&Context, &S) -> Result<R, PipelineError>,
        make: impl Fn(&S, R) -> M + Sync,
        mut take: impl FnMut(Vec<(&S, M)>) -> Result<(), PipelineError>,
    ) -> Result<(), PipelineError> {
        self.batches(due, |batch| {
            let made = self.batch(context, batch, &load, &make)?;
            // What an interruption met is not there, and what lacks it would pass for whole.
            interrupt::check();
            take(pairs(batch, made))
        })
    }

    /// One batch after the other, told to who listens.
    fn batches<'s, S>(
        &self,
        due: &'s [S],
        mut one: impl FnMut(&'s [S]) -> Result<(), PipelineError>,
    ) -> Result<(), PipelineError> {
        if due.is_empty() {
            return Ok(());
        }
        self.observer.begin(self.doing, due.len() as u64);
        for batch in due.chunks(self.at_once) {
            if !(self.may_go_on)() {
                break;
            }
            one(batch)?;
            interrupt::check();
        }
        self.observer.end();
        Ok(())
    }

    /// The results of one batch in its order; none for what was not begun, or met by an interruption.
    fn batch<S: Sync, R: Send, M: Send>(
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

/// Each subject with what was made of it.
fn pairs<S, M>(batch: &[S], made: Vec<Option<M>>) -> Vec<(&S, M)> {
    let made = batch.iter().zip(made);
    made.filter_map(|(of, made)| Some((of, made?))).collect()
}

/// What is made anew whenever somebody looks, of all `subjects` in their order.
///
/// # Errors
/// Of `load`.
pub(crate) fn compute<S: Sync, R: Send, M: Send>(
    context: &Context,
    subjects: &[S],
    load: impl Fn(&Context, &S) -> Result<R, PipelineError>,
    make: impl Fn(&S, R) -> M + Sync,
) -> Result<Vec<M>, PipelineError> {
    let making = Making {
        doing: "",
        at_once: LOOKED_AT_ONCE,
        observer: &Silent,
        may_go_on: TO_THE_END,
    };
    let mut all = Vec::with_capacity(subjects.len());
    making.look(context, subjects, load, make, |made| {
        all.extend(made.into_iter().map(|(_, made)| made));
        Ok(())
    })?;
    Ok(all)
}

/// Subjects whose readings are in memory together where results are made whenever they are asked for.
const LOOKED_AT_ONCE: usize = 32;
