//! What a study says of its materials: one idea a sentence, the largest first, and nothing of what is open.

use std::cmp::Ordering;
use std::collections::BTreeSet;

use ieap_domain::surroundings::in_words;
use ieap_domain::words::{in_a_row, numeral};

use super::answer::{Answer, Kind, Scale};
use super::grammar::{
    Standing, bracket, by_voltage, changes, from_to, in_strips, loses, loses_by_voltage, most,
};
use super::made::Study;
use super::measures::{BENDING_CURVE, BENDING_LOST, BENDING_PER_VOLT, CURRENT_CURVE};
use super::policy::TOLD_TOGETHER;
use super::words::{at_voltages, name, symbol};
use crate::parameters::COMPARED;

/// A sentence: what one pair of conditions does, or does not, to some parameters of a material.
#[derive(Clone)]
pub(super) struct Sentence<'a> {
    study: &'a Study,
    /// What is told, all of one pair.
    of: Vec<&'a Answer>,
    /// Whether it is told that they do not change.
    is_alike: bool,
}

/// What has been said before, so that it is not said again.
#[derive(Default)]
pub(super) struct Before<'a> {
    /// Parameters whose names were told.
    named: BTreeSet<&'static str>,
    material: Option<&'a str>,
    /// Where the last sentence was about.
    head: String,
}

/// The sentences of a material, what is known best first; one that says so where nothing can be told.
pub fn lead(study: &Study, material: &str) -> Vec<String> {
    let mut before = Before::default();
    let of = ranked(study, material);
    if of.is_empty() {
        return nothing(study, material).into_iter().collect();
    }
    of.iter().map(|own| own.said(&mut before)).collect()
}

/// Key of the parameter that a picture of what is told first shows.
pub fn first_parameter(study: &Study) -> Option<&'static str> {
    Some(match first(study)?.parameter {
        BENDING_LOST => COMPARED[1],
        BENDING_PER_VOLT | BENDING_CURVE => COMPARED[0],
        CURRENT_CURVE => COMPARED[3],
        key => key,
    })
}

/// What is told first of all.
pub(super) fn first(study: &Study) -> Option<&Answer> {
    let all = study.materials().into_iter().flat_map(|of| ranked(study, of));
    let changes = all.filter(|own| !own.is_alike);
    changes.min_by(Sentence::before).map(|own| own.of[0])
}

/// The sentences of a material: what changes, the largest first, then what does not.
pub(super) fn ranked<'a>(study: &'a Study, material: &str) -> Vec<Sentence<'a>> {
    let mut pairs: Vec<Vec<&Answer>> = Vec::new();
    for own in study
        .asked()
        .filter(|own| own.material == material && !own.kind.is_by_material())
    {
        match pairs.iter_mut().find(|of| pair(of[0]) == pair(own)) {
            Some(of) => of.push(own),
            None => pairs.push(vec![own]),
        }
    }
    let (mut changes, mut alike) = (Vec::new(), Vec::new());
    let sentence = |of: &[&'a Answer], is_alike| Sentence {
        study,
        of: of.to_vec(),
        is_alike,
    };
    for of in pairs {
        let changed = changed(study, &of);
        changes.extend(changed.chunks(TOLD_TOGETHER).map(|of| sentence(of, false)));
        let same = unchanged(study, &of);
        if !same.is_empty() {
            alike.push(sentence(&same, true));
        }
    }
    changes.sort_by(Sentence::before);
    changes.into_iter().chain(alike).collect()
}

fn pair(answer: &Answer) -> (&str, &str) {
    (&answer.upper, &answer.lower)
}

/// What is the same thing on another scale: bending lost and the rate of it, bending per volt and the coupling.
fn family(key: &str) -> &str {
    match key {
        BENDING_LOST => COMPARED[1],
        BENDING_PER_VOLT => COMPARED[0],
        key => key,
    }
}

