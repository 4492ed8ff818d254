//! Results that follow from readings: which are due, how they are made and stored under what they depend on. One for all kinds:
//! a kind says only what it is made of and how.

use std::collections::BTreeMap;

use super::batch::{Making, TO_THE_END};
use super::context::{CODE_VERSION, now};
use crate::domain::Issue;
use crate::domain::fault::caught;
use crate::pipeline::{Context, Observer, PipelineError};
use crate::store::{NewResult, ResultDocument, ResultKind, RunThen, Subject};

/// A kind of result.
pub(crate) trait Derived: Sync {
    /// What results are made of: a run, a log, a group of runs.
    type Subject: Sync;
    /// What has to be read for that.
    type Readings: Send;
    /// What is found.
    type Found: ResultDocument + Send;
    const KIND: ResultKind;
    /// What is done, for the progress.
    const DOING: &'static str;
    /// Subjects between two commits: bounds memory, and what an interruption costs.
    const AT_ONCE: usize;

    /// The runs and logs that a subject is made of: its results are made from all of them, and there is one of each.
    fn runs<'s>(&self, of: &'s Self::Subject) -> Vec<RunThen<'s>>;
    /// Hash of everything that they depend on.
    fn key(&self, of: &Self::Subject) -> String;
    /// # Errors
    /// The database cannot be read.
    fn load(&self, context: &Context, of: &Self::Subject) -> Result<Self::Readings, PipelineError>;
    /// One for each run: what is found, or why nothing is.
    fn make(&self, of: &Self::Subject, readings: Self::Readings) -> Vec<Made<Self::Found>>;
    /// What is said of each run where a fault of the program stops the making: it stops this subject only.
    fn fault(&self, reason: &str) -> Issue;
    /// Stores results of a batch; what goes with them is stored in the same step. Tells of each whether it is stored.
    ///
    /// # Errors
    /// The database cannot be written.
    fn store(
        &self,
        context: &mut Context,
        results: &[NewResult<'_, Self::Found>],
        _of: &[&Self::Subject],
    ) -> Result<Vec<bool>, PipelineError> {
        Ok(context.store.keep_results(&now(), Self::KIND, results)?)
    }
}

/// What is found, or why nothing is.
pub(crate) type Made<T> = Result<T, Issue>;

/// A subject with what its results depend on.
pub(crate) type Keyed<S> = (String, S);

/// Whether results are to be made anew, as what they were made from is not what it was when they were to be stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[must_use]
pub(crate) enum Anew {
    No,
    Yes,
}

impl Anew {
    /// Takes note, and says, that a run changed while something was made of it.
    pub(crate) fn of(&mut self, doing: &str, run: &str, observer: &dyn Observer) {
        *self = Anew::Yes;
        observer.say(&format!(
            "{run} changed while {doing}: what was made of it is not stored, and is made anew"
        ));
    }

    /// Whether the one or the other is.
    pub(crate) fn or(self, other: Anew) -> Anew {
        if self == Anew::Yes { self } else { other }
    }
}

/// Subjects, by whether their results are up to date and due.
pub(crate) struct Sorted<S> {
    pub(crate) up_to_date: Vec<Keyed<S>>,
    pub(crate) due: Vec<Keyed<S>>,
}

/// Subjects whose results are missing or depend on something else than they were made from, and the others.
///
/// # Errors
/// The database cannot be read.
pub(crate) fn sorted<D: Derived>(
    kind: &D,
    context: &Context,
    subjects: Vec<D::Subject>,
    again: bool,
) -> Result<Sorted<D::Subject>, PipelineError> {
    let known = context.store.result_keys(D::KIND)?;
    let is_done = |(key, of): &Keyed<D::Subject>| !again && is_current(&known, &kind.runs(of), key);
    let keyed = subjects.into_iter().map(|of| (kind.key(&of), of));
    let (up_to_date, due) = keyed.partition(is_done);
    Ok(Sorted { up_to_date, due })
}

