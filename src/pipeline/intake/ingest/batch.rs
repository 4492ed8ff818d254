//! Reads, archives and stores files in batches, which wait for the disk together: a file alone waits five times.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::prepare::{Group, Outcome, Prepared, PreparedFile, With, prepare};
use crate::ingest::archive::{Archive, Incoming, Outcome as Stored};
use crate::ingest::being_read::BeingRead;
use crate::numerics::interrupt;
use crate::pipeline::{Context, Observer, PipelineError};
use crate::store::Store;

/// Most files of a batch, but for one group that has more.
pub const MOST_FILES: usize = 128;
/// A batch ends where its files come to this many bytes, so that memory does not grow with their number.
const MOST_BYTES: u64 = 16 << 20;

/// Stores what was read of a group, and says so.
pub type Settle<'a> = dyn FnMut(&mut Context, Prepared, &dyn Observer) -> Result<(), PipelineError> + 'a;

/// Reads all groups and hands each to `settle`, in order, after its raw bytes are safe in the archive. What `settle`
/// stores and says counts when its batch is on the disk; where it fails, what came before is kept. Gives the raw files
/// that the archive had lost, or held with other bytes, and that are whole again.
///
/// # Errors
/// The archive or the database refuses, or what `settle` says.
pub fn in_batches(
    context: &mut Context,
    groups: &[Group],
    observer: &dyn Observer,
    settle: &mut Settle<'_>,
) -> Result<Vec<String>, PipelineError> {
    let mut mended = Vec::new();
    let archive = Archive::new(&context.folder);
    let being_read = BeingRead::of(&context.folder);
    for batch in batches(groups, rayon::current_num_threads()) {
        interrupt::check();
        let with = With {
            folder: &context.folder,
            profiles: &context.profiles,
            campaign: &context.campaign,
            read_file: context.read_file,
        };
        let mut prepared = prepared(with, &being_read, batch);
        for path in archive_all(&archive, &context.store, &mut prepared)? {
            observer.warn(&format!("{path} was lost or damaged; it is whole again"));
            mended.push(path);
        }
        let held = Held::new(observer);
        together(context, |context| {
            let mut groups = prepared.into_iter();
            groups.try_for_each(|prepared| settle(context, prepared, &held))
        })?;
        held.release();
        batch.iter().for_each(|_| observer.advance());
    }
    Ok(mended)
}

/// Reads the groups of a batch, beside one another; those with a file during which the program died are read alone after them.
fn prepared(with: With<'_>, being_read: &BeingRead, batch: &[Group]) -> Vec<Prepared> {
    let is_suspect = |group: &Group| group.files.iter().any(|file| being_read.is_suspect(file));
    let read = |group: &Group| prepare(with, being_read, group);
    let beside: Vec<Option<Prepared>> = batch
        .par_iter()
        .map(|group| (!is_suspect(group)).then(|| read(group)))
        .collect();
    let all = batch.iter().zip(beside);
    all.map(|(group, prepared)| prepared.unwrap_or_else(|| read(group)))
        .collect()
}

/// Does `work`, whose changes of the database wait for the disk together. Where it fails, what it changed before is
/// kept.
///
/// # Errors
/// What `work` says, or the database refuses.
pub fn together(
    context: &mut Context,
    work: impl FnOnce(&mut Context) -> Result<(), PipelineError>,
) -> Result<(), PipelineError> {
    context.store.begin_batch()?;
    let outcome = work(context);
    let committed = context.store.commit_batch();
    outcome?;
    Ok(committed?)
}

/// Groups in batches of bounded size, at least one group for each of the `threads`.
fn batches(groups: &[Group], threads: usize) -> impl Iterator<Item = &[Group]> {
    let mut rest = groups;
    std::iter::from_fn(move || {
        let (mut files, mut bytes) = (0, 0);
        let fits = |&(index, group): &(usize, &Group)| {
            files += group.files.len();
            bytes += group.files.iter().map(|file| file.size_bytes).sum::<u64>();
            index == 0 || files <= MOST_FILES && (bytes <= MOST_BYTES || index < threads)
        };
        let count = rest.iter().enumerate().take_while(fits).count();
        let (batch, after) = rest.split_at(count);
        rest = after;
        (!batch.is_empty()).then_some(batch)
    })
}

