//! Fits one part of a campaign's runs without writing into the campaign: many computers at once, each its part. What they write
//! is joined by [`crate::pipeline::upkeep::import_fits`].

use std::fmt;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use schemars::JsonSchema;
use serde::Serialize;

use super::extended;
use super::plan::fit_plan;
use super::result::{End, FitResult};
use super::runs::{Due, FitRuns, fit_and_take};
use crate::domain::Issue;
use crate::pipeline::ground::whole_file::put_file;
use crate::pipeline::{Context, Observer, PipelineError};
use crate::system::fs;

/// One part of several: `2/8`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Part {
    /// Which, from 1.
    pub number: u32,
    /// Of how many.
    pub of: u32,
}

impl Part {
    /// Whether a run is of this part. It goes by the run's name alone: files that come or go move no other run.
    pub fn holds(self, run: &str) -> bool {
        let hash = blake3::hash(run.as_bytes());
        let first: [u8; 8] = std::array::from_fn(|at| hash.as_bytes()[at]);
        u64::from_le_bytes(first) % u64::from(self.of) == u64::from(self.number - 1)
    }
}

impl FromStr for Part {
    type Err = String;

    fn from_str(text: &str) -> Result<Part, String> {
        let parts = text
            .split_once('/')
            .and_then(|(number, of)| Some((number.parse().ok()?, of.parse().ok()?)));
        match parts {
            Some((number, of)) if number >= 1 && number <= of => Ok(Part { number, of }),
            _ => Err("needed K/N, the K-th of N parts, such as 1/8".to_owned()),
        }
    }
}

impl fmt::Display for Part {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}/{}", self.number, self.of)
    }
}

/// Fits the runs of a part that have no current fit.
#[derive(Debug, Clone)]
pub struct FitShard {
    /// How, and whether also what is up to date.
    pub fits: FitRuns,
    /// Which runs.
    pub part: Part,
    /// File to write, a line a run.
    pub path: PathBuf,
    /// Whether a file that is there may be written over.
    pub overwrite: bool,
}

/// What was fitted, and what is left to whoever holds the campaign.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct ShardSummary {
    /// File with the results.
    pub file: PathBuf,
    /// Which part of the runs.
    pub part: Part,
    /// Runs fitted.
    pub fitted: usize,
    /// Runs of this part whose fit is up to date.
    pub up_to_date: usize,
    /// Runs that could not be fitted, with the reason; their reasons stand in the file too.
    pub failed: Vec<(String, Issue)>,
    /// Runs that are fitted together with others and therefore in no part: `ieap fit` in the campaign does them.
    pub fitted_together: usize,
}

impl FitShard {
    /// Fits and writes; the file appears whole or not at all.
    ///
    /// # Errors
    /// The model is not known, the database cannot be read, the file is there or cannot be written.
    pub fn run(&self, context: &Context, observer: &dyn Observer) -> Result<ShardSummary, PipelineError> {
        let plan = fit_plan(context, &self.fits.choice.asked(), &Default::default())?;
        let fitted_together = extended::due(&plan.extended, self.fits.again);
        let of_part = plan
            .single
            .into_iter()
            .filter(|run| self.part.holds(&run.task.path));
        let (done, due) = self.fits.sorted(of_part.collect());
        let mut summary = ShardSummary {
            file: self.path.clone(),
            part: self.part,
            fitted: 0,
            up_to_date: done.len(),
            failed: Vec::new(),
            fitted_together,
        };
        put_file(&self.path, self.overwrite, |part| {
            self.fill(context, &due, part, observer, &mut summary)
        })?;
        Ok(summary)
    }

    fn fill(
        &self,
        context: &Context,
        due: &[Due],
        path: &Path,
        observer: &dyn Observer,
        summary: &mut ShardSummary,
    ) -> Result<(), PipelineError> {
        let failed = |source| PipelineError::File {
            path: self.path.clone(),
            doing: "writing results",
            source,
        };
        let mut file = fs::OpenOptions::new().write(true).open(path).map_err(failed)?;
        let (mut rows, mut sum) = (0, blake3::Hasher::new());
        fit_and_take("fitting", context, due, observer, |made| {
            for ((input_hash, run), outcome) in made {
                if let Err(issue) = &outcome {
                    summary.failed.push((run.task.path.clone(), issue.clone()));
                }
                summary.fitted += usize::from(outcome.is_ok());
                let (task, asked) = (&run.task, &run.chosen.asked);
                let result = FitResult::of(&task.path, &task.data_hash, input_hash, asked, outcome);
                sum.update(line(&result, &mut file).map_err(failed)?.as_bytes());
                rows += 1;
            }
            Ok(())
        })?;
        line(&End::of(rows, &sum), &mut file).map_err(failed)?;
        Ok(())
    }
}

/// Writes a line of JSON; gives what was written.
fn line(what: &impl Serialize, file: &mut fs::File) -> std::io::Result<String> {
    let text = serde_json::to_string(what)? + "\n";
    file.write_all(text.as_bytes())?;
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_run_is_of_one_part() {
        for of in 1..=7u32 {
            let parts: Vec<Part> = (1..=of).map(|number| Part { number, of }).collect();
            let mut sizes = vec![0usize; of as usize];
            for run in 0..700 {
                let name = format!("runs/{run}.csv");
                let holding: Vec<usize> = (0..parts.len()).filter(|&at| parts[at].holds(&name)).collect();
                assert_eq!(holding.len(), 1, "{name} of {of}");
                sizes[holding[0]] += 1;
            }
            let expected = 700 / of as usize;
            assert!(
                sizes
                    .iter()
                    .all(|&size| size > expected / 2 && size < 2 * expected),
                "{sizes:?}"
            );
        }
    }

    #[test]
    fn a_part_is_written_k_of_n() {
        assert_eq!("2/8".parse(), Ok(Part { number: 2, of: 8 }));
        for wrong in ["0/8", "9/8", "1", "a/b", "1/0", "-1/2", ""] {
            assert!(wrong.parse::<Part>().is_err(), "{wrong}");
        }
    }
}
