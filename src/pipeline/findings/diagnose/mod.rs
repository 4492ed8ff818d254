//! Diagnoses every group of runs, and every run alone, that is new or whose input changed.

mod ahead;
mod choice;
mod from_others;
mod input_hash;
mod inputs;
mod outdated;
mod subject;

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

use crate::analysis::groups::{is_called, title};
use crate::diagnose::{DiagnoseOptions, diagnose_group, with_places};
use crate::domain::fault::caught;
use crate::domain::{Channel, GroupDiagnosis, MadeBy};
use crate::pipeline::campaign::batch::Making;
use crate::pipeline::campaign::context::{PROGRAM, now};
use crate::pipeline::campaign::derived::{Holding, Inputs, in_rounds};
use crate::pipeline::campaign::{readings, standing};
use crate::pipeline::findings::current::current_findings;
use crate::pipeline::fits::along;
use crate::pipeline::fits::input_hash::library_hash;
use crate::pipeline::{Context, Observer, PipelineError};
use crate::store::{self, Diagnosed, FitTask, NewResult, ResultKind};
pub(crate) use ahead::condemned_ahead;
pub use choice::{DiagnoseChoice, stands_in};
use input_hash::input_hash;
use inputs::{BATCH, not_condemned, with_inputs};
pub(crate) use outdated::waiting;
pub(crate) use subject::Subject;
use subject::subjects;

/// The verb `diagnose`.
#[derive(Debug, Clone, Default)]
pub struct DiagnoseRuns {
    /// How to diagnose.
    pub choice: DiagnoseChoice,
    /// Diagnose again even where nothing changed.
    pub again: bool,
    /// Only the group of that name, and its runs.
    pub group: Option<String>,
}

/// A run that the simulation may be said to be wrong about when it came.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct ClaimedRun {
    /// Path relative to the campaign.
    pub run: String,
    /// Probability of residuals at least as bad by chance.
    pub p_misfit: f64,
    /// Level at which it was tested.
    pub level: f64,
}

/// What `diagnose` did.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct DiagnoseSummary {
    /// Groups and single runs diagnosed.
    pub diagnosed: usize,
    /// Groups and single runs whose diagnosis was up to date.
    pub up_to_date: usize,
    /// Groups and single runs left for the next turn.
    pub left: usize,
    /// Groups and single runs that are left for the next call: what their diagnoses depend on changed each time that they were
    /// made.
    pub changing: Vec<String>,
    /// Groups and single runs whose diagnosis stopped on an internal fault, now or before.
    pub failed: Vec<String>,
    /// Runs diagnosed now that may be claimed to be wrong as they came, with p and the level that they were tested at.
    pub claimed: Vec<ClaimedRun>,
    /// Keys of `group_by` that no run carries.
    pub unknown_keys: Vec<String>,
}

impl DiagnoseSummary {
    /// Adds what was diagnosed later, of runs that changed in between.
    fn and_then(&mut self, later: DiagnoseSummary) {
        self.diagnosed += later.diagnosed;
        self.left = later.left;
        self.failed.extend(later.failed);
        self.failed.sort();
        self.failed.dedup();
        self.claimed.extend(later.claimed);
        self.unknown_keys = later.unknown_keys;
    }

    /// Whether a fault of the program stopped a diagnosis.
    pub fn has_fault(&self) -> bool {
        !self.failed.is_empty()
    }
}

/// A finding to be made, with the hash of all that it depends on.
type Due<'a> = (String, &'a [usize], Vec<&'a Subject>);

/// What is done, for the progress.
const DOING: &str = "diagnosing";

impl DiagnoseRuns {
    /// Diagnoses what is missing or out of date. The outcome does not depend on the number of threads.
    ///
    /// # Errors
    /// The model or the group is not known, or the database fails; a group that cannot be diagnosed is no error.
    pub fn run(
        &self,
        context: &mut Context,
        observer: &dyn Observer,
    ) -> Result<DiagnoseSummary, PipelineError> {
        self.run_while(context, observer, &|| true, &mut |_| Ok(()))
    }

