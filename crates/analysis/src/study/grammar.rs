//! What an answer shows, as one scientist says it to another: direction and size in words, the interval behind the number.

use ieap_domain::number::{plain, rounded_bound, significant};
use ieap_domain::words::{in_a_row, numeral};

use super::answer::{Answer, Basis, Certainty, Kind, Scale, Verdict};
use super::policy::{FOLDS_FROM, ONE_SLOPE, ROUGHLY_FROM};

/// How what is open begins.
pub const UNTOLD: &str = "cannot be told";

/// What may be said of an answer, what is known best first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Standing {
    /// It differs.
    Sure,
    /// It does so likely.
    Probably,
    /// It does in the strips as they were measured, and that is open of their material.
    InStrips,
    /// It does not change.
    Alike,
    /// One side is a bound.
    Bound,
    /// Nothing.
    Open,
}

impl Standing {
    pub(super) fn of(answer: &Answer) -> Standing {
        let in_strips = answer.of_strips.as_ref().is_some_and(|own| own.is_shown);
        match answer.verdict {
            Verdict::Differs => Standing::Sure,
            Verdict::Open if answer.certainty == Certainty::Likely => Standing::Probably,
            Verdict::Open if in_strips => Standing::InStrips,
            Verdict::Alike => Standing::Alike,
            Verdict::Bound => Standing::Bound,
            Verdict::Open | Verdict::NotTold => Standing::Open,
        }
    }

    /// Whether a change is told of what the study asks about.
    pub(super) fn is_change(self) -> bool {
        self <= Standing::Probably
    }
}

/// What an answer shows, how sure that is and of whom, in a few words: a cell of a table.
pub(crate) fn in_short(answer: &Answer) -> &'static str {
    match Standing::of(answer) {
        Standing::Probably => "probably differs",
        Standing::InStrips => "differs in the strips measured",
        Standing::Sure | Standing::Alike | Standing::Bound | Standing::Open => answer.verdict.label(),
    }
}

/// What an answer shows, as the rest of a sentence that begins with what is asked.
pub(super) fn shows(answer: &Answer) -> String {
    match Standing::of(answer) {
        Standing::Sure | Standing::Probably | Standing::InStrips => changes(answer),
        Standing::Alike => format!("{} (within {})", alike(answer.kind), most(answer)),
        Standing::Bound => bound(answer),
        Standing::Open => cannot_be_told(answer),
    }
}

/// `rises 3.5-fold (3.3 to 3.7)`, `probably falls to 4.4 % (0.59 to 32 %)`, `falls 2.0 % for each percent of humidity (1.9 to
/// 2.1 in the two strips measured), to about a fifth in all`.
pub(super) fn changes(answer: &Answer) -> String {
    let own = told(answer, Standing::of(answer));
    let Some(value) = own.value else {
        return cannot_be_told(answer);
    };
    let ends = ends(&own);
    let change = match own.scale {
        Scale::OfRange => curve(&own, value, ends),
        Scale::Points => points(&own, value, ends),
        Scale::PerUnit => law(&own, value, ends),
        Scale::Ratio => ratio(own.kind, value, ends),
    };
    change.said(answer)
}

/// `probably loses 43 of 100 parts more of its bending in an hour (19 to 67)`.
pub(super) fn loses(answer: &Answer) -> String {
    let own = told(answer, Standing::of(answer));
    let over = if own.kind.is_law() {
        own.span.unwrap_or(1.0)
    } else {
        1.0
    };
    let Some(value) = own.value else {
        return cannot_be_told(answer);
    };
    let ends = ends(&own).map(|(low, high)| (over * low, over * high));
    lost(&[(over * value, ends)]).said(answer)
}

/// The same at several voltages, that it differs by which is known as well as `by` is.
pub(super) fn loses_by_voltage(each: &[&Answer], by: &Answer) -> String {
    lost(&numbers(each, by)).said(by)
}

