//! What an extension gains on readings that took no part in its fit, for the page of one group.

use serde::Serialize;

use crate::figures::residual::Called;
use crate::pages::policy::ERROR_RISES_FACTOR;
use ieap_domain::number::{measured, percent, significant};
use ieap_domain::{Gain, GroupDiagnosis, HeldOutGain, Verdict};

/// Errors before and after, on readings that took no part in the fit.
#[derive(Debug, Serialize)]
pub struct ErrorTable {
    sentence: String,
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
        sentence: first.sentence,
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
        Verdict::Unknown => "extension that was tried",
        _ => "extended model",
    }
}

/// The same at the head of a column and in a legend.
fn in_legend(found: &GroupDiagnosis) -> &'static str {
    match found.verdict {
        Verdict::Unknown => "Extension tried",
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
        Verdict::Unknown => (
            format!("What the {subject} would gain"),
            "It fits best of all that is known here and was not accepted: it is no cause, and no fit or table uses it.",
        ),
        _ if !gain.proof.is_clear() => (
            format!("Whether the {subject} gains"),
            "That it predicts better what was left out is not clear: not every part comes out better, and the 95 % interval of the fall of the deviance reaches zero.",
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
    let mut block = block(heading, what, &gain.proof, subject);
    block.rows.extend(gain.predictions.iter().map(|of| {
        let percent = |value: f64| format!("{} %", significant(value, 2));
        (
            format!("Error of predicted {}", in_words(&of.quantity)),
            percent(of.before_percent),
            percent(of.after_percent),
        )
    }));
    block.rows.push((
        "Residuals of the fit to all readings, in σ of the noise".to_owned(),
        significant(gain.residual_rms_sigma_before, 3),
        significant(gain.residual_rms_sigma_after, 3),
    ));
    block
}

fn later_block(later: &HeldOutGain, subject: &str) -> GainBlock {
    let what = "the last 40 % of every run from the first 60 % of all";
    block("Later times from earlier ones", what, later, subject)
}

fn block(heading: &str, what: &str, gain: &HeldOutGain, subject: &str) -> GainBlock {
    GainBlock {
        heading: heading.to_owned(),
        sentence: sentence(what, gain, subject),
        rows: rows(gain),
        parts: gain
            .parts
            .iter()
            .map(|(name, fall)| (name.clone(), significant(*fall, 3)))
            .collect(),
        total: measured(gain.deviance, gain.standard_error),
    }
}

fn sentence(what: &str, gain: &HeldOutGain, subject: &str) -> String {
    let (better, all) = gain.better_parts();
    let which = match (better == all, gain.deviance > 0.0) {
        (true, _) if gain.is_clear() => "all better than the base model does".to_owned(),
        (_, true) if !gain.is_clear() => format!(
            "{better} of {all} better than the base model does, and in the sum not clearly so (its 95 % interval reaches zero)"
        ),
        (_, true) => format!("{better} of {all} better than the base model does, and better in the sum"),
        (_, false) => format!("{better} of {all} better than the base model does, and worse in the sum"),
    };
    let doubt = if gain.deviance > 0.0 && error_rises(gain) {
        " Its best guess lies farther off than that of the base model, but it claims to know less: the deviance \
         counts both."
    } else {
        ""
    };
    format!("Asked to predict {what}, the {subject} predicts {which}.{doubt}")
}

/// Whether the error of a channel in percent rises.
fn error_rises(gain: &HeldOutGain) -> bool {
    let pairs = [
        (gain.nrmse_current_before, gain.nrmse_current_after),
        (gain.nrmse_curvature_before, gain.nrmse_curvature_after),
    ];
    let rises = |(before, after): (Option<f64>, Option<f64>)| Some(after? > ERROR_RISES_FACTOR * before?);
    pairs.into_iter().any(|pair| rises(pair) == Some(true))
}

fn rows(gain: &HeldOutGain) -> Vec<(String, String, String)> {
    let error = |part: f64| format!("{} %", significant(100.0 * part, 2));
    let share = |part: f64| percent(part, 0);
    let row = |name: &str, pair: (Option<f64>, Option<f64>), text: &dyn Fn(f64) -> String| {
        Some((name.to_owned(), text(pair.0?), text(pair.1?)))
    };
    let current = (gain.nrmse_current_before, gain.nrmse_current_after);
    let curvature = (gain.nrmse_curvature_before, gain.nrmse_curvature_after);
    let coverage = (gain.coverage_before, gain.coverage_after);
    [
        row("Error of predicted current, in % of its range", current, &error),
        row(
            "Error of predicted curvature, in % of its range",
            curvature,
            &error,
        ),
        row("Held-out readings within their 95 % interval", coverage, &share),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// A predicted quantity in words.
fn in_words(quantity: &str) -> &str {
    match quantity {
        "peak_curvature" => "largest curvature",
        "time_of_peak_curvature" => "time of the largest curvature",
        "end_curvature" => "curvature at the end",
        "charge" => "charge passed",
        "end_current" => "current at the end",
        other => other,
    }
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
    fn a_wider_claim_that_is_farther_off_is_said_to_be_one() {
        let said = |gain| sentence("it", &gain, "extended model");
        assert_eq!(
            said(gain(8.0, &[5.0, 3.0], [0.2, 0.1])),
            "Asked to predict it, the extended model predicts all better than the base model does."
        );
        assert!(said(gain(8.0, &[5.0, 3.0], [0.1, 0.2])).contains("farther off"));
        assert!(!said(gain(-8.0, &[-5.0, -3.0], [0.1, 0.2])).contains("farther off"));
    }

    #[test]
    fn a_gain_that_may_be_none_is_not_told_as_one() {
        let unclear = HeldOutGain {
            standard_error: 6.0,
            ..gain(8.0, &[9.0, 1.0, -2.0], [0.2, 0.1])
        };
        let text = sentence("it", &unclear, "extended model");
        assert!(
            text.contains("not clearly so") && !text.contains("all better"),
            "{text}"
        );
        let mut found = testing::finding();
        found.verdict = Verdict::Partial;
        found.gain = Some(testing::gain(unclear));
        let section = gain_section(&found).unwrap();
        assert!(section.heading.starts_with("Whether") && section.caution.contains("not clear"));
        assert!(!super::super::finding_words::verdict_of(&found).contains("found"));
    }

    #[test]
    fn an_extension_that_was_not_accepted_is_not_called_the_model() {
        let mut found = testing::finding();
        found.gain = Some(testing::gain(gain(8.0, &[8.0], [0.2, 0.1])));
        assert!(gain_section(&found).is_none());
        found.verdict = Verdict::Named;
        let section = gain_section(&found).unwrap();
        assert!(section.heading.contains("extended model gains") && section.caution.is_empty());
        found.verdict = Verdict::Unknown;
        let section = gain_section(&found).unwrap();
        assert!(section.heading.contains("was tried") && section.caution.contains("not accepted"));
        assert!(!section.blocks[0].sentence.contains("extended model"));
    }
}
