//! Full dates in lines above a table, wherever they stand in a line and whatever word stands before them.

use super::kind::{Kind, kind};
use super::order::orders;
use crate::text::dictionary::NO_STARTS;

/// A full date above a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Dated<'l> {
    /// Index of its line.
    pub line: usize,
    /// What stands before it in its line.
    pub label: &'l str,
    /// The date with its time of day.
    pub date: String,
}

/// Most pieces of a line that are one date with its time: `Jun. 3, 2026 10:21:05 a. m.`.
const MOST_PIECES: usize = 7;

/// The full dates of lines, one a line at most; a date and a time of day in two pieces or in two lines are one.
pub fn dated<'l>(lines: &[&'l str]) -> Vec<Dated<'l>> {
    let mut found = Vec::new();
    for (line, text) in lines.iter().enumerate() {
        let pieces = pieces(text);
        let whole = whole(&pieces).or_else(|| in_two(&pieces, &pieces));
        let below = || {
            lines
                .get(line + 1)
                .and_then(|next| in_two(&pieces, &self::pieces(next)))
        };
        if let Some((at, date)) = whole.or_else(below) {
            let label = text[..pieces[at].0].trim();
            found.push(Dated { line, label, date });
        }
    }
    found
}

/// Whether a word of a label says that its date is no start: that of an export, of a calibration, of an end.
pub fn says_no_start(label: &str) -> bool {
    let lower = label.to_lowercase();
    NO_STARTS.split(';').any(|word| lower.contains(word))
}

/// The pieces of a line between blanks and delimiters, each with its place, without the letters before a digit.
fn pieces(text: &str) -> Vec<(usize, &str)> {
    let is_mark = |c: char| c.is_whitespace() || matches!(c, ',' | ';' | '"' | '|' | '=');
    let place = |piece: &str| piece.as_ptr() as usize - text.as_ptr() as usize;
    let pieces = text.split(is_mark).filter(|piece| !piece.is_empty());
    let bare = |piece: &'_ str| {
        let is_joined = piece.contains(|c: char| c > '\u{2e80}' || c == ':')
            && piece.contains(|c: char| c.is_ascii_digit());
        let start = piece
            .find(|c: char| c.is_ascii_digit())
            .filter(|_| is_joined)
            .unwrap_or(0);
        place(piece) + start
    };
    pieces
        .map(|piece| {
            let from = bare(piece);
            (from, &text[from..place(piece) + piece.len()])
        })
        .collect()
}

/// The longest run of pieces that is a date with a time of day, and where it begins.
fn whole(pieces: &[(usize, &str)]) -> Option<(usize, String)> {
    // Blocks of numbers above a table hold none and are told soonest.
    if pieces.len() > 64 {
        return None;
    }
    (0..pieces.len()).find_map(|at| {
        let most = (at + MOST_PIECES).min(pieces.len());
        (at + 1..=most).rev().find_map(|end| {
            let words: Vec<&str> = pieces[at..end].iter().map(|(_, piece)| *piece).collect();
            let date = words.join(" ");
            (kind(&date) == Kind::Moment && !orders(&date).is_empty()).then_some((at, date))
        })
    })
}

/// A date among some pieces and a time of day among others.
fn in_two(dates: &[(usize, &str)], clocks: &[(usize, &str)]) -> Option<(usize, String)> {
    let at = dates.iter().position(|(_, piece)| kind(piece) == Kind::Date)?;
    let mut times = (0..clocks.len()).filter(|at| kind(clocks[*at].1) == Kind::Clock);
    let clock = times.next().filter(|_| times.next().is_none())?;
    let half = clocks.get(clock + 1).map(|(_, half)| *half);
    let half = half.filter(|half| ["am", "pm"].contains(&half.replace('.', "").to_lowercase().as_str()));
    let clock = [Some(clocks[clock].1), half]
        .into_iter()
        .flatten()
        .collect::<Vec<_>>()
        .join(" ");
    let date = format!("{} {clock}", dates[at].1);
    (!orders(&date).is_empty()).then_some((at, date))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_date_is_found_behind_any_word() {
        for (lines, expected) in [
            (
                &["测量开始日期时间 2026/06/03 10:21:05"][..],
                Some("2026/06/03 10:21:05"),
            ),
            (
                &["测量开始日期时间:2026/06/03 10:21:05"],
                Some("2026/06/03 10:21:05"),
            ),
            (&["Run;12;Messung vom;03.06.2026 10:21"], Some("03.06.2026 10:21")),
            (
                &["開始2026年6月3日 10時21分05秒"],
                Some("2026年6月3日 10時21分05秒"),
            ),
            (
                &["Datum\t2026-06-03\tUhrzeit\t10:21:05"],
                Some("2026-06-03 10:21:05"),
            ),
            (
                &["날짜: 2026-06-03", "시각: 10:21:05"],
                Some("2026-06-03 10:21:05"),
            ),
            (&["Opened 3/19/2026, at: 2:00 pm"], Some("3/19/2026 2:00 pm")),
            (&["Jun. 3, 2026   10:21:05"], Some("Jun. 3 2026 10:21:05")),
            (&["Version 1.2.3 of 2026", "Channels 1 2 3", "Rate 10:1"], None),
        ] {
            let found = dated(lines);
            assert_eq!(
                found.first().map(|found| found.date.as_str()),
                expected,
                "{lines:?}"
            );
        }
    }
}
