//! Tables of the page of monitoring.

use ieap_show::{Quantity, Sheet, Table, Value};

use super::forecasts::{Dates, Forecast};
use super::words::StepText;
use super::{Watched, words};
use crate::laws::words::symbol;
use ieap_domain::Campaign;

const PARAMETER: Quantity = Quantity::plain("parameter", "Parameter", "parameter");

/// When every limit is reached.
pub fn limits(forecasts: Vec<Forecast>) -> Table {
    Sheet::<Forecast>::new("limits", "When limits are reached", 2)
        .column(PARAMETER, |one| one.what.clone())
        .column(Quantity::plain("limit", "Limit", "limit"), |one| {
            one.limit.clone()
        })
        .column(
            Quantity::plain("reached", "Reached", "when the limit is reached"),
            |one| one.when.clone(),
        )
        .column(
            Quantity::plain("interval", "95\u{202f}% interval", "95 % interval"),
            |one| one.interval.clone(),
        )
        .over(forecasts)
}

/// Every step and jump of the watched parameters.
pub fn steps(watched: &[Watched], dates: &Dates) -> Table {
    type Row<'w> = (&'w Watched, StepText);
    let of_one = |own| words::steps(own).into_iter().map(move |step| (own, step));
    Sheet::<Row>::new("steps", "Steps and jumps", 2)
        .column(PARAMETER, |(own, _)| {
            format!("{} of {}", symbol(&own.parameter), own.sample)
        })
        .column(
            Quantity::plain("when", "When", "where on the life of the sample"),
            |(own, step)| dates.moment(own, step.at),
        )
        .column(Quantity::plain("size", "How far", "size"), |(_, step)| {
            step.size.clone()
        })
        .column(
            Quantity::plain("what", "What it is", "what it is"),
            |(_, step)| step.what.clone(),
        )
        .over(watched.iter().flat_map(of_one))
}

/// The control charts of a sample in numbers.
pub fn charts(watched: &[Watched], dates: &Dates, campaign: &Campaign) -> Table {
    Sheet::<&Watched>::new("charts", "Control charts in numbers", 1)
        .column(PARAMETER, |own| symbol(&own.parameter))
        .column(
            Quantity::plain("now", "Now", "weighted average now, standard deviations"),
            |own| {
                own.study
                    .chart
                    .statistic
                    .last()
                    .map(|(_, now)| Value::Rough(*now, 2))
            },
        )
        .column(
            Quantity::plain("limit", "Limit", "alarm limit, standard deviations"),
            |own| Value::Rough(own.study.chart.limit, 3),
        )
        .column(Quantity::plain("state", "State", "state"), |own| {
            match own.study.chart.first_alarm {
                Some(at) => format!("alarm since {}", dates.run_and_day(own.runs[at], campaign)),
                None => "in control".to_owned(),
            }
        })
        .over(watched)
}