    /// The same until `may_go_on` says no, which is asked before each group: what was begun until then is made and saved,
    /// and the rest is counted in [`DiagnoseSummary::left`]. `begins` is called once before the first of them, where there
    /// are any.
    ///
    /// # Errors
    /// As of [`DiagnoseRuns::run`].
    pub fn run_while(
        &self,
        context: &mut Context,
        observer: &dyn Observer,
        may_go_on: &(dyn Fn() -> bool + Sync),
        begins: &mut dyn FnMut(&Context) -> Result<(), PipelineError>,
    ) -> Result<DiagnoseSummary, PipelineError> {
        let mut hears_once = Some(begins);
        let mut begins = |context: &Context| hears_once.take().map_or(Ok(()), |begins| begins(context));
        let mut summary = DiagnoseSummary::default();
        summary.changing = in_rounds(DOING, observer, |is_first| {
            let again = self.again && is_first;
            let (found, changed) = self.once(context, again, observer, may_go_on, &mut begins)?;
            if is_first {
                summary = found;
            } else {
                summary.and_then(found);
            }
            Ok(changed)
        })?;
        Ok(summary)
    }

    /// Diagnoses what is due of the runs as they are now; names what changed meanwhile.
    fn once(
        &self,
        context: &mut Context,
        again: bool,
        observer: &dyn Observer,
        may_go_on: &(dyn Fn() -> bool + Sync),
        begins: &mut dyn FnMut(&Context) -> Result<(), PipelineError>,
    ) -> Result<(DiagnoseSummary, BTreeSet<String>), PipelineError> {
        let options = self.choice.options(&context.campaign)?;
        let tasks = context.store.fit_tasks()?;
        let (all, unknown_keys) = subjects(context, &tasks, &standing::to_diagnose(context)?);
        retire_gone(context, &all)?;
        let asked = self.asked(&all)?;
        let library = library_hash();
        let known: BTreeMap<(ResultKind, String), (String, bool)> = context
            .store
            .diagnoses()?
            .into_iter()
            .map(|stored| {
                let is_fault = stored.diagnosed.found.is_fault;
                ((stored.kind, stored.origin.name), (stored.origin.key, is_fault))
            })
            .collect();
        let mut summary = DiagnoseSummary {
            unknown_keys,
            ..DiagnoseSummary::default()
        };
        // A group of one run and that run alone are one question.
        let mut due: Vec<Due> = Vec::new();
        let mut places: BTreeMap<String, usize> = BTreeMap::new();
        for subject in asked {
            let hash = input_hash(subject, &tasks, &options, &library);
            let stored = known.get(&(subject.kind, subject.name.clone()));
            if let Some((_, is_fault)) = stored.filter(|(known, _)| *known == hash && !again) {
                summary.up_to_date += 1;
                // It stands until the input or the library changes, and is said until then.
                summary.failed.extend(is_fault.then(|| subject.name.clone()));
                continue;
            }
            match places.get(&hash) {
                Some(&place) => due[place].2.push(subject),
                None => {
                    places.insert(hash.clone(), due.len());
                    due.push((hash, &subject.members, vec![subject]));
                }
            }
        }
        if !due.is_empty() {
            begins(context)?;
        }
        let making = Making {
            doing: DOING,
            at_once: BATCH,
            observer,
            may_go_on,
        };
        let saving = RefCell::new(Saving::of(|context: &Context| {
            inputs_now(context, &options, &library)
        }));
        let load = |context: &Context, (hash, members, subjects): &Due| {
            let load = || -> Result<Vec<Vec<Channel>>, PipelineError> {
                if subjects[0].set_apart.is_some() {
                    return Ok(Vec::new());
                }
                let channels = |&index: &usize| readings::with_climate(context, &tasks[index]);
                members.iter().map(channels).collect()
            };
            let inputs = (hash.clone(), runs_of(subjects[0], &tasks));
            saving.borrow_mut().holding.loaded(context, &inputs, load)
        };
        let make = |(_, members, subjects): &Due, channels: Option<Vec<Vec<Channel>>>| {
            channels.map(|channels| diagnose_one(subjects[0], members, &tasks, &channels, &options))
        };
        let mut made: Vec<Due> = Vec::new();
        making.run(context, &due, load, make, |context, found| {
            let (mut done, mut all): (Vec<Due>, Vec<GroupDiagnosis>) = (Vec::new(), Vec::new());
            for (due, found) in found {
                made.push(due.clone());
                match found {
                    Some(found) => {
                        done.push(due.clone());
                        all.push(found);
                    }
                    None => {
                        let names = due.2.iter().map(|subject| title(&subject.name));
                        saving.borrow_mut().changed.extend(names);
                    }
                }
            }
            let rows = rows(&done, all, (&tasks, &options, &library));
            saving.borrow_mut().save(context, &rows, |row| {
                let found = &row.diagnosed.found;
                summary.diagnosed += 1;
                summary.failed.extend(found.is_fault.then(|| row.name.clone()));
            })
        })?;
        let count = |due: &[Due]| due.iter().map(|(_, _, subjects)| subjects.len()).sum::<usize>();
        summary.left = count(&due) - count(&made);
        summary.claimed = claimed(context, &made)?;
        let changed = saving.into_inner().changed;
        if summary.left == 0 && changed.is_empty() {
            let changed = from_others::hold_against_others(context, &all, &tasks, &options, observer)?;
            return Ok((summary, changed));
        }
        Ok((summary, changed))
    }

