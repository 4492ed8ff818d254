//! What an extension gains on readings that took no part in its fit, for the page of one group.

use crate::figures::residual::Called;
use ieap_domain::finding_words::{StatedError, errors as stated_errors, gain_words};
use ieap_domain::number::{measured, percent, significant};
use ieap_domain::{Gain, GroupDiagnosis, HeldOutGain, Prediction, Verdict};
use ieap_show::{Block, Sheet, Table};

/// Errors before and after, on readings that took no part in the fit; none where nothing was held out, or the readings allow
/// no finding.
pub fn errors(found: &GroupDiagnosis) -> Option<Block> {
    let section = gain_section(found)?;
    let mut blocks = section.caution();
    blocks.push(Block::Table(section.blocks.first()?.errors(section.column)));
    Some(Block::part("Errors before and after", blocks))
}

/// Everything about the gain of a group's extension.
#[derive(Debug)]
pub struct GainSection {
    /// Title.
    pub heading: String,
    /// What a reader must know first; empty where the extension stands.
    caution: &'static str,
    /// Head of the extension's column.
    column: &'static str,
    blocks: Vec<GainBlock>,
}

impl GainSection {
    /// What is said of it.
    pub fn blocks(&self) -> Vec<Block> {
        let mut blocks = self.caution();
        blocks.extend(self.blocks.iter().map(|own| own.part(self.column)));
        blocks
    }

    fn caution(&self) -> Vec<Block> {
        let caution = Some(self.caution).filter(|caution| !caution.is_empty());
        caution.map(Block::say).into_iter().collect()
    }
}

/// The gain on one kind of held-out readings.
#[derive(Debug)]
struct GainBlock {
    heading: &'static str,
    sentence: String,
    /// What, before, after.
    rows: Vec<[String; 3]>,
    /// What was held out, and the gain there; all of it last.
    parts: Vec<[String; 2]>,
}

impl GainBlock {
    fn part(&self, column: &str) -> Block {
        let parts = Sheet::<&[String; 2]>::new("held-out", "", 1)
            .plain("Held out", |row| row[0].as_str())
            .plain("Gain", |row| row[1].as_str())
            .over(&self.parts);
        let errors = self.errors(column);
        let blocks = vec![
            Block::say(&self.sentence),
            Block::Table(errors),
            Block::Table(parts),
        ];
        Block::part(self.heading, blocks)
    }

    fn errors(&self, column: &str) -> Table {
        Sheet::<&[String; 3]>::new("errors", "", 1)
            .plain("Measure", |row| row[0].as_str())
            .plain(BASE, |row| row[1].as_str())
            .plain(column, |row| row[2].as_str())
            .over(&self.rows)
    }
}

/// What the extension of that finding is called: one that was not accepted is not the group's model.
pub fn extension(found: &GroupDiagnosis) -> &'static str {
    match found.verdict {
        Verdict::Unexplained => "extension that was tried",
        Verdict::Differs => "base model with laws of the voltage",
        _ => "extended model",
    }
}

/// The same at the head of a column and in a legend.
fn in_legend(found: &GroupDiagnosis) -> &'static str {
    match found.verdict {
        Verdict::Unexplained => "Extension tried",
        Verdict::Differs => "Laws of the voltage",
        _ => "Extended model",
    }
}

const BASE: &str = "Base model";

/// What the models are called beside a curve of one run. Where runs scatter, what is drawn of a run holds its own deviations.
pub fn called(found: &GroupDiagnosis) -> Called<'static> {
    Called {
        base: if found.scatter_is_noise {
            "Base model, with this run's own deviations"
        } else {
            BASE
        },
        extension: in_legend(found),
    }
}

/// The same of readings that took no part in the fits, which tell no deviations.
pub fn called_held_out(found: &GroupDiagnosis) -> Called<'static> {
    Called {
        base: BASE,
        ..called(found)
    }
}

