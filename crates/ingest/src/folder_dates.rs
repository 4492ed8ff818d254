//! The order of day and month that the other files of a folder show: one computer writes all of them alike.

use std::io::Read;
use std::path::Path;

use crate::text::decode;
use ieap_domain::DateOrder;
use ieap_system::fs;

/// Most files of a folder that are looked at.
const MOST_FILES: usize = 200;
/// Bytes of each that are looked at, from its beginning.
const LOOKED_AT_BYTES: u64 = 256 << 10;

/// The order that dates with the separator of `date` show in other files of `file`'s folder with its extension; none
/// where they show none, or contradict each other.
pub fn order_beside(file: &Path, date: &str) -> Option<DateOrder> {
    let mark = date.chars().find(|c| is_mark(*c))?;
    let extension = file.extension().map(|end| end.to_ascii_lowercase());
    // Files that nobody sees may contradict the others: the order is not shown then.
    let folder = file.parent()?;
    let mut others: Vec<_> = fs::entries(folder)
        .ok()?
        .into_iter()
        .map(|entry| entry.path())
        .filter(|path| path != file && path.extension().map(|end| end.to_ascii_lowercase()) == extension)
        .collect();
    others.sort();
    let mut found = None;
    for other in others.into_iter().take(MOST_FILES) {
        let mut head = Vec::new();
        let opened = fs::File::open_stated(folder, &other);
        if opened
            .and_then(|opened| opened.take(LOOKED_AT_BYTES).read_to_end(&mut head))
            .is_err()
        {
            continue;
        }
        match (found, shown(&decode(&head).text, mark)) {
            (_, None) => {}
            (None, order) => found = order,
            (Some(known), Some(order)) if known == order => {}
            _ => return None,
        }
    }
    found
}

fn is_mark(c: char) -> bool {
    matches!(c, '.' | '/' | '-')
}

/// The order that dates with that separator show: day first where a first part exceeds 12, month first where a second
/// one does; none where neither or both are so.
pub fn shown(text: &str, mark: char) -> Option<DateOrder> {
    let (mut day_first, mut month_first) = (false, false);
    let words = text.split(|c: char| !(c.is_ascii_digit() || is_mark(c)));
    for word in words {
        let parts: Vec<&str> = word.split(mark).collect();
        let [first, second, year] = parts.as_slice() else {
            continue;
        };
        let small = |part: &str| match part.len() {
            1 | 2 => part.parse::<u32>().ok(),
            _ => None,
        };
        let is_year = year.len() == 4 && year.bytes().all(|byte| byte.is_ascii_digit());
        if let (true, Some(first), Some(second)) = (is_year, small(first), small(second)) {
            day_first |= (13..=31).contains(&first) && (1..=12).contains(&second);
            month_first |= (1..=12).contains(&first) && (13..=31).contains(&second);
        }
    }
    match (day_first, month_first) {
        (true, false) => Some(DateOrder::DayFirst),
        (false, true) => Some(DateOrder::MonthFirst),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_show_their_order_where_one_part_is_no_month() {
        for (text, expected) in [
            ("02/03/2026 10:00;1", None),
            ("02/03/2026 10:00\n14/03/2026 10:00", Some(DateOrder::DayFirst)),
            ("(3/14/2026)", Some(DateOrder::MonthFirst)),
            ("14/03/2026, 3/14/2026", None),
            ("14.03.2026", None),
            ("14/03/26 1/14/2026x7", Some(DateOrder::MonthFirst)),
            ("2026/03/14 99/99/2026", None),
        ] {
            assert_eq!(shown(text, '/'), expected, "{text}");
        }
    }

    #[test]
    fn a_folder_speaks_where_its_files_agree() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
        let file = folder.path().join("a.csv");
        write("a.csv", "14/03/2026");
        write("b.csv", "02/03/2026");
        assert_eq!(order_beside(&file, "02/03/2026"), None);
        write("c.CSV", "14/03/2026");
        write("d.txt", "3/14/2026");
        assert_eq!(order_beside(&file, "02/03/2026"), Some(DateOrder::DayFirst));
        assert_eq!(order_beside(&file, "02-03-2026"), None);
        write("e.csv", "3/14/2026");
        assert_eq!(order_beside(&file, "02/03/2026"), None);
    }
}
