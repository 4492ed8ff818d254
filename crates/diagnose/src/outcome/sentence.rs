//! The finding in one plain sentence.

use super::{RIGHT, Shown, WRONG};
use crate::select::BEATEN;
use ieap_domain::diagnosis::follows_a_tag;
use ieap_domain::{GroupDiagnosis, Verdict};
use ieap_model::effects::effect;

impl Shown<'_, '_> {
    pub(super) fn sentence(&self, found: &GroupDiagnosis, taken: &[&str], passed: bool) -> String {
        let place = found.whereabouts.as_ref().map_or("", |w| &w.text);
        let summary = |id: &str| {
            effect(id).map_or_else(|| id.to_owned(), |e| format!("{} ({})", id, e.about().summary))
        };
        let proof = format!("{}{}", proof(found), doubt(found));
        match found.verdict {
            Verdict::Named => {
                let names: Vec<String> = taken
                    .iter()
                    .map(|id| with_parameter(found, id, summary(id)))
                    .collect();
                format!("The simulation misses {}: {place}.{proof}", names.join(" and "))
            }
            Verdict::Set => format!(
                "The simulation is wrong ({place}); {} explain it equally well.{proof}",
                found.set.join(", ")
            ),
            Verdict::Partial => format!(
                "The simulation is wrong ({place}); {} {} most of it{}.{proof}",
                taken.join(" with "),
                if found.gains_clearly() { "explains" } else { "fits" },
                if doubt(found).is_empty() {
                    ", and a misfit is left"
                } else {
                    ""
                }
            ),
            Verdict::DataProblem => SPIKED_WORDS.into(),
            _ if !taken.is_empty() && is_beaten(found) => format!(
                "The simulation is wrong ({place}), and no known cause is proved: {} fits, but a smooth answer to the voltage without a name predicts held-out readings better.",
                taken.join(" with ")
            ),
            _ if !taken.is_empty() && !passed => format!(
                "The simulation is wrong ({place}), and no known cause is proved: {} fits, but does not predict held-out readings.",
                taken.join(" with ")
            ),
            _ => format!(
                "The simulation is wrong ({place}), and no known cause explains it. It leaves {:.1} times the noise.",
                (self.base.square / self.group.rows().max(1) as f64).sqrt()
            ),
        }
    }
}

/// The words about an effect; where it follows a tag with the parameter that does, which the tag does not say.
fn with_parameter(found: &GroupDiagnosis, id: &str, words: String) -> String {
    let own = found
        .effects
        .iter()
        .find(|own| own.effect == id && follows_a_tag(id));
    match own.and_then(|own| own.variant.as_deref()) {
        Some(parameter) => format!("{words} in {parameter}"),
        None => words,
    }
}

/// What was held out, and what became of it.
fn proof(found: &GroupDiagnosis) -> String {
    let Some(gain) = &found.gain else {
        return String::new();
    };
    let (better, all) = gain.proof.better_parts();
    let what = gain.parts_word(found.runs.len());
    let sum = format!("{:.0} +- {:.0}", gain.proof.deviance, gain.proof.standard_error);
    if !gain.proof.is_clear() {
        return format!(
            " That it predicts held-out {what} better is not clear: {better} of {all} come out better, and the fall of the deviance, {sum}, may be none."
        );
    }
    let which = match better == all {
        true => format!("all {all}"),
        false => format!("{better} of {all}"),
    };
    format!(" It predicts {which} held-out {what} better: the deviance falls by {sum}.")
}

/// What is left of a misfit that is explained may still be more than chance leaves.
fn doubt(found: &GroupDiagnosis) -> String {
    let open = found.p_leftover.filter(|p| (WRONG..RIGHT).contains(p));
    open.map_or_else(String::new, |p| {
        format!(" What it leaves may be more than chance does (p = {p:.3}).")
    })
}

/// Whether what has no name predicts held-out readings better.
fn is_beaten(found: &GroupDiagnosis) -> bool {
    found
        .gain
        .as_ref()
        .is_some_and(|gain| gain.nameless_deviance > gain.proof.deviance + BEATEN)
}

pub(super) const SPIKED_WORDS: &str =
    "More than one reading in twenty stands far off its neighbours: the readings allow no finding.";