/// The section; none where nothing was held out, or the readings allow no finding.
pub fn gain_section(found: &GroupDiagnosis) -> Option<GainSection> {
    let gain = found.gain.as_ref()?;
    let subject = extension(found);
    let (heading, caution) = match found.verdict {
        Verdict::DataProblem => return None,
        Verdict::Unexplained => (
            format!("What the {subject} would gain"),
            "It fits best of all that is known here and was not accepted: it is no cause, and no fit or table uses it.",
        ),
        _ => (format!("What the {subject} gains"), ""),
    };
    let mut blocks = vec![proof(gain, found.runs.len(), subject)];
    blocks.extend(
        gain.outside
            .as_ref()
            .map(|outside| outside_block(outside, subject)),
    );
    blocks.extend(gain.later.as_ref().map(|later| later_block(later, subject)));
    Some(GainSection {
        heading,
        caution,
        column: in_legend(found),
        blocks,
    })
}

fn proof(gain: &Gain, runs: usize, subject: &str) -> GainBlock {
    let (heading, what) = match gain.parts_word(runs) {
        "stretches of time" => (
            "Stretches of time left out",
            "stretches of time that took no part in the fit",
        ),
        "drives" => (
            "Drives left out, with all their repeats",
            "drives that took no part in the fit",
        ),
        _ => ("Runs left out", "runs that took no part in the fit"),
    };
    let what = match gain.outside {
        Some(_) => format!("{what} and lie between others"),
        None => what.to_owned(),
    };
    let mut block = block(heading, &what, (&gain.proof, &gain.predictions), subject);
    block.rows.push([
        "Residuals of the fit to all readings, in σ of the noise".to_owned(),
        significant(gain.residual_rms_sigma_before, 3),
        significant(gain.residual_rms_sigma_after, 3),
    ]);
    block
}

fn outside_block(outside: &HeldOutGain, subject: &str) -> GainBlock {
    let what = "runs that took no part in the fit and lie outside what the others measured";
    block("Outside what the others measured", what, (outside, &[]), subject)
}

fn later_block(later: &HeldOutGain, subject: &str) -> GainBlock {
    let what = "ends of runs (the last 40 %, from the first 60 % of all)";
    block("Later times from earlier ones", what, (later, &[]), subject)
}

fn block(
    heading: &'static str,
    what: &str,
    (gain, predictions): (&HeldOutGain, &[Prediction]),
    subject: &str,
) -> GainBlock {
    let part = |(name, fall): &(String, f64)| [name.clone(), significant(*fall, 3)];
    let all = measured(gain.deviance, gain.standard_error);
    let all = ["All, ± standard error".to_owned(), all];
    GainBlock {
        heading,
        sentence: gain_words(&format!("the {subject}"), what, gain, predictions),
        rows: rows(gain, predictions),
        parts: gain.parts.iter().map(part).chain([all]).collect(),
    }
}

fn rows(gain: &HeldOutGain, predictions: &[Prediction]) -> Vec<[String; 3]> {
    let error = |error: StatedError| {
        let of_range = if error.is_of_range {
            ", in % of its range"
        } else {
            ""
        };
        let what = format!("Error of predicted {}{of_range}", error.of);
        [what, error.before, error.after]
    };
    let coverage = gain.coverage_before.zip(gain.coverage_after);
    let coverage = coverage.map(|(before, after)| {
        let what = "Held-out readings within their 95 % interval".to_owned();
        [what, percent(before, 0), percent(after, 0)]
    });
    let errors = stated_errors(gain, predictions).into_iter().map(error);
    errors.chain(coverage).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::testing::{self, held_out};

    fn gain(deviance: f64, falls: &[f64], errors: [f64; 2]) -> HeldOutGain {
        HeldOutGain {
            parts: falls.iter().map(|fall| ("run".to_owned(), *fall)).collect(),
            nrmse_current_before: Some(errors[0]),
            nrmse_current_after: Some(errors[1]),
            ..held_out(deviance, 1.0)
        }
    }

    #[test]
    fn an_extension_that_was_not_accepted_is_not_called_the_model() {
        let mut found = testing::finding();
        found.gain = Some(testing::gain(gain(8.0, &[8.0], [0.2, 0.1])));
        assert!(gain_section(&found).is_none());
        found.verdict = Verdict::Law;
        let section = gain_section(&found).unwrap();
        assert!(section.heading.contains("extended model gains") && section.caution.is_empty());
        found.verdict = Verdict::Unexplained;
        let section = gain_section(&found).unwrap();
        assert!(section.heading.contains("was tried") && section.caution.contains("not accepted"));
        assert!(!section.blocks[0].sentence.contains("extended model"));
    }
}
