//! What monitoring found, in sentences.

use super::Watched;
use super::series::Reaches;
use crate::laws::covariate::Covariate;
use crate::laws::words::{moves, round, short, symbol};
use crate::monitoring::fitted::{Fitted, Interval};
use crate::monitoring::policy::AS_GOOD;
use crate::monitoring::shape::Law;
use crate::study::factor;
use crate::study::{self, Answer, Kind, Study, Verdict};
use ieap_domain::Limit;
use ieap_domain::number::fixed;
use ieap_domain::words::{counted, in_a_row};

/// The life of a parameter of a sample, in a few sentences: what is clearest first.
pub fn life(watched: &Watched) -> String {
    let jumps = jumps(watched);
    let mut text = match watched.study.is_shown() {
        true => format!("{}{jumps}", course(watched)),
        false if jumps.is_empty() => nothing(watched),
        false => format!("{} {}", jumps.trim_start(), nothing(watched)),
    };
    if let Some((limit, reaches)) = &watched.limit {
        text += &format!(" {}", limit_words(watched, limit, reaches));
    }
    if watched.left_out > 0 {
        text += &format!(
            " {} left out: a bound, or not determined.",
            counted(watched.left_out, "run")
        );
    }
    text
}

pub(super) fn subject(watched: &Watched) -> String {
    format!("{} of {}", symbol(&watched.parameter), watched.sample)
}

/// The trend or the step that is told, with its rivals.
fn course(watched: &Watched) -> String {
    let study = &watched.study;
    let (Some(law), Some(p)) = (study.trends.first(), study.p_trend) else {
        return nothing(watched);
    };
    let moves = moves(law.size, watched.series.is_log);
    let how = match law.bend_at {
        Some(at) if law.law == Law::Step => format!("in one step {}", at_step(watched, at)),
        Some(at) if law.law == Law::Knee => {
            format!("over {}, knee at {}", span(watched), on_axis(watched, at))
        }
        _ => format!("over {}, {}", span(watched), law.law.key()),
    };
    let mut text = format!(
        "{} {moves} {how}{} (p = {}, {}).",
        subject(watched),
        as_well(&study.trends),
        short(p),
        counted(watched.series.x.len(), "run")
    );
    if let Some(change) = &study.change {
        text += &format!(
            " Beside this trend its level steps {} {} (p = {}).",
            by(change.size, watched.series.is_log),
            at_step(watched, change.at),
            short(change.p)
        );
    }
    text
}

/// Laws that describe it as well as the first of them.
fn as_well(laws: &[Fitted]) -> String {
    let best = laws.iter().map(|law| law.bic).fold(f64::INFINITY, f64::min);
    let others: Vec<&str> = laws
        .iter()
        .skip(1)
        .filter(|other| other.bic <= best + AS_GOOD)
        .map(|other| other.law.key())
        .collect();
    if others.is_empty() {
        String::new()
    } else {
        format!(" as well as {}", others.join(", "))
    }
}

fn nothing(watched: &Watched) -> String {
    let (what, n) = (subject(watched), counted(watched.series.x.len(), "run"));
    let apart = if watched.study.steps.is_empty() {
        ""
    } else {
        "Apart from that "
    };
    match watched.study.p_trend {
        Some(p) => format!(
            "{apart}{what} shows no trend and no step over {} (p = {}, {n}).",
            span(watched),
            short(p)
        ),
        None => format!("{what}: {n}, too few for a trend."),
    }
}

/// Where a step lies: between which readings, and between which it may lie.
fn at_step(watched: &Watched, at: Interval) -> String {
    let x = &watched.series.x;
    let below = |place: f64| x.iter().copied().filter(|x| *x < place).reduce(f64::max);
    let above = |place: f64| x.iter().copied().filter(|x| *x >= place).reduce(f64::min);
    let (Some(before), Some(after)) = (below(at.value), above(at.value)) else {
        return format!("at {}", on_axis(watched, at));
    };
    // The ends are places that are excluded: what is held lies between the readings next to them.
    let first = at.low_95.and_then(above).unwrap_or(watched.study.span.low);
    let last = at.high_95.and_then(below).unwrap_or(watched.study.span.high);
    let within = if first < before || last > after {
        format!(
            " [{} to {}]",
            short_axis(watched, first),
            short_axis(watched, last)
        )
    } else {
        String::new()
    };
    format!(
        "between {} {} and {}{within}{}",
        watched.axis.label(),
        short_axis(watched, before),
        short_axis(watched, after),
        unit(watched.axis)
    )
}

