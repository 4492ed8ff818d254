//! The sentences of an alarm, made from its numbers.

use super::Watched;
use super::words::{place, subject};
use crate::laws::words::{ends, moves, round, short, symbol};
use crate::monitoring::fitted::Interval;
use crate::zone::Zone;
use ieap_domain::number::fixed;
use ieap_domain::words::in_a_row;
use ieap_domain::{Alarm, AlarmSign};

/// What an alarm says: what is shown, since when, by how much it moved, and how sure that is.
pub(super) fn message(alarm: &Alarm, first: &Watched, zone: &Zone) -> String {
    let symbols: Vec<&str> = alarm
        .shown_by
        .iter()
        .map(|sign| symbol(&sign.parameter))
        .collect();
    let (who, several) = (in_a_row(&symbols), symbols.len() > 1);
    let sample = &alarm.sample;
    let what = match alarm.chart.as_str() {
        "limit" => beyond(alarm, first),
        "jump" => format!(
            "{who} of {sample} {} from one run to the next, and no change of the instrument is stated: the chart begins \
             anew after it.",
            if several { "jump" } else { "jumps" }
        ),
        _ => format!(
            "{who} of {sample} left control in the reference condition with {}.",
            alarm.run
        ),
    };
    let began = &alarm.began;
    let day = began
        .started_at
        .as_ref()
        .map(|start| format!(", {}", zone.day(start)));
    let changes: Vec<String> = alarm.shown_by.iter().filter_map(changed).collect();
    let changes = if changes.is_empty() {
        String::new()
    } else {
        format!(": {}", changes.join("; "))
    };
    let by_chance = alarm.false_alarm_runs.map(|runs| {
        let runs = fixed(runs, 0);
        format!(" One such alarm is expected by chance in {runs} reference runs of a sample.")
    });
    format!(
        "{what} It began with {} ({}{}){changes}.{}",
        began.run,
        place(first, began.at),
        day.unwrap_or_default(),
        by_chance.unwrap_or_default()
    )
}

/// `α of S1 lies below its limit of 12 with its whole 95 % interval: 10.2 [9.8, 10.6].`
fn beyond(alarm: &Alarm, watched: &Watched) -> String {
    let limit = watched.limit.as_ref().map(|(limit, _)| limit);
    let number = limit.and_then(|limit| limit.below.or(limit.above));
    let side = match limit.and_then(|limit| limit.below) {
        Some(_) => "below",
        None => "above",
    };
    let reading = alarm.shown_by[0].reading.as_ref();
    let reading = reading.and_then(|one| Some((one.value?, one.low_95?, one.high_95?)));
    let reading = reading.map(|(value, low, high)| {
        let ends = ends(Some(low), Some(high), |x| x);
        format!(": {}{ends}", round(value, 2.0 * (high - low)))
    });
    format!(
        "{} lies {side} its limit of {} with its whole 95\u{202f}% interval{}.",
        subject(watched),
        short(number.unwrap_or(0.0)),
        reading.unwrap_or_default()
    )
}

/// `R₁ falls by 7.3 % (6.1 to 8.5 %) (p = 2.1·10⁻⁹)`: the mean since a change against the mean before.
fn changed(sign: &AlarmSign) -> Option<String> {
    let change = sign.change.as_ref()?;
    let (value, low, high) = (change.value?, change.low_95?, change.high_95?);
    let scaled = |x: f64| if sign.is_ratio { x.ln() } else { x };
    let change = Interval {
        value: scaled(value),
        low_95: Some(scaled(low)),
        high_95: Some(scaled(high)),
    };
    let how = moves(change, sign.is_ratio);
    let p = sign.p.map(|p| format!(" (p = {})", short(p)));
    Some(format!(
        "{} {how}{}",
        symbol(&sign.parameter),
        p.unwrap_or_default()
    ))
}
