//! Answers in words: the answer first, its interval, what it rests on, what else may be the cause.

use ieap_domain::number::estimates::ends;
use ieap_domain::number::probabilities::equation;
use ieap_domain::number::{rounded_bound, significant};
use ieap_domain::words::{counted, in_a_row};

use super::answer::{Answer, Basis, Kind, Scale, Verdict};
use super::made::Study;
use super::measures::{BENDING_LOST, BENDING_PER_VOLT};
use super::policy::MOST_NAMED;
use crate::conditions::volts_number;
use crate::false_discovery::CLAIMED_BELOW;
use crate::laws::words::symbol as of_parameter;

/// Symbol of what is asked about.
pub fn symbol(key: &str) -> &str {
    match key {
        BENDING_PER_VOLT => "α C",
        BENDING_LOST => "bending lost in an hour",
        key => of_parameter(key),
    }
}

/// `1.2, 2.0, 2.5`.
pub fn voltages(of: &[f64]) -> String {
    let each: Vec<String> = of.iter().map(|&volts| volts_number(volts)).collect();
    each.join(", ")
}

/// A number of an answer in words: `× 2.21 [2.01, 2.44]`, `+43 points [19, 67]`, `> 81`.
pub fn number(answer: &Answer) -> String {
    let interval = answer
        .low_95
        .zip(answer.high_95)
        .or(answer.fits_low_95.zip(answer.fits_high_95));
    let is_law = answer.kind.is_law();
    let bracket = interval.map_or(String::new(), |(low, high)| format!(" [{}]", brackets(low, high)));
    match (answer.value, answer.at_least, answer.at_most, answer.scale) {
        (Some(value), _, _, Scale::Points) => {
            let per = if is_law {
                format!(" per {}", unit(answer))
            } else {
                String::new()
            };
            let sign = if value > 0.0 { "+" } else { "" };
            format!("{sign}{} points{per}{bracket}", significant(value, 2))
        }
        (Some(value), _, _, Scale::PerUnit) => {
            // A relative change per unit, in percent.
            let percent = |number: f64| significant(100.0 * number.exp_m1(), 2);
            let ends = interval.map_or(String::new(), |(low, high)| {
                format!(" [{}, {}]", percent(low), percent(high))
            });
            let sign = if value > 0.0 { "+" } else { "" };
            format!("{sign}{} %{ends} per {}", percent(value), unit(answer))
        }
        (Some(value), ..) => format!("× {}{bracket}", significant(value, 3)),
        (None, Some(least), None, _) => format!("× > {}", rounded_bound(least, false).value_text()),
        (None, None, Some(most), _) => format!("× < {}", rounded_bound(most, true).value_text()),
        (None, Some(least), Some(most), _) => format!("× {}", ends(least, most)),
        _ => "not told".to_owned(),
    }
}

fn brackets(low: f64, high: f64) -> String {
    format!("{}, {}", significant(low, 3), significant(high, 3))
}

/// A ratio with its interval by the errors of the fits alone: `3.48 [3.43, 3.53]`.
pub fn by_fits(answer: &Answer) -> String {
    match (answer.value, answer.fits_low_95.zip(answer.fits_high_95)) {
        (Some(value), Some((low, high))) => format!("{} [{}]", significant(value, 3), brackets(low, high)),
        _ => number(answer).replace("× ", ""),
    }
}

/// Unit of what a law follows.
pub fn unit(answer: &Answer) -> &'static str {
    match answer.kind {
        Kind::HumidityLaw => "% RH",
        _ => "V",
    }
}

/// An answer as a sentence.
pub fn sentence(answer: &Answer) -> String {
    let mut text = format!("{}: {}", about(answer), shows(answer));
    if !answer.also_changed.is_empty() && answer.verdict != Verdict::Alike {
        text += &format!(
            "; in this design {} changed with it",
            in_a_row(&answer.also_changed)
        );
    }
    text + "."
}