/// The parameters that a pair changes, what is known best first, each thing once; curves where parameters are silent.
fn changed<'a>(study: &'a Study, of: &[&'a Answer]) -> Vec<&'a Answer> {
    let is_told = |own: &&&Answer| Standing::of(told_by(study, own)).is_change();
    let (curves, all): (Vec<&Answer>, Vec<&Answer>) = of
        .iter()
        .filter(is_told)
        .copied()
        .partition(|own| own.is_of_curve());
    if all.is_empty() {
        return curves;
    }
    let best = |own: &&'a Answer| {
        let same = all
            .iter()
            .filter(|other| family(other.parameter) == family(own.parameter));
        let same = same.map(|other| told_by(study, other));
        same.min_by(|a, b| larger(a, b))
            .unwrap_or_else(|| told_by(study, own))
    };
    let is_first = |own: &&Answer| {
        let itself = family(own.parameter);
        own.parameter == itself || all.iter().all(|other| other.parameter != itself)
    };
    let mut shown: Vec<&Answer> = all.iter().copied().filter(is_first).collect();
    shown.sort_by(|a, b| larger(best(a), best(b)));
    shown
}

/// The parameters that a pair does not change, each thing once; curves where parameters are silent.
fn unchanged<'a>(study: &'a Study, of: &[&'a Answer]) -> Vec<&'a Answer> {
    let is_alike = |own: &&&Answer| Standing::of(told_by(study, own)) == Standing::Alike;
    let all: Vec<&Answer> = of.iter().filter(is_alike).copied().collect();
    let is_named = |own: &&Answer| !own.is_of_curve() && family(own.parameter) == own.parameter;
    let named: Vec<&Answer> = all.iter().copied().filter(is_named).collect();
    if named.is_empty() { all } else { named }
}

/// What changes more stands first.
fn larger(a: &Answer, b: &Answer) -> Ordering {
    rank(b).total_cmp(&rank(a))
}

/// The size of a change in what the strip does, times how sure it is.
fn rank(own: &Answer) -> f64 {
    size(own) * (1.0 - own.p.unwrap_or(1.0))
}

/// Size of a change as a logarithm, of a law over all of its range; of parts of a whole as the logarithm of what is left.
fn size(of: &Answer) -> f64 {
    let value = of.value.unwrap_or(0.0);
    let part = match of.scale {
        Scale::Ratio => return value.ln().abs(),
        Scale::PerUnit => return (of.span.unwrap_or(1.0) * value).abs(),
        Scale::Points if of.kind.is_law() => of.over_all(value).abs() / 100.0,
        Scale::Points | Scale::OfRange => value.abs() / 100.0,
    };
    -(-part.min(0.99)).ln_1p()
}

/// What is told of a pair: what it does on the whole, or that it acts otherwise at another voltage, whichever is known better.
/// How sure the sentence is, is how sure that is.
fn told_by<'a>(study: &'a Study, answer: &'a Answer) -> &'a Answer {
    let known_better = |own: &&Answer| {
        let standing = Standing::of(own);
        standing.is_change() && standing <= Standing::of(answer)
    };
    (interaction(study, answer).filter(known_better))
        .filter(|_| at_each_voltage(study, answer).len() > 1)
        .unwrap_or(answer)
}

/// Whether a pair acts otherwise at another voltage.
fn interaction<'a>(study: &'a Study, answer: &Answer) -> Option<&'a Answer> {
    let is_at = |of: &str, name: &str| of.strip_prefix(name).is_some_and(|rest| rest.starts_with(" at "));
    let is_it = |own: &&Answer| {
        own.kind == Kind::ByVoltage
            && (own.parameter, &own.material) == (answer.parameter, &answer.material)
            && is_at(&own.upper, &answer.upper)
            && is_at(&own.lower, &answer.lower)
    };
    let mut all = study.answers.iter().filter(|_| answer.kind == Kind::Environment);
    all.find(is_it)
}

