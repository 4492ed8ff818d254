//! Tests of folders that are exchanged as a whole.

use std::sync::Arc;

use super::*;
use crate::system::{Call, FaultInjector, Kind, with_fs};

fn never(_: &Path) -> bool {
    false
}

/// Makes a folder with that file and puts it in place.
fn put(root: &Path, file: &str) -> Result<(), PipelineError> {
    let fresh = Fresh::begin(root, ".report-").unwrap();
    let path = fresh.path().join(file);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, file).unwrap();
    fresh.finish().unwrap();
    fresh.put(&root.join("report"), &never)
}

fn names(folder: &Path) -> Vec<String> {
    entries(folder)
        .unwrap()
        .into_iter()
        .map(|entry| entry.name)
        .collect()
}

#[test]
fn the_new_folder_stands_and_the_old_is_gone() {
    let root = tempfile::tempdir().unwrap();
    for turn in ["one", "runs/two", "three"] {
        put(root.path(), turn).unwrap();
        assert!(root.path().join("report").join(turn).exists());
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 1);
    }
    assert_eq!(names(&root.path().join("report")), [".written", "three"]);
}

#[test]
fn whatever_else_lies_in_it_is_named_and_stays() {
    let root = tempfile::tempdir().unwrap();
    let report = root.path().join("report");
    for other in ["notes.txt", "runs/mine.html", "chapter/thesis.tex", ".hidden"] {
        put(root.path(), "runs/a.html").unwrap();
        let path = report.join(other);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, "mine").unwrap();
        let refused = put(root.path(), "runs/b.html").unwrap_err();
        assert!(refused.to_string().contains(other), "{refused}");
        assert_eq!(fs::read_own_text(&path).unwrap(), "mine");
        assert!(report.join("runs/a.html").exists());
        assert_eq!(
            names(root.path())
                .iter()
                .filter(|name| name.starts_with(".report"))
                .count(),
            0
        );
        fs::remove_dir_all(&report).unwrap();
    }
}

#[test]
fn a_folder_without_a_list_and_a_file_are_not_ours_and_an_empty_folder_is_nobodys() {
    let root = tempfile::tempdir().unwrap();
    let report = root.path().join("report");
    fs::write(&report, "a file").unwrap();
    assert!(matches!(
        put(root.path(), "a"),
        Err(PipelineError::NotOurs { .. })
    ));
    fs::remove_file(&report).unwrap();
    fs::create_dir(&report).unwrap();
    put(root.path(), "a").unwrap();
    fs::remove_file(report.join(WRITTEN)).unwrap();
    assert!(matches!(
        put(root.path(), "a"),
        Err(PipelineError::NotOurs { .. })
    ));
}

#[cfg(unix)]
#[test]
fn a_link_is_not_ours() {
    let (root, elsewhere) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    std::os::unix::fs::symlink(elsewhere.path(), root.path().join("report")).unwrap();
    assert!(matches!(
        put(root.path(), "a"),
        Err(PipelineError::NotOurs { .. })
    ));
    assert!(root.path().join("report").is_symlink());
}

#[test]
fn a_file_that_comes_while_the_old_folder_is_removed_stays() {
    let root = tempfile::tempdir().unwrap();
    put(root.path(), "runs/a.html").unwrap();
    let report = root.path().join("report");
    let listed = listed_or_all(&report).unwrap();
    fs::write(report.join("runs/late.txt"), "mine").unwrap();
    remove_listed(&report, &listed).unwrap();
    assert_eq!(names(&report), ["runs", "runs/late.txt"]);
}

