//! What a spectrum and the steps say together, in sentences: where they disagree and which effect would do that.

use std::f64::consts::TAU;

use ieap_domain::number::{fixed, interval, rounded_bound, significant};
use ieap_domain::{Estimate, EstimateState};

use crate::laws::words::symbol;

use super::beside::{BesideRow, Comparison, can_be_same};

/// A ratio within which a difference is too small to speak of an effect, though it lies beyond the intervals: two
/// mountings of one strip differ by as much.
const SLIGHT: f64 = 1.1;

/// Writes the sentences of a comparison and names the effects.
pub fn describe(comparison: &mut Comparison) {
    let mut said = Said::default();
    let title = &comparison.circuit;
    if !comparison.describes {
        let sentence = format!(
            "{title} does not describe the spectrum: it leaves {} % of |Z|, {} leaves {} %. Its numbers are those of the \
             nearest such circuit, their intervals too narrow, and nothing is concluded from how they differ from the step's.",
            fixed(comparison.residual_rms_percent, 1),
            comparison.best,
            fixed(comparison.best_rms_percent, 1)
        );
        match comparison.best.as_str() {
            "constant-phase" => said.say(sentence, &["dispersion"]),
            "warburg-finite" | "warburg-parallel" => said.say(sentence, &["warburg"]),
            _ => said.say(sentence, &[]),
        }
        (comparison.sentences, comparison.effects) = (said.sentences, said.effects);
        return;
    }
    leak(comparison, &mut said);
    fastest(comparison, &mut said);
    total(comparison, &mut said);
    chains(comparison, &mut said);
    let mut sentences = Vec::new();
    let determined = comparison.rows.iter().any(|row| row.agrees.is_some());
    sentences.push(match (determined, said.sentences.is_empty()) {
        (false, _) => format!("Nothing can be compared: step and spectrum determine no number of {title} together."),
        (true, true) => format!(
            "The step and the spectrum tell the same circuit {title}: no number differs beyond its uncertainty and a tenth."
        ),
        (true, false) => format!("The step and the spectrum do not tell the same circuit {title}."),
    });
    sentences.append(&mut said.sentences);
    (comparison.sentences, comparison.effects) = (sentences, said.effects);
}

#[derive(Default)]
struct Said {
    sentences: Vec<String>,
    effects: Vec<&'static str>,
}

impl Said {
    fn effect(&mut self, id: &'static str) {
        if !self.effects.contains(&id) {
            self.effects.push(id);
        }
    }

    fn say(&mut self, sentence: String, effects: &[&'static str]) {
        self.sentences.push(sentence);
        effects.iter().for_each(|id| self.effect(id));
    }
}

fn row<'a>(comparison: &'a Comparison, key: &str) -> Option<&'a BesideRow> {
    comparison.rows.iter().find(|row| row.key == key)
}

/// Step over spectrum of a number that differs by more than slightly.
fn differs(row: &BesideRow) -> Option<f64> {
    let ratio = row.ratio.value?;
    (row.agrees == Some(false) && !(SLIGHT.recip()..=SLIGHT).contains(&ratio)).then_some(ratio)
}

/// A number of a sentence that names its unit.
fn number(estimate: &Estimate) -> String {
    match estimate.state() {
        EstimateState::Determined(value) => significant(value, 4),
        EstimateState::Between(low, high) => interval(low, high),
        EstimateState::Above(low) => format!("more than {}", rounded_bound(low, false).value_text()),
        EstimateState::Below(high) => format!("less than {}", rounded_bound(high, true).value_text()),
        EstimateState::Open => "not determined".to_owned(),
    }
}

