//! An answer in a sentence of its own: what is asked, what it shows, what it rests on, what else may be the cause.

use ieap_domain::ParameterInfo;
use ieap_domain::number::estimates::ends;
use ieap_domain::number::{rounded_bound, significant};
use ieap_domain::words::{capital, counted, in_a_row};

use super::answer::{Answer, Basis, Kind, Verdict};
use super::grammar::{from_to, shows};
use super::made::Study;
use super::measures::{BENDING_CURVE, BENDING_LOST, BENDING_PER_VOLT, CURRENT_CURVE};
use super::policy::MOST_NAMED;
use crate::conditions::volts_number;
use crate::laws::words::symbol as of_parameter;

/// Name of what is asked about, as it is said before its symbol; empty where that is words itself.
pub(super) fn name(key: &str) -> &'static str {
    match key {
        BENDING_PER_VOLT => "bending per volt",
        // Short for what it couples, which its symbol says.
        "alpha_per_c_cm" => "coupling",
        key => ParameterInfo::of(key).map_or("", |info| info.name),
    }
}

/// Symbol of what is asked about.
pub fn symbol(key: &str) -> &str {
    match key {
        BENDING_PER_VOLT => "α C",
        BENDING_LOST => "bending lost in an hour",
        CURRENT_CURVE => "curve of current",
        BENDING_CURVE => "curve of bending",
        key => of_parameter(key),
    }
}

/// `1.2, 2.0, 2.5`.
pub fn voltages(of: &[f64]) -> String {
    let each: Vec<String> = of.iter().map(|&volts| volts_number(volts)).collect();
    each.join(", ")
}

/// ` at 1.2, 2.0 and 2.5 V`; nothing of none.
pub(super) fn at_voltages(of: &[f64]) -> String {
    let each: Vec<String> = of.iter().map(|&volts| volts_number(volts)).collect();
    if each.is_empty() {
        String::new()
    } else {
        format!(" at {} V", in_a_row(&each))
    }
}

/// A ratio with its interval by the errors of the fits alone: `3.48 [3.43, 3.53]`; else a bound.
pub fn by_fits(answer: &Answer) -> String {
    let fits = answer.fits_low_95.zip(answer.fits_high_95);
    match (answer.value, fits, answer.at_least, answer.at_most) {
        (Some(value), Some((low, high)), ..) => {
            let [value, low, high] = [value, low, high].map(|own| significant(own, 3));
            format!("{value} [{low}, {high}]")
        }
        (_, _, Some(least), None) => format!("> {}", rounded_bound(least, false).value_text()),
        (_, _, None, Some(most)) => format!("< {}", rounded_bound(most, true).value_text()),
        (_, _, Some(least), Some(most)) => ends(least, most),
        _ => "–".to_owned(),
    }
}

/// An answer as a sentence, with what else may be the cause.
pub fn sentence(answer: &Answer) -> String {
    let text = told_alone(answer);
    if answer.also_changed.is_empty() || answer.verdict == Verdict::Alike {
        text + "."
    } else {
        format!(
            "{text}; in this design {} changed with it.",
            in_a_row(&answer.also_changed)
        )
    }
}

/// An answer as a sentence without its stop.
pub(super) fn told_alone(answer: &Answer) -> String {
    let about = about(answer);
    let about = if about.is_char_boundary(1) {
        capital(&about)
    } else {
        about
    };
    format!("{about} {}", shows(answer))
}

/// What is compared: `Rₛₛ of CNaf in air against dry (vacuum, inert) at 1.2, 2.0 and 2.5 V`.
pub fn about(answer: &Answer) -> String {
    let of = match (symbol(answer.parameter), &answer.against_material) {
        (symbol, Some(other)) if answer.kind.is_by_material() => {
            format!("the change of {symbol} of {} against {other}", answer.material)
        }
        (symbol, _) => format!("{symbol} of {}", answer.material),
    };
    let at = at_voltages(&answer.voltages_v);
    let (upper, lower) = (&answer.upper, &answer.lower);
    match answer.kind {
        Kind::OtherLaw if !lower.is_empty() => format!("{of} with {upper} against {lower}"),
        kind if kind.is_law() => {
            let at = if kind == Kind::HumidityLaw || kind == Kind::HumidityByMaterial {
                at
            } else {
                String::new()
            };
            format!("{of} with the {upper}{}{at}", from_to(answer))
        }
        Kind::Voltage => format!("{of} at {upper} against {lower}"),
        Kind::ByVoltage => format!("the change of {of} in {upper} against {lower}"),
        Kind::Material => format!("{of} against {lower}{at}"),
        _ => {
            let times = answer.times_s.map_or(String::new(), |(from, to)| {
                format!(
                    ", {} to {} s after the step,",
                    significant(from, 1),
                    significant(to, 1)
                )
            });
            format!("{of} in {upper} against {lower}{at}{times}")
        }
    }
}