/// Archives the bytes of every file that was read, and lets go of all bytes. Gives the paths of those that the database
/// named before and the archive did not hold as they were.
fn archive_all(
    archive: &Archive,
    store: &Store,
    prepared: &mut [Prepared],
) -> Result<Vec<String>, PipelineError> {
    let files = prepared.iter().flat_map(|group| &group.files);
    let incoming: Vec<Incoming<'_>> = files.filter_map(incoming).collect();
    let stored = archive.store_all(&incoming)?;
    let mut mended = Vec::new();
    for (archived, outcome) in &stored {
        let was_lost = match outcome {
            Stored::AlreadyThere => false,
            Stored::Repaired => true,
            Stored::Written => store.names_content(Some(&archived.hash))?,
        };
        if was_lost {
            mended.push(archived.path.clone());
        }
    }
    let mut stored = stored.into_iter().map(|(archived, _)| archived);
    for file in prepared.iter_mut().flat_map(|group| &mut group.files) {
        if was_read(file) {
            file.archived = stored.next();
        }
        file.bytes = Vec::new();
    }
    Ok(mended)
}

fn was_read(file: &PreparedFile) -> bool {
    file.hash.is_some() && matches!(file.outcome, Outcome::Read(_))
}

fn incoming(file: &PreparedFile) -> Option<Incoming<'_>> {
    Some(Incoming {
        hash: file.hash.as_deref().filter(|_| was_read(file))?,
        bytes: &file.bytes,
        name: &file.file.relative,
    })
}

/// Holds the messages of a batch back until it is on the disk; of progress it hears nothing.
struct Held<'a> {
    observer: &'a dyn Observer,
    said: Mutex<Vec<String>>,
}

impl<'a> Held<'a> {
    fn new(observer: &'a dyn Observer) -> Held<'a> {
        Held {
            observer,
            said: Mutex::default(),
        }
    }

    fn release(self) {
        let said = self.said.into_inner().unwrap_or_else(PoisonError::into_inner);
        said.iter().for_each(|text| self.observer.say(text));
    }
}

impl Observer for Held<'_> {
    fn begin(&self, _step: &str, _total: u64) {}
    fn advance(&self) {}
    fn reach(&self, _done: u64) {}
    fn end(&self) {}

    fn say(&self, text: &str) {
        let mut said = self.said.lock().unwrap_or_else(PoisonError::into_inner);
        said.push(text.to_owned());
    }

    fn warn(&self, text: &str) {
        self.observer.warn(text);
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::domain::RunKind;
    use crate::ingest::scan::SeenFile;

    fn group(sizes: &[u64]) -> Group {
        let file = |&size_bytes: &u64| SeenFile {
            relative: PathBuf::from("runs/a.csv"),
            display: "runs/a.csv".to_owned(),
            size_bytes,
            modified_ns: 0,
            inode: 0,
            changed_ns: 0,
            age: None,
            link_target: None,
        };
        Group {
            run_name: "runs/a.csv".to_owned(),
            kind: RunKind::Actuation,
            files: sizes.iter().map(file).map(Into::into).collect(),
        }
    }

    fn sizes(groups: &[Group]) -> Vec<usize> {
        batches(groups, 2).map(<[Group]>::len).collect()
    }

    #[test]
    fn batches_are_bounded_in_files_and_bytes_and_leave_nothing_out() {
        assert_eq!(sizes(&[]), Vec::<usize>::new());
        assert_eq!(sizes(&vec![group(&[10]); 300]), [128, 128, 44]);
        assert_eq!(sizes(&vec![group(&[10, 10, 10]); 100]), [42, 42, 16]);
        assert_eq!(sizes(&vec![group(&[MOST_BYTES / 4]); 9]), [4, 4, 1]);
        // Large files still give every thread something to read.
        assert_eq!(sizes(&vec![group(&[1 << 30]); 5]), [2, 2, 1]);
        assert_eq!(sizes(&[group(&[1; 200]), group(&[1])]), [1, 1]);
    }

    #[test]
    fn messages_are_told_when_they_are_true() {
        struct Heard(Mutex<Vec<String>>);
        impl Observer for Heard {
            fn begin(&self, _step: &str, _total: u64) {}
            fn advance(&self) {}
            fn reach(&self, _done: u64) {}
            fn end(&self) {}
            fn say(&self, text: &str) {
                self.0.lock().unwrap().push(text.to_owned());
            }
            fn warn(&self, text: &str) {
                self.0.lock().unwrap().push(text.to_owned());
            }
        }
        let heard = Heard(Mutex::default());
        let held = Held::new(&heard);
        held.say("read a");
        held.warn("no room");
        assert_eq!(*heard.0.lock().unwrap(), ["no room"]);
        held.release();
        assert_eq!(*heard.0.lock().unwrap(), ["no room", "read a"]);
    }
}
