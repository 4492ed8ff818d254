//! Writes a file that appears whole or not at all: the one door through which verbs write what a user asked for.
//!
//! The content goes into a temporary beside the file, is brought to the disk and takes the name in one step. A full disk or
//! a kill leaves what stood there before, and no stump.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::ingest::campaign_file;
use crate::ingest::scan::is_own_product;
use crate::pipeline::{PipelineError, failed};
use crate::system::{Temporary, fs};

/// Has `fill` write the temporary that becomes `path`, which a user names. A device or a pipe has no name to take and is written
/// as it is.
///
/// # Errors
/// It is a file that a campaign consists of; a file is there and `overwrite` is not set; the disk refuses; or what `fill` says.
pub fn put_file<T>(
    path: &Path,
    overwrite: bool,
    fill: impl FnOnce(&Path) -> Result<T, PipelineError>,
) -> Result<T, PipelineError> {
    if is_of_campaign(path) {
        Err(PipelineError::BadArgument {
            what: "the file to write",
            found: format!("{}, of which a campaign consists", path.display()),
            needed: "another name; nothing was written".to_owned(),
        })
    } else {
        exchanged(path, overwrite, fill)
    }
}

/// Whether that is the name of a database, an archive, a report or a campaign.toml, or lies in one.
fn is_of_campaign(path: &Path) -> bool {
    let absolute = fs::canonicalize(path).ok().or_else(|| {
        let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty());
        let parent = fs::canonicalize(parent.unwrap_or(Path::new("."))).ok()?;
        Some(parent.join(path.file_name()?))
    });
    let Some(absolute) = absolute else { return false };
    let holds_campaign =
        |folder: &&Path| *folder != absolute && folder.join(campaign_file::FILE_NAME).is_file();
    let mut campaigns = absolute.ancestors().filter(holds_campaign);
    campaigns.any(|campaign| {
        let inside = absolute.strip_prefix(campaign).unwrap_or(&absolute);
        is_own_product(inside) || inside == Path::new(campaign_file::FILE_NAME)
    })
}

fn exchanged<T>(
    path: &Path,
    overwrite: bool,
    fill: impl FnOnce(&Path) -> Result<T, PipelineError>,
) -> Result<T, PipelineError> {
    let refused = |source: io::Error| match source.kind() {
        io::ErrorKind::AlreadyExists => PipelineError::FileExists {
            path: path.to_owned(),
        },
        _ => failed(path, "writing")(source),
    };
    if fs::symlink_metadata(path).is_ok() && !overwrite {
        return Err(refused(io::ErrorKind::AlreadyExists.into()));
    }
    // A link keeps standing: what it leads to is exchanged.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let known = fs::metadata(&target).ok();
    if known.as_ref().is_some_and(|known| !known.is_file()) {
        return fill(&target);
    }
    let part = temporary_beside(&target).map_err(refused)?;
    let done = fill(part.path())?;
    let file = fs::File::open_own(part.path()).map_err(refused)?;
    if let Some(known) = known {
        file.set_permissions(known.permissions()).map_err(refused)?;
    }
    file.sync_all().map_err(refused)?;
    let placed = if overwrite {
        part.persist(&target)
    } else {
        part.persist_to_free(&target)
    };
    placed.map_err(refused)?;
    Ok(done)
}

/// The same for content that is at hand.
///
/// # Errors
/// A file is there and `overwrite` is not set, or the disk refuses.
pub fn put_bytes(path: &Path, overwrite: bool, bytes: &[u8]) -> Result<(), PipelineError> {
    put_file(path, overwrite, |part| write_all(part, path, bytes))
}

fn write_all(part: &Path, path: &Path, bytes: &[u8]) -> Result<(), PipelineError> {
    let opened = fs::OpenOptions::new().write(true).open(part);
    let written = opened.and_then(|mut file| file.write_all(bytes));
    written.map_err(failed(path, "writing"))
}

/// Writes a file anew that people write, too, such as campaign.toml: a link to it keeps standing.
///
/// # Errors
/// The disk refuses.
pub fn put_stated(path: &Path, bytes: &[u8]) -> Result<(), PipelineError> {
    exchanged(path, true, |part| write_all(part, path, bytes))
}

/// Writes a file anew that the program itself keeps: in its place stands a regular file or nothing.
///
/// # Errors
/// Something else stands there, or the disk refuses.
pub fn put_own(path: &Path, bytes: &[u8]) -> Result<(), PipelineError> {
    fs::check_own(path).map_err(failed(path, "writing"))?;
    exchanged(path, true, |part| write_all(part, path, bytes))
}

/// An empty file with the rights of a new one, under a name that no scan takes for data; it goes when it is dropped.
fn temporary_beside(path: &Path) -> io::Result<Temporary> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.map_or(PathBuf::from("."), Path::to_owned);
    // Temporary files are their owner's alone; these are for everyone whom the user lets read.
    Temporary::new_in(&folder, ".ieap-", ".part", 0o666)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect()
    }

    #[test]
    fn a_file_appears_whole_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        let stopped = put_file(&path, false, |part| -> Result<(), PipelineError> {
            fs::write(part, "half").unwrap();
            Err(PipelineError::NoScale)
        });
        assert!(stopped.is_err() && names(folder.path()).is_empty());
        put_bytes(&path, false, b"one").unwrap();
        assert!(matches!(
            put_bytes(&path, false, b"two"),
            Err(PipelineError::FileExists { .. })
        ));
        assert_eq!(fs::read(&path).unwrap(), b"one");
        put_bytes(&path, true, b"two").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert_eq!(names(folder.path()), ["a.txt"]);
    }

    #[test]
    fn what_a_campaign_consists_of_is_written_by_the_program_alone() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        put_bytes(&at("campaign.toml"), false, b"[campaign]").unwrap();
        for name in ["runs", "report", "archive"] {
            fs::create_dir(at(name)).unwrap();
        }
        fs::write(at("campaign.db"), "all").unwrap();
        for name in [
            "campaign.db",
            "campaign.db-wal",
            "campaign.toml",
            "archive/journal.jsonl",
            "report/a.csv",
        ] {
            let refused = put_bytes(&at(name), true, b"a table").unwrap_err();
            assert!(
                refused.to_string().contains("a campaign consists"),
                "{name}: {refused}"
            );
        }
        assert_eq!(fs::read_own(at("campaign.db")).unwrap(), b"all");
        for name in ["table.csv", "runs/plan.csv"] {
            put_bytes(&at(name), true, b"a table").unwrap();
        }
        put_stated(&at("campaign.toml"), b"[campaign]\n").unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_and_rights_stay() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (path, link) = (folder.path().join("a.txt"), folder.path().join("link"));
        fs::write(&path, "one").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        std::os::unix::fs::symlink(&path, &link).unwrap();
        put_bytes(&link, true, b"two").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert!(link.symlink_metadata().unwrap().is_symlink());
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_device_is_written_and_not_exchanged() {
        assert!(put_bytes(Path::new("/dev/full"), true, b"x").is_err());
        put_bytes(Path::new("/dev/null"), true, b"x").unwrap();
        use std::os::unix::fs::FileTypeExt;
        assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());
    }
}