fn is_current(known: &BTreeMap<String, String>, runs: &[RunThen<'_>], key: &str) -> bool {
    runs.iter()
        .all(|run| known.get(run.name).is_some_and(|known| known == key))
}

/// Makes what is due and stores it; `took` is told of each result that is stored, with its run's name. The outcome does not
/// depend on the number of threads. Tells whether runs changed meanwhile, of which the results are to be made anew.
///
/// # Errors
/// The database fails; what cannot be made is a result, and no error.
pub(crate) fn bring_up_to_date<D: Derived>(
    kind: &D,
    context: &mut Context,
    due: &[Keyed<D::Subject>],
    observer: &dyn Observer,
    mut took: impl FnMut(&D::Subject, &str, &Made<D::Found>),
) -> Result<Anew, PipelineError> {
    let mut anew = Anew::No;
    let load = |context: &Context, (_, of): &Keyed<D::Subject>| kind.load(context, of);
    let make = |(_, of): &Keyed<D::Subject>, readings| made(kind, of, readings);
    making::<D>(observer).run(context, due, load, make, |context, batch| {
        let runs: Vec<Vec<RunThen<'_>>> = batch.iter().map(|((_, of), _)| kind.runs(of)).collect();
        let (mut results, mut of_each) = (Vec::new(), Vec::new());
        for (((key, of), made), runs) in batch.iter().zip(&runs) {
            for (run, (found, is_fault)) in runs.iter().zip(made) {
                of_each.push((of, run.name, found));
                results.push(NewResult {
                    of: Subject::Run(run.run_id),
                    made_from: runs,
                    // A fault says nothing of the readings: it is tried again, and said again, every time.
                    key: if *is_fault { "" } else { key },
                    version: CODE_VERSION,
                    found: found.as_ref(),
                });
            }
        }
        let subjects: Vec<&D::Subject> = batch.iter().map(|((_, of), _)| of).collect();
        let kept = kind.store(context, &results, &subjects)?;
        for (kept, (of, run, found)) in kept.into_iter().zip(of_each) {
            if kept {
                took(of, run, found);
            } else {
                anew.of(D::DOING, run, observer);
            }
        }
        Ok(())
    })?;
    Ok(anew)
}

/// The same without storing anything: `took` gets every result with its subject and its run's name.
///
/// # Errors
/// The database fails.
pub(crate) fn look<D: Derived>(
    kind: &D,
    context: &Context,
    due: &[Keyed<D::Subject>],
    observer: &dyn Observer,
    mut took: impl FnMut(&D::Subject, &str, Made<D::Found>),
) -> Result<(), PipelineError> {
    let load = |context: &Context, (_, of): &Keyed<D::Subject>| kind.load(context, of);
    let make = |(_, of): &Keyed<D::Subject>, readings| made(kind, of, readings);
    making::<D>(observer).look(context, due, load, make, |batch| {
        for ((_, of), made) in batch {
            let of_each = kind.runs(of).into_iter().zip(made);
            of_each.for_each(|(run, (found, _))| took(of, run.name, found));
        }
        Ok(())
    })
}

/// The results of a subject, each with whether a fault of the program stopped it.
fn made<D: Derived>(kind: &D, of: &D::Subject, readings: D::Readings) -> Vec<(Made<D::Found>, bool)> {
    match caught(|| kind.make(of, readings)) {
        Ok(made) => made.into_iter().map(|made| (made, false)).collect(),
        Err(reason) => {
            let fault = kind.fault(&reason);
            let runs = kind.runs(of);
            runs.iter().map(|_| (Err(fault.clone()), true)).collect()
        }
    }
}

fn making<D: Derived>(observer: &dyn Observer) -> Making<'_> {
    Making {
        doing: D::DOING,
        at_once: D::AT_ONCE,
        observer,
        may_go_on: TO_THE_END,
    }
}