/// What the intervals rest on, in sentences.
pub fn basis(answers: &[&Answer]) -> Vec<String> {
    let mut found: Vec<Basis> = answers
        .iter()
        .filter(|own| own.value.is_some())
        .map(|own| own.basis)
        .collect();
    found.sort_unstable();
    found.dedup();
    let samples = answers.iter().map(|own| own.samples).max().unwrap_or(0);
    let of = |basis: &Basis| {
        match basis {
        Basis::Repeats if samples > 1 => "Intervals hold the scatter from run to run, between samples, and of samples in environments (a mixed model, its scatters integrated).".to_owned(),
        Basis::Repeats => "Intervals hold the scatter from run to run. Of one strip nothing is said of another.".to_owned(),
        Basis::Stated => "One run a condition: intervals are by the scatter that campaign.toml states.".to_owned(),
        Basis::DryPair => "One run a condition: nothing tells the scatter from run to run by itself. Intervals are by the scatter of the dry environments about their mean at each voltage; what would undo a difference stands beside it.".to_owned(),
        Basis::Additive => "One run a condition: intervals are by what environment and voltage leave where both act alike, which holds real differences too and is rather too large.".to_owned(),
        Basis::Unknown => "Where nothing tells the scatter from run to run, intervals are those of the fits alone, and no difference is claimed.".to_owned(),
    }
    };
    let mut said: Vec<String> = found.iter().map(of).collect();
    if answers.iter().any(|own| own.of_material.is_some()) {
        said.push("What goes with humidity, voltage or another number is told of the strips measured, each with a level of its own; of the material it is shown where it stands beside what strips differ by (their slopes by chance).".to_owned());
    }
    if answers.iter().any(|own| own.of_strips.is_some()) {
        said.push("What surroundings do is told of the material; where that is open and the strips as they were measured show it, it is said of them: what a strip does in surroundings that it was put into once is not told from how it was put there.".to_owned());
    }
    if answers.iter().any(|own| own.is_of_curve() && own.value.is_some()) {
        said.push("Whole curves are compared at times spread evenly over the logarithm of the time since the step, in percent of the range of both together; what holds nowhere holds at each of these times (95 %), and what is told of one time holds at all of them.".to_owned());
    }
    said
}

/// Which fitted runs take part in no answer, or in none about whole curves.
pub fn left_out(study: &Study) -> Vec<String> {
    let of = |runs: &[String], of: &str, why: &str| {
        let some = &runs[..runs.len().min(MOST_NAMED)];
        let more = match runs.len() - some.len() {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        let all = match runs.len() {
            1 => "1 fitted run takes".to_owned(),
            several => format!("{several} fitted runs take"),
        };
        let row = some.join(", ");
        (!some.is_empty()).then(|| format!("{all} part in no answer{of} ({row}{more}): {why}."))
    };
    let mut reasons: Vec<&str> = study.left_out_why.clone();
    reasons.sort_unstable();
    reasons.dedup();
    let parameters = reasons.into_iter().filter_map(|why| {
        let each = study.left_out.iter().zip(&study.left_out_why);
        let runs: Vec<String> = each
            .filter(|(_, of)| **of == why)
            .map(|(run, _)| run.clone())
            .collect();
        of(&runs, "", why)
    });
    let curves = of(
        &study.left_out_of_curves,
        " about whole curves",
        "they do not begin with a step that is held, nothing tells when that was, or nothing stands against them in another environment",
    );
    parameters.chain(curves).collect()
}

/// How many questions were asked, and how their chances were judged.
pub fn family(study: &Study) -> String {
    let of = |is_of: fn(&&Answer) -> bool| {
        let judged = study.answers.iter().filter(|own| own.p.is_some());
        judged.filter(is_of).count()
    };
    let questions = of(|own| own.is_of_study && !own.is_of_curve() && own.kind != Kind::OtherLaw);
    let curves = of(|own| own.is_of_study && own.is_of_curve());
    let mut families = vec![format!("{} of the study", counted(questions, "question"))];
    families.extend((curves > 0).then(|| counted(curves, "whole curve")));
    let laws = of(|own| own.kind == Kind::OtherLaw);
    families.extend((laws > 0).then(|| counted(laws, "law of what else differed")));
    families.push(counted(
        of(|own| !own.is_of_study && own.kind != Kind::OtherLaw),
        "detail",
    ));
    format!(
        "{} were judged, each family by itself: of what is claimed at most 1 in 20 is expected to be chance (Benjamini and Hochberg).",
        in_a_row(&families)
    )
}