#[test]
fn only_leftovers_with_our_mark_go_and_what_only_looks_like_one_is_told() {
    let root = tempfile::tempdir().unwrap();
    let make = |name: &str, mark: Option<&str>, file: &str| {
        let folder = root.path().join(name);
        fs::create_dir(&folder).unwrap();
        fs::write(folder.join(file), "x").unwrap();
        mark.into_iter()
            .for_each(|mark| fs::write(folder.join(PASSING), mark).unwrap());
    };
    make(".report-11", Some(".report-11"), "index.html");
    make(".report-12.old", Some(".report-12"), "index.html");
    fs::create_dir(root.path().join(".report-13")).unwrap();
    make(".report-14", None, "thesis.tex");
    make(".report-old", None, "thesis.tex");
    // A copy of a folder that carried the mark.
    make(".report-copy", Some(".report-11"), "index.html");
    let kept = remove_leftovers(root.path(), ".report-");
    assert_eq!(kept, [root.path().join(".report-14")]);
    let mut left: Vec<String> = fs::read_dir(root.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    left.sort();
    assert_eq!(left, [".report-14", ".report-copy", ".report-old"]);
}

#[test]
fn what_file_managers_leave_is_no_obstacle() {
    let root = tempfile::tempdir().unwrap();
    put(root.path(), "runs/a.html").unwrap();
    for name in [".DS_Store", "runs/Thumbs.db"] {
        fs::write(root.path().join("report").join(name), "x").unwrap();
    }
    put(root.path(), "b.html").unwrap();
    assert_eq!(names(root.path()), ["report", "report/.written", "report/b.html"]);
}

/// Writes down what is changed.
#[derive(Default)]
struct Heard(std::sync::Mutex<Vec<(Kind, PathBuf)>>);

impl FaultInjector for Heard {
    fn before(&self, _call: &Call<'_>) -> io::Result<()> {
        Ok(())
    }

    fn after(&self, call: &Call<'_>) {
        if call.kind.changes() {
            self.0.lock().unwrap().push((call.kind, call.path.to_owned()));
        }
    }

    fn now(&self) -> std::time::SystemTime {
        std::time::SystemTime::now()
    }
}

/// Else a loss of power leaves the old folder without a part of its files, or the mark in the new one.
#[test]
fn the_new_name_is_on_the_disk_before_the_old_folder_loses_a_file() {
    let root = tempfile::tempdir().unwrap();
    for turn in ["first", "second"] {
        let heard = Arc::new(Heard::default());
        with_fs(heard.clone(), || put(root.path(), turn)).unwrap();
        let heard = heard.0.lock().unwrap();
        let place = |wanted: &dyn Fn(&(Kind, PathBuf)) -> bool| heard.iter().position(wanted).unwrap();
        let named = place(&|(kind, _)| matches!(kind, Kind::Exchange | Kind::Rename));
        let safe = place(&|(kind, path)| *kind == Kind::Sync && path == root.path());
        let removed = place(&|(kind, _)| *kind == Kind::Remove);
        assert!(named < safe && safe < removed, "{turn}: {heard:?}");
        // Whatever is written, the mark is on the disk first.
        let marks: Vec<Kind> = heard.iter().map(|(kind, _)| *kind).take(5).collect();
        assert_eq!(
            marks,
            [
                Kind::MakeFolder,
                Kind::Create,
                Kind::Write,
                Kind::Sync,
                Kind::Sync
            ]
        );
    }
}

#[test]
fn every_path_has_a_folder_that_can_be_waited_for() {
    for (path, parent) in [("report", "."), ("a/report", "a"), ("/report", "/")] {
        assert_eq!(parent_of(Path::new(path)), Path::new(parent));
        assert!(parent == "a" || fs::sync_names(parent).is_ok());
    }
}

#[test]
fn a_folder_with_a_torn_mark_alone_goes() {
    let root = tempfile::tempdir().unwrap();
    for mark in ["", ".rep", "\0\0\0"] {
        let folder = root.path().join(".report-15");
        fs::create_dir(&folder).unwrap();
        fs::write(folder.join(PASSING), mark).unwrap();
        assert_eq!(remove_leftovers(root.path(), ".report-"), Vec::<PathBuf>::new());
        assert!(!folder.exists(), "{mark:?}");
    }
}

#[test]
fn a_file_that_is_not_as_it_was_written_is_found() {
    let root = tempfile::tempdir().unwrap();
    put(root.path(), "runs/a.html").unwrap();
    let report = root.path().join("report");
    assert!(is_hashed(&report) && altered(&report).unwrap().is_empty());
    let path = report.join("runs/a.html");
    fs::write(&path, "runs/b.html").unwrap();
    let found = |what| vec![("runs/a.html".to_owned(), what)];
    assert_eq!(altered(&report).unwrap(), found(Altered::Changed));
    fs::remove_file(&path).unwrap();
    assert_eq!(altered(&report).unwrap(), found(Altered::Missing));
    fs::create_dir(&path).unwrap();
    assert!(matches!(altered(&report).unwrap()[0].1, Altered::Unreadable(_)));
    // As an earlier version wrote it: whether it is the same nobody knows.
    fs::remove_dir(&path).unwrap();
    fs::write(&path, "anything").unwrap();
    fs::write(report.join(WRITTEN), "runs/a.html\n").unwrap();
    assert!(!is_hashed(&report) && altered(&report).unwrap().is_empty());
    put(root.path(), "runs/a.html").unwrap();
}

/// Refuses further names for files, as some file systems do.
struct NoLinks;

impl FaultInjector for NoLinks {
    fn before(&self, call: &Call<'_>) -> io::Result<()> {
        match call.kind {
            Kind::Link => Err(io::ErrorKind::Unsupported.into()),
            _ => Ok(()),
        }
    }

    fn after(&self, _call: &Call<'_>) {}

    fn now(&self) -> std::time::SystemTime {
        std::time::SystemTime::now()
    }
}

fn files_are_taken_over() {
    let root = tempfile::tempdir().unwrap();
    let old = root.path().join("report");
    let first = Fresh::begin(root.path(), ".report-").unwrap();
    for file in ["a", "b"] {
        fs::write(first.path().join(file), file).unwrap();
    }
    first.finish().unwrap();
    first.put(&old, &never).unwrap();
    let hashes = hashes(&old).unwrap();
    let both: Vec<(&str, &str)> = hashes
        .iter()
        .map(|(name, hash)| (name.as_str(), hash.as_str()))
        .collect();
    let fresh = Fresh::begin(root.path(), ".report-").unwrap();
    // All or none: of two files the one that is as it was is not left behind.
    fs::write(old.join("b"), "changed").unwrap();
    assert!(!fresh.keep(&old, &both).unwrap());
    fs::remove_file(old.join("b")).unwrap();
    assert!(!fresh.keep(&old, &both).unwrap());
    assert_eq!(names(fresh.path()), [PASSING]);
    assert!(fresh.keep(&old, &both[..1]).unwrap());
    fs::write(fresh.path().join("c"), "c").unwrap();
    fresh.finish().unwrap();
    fresh.put(&old, &never).unwrap();
    assert_eq!(names(&old), [".written", "a", "c"]);
    assert_eq!(fs::read_own_text(old.join("a")).unwrap(), "a");
    assert!(altered(&old).unwrap().is_empty());
}

#[test]
fn files_are_taken_over_all_or_none() {
    files_are_taken_over();
    with_fs(Arc::new(NoLinks), files_are_taken_over);
}

/// Refuses to read the list of a folder.
struct NoList;

impl FaultInjector for NoList {
    fn before(&self, call: &Call<'_>) -> io::Result<()> {
        if call.kind == Kind::Read && call.path.ends_with(WRITTEN) {
            Err(io::Error::from_raw_os_error(5))
        } else {
            Ok(())
        }
    }

    fn after(&self, _call: &Call<'_>) {}

    fn now(&self) -> std::time::SystemTime {
        std::time::SystemTime::now()
    }
}

/// It was told as files that somebody else wrote and that are to be moved out.
#[test]
fn a_list_that_the_disk_does_not_give_is_an_error_of_the_disk() {
    let root = tempfile::tempdir().unwrap();
    put(root.path(), "a.html").unwrap();
    let refused = with_fs(Arc::new(NoList), || put(root.path(), "b.html")).unwrap_err();
    assert!(matches!(refused, PipelineError::File { .. }), "{refused}");
    assert!(refused.to_string().contains(WRITTEN), "{refused}");
    put(root.path(), "b.html").unwrap();
}

/// Puts another folder in place as soon as the list of the one that is there was read, once.
struct Exchanged(PathBuf, std::sync::atomic::AtomicBool);

impl FaultInjector for Exchanged {
    fn before(&self, _call: &Call<'_>) -> io::Result<()> {
        Ok(())
    }

    fn after(&self, call: &Call<'_>) {
        let is_list = call.kind == Kind::Read && call.path == self.0.join("report").join(WRITTEN);
        if is_list && !self.1.swap(true, std::sync::atomic::Ordering::Relaxed) {
            put(&self.0, "b.html").unwrap();
        }
    }

    fn now(&self) -> std::time::SystemTime {
        std::time::SystemTime::now()
    }
}

/// Beside a program that wrote a report its files were told as lost, damaged and foreign.
#[test]
fn a_folder_that_is_exchanged_while_it_is_looked_at_is_as_it_was_written() {
    let root = tempfile::tempdir().unwrap();
    let report = root.path().join("report");
    let looks: [&dyn Fn() -> bool; 2] = [&|| altered(&report).unwrap().is_empty(), &|| {
        check(&report, &never).is_ok()
    }];
    for look in looks {
        put(root.path(), "a.html").unwrap();
        let world = Arc::new(Exchanged(root.path().to_owned(), false.into()));
        assert!(with_fs(world.clone(), look));
        assert!(world.1.load(std::sync::atomic::Ordering::Relaxed));
    }
}
