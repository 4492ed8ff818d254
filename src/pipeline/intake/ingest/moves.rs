//! Names: files that lie under other names than at the last look, renamed, swapped, shifted or in a chain, are found by their
//! bytes; all of a look at once, and before anything is read. So the state of a campaign does not depend on how often it was
//! looked at, and new bytes under an old name are another measurement while the old ones lie elsewhere.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use rayon::prelude::*;

use super::groups::{is_named_as_copy, run_name};
use super::prepare::LARGEST_FILE_BYTES;
use super::rows::file_row;
use crate::domain::FileState;
use crate::ingest::archive;
use crate::ingest::scan::{Changes, Scan, SeenFile};
use crate::pipeline::campaign::context::now;
use crate::pipeline::{Context, Observer, PipelineError};
use crate::store::{FileRow, HeldFile, Moves};

/// Names runs, or logs, after the files that hold their bytes now; `stored` and `changes` are of the files of the scan, and
/// `held` what current runs or logs were read from. Gives the names before and now, and those of them that another measurement
/// had, whose bytes lie nowhere any more.
///
/// # Errors
/// The database refuses.
pub fn settle(
    context: &mut Context,
    (held, state): (&[HeldFile], FileState),
    (stored, seen, changes): (&[FileRow], &Scan, &Changes),
    observer: &dyn Observer,
) -> Result<Renamed, PipelineError> {
    let folder = Folder::of(context, stored, seen, changes);
    let moved = folder.moved(held, observer);
    let moves = named(held, &moved, |old, new, hash| folder.row(state, old, new, hash));
    if !moves.files.is_empty() {
        let renamed = moves.runs.iter().filter(|(old, new)| old != new);
        renamed.for_each(|(old, new)| observer.say(&format!("{old} is {new} now")));
        context.store.move_files(&now(), &moves)?;
    }
    let olds: BTreeSet<&String> = moves.runs.iter().map(|(old, _)| old).collect();
    let runs: BTreeSet<&String> = held.iter().map(|file| &file.run).collect();
    let is_replaced = |new: &&String| runs.contains(new) && !olds.contains(new);
    let news = moves.runs.iter().map(|(_, new)| new);
    let replaced: Vec<String> = news.filter(is_replaced).cloned().collect();
    for name in &replaced {
        observer.say(&format!("what was {name} before is kept in the archive alone"));
    }
    let is_moved = !moves.files.is_empty();
    let mut names = moves.runs;
    names.retain(|(old, new)| old != new);
    Ok(Renamed {
        is_moved,
        names,
        replaced,
    })
}

/// What became of names.
#[derive(Debug, Default)]
pub struct Renamed {
    /// Whether any file has another name.
    pub is_moved: bool,
    /// Names of runs or logs before and now.
    pub names: Vec<(String, String)>,
    /// Names that another measurement had.
    pub replaced: Vec<String>,
}

/// What lies in the folder.
struct Folder<'a> {
    context: &'a Context,
    stored: BTreeMap<&'a str, &'a FileRow>,
    seen: BTreeMap<&'a str, &'a Arc<SeenFile>>,
    /// Files that are not as they are stored.
    fresh: BTreeSet<&'a str>,
    /// Stored files of folders that cannot be looked into.
    out_of_sight: BTreeSet<&'a str>,
}

/// Bytes that are known by their hash, by path; none of a file that cannot be read now.
type Hashes<'a> = BTreeMap<&'a str, Option<String>>;

