//! The course of an electrode's resistance in sentences.

use super::{Course, DAY_S};
use crate::laws::words::{moves, short};
use crate::monitoring::shape::Law;
use crate::study::factor;
use ieap_domain::number::fixed;
use ieap_domain::words::counted;

/// What the readings of a sample say, the clearest first.
pub fn life(course: &Course) -> String {
    let (study, sample) = (&course.study, &course.series.sample);
    let readings = counted(course.series.readings.len(), "reading");
    let days = study.span.length();
    let mut text = match (study.trends.first(), study.p_trend) {
        (Some(law), Some(p)) if study.is_shown() && law.law != Law::Step => format!(
            "R_e of {sample} {} over {} days, {} (p = {}, {readings}).",
            moves(law.size, true),
            fixed(days, 0),
            law.law.key(),
            short(p)
        ),
        (Some(_), Some(p)) if study.is_shown() => {
            format!(
                "R_e of {sample} changes in one step (p = {}, {readings}).",
                short(p)
            )
        }
        (_, Some(p)) => format!(
            "R_e of {sample} shows no trend over {} days (p = {}, {readings}).",
            fixed(days, 0),
            short(p)
        ),
        (_, None) => format!("R_e of {sample}: {readings}, too few for a trend or a crack."),
    };
    for sentence in cracks(course) {
        text += &format!(" {sentence}");
    }
    if course
        .series
        .readings
        .iter()
        .all(|reading| reading.error_ohm_per_sq.is_none())
    {
        text += " No reading has a standard error: state one, or measure several times on a day.";
    }
    text
}

/// A sentence for each crack.
pub fn cracks(course: &Course) -> Vec<String> {
    let readings = &course.series.readings;
    let flexed = |at: usize| match readings[at].flexings {
        Some(count) => format!(", by {} flexings", fixed(count, 0)),
        None => String::new(),
    };
    let sentence = |&(at, size): &(usize, f64)| {
        format!(
            "A crack: it {} between {} and {}{}.",
            factor(size.exp(), None, None),
            date(readings[at - 1].at_s),
            date(readings[at].at_s),
            flexed(at)
        )
    };
    course
        .cracks
        .iter()
        .filter(|(at, _)| *at > 0)
        .map(sentence)
        .collect()
}

/// The day of a moment, UTC.
fn date(at_s: f64) -> String {
    let moment = jiff::Timestamp::from_second((at_s / DAY_S).floor() as i64 * DAY_S as i64);
    moment.map_or_else(
        |_| String::new(),
        |moment| moment.strftime("%Y-%m-%d").to_string(),
    )
}
