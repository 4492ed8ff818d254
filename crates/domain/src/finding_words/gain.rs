//! What an extension gains on readings that took no part in its fit.

use crate::number::significant;
use crate::words::in_a_row;
use crate::{HeldOutGain, Prediction};

/// An error of what was predicted, by the base model and with the extension, as every medium prints it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StatedError {
    /// What was predicted.
    pub of: String,
    /// Whether it is in percent of the range of a channel.
    pub is_of_range: bool,
    /// `39 %`, by the base model.
    pub before: String,
    /// The same with the extension.
    pub after: String,
    /// Whether it is larger with the extension, as printed.
    pub grows: bool,
    /// Whether by more than the error of so many parts is known to.
    pub grows_clearly: bool,
    /// Whether it is smaller with the extension, as printed.
    pub falls: bool,
}

/// The errors that are stated of held-out readings: of the channels, then of what a user predicts.
pub fn errors(gain: &HeldOutGain, predictions: &[Prediction]) -> Vec<StatedError> {
    // What errs within a run errs together, so that a mean square of as many parts has a standard error of this part of its root.
    let known_to = (2.0 * gain.parts.len().max(1) as f64).sqrt().recip();
    let stated = |of: &str, is_of_range: bool, before: f64, after: f64| {
        let [before_text, after_text] =
            [before, after].map(|percent| format!("{} %", significant(percent, 2)));
        StatedError {
            of: of.to_owned(),
            is_of_range,
            grows: after > before && after_text != before_text,
            grows_clearly: after > (1.0 + known_to) * before,
            falls: after < before && after_text != before_text,
            before: before_text,
            after: after_text,
        }
    };
    let channel = |of: &str, before: Option<f64>, after: Option<f64>| {
        Some(stated(of, true, 100.0 * before?, 100.0 * after?))
    };
    let channels = [
        channel("current", gain.nrmse_current_before, gain.nrmse_current_after),
        channel(
            "curvature",
            gain.nrmse_curvature_before,
            gain.nrmse_curvature_after,
        ),
    ];
    let predicted = predictions.iter().map(|own| {
        stated(
            quantity(&own.quantity),
            false,
            own.before_percent,
            own.after_percent,
        )
    });
    channels.into_iter().flatten().chain(predicted).collect()
}

/// `With it all 3 held-out runs are predicted better: the error of the current falls from 39 % to 1.8 %.`; only what
/// falls, and grows beyond doubt, where a stated error grows.
pub fn gain_words(with: &str, what: &str, gain: &HeldOutGain, predictions: &[Prediction]) -> String {
    let stated = errors(gain, predictions);
    let (better, all) = gain.better_parts();
    let which = match (better == all, all) {
        (_, 0) => what.to_owned(),
        (true, 1) => format!("the {what}"),
        (true, _) => format!("all {all} {what}"),
        (false, _) if better == 0 => format!("none of the {what}"),
        (false, _) => format!("{better} of {all} {what}"),
    };
    let is_several = ["runs", "drives", "stretches"]
        .iter()
        .any(|word| what.contains(word));
    let is_one = !is_several || (better < all && better < 2);
    let are = if is_one { "is" } else { "are" };
    let sum = match gain.deviance > 0.0 {
        _ if gain.is_clear() => "",
        true => ", which may be chance",
        false => ", and all together are not",
    };
    // The first one in full, those of the same kind behind it in short.
    let said = |all: Vec<&StatedError>, verb: &str, begins: &str| {
        let each = all.iter().enumerate().map(|(at, error)| match at {
            0 => format!(
                "{begins} of the {} {verb} from {} to {}",
                error.of, error.before, error.after
            ),
            _ => format!(
                "that of the {} from {} to {}",
                error.of, error.before, error.after
            ),
        });
        in_a_row(&each.collect::<Vec<_>>())
    };
    let is_told = |error: &&StatedError| error.is_of_range && error.falls;
    let better: Vec<&StatedError> = stated.iter().filter(is_told).collect();
    let is_worse = |error: &&StatedError| error.grows && (error.grows_clearly || better.is_empty());
    let worse: Vec<&StatedError> = stated.iter().filter(is_worse).collect();
    let is_any_larger = stated.iter().any(|error| error.grows);
    let what = if is_several {
        what.to_owned()
    } else {
        format!("the {what}")
    };
    match (better.is_empty(), worse.is_empty()) {
        (true, true) => format!("With {with} {which} {are} predicted better{sum}."),
        (false, true) if is_any_larger => {
            format!("With {with} {} in {what}.", said(better, "falls", "the error"))
        }
        (false, true) => format!(
            "With {with} {which} {are} predicted better{sum}: {}.",
            said(better, "falls", "the error")
        ),
        (true, false) => format!("With {with} {} in {what}.", said(worse, "grows", "the error")),
        (false, false) => format!(
            "With {with} {} in {what}, but {}.",
            said(better, "falls", "the error"),
            said(worse, "grows", "that")
        ),
    }
}

/// The error that falls furthest, in a clause: `the error of the current falls from 39 % to 1.8 %`; nothing where none falls.
pub fn gain_in_short(gain: &HeldOutGain) -> Option<String> {
    let fall = |before: Option<f64>, after: Option<f64>| {
        before.zip(after).map_or(1.0, |(before, after)| after / before)
    };
    let is_first = fall(gain.nrmse_current_before, gain.nrmse_current_after)
        <= fall(gain.nrmse_curvature_before, gain.nrmse_curvature_after);
    let named = if is_first { "current" } else { "curvature" };
    let stated = errors(gain, &[]);
    let own = stated.iter().find(|error| error.of == named)?;
    own.falls.then(|| {
        format!(
            "the error of the {named} falls from {} to {}",
            own.before, own.after
        )
    })
}

/// A predicted quantity in words.
fn quantity(key: &str) -> &str {
    match key {
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
    use crate::testing::held_out;

    fn said(deviance: f64, falls: &[f64], errors: [f64; 2]) -> String {
        let gain = HeldOutGain {
            parts: falls.iter().map(|fall| ("run".to_owned(), *fall)).collect(),
            nrmse_current_before: Some(errors[0]),
            nrmse_current_after: Some(errors[1]),
            ..held_out(deviance, 6.0)
        };
        gain_words("it", "held-out runs", &gain, &[])
    }

    #[test]
    fn a_gain_is_told_by_its_parts_and_its_errors() {
        assert_eq!(
            said(8.0, &[5.0, 3.0], [0.39, 0.018]),
            "With it all 2 held-out runs are predicted better: the error of the current falls from 39 % to 1.8 %."
        );
        // Likelier by a wider claim and farther off is no better prediction.
        assert_eq!(
            said(8.0, &[5.0, 3.0], [0.1, 0.2]),
            "With it the error of the current grows from 10 % to 20 % in held-out runs."
        );
        let unclear = said(8.0, &[9.0, 1.0, -2.0], [0.2, 0.1]);
        assert!(
            unclear.contains("2 of 3 held-out runs") && unclear.contains("may be chance"),
            "{unclear}"
        );
    }
}
