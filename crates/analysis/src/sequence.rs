//! Numbered files whose dates do not follow their numbers: runs that look like one series and are not.

use std::borrow::Borrow;
use std::collections::BTreeMap;

use crate::zone::order_s;
use ieap_domain::tag::keys;
use ieap_domain::{Issue, RunRecord};

/// A start this much before that of the run named before it breaks the series, s: one day. Clocks that are
/// set, and runs repeated the same day, stay below.
const BREAK_S: i64 = 86_400;

/// Runs that carry on the numbers of a series but not its dates.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Break {
    /// Indices of the runs, in order of their numbers.
    pub runs: Vec<usize>,
    /// Index of the run named before the first of them.
    pub after: usize,
    /// Whole days by which they start earlier than that run.
    pub days_back: i64,
    /// Whether they come from another instrument than that run.
    pub other_instrument: bool,
}

/// Finds the breaks. A series is runs in one folder whose names differ in their last number only.
pub fn breaks<R: Borrow<RunRecord>>(runs: &[R]) -> Vec<Break> {
    let mut series: BTreeMap<String, Vec<(u64, usize)>> = BTreeMap::new();
    for (index, run) in runs.iter().enumerate() {
        if let Some((name, number)) = numbered(&run.borrow().path) {
            series.entry(name).or_default().push((number, index));
        }
    }
    let mut found = Vec::new();
    for members in series.values_mut() {
        members.sort_unstable();
        let dated: Vec<(usize, i64)> = members
            .iter()
            .filter_map(|&(_, index)| Some((index, start_s(runs[index].borrow())?)))
            .collect();
        found.extend(breaks_of(runs, &dated));
    }
    found
}

/// Adds the issue of each break to the runs that it is about, but for those that a person said are right.
pub fn annotate(runs: &mut [RunRecord]) {
    for found in breaks(runs) {
        let issue = found.issue(runs);
        for &index in &found.runs {
            if !runs[index].standing.is_vouched() {
                runs[index].issues.push(issue.clone());
            }
        }
    }
}

fn breaks_of<R: Borrow<RunRecord>>(runs: &[R], dated: &[(usize, i64)]) -> Vec<Break> {
    let mut found: Vec<Break> = Vec::new();
    let mut previous: Option<(usize, i64)> = None;
    for &(index, at) in dated {
        // The series goes on from the last run before the break, not from inside it.
        match previous {
            Some((after, before)) if at < before - BREAK_S => {
                let continues = found.last_mut().filter(|open| open.after == after);
                match continues {
                    Some(open) => open.runs.push(index),
                    None => found.push(Break {
                        runs: vec![index],
                        after,
                        days_back: (before - at) / 86_400,
                        other_instrument: other_instrument(runs[index].borrow(), runs[after].borrow()),
                    }),
                }
            }
            _ => previous = Some((index, at)),
        }
    }
    found
}

fn other_instrument(one: &RunRecord, other: &RunRecord) -> bool {
    let (one, other) = (one.tag(keys::INSTRUMENT), other.tag(keys::INSTRUMENT));
    one.is_some() && other.is_some() && one != other
}

/// The name without its last number, and the number.
fn numbered(path: &str) -> Option<(String, u64)> {
    let stem_end = path
        .rfind('.')
        .filter(|dot| !path[*dot..].contains('/'))
        .unwrap_or(path.len());
    let (stem, extension) = path.split_at(stem_end);
    let end = stem.rfind(|c: char| c.is_ascii_digit())? + 1;
    let start = stem[..end]
        .rfind(|c: char| !c.is_ascii_digit())
        .map_or(0, |at| at + 1);
    // A number with a decimal point is a value, such as a voltage, and does not count runs.
    if stem[..start].ends_with(['.', '-'])
        && stem[..start].len() > 1
        && stem[..start - 1].ends_with(|c: char| c.is_ascii_digit())
    {
        return None;
    }
    let number = stem[start..end].parse().ok()?;
    Some((format!("{}*{}{extension}", &stem[..start], &stem[end..]), number))
}

fn start_s(run: &RunRecord) -> Option<i64> {
    order_s(run.tag(keys::STARTED_AT)?).map(|seconds| seconds as i64)
}

impl Break {
    /// What a reader must know of it, in words.
    pub fn issue<R: Borrow<RunRecord>>(&self, runs: &[R]) -> Issue {
        let path = |index: usize| runs[index].borrow().path.as_str();
        let date = |index: usize| {
            let start = runs[index].borrow().tag(keys::STARTED_AT).unwrap_or_default();
            start.split('T').next().unwrap_or_default().to_owned()
        };
        let (first, last) = (self.runs[0], self.runs[self.runs.len() - 1]);
        let who = match self.runs.len() {
            1 => path(first).to_owned(),
            count => format!("{count} runs, {} to {},", path(first), path(last)),
        };
        let instrument = if self.other_instrument {
            " and on another instrument"
        } else {
            ""
        };
        let verb = if self.runs.len() == 1 {
            "continues"
        } else {
            "continue"
        };
        let message = format!(
            "{who} {verb} the numbers of {} but started on {}, {} days before it ({}){instrument}: not the same series",
            path(self.after),
            date(first),
            self.days_back,
            date(self.after),
        );
        Issue::warning("series-broken", message)
            .at(keys::STARTED_AT)
            .mend("keep other days in a folder of their own, or correct started_at")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::testing;
    use ieap_domain::{Tag, TagSource};

    fn run(path: &str, started_at: &str, instrument: &str) -> RunRecord {
        let mut run = testing::run(path, "S", "air", None, 1.0);
        run.path = path.to_owned();
        for (key, value) in [(keys::STARTED_AT, started_at), (keys::INSTRUMENT, instrument)] {
            run.tags.retain(|tag| tag.key != key);
            run.tags.push(Tag {
                key: key.into(),
                value: value.into(),
                source: TagSource::Header,
                detail: String::new(),
            });
        }
        run
    }

    #[test]
    fn earlier_dates_under_later_numbers_are_one_break() {
        let mut runs: Vec<RunRecord> = (1..=12)
            .map(|n| {
                run(
                    &format!("runs/p_n{n}.DTA"),
                    &format!("2024-07-17T10:{:02}:00Z", 10 + n),
                    "A",
                )
            })
            .collect();
        runs.extend((13..=15).map(|n| {
            run(
                &format!("runs/p_n{n}.DTA"),
                &format!("2024-02-13T09:{n}:00Z"),
                "B",
            )
        }));
        // As the store lists them: n1, n10, n11, ...
        runs.sort_by(|a, b| a.path.cmp(&b.path));
        let found = breaks(&runs);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].runs.len(), 3);
        assert_eq!(runs[found[0].after].path, "runs/p_n12.DTA");
        assert!(found[0].other_instrument);
        let message = found[0].issue(&runs).message;
        assert!(
            message.contains("2024-02-13") && message.contains("155 days"),
            "{message}"
        );
    }

    #[test]
    fn voltages_in_names_and_later_dates_are_no_break() {
        let runs = [
            run("runs/a_1.2V.csv", "2024-07-17T10:00:00Z", "A"),
            run("runs/a_2.0V.csv", "2024-07-01T10:00:00Z", "A"),
            run("runs/b_1.csv", "2024-07-17T10:00:00Z", "A"),
            run("runs/b_2.csv", "2025-07-17T10:00:00Z", "A"),
        ];
        assert!(breaks(&runs).is_empty());
    }
}
