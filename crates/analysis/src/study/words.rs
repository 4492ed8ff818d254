//! Answers in words: the answer first, its interval, what it rests on, what else may be the cause.

use ieap_domain::number::estimates::ends;
use ieap_domain::number::probabilities::equation;
use ieap_domain::number::{plain, rounded_bound, significant};
use ieap_domain::words::{counted, in_a_row};

use super::answer::{Answer, Basis, Kind, Scale, Verdict};
use super::made::Study;
use super::measures::{BENDING_CURVE, BENDING_LOST, BENDING_PER_VOLT, CURRENT_CURVE};
use super::policy::{MOST_NAMED, ONE_SLOPE};
use crate::conditions::volts_number;
use crate::false_discovery::CLAIMED_BELOW;
use crate::laws::words::symbol as of_parameter;

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

/// A number of an answer in words: `× 2.21 [2.01, 2.44]`, `+43 points [19, 67]`, `> 81`, `+12 % of its range at 50 s`.
pub fn number(answer: &Answer) -> String {
    let interval = answer
        .low_95
        .zip(answer.high_95)
        .or(answer.fits_low_95.zip(answer.fits_high_95));
    let bracket = interval.map_or(String::new(), |(low, high)| format!(" [{}]", brackets(low, high)));
    match (answer.value, answer.at_least, answer.at_most, answer.scale) {
        (Some(value), _, _, Scale::Points) => {
            let over = answer.span.unwrap_or(1.0);
            let ends = interval.map_or(String::new(), |(low, high)| {
                format!(" [{}]", brackets(over * low, over * high))
            });
            let sign = if value > 0.0 { "+" } else { "" };
            format!("{sign}{} points{ends}", significant(over * value, 2))
        }
        (Some(value), _, _, Scale::OfRange) => {
            let sign = if value > 0.0 { "+" } else { "" };
            // An interval of all times together beside a bound that holds at each: where nothing is claimed the bound is said.
            let bracket = Some(bracket).filter(|_| answer.verdict == Verdict::Differs);
            let at = answer
                .most_at_s
                .map_or(String::new(), |at| format!(" at {} s", significant(at, 1)));
            format!(
                "{sign}{} % of its range{}{at}",
                significant(value, 2),
                bracket.unwrap_or_default()
            )
        }
        (Some(value), _, _, Scale::PerUnit) => over_range(answer, value, interval),
        (Some(value), ..) => format!("× {}{bracket}", significant(value, 3)),
        (None, Some(least), None, _) => format!("× > {}", rounded_bound(least, false).value_text()),
        (None, None, Some(most), _) => format!("× < {}", rounded_bound(most, true).value_text()),
        (None, Some(least), Some(most), _) => format!("× {}", ends(least, most)),
        _ => "not told".to_owned(),
    }
}

/// A law as a factor over the range of what it follows, `× 6.5 [5.9, 7.2] (+2.5 % per % RH)`: per unit a large change says
/// nothing, a small one is lost.
fn over_range(answer: &Answer, value: f64, interval: Option<(f64, f64)>) -> String {
    let factor = |number: f64| answer.over_all(number);
    let ends = interval.map_or(String::new(), |(low, high)| {
        format!(" [{}]", brackets(factor(low), factor(high)))
    });
    let each = match answer.kind {
        Kind::HumidityLaw => {
            let sign = if value > 0.0 { "+" } else { "" };
            let percent = significant(100.0 * value.exp_m1(), 2);
            format!(" ({sign}{percent}\u{a0}% per %\u{a0}RH)")
        }
        _ => String::new(),
    };
    let strips = answer.strips_from_to.filter(|_| do_strips_differ(answer));
    let strips = strips.map_or(String::new(), |(least, largest)| {
        let of = |number| significant(factor(number), 2);
        format!(", in single strips × {} to × {}", of(least), of(largest))
    });
    format!("× {}{ends}{each}{strips}", significant(factor(value), 3))
}

