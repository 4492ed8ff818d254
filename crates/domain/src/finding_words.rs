//! What a finding says: each sentence is made here, from the values that decide it. Overview, pages, tables, terminal and
//! documents quote it.

mod gain;
mod varying;

pub use gain::{StatedError, errors, gain_words, is_beaten};
pub use varying::{listed, printed, short};

use crate::diagnosis::{LARGEST_SET, RIGHT_FROM, SURE, WRONG_BELOW, follows_a_tag};
use crate::number::probabilities::{counted, equation_of, share};
use crate::number::significant;
use crate::words::in_a_row;
use crate::{GroupDiagnosis, Hypothesis, HypothesisKind, MisfitPercent, ParameterScatter, Verdict};

/// What is known of an effect by its id, in a line.
pub type About<'a> = dyn Fn(&str) -> Option<&'a str> + 'a;

/// Explanations at most that are told where none is proved. Chosen.
const MOST_EXPLANATIONS: usize = 4;
/// Least probability of an explanation that is told where none is proved. Chosen.
const LEAST_EXPLANATION: f64 = 0.01;
/// Parameters whose scatter from run to run is told at most. Chosen.
const MOST_SCATTERED: usize = 3;
/// Depth of a node of the tree of causes that is one effect.
const EFFECT: usize = 3;

/// The verdict in words of plain language.
pub fn verdict_word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Consistent => "right to within the noise",
        Verdict::Undecided => "undecided",
        Verdict::Named => "wrong, cause found",
        Verdict::Set => "wrong, several possible causes",
        Verdict::Partial => "wrong, cause found in part",
        Verdict::Unproved => "wrong, what fits is not proved",
        Verdict::Unknown => "wrong, cause unknown",
        Verdict::Varies => "the runs differ in their parameters",
        Verdict::Resembles => "wrong, like a known cause and not it",
        Verdict::DataProblem => "readings not usable",
    }
}

/// Says it of a finding; where the question could not be asked, who could not ask it has said why.
pub fn say(found: &mut GroupDiagnosis, about: &About) {
    if let Some(sentence) = sentence(found, about) {
        found.sentence = sentence;
    }
}

fn sentence(found: &GroupDiagnosis, about: &About) -> Option<String> {
    let place = found.whereabouts.as_ref().map_or("", |place| &place.text);
    let p = found.p_misfit;
    let chance = equation_of("p", &counted(p, found.draws));
    let wrong = match place {
        "" => "The simulation is wrong".to_owned(),
        place => format!("The simulation is wrong ({place})"),
    };
    let causes = causes(found, about);
    let visible = visible(found.visible_percent);
    let evidence = || format!("{}{}", proof(found, "it"), doubt(found));
    Some(match (found.verdict, p) {
        (Verdict::DataProblem, _) | (Verdict::Consistent | Verdict::Undecided, None) => return None,
        (Verdict::Consistent, _) => format!(
            "The simulation is right to within the noise{} ({chance}){}.",
            beside_scatter(found),
            visible.map_or_else(String::new, |error| format!(": {error} would have been seen"))
        ),
        (Verdict::Undecided, Some(p)) if p < WRONG_BELOW => format!(
            "The simulation may be wrong ({chance}), but of all findings of this campaign such a one is expected by chance too often to claim it; measure again."
        ),
        (Verdict::Undecided, Some(p)) if p >= RIGHT_FROM => format!(
            "Nothing speaks against the simulation ({chance}), and little could{}.",
            visible.map_or_else(String::new, |error| format!(
                ": only {error} would have been seen"
            ))
        ),
        (Verdict::Undecided, _) => format!(
            "The simulation may be wrong ({chance}): too much for chance to be sure, too little to name a cause{}.",
            after("; ", place)
        ),
        (Verdict::Named, _) => {
            format!(
                "The simulation misses {causes}{}.{}",
                after(": ", place),
                evidence()
            )
        }
        (Verdict::Set | Verdict::Partial, _) => format!("{wrong}; {causes}.{}", evidence()),
        (Verdict::Unproved, _) => format!("{wrong}, and no cause is proved; {causes}.{}", evidence()),
        (Verdict::Unknown, _) => format!(
            "{wrong}, and no known cause is proved.{}{}",
            likeliest(found),
            proof(found, "what was tried")
        ),
        (Verdict::Varies, _) => varying::sentence(found),
        (Verdict::Resembles, _) => format!("{wrong}, by something that looks like {causes} and is not it."),
    })
}