/// Values at several voltages, that they differ is known as well as `by` is: `rises 1.7-, 3.5- and 19-fold (1.2 to 2.4, 2.5 to
/// 4.9 and 13 to 28)`, `probably falls to 30, 9.0 and 2.7 %`.
pub(super) fn by_voltage(each: &[&Answer], by: &Answer) -> String {
    factors(&numbers(each, by)).said(by)
}

/// `probably `, where it is not sure.
pub(super) fn adverb(answer: &Answer) -> &'static str {
    match Standing::of(answer) {
        Standing::Probably => "probably ",
        _ => "",
    }
}

/// The answer with the numbers that are told: where only the strips as they were measured show it, theirs.
fn told(answer: &Answer, standing: Standing) -> Answer {
    match &answer.of_strips {
        Some(strips) if standing == Standing::InStrips => Answer {
            value: Some(strips.value),
            low_95: Some(strips.low_95),
            high_95: Some(strips.high_95),
            ..answer.clone()
        },
        _ => answer.clone(),
    }
}

/// Its interval, by the fits alone where nothing tells the scatter.
fn ends(own: &Answer) -> Ends {
    own.low_95
        .zip(own.high_95)
        .or(own.fits_low_95.zip(own.fits_high_95))
}

/// The values and intervals of several answers, of those whom `by` is told of.
fn numbers(each: &[&Answer], by: &Answer) -> Vec<(f64, Ends)> {
    let standing = Standing::of(by);
    let number = |own: &&Answer| {
        let own = told(own, standing);
        Some((own.value?, ends(&own)))
    };
    each.iter().filter_map(number).collect()
}

/// `in the two strips measured; a third would tell`, where nothing is said of their material; of one strip the whole study says
/// it once.
pub(super) fn in_strips(answer: &Answer) -> String {
    let is_of_material = answer.of_material.as_ref().is_none_or(|own| own.is_shown);
    if is_of_material && Standing::of(answer) != Standing::InStrips {
        return String::new();
    }
    let would = match (Standing::of(answer), answer.samples) {
        (Standing::InStrips, 2) => "; a third would tell",
        (Standing::InStrips, 3) => "; a fourth would tell",
        (Standing::InStrips, _) => "; more would tell",
        _ => "",
    };
    format!("in the {} strips measured{would}", numeral(answer.samples))
}

/// A change: its verb, how much, the ends of its interval, and what stands behind them.
struct Change {
    verb: &'static str,
    size: String,
    ends: Option<String>,
    rest: String,
}

type Ends = Option<(f64, f64)>;

impl Change {
    /// As sure, and of whom, as that answer is.
    fn said(self, by: &Answer) -> String {
        let adverb = adverb(by);
        let verb = match self.verb {
            "is" => format!("is {adverb}"),
            verb => format!("{adverb}{verb} "),
        };
        let bracket = bracket(self.ends, &in_strips(by));
        format!("{verb}{}{bracket}{}", self.size, self.rest)
    }
}

/// ` (3.3 to 3.7 in the two strips measured)`: what stands behind a number.
pub(super) fn bracket(ends: Option<String>, strips: &str) -> String {
    match (ends, strips) {
        (Some(ends), "") => format!(" ({ends})"),
        (Some(ends), strips) => format!(" ({ends} {strips})"),
        (None, "") => String::new(),
        (None, strips) => format!(" {strips}"),
    }
}

/// `rises 3.5-fold (3.3 to 3.7)`, `falls to 40 % (falls to 44 % or less)`: a factor with what is known of its interval, wherever
/// one is told.
pub(crate) fn factor(value: f64, low: Option<f64>, high: Option<f64>) -> String {
    let change = ratio(Kind::Environment, value, low.zip(high));
    let one_end = match (low, high) {
        (Some(_), Some(_)) => None,
        (low, high) => bounded(low, high),
    };
    format!(
        "{} {}{}",
        change.verb,
        change.size,
        bracket(change.ends.or(one_end), "")
    )
}

