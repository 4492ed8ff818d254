//! Takes runs out of all results, and back: on a person's word, with who said it, when and why.

use std::collections::BTreeSet;

use schemars::JsonSchema;
use serde::Serialize;

use super::tag::known_run;
use crate::domain::{RunRecord, RunWord, Standing};
use crate::pipeline::campaign::context::now;
use crate::pipeline::campaign::standing::{self, SetAside};
use crate::pipeline::intake::ingest::together;
use crate::pipeline::{Context, PipelineError};

/// The verb `drop`, and `drop --undo`.
#[derive(Debug, Clone)]
pub struct SpeakOfRuns {
    /// Names of the runs, as `tag` takes them.
    pub runs: Vec<String>,
    /// Also every run, or modulus log, whose files are gone.
    pub deleted: bool,
    /// Whether they leave results; else they come back.
    pub drops: bool,
    /// Why. Needed to drop a run; a run that the program sets aside comes back with it alone.
    pub why: Option<String>,
    /// Who says it.
    pub said_by: String,
}

/// What became of the runs.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub struct SpokenOf {
    /// Runs that results are made from now, by name.
    pub speaking: Vec<String>,
    /// Runs that none are made from now.
    pub set_aside: Vec<SetAside>,
    /// Of those that came back: what the program would set aside without a person's word, with its reason.
    pub overruled: Vec<SetAside>,
}

impl SpeakOfRuns {
    /// Records the word for all of the runs, or for none.
    ///
    /// # Errors
    /// A run is not known; a reason is missing; or the database refuses.
    pub fn run(&self, context: &mut Context) -> Result<SpokenOf, PipelineError> {
        let why = self.why.as_deref().map(str::trim).filter(|why| !why.is_empty());
        if self.drops && why.is_none() {
            return Err(bad_why(
                "nothing",
                "the reason in a few words, as in --why \"clip slipped\"",
            ));
        }
        let (mut before, mut said_of) = (Vec::new(), Vec::new());
        // What a name means and what is said of it is one step: nobody renames in between.
        together(context, |context| {
            before = self.meant(context)?;
            if !self.drops && why.is_none() {
                before.iter().try_for_each(comes_back)?;
            }
            let now = now();
            let words: Vec<RunWord> = before.iter().map(|run| self.word(run, why, &now)).collect();
            for run in &before {
                said_of.push(context.store.measurement_of(&run.path)?);
            }
            if words.is_empty() {
                return Ok(());
            }
            Ok(context.store.add_run_words(&now, &words)?)
        })?;
        let mut names = BTreeSet::new();
        for of in &said_of {
            names.extend(context.store.name_of(of)?);
        }
        let (speaking, silent): (Vec<RunRecord>, Vec<RunRecord>) =
            (records(context, &names)?.into_iter()).partition(|run| run.standing.speaks());
        let said: BTreeSet<&str> = speaking.iter().map(|run| run.path.as_str()).collect();
        let by_the_program = |run: &&RunRecord| {
            matches!(
                run.standing,
                Standing::Condemned { .. } | Standing::Contradicted { .. } | Standing::Copy { .. }
            ) && said.contains(run.path.as_str())
        };
        Ok(SpokenOf {
            overruled: before.iter().filter(by_the_program).map(SetAside::of).collect(),
            speaking: speaking.into_iter().map(|run| run.path).collect(),
            set_aside: silent.iter().map(SetAside::of).collect(),
        })
    }
}

impl SpeakOfRuns {
    /// The runs that are meant.
    fn meant(&self, context: &Context) -> Result<Vec<RunRecord>, PipelineError> {
        let mut names: BTreeSet<String> = BTreeSet::new();
        for name in &self.runs {
            names.insert(known_run(context, name)?);
        }
        if self.deleted {
            names.extend(context.store.deleted_runs()?);
        }
        records(context, &names)
    }

    fn word(&self, run: &RunRecord, why: Option<&str>, now: &str) -> RunWord {
        RunWord {
            run_path: run.path.clone(),
            drops: self.drops,
            why: why.map(str::to_owned),
            said_by: self.said_by.clone(),
            said_at: now.to_owned(),
            data_hash: run.data_hash.clone(),
        }
    }
}

/// Without a reason only a person's own word is taken back.
fn comes_back(run: &RunRecord) -> Result<(), PipelineError> {
    match &run.standing {
        Standing::Dropped(_) | Standing::Vouched(_) => Ok(()),
        Standing::Speaks => Err(PipelineError::BadArgument {
            what: "drop --undo",
            found: format!("{}, which is not dropped", run.path),
            needed: "a run that is set aside; `ieap status` lists them".to_owned(),
        }),
        Standing::Condemned { .. } | Standing::Contradicted { .. } | Standing::Copy { .. } => Err(bad_why(
            &format!(
                "nothing, and {} is set aside: {}",
                run.path,
                run.standing.reason()
            ),
            "why it is right all the same, as in --why \"the logger writes mA\"",
        )),
    }
}

fn bad_why(found: &str, needed: &str) -> PipelineError {
    PipelineError::BadArgument {
        what: "--why",
        found: found.to_owned(),
        needed: needed.to_owned(),
    }
}

/// The runs, modulus logs and spectra of these names.
fn records(context: &Context, names: &BTreeSet<String>) -> Result<Vec<RunRecord>, PipelineError> {
    let (speaking, set_aside) = standing::modulus_logs(context)?;
    let logs = speaking.into_iter().chain(set_aside).map(|log| log.run);
    let spectra = standing::spectra(context)?;
    let spectra = spectra.speaking.into_iter().chain(spectra.set_aside);
    let runs = standing::all(context)?.into_iter();
    let mut found: Vec<RunRecord> = runs.chain(logs).chain(spectra).collect();
    found.retain(|run| names.contains(&run.path));
    Ok(found)
}
