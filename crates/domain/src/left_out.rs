//! Readings that a person leaves out of fits, by time or by a mark of the instrument.

use super::{Channel, FlaggedStretch, Quantity};

/// Stretches of seconds as tags state them: `600-1200, 1800-2400`, or the list `[[600, 1200], [1800, 2400]]`. `None`
/// where the text is neither, or a stretch does not end after it begins.
pub fn stretches(text: &str) -> Option<Vec<(f64, f64)>> {
    let found: Vec<(f64, f64)> = if text.trim_start().starts_with('[') {
        serde_json::from_str(text).ok()?
    } else {
        text.split(',').map(stretch).collect::<Option<_>>()?
    };
    found.iter().all(|(from, to)| from < to).then_some(found)
}

/// `600-1200`; the first number may be below zero.
fn stretch(piece: &str) -> Option<(f64, f64)> {
    let piece = piece.trim();
    let after_sign = usize::from(piece.starts_with('-'));
    let middle = after_sign + piece.get(after_sign..)?.find('-')?;
    let (from, to) = (&piece[..middle], &piece[middle + 1..]);
    Some((from.trim().parse().ok()?, to.trim().parse().ok()?))
}

/// Whether a mark is one of those that a tag names, separated by commas: by its column, by its text, or by both as
/// `column=text`.
pub fn names_mark(tag: &str, mark: &FlaggedStretch) -> bool {
    tag.split(',').any(|named| names_one(named.trim(), mark))
}

fn names_one(named: &str, mark: &FlaggedStretch) -> bool {
    let (column, flag) = (mark.column.trim(), mark.flag.trim());
    let both = named
        .split_once('=')
        .is_some_and(|(of, text)| of.trim() == column && text.trim() == flag);
    both || (!named.is_empty() && (named == column || named == flag))
}

/// Leaves out the readings of every channel in stretches of seconds, their ends included.
pub fn leave_out(channels: &mut [Channel], stretches: &[(f64, f64)]) {
    for channel in channels {
        leave_out_of(channel, stretches);
    }
}

/// Leaves out the current while a mark that the tag names holds: the marks are the instrument's, and speak of what it
/// measures.
pub fn leave_out_marked(channels: &mut [Channel], tag: &str, marks: &[FlaggedStretch]) {
    let named = marks.iter().filter(|mark| names_mark(tag, mark));
    let stretches: Vec<(f64, f64)> = named.map(|mark| (mark.from_s, mark.to_s)).collect();
    for channel in channels {
        if channel.quantity == Quantity::Current {
            leave_out_of(channel, &stretches);
        }
    }
}

fn leave_out_of(channel: &mut Channel, stretches: &[(f64, f64)]) {
    if stretches.is_empty() {
        return;
    }
    let within = |time_s: f64| stretches.iter().any(|&(from, to)| (from..=to).contains(&time_s));
    let times = channel.time_s.iter().enumerate();
    let mut excluded: Vec<u32> = times
        .filter(|(_, time_s)| within(**time_s))
        .map(|(index, _)| index as u32)
        .chain(channel.excluded.iter().copied())
        .collect();
    excluded.sort_unstable();
    excluded.dedup();
    channel.excluded = excluded.into();
}

#[cfg(test)]
mod tests {
    use super::*;

    fn current() -> Channel {
        let times: Vec<f64> = (0..10).map(f64::from).collect();
        let mut channel = Channel::new(Quantity::Current, times.into(), vec![1.0; 10].into());
        channel.excluded = [9].into();
        channel
    }

    fn mark(column: &str, flag: &str) -> FlaggedStretch {
        FlaggedStretch {
            column: column.to_owned(),
            flag: flag.to_owned(),
            from_s: 2.0,
            to_s: 3.0,
            readings: 2,
            excludes: false,
        }
    }

    #[test]
    fn stretches_are_read_in_both_spellings() {
        let expected = Some(vec![(600.0, 1200.0), (1800.0, 2400.5)]);
        assert_eq!(stretches("600-1200, 1800-2400.5"), expected);
        assert_eq!(stretches("[[600, 1200], [1800.0, 2400.5]]"), expected);
        assert_eq!(stretches("-5-0"), Some(vec![(-5.0, 0.0)]));
        for wrong in ["", "600", "1200-600", "a-b", "[[1]]", "-", "5--"] {
            assert_eq!(stretches(wrong), None, "{wrong:?}");
        }
    }

    #[test]
    fn readings_within_are_added_to_those_left_out_already() {
        let mut channels = [current()];
        leave_out(&mut channels, &[(3.5, 6.0), (8.0, 20.0)]);
        assert_eq!(channels[0].excluded[..], [4, 5, 6, 8, 9]);
    }

    #[test]
    fn marks_are_named_by_column_by_text_or_by_both() {
        let overload = mark("Error", "1");
        for tag in ["Error", "1", "Error=1", "other, Error = 1"] {
            assert!(names_mark(tag, &overload), "{tag}");
        }
        for tag in ["", "Error=2", "Err", "other", ","] {
            assert!(!names_mark(tag, &overload), "{tag}");
        }
    }

    #[test]
    fn a_mark_leaves_out_the_current_and_nothing_else() {
        let times: Vec<f64> = (0..10).map(f64::from).collect();
        let curvature = Channel::new(Quantity::Curvature, times.into(), vec![1.0; 10].into());
        let mut channels = [current(), curvature];
        leave_out_marked(&mut channels, "Error", &[mark("Error", "1"), mark("Range", "1")]);
        assert_eq!(channels[0].excluded[..], [2, 3, 9]);
        assert!(channels[1].excluded.is_empty());
    }
}
