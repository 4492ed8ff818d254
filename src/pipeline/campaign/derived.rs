//! Results that follow from readings: which are due, how they are made and stored under what they depend on. One for all kinds:
//! a kind says only what it is made of and how.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

use super::batch::{Making, TO_THE_END};
use super::context::{PROGRAM, now};
use crate::domain::Issue;
use crate::domain::fault::caught;
use crate::pipeline::{Context, Observer, PipelineError};
use crate::store::{FitTask, NewResult, ResultDocument, ResultKind, Subject};

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

    /// Every subject as it is now.
    ///
    /// # Errors
    /// The database cannot be read.
    fn subjects(&self, context: &Context) -> Result<Vec<Self::Subject>, PipelineError>;
    /// The runs and logs that a subject is made of: its results are made from all of them, and there is one of each.
    fn runs<'s>(&self, of: &'s Self::Subject) -> Vec<MadeOf<'s>>;
    /// Hash of everything that they depend on, and of nothing else: what is not in it must not be read in the making.
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

/// A run, or a log, that something is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct MadeOf<'a> {
    /// Row id.
    pub(crate) run_id: i64,
    /// Its name.
    pub(crate) name: &'a str,
}

impl<'a> From<&'a FitTask> for MadeOf<'a> {
    fn from(task: &'a FitTask) -> MadeOf<'a> {
        MadeOf {
            run_id: task.run_id,
            name: &task.path,
        }
    }
}

/// What is found, or why nothing is.
pub(crate) type Made<T> = Result<T, Issue>;

/// A subject with what its results depend on.
pub(crate) type Keyed<S> = (String, S);

/// Times that results are made before those are left whose inputs were other ones each time that they were to be stored.
/// Chosen: a correction on the way is taken in at once; who goes on correcting is told so.
const ROUNDS: usize = 3;

/// Makes results in rounds, until what they were made from held to the end; `once` makes what is due, for the first time or
/// again, and names what changed meanwhile. Gives the names of what still changed in the last round, which is left.
///
/// # Errors
/// Of `once`.
pub(crate) fn in_rounds(
    doing: &str,
    observer: &dyn Observer,
    mut once: impl FnMut(bool) -> Result<BTreeSet<String>, PipelineError>,
) -> Result<Vec<String>, PipelineError> {
    let mut changed = once(true)?;
    for _ in 1..ROUNDS {
        for name in &changed {
            observer.say(&format!(
                "{name} changed while {doing}: what was made of it is not stored, and is made anew"
            ));
        }
        if changed.is_empty() {
            break;
        }
        changed = once(false)?;
    }
    Ok(changed.into_iter().collect())
}

/// In words: what is left of what changed while it was made.
pub(crate) fn left_words(name: &str) -> String {
    format!(
        "{name}: what its result depends on was changed each of the {ROUNDS} times that it was made; it is left, and the next call makes it"
    )
}

/// What results depend on at one moment: the hash of it, and the row ids of the runs.
pub(crate) type Inputs = (String, Vec<i64>);

/// The inputs that hold, asked again only where others changed the database since. They are asked twice: where readings are
/// loaded, so that what is made is made of them, and where the result is stored.
pub(crate) struct Holding<N> {
    /// All inputs as they are now.
    now: N,
    changes: Option<u64>,
    inputs: BTreeSet<Inputs>,
}

impl<N: Fn(&Context) -> Result<BTreeSet<Inputs>, PipelineError>> Holding<N> {
    pub(crate) fn of(now: N) -> Holding<N> {
        Holding {
            now,
            changes: None,
            inputs: BTreeSet::new(),
        }
    }

    fn look(&mut self, context: &Context) -> Result<(), PipelineError> {
        let changes = Some(context.store.changes()?.0);
        if self.changes != changes {
            self.inputs = (self.now)(context)?;
            self.changes = changes;
        }
        Ok(())
    }

    /// What `load` reads, where these inputs hold at the moment that it reads.
    ///
    /// # Errors
    /// The database cannot be read.
    pub(crate) fn loaded<T>(
        &mut self,
        context: &Context,
        inputs: &Inputs,
        load: impl FnOnce() -> Result<T, PipelineError>,
    ) -> Result<Option<T>, PipelineError> {
        let _moment = context.store.snapshot()?;
        self.look(context)?;
        let holds = self.inputs.contains(inputs);
        holds.then(load).transpose()
    }

