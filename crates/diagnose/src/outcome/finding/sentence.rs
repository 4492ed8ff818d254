//! The finding in one plain sentence.

use super::{FindingBuilder, SPIKED_WORDS};
use crate::cause::evidence::{LARGEST_SET, SURE};
use crate::cause::policy::NAMELESS_BEATS_BY;
use crate::levels::{RIGHT_FROM, WRONG_BELOW};
use crate::outcome::policy::{LARGER_THAN_NOISE, LEAST_EXPLANATION, MOST_EXPLANATIONS};
use ieap_domain::diagnosis::follows_a_tag;
use ieap_domain::number::probabilities::equation;
use ieap_domain::number::{fixed, percent, significant};
use ieap_domain::words::in_a_row;
use ieap_domain::{GroupDiagnosis, Hypothesis, HypothesisKind, Verdict};
use ieap_model::effects::effect;

impl FindingBuilder<'_, '_> {
    /// Of a group of which a cause was sought; `lead` are the ids of the effects that explain most.
    pub(crate) fn sentence(&self, found: &GroupDiagnosis, lead: &[&str], predicts: bool) -> String {
        let place = found.whereabouts.as_ref().map_or("", |w| &w.text);
        match found.verdict {
            Verdict::DataProblem => SPIKED_WORDS.into(),
            verdict if verdict.extends_the_model() => cause(found, place),
            _ if predicts && found.p_leftover.is_some_and(|p| p >= WRONG_BELOW) => format!(
                "The simulation is wrong ({place}); it may be {}: these runs do not tell which.",
                likeliest(found)
            ),
            _ if lead.is_empty() || predicts => format!(
                "The simulation is wrong ({place}), and no known cause explains it. {}",
                left_words((self.base.square / self.group.rows().max(1) as f64).sqrt())
            ),
            _ if is_beaten(found) => format!(
                "The simulation is wrong ({place}), and no known cause is proved: {} fits, but a smooth answer to the voltage without a name predicts held-out readings better.",
                lead.join(" with ")
            ),
            _ => format!(
                "The simulation is wrong ({place}), and no known cause is proved: {} fits, but does not predict held-out readings.",
                lead.join(" with ")
            ),
        }
    }
}

/// The leading explanations with their probabilities.
fn likeliest(found: &GroupDiagnosis) -> String {
    let words = |own: &Hypothesis| {
        let what = match own.kind {
            HypothesisKind::Effect => own.effects.join(" with "),
            HypothesisKind::Varies => "parameters that differ".to_owned(),
            HypothesisKind::SlowNoise => "slow noise".to_owned(),
            HypothesisKind::Unnamed => "something without a name".to_owned(),
            HypothesisKind::Base => "nothing".to_owned(),
        };
        format!("{what} ({})", percent(own.mass, 0))
    };
    let told = found.posterior.iter().filter(|own| own.mass >= LEAST_EXPLANATION);
    let leading: Vec<String> = told.take(MOST_EXPLANATIONS).map(words).collect();
    match leading.split_last() {
        Some((last, first)) if !first.is_empty() => format!("{} or {last}", first.join(", ")),
        _ => leading.concat(),
    }
}

/// How large what is left is, over the noise.
fn left_words(over_noise: f64) -> String {
    if over_noise < LARGER_THAN_NOISE {
        "What it leaves is no larger than the noise, but has a shape that noise has not.".to_owned()
    } else {
        format!(
            "What it leaves is {} times as large as the noise.",
            fixed(over_noise, 1)
        )
    }
}

/// The words about an effect; where it follows a tag with the parameter that does, which the tag does not say.
fn with_summary(found: &GroupDiagnosis, id: &str) -> String {
    let words = effect(id).map_or_else(
        || id.to_owned(),
        |known| format!("{id} ({})", known.about().summary),
    );
    let own = found
        .effects
        .iter()
        .find(|own| own.effect == id && follows_a_tag(id));
    match own.and_then(|own| own.variant.as_deref()) {
        Some(parameter) => format!("{words} in {parameter}"),
        None => words,
    }
}

/// What is said of a cause: no more than what was held out proves.
fn cause(found: &GroupDiagnosis, place: &str) -> String {
    let proof = format!("{}{}", proof(found), doubt(found));
    let summaries: Vec<String> = found.set.iter().map(|id| with_summary(found, id)).collect();
    match (found.verdict, found.gains_clearly()) {
        (Verdict::Named, true) => {
            format!("The simulation misses {}: {place}.{proof}", in_a_row(&summaries))
        }
        (Verdict::Named, false) => format!(
            "The simulation is wrong ({place}); {} fits, and is not proved.{proof}",
            summaries.join(" with ")
        ),
        (Verdict::Set, _) => format!("The simulation is wrong ({place}); {}.{proof}", open(found)),
        (_, is_proved) => format!(
            "The simulation is wrong ({place}); {}{} {}, and a misfit without a name is left.{proof}",
            kind(found),
            together(found),
            if is_proved { "explains most of it" } else { "fits" }
        ),
    }
}

/// The effects that the extended model has; the set also holds what each of them may be in its place.
fn together(found: &GroupDiagnosis) -> String {
    let accepted: Vec<&str> = found.effects.iter().map(|own| own.effect.as_str()).collect();
    if accepted.is_empty() {
        found.set.join(" with ")
    } else {
        accepted.join(" with ")
    }
}