/// Whether strips follow a law of their own each, by more than runs differ.
fn do_strips_differ(answer: &Answer) -> bool {
    answer.strips_differ_p.is_some_and(|p| p <= ONE_SLOPE)
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

/// The range over which a law was measured: `, 15 to 90 % RH`; nothing of what is no law.
fn range(answer: &Answer) -> String {
    let unit = match answer.unit() {
        "" => String::new(),
        unit => format!("\u{a0}{unit}"),
    };
    let of = |(low, high)| format!(", {} to {}{unit}", plain(low), plain(high));
    answer.from_to.map_or(String::new(), of)
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
        Some(other) if answer.kind.is_by_material() => format!("{} against {other}", answer.material),
        _ => answer.material.clone(),
    };
    match answer.kind {
        Kind::HumidityLaw | Kind::HumidityByMaterial => {
            format!("{symbol} of {of} with the {}{}{at}", answer.upper, range(answer))
        }
        Kind::OtherLaw if !answer.lower.is_empty() => {
            format!("{symbol} of {of}, {} over {}", answer.upper, answer.lower)
        }
        Kind::VoltageLaw | Kind::OtherLaw => {
            format!("{symbol} of {of} with the {}{}", answer.upper, range(answer))
        }
        Kind::Environment if let Some((from, to)) = answer.times_s => format!(
            "{symbol} of {of}, {} over {}{at}, {} to {} s after the step",
            answer.upper,
            answer.lower,
            significant(from, 1),
            significant(to, 1)
        ),
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
    let unit = match answer.scale {
        Scale::Points => "points",
        Scale::OfRange => "% of its range at any time",
        Scale::Ratio | Scale::PerUnit => "%",
    };
    let strips = in_strips(&[answer]);
    let in_strips = strips.as_ref().map_or("", |(strips, _)| strips);
    let said = match (answer.verdict, most) {
        (Verdict::Differs, _) => match &strips {
            Some((strips, material)) => format!("{number}{strips}, {material}"),
            None => number,
        },
        (Verdict::Alike, Some(most)) => {
            format!("no effect larger than {most} {unit}{in_strips} (95 %): {number}")
        }
        (Verdict::Open, Some(_)) if answer.p.is_some_and(|p| p <= CLAIMED_BELOW) => format!(
            "{number}; of as many questions as were asked, one such answer is expected by chance ({})",
            equation("q", answer.q)
        ),
        (Verdict::Open, Some(most)) => {
            format!("{number}; no difference is shown, and up to {most} {unit} is not excluded")
        }
        (Verdict::Bound, _) => number,
        _ if answer.value.is_some() => {
            let of = if answer.is_of_curve() {
                "noise of the readings"
            } else {
                "fits"
            };
            format!("{number} by the {of} alone: nothing tells the scatter from run to run")
        }
        _ => number,
    };
    match strips_alone(&[answer]) {
        Some(strips) => format!("{said}; {strips}"),
        None => said,
    }
}

/// The answers for a material, a line for each pair that the study asked: what differs, then what does not.
pub fn lead(study: &Study, material: &str) -> Vec<String> {
    let own: Vec<&Answer> = (study.asked())
        .filter(|answer| answer.material == material && !answer.kind.is_by_material())
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
        kind if kind.is_law() => format!("with the {}{}", answer.upper, range(answer)),
        _ => format!("{} against {}", answer.upper, answer.lower),
    }
}

/// What a pair does to the parameters: those that differ with their numbers, strongest first; those that do by themselves, but
/// of as many questions one such answer is expected by chance; those that do not, with the largest effect that could hide;
/// those that are open.
fn told(all: &[&Answer]) -> String {
    let numbers = |mut of: Vec<&Answer>| {
        of.sort_by(|a, b| a.p.unwrap_or(1.0).total_cmp(&b.p.unwrap_or(1.0)));
        let each = of
            .iter()
            .map(|own| format!("{} {}", symbol(own.parameter), number(own)));
        in_a_row(&each.collect::<Vec<_>>())
    };
    let names = |of: &[&Answer]| in_a_row(&of.iter().map(|own| symbol(own.parameter)).collect::<Vec<_>>());
    let (curves, of): (Vec<&Answer>, Vec<&Answer>) = all.iter().partition(|own| own.is_of_curve());
    let with = |verdict: Verdict| of.iter().copied().filter(move |own| own.verdict == verdict);
    let (alone, open): (Vec<&Answer>, Vec<&Answer>) =
        with(Verdict::Open).partition(|own| own.p.is_some_and(|p| p <= CLAIMED_BELOW));
    let differ: Vec<&Answer> = with(Verdict::Differs).collect();
    let alike: Vec<&Answer> = with(Verdict::Alike).collect();
    let (curves_differ, curves): (Vec<&Answer>, Vec<&Answer>) = curves
        .into_iter()
        .partition(|own| own.verdict == Verdict::Differs);
    let mut parts = Vec::new();
    let of_strips = in_strips(&differ);
    if !differ.is_empty() {
        let of = of_strips.as_ref().map_or("", |(strips, _)| strips);
        parts.push(numbers(differ) + of);
    }
    parts.extend(of_strips.map(|(_, material)| material));
    if !curves_differ.is_empty() {
        parts.push(numbers(curves_differ));
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
            let strips = in_strips(&of);
            parts.push(format!(
                "no effect larger than {} {unit} on {}{}",
                rounded_bound(most, true).value_text(),
                names(&of),
                strips.as_ref().map_or("", |(strips, _)| strips)
            ));
        }
    }
    // That curves are nowhere further apart than their whole range tells nothing.
    let is_told = |own: &&Answer| own.no_more_than.is_some_and(|most| most < 100.0);
    let (bounded, untold): (Vec<&Answer>, Vec<&Answer>) = curves.into_iter().partition(is_told);
    let open: Vec<&Answer> = open
        .into_iter()
        .chain(with(Verdict::Bound))
        .chain(untold)
        .filter(|own| strips_alone(&[own]).is_none())
        .collect();
    if !open.is_empty() {
        parts.push(format!("open: {}", names(&open)));
    }
    parts.extend(strips_alone(all));
    parts.extend(nowhere_more(&bounded));
    if parts.is_empty() {
        return "nothing was determined".to_owned();
    }
    parts.join("; ")
}

