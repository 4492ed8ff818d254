//! What a finding says: each sentence is made here, from the values that decide it. Overview, pages, tables, terminal and
//! documents quote it.

mod gain;
mod varying;

pub use gain::{StatedError, errors, gain_in_short, gain_words};
pub use varying::{listed, short, symbol, told_first};

use crate::diagnosis::{RIGHT_FROM, WRONG_BELOW, follows_a_tag};
use crate::number::probabilities::{counted, equation_of, share};
use crate::number::significant;
use crate::words::in_a_row;
use crate::{
    Account, GroupDiagnosis, Hypothesis, HypothesisKind, MisfitPercent, MissingLaw, ParameterScatter, Verdict,
};

/// What is known of an effect by its id, in a line.
pub type About<'a> = dyn Fn(&str) -> Option<&'a str> + 'a;

/// Explanations at most that are told where none is sure. Chosen.
const MOST_EXPLANATIONS: usize = 4;
/// No law is exact: what it leaves of the error within this part is not worth a number, and what a rival explains less within
/// this part of what the best explains does not rule it out. Chosen.
pub const INEXACT: f64 = 0.02;
/// Parameters that differ which are told by name at most. Chosen.
const MOST_DIFFERING: usize = 3;
/// Least probability of an explanation that is told where none is sure. Chosen.
const LEAST_EXPLANATION: f64 = 0.01;
/// Parameters whose scatter from run to run is told at most. Chosen.
const MOST_SCATTERED: usize = 3;

/// The verdict in words of plain language.
pub fn verdict_word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Right => "right",
        Verdict::Undecided => "undecided",
        Verdict::Law => "wrong, a law is missing",
        Verdict::Differs => "the runs differ in their parameters",
        Verdict::Instrument => "slow noise of the instrument",
        Verdict::Unexplained => "wrong, not explained",
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
    let visible = visible(found.visible_percent);
    Some(match (found.verdict, p) {
        (Verdict::DataProblem, _) | (Verdict::Right | Verdict::Undecided, None) => return None,
        (Verdict::Right, Some(p)) if p < WRONG_BELOW => right_to(found, about),
        (Verdict::Right, _) => format!(
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
        (Verdict::Law, _) => format!(
            "The simulation misses {}.{}{}",
            causes(found, about),
            taken(found),
            proof(found, "it")
        ),
        (Verdict::Instrument, _) => format!(
            "Slow noise of the instrument, at rest as under voltage, is what the simulation leaves ({chance}){}.",
            visible.map_or_else(String::new, |error| format!(
                ": beside it {error} of the simulation would have been seen"
            ))
        ),
        (Verdict::Unexplained, _) => format!(
            "The simulation is wrong{}{}, and what it misses cannot be told.{}{}",
            after(" by ", &size(found.misfit_percent)),
            match place {
                "" => String::new(),
                place => format!(" ({place})"),
            },
            likeliest(found, about),
            proof(found, "what was tried")
        ),
        (Verdict::Differs, _) => varying::sentence(found),
    })
}

/// What the laws take of the error, where they leave some of it.
fn taken(found: &GroupDiagnosis) -> String {
    let part = found.account.map(|own| own.share(own.within_runs));
    let part = part.filter(|part| *part < 100.0 * (1.0 - INEXACT));
    part.map_or_else(String::new, |part| {
        format!(" That is {} % of the error.", significant(part, 2))
    })
}

/// Right, by its size and not by chance.
fn right_to(found: &GroupDiagnosis, about: &About) -> String {
    let left = match causes(found, about).as_str() {
        "" => String::new(),
        causes => format!(" What it misses is {causes}."),
    };
    format!(
        "The simulation is right to {}: less than the {} % that this campaign tolerates.{left}",
        size(found.misfit_percent),
        significant(found.tolerance_percent, 2)
    )
}

/// How large a misfit is.
fn size(misfit: MisfitPercent) -> String {
    let of = |percent: Option<f64>, what: &str| Some(format!("{} % of the {what}", significant(percent?, 2)));
    let each = [
        of(misfit.current, "range of the current"),
        of(misfit.curvature, "range of the curvature"),
        of(misfit.charge, "charge"),
    ];
    in_a_row(&each.into_iter().flatten().collect::<Vec<_>>())
}

/// The laws that are missing: "faradaic-leak (electrolysis current above an onset voltage)"; empty of none. What is no more than a
/// place comes last.
pub fn causes(found: &GroupDiagnosis, about: &About) -> String {
    let (laws, places): (Vec<&MissingLaw>, Vec<&MissingLaw>) =
        found.missing.iter().partition(|law| law.law.is_some());
    let each = laws.into_iter().chain(places).map(|law| cause(law, about));
    in_a_row(&each.collect::<Vec<_>>())
}

/// A law in words: by its name; else by what it is, and which of the known curves lie within its band.
fn cause(law: &MissingLaw, about: &About) -> String {
    if let Some(name) = &law.name {
        return with_summary(name, about);
    }
    if law.law.is_none() {
        return format!(
            "something in the {}, and these runs do not tell which law",
            law.place
        );
    }
    let by = match law.names.as_slice() {
        [] => " (no known curve)".to_owned(),
        [only] => format!(", about as {only} has it"),
        many => format!(", as {} has it: these runs do not tell which", either(many)),
    };
    format!("that {}{by}", law.words)
}

