//! Long-term monitoring: one row a parameter of a sample that is watched.

use super::TableInput;
use crate::json_rows::list;
use crate::monitoring::fitted::Interval;
use crate::monitoring::{Monitoring, Watched, series::Reaches, words};
use ieap_show::{Made, Rough, Sheet};

/// Digits of a number that people read.
const DIGITS: i32 = 3;

/// Makes the table.
pub fn make<M: Made>(input: &TableInput) -> M {
    let none = Monitoring::default();
    let monitoring = input.monitoring.unwrap_or(&none);
    let trend = |own: &Watched| (own.study.trends.first().copied()).filter(|_| own.study.is_shown());
    // The size of a law of logarithms is that of a ratio.
    let size = |own: &Watched, of: fn(&Interval) -> Option<f64>| {
        let size = of(&trend(own)?.size)?;
        Some(if own.series.is_log { size.exp() } else { size })
    };
    Sheet::<&Watched>::new("monitoring", "Parameters over the life of the samples", 4)
        .plain("material", |own| own.material.as_str())
        .plain("sample", |own| own.sample.as_str())
        .plain("parameter", |own| own.parameter.as_str())
        .plain("axis", |own| own.axis.key())
        .plain("runs", |own| own.runs.len())
        .plain("changes", |own| own.study.is_shown())
        .plain("p_trend", |own| rough(own.study.p_trend))
        .plain("law", |own| Some(trend(own)?.law.key()))
        .plain("change", |own| rough(size(own, |of| Some(of.value))))
        .plain("change_low_95", |own| rough(size(own, |of| of.low_95)))
        .plain("change_high_95", |own| rough(size(own, |of| of.high_95)))
        .in_files(|sheet| sheet.plain("is_ratio", |own| own.series.is_log))
        .plain("alarms", |own| list(&alarms(own, monitoring), ", "))
        .plain("limit_reached_at", |own| {
            rough(match &own.limit.as_ref()?.1 {
                Reaches::At(at) => Some(at.value),
                Reaches::Beyond => own.series.x.last().copied(),
                Reaches::Unknown(_) => None,
            })
        })
        .plain("sentence", |own| words::life(own))
        .made(&monitoring.watched)
}

fn rough(number: Option<f64>) -> Option<Rough> {
    number.map(|number| Rough(number, DIGITS))
}

/// Charts that raised an alarm on it.
fn alarms(own: &Watched, monitoring: &Monitoring) -> Vec<String> {
    let of_sample = monitoring
        .alarms
        .iter()
        .filter(|alarm| alarm.sample == own.sample);
    let charts = of_sample.flat_map(|alarm| {
        let signs = alarm.shown_by.iter().map(|sign| (&sign.parameter, &sign.chart));
        let first = (&alarm.parameter, &alarm.chart);
        signs.chain(alarm.shown_by.is_empty().then_some(first))
    });
    charts
        .filter(|(parameter, _)| **parameter == own.parameter)
        .map(|(_, chart)| chart.clone())
        .collect()
}