/// A ratio: as a fold where it is large, else in percent; of two things beside each other as times.
fn ratio(kind: Kind, value: f64, ends: Ends) -> Change {
    let percent = |low: f64, high: f64| format!("{} %", between(100.0 * low, 100.0 * high));
    let of = |verb, size, ends| Change {
        verb,
        size,
        ends,
        rest: String::new(),
    };
    if kind == Kind::Material || is_of_ratios(kind) {
        let what = if kind == Kind::Material {
            "times as large"
        } else {
            "times as much"
        };
        let ends = ends.map(|(low, high)| between(low, high));
        return of("is", format!("{} {what}", significant(value, 2)), ends);
    }
    if value >= FOLDS_FROM {
        let ends = ends.map(|(low, high)| between(low, high));
        of("rises", format!("{}-fold", significant(value, 2)), ends)
    } else if value >= 1.0 {
        let ends = ends.map(|(low, high)| percent(low - 1.0, high - 1.0));
        of(
            "rises",
            format!("by {} %", significant(100.0 * (value - 1.0), 2)),
            ends,
        )
    } else if value > 1.0 / FOLDS_FROM {
        let ends = ends.map(|(low, high)| percent(1.0 - high, 1.0 - low));
        of(
            "falls",
            format!("by {} %", significant(100.0 * (1.0 - value), 2)),
            ends,
        )
    } else {
        let ends = ends.map(|(low, high)| percent(low, high));
        of("falls", format!("to {} %", significant(100.0 * value, 2)), ends)
    }
}

/// A law: of the humidity by the percent, and what that makes over all that was measured; else over all of it.
fn law(own: &Answer, value: f64, ends: Ends) -> Change {
    let over = |number: f64| own.over_all(number);
    if own.kind != Kind::HumidityLaw {
        let ends = ends.map(|(low, high)| (over(low), over(high)));
        return Change {
            rest: single_strips(own),
            ..ratio(own.kind, over(value), ends)
        };
    }
    let each = |number: f64| 100.0 * number.exp_m1();
    let sign = if value < 0.0 { -1.0 } else { 1.0 };
    let sorted = |a: f64, b: f64| between(a.min(b), a.max(b));
    Change {
        verb: if value < 0.0 { "falls" } else { "rises" },
        size: format!(
            "{} % for each percent of humidity",
            significant(sign * each(value), 2)
        ),
        ends: ends.map(|(low, high)| sorted(sign * each(low), sign * each(high))),
        rest: format!(", {} in all{}", roughly(over(value)), single_strips(own)),
    }
}

/// What single strips do, where they differ by more than runs do: `, 5.2- to 7.7-fold in single strips`.
fn single_strips(own: &Answer) -> String {
    let do_differ = own.strips_differ_p.is_some_and(|p| p <= ONE_SLOPE);
    let strips = own.strips_from_to.filter(|_| do_differ);
    strips.map_or(String::new(), |(least, largest)| {
        let ends = between(own.over_all(least), own.over_all(largest));
        format!(", {ends} times in single strips")
    })
}

/// A factor in a word: `about sevenfold`, `to about a fifth`, `by 35 %`.
fn roughly(factor: f64) -> String {
    const PARTS: [&str; 8] = [
        "third", "quarter", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth",
    ];
    let part = |of: f64| PARTS.get((of.round() as usize).wrapping_sub(3));
    match factor {
        large if large >= ROUGHLY_FROM => match part(large) {
            Some(_) => format!("about {}fold", numeral(large.round() as usize)),
            None => format!("about {}-fold", significant(large, 2)),
        },
        small if small <= 1.0 / ROUGHLY_FROM => match part(1.0 / small) {
            Some(part) if part.starts_with("eigh") => format!("to about an {part}"),
            Some(part) => format!("to about a {part}"),
            None => format!("to about {} %", significant(100.0 * small, 2)),
        },
        twice if twice >= FOLDS_FROM => format!("{}-fold", significant(twice, 2)),
        half if half <= 1.0 / FOLDS_FROM => format!("to {} %", significant(100.0 * half, 2)),
        near => format!("by {} %", significant(100.0 * (near - 1.0).abs(), 2)),
    }
}

