//! A time axis of dates by a clock, from hours to years.

use jiff::{Timestamp, ToSpan, Zoned};

use super::axis::{Axis, Scale, Tick};
use ieap_analysis::zone::Zone;

/// Steps between ticks, with the format of their labels: (hours, days, months).
const STEPS: [((i64, i64, i64), &str); 12] = [
    ((1, 0, 0), "%H:%M"),
    ((3, 0, 0), "%H:%M"),
    ((6, 0, 0), "%d %b %H:%M"),
    ((12, 0, 0), "%d %b %H:%M"),
    ((0, 1, 0), "%d %b"),
    ((0, 2, 0), "%d %b"),
    ((0, 7, 0), "%d %b %Y"),
    ((0, 14, 0), "%d %b %Y"),
    ((0, 0, 1), "%b %Y"),
    ((0, 0, 3), "%b %Y"),
    ((0, 0, 6), "%b %Y"),
    ((0, 0, 12), "%Y"),
];

/// An axis from `low_s` to `high_s` (s since 1970 UTC) with about `wanted` ticks at most, by the clock of `zone`.
pub fn calendar_axis(low_s: f64, high_s: f64, wanted: usize, zone: &Zone) -> Axis {
    let (low_s, high_s) = if high_s > low_s {
        (low_s, high_s)
    } else {
        (low_s - 1800.0, low_s + 1800.0)
    };
    let length_s = |(hours, days, months): (i64, i64, i64)| {
        3600.0 * (hours + 24 * days) as f64 + 2_629_800.0 * months as f64
    };
    let fits = |step: &&((i64, i64, i64), &str)| (high_s - low_s) / length_s(step.0) <= wanted as f64;
    let (step, format) = STEPS.iter().find(fits).unwrap_or(&STEPS[STEPS.len() - 1]);
    // What the labels leave out of the date stands in the title.
    let from = match (format.contains("%Y"), format.contains("%d")) {
        (true, _) => "",
        (false, true) => "%Y",
        (false, false) => "%d %b %Y",
    };
    let from = moment(low_s, zone).map_or_else(String::new, |low| low.strftime(from).to_string());
    Axis {
        scale: Scale::Calendar,
        low: low_s,
        high: high_s,
        ticks: ticks((low_s, high_s), *step, format, zone),
        title: if from.is_empty() {
            format!("Time ({})", zone.name())
        } else {
            format!("Time ({}), from {from}", zone.name())
        },
        shown_factor: 1.0,
    }
}

fn moment(at_s: f64, zone: &Zone) -> Option<Zoned> {
    Some(
        Timestamp::from_second(at_s as i64)
            .ok()?
            .to_zoned(zone.zone().clone()),
    )
}

fn ticks(
    (low_s, high_s): (f64, f64),
    (hours, days, months): (i64, i64, i64),
    format: &str,
    zone: &Zone,
) -> Vec<Tick> {
    let Some(low) = moment(low_s, zone) else {
        return Vec::new();
    };
    // Months start on their first day, days at midnight.
    let start = match (months, days) {
        (0, 0) => low.start_of_day(),
        (0, _) => low.start_of_day(),
        _ => low.first_of_month().and_then(|first| first.start_of_day()),
    };
    let span = hours.hours().days(days).months(months);
    let mut ticks = Vec::new();
    let mut at = start
        .ok()
        .filter(|_| months < 12)
        .or_else(|| low.first_of_year().ok()?.start_of_day().ok());
    while let Some(tick) = at {
        let position = tick.timestamp().as_second() as f64;
        if position > high_s || ticks.len() > 60 {
            break;
        }
        if position >= low_s {
            ticks.push(Tick {
                at: position,
                label: tick.strftime(format).to_string(),
            });
        }
        at = tick.checked_add(span).ok();
    }
    ticks
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(from: &str, to: &str) -> (usize, String, String) {
        let seconds = |text: &str| text.parse::<Timestamp>().unwrap().as_second() as f64;
        let axis = calendar_axis(seconds(from), seconds(to), 7, &Zone::utc());
        let first = axis
            .ticks
            .first()
            .map_or_else(String::new, |tick| tick.label.clone());
        (axis.ticks.len(), first, axis.title)
    }

    #[test]
    fn spans_from_hours_to_decades_have_a_few_dates() {
        for (from, to, first) in [
            ("2026-03-01T10:10:00Z", "2026-03-01T15:00:00Z", "11:00"),
            ("2026-03-01T10:00:00Z", "2026-03-05T10:00:00Z", "02 Mar"),
            ("2026-02-01T10:00:00Z", "2026-03-01T10:00:00Z", "08 Feb 2026"),
            ("2025-11-20T10:00:00Z", "2026-05-01T10:00:00Z", "Dec 2025"),
            ("2000-05-25T10:00:00Z", "2026-05-01T10:00:00Z", "2001"),
        ] {
            let (count, label, title) = axis(from, to);
            assert!((2..=30).contains(&count), "{from}: {count}");
            assert_eq!(label, first, "{title}");
        }
        assert!(!calendar_axis(0.0, 0.0, 7, &Zone::utc()).ticks.is_empty());
    }
}