/// A steady current that the spectrum does not know.
fn leak(comparison: &Comparison, said: &mut Said) {
    let Some(row) = row(comparison, "rss_ohm_cm2") else {
        return;
    };
    let lower = |step: &Estimate| {
        can_be_same(step, &row.spectrum) == Some(false)
            && step.value.or(step.high_95) < row.spectrum.value.or(row.spectrum.low_95)
    };
    let highest = comparison.highest.as_ref().zip(row.step_at_highest.as_ref());
    let onset = highest.filter(|pair| lower(pair.1) && !lower(&row.step));
    if let Some((side, step)) = onset {
        let sentence = format!(
            "At {} V the step leaks (R_ss {} Ω cm²), at {} V and in the spectrum ({} Ω cm²) it does not: a leak above an onset \
             does that (faradaic-leak), which the small voltage of a spectrum never reaches.",
            side.voltage_v,
            number(step),
            comparison.lowest.voltage_v,
            number(&row.spectrum)
        );
        said.say(sentence, &["faradaic-leak"]);
    } else if lower(&row.step) {
        let sentence = format!(
            "The step leaks more than the spectrum allows: R_ss is {} Ω cm² at {} V and {} Ω cm² in the spectrum. A leak above an \
             onset is seen by the step alone (faradaic-leak); so is one that lasts longer than a cycle of the lowest frequency \
             (diffusion-limited-leak).",
            number(&row.step),
            comparison.lowest.voltage_v,
            number(&row.spectrum)
        );
        said.say(sentence, &["faradaic-leak", "diffusion-limited-leak"]);
    } else if row.agrees == Some(false) {
        let sentence = format!(
            "The spectrum leaks more than the step: R_ss is {} Ω cm² in it and {} Ω cm² in the step. Below {} Hz nothing was \
             measured: a slow chain looks like a leak there (slow-branch).",
            number(&row.spectrum),
            number(&row.step),
            significant(comparison.lowest_hz, 2)
        );
        said.say(sentence, &["slow-branch"]);
    }
}

/// The resistance of the first current and of the highest frequencies.
fn fastest(comparison: &Comparison, said: &mut Said) {
    let Some(row) = row(comparison, "r_parallel_ohm_cm2") else {
        return;
    };
    let Some(ratio) = differs(row) else { return };
    let (step, spectrum) = (number(&row.step), number(&row.spectrum));
    if ratio < 1.0 {
        said.say(
            format!(
                "The spectrum has the larger resistance at its fast end: R∥ is {spectrum} Ω cm² in it and {step} Ω cm² in the step. A \
                 series resistance of leads or contacts stands there first (series-resistance)."
            ),
            &["series-resistance"],
        );
    } else {
        said.say(
            format!(
                "The step has the larger resistance at its fast end: R∥ is {step} Ω cm² in it and {spectrum} Ω cm² in the spectrum. A \
                 source that clips or rises slowly does that (current-limit, source-rise), and so do readings too far apart to \
                 see the first current."
            ),
            &["current-limit", "source-rise"],
        );
    }
}

/// The charge of a volt.
fn total(comparison: &Comparison, said: &mut Said) {
    let Some(row) = row(comparison, "c_total_f_per_cm2") else {
        return;
    };
    let Some(ratio) = differs(row) else { return };
    let (step, spectrum) = (number(&row.step), number(&row.spectrum));
    let seen_s = (TAU * comparison.lowest_hz).recip();
    if ratio > 1.0 {
        said.say(
            format!(
                "The step stores more: C_total is {step} F/cm² in it and {spectrum} F/cm² in the spectrum, which sees what charges within \
                 {} s. Slower charging (slow-branch, dispersion) or a capacitance that grows with the voltage \
                 (voltage-dependent-capacitance) does that; a lower frequency tells them apart.",
                fixed(seen_s, 0)
            ),
            &["slow-branch", "dispersion", "voltage-dependent-capacitance"],
        );
    } else {
        said.say(
            format!(
                "The spectrum stores more: C_total is {spectrum} F/cm² in it and {step} F/cm² in the step. A capacitance that falls with \
                 the voltage (voltage-dependent-capacitance), or a step that ended before the strip was charged, does that."
            ),
            &["voltage-dependent-capacitance"],
        );
    }
}

/// How charge and resistance are shared between the chains.
fn chains(comparison: &Comparison, said: &mut Said) {
    let parts = ["r1_ohm_cm2", "c1_f_per_cm2", "r2_ohm_cm2", "c2_f_per_cm2"];
    let off: Vec<&BesideRow> = parts
        .iter()
        .filter_map(|key| row(comparison, key))
        .filter(|row| differs(row).is_some())
        .collect();
    let wholes = ["r_parallel_ohm_cm2", "c_total_f_per_cm2"];
    let wholes_differ = wholes
        .iter()
        .any(|key| row(comparison, key).is_some_and(|row| differs(row).is_some()));
    if off.is_empty() || wholes_differ {
        return;
    }
    let symbols: Vec<&str> = off.iter().map(|row| symbol(row.key)).collect();
    let sentence = format!(
        "{} differ, though total capacitance and fast resistance do not: two chains share a spread of time constants in another \
         way at other frequencies (dispersion, warburg).",
        symbols.join(", ")
    );
    said.say(sentence, &["dispersion", "warburg"]);
}
