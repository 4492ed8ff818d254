//! Results that follow from readings: which are due, how they are made and stored under what they depend on. One for all kinds:
//! a kind says only what it is made of and how.

use std::collections::BTreeMap;

use super::batch::{Making, TO_THE_END};
use super::context::{CODE_VERSION, now};
use crate::domain::Issue;
use crate::domain::fault::caught;
use crate::pipeline::{Context, Observer, PipelineError};
use crate::store::{NewResult, ResultDocument, ResultKind};

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

    /// Names of the results of a subject.
    fn names<'s>(&self, of: &'s Self::Subject) -> Vec<&'s str>;
    /// Hash of everything that they depend on.
    fn key(&self, of: &Self::Subject) -> String;
    /// # Errors
    /// The database cannot be read.
    fn load(&self, context: &Context, of: &Self::Subject) -> Result<Self::Readings, PipelineError>;
    /// One for each name: what is found, or why nothing is.
    fn make(&self, of: &Self::Subject, readings: Self::Readings) -> Vec<Made<Self::Found>>;
    /// What is said of each name where a fault of the program stops the making: it stops this subject only.
    fn fault(&self, reason: &str) -> Issue;
    /// Stores results of a batch; what goes with them is stored in the same step.
    ///
    /// # Errors
    /// The database cannot be written.
    fn store(
        &self,
        context: &mut Context,
        results: &[NewResult<'_, Self::Found>],
        _of: &[&Self::Subject],
    ) -> Result<(), PipelineError> {
        Ok(context.store.keep_results(&now(), Self::KIND, results)?)
    }
}

/// What is found, or why nothing is.
pub(crate) type Made<T> = Result<T, Issue>;

/// A subject with what its results depend on.
pub(crate) type Keyed<S> = (String, S);

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
    let is_done = |(key, of): &Keyed<D::Subject>| !again && is_current(&known, &kind.names(of), key);
    let keyed = subjects.into_iter().map(|of| (kind.key(&of), of));
    let (up_to_date, due) = keyed.partition(is_done);
    Ok(Sorted { up_to_date, due })
}

fn is_current(known: &BTreeMap<String, String>, names: &[&str], key: &str) -> bool {
    names
        .iter()
        .all(|name| known.get(*name).is_some_and(|known| known == key))
}

/// Makes what is due and stores it; `took` is told of each result. The outcome does not depend on the number of threads.
///
/// # Errors
/// The database fails; what cannot be made is a result, and no error.
pub(crate) fn bring_up_to_date<D: Derived>(
    kind: &D,
    context: &mut Context,
    due: &[Keyed<D::Subject>],
    observer: &dyn Observer,
    mut took: impl FnMut(&D::Subject, &str, &Made<D::Found>),
) -> Result<(), PipelineError> {
    let load = |context: &Context, (_, of): &Keyed<D::Subject>| kind.load(context, of);
    let make = |(_, of): &Keyed<D::Subject>, readings| made(kind, of, readings);
    making::<D>(observer).run(context, due, load, make, |context, batch| {
        let mut results = Vec::new();
        for ((key, of), made) in &batch {
            for (name, (found, is_fault)) in kind.names(of).into_iter().zip(made) {
                took(of, name, found);
                results.push(NewResult {
                    name,
                    // A fault says nothing of the readings: it is tried again, and said again, every time.
                    key: if *is_fault { "" } else { key },
                    version: CODE_VERSION,
                    found: found.as_ref(),
                });
            }
        }
        let subjects: Vec<&D::Subject> = batch.iter().map(|((_, of), _)| of).collect();
        kind.store(context, &results, &subjects)
    })
}

/// The same without storing anything: `took` gets every result with its subject and its name.
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
            let named = kind.names(of).into_iter().zip(made);
            named.for_each(|(name, (found, _))| took(of, name, found));
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
            let names = kind.names(of);
            names.iter().map(|_| (Err(fault.clone()), true)).collect()
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