/// A difference in points, over all of what a law follows.
fn points(own: &Answer, value: f64, ends: Ends) -> Change {
    let over = if own.kind.is_law() {
        own.span.unwrap_or(1.0)
    } else {
        1.0
    };
    let sign = if value < 0.0 { -1.0 } else { 1.0 };
    let verb = match (is_of_ratios(own.kind) || own.kind == Kind::Material, value < 0.0) {
        (true, _) => "is",
        (_, true) => "falls",
        (_, false) => "rises",
    };
    let size = significant(sign * over * value, 2);
    let size = match (verb, value < 0.0) {
        ("is", true) => format!("{size} points less"),
        ("is", false) => format!("{size} points more"),
        _ => format!("by {size} points"),
    };
    let ends = ends.map(|(low, high)| {
        let (a, b) = (sign * over * low, sign * over * high);
        between(a.min(b), a.max(b))
    });
    let rest = String::new();
    Change {
        verb,
        size,
        ends,
        rest,
    }
}

/// Where two curves differ most.
fn curve(own: &Answer, value: f64, ends: Ends) -> Change {
    let sign = if value < 0.0 { -1.0 } else { 1.0 };
    let side = if value < 0.0 { "lower" } else { "higher" };
    let ends = ends.map(|(low, high)| (sign * low, sign * high));
    Change {
        verb: "is",
        size: format!("{side} by {} % of its range", significant(sign * value, 2)),
        ends: ends.map(|(a, b)| format!("{} %", between(a.min(b), a.max(b)))),
        rest: own.most_at_s.map_or(String::new(), |at| {
            format!(" {} s after the step", significant(at, 1))
        }),
    }
}

/// Factors at several voltages: `rises 1.7-, 3.5- and 19-fold`, `falls to 30, 9.0 and 2.7 %`.
fn factors(each: &[(f64, Ends)]) -> Change {
    let all = |is_so: fn(f64) -> bool| each.iter().all(|(value, _)| is_so(*value));
    let (verb, before, times, behind, unit) = if all(|own| own >= 1.0) {
        ("rises", "", 1.0, "-", "fold")
    } else if all(|own| own <= 1.0) {
        ("falls", "to ", 100.0, "", " %")
    } else {
        ("becomes", "", 1.0, "", " times as large")
    };
    let number = |(value, _): &(f64, Ends)| significant(times * value, 2) + behind;
    let unit_of_ends = if unit == " %" { unit } else { "" };
    Change {
        verb,
        size: format!("{before}{}{unit}", row(each, number)),
        ends: ends_in_a_row(each, times).map(|ends| ends + unit_of_ends),
        rest: String::new(),
    }
}

/// Points of bending lost: `loses 43 of 100 parts more of its bending in an hour`.
fn lost(each: &[(f64, Ends)]) -> Change {
    let is_less = each.iter().all(|(value, _)| *value < 0.0);
    let (sign, side) = if is_less { (-1.0, "less") } else { (1.0, "more") };
    let parts = row(each, |(value, _)| significant(sign * value, 2));
    Change {
        verb: "loses",
        size: format!("{parts} of 100 parts {side} of its bending in an hour"),
        ends: ends_in_a_row(each, sign),
        rest: String::new(),
    }
}

/// Numbers in a row: `1.7, 3.5 and 19`.
fn row(each: &[(f64, Ends)], said: impl Fn(&(f64, Ends)) -> String) -> String {
    in_a_row(&each.iter().map(said).collect::<Vec<_>>())
}

/// Their intervals, so many times as large; none where one is not known.
fn ends_in_a_row(each: &[(f64, Ends)], times: f64) -> Option<String> {
    let said = |(_, ends): &(f64, Ends)| {
        let (a, b) = (*ends).map(|(low, high)| (times * low, times * high))?;
        Some(between(a.min(b), a.max(b)))
    };
    let all: Option<Vec<String>> = each.iter().map(said).collect();
    all.map(|all| in_a_row(&all))
}

