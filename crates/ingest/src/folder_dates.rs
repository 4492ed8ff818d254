//! The order of day and month that the other files of a folder show: one computer writes all of them alike.

use std::collections::BTreeSet;
use std::io::Read;
use std::path::Path;

use crate::formats::stamp;
use crate::text::decode;
use ieap_domain::DateOrder;
use ieap_system::fs;

/// Most files of a folder that are looked at.
const MOST_FILES: usize = 200;
/// How many times closer together dates must lie in one order than in any other. Chosen: consecutive days are months apart where day
/// and month are exchanged.
const CLOSER_BY: f64 = 10.0;
/// Bytes of each that are looked at, from its beginning.
const LOOKED_AT_BYTES: u64 = 256 << 10;

/// The order that dates with the separator of `date` show in other files of `file`'s folder with its extension: the one in which
/// all of them are dates and, where several are, lie close together; none where they show none.
pub fn order_beside(file: &Path, date: &str) -> Option<DateOrder> {
    let mark = date.chars().find(|c| is_mark(*c))?;
    let extension = file.extension().map(|end| end.to_ascii_lowercase());
    // Files that nobody sees may contradict the others: the order is not shown then.
    let folder = file.parent()?;
    let mut others: Vec<_> = fs::entries(folder)
        .ok()?
        .into_iter()
        .map(|entry| entry.path())
        .filter(|path| path.extension().map(|end| end.to_ascii_lowercase()) == extension)
        .collect();
    others.sort();
    let mut found = BTreeSet::new();
    for other in others.into_iter().take(MOST_FILES) {
        let mut head = Vec::new();
        let opened = fs::File::open_stated(folder, &other);
        let read = opened.and_then(|opened| opened.take(LOOKED_AT_BYTES).read_to_end(&mut head));
        if read.is_ok() {
            found.extend(dates(&decode(&head).text, mark));
        }
    }
    order_of(&found)
}

fn is_mark(c: char) -> bool {
    matches!(c, '.' | '/' | '-')
}

/// The parts of a date in the order of the text, each with its digits.
type Parts = [(u32, usize); 3];

/// The dates in a text with that mark between their parts, whose year is the last part or has two digits.
fn dates(text: &str, mark: char) -> BTreeSet<Parts> {
    let mut found = BTreeSet::new();
    let mut rest = text;
    while let Some(start) = rest.find(|c: char| c.is_ascii_digit()) {
        rest = &rest[start..];
        let end = rest
            .find(|c: char| !(c.is_ascii_digit() || is_mark(c)))
            .unwrap_or(rest.len());
        let (word, behind) = rest.split_at(end);
        rest = behind;
        let parts: Option<Vec<(u32, usize)>> = (word.split(mark))
            .map(|part| Some((part.parse().ok()?, part.len())))
            .collect();
        let Some(&[first, second, third]) = parts.as_deref() else {
            continue;
        };
        // Three short numbers may be anything, but where a time of day stands behind them.
        let is_year = third.1 == 4 || (third.1 == 2 && has_clock(behind));
        if is_year && first.1 <= 2 && second.1 <= 2 {
            found.insert([first, second, third]);
        }
    }
    found
}

fn has_clock(text: &str) -> bool {
    let text = text.trim_start_matches([' ', '\t', ',', ';', 'T', '"']);
    let hour = text.bytes().take_while(u8::is_ascii_digit).count();
    (1..=2).contains(&hour) && text[hour..].starts_with(':')
}

/// The one order in which all dates are dates; of several the one in which they lie closest together by far.
fn order_of(dates: &BTreeSet<Parts>) -> Option<DateOrder> {
    let span_days = |order: DateOrder| -> Option<f64> {
        let day = |parts: &Parts| {
            let [a, b, c] = parts;
            let text = format!("{:02}/{:02}/{:0width$} 12:00", a.0, b.0, c.0, width = c.1);
            stamp::civil(&text, order)
        };
        let days: Option<Vec<_>> = dates.iter().map(day).collect();
        let days = days.filter(|days| !days.is_empty())?;
        let (first, last) = (days.iter().min()?, days.iter().max()?);
        Some(last.duration_since(*first).as_secs_f64() / 86_400.0)
    };
    let mut spans: Vec<(f64, DateOrder)> = (DateOrder::ALL.into_iter())
        .filter_map(|order| Some((span_days(order)?, order)))
        .collect();
    spans.sort_by(|a, b| a.0.total_cmp(&b.0));
    match spans.as_slice() {
        [(_, only)] => Some(*only),
        [(least, order), (next, _), ..] if *next > CLOSER_BY * (least + 1.0) => Some(*order),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_show_their_order_where_one_part_is_no_month_or_they_lie_close_together() {
        for (text, expected) in [
            ("02/03/2026 10:00;1", None),
            ("02/03/2026 10:00\n14/03/2026 10:00", Some(DateOrder::DayFirst)),
            ("(3/14/2026)", Some(DateOrder::MonthFirst)),
            ("14/03/2026, 3/14/2026", None),
            ("14.03.2026", None),
            ("2026/03/14 99/99/2026", None),
            ("03/11/2026 23:55\n03/12/2026 00:10", Some(DateOrder::MonthFirst)),
            ("11/03/26 23:55\n12/03/26 00:10", Some(DateOrder::DayFirst)),
            ("26/03/11 10:00", None),
            ("1/2/3 of 4", None),
        ] {
            assert_eq!(order_of(&dates(text, '/')), expected, "{text}");
        }
    }

    #[test]
    fn a_folder_speaks_where_its_files_agree() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
        let file = folder.path().join("a.csv");
        write("a.csv", "14/03/2026");
        write("b.csv", "02/03/2026");
        assert_eq!(order_beside(&file, "02-03-2026"), None);
        write("c.CSV", "14/03/2026");
        write("d.txt", "3/14/2026");
        assert_eq!(order_beside(&file, "02/03/2026"), Some(DateOrder::DayFirst));
        assert_eq!(order_beside(&file, "02-03-2026"), None);
        write("e.csv", "3/14/2026");
        assert_eq!(order_beside(&file, "02/03/2026"), None);
    }
}