/// Jumps from which on they are told together.
const MANY_JUMPS: usize = 2;

/// Jumps in sentences, each with a space before it.
fn jumps(watched: &Watched) -> String {
    let own = watched.study.steps.iter().filter(|step| !step.is_stated);
    let own: Vec<&super::series::Step> = own.collect();
    if own.len() >= MANY_JUMPS && own.len() == watched.study.steps.len() {
        let places: Vec<String> = own
            .iter()
            .map(|step| short_axis(watched, watched.series.x[step.at]))
            .collect();
        let places: Vec<&str> = places.iter().map(String::as_str).collect();
        let largest = own
            .iter()
            .map(|step| step.size)
            .max_by(|a, b| a.abs().total_cmp(&b.abs()));
        return format!(
            " {} jumps at {} {}, at most {}: that is left out of the trend and of the chart.",
            subject(watched),
            watched.axis.label(),
            in_a_row(&places),
            by(largest.unwrap_or_default(), watched.series.is_log),
        );
    }
    let told = |step: &super::series::Step| {
        let why = if step.is_stated {
            "where the instrument or its calibration changed"
        } else {
            "from one run to the next"
        };
        format!(
            " {} jumps {} at {} {}, {why}: that is left out of the trend and of the chart.",
            subject(watched),
            by(step.size, watched.series.is_log),
            watched.axis.label(),
            short_axis(watched, watched.series.x[step.at]),
        )
    };
    watched.study.steps.iter().map(told).collect()
}

/// A step as a table tells it.
#[derive(Debug, Clone, PartialEq)]
pub struct StepText {
    /// Where on the axis.
    pub at: f64,
    /// `down by 29 %`.
    pub size: String,
    /// What it is.
    pub what: String,
}

/// Every step of a parameter: jumps that are left out, a step beside a trend, a course that is one step.
pub fn steps(watched: &Watched) -> Vec<StepText> {
    let (study, is_log) = (&watched.study, watched.series.is_log);
    let jumps = study.steps.iter().map(|step| StepText {
        at: watched.series.x[step.at],
        size: by(step.size, is_log),
        what: if step.is_stated {
            "the instrument or its calibration changed; left out of the trend and of the chart"
        } else {
            "jump from one run to the next; left out of the trend and of the chart"
        }
        .to_owned(),
    });
    let beside = study.change.iter().map(|change| StepText {
        at: change.at.value,
        size: by(change.size, is_log),
        what: format!("step beside the trend (p = {})", short(change.p)),
    });
    let course = study
        .trends
        .first()
        .filter(|law| study.is_shown() && law.law == Law::Step);
    let course = course.and_then(|law| {
        Some(StepText {
            at: law.bend_at?.value,
            size: by(law.size.value, is_log),
            what: format!("one step, no trend (p = {})", short(study.p_trend?)),
        })
    });
    jumps.chain(beside).chain(course).collect()
}

/// A place on the axis with its unit: `age 530 h`.
pub fn place(watched: &Watched, at: f64) -> String {
    let axis = watched.axis;
    format!("{} {}{}", axis.label(), short_axis(watched, at), unit(axis))
}

fn by(size: f64, is_log: bool) -> String {
    if !is_log {
        return format!("by {}", short(size));
    }
    let said = factor(size.exp(), None, None);
    let (verb, how_far) = said.split_once(' ').unwrap_or_default();
    format!("{} {how_far}", if verb == "rises" { "up" } else { "down" })
}

fn span(watched: &Watched) -> String {
    let span = watched.study.span;
    format!(
        "{} {} to {}{}",
        watched.axis.label(),
        short_axis(watched, span.low),
        short_axis(watched, span.high),
        unit(watched.axis)
    )
}

fn short_axis(watched: &Watched, x: f64) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    if x.fract() == 0.0 && x.abs() < 1e6 {
        fixed(x, 0)
    } else {
        round(x, watched.study.span.length())
    }
}