/// Whether the number is a ratio of ratios.
fn is_of_ratios(kind: Kind) -> bool {
    kind.is_by_material() || kind == Kind::ByVoltage
}

fn alike(kind: Kind) -> &'static str {
    match kind {
        kind if is_of_ratios(kind) || kind == Kind::Material => "is the same",
        _ => "does not change",
    }
}

/// How large an effect could hide: `12 %`, `15 points`, `17 % of its range`.
pub(super) fn most(answer: &Answer) -> String {
    let most = answer
        .no_more_than
        .map_or(String::new(), |most| rounded_bound(most, true).value_text());
    match answer.scale {
        Scale::Points => format!("{most} points"),
        Scale::OfRange => format!("{most} % of its range"),
        Scale::Ratio | Scale::PerUnit => format!("{most} %"),
    }
}

/// A bound as a sentence's rest.
fn bound(answer: &Answer) -> String {
    bounded(answer.at_least, answer.at_most).unwrap_or_else(|| cannot_be_told(answer))
}

/// `rises at least 80-fold`, `falls to 44 % or less`; none without an end.
fn bounded(at_least: Option<f64>, at_most: Option<f64>) -> Option<String> {
    let times = |value: f64, is_upper| rounded_bound(value, is_upper).value_text();
    Some(match (at_least, at_most) {
        (Some(least), None) if least >= 1.0 => format!("rises at least {}-fold", times(least, false)),
        (Some(least), None) => format!("falls no further than to {} %", times(100.0 * least, false)),
        (None, Some(most)) if most >= 1.0 => format!("rises no more than {}-fold", times(most, true)),
        (None, Some(most)) => format!("falls to {} % or less", times(100.0 * most, true)),
        (Some(least), Some(most)) => format!("becomes {} times as large", between(least, most)),
        (None, None) => return None,
    })
}

/// `cannot be told with 2 strips (a third would): up to 2.6-fold is possible`.
fn cannot_be_told(answer: &Answer) -> String {
    let possible = match (answer.no_more_than, answer.scale) {
        (None, _) => String::new(),
        (Some(most), Scale::Ratio | Scale::PerUnit) if most > 100.0 => {
            format!(": up to {}-fold is possible", significant(1.0 + most / 100.0, 2))
        }
        (Some(_), _) => format!(": up to {} is possible", most(answer)),
    };
    untold(answer) + &possible
}

/// `cannot be told with 2 strips (a third would)`.
pub(super) fn untold(answer: &Answer) -> String {
    if let Some(reason) = &answer.reason {
        return format!("{UNTOLD}: {reason}");
    }
    let would = match (answer.basis, answer.samples) {
        (Basis::Unknown, _) | (_, 0) => {
            ", for nothing tells the scatter from run to run (a repeat would)".to_owned()
        }
        _ if answer.kind.is_by_material() => " with these strips (more would)".to_owned(),
        (_, 1) => " with 1 strip (a second would)".to_owned(),
        (_, 2) => " with 2 strips (a third would)".to_owned(),
        (_, strips) => format!(" with {strips} strips (more would)"),
    };
    format!("{UNTOLD}{would}")
}

/// `3.3 to 3.7`: as many digits as tell the ends apart.
pub(super) fn between(low: f64, high: f64) -> String {
    let [least, largest] = [low, high].map(|end| significant(end, 2));
    if least == largest {
        format!("{} to {}", significant(low, 3), significant(high, 3))
    } else {
        format!("{least} to {largest}")
    }
}

/// ` from 15 to 90 % RH`: the range over which a law was measured; nothing of what is no law.
pub(super) fn from_to(answer: &Answer) -> String {
    let unit = match answer.unit() {
        "" => String::new(),
        unit => format!("\u{a0}{unit}"),
    };
    let of = |(low, high)| format!(" from {} to {}{unit}", plain(low), plain(high));
    answer.from_to.map_or(String::new(), of)
}