/// What is compared: `Rₛₛ of CNaf, air over dry (vacuum, inert), at 1.2, 2.0 and 2.5 V`.
pub fn about(answer: &Answer) -> String {
    let symbol = symbol(answer.parameter);
    let at = voltages(&answer.voltages_v);
    let at = if at.is_empty() { at } else { format!(", at {at} V") };
    let of = match &answer.against_material {
        Some(other) if answer.kind == Kind::ByMaterial => format!("{} against {other}", answer.material),
        _ => answer.material.clone(),
    };
    match answer.kind {
        Kind::HumidityLaw | Kind::VoltageLaw => format!("{symbol} of {of} with the {}{at}", answer.upper),
        Kind::Material => format!("{symbol}, {} over {}{at}", answer.upper, answer.lower),
        Kind::Voltage => format!("{symbol} of {of}, {} over {}", answer.upper, answer.lower),
        Kind::ByVoltage => format!("{symbol} of {of}, ({}) over ({})", answer.upper, answer.lower),
        Kind::Environment | Kind::ByMaterial => {
            format!("{symbol} of {of}, {} over {}{at}", answer.upper, answer.lower)
        }
    }
}

/// What an answer shows: the number, then what may be said.
pub fn shows(answer: &Answer) -> String {
    if let Some(reason) = &answer.reason {
        return reason.clone();
    }
    let number = number(answer);
    let most = answer
        .no_more_than
        .map(|most| rounded_bound(most, true).value_text());
    let unit = if answer.scale == Scale::Points {
        "points"
    } else {
        "%"
    };
    match (answer.verdict, most) {
        (Verdict::Differs, _) => number,
        (Verdict::Alike, Some(most)) => format!("no effect larger than {most} {unit} (95 %): {number}"),
        (Verdict::Open, Some(_)) if answer.p.is_some_and(|p| p <= CLAIMED_BELOW) => format!(
            "{number}; of as many questions as were asked, one such answer is expected by chance ({})",
            equation("q", answer.q)
        ),
        (Verdict::Open, Some(most)) => {
            format!("{number}; no difference is shown, and up to {most} {unit} is not excluded")
        }
        (Verdict::Bound, _) => number,
        _ if answer.value.is_some() => {
            format!("{number} by the fits alone: nothing tells the scatter from run to run")
        }
        _ => number,
    }
}

/// The answers for a material, a line for each pair that the study asked: what differs, then what does not.
pub fn lead(study: &Study, material: &str) -> Vec<String> {
    let own: Vec<&Answer> = (study.asked())
        .filter(|answer| answer.material == material && answer.kind != Kind::ByMaterial)
        .collect();
    let mut parts: Vec<(String, Vec<&Answer>)> = Vec::new();
    for answer in &own {
        let pair = pair(answer);
        match parts.iter_mut().find(|(known, _)| *known == pair) {
            Some((_, of)) => of.push(answer),
            None => parts.push((pair, vec![answer])),
        }
    }
    let strip = if is_of_one_sample(&own) {
        " (one strip)"
    } else {
        ""
    };
    parts
        .iter()
        .map(|(pair, of)| format!("{material}{strip}, {pair}: {}.", told(of)))
        .collect()
}

fn is_of_one_sample(answers: &[&Answer]) -> bool {
    answers.iter().map(|own| own.samples).max() == Some(1)
}

/// `air against dry (vacuum, inert)`, `with the relative humidity`.
fn pair(answer: &Answer) -> String {
    match answer.kind {
        Kind::HumidityLaw | Kind::VoltageLaw => format!("with the {}", answer.upper),
        _ => format!("{} against {}", answer.upper, answer.lower),
    }
}

