//! Which lines of a journal hold: a change that was cut short after its line was written came again.

use std::collections::{BTreeMap, BTreeSet};

use crate::store::journal::{Entry, Line};

/// What a line reads: a name, its revision, and the bytes.
type Read = (String, i64, String);

/// The lines that hold, in order. Where two of them read the same revision of a run or log from the same bytes, the first was
/// never stored.
pub fn that_hold(lines: &[Line]) -> Vec<&Line> {
    let mut last: BTreeMap<Read, usize> = BTreeMap::new();
    let mut never: BTreeSet<usize> = BTreeSet::new();
    for (index, line) in lines.iter().enumerate() {
        let mut reads = |name: &str, revision: i64, bytes: &str| {
            never.extend(last.insert((name.to_owned(), revision, bytes.to_owned()), index));
        };
        match &line.entry {
            Entry::Read { runs, files, .. } => {
                let bytes: Vec<&str> = files.iter().map(|file| file.hash.as_str()).collect();
                let bytes = bytes.join(" ");
                runs.iter().for_each(|run| reads(&run.name, run.revision, &bytes));
            }
            Entry::Log { file, revision } => reads(&file.path, *revision, &file.hash),
            Entry::Renamed { old, file } => rename(&mut last, &[(old, &file.path)]),
            Entry::Moved { files, runs } => {
                let logs = files.iter().map(|file| (&file.old, &file.now.path));
                let runs = runs.iter().map(|(old, new)| (old, new));
                let moved: BTreeMap<&String, &String> = logs.chain(runs).collect();
                rename(&mut last, &moved.into_iter().collect::<Vec<_>>());
            }
            _ => {}
        }
    }
    let holds = |(index, line)| (!never.contains(&index)).then_some(line);
    lines.iter().enumerate().filter_map(holds).collect()
}

/// What was read under a name is known by another from here on; the old name may come again.
fn rename(last: &mut BTreeMap<Read, usize>, names: &[(&String, &String)]) {
    let named = std::mem::take(last).into_iter();
    let renamed = named.map(|((name, revision, bytes), index)| {
        let now = names.iter().find(|(old, _)| **old == name);
        let name = now.map_or(name, |(_, new)| (*new).clone());
        ((name, revision, bytes), index)
    });
    last.extend(renamed);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::RunKind;
    use crate::store::journal::{NamedBytes, NamedRun};

    fn line(n: u64, entry: Entry) -> Line {
        let at = "2026-01-01T00:00:00Z".to_owned();
        Line {
            n,
            at,
            entry,
            of: None,
            after: None,
            text: String::new(),
        }
    }

    fn read(n: u64, name: &str, revision: i64) -> Line {
        let entry = Entry::Read {
            kind: RunKind::Actuation,
            reader: "plain-table".to_owned(),
            files: Vec::new(),
            runs: vec![NamedRun {
                name: name.to_owned(),
                revision,
                continues: true,
            }],
        };
        line(n, entry)
    }

    fn renamed(n: u64, old: &str, new: &str) -> Line {
        let (old, path) = (old.to_owned(), new.to_owned());
        let file = NamedBytes {
            path,
            hash: String::new(),
        };
        line(n, Entry::Renamed { old, file })
    }

    #[test]
    fn a_reading_that_came_again_holds_once_and_a_name_that_came_again_is_another_run() {
        let lines = [
            read(1, "a", 1),
            read(2, "a", 1),
            read(3, "a", 2),
            renamed(4, "a", "b"),
            read(5, "a", 1),
            read(6, "b", 2),
        ];
        let held: Vec<u64> = that_hold(&lines).iter().map(|line| line.n).collect();
        assert_eq!(held, [2, 4, 5, 6]);
    }
}