/// The causes that a finding gives, as a clause; empty where it gives none.
pub fn causes(found: &GroupDiagnosis, about: &About) -> String {
    let named = || {
        let words = found.set.iter().map(|id| with_summary(found, id, about));
        in_a_row(&words.collect::<Vec<_>>())
    };
    match found.verdict {
        Verdict::Named | Verdict::Resembles => named(),
        Verdict::Set => format!("{}{}", kind(found), open(found, about)),
        Verdict::Partial => format!(
            "{}an extension with {} explains most of it, and {}",
            kind(found),
            named(),
            match found.p_leftover {
                Some(_) => "a misfit without a name is left",
                None => "whether a misfit of another kind is left could not be asked",
            }
        ),
        Verdict::Unproved => format!(
            "{}{}{}",
            kind(found),
            open(found, about),
            match found.p_leftover {
                Some(p) if p < WRONG_BELOW => ", and a misfit without a name is left",
                _ => "",
            }
        ),
        _ => String::new(),
    }
}

/// An explanation in a few words.
pub fn explanation(own: &Hypothesis) -> String {
    let what = match own.kind {
        HypothesisKind::Effect => own.effects.join(" with "),
        HypothesisKind::Varies => "parameters that differ".to_owned(),
        HypothesisKind::SlowNoise => "slow noise".to_owned(),
        HypothesisKind::Unnamed => "something without a name".to_owned(),
        HypothesisKind::Base => "chance".to_owned(),
    };
    match own.kind {
        HypothesisKind::Effect if own.with_unnamed => format!("{what} with something without a name"),
        _ => what,
    }
}

/// The leading explanations with their probabilities, where none is proved.
fn likeliest(found: &GroupDiagnosis) -> String {
    let words = |own: &Hypothesis| format!("{} ({} %)", explanation(own), share(own.mass));
    let told = found.posterior.iter().filter(|own| own.mass >= LEAST_EXPLANATION);
    let leading: Vec<String> = told.take(MOST_EXPLANATIONS).map(words).collect();
    match leading.as_slice() {
        [] => String::new(),
        leading => format!(" It may be {}.", either(leading)),
    }
}

/// The words about an effect; where it follows a tag with the parameter that does, which the tag does not say.
fn with_summary(found: &GroupDiagnosis, id: &str, about: &About) -> String {
    // What else is to be said of it stands on its page.
    let first_clause = |summary: &str| summary.split(';').next().unwrap_or(summary).trim().to_owned();
    let words = about(id).map_or_else(
        || id.to_owned(),
        |summary| format!("{id} ({})", first_clause(summary)),
    );
    let mut own = found
        .effects
        .iter()
        .filter(|own| own.effect == id && follows_a_tag(id));
    match own.next().and_then(|own| own.variant.as_deref()) {
        Some(parameter) => format!("{words} in {parameter}"),
        None => words,
    }
}

/// What is known of a cause of several: what is so, and which of them it may be.
fn open(found: &GroupDiagnosis, about: &About) -> String {
    let probability = |id: &String| -> f64 {
        let holding = found.posterior.iter().filter(|own| own.effects.contains(id));
        holding.map(|own| own.mass).sum()
    };
    if let [only] = found.set.as_slice() {
        return format!("{} fits", with_summary(found, only, about));
    }
    let (certain, rest): (Vec<&String>, Vec<&String>) =
        found.set.iter().partition(|id| probability(id) >= SURE);
    let certain = in_a_row(&certain);
    let fits = match rest.len() {
        0 => return format!("{certain} fit together"),
        many if many > LARGEST_SET => format!("{many} causes of this kind fit"),
        _ if certain.is_empty() => format!("{} fits", either(&rest)),
        _ => format!("{certain} with {} fits", either(&rest)),
    };
    format!("{fits}, and these runs do not tell which")
}