impl<'a> Folder<'a> {
    fn of(context: &'a Context, stored: &'a [FileRow], seen: &'a Scan, changes: &'a Changes) -> Folder<'a> {
        let fresh = changes.new.iter().chain(&changes.changed);
        Folder {
            context,
            stored: stored.iter().map(|row| (row.path.as_str(), row)).collect(),
            seen: seen
                .files
                .iter()
                .map(|file| (file.display.as_str(), file))
                .collect(),
            fresh: fresh.map(|file| file.display.as_str()).collect(),
            out_of_sight: changes.out_of_sight.iter().map(String::as_str).collect(),
        }
    }

    /// Where each file of a run lies now that does not lie where it lay: path before and path now.
    fn moved(&self, held: &[HeldFile], observer: &dyn Observer) -> BTreeMap<String, String> {
        let may_have_moved: Vec<&HeldFile> = held
            .iter()
            .filter(|held| self.is_certainly_there(held) != Some(true))
            .collect();
        if may_have_moved.is_empty() {
            return BTreeMap::new();
        }
        let hashes = self.hashes(&may_have_moved);
        let is_there = |held: &HeldFile| match self.is_certainly_there(held) {
            Some(is_there) => is_there,
            // What cannot be read now says nothing.
            None => {
                let hash = hashes.get(held.path.as_str()).and_then(Option::as_ref);
                hash.is_none_or(|hash| *hash == held.hash)
            }
        };
        let (there, away): (Vec<&HeldFile>, Vec<&HeldFile>) = held.iter().partition(|held| is_there(held));
        let taken: BTreeSet<&str> = there.iter().map(|held| held.path.as_str()).collect();
        let away: BTreeMap<&str, &str> = away
            .into_iter()
            .map(|held| (held.path.as_str(), held.hash.as_str()))
            .filter(|(path, _)| !taken.contains(path))
            .collect();
        let mut free: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        for (path, hash) in hashes.iter().filter(|(path, _)| !taken.contains(*path)) {
            if let Some(hash) = hash {
                free.entry(hash).or_default().push(path);
            }
        }
        let mut moved = BTreeMap::new();
        for (hash, mut paths) in free {
            // As where a folder is looked at for the first time: a copy comes after what it is of.
            paths.sort_by_key(|path| (is_named_as_copy(path), *path));
            let kind = |path: &str| self.context.campaign.kind_of(path);
            let mut of_bytes: Vec<&str> = away
                .iter()
                .filter(|(_, own)| **own == hash)
                .map(|(path, _)| *path)
                .collect();
            for path in paths {
                if let Some(at) = of_bytes.iter().position(|old| kind(old) == kind(path)) {
                    moved.insert(of_bytes.remove(at).to_owned(), path.to_owned());
                } else if let Some((old, first)) = moved
                    .iter()
                    .find(|(old, _)| away.get(old.as_str()) == Some(&hash))
                {
                    observer.warn(&format!(
                        "{old} lies under two other names, {first} and {path}: its run is named {first}; remove the other, or tag \
                         the run where they state different things"
                    ));
                }
            }
        }
        moved
    }

    /// Whether a file lies where it lay, with its bytes; none where only its bytes tell.
    fn is_certainly_there(&self, held: &HeldFile) -> Option<bool> {
        let path = held.path.as_str();
        let Some(file) = self.seen.get(path) else {
            return Some(self.out_of_sight.contains(path));
        };
        if self.is_folder(file) {
            return Some(true);
        }
        if self.fresh.contains(path) {
            return (file.size_bytes != held.size_bytes).then_some(false);
        }
        let hash = self.stored.get(path).and_then(|row| row.hash.as_deref());
        Some(hash.is_none_or(|hash| hash == held.hash))
    }

    /// A folder of frames is told by its pictures, which is no quick look.
    fn is_folder(&self, file: &SeenFile) -> bool {
        self.fresh.contains(file.display.as_str()) && file.location(&self.context.folder).is_dir()
    }

    /// The bytes of all files that may be one of these, those that are not as they are stored read for it.
    fn hashes(&self, wanted: &[&HeldFile]) -> Hashes<'a> {
        let sizes: BTreeSet<u64> = wanted.iter().map(|held| held.size_bytes).collect();
        let bytes: BTreeSet<&str> = wanted.iter().map(|held| held.hash.as_str()).collect();
        let (fresh, known): (Vec<_>, Vec<_>) = (self.seen.iter().map(|(path, file)| (*path, *file)))
            .partition(|(path, _)| self.fresh.contains(path));
        let stored = known.into_iter().filter_map(|(path, _)| {
            let hash = self.stored.get(path)?.hash.as_ref()?;
            bytes.contains(hash.as_str()).then(|| (path, Some(hash.clone())))
        });
        let may_be =
            |(_, file): &(&str, &Arc<SeenFile>)| sizes.contains(&file.size_bytes) && !self.is_folder(file);
        let to_read: Vec<_> = fresh.into_iter().filter(may_be).collect();
        let (folder, read_file) = (&self.context.folder, self.context.read_file);
        let read = to_read.into_par_iter().map(|(path, file)| {
            let bytes = read_file(&file.location(folder), LARGEST_FILE_BYTES);
            (path, bytes.ok().map(|bytes| archive::hash(&bytes)))
        });
        let mut hashes: Hashes<'a> = read.collect();
        hashes.extend(stored);
        hashes
    }

    /// What is known of the file at `new`, which holds what lay at `old`.
    fn row(&self, state: FileState, old: &str, new: &str, hash: &str) -> Option<FileRow> {
        let reader = self
            .stored
            .get(old)
            .filter(|row| row.hash.as_deref() == Some(hash));
        let reader = reader.map_or_else(String::new, |row| row.reader.clone());
        Some(file_row(
            self.seen.get(new)?,
            Some(hash.to_owned()),
            state,
            reader,
            None,
        ))
    }
}