/// The values at each voltage of what a pair does, where they show a change: against the first of several that are put together.
fn at_each_voltage<'a>(study: &'a Study, answer: &Answer) -> Vec<&'a Answer> {
    let is_it = |own: &&Answer| {
        own.kind == Kind::Environment
            && own.voltages_v.len() == 1
            && own.value.is_some()
            && shows_a_change(own)
            && (own.parameter, &own.material, &own.upper)
                == (answer.parameter, &answer.material, &answer.upper)
            && answer.lower.contains(&own.lower)
    };
    let all: Vec<&Answer> = study.answers.iter().filter(is_it).collect();
    let first = all.first().map(|own| own.lower.as_str());
    all.into_iter()
        .filter(|own| Some(own.lower.as_str()) == first)
        .collect()
}

/// Whether the interval of a ratio or a difference holds no value without a change.
fn shows_a_change(own: &Answer) -> bool {
    let none = if own.scale == Scale::Ratio { 1.0 } else { 0.0 };
    let ends = own.low_95.zip(own.high_95);
    ends.or(own.fits_low_95.zip(own.fits_high_95))
        .is_some_and(|(low, high)| low > none || high < none)
}

/// What is said of a material of which nothing can be told.
fn nothing(study: &Study, material: &str) -> Option<String> {
    let strips = study
        .asked()
        .filter(|own| own.material == material)
        .map(|own| own.samples)
        .max()?;
    let strips = match strips {
        0 => String::new(),
        1 => " with one strip (a second would)".to_owned(),
        2 => " with two strips (a third would)".to_owned(),
        more => format!(" with {} strips (more would)", numeral(more)),
    };
    Some(format!(
        "What was varied changes {material} in nothing that can be told{strips}."
    ))
}

