//! What is new, changed or gone between what is stored and what a scan saw.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

use super::fingerprint::{changed_ns, identity, modified_ns};
use super::{Scan, SeenFile, parse_display_path};
use ieap_system::fs;

/// A file as it is stored from the scan before.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Known<'a> {
    /// Path as text, [`super::display_path`].
    pub display: &'a str,
    /// Size, bytes.
    pub size_bytes: u64,
    /// Modification time, ns since 1970.
    pub modified_ns: i64,
    /// Inode; 0 where it is not known, and then not compared.
    pub inode: u64,
    /// Time of the last change of anything of the file, ns since 1970; 0 where it is not known, and then not compared.
    pub changed_ns: i64,
    /// Whether an earlier scan already found it gone.
    pub missing: bool,
}

/// The difference between what is stored and what a scan saw, each list in the order of the paths.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Changes {
    /// Seen for the first time.
    pub new: Vec<Arc<SeenFile>>,
    /// Other size, time or inode than stored, or back after it was gone: read it again.
    pub changed: Vec<Arc<SeenFile>>,
    /// As stored.
    pub unchanged: Vec<Arc<SeenFile>>,
    /// Stored, not marked missing, and not seen any more.
    pub gone: Vec<String>,
    /// Stored and not seen, but their folder could not be looked into: nothing is known of them.
    pub out_of_sight: Vec<String>,
}

/// Compares what is stored with what a scan saw.
pub fn diff(known: &[Known<'_>], seen: &Scan) -> Changes {
    let stored: BTreeMap<&str, &Known<'_>> = known.iter().map(|file| (file.display, file)).collect();
    let present: BTreeSet<&str> = seen.files.iter().map(|file| file.display.as_str()).collect();
    let mut changes = Changes::default();
    for file in &seen.files {
        let list = match stored.get(file.display.as_str()) {
            None => &mut changes.new,
            Some(known) if known.missing || differs(known, file) => &mut changes.changed,
            Some(_) => &mut changes.unchanged,
        };
        list.push(Arc::clone(file));
    }
    for (display, known) in stored {
        if known.missing || present.contains(display) {
            continue;
        }
        let list = if is_below(display, &seen.unreadable) {
            &mut changes.out_of_sight
        } else {
            &mut changes.gone
        };
        list.push(display.to_owned());
    }
    changes
}

fn differs(known: &Known<'_>, seen: &SeenFile) -> bool {
    let other_inode = known.inode != 0 && seen.inode != 0 && known.inode != seen.inode;
    let other_change = known.changed_ns != 0 && seen.changed_ns != 0 && known.changed_ns != seen.changed_ns;
    known.size_bytes != seen.size_bytes
        || known.modified_ns != seen.modified_ns
        || other_inode
        || other_change
}

/// Whether the file that lies under a name now is not the one that is stored, or cannot be looked at; not, where none lies there.
pub fn is_another(campaign: &Path, known: &Known<'_>) -> bool {
    let relative = parse_display_path(known.display);
    let found = match fs::metadata(campaign.join(&relative)) {
        Ok(found) => found,
        Err(error) => return error.kind() != std::io::ErrorKind::NotFound,
    };
    let seen = SeenFile {
        relative,
        display: known.display.to_owned(),
        size_bytes: found.len(),
        modified_ns: modified_ns(&found),
        inode: identity(&found).1,
        changed_ns: changed_ns(&found),
        age: None,
        link_target: None,
    };
    // A folder of frames has a fingerprint of all its pictures.
    found.is_file() && differs(known, &seen)
}

fn is_below(display: &str, folders: &[String]) -> bool {
    folders.iter().any(|folder| {
        let rest = display.strip_prefix(folder.as_str());
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn known(display: &str, size_bytes: u64, modified_ns: i64, inode: u64, missing: bool) -> Known<'_> {
        Known {
            display,
            size_bytes,
            modified_ns,
            inode,
            changed_ns: 0,
            missing,
        }
    }

    fn seen(display: &str, size_bytes: u64, modified_ns: i64, inode: u64) -> SeenFile {
        SeenFile {
            relative: display.into(),
            display: display.to_owned(),
            size_bytes,
            modified_ns,
            inode,
            changed_ns: 0,
            age: None,
            link_target: None,
        }
    }

    /// Which list the one file goes to.
    fn list(known: Option<Known<'_>>, seen: Option<SeenFile>, unreadable: &[&str]) -> &'static str {
        let scan = Scan {
            files: seen.into_iter().map(Arc::new).collect(),
            unreadable: unreadable.iter().map(|folder| (*folder).to_owned()).collect(),
            ..Scan::default()
        };
        let changes = diff(known.as_slice(), &scan);
        let lengths = [
            (changes.new.len(), "new"),
            (changes.changed.len(), "changed"),
            (changes.unchanged.len(), "unchanged"),
            (changes.gone.len(), "gone"),
            (changes.out_of_sight.len(), "out of sight"),
        ];
        let filled: Vec<&str> = lengths
            .iter()
            .filter(|(n, _)| *n > 0)
            .map(|(_, name)| *name)
            .collect();
        assert!(filled.len() <= 1, "{changes:?}");
        filled.first().copied().unwrap_or("nothing")
    }

    #[test]
    fn each_case_goes_to_its_list() {
        let stored = || Some(known("runs/a/x.csv", 10, 100, 7, false));
        let lost = || Some(known("runs/a/x.csv", 10, 100, 7, true));
        let file = |size, time, inode| Some(seen("runs/a/x.csv", size, time, inode));
        for (before, now, unreadable, expected) in [
            (None, file(10, 100, 7), &[][..], "new"),
            (stored(), file(10, 100, 7), &[], "unchanged"),
            (stored(), file(11, 100, 7), &[], "changed"),
            (stored(), file(10, 99, 7), &[], "changed"), // a copy that keeps an older time
            (stored(), file(10, 101, 7), &[], "changed"), // within the same second
            (stored(), file(10, 100, 8), &[], "changed"), // replaced by rename
            (stored(), file(10, 100, 0), &[], "unchanged"), // the file system gives no inode
            (stored(), None, &[], "gone"),
            (stored(), None, &["runs/a"], "out of sight"),
            (stored(), None, &["runs/a/x.csv"], "out of sight"),
            (stored(), None, &["runs/a/x"], "gone"),
            (stored(), None, &["run"], "gone"),
            (lost(), None, &[], "nothing"),
            (lost(), file(10, 100, 7), &[], "changed"),
        ] {
            assert_eq!(
                list(before.clone(), now.clone(), unreadable),
                expected,
                "{before:?} {now:?} {unreadable:?}"
            );
        }
    }

    /// As `cp -p`, `touch -r` or a program that puts the time back leaves a file.
    #[test]
    fn a_change_that_left_size_time_and_inode_alone_is_seen_where_both_tell_its_time() {
        for (stored_ns, seen_ns, expected) in [
            (5, 5, "unchanged"),
            (5, 6, "changed"),
            (0, 6, "unchanged"), // stored before such times were
            (5, 0, "unchanged"), // the file system gives none
        ] {
            let stored = Known {
                changed_ns: stored_ns,
                ..known("runs/a", 10, 100, 7, false)
            };
            let now = SeenFile {
                changed_ns: seen_ns,
                ..seen("runs/a", 10, 100, 7)
            };
            assert_eq!(
                list(Some(stored), Some(now), &[]),
                expected,
                "{stored_ns} {seen_ns}"
            );
        }
    }
}
