//! What the tags `leave_out`, `leave_out_marked` and `open_circuit` state: read, counted, or pointed out.

use crate::domain::tag::keys;
use crate::domain::{Channel, FlaggedStretch, Issue, left_out};
use crate::ingest::tags::no_stretches;

/// The stretches of seconds that the tag `key` states; a text that is none is pointed out.
pub(super) fn stretches(key: &str, text: Option<&str>, issues: &mut Vec<Issue>) -> Vec<(f64, f64)> {
    let Some(text) = text else { return Vec::new() };
    left_out::stretches(text).unwrap_or_else(|| {
        issues.push(no_stretches(key, text));
        Vec::new()
    })
}

/// How many readings the tag `leave_out` takes from which channels.
pub(super) fn by_time(channels: &[Channel], text: Option<&str>, issues: &mut Vec<Issue>) {
    let stretches = stretches(keys::LEAVE_OUT, text, issues);
    if stretches.is_empty() {
        return;
    }
    let mut left = channels.to_vec();
    left_out::leave_out(&mut left, &stretches);
    let nothing = "no reading lies in these stretches, so nothing is left out";
    issues.push(counted(keys::LEAVE_OUT, channels, &left, nothing));
}

/// How many readings of the current the tag `leave_out_marked` takes.
pub(super) fn by_mark(
    channels: &[Channel],
    marks: &[FlaggedStretch],
    text: Option<&str>,
    issues: &mut Vec<Issue>,
) {
    let Some(text) = text else { return };
    if !marks.iter().any(|mark| left_out::names_mark(text, mark)) {
        let mut held: Vec<String> = marks
            .iter()
            .map(|mark| format!("{}={}", mark.column, mark.flag))
            .collect();
        held.sort();
        held.dedup();
        let held = if held.is_empty() {
            "its files hold no marks".to_owned()
        } else {
            format!("its marks are {}", held.join(", "))
        };
        let message = format!("`{}` names {text:?}; {held}", keys::LEAVE_OUT_MARKED);
        let mend = "write the name of a column of marks, the text of a mark, or both as column=text";
        let issue = Issue::warning("tag-unusable", message).at(keys::LEAVE_OUT_MARKED);
        issues.push(issue.mend(mend));
        return;
    }
    let mut left = channels.to_vec();
    left_out::leave_out_marked(&mut left, text, marks);
    let nothing = "every reading with that mark is left out already";
    issues.push(counted(keys::LEAVE_OUT_MARKED, channels, &left, nothing));
}

fn counted(key: &str, before: &[Channel], after: &[Channel], nothing: &str) -> Issue {
    let more = |(before, after): (&Channel, &Channel)| {
        let count = after.excluded.len() - before.excluded.len();
        (count > 0).then(|| format!("{count} of {} readings of {}", after.len(), after.raw_name))
    };
    let counts: Vec<String> = before.iter().zip(after).filter_map(more).collect();
    if counts.is_empty() {
        Issue::warning("tag-without-effect", format!("`{key}`: {nothing}")).at(key)
    } else {
        let message = format!("left out of fits by the tag `{key}`: {}", counts.join(", "));
        Issue::note("left-out-by-tag", message).at(key)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::Quantity;

    fn current() -> Vec<Channel> {
        let times: Vec<f64> = (0..10).map(f64::from).collect();
        vec![Channel::new(
            Quantity::Current,
            times.into(),
            vec![1.0; 10].into(),
        )]
    }

    fn mark() -> FlaggedStretch {
        FlaggedStretch {
            column: "Error".to_owned(),
            flag: "1".to_owned(),
            from_s: 2.0,
            to_s: 3.0,
            readings: 2,
            excludes: false,
        }
    }

    #[test]
    fn stretches_are_read_or_pointed_out() {
        let mut issues = Vec::new();
        let read = |text, issues: &mut Vec<Issue>| stretches(keys::OPEN_CIRCUIT, Some(text), issues);
        assert_eq!(read("600-1200", &mut issues), [(600.0, 1200.0)]);
        assert!(issues.is_empty());
        for wrong in ["from noon", "[[20.0, 10.0]]", "[10.0, 20.0]"] {
            assert!(read(wrong, &mut issues).is_empty());
        }
        assert_eq!(issues.len(), 3);
        assert!(issues.iter().all(|issue| issue.code == "tag-unusable"));
    }

    #[test]
    fn what_is_left_out_is_counted() {
        let mut issues = Vec::new();
        by_time(&current(), Some("2.5-6"), &mut issues);
        by_mark(&current(), &[mark()], Some("Error"), &mut issues);
        let messages: Vec<&str> = issues.iter().map(|issue| issue.message.as_str()).collect();
        assert_eq!(
            messages,
            [
                "left out of fits by the tag `leave_out`: 4 of 10 readings of current_a",
                "left out of fits by the tag `leave_out_marked`: 2 of 10 readings of current_a"
            ]
        );
    }

    #[test]
    fn a_tag_that_does_nothing_is_pointed_out() {
        let mut issues = Vec::new();
        by_time(&current(), Some("20-30"), &mut issues);
        by_mark(&current(), &[mark()], Some("Range"), &mut issues);
        by_mark(&current(), &[], Some("Range"), &mut issues);
        let codes: Vec<&str> = issues.iter().map(|issue| issue.code.as_str()).collect();
        assert_eq!(codes, ["tag-without-effect", "tag-unusable", "tag-unusable"]);
        assert!(issues[1].message.contains("its marks are Error=1"));
        assert!(issues[2].message.contains("hold no marks"));
    }
}