impl<'a> Sentence<'a> {
    /// The same of what it tells first, where it tells a change.
    pub(super) fn first_alone(&self) -> Sentence<'a> {
        let told = if self.is_alike { self.of.len() } else { 1 };
        Sentence {
            of: self.of[..told].to_vec(),
            ..self.clone()
        }
    }

    /// What is known best stands first, and what does not change behind what does.
    pub(super) fn before(&self, other: &Self) -> Ordering {
        (self.is_alike.cmp(&other.is_alike)).then_with(|| larger(self.known(), other.known()))
    }

    /// Whether it stands before an answer of that rank.
    pub(super) fn is_before(&self, other: f64) -> bool {
        !self.is_alike && rank(self.known()) >= other
    }

    fn known(&self) -> &'a Answer {
        told_by(self.study, self.of[0])
    }

    pub(super) fn said(&self, before: &mut Before<'a>) -> String {
        let first = self.of[0];
        let is_new = before.material != Some(first.material.as_str());
        let place = head(first);
        let head = if before.head != place {
            format!("{place}, ")
        } else {
            String::new()
        };
        let whose = if is_new {
            format!("{}'s", first.material)
        } else {
            "its".to_owned()
        };
        before.material = Some(first.material.as_str());
        before.head = place;
        let text = if self.is_alike {
            format!("{head}{}", self.alike(&whose, before))
        } else {
            let each = self.of.iter().enumerate();
            let each: Vec<(String, String)> = each
                .map(|(at, own)| self.change(own, if at == 0 { &whose } else { "its" }, before))
                .collect();
            // Where two clauses share the voltages, the last one says them.
            let clause = |(at, (text, place)): (usize, &(String, String))| {
                let is_said_behind = each.get(at + 1).is_some_and(|(_, next)| next == place);
                if is_said_behind {
                    text.clone()
                } else {
                    format!("{text}{place}")
                }
            };
            let clauses: Vec<String> = each.iter().enumerate().map(clause).collect();
            format!("{head}{}", in_a_row(&clauses))
        };
        match text.strip_prefix("its ") {
            Some(rest) => format!("Its {rest}."),
            None => format!("{text}."),
        }
    }

    /// `CNaf's steady-state resistance Rₛₛ probably falls to 4.4 % (0.59 to 32 %)`, and at which voltages.
    fn change(&self, answer: &Answer, whose: &str, before: &mut Before) -> (String, String) {
        let (is_lost, by) = (answer.parameter == BENDING_LOST, told_by(self.study, answer));
        let (said, at) = if by.kind == Kind::ByVoltage {
            let each = at_each_voltage(self.study, answer);
            let said = if is_lost {
                loses_by_voltage(&each, by)
            } else {
                by_voltage(&each, by)
            };
            (said, at_each(&each, answer))
        } else {
            let said = if is_lost { loses(answer) } else { changes(answer) };
            (said, self.where_not_all(answer))
        };
        let subject = if is_lost {
            whose.strip_suffix("'s").unwrap_or("it").to_owned()
        } else {
            format!("{whose} {}", named(answer, before))
        };
        (format!("{subject} {said}"), at)
    }

    /// At which voltages, where the others of the pair were told at more.
    fn where_not_all(&self, answer: &Answer) -> String {
        let of_pair = self
            .study
            .asked()
            .filter(|own| own.material == answer.material && pair(own) == pair(answer));
        let all = of_pair.map(|own| own.voltages_v.len()).max().unwrap_or(0);
        if answer.voltages_v.len() < all {
            at_voltages(&answer.voltages_v)
        } else {
            String::new()
        }
    }

    /// `its coupling α and capacitance C₁ + C₂ do not change (within 12 %)`.
    fn alike(&self, whose: &str, before: &mut Before) -> String {
        let names: Vec<String> = self.of.iter().map(|own| named(own, before)).collect();
        let largest = self.of.iter().max_by(|a, b| {
            let most = |own: &Answer| own.no_more_than.unwrap_or(0.0);
            most(a).total_cmp(&most(b))
        });
        let within = largest.map(|own| format!("within {}", most(own)));
        let strips = self.of.iter().map(|own| in_strips(own));
        let within = bracket(within, &strips.max_by_key(String::len).unwrap_or_default());
        let do_not = if names.len() == 1 { "does" } else { "do" };
        format!("{whose} {} {do_not} not change{within}", in_a_row(&names))
    }
}

/// ` against vacuum at 1.2 and 2.5 V`: where values at each voltage hold, and against what, where not against all that the
/// pair sets together.
fn at_each(each: &[&Answer], answer: &Answer) -> String {
    let volts: Vec<f64> = each.iter().map(|own| own.voltages_v[0]).collect();
    let lower = each.first().map(|own| own.lower.as_str());
    let against = (lower.filter(|own| *own != answer.lower))
        .map_or(String::new(), |own| format!(" against {}", in_words(own)));
    against + &at_voltages(&volts)
}

/// `steady-state resistance Rₛₛ`, and `Rₛₛ` once that was said.
fn named(answer: &Answer, before: &mut Before) -> String {
    let (name, symbol) = (name(answer.parameter), symbol(answer.parameter));
    if before.named.insert(answer.parameter) && !name.is_empty() {
        format!("{name} {symbol}")
    } else {
        symbol.to_owned()
    }
}

/// Where a sentence is about: `In air, against dry`, `With the relative humidity from 0 to 80 % RH`.
fn head(answer: &Answer) -> String {
    // Which surroundings are the dry ones the table says.
    let lower = answer
        .lower
        .split_once(" (")
        .map_or(answer.lower.as_str(), |(name, _)| name);
    match answer.kind {
        Kind::OtherLaw if !lower.is_empty() => format!("With {}, against {lower}", answer.upper),
        kind if kind.is_law() => format!("With the {}{}", answer.upper, from_to(answer)),
        Kind::Voltage => format!("At {}, against {lower}", answer.upper),
        _ => format!("In {}, against {}", in_words(&answer.upper), in_words(lower)),
    }
}