/// `a`, `a or b`, `a, b or c`.
fn either<T: AsRef<str>>(words: &[T]) -> String {
    match words {
        [first @ .., last] if !first.is_empty() => {
            let first: Vec<&str> = first.iter().map(AsRef::as_ref).collect();
            format!("{} or {}", first.join(", "), last.as_ref())
        }
        _ => in_a_row(words),
    }
}

/// What is so where no single effect is told.
fn kind(found: &GroupDiagnosis) -> String {
    let node = found.node.as_ref().filter(|node| node.depth < EFFECT);
    node.map_or_else(String::new, |node| format!("{}: ", node.words))
}

/// What became of what was held out, with a blank before it; nothing of nothing.
pub fn proof(found: &GroupDiagnosis, with: &str) -> String {
    found.gain.as_ref().map_or_else(String::new, |gain| {
        let what = format!("held-out {}", gain.parts_word(found.runs.len()));
        format!(" {}", gain_words(with, &what, &gain.proof, &gain.predictions)) + is_beaten(gain)
    })
}

/// What is left of a misfit that is explained may still be more than chance leaves.
fn doubt(found: &GroupDiagnosis) -> String {
    let open = found.p_leftover.filter(|p| (WRONG_BELOW..RIGHT_FROM).contains(p));
    open.map_or_else(String::new, |p| {
        format!(
            " What it leaves may be more than chance does ({}).",
            equation_of("p", &counted(Some(p), found.draws))
        )
    })
}

/// The error of the simulation that would have been seen.
fn visible(percent: MisfitPercent) -> Option<String> {
    let of = |percent: Option<f64>, what: &str| {
        Some(format!(
            "{} % of the range of the {what}",
            significant(percent?, 2)
        ))
    };
    let each = [of(percent.current, "current"), of(percent.curvature, "curvature")];
    let sizes: Vec<String> = each.into_iter().flatten().collect();
    (!sizes.is_empty()).then(|| format!("an error of {}", sizes.join(" or ")))
}

/// What stands beside "to within the noise" where scatter is taken as noise.
fn beside_scatter(found: &GroupDiagnosis) -> String {
    if !found.scatter_is_noise {
        return String::new();
    }
    let of = |own: &&ParameterScatter| format!("{} {} %", printed(&own.key).0, short_percent(own.percent));
    let parts: Vec<String> = most_scattered(&found.scatter).iter().map(of).collect();
    format!(
        " and to the scatter from run to run{}",
        match parts.as_slice() {
            [] => String::new(),
            parts => format!(" ({})", parts.join(", ")),
        }
    )
}

/// The parameters that scatter, the most certain first.
pub fn most_scattered(scatter: &[ParameterScatter]) -> Vec<&ParameterScatter> {
    let mut found: Vec<&ParameterScatter> = scatter.iter().filter(|own| own.percent > 0.0).collect();
    found.sort_by(|a, b| {
        let by_low = b.low_95_percent.total_cmp(&a.low_95_percent);
        by_low.then(b.percent.total_cmp(&a.percent))
    });
    found.truncate(MOST_SCATTERED);
    found
}

/// Three digits that count, below a hundredth of a percent none.
pub fn short_percent(percent: f64) -> String {
    match percent {
        0.01.. => short((percent * 100.0).round() / 100.0),
        _ => "0".to_owned(),
    }
}

/// The words with what joins them to those before; nothing of none.
fn after(joint: &str, words: &str) -> String {
    match words {
        "" => String::new(),
        words => format!("{joint}{words}"),
    }
}
