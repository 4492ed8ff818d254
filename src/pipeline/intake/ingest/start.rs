//! The start that a file states: where its date leaves the order of day and month open, campaign.toml or the other
//! files of the folder decide.

use std::path::Path;

use jiff::SignedDuration;
use jiff::civil::DateTime;

use crate::domain::number::fixed;
use crate::domain::tag::keys;
use crate::domain::{Channel, DateOrder, Issue, RunClock, RunOrigin, Timestamp};
use crate::ingest::folder_dates::order_beside;
use crate::ingest::formats::date::{DATE_UNCERTAIN, uncertain};
use crate::ingest::formats::stamp;
use crate::ingest::{Reading, StartedAt};

/// The start that the files of a run state: any of them serves all. Of a file that states its end, its length is taken off.
pub fn of_run(origin: &RunOrigin, channels: &[Channel]) -> Option<StartedAt> {
    let stamp = |clock: &RunClock| clock.stamp.clone();
    let is_start =
        |stamp: &StartedAt| stamp.kind == Timestamp::Start && (stamp.local.is_some() || is_open(stamp));
    let stated = origin.clocks.iter().filter_map(stamp).find(is_start);
    let from_end = || {
        origin.clocks.iter().find_map(|clock| {
            let stamp = clock
                .stamp
                .as_ref()
                .filter(|stamp| stamp.kind == Timestamp::End)?;
            let of_clock = channels.iter().skip(clock.first_channel).take(clock.channels);
            let last_s = of_clock
                .filter_map(|channel| channel.time_s.last().copied())
                .reduce(f64::max)?;
            before_end(stamp, last_s)
        })
    };
    let any = || origin.clocks.iter().find_map(stamp);
    stated.or_else(from_end).or_else(any)
}

/// The start of a record that ended then, `last_s` after its zero.
fn before_end(stamp: &StartedAt, last_s: f64) -> Option<StartedAt> {
    let end: DateTime = stamp.moment()?.parse().ok()?;
    let length = SignedDuration::try_from_secs_f64(last_s).ok()?;
    Some(StartedAt {
        kind: Timestamp::Start,
        local: Some(end.checked_sub(length).ok()?.to_string()),
        basis: format!(
            "{}, less the {} s that the record lasts",
            stamp.basis,
            fixed(last_s, 1)
        ),
        ..stamp.clone()
    })
}

/// Whether day, month and year of a start may stand in several orders.
pub fn is_open(started: &StartedAt) -> bool {
    let reads = |order: &DateOrder| stamp::civil(&started.raw, *order).is_some();
    started.local.is_none() && DateOrder::ALL.iter().filter(|order| reads(order)).count() > 1
}

/// The start with its date read in the order that campaign.toml states, else in the one that the files beside `file`
/// show; an issue where neither speaks.
pub fn settled(started: &StartedAt, stated: Option<DateOrder>, file: &Path) -> (StartedAt, Option<Issue>) {
    if !is_open(started) {
        return (started.clone(), None);
    }
    let said = stated.map(|order| (order, "as campaign.toml states (date_order)"));
    let shown = || {
        Some((
            order_beside(file, &started.raw)?,
            "as other files of the folder show",
        ))
    };
    let Some((order, reason)) = said.or_else(shown) else {
        return (
            started.clone(),
            Some(uncertain(&started.raw, &started.basis).at(keys::STARTED_AT)),
        );
    };
    let settled = StartedAt {
        local: stamp::civil(&started.raw, order).map(|local| local.to_string()),
        basis: format!("{}, {reason}", order.words()),
        ..started.clone()
    };
    (settled, None)
}

/// The issues of a reading without the one of an open date, which is said of the run's tags.
pub fn without_open_dates(reading: &Reading) -> impl Iterator<Item = Issue> + '_ {
    let is_open = reading.started_at.as_ref().is_some_and(is_open);
    let issues = reading.issues.iter();
    issues
        .filter(move |issue| !is_open || issue.code != DATE_UNCERTAIN)
        .cloned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::Timestamp;

    #[test]
    fn an_open_date_is_settled_by_campaign_toml_then_by_the_folder() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.dta");
        let open = StartedAt {
            raw: "3/10/2019 12:00:00".to_owned(),
            kind: Timestamp::Start,
            local: None,
            offset: None,
            basis: "day and month may stand in either order".to_owned(),
        };
        let (same, issue) = settled(&open, None, &file);
        assert_eq!((same.local, issue.unwrap().code.as_str()), (None, DATE_UNCERTAIN));
        let (stated, issue) = settled(&open, Some(DateOrder::DayFirst), &file);
        assert_eq!(
            (stated.local.as_deref(), issue),
            (Some("2019-10-03T12:00:00"), None)
        );
        std::fs::write(folder.path().join("b.dta"), "DATE\t3/14/2019\n").unwrap();
        let (shown, issue) = settled(&open, None, &file);
        assert_eq!(
            (shown.local.as_deref(), issue),
            (Some("2019-03-10T12:00:00"), None)
        );
        assert!(shown.basis.contains("folder"), "{}", shown.basis);
        let no_date = StartedAt {
            raw: "soon".to_owned(),
            ..open
        };
        assert_eq!(
            settled(&no_date, Some(DateOrder::DayFirst), &file),
            (no_date, None)
        );
    }

    #[test]
    fn a_day_is_no_moment_from_which_a_start_could_be_reckoned() {
        let of = |local: &str| StartedAt {
            raw: local.into(),
            kind: Timestamp::End,
            local: Some(local.into()),
            offset: None,
            basis: "year first".into(),
        };
        assert_eq!(before_end(&of("2024-07-17"), 10.0), None);
        assert!(before_end(&of("2024-07-17T10:00:00"), 10.0).is_some());
    }
}