/// What a pair does to the parameters: those that differ with their numbers, strongest first; those that do by themselves, but
/// of as many questions one such answer is expected by chance; those that do not, with the largest effect that could hide;
/// those that are open.
fn told(of: &[&Answer]) -> String {
    let with = |verdict: Verdict| of.iter().copied().filter(move |own| own.verdict == verdict);
    let numbers = |mut of: Vec<&Answer>| {
        of.sort_by(|a, b| a.p.unwrap_or(1.0).total_cmp(&b.p.unwrap_or(1.0)));
        let each = of
            .iter()
            .map(|own| format!("{} {}", symbol(own.parameter), number(own)));
        in_a_row(&each.collect::<Vec<_>>())
    };
    let names = |of: &[&Answer]| in_a_row(&of.iter().map(|own| symbol(own.parameter)).collect::<Vec<_>>());
    let (alone, open): (Vec<&Answer>, Vec<&Answer>) =
        with(Verdict::Open).partition(|own| own.p.is_some_and(|p| p <= CLAIMED_BELOW));
    let differ: Vec<&Answer> = with(Verdict::Differs).collect();
    let alike: Vec<&Answer> = with(Verdict::Alike).collect();
    let mut parts = Vec::new();
    if !differ.is_empty() {
        parts.push(numbers(differ));
    }
    if !alone.is_empty() {
        parts.push(format!("less sure (q above {CLAIMED_BELOW}) {}", numbers(alone)));
    }
    let most = |is_of: fn(&&&Answer) -> bool| {
        alike
            .iter()
            .filter(is_of)
            .filter_map(|own| own.no_more_than)
            .reduce(f64::max)
    };
    let both = [
        (most(|own| own.scale != Scale::Points), "%"),
        (most(|own| own.scale == Scale::Points), "points"),
    ];
    for (most, unit) in both {
        if let Some(most) = most {
            let of: Vec<&Answer> = alike
                .iter()
                .copied()
                .filter(|own| (own.scale == Scale::Points) == (unit == "points"))
                .collect();
            parts.push(format!(
                "no effect larger than {} {unit} on {}",
                rounded_bound(most, true).value_text(),
                names(&of)
            ));
        }
    }
    let open: Vec<&Answer> = open.into_iter().chain(with(Verdict::Bound)).collect();
    if !open.is_empty() {
        parts.push(format!("open: {}", names(&open)));
    }
    if parts.is_empty() {
        return "nothing was determined".to_owned();
    }
    parts.join("; ")
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
        Basis::Repeats if samples > 1 => "Intervals hold the scatter from run to run, between samples, and of samples in environments (a mixed model, REML, errors of Kenward and Roger).".to_owned(),
        Basis::Repeats => "Intervals hold the scatter from run to run. Of one strip nothing is said of another.".to_owned(),
        Basis::Stated => "One run a condition: intervals are by the scatter that campaign.toml states.".to_owned(),
        Basis::DryPair => "One run a condition: nothing tells the scatter from run to run by itself. Intervals are by the scatter of the dry environments about their mean at each voltage; what would undo a difference stands beside it.".to_owned(),
        Basis::Additive => "One run a condition: intervals are by what environment and voltage leave where both act alike, which holds real differences too and is rather too large.".to_owned(),
        Basis::Unknown => "Where nothing tells the scatter from run to run, intervals are those of the fits alone, and no difference is claimed.".to_owned(),
    }
    };
    found.iter().map(of).collect()
}

/// Which fitted runs take part in no answer; none where all do.
pub fn left_out(study: &Study) -> Option<String> {
    let some = &study.left_out[..study.left_out.len().min(MOST_NAMED)];
    let more = study.left_out.len() - some.len();
    let more = if more > 0 {
        format!(" and {more} more")
    } else {
        String::new()
    };
    (!some.is_empty()).then(|| {
        format!(
            "{} part in no answer ({}{more}): nothing stands against them in another condition, a tag is missing, their voltage moves, or what their model gets wrong has no known cause.",
            match study.left_out.len() {
                1 => "1 fitted run takes".to_owned(),
                several => format!("{several} fitted runs take"),
            },
            some.join(", ")
        )
    })
}

/// How many questions were asked, and how their chances were judged.
pub fn family(study: &Study) -> String {
    let asked = study.asked().filter(|own| own.p.is_some()).count();
    let details = study
        .answers
        .iter()
        .filter(|own| !own.is_of_study && own.p.is_some())
        .count();
    format!(
        "{} of the study and {} were judged, each family by itself: of what is claimed at most 1 in 20 is expected to be chance (Benjamini and Hochberg).",
        counted(asked, "question"),
        counted(details, "detail"),
    )
}