/// What is known of a cause of several: what is so, and which of them it may be.
fn open(found: &GroupDiagnosis) -> String {
    let sure = found.posterior.iter().filter(|own| !own.effects.is_empty());
    let probability = |id: &String| -> f64 {
        let holding = sure.clone().filter(|own| own.effects.contains(id));
        holding.map(|own| own.mass).sum()
    };
    let (certain, rest): (Vec<&String>, Vec<&String>) =
        found.set.iter().partition(|id| probability(id) >= SURE);
    let of = |ids: &[&String], word: &str| match ids {
        [] => String::new(),
        [one] => (*one).clone(),
        [first @ .., last] => {
            let first: Vec<&str> = first.iter().map(|id| id.as_str()).collect();
            format!("{} {word} {last}", first.join(", "))
        }
    };
    let may_be = match (certain.is_empty(), rest.len() > LARGEST_SET) {
        (_, true) => format!("{} causes of this kind fit", rest.len()),
        (true, false) => format!("{} fits", of(&rest, "or")),
        (false, false) => format!("{} with {} fits", of(&certain, "and"), of(&rest, "or")),
    };
    format!("{}{may_be}, and these runs do not tell which", kind(found))
}

/// What is so where no single effect is told.
fn kind(found: &GroupDiagnosis) -> String {
    let node = found.node.as_ref().filter(|node| node.depth < 3);
    node.map_or_else(String::new, |node| format!("{}: ", node.words))
}

/// What was held out, and what became of it.
fn proof(found: &GroupDiagnosis) -> String {
    let Some(gain) = &found.gain else {
        return String::new();
    };
    let (better, all) = gain.proof.better_parts();
    let what = gain.parts_word(found.runs.len());
    let errors = [
        (
            "current",
            gain.proof.nrmse_current_before,
            gain.proof.nrmse_current_after,
        ),
        (
            "curvature",
            gain.proof.nrmse_curvature_before,
            gain.proof.nrmse_curvature_after,
        ),
    ];
    let falls = errors.into_iter().filter_map(|(channel, before, after)| {
        let (before, after) = (100.0 * before?, 100.0 * after?);
        (after < before).then(|| {
            format!(
                "{channel} {} -> {} %",
                significant(before, 2),
                significant(after, 2)
            )
        })
    });
    let falls: Vec<String> = falls.collect();
    let error = if falls.is_empty() {
        String::new()
    } else {
        format!("; error of the {} of the range", falls.join(", "))
    };
    match (gain.proof.is_clear(), better == all) {
        (false, _) => format!(
            " That it predicts held-out {what} better is not clear: {better} of {all} come out better{error}."
        ),
        (true, true) => format!(" It predicts all {all} held-out {what} better{error}."),
        (true, false) => format!(" It predicts {better} of {all} held-out {what} better{error}."),
    }
}

/// What is left of a misfit that is explained may still be more than chance leaves.
fn doubt(found: &GroupDiagnosis) -> String {
    let open = found.p_leftover.filter(|p| (WRONG_BELOW..RIGHT_FROM).contains(p));
    open.map_or_else(String::new, |p| {
        format!(
            " What it leaves may be more than chance does ({}).",
            equation("p", p)
        )
    })
}

/// Whether what has no name predicts held-out readings better.
fn is_beaten(found: &GroupDiagnosis) -> bool {
    found
        .gain
        .as_ref()
        .is_some_and(|gain| gain.nameless_deviance > gain.proof.deviance + NAMELESS_BEATS_BY)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::testing::{finding, gain, held_out};

    fn said(verdict: Verdict, parts: &[f64]) -> String {
        let mut proof = held_out(parts.iter().sum(), 1e9);
        proof.parts = parts.iter().map(|fall| ("run".to_owned(), *fall)).collect();
        (proof.nrmse_current_before, proof.nrmse_current_after) = (Some(0.39), Some(0.018));
        let found = GroupDiagnosis {
            verdict,
            set: vec!["warburg".into(), "slow-branch".into()],
            gain: Some(gain(proof)),
            ..finding()
        };
        cause(&found, "after steps")
    }

    #[test]
    fn a_gain_is_told_by_its_parts_and_the_error_that_falls() {
        for verdict in [Verdict::Named, Verdict::Set, Verdict::Partial] {
            let unclear = said(verdict, &[40.0, 20.0, -1.0]);
            assert!(
                unclear.contains("is not clear: 2 of 3 come out better"),
                "{unclear}"
            );
            let claims = ["most of it", "misses"];
            assert!(claims.iter().all(|claim| !unclear.contains(claim)), "{unclear}");
            let clear = said(verdict, &[40.0, 20.0, 1.0]);
            let told = "predicts all 3 held-out runs better; error of the current 39 -> 1.8 % of the range";
            assert!(clear.contains(told), "{clear}");
        }
    }

    #[test]
    fn causes_that_are_open_are_told_with_what_they_have_in_common() {
        let clear = said(Verdict::Set, &[40.0, 20.0]);
        assert!(
            clear.contains("warburg or slow-branch fits, and these runs do not tell which"),
            "{clear}"
        );
    }
}