/// The runs of files that moved with their names now: the one of their file, or of the stem that their files share. A run of
/// which the files lie under names that do not belong together is left to who pairs files.
fn named(
    held: &[HeldFile],
    moved: &BTreeMap<String, String>,
    row: impl Fn(&str, &str, &str) -> Option<FileRow>,
) -> Moves {
    let mut runs: BTreeMap<&str, Vec<&HeldFile>> = BTreeMap::new();
    for file in held {
        runs.entry(&file.run).or_default().push(file);
    }
    let mut moves = Moves::default();
    for (run, files) in runs {
        let now = |file: &HeldFile| moved.get(&file.path).unwrap_or(&file.path).clone();
        if !files.iter().any(|file| moved.contains_key(&file.path)) {
            continue;
        }
        let Some(name) = name_now(run, &files, now) else {
            continue;
        };
        for file in files.iter().filter(|file| moved.contains_key(&file.path)) {
            let new = now(file);
            if let Some(row) = row(&file.path, &new, &file.hash) {
                moves.files.insert(file.path.clone(), row);
            }
        }
        moves.runs.push((run.to_owned(), name));
    }
    moves
}

fn name_now(run: &str, files: &[&HeldFile], now: impl Fn(&HeldFile) -> String) -> Option<String> {
    if let Some(table) = files
        .first()
        .and_then(|first| run.strip_prefix(first.path.as_str()))
    {
        return Some(now(files[0]) + table);
    }
    let mut stems = files.iter().map(|file| run_name(&now(file)));
    let stem = stems.next()?;
    stems.all(|other| other == stem).then_some(stem)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(held: &[(&str, &str)], moved: &[(&str, &str)]) -> Vec<(String, String)> {
        let file = |(run, path): &(&str, &str)| HeldFile {
            run: (*run).to_owned(),
            path: (*path).to_owned(),
            hash: String::new(),
            size_bytes: 0,
        };
        let held: Vec<HeldFile> = held.iter().map(file).collect();
        let moved = moved
            .iter()
            .map(|(old, new)| ((*old).to_owned(), (*new).to_owned()));
        named(&held, &moved.collect(), |_, _, _| None).runs
    }

    #[test]
    fn runs_are_named_after_their_files_and_tables_and_stems() {
        let held = [
            ("r/a.csv", "r/a.csv"),
            ("r/b.xlsx#One", "r/b.xlsx"),
            ("r/b.xlsx#Two", "r/b.xlsx"),
            ("r/c.csv", "r/c.current.csv"),
            ("r/c.csv", "r/c.curvature.csv"),
        ];
        let pair = |old: &str, new: &str| (old.to_owned(), new.to_owned());
        assert_eq!(
            names(&held, &[("r/a.csv", "q/z.csv")]),
            [pair("r/a.csv", "q/z.csv")]
        );
        let tables = [
            pair("r/b.xlsx#One", "r/d.xlsx#One"),
            pair("r/b.xlsx#Two", "r/d.xlsx#Two"),
        ];
        assert_eq!(names(&held, &[("r/b.xlsx", "r/d.xlsx")]), tables);
        let half = ("r/c.current.csv", "r/d.current.csv");
        assert_eq!(names(&held, &[half]), []);
        assert_eq!(
            names(&held, &[half, ("r/c.curvature.csv", "r/d.curvature.csv")]),
            [pair("r/c.csv", "r/d.csv")]
        );
    }
}