/// What is open of the material and shown of the strips as they were measured; none of others.
fn strips_alone(of: &[&Answer]) -> Option<String> {
    let shown = |own: &&Answer| {
        let strips = own
            .of_strips
            .as_ref()
            .filter(|of| of.is_shown && own.verdict == Verdict::Open)?;
        let of_strips = Answer {
            value: Some(strips.value),
            low_95: Some(strips.low_95),
            high_95: Some(strips.high_95),
            ..(*own).clone()
        };
        Some((
            own.samples,
            format!("{} {}", symbol(own.parameter), number(&of_strips)),
        ))
    };
    let (strips, numbers): (Vec<usize>, Vec<String>) = of.iter().filter_map(shown).unzip();
    let strips = strips.into_iter().max()?;
    Some(format!(
        "in the {strips} strips as they were measured {}, of the material that is not shown, {} would tell",
        in_a_row(&numbers),
        more(strips)
    ))
}

/// What would tell of a material.
fn more(strips: usize) -> &'static str {
    if strips == 2 {
        "a third strip"
    } else {
        "further strips"
    }
}

/// Of what strips of several show: of whom that is told, and of which of it the same is shown of the material; none of others.
fn in_strips(differ: &[&Answer]) -> Option<(String, String)> {
    let of: Vec<&Answer> = differ
        .iter()
        .copied()
        .filter(|own| own.of_material.is_some())
        .collect();
    let strips = of.iter().map(|own| own.samples).max()?;
    let is_shown = |own: &&Answer| own.of_material.as_ref().is_some_and(|of| of.is_shown);
    let (shown, open): (Vec<&Answer>, Vec<&Answer>) = of.into_iter().partition(is_shown);
    let names = |of: &[&Answer]| in_a_row(&of.iter().map(|own| symbol(own.parameter)).collect::<Vec<_>>());
    let more = more(strips);
    let material = match (shown.is_empty(), open.is_empty()) {
        (_, true) => "of the material too".to_owned(),
        (true, _) => format!("of the material that is not shown, {more} would tell"),
        _ => format!(
            "of the material too for {}; for {} {more} would tell",
            names(&shown),
            names(&open)
        ),
    };
    Some((format!(" in the {strips} strips measured"), material))
}

/// By how much curves differ nowhere; nothing of none.
fn nowhere_more(of: &[&Answer]) -> Option<String> {
    let bound = |own: &&Answer| {
        let most = rounded_bound(own.no_more_than?, true).value_text();
        Some(format!("{most} % ({})", symbol(own.parameter)))
    };
    let bounds: Vec<String> = of.iter().filter_map(bound).collect();
    (!bounds.is_empty()).then(|| format!("nowhere more than {} of the range apart", in_a_row(&bounds)))
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
    let mut said: Vec<String> = found.iter().map(of).collect();
    if answers.iter().any(|own| own.of_material.is_some()) {
        said.push("What goes with humidity, voltage or another number is told of the strips measured, each with a level of its own; of the material it is shown where it stands beside what strips differ by (their slopes by chance, Kenward and Roger).".to_owned());
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
    let questions = of(|own| own.is_of_study && !own.is_of_curve());
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