fn unit(axis: Covariate) -> String {
    match axis.unit() {
        "" => String::new(),
        unit => format!(" {unit}"),
    }
}

fn on_axis(watched: &Watched, at: Interval) -> String {
    let ends = match (at.low_95, at.high_95) {
        (Some(low), Some(high)) => format!(" [{}, {}]", short_axis(watched, low), short_axis(watched, high)),
        (Some(low), None) => format!(" [{} or later]", short_axis(watched, low)),
        (None, Some(high)) => format!(" [{} or earlier]", short_axis(watched, high)),
        (None, None) => String::new(),
    };
    format!(
        "{} {}{ends}{}",
        watched.axis.label(),
        round(at.value, watched.study.span.length()),
        unit(watched.axis)
    )
}

fn limit_words(watched: &Watched, limit: &Limit, reaches: &Reaches) -> String {
    let number = limit.below.or(limit.above).unwrap_or(0.0);
    let side = if limit.below.is_some() { "below" } else { "above" };
    match reaches {
        Reaches::Beyond => format!("It lies {side} its limit of {}.", short(number)),
        Reaches::At(at) => format!(
            "On this trend it passes its limit of {} at {}{}.",
            short(number),
            on_axis(watched, *at),
            dated(watched, *at).unwrap_or_default()
        ),
        Reaches::Unknown(why) => format!(
            "When it passes its limit of {} cannot be told: {why}.",
            short(number)
        ),
    }
}

/// The same as dates, `, about 2027-03-14 [2027-03-02, 2027-03-30]`; none where the
/// runs do not say when they were started.
fn dated(watched: &Watched, at: Interval) -> Option<String> {
    let date = |x: f64| watched.date_at(x);
    let ends = match (at.low_95.and_then(date), at.high_95.and_then(date)) {
        (Some(low), Some(high)) => format!(" [{low}, {high}]"),
        (Some(low), None) => format!(" [{low} or later]"),
        (None, Some(high)) => format!(" [{high} or earlier]"),
        (None, None) => String::new(),
    };
    let pace = match watched.axis {
        Covariate::Age => "",
        _ => " at the pace so far",
    };
    Some(format!(", about {}{ends}{pace}", date(at.value)?))
}

/// Which values are shown at one humidity and one temperature, by what the runs of their strip tell: a sentence a strip.
pub fn brought(watched: &[Watched]) -> Vec<String> {
    let mut said: Vec<((&str, String), Vec<&str>)> = Vec::new();
    for own in watched.iter().filter(|own| !own.brought.is_empty()) {
        let to = own
            .brought
            .iter()
            .map(|(covariate, at)| format!("{}\u{a0}{}", fixed(*at, 0), covariate.unit()));
        let of = (own.sample.as_str(), in_a_row(&to.collect::<Vec<_>>()));
        let symbol = symbol(&own.parameter);
        match said.iter_mut().find(|(known, _)| *known == of) {
            Some((_, symbols)) => symbols.push(symbol),
            None => said.push((of, vec![symbol])),
        }
    }
    let sentence = |((sample, to), symbols): ((&str, String), Vec<&str>)| {
        format!(
            "{} of {sample}: values are brought to {to} by what its runs tell, so that seasons raise no alarm.",
            in_a_row(&symbols)
        )
    };
    said.into_iter().map(sentence).collect()
}

/// What of the changes over the campaign comes back with the humidity, and what stays with use: of every parameter that
/// follows either, as the study has it.
pub fn split(study: &Study) -> Vec<String> {
    let shown = study.laws().filter(|own| own.verdict == Verdict::Differs);
    let said = |own: &Answer| {
        let is_of_use = Covariate::OF_AGE
            .iter()
            .any(|age| own.covariate == Some(age.key()));
        let what = match (own.kind, own.also_changed.is_empty()) {
            (Kind::HumidityLaw, true) => "It comes back with the humidity.",
            (Kind::OtherLaw, true) if is_of_use => "It stays.",
            (Kind::HumidityLaw, false) => "Whether it comes back cannot be told.",
            (Kind::OtherLaw, false) if is_of_use => "Whether it stays cannot be told.",
            _ => return None,
        };
        Some(format!("{} {what}", study::sentence(own)))
    };
    shown.filter_map(said).collect()
}