    /// The subjects that are asked for.
    fn asked<'a>(&self, all: &'a [Subject]) -> Result<Vec<&'a Subject>, PipelineError> {
        let Some(name) = &self.group else {
            return Ok(all.iter().collect());
        };
        let is_it = |subject: &&Subject| subject.kind == ResultKind::Group && is_called(&subject.name, name);
        let Some(group) = all.iter().find(is_it) else {
            let names: Vec<String> = all
                .iter()
                .filter(|subject| subject.kind == ResultKind::Group)
                .map(|subject| title(&subject.name))
                .collect();
            return Err(PipelineError::BadArgument {
                what: "--group",
                found: name.clone(),
                needed: format!("one of the groups {}", names.join(" | ")),
            });
        };
        let belongs = |subject: &&Subject| {
            std::ptr::eq(*subject, group)
                || (subject.kind == ResultKind::Run && group.members.contains(&subject.members[0]))
        };
        Ok(all.iter().filter(belongs).collect())
    }
}

/// Runs among those diagnosed that may be claimed as they came.
fn claimed(context: &Context, due: &[Due]) -> Result<Vec<ClaimedRun>, PipelineError> {
    let subjects = due.iter().flat_map(|(_, _, subjects)| subjects);
    let new: BTreeSet<&str> = subjects
        .filter(|subject| subject.kind == ResultKind::Run)
        .map(|subject| subject.name.as_str())
        .collect();
    if new.is_empty() {
        return Ok(Vec::new());
    }
    let findings = current_findings(context)?;
    let one = |found: &GroupDiagnosis| {
        let turn = findings.turns.get(&found.group)?;
        (turn.is_claimed && new.contains(found.group.as_str())).then_some(ClaimedRun {
            run: found.group.clone(),
            p_misfit: found.p_misfit?,
            level: turn.level,
        })
    };
    Ok(findings.runs.iter().filter_map(one).collect())
}

/// Retires diagnoses of groups and runs that are no more.
fn retire_gone(context: &mut Context, all: &[Subject]) -> Result<(), PipelineError> {
    let there: BTreeSet<(ResultKind, &str)> = all
        .iter()
        .map(|subject| (subject.kind, subject.name.as_str()))
        .collect();
    for kind in [ResultKind::Group, ResultKind::Run] {
        let names = context.store.result_keys(kind)?.into_keys();
        let gone: Vec<String> = names.filter(|name| !there.contains(&(kind, name))).collect();
        context.store.retire_results(&now(), kind, &gone)?;
    }
    Ok(())
}

/// Diagnoses one group; a panic in a kernel is that group's failure, not the program's.
pub(crate) fn diagnose_one(
    subject: &Subject,
    members: &[usize],
    tasks: &[FitTask],
    channels: &[Vec<Channel>],
    options: &DiagnoseOptions,
) -> GroupDiagnosis {
    let names = || members.iter().map(|&index| tasks[index].path.clone()).collect();
    if let Some(issue) = &subject.set_apart {
        let sentence = format!("Set apart, not diagnosed: {}.", issue.message);
        let mut found = GroupDiagnosis::data_problem(&subject.name, names(), options.model.id, sentence);
        found
            .remarks
            .extend((!issue.mend.is_empty()).then(|| issue.mend.clone()));
        return found;
    }
    let diagnosed = caught(|| {
        let places = members.iter().zip(channels).filter_map(|(&index, channels)| {
            let decision = along::decision(&tasks[index], channels)?;
            Some((tasks[index].path.as_str(), decision))
        });
        let places: Vec<_> = places.collect();
        with_inputs(subject, tasks, channels, |inputs| {
            let found = diagnose_group(&subject.name, inputs, options);
            let inputs = not_condemned(inputs, &found);
            let mut places = places;
            places.retain(|(name, _)| inputs.iter().any(|input| input.name == *name));
            with_places(found, &places, &inputs, options)
        })
    });
    diagnosed.unwrap_or_else(|reason| {
        let sentence = format!(
            "The diagnosis stopped on an internal fault: {reason}. Report it with the runs' files; other groups are not affected."
        );
        GroupDiagnosis {
            is_fault: true,
            ..GroupDiagnosis::data_problem(&subject.name, names(), options.model.id, sentence)
        }
    })
}

