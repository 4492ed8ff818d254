//! What an extension gains on readings that took no part in its fit, for the page of one group.

use serde::Serialize;

use crate::figures::residual::Called;
use ieap_domain::finding_words::{StatedError, errors, gain_words};
use ieap_domain::number::{measured, percent, significant};
use ieap_domain::{Gain, GroupDiagnosis, HeldOutGain, Prediction, Verdict};

/// Errors before and after, on readings that took no part in the fit.
#[derive(Debug, Serialize)]
pub struct ErrorTable {
    /// What a reader must know first; empty where the extension stands.
    caution: &'static str,
    /// Head of the extension's column.
    column: &'static str,
    rows: Vec<(String, String, String)>,
}

/// The table; none where nothing was held out, or the readings allow no finding.
pub fn error_table(found: &GroupDiagnosis) -> Option<ErrorTable> {
    let section = gain_section(found)?;
    let first = section.blocks.into_iter().next()?;
    Some(ErrorTable {
        caution: section.caution,
        column: section.column,
        rows: first.rows,
    })
}

/// Everything about the gain of a group's extension.
#[derive(Debug, Serialize)]
pub struct GainSection {
    heading: String,
    /// What a reader must know first; empty where the extension stands.
    caution: &'static str,
    /// Head of the extension's column.
    column: &'static str,
    blocks: Vec<GainBlock>,
}

/// The gain on one kind of held-out readings.
#[derive(Debug, Serialize)]
struct GainBlock {
    heading: String,
    sentence: String,
    rows: Vec<(String, String, String)>,
    parts: Vec<(String, String)>,
    total: String,
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
    let mut block = block(heading, what, (&gain.proof, &gain.predictions), subject);
    block.rows.push((
        "Residuals of the fit to all readings, in σ of the noise".to_owned(),
        significant(gain.residual_rms_sigma_before, 3),
        significant(gain.residual_rms_sigma_after, 3),
    ));
    block
}

fn later_block(later: &HeldOutGain, subject: &str) -> GainBlock {
    let what = "ends of runs (the last 40 %, from the first 60 % of all)";
    block("Later times from earlier ones", what, (later, &[]), subject)
}

fn block(
    heading: &str,
    what: &str,
    (gain, predictions): (&HeldOutGain, &[Prediction]),
    subject: &str,
) -> GainBlock {
    GainBlock {
        heading: heading.to_owned(),
        sentence: gain_words(&format!("the {subject}"), what, gain, predictions),
        rows: rows(gain, predictions),
        parts: gain
            .parts
            .iter()
            .map(|(name, fall)| (name.clone(), significant(*fall, 3)))
            .collect(),
        total: measured(gain.deviance, gain.standard_error),
    }
}

fn rows(gain: &HeldOutGain, predictions: &[Prediction]) -> Vec<(String, String, String)> {
    let error = |error: StatedError| {
        let of_range = if error.is_of_range {
            ", in % of its range"
        } else {
            ""
        };
        (
            format!("Error of predicted {}{of_range}", error.of),
            error.before,
            error.after,
        )
    };
    let coverage = gain
        .coverage_before
        .zip(gain.coverage_after)
        .map(|(before, after)| {
            (
                "Held-out readings within their 95 % interval".to_owned(),
                percent(before, 0),
                percent(after, 0),
            )
        });
    let errors = errors(gain, predictions).into_iter().map(error);
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