/// What a missing law is called in few words: its name, else what it is and follows, else its place.
pub fn short_name(law: &MissingLaw) -> String {
    match (&law.name, &law.law, &law.variable) {
        (Some(name), ..) => name.clone(),
        (_, Some(law), Some(variable)) => format!("{law} by {}", variable_words(variable)),
        _ => format!("something in the {}", law.place),
    }
}

/// What a law follows, in words, by its key.
pub fn variable_words(variable: &str) -> &str {
    match variable {
        "time_s" => "time",
        "time_since_edge_s" => "the time since the last change of the voltage",
        "voltage_v" => "the voltage",
        "largest_voltage_v" => "the largest voltage so far",
        "edges" => "the number of changes of the voltage so far",
        "charge_c_per_cm2" => "the charge",
        "curvature_per_cm" => "the curvature",
        "current_a_per_cm2" => "the current",
        "heat" => "the heat put in of late",
        "flow" => "the charge that flowed of late",
        "history" => "what went before",
        "relative_humidity_percent" => "the relative humidity",
        "temperature_c" => "the temperature",
        "pressure_pa" => "the pressure",
        "oxygen_ppm" => "the oxygen in the gas",
        "water_ppm" => "the water in the gas",
        other => other,
    }
}

/// An explanation in a few words.
pub fn explanation(own: &Hypothesis, about: &About) -> String {
    match own.kind {
        HypothesisKind::Effect => own.effect.clone().unwrap_or_default(),
        HypothesisKind::Law => {
            let id = own.effect.as_deref().unwrap_or_default();
            format!("that {}", about(id).unwrap_or(id))
        }
        HypothesisKind::Varies => differing(own),
        HypothesisKind::SlowNoise => "slow noise".to_owned(),
        HypothesisKind::Unnamed => {
            let place = own.with.as_deref().unwrap_or("readings");
            format!("something in the {place} that is none of the laws asked")
        }
        HypothesisKind::Base => "chance".to_owned(),
    }
}

/// Which parameters differ, and with what.
fn differing(own: &Hypothesis) -> String {
    let names: Vec<String> = own.parameters_that_differ.iter().map(|key| symbol(key)).collect();
    let which = match names.len() {
        0 => "parameters".to_owned(),
        1..=MOST_DIFFERING => in_a_row(&names),
        many => format!("{many} parameters"),
    };
    let verb = if names.len() == 1 { "differs" } else { "differ" };
    let with = match own.with.as_deref() {
        Some("voltage_v") => " with the voltage".to_owned(),
        with => with
            .and_then(followed_tag)
            .map_or_else(String::new, |tag| format!(" with {tag}")),
    };
    format!("that {which} {verb}{with}")
}

/// The leading explanations with their probabilities, where none is sure.
fn likeliest(found: &GroupDiagnosis, about: &About) -> String {
    let words = |own: &Hypothesis| format!("{} ({} %)", explanation(own, about), share(own.mass));
    let told = found.posterior.iter().filter(|own| own.mass >= LEAST_EXPLANATION);
    let leading: Vec<String> = told.take(MOST_EXPLANATIONS).map(words).collect();
    match leading.as_slice() {
        [] => String::new(),
        leading => format!(" It may be {}.", either(leading)),
    }
}

/// The words about an effect.
fn with_summary(id: &str, about: &About) -> String {
    // What else is to be said of it stands on its page.
    let first_clause = |summary: &str| summary.split(';').next().unwrap_or(summary).trim().to_owned();
    about(id).map_or_else(
        || id.to_owned(),
        |summary| format!("{id} ({})", first_clause(summary)),
    )
}

/// Whether what a parameter follows is a tag, and its id.
pub fn followed_tag(with: &str) -> Option<&str> {
    follows_a_tag(with).then(|| with.trim_start_matches(crate::diagnosis::FOLLOWS))
}

/// The account in one line, of what is beyond noise: "missing law 92 %, not explained 8 %".
pub fn account_words(account: &Account) -> String {
    let told = account
        .parts()
        .into_iter()
        .skip(1)
        .filter(|(_, part)| account.share(*part) >= 1.0);
    let each: Vec<String> = told
        .map(|(name, part)| format!("{name} {} %", significant(account.share(part), 2)))
        .collect();
    each.join(", ")
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

/// What became of what was held out, with a blank before it; nothing of nothing.
pub fn proof(found: &GroupDiagnosis, with: &str) -> String {
    found.gain.as_ref().map_or_else(String::new, |gain| {
        let what = gain.held_out_words(found.runs.len());
        // Of runs that differ what is predicted stands in the table below.
        let predictions = match found.verdict {
            Verdict::Differs => &[],
            _ => gain.predictions.as_slice(),
        };
        format!(" {}", gain_words(with, &what, &gain.proof, predictions))
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
    let of = |own: &&ParameterScatter| format!("{} {} %", symbol(&own.key), short_percent(own.percent));
    let parts: Vec<String> = most_scattered(&found.scatter).iter().map(of).collect();
    format!(
        " and to what repeats differ by{}",
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