/// What was found of a batch, as it is stored.
fn rows(
    batch: &[Due],
    found: Vec<GroupDiagnosis>,
    (tasks, options, library): (&[FitTask], &DiagnoseOptions, &str),
) -> Vec<Row> {
    let mut rows = Vec::new();
    for ((hash, members, subjects), found) in batch.iter().zip(found) {
        for subject in subjects {
            let mut found = found.clone();
            found.group.clone_from(&subject.name);
            if subject.kind == ResultKind::Run {
                // Residuals are drawn on the pages of groups only.
                found.residuals.clear();
                found.held_out_residuals.clear();
            }
            let of = |&index: &usize| (tasks[index].path.clone(), tasks[index].revision);
            rows.push(Row {
                kind: subject.kind,
                name: subject.name.clone(),
                made_from: runs_of(subject, tasks),
                key: hash.clone(),
                made_by: PROGRAM.clone(),
                diagnosed: Diagnosed {
                    members: members.iter().map(of).collect(),
                    library: library.to_owned(),
                    seed: options.seed,
                    draws: options.draws,
                    found,
                },
            });
        }
    }
    rows
}

/// Row ids of the runs that a subject is made of.
fn runs_of(subject: &Subject, tasks: &[FitTask]) -> Vec<i64> {
    subject.members.iter().map(|&index| tasks[index].run_id).collect()
}

/// A diagnosis on its way into the database.
struct Row {
    kind: ResultKind,
    name: String,
    made_from: Vec<i64>,
    key: String,
    made_by: MadeBy,
    diagnosed: Diagnosed,
}

/// The storing of diagnoses.
struct Saving<N> {
    holding: Holding<N>,
    /// Names of what changed while it was diagnosed: nothing of it is stored.
    changed: BTreeSet<String>,
}

impl<N: Fn(&Context) -> Result<BTreeSet<Inputs>, PipelineError>> Saving<N> {
    /// Of diagnoses whose inputs are among those that hold `now`.
    fn of(now: N) -> Saving<N> {
        Saving {
            holding: Holding::of(now),
            changed: BTreeSet::new(),
        }
    }

    /// Stores diagnoses whose inputs hold; `took` is told of each.
    fn save(
        &mut self,
        context: &mut Context,
        rows: &[Row],
        mut took: impl FnMut(&Row),
    ) -> Result<(), PipelineError> {
        let changed = &mut self.changed;
        self.holding.step(context, |context, inputs| {
            let holds = |row: &&Row| inputs.contains(&(row.key.clone(), row.made_from.clone()));
            let (holding, other): (Vec<&Row>, Vec<&Row>) = rows.iter().partition(holds);
            changed.extend(other.into_iter().map(|row| title(&row.name)));
            for kind in [ResultKind::Group, ResultKind::Run] {
                let of_kind = holding.iter().copied().filter(|row| row.kind == kind);
                let of_kind: Vec<&Row> = of_kind.collect();
                let results: Vec<NewResult<'_, Diagnosed>> =
                    of_kind.iter().copied().map(Row::result).collect();
                let kept = context.store.keep_results(&now(), kind, &results)?;
                for (kept, row) in kept.into_iter().zip(of_kind) {
                    if kept {
                        took(row);
                    } else {
                        changed.insert(title(&row.name));
                    }
                }
            }
            Ok(())
        })
    }
}

/// What diagnoses with these options depend on now.
fn inputs_now(
    context: &Context,
    options: &DiagnoseOptions,
    library: &str,
) -> Result<BTreeSet<Inputs>, PipelineError> {
    let tasks = context.store.fit_tasks()?;
    let (all, _) = subjects(context, &tasks, &standing::to_diagnose(context)?);
    let inputs = |subject: &Subject| {
        let key = input_hash(subject, &tasks, options, library);
        (key, runs_of(subject, &tasks))
    };
    Ok(all.iter().map(inputs).collect())
}

impl Row {
    fn result(&self) -> NewResult<'_, Diagnosed> {
        NewResult {
            of: match self.kind {
                ResultKind::Run => store::Subject::Run(self.made_from[0]),
                _ => store::Subject::Named(&self.name),
            },
            made_from: &self.made_from,
            key: &self.key,
            made_by: &self.made_by,
            found: Ok(&self.diagnosed),
        }
    }
}