    /// Runs `then` with the inputs that hold, in one step of the database: nobody changes them until it ends.
    ///
    /// # Errors
    /// The database cannot be read or written.
    pub(crate) fn step<T>(
        &mut self,
        context: &mut Context,
        then: impl FnOnce(&mut Context, &BTreeSet<Inputs>) -> Result<T, PipelineError>,
    ) -> Result<T, PipelineError> {
        // What can be asked before is not asked while others wait.
        self.look(context)?;
        context.store.begin_batch()?;
        let done = self.in_step(context, then);
        let committed = context.store.commit_batch();
        let done = done?;
        committed?;
        Ok(done)
    }

    fn in_step<T>(
        &mut self,
        context: &mut Context,
        then: impl FnOnce(&mut Context, &BTreeSet<Inputs>) -> Result<T, PipelineError>,
    ) -> Result<T, PipelineError> {
        self.look(context)?;
        let done = then(context, &self.inputs)?;
        // What is stored here changes no inputs.
        self.changes = Some(context.store.changes()?.0);
        Ok(done)
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

fn is_current(known: &BTreeMap<String, String>, runs: &[MadeOf<'_>], key: &str) -> bool {
    runs.iter()
        .all(|run| known.get(run.name).is_some_and(|known| known == key))
}

/// Makes what is due and stores it; `took` is told of each result that is stored, with its run's name. The outcome does not
/// depend on the number of threads. Names the runs of which what results depend on changed meanwhile: of these nothing is
/// stored.
///
/// # Errors
/// The database fails; what cannot be made is a result, and no error.
pub(crate) fn bring_up_to_date<D: Derived>(
    kind: &D,
    context: &mut Context,
    due: &[Keyed<D::Subject>],
    observer: &dyn Observer,
    mut took: impl FnMut(&D::Subject, &str, &Made<D::Found>),
) -> Result<BTreeSet<String>, PipelineError> {
    let mut changed = BTreeSet::new();
    let inputs_of = |key: &str, of: &D::Subject| (key.to_owned(), ids(&kind.runs(of)));
    let holding = RefCell::new(Holding::of(|context: &Context| {
        let subjects = kind.subjects(context)?.into_iter();
        Ok(subjects.map(|of| inputs_of(&kind.key(&of), &of)).collect())
    }));
    let load = |context: &Context, (key, of): &Keyed<D::Subject>| {
        let load = || kind.load(context, of);
        holding.borrow_mut().loaded(context, &inputs_of(key, of), load)
    };
    let make = |(_, of): &Keyed<D::Subject>, readings: Option<D::Readings>| {
        readings.map(|readings| made(kind, of, readings))
    };
    making::<D>(observer).run(context, due, load, make, |context, batch| {
        holding.borrow_mut().step(context, |context, inputs| {
            let (mut results, mut of_each, mut subjects) = (Vec::new(), Vec::new(), Vec::new());
            let of_batch = batch.iter().map(|((key, of), _)| inputs_of(key, of));
            let of_batch: Vec<Inputs> = of_batch.collect();
            for (((key, of), made), own) in batch.iter().zip(&of_batch) {
                let (runs, ids) = (kind.runs(of), &own.1);
                let Some(made) = made.as_ref().filter(|_| inputs.contains(own)) else {
                    changed.extend(runs.iter().map(|run| run.name.to_owned()));
                    continue;
                };
                subjects.push(of);
                for (run, (found, is_fault)) in runs.iter().zip(made) {
                    of_each.push((of, run.name, found));
                    results.push(NewResult {
                        of: Subject::Run(run.run_id),
                        made_from: ids,
                        // A fault says nothing of the readings: it is tried again, and said again, every time.
                        key: if *is_fault { "" } else { key },
                        made_by: &PROGRAM,
                        found: found.as_ref(),
                    });
                }
            }
            let kept = kind.store(context, &results, &subjects)?;
            for (kept, (of, run, found)) in kept.into_iter().zip(of_each) {
                if kept {
                    took(of, run, found);
                } else {
                    changed.insert(run.to_owned());
                }
            }
            Ok(())
        })
    })?;
    Ok(changed)
}

fn ids(runs: &[MadeOf<'_>]) -> Vec<i64> {
    runs.iter().map(|run| run.run_id).collect()
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
