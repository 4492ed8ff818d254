//! What monitoring found, in sentences.

use super::series::{Charted, Reaches, SHOWN_BELOW};
use super::{Watched, dependence_on};
use crate::analysis::false_discovery::CLAIMED_BELOW;
use crate::analysis::laws::CampaignLaws;
use crate::analysis::laws::covariate::Covariate;
use crate::analysis::laws::fitted::{AS_GOOD, Interval};
use crate::analysis::laws::words::{counted, listed, moves, round, short, symbol};
use crate::domain::Limit;

/// The life of a parameter of a sample, in a few sentences.
pub fn life(watched: &Watched) -> String {
    let what = format!("{} of {}", symbol(&watched.parameter), watched.sample);
    let n = counted(watched.series.x.len(), "run");
    let mut text = match (watched.study.trends.first(), watched.study.p_trend) {
        (Some(law), Some(p)) if p <= SHOWN_BELOW => {
            let best = watched
                .study
                .trends
                .iter()
                .map(|law| law.bic)
                .fold(f64::INFINITY, f64::min);
            let others: Vec<&str> = watched
                .study
                .trends
                .iter()
                .skip(1)
                .filter(|other| other.bic <= best + AS_GOOD)
                .map(|other| other.law.key())
                .collect();
            let as_well = match others.is_empty() {
                true => String::new(),
                false => format!(" as well as {}", others.join(", ")),
            };
            let knee = match law.bend_at {
                Some(at) if law.law == crate::analysis::laws::shape::Law::Knee => {
                    format!(" at {}", on_axis(watched, at))
                }
                _ => String::new(),
            };
            format!(
                "{what} {} over {} {}{knee}{as_well} (p = {}, {n}).",
                moves(law.size, watched.series.is_log),
                span(watched),
                law.law.key(),
                short(p)
            )
        }
        (_, Some(p)) => format!(
            "{what} shows no trend over {} (p = {}, {n}).",
            span(watched),
            short(p)
        ),
        (_, None) => format!("{what}: {n}, too few for a trend."),
    };
    text += &jumps(watched);
    if let Some(change) = &watched.study.change {
        text += &format!(
            " Its level changed {} at {} beside the trend (p = {}).",
            by(change.size, watched.series.is_log),
            on_axis(watched, change.at),
            short(change.p)
        );
    }
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

fn jumps(watched: &Watched) -> String {
    let mut text = String::new();
    for step in &watched.study.steps {
        let at = watched.series.x[step.at];
        let why = match step.is_stated {
            true => "where the instrument or its calibration changed",
            false => "from one run to the next",
        };
        text += &format!(
            " It jumps {} at {} {}, {why}: that is left out of the trend and of the charts.",
            by(step.size, watched.series.is_log),
            watched.axis.label(),
            short_axis(watched, at)
        );
    }
    text
}

fn by(size: f64, is_log: bool) -> String {
    match (is_log, size >= 0.0) {
        (true, true) => format!("up by a factor of {}", short(size.exp())),
        (true, false) => format!("down by a factor of {}", short((-size).exp())),
        (false, _) => format!("by {}", short(size)),
    }
}

fn span(watched: &Watched) -> String {
    let span = watched.study.span;
    format!(
        "{} {} to {}{},",
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
    match x.fract() == 0.0 && x.abs() < 1e6 {
        true => format!("{x:.0}"),
        false => round(x, watched.study.span.length()),
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
            "On this trend it passes its limit of {} at {}.",
            short(number),
            on_axis(watched, *at)
        ),
        Reaches::Unknown(why) => format!(
            "When it passes its limit of {} cannot be told: {why}.",
            short(number)
        ),
    }
}

/// A chart's alarm.
pub(super) fn chart_alarm(watched: &Watched, charted: &Charted, false_alarm: f64) -> String {
    let first = charted.first_alarm.unwrap_or(0);
    let statistic = charted
        .statistic
        .iter()
        .find(|(place, _)| *place == first)
        .map_or(0.0, |(_, x)| *x);
    format!(
        "{} of {} left control in the reference condition: the {} chart is at {} beyond {} (a false alarm every {:.0} reference runs on average).",
        symbol(&watched.parameter),
        watched.sample,
        match charted.chart.key() {
            "shewhart" => "Shewhart",
            "ewma" => "EWMA",
            _ => "CUSUM",
        },
        short(statistic),
        short(charted.limit),
        false_alarm
    )
}

/// A limit's alarm.
pub(super) fn limit_alarm(watched: &Watched, limit: &Limit) -> String {
    let number = limit.below.or(limit.above).unwrap_or(0.0);
    let side = if limit.below.is_some() { "below" } else { "above" };
    format!(
        "{} of {} lies {side} its limit of {} with its whole 95 % interval.",
        symbol(&watched.parameter),
        watched.sample,
        short(number)
    )
}

/// What of the changes over the campaign comes back with the humidity, and what is age, where a design allows to say.
pub fn split(laws: &CampaignLaws) -> Vec<String> {
    let mut sentences = Vec::new();
    for found in laws
        .claimed()
        .filter(|found| found.covariate.effect() == Some("degradation"))
    {
        let what = format!("{} of {}", symbol(&found.parameter), found.material);
        if found.confounded_with.contains(&Covariate::RelativeHumidity) {
            sentences.push(format!(
                "{what}: ageing and humidity cannot be told apart, for {} changed together.",
                listed(&[Covariate::RelativeHumidity, found.covariate])
            ));
            continue;
        }
        let Some(change) = found.change() else { continue };
        let age = format!(
            "with age ({}) it {}",
            found.covariate.label(),
            moves(change, found.is_log)
        );
        let humidity = dependence_on(laws, found, "humidity-dependence");
        sentences.push(match humidity.and_then(|one| Some((one, one.change()?))) {
            Some((one, change)) if one.q <= CLAIMED_BELOW => format!(
                "{what}: {age} and stays so; with humidity it {} and comes back.",
                moves(change, one.is_log)
            ),
            Some(_) => format!("{what}: {age}; a part that follows humidity is not shown."),
            None => format!("{what}: {age}; humidity did not change enough to say what follows it."),
        });
    }
    sentences
}
