//! The finding in one plain sentence.

use super::{FindingBuilder, SPIKED_WORDS};
use crate::cause::select::BEATEN;
use crate::levels::{RIGHT, WRONG};
use ieap_domain::diagnosis::follows_a_tag;
use ieap_domain::{GroupDiagnosis, Verdict};
use ieap_model::effects::effect;

impl FindingBuilder<'_, '_> {
    pub(crate) fn sentence(&self, found: &GroupDiagnosis, taken: &[&str], passed: bool) -> String {
        let place = found.whereabouts.as_ref().map_or("", |w| &w.text);
        let summary = |id: &str| {
            effect(id).map_or_else(|| id.to_owned(), |e| format!("{} ({})", id, e.about().summary))
        };
        match found.verdict {
            Verdict::Named | Verdict::Set | Verdict::Partial | Verdict::Resembles => {
                let words = |id: &&str| with_parameter(found, id, summary(id));
                let names: Vec<String> = taken.iter().map(words).collect();
                cause(found, place, taken, &names)
            }
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
                "The simulation is wrong ({place}), and no known cause explains it. {}",
                left_words((self.base.square / self.group.rows().max(1) as f64).sqrt())
            ),
        }
    }
}

/// Size of what is left, over that of the noise, from which it is told as a number.
const LARGER: f64 = 1.05;

/// How large what is left is, over the noise.
fn left_words(over_noise: f64) -> String {
    match over_noise < LARGER {
        true => "What it leaves is no larger than the noise, but has a shape that noise has not.".to_owned(),
        false => format!("What it leaves is {over_noise:.1} times as large as the noise."),
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

/// What is said of a cause: no more than what was held out proves. `names` are those of `taken` with what they are.
fn cause(found: &GroupDiagnosis, place: &str, taken: &[&str], names: &[String]) -> String {
    let proof = format!("{}{}", proof(found), doubt(found));
    let misfit = match doubt(found).is_empty() {
        true => ", and a misfit is left",
        false => "",
    };
    match (found.verdict, found.gains_clearly()) {
        (Verdict::Named, true) => {
            format!("The simulation misses {}: {place}.{proof}", names.join(" and "))
        }
        (Verdict::Named, false) => format!(
            "The simulation is wrong ({place}); {} fits, and is not proved.{proof}",
            names.join(" with ")
        ),
        (Verdict::Set, is_proved) => format!(
            "The simulation is wrong ({place}); {} {} equally well.{proof}",
            found.set.join(", "),
            if is_proved { "explain it" } else { "fit" }
        ),
        (Verdict::Resembles, _) => format!(
            "The simulation is wrong ({place}); what it lacks looks like {}, and its course is not quite that.{proof}",
            names.join(" with ")
        ),
        (_, true) => format!(
            "The simulation is wrong ({place}); {} explains most of it{misfit}.{proof}",
            taken.join(" with ")
        ),
        (_, false) => format!(
            "The simulation is wrong ({place}); {} fits, and is not proved{misfit}.{proof}",
            taken.join(" with ")
        ),
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

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::testing::{finding, gain, held_out};

    fn said(verdict: Verdict, standard_error: f64) -> String {
        let found = GroupDiagnosis {
            verdict,
            set: vec!["warburg".into(), "slow-branch".into()],
            gain: Some(gain(held_out(23_197.0, standard_error))),
            ..finding()
        };
        cause(
            &found,
            "after steps",
            &["warburg"],
            &["warburg (diffusion)".to_owned()],
        )
    }

    #[test]
    fn a_fall_that_may_be_none_is_no_explanation() {
        for verdict in [Verdict::Named, Verdict::Set, Verdict::Partial] {
            let unclear = said(verdict, 23_250.0);
            assert!(unclear.contains("23197 +- 23250, may be none"), "{unclear}");
            let claims = ["in part", "most of it", "explain", "misses"];
            assert!(claims.iter().all(|claim| !unclear.contains(claim)), "{unclear}");
            let clear = said(verdict, 2_325.0);
            assert!(clear.contains("the deviance falls by 23197 +- 2325"), "{clear}");
            assert!(claims.iter().any(|claim| clear.contains(claim)), "{clear}");
        }
    }
}
