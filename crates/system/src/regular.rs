//! Whether a regular file has a name: what a campaign consists of is opened only then.
//!
//! A pipe keeps who reads it waiting for ever, a device has no end, and through a link the program would change a file of
//! somebody else, or show one to whoever sees what is made of a campaign.

use std::fs::{FileType, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

/// What may stand in the place of a regular file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Links {
    /// Nothing: what the program itself writes it never finds behind a link.
    Refused,
    /// A link to a regular file in this folder: a campaign speaks of itself, and may come from anybody.
    Within(PathBuf),
    /// A link to a regular file: a user names what is meant.
    Followed,
}

/// The path without links, where it lies in that folder.
pub(crate) fn within(folder: &Path, path: &Path) -> io::Result<PathBuf> {
    let real = std::fs::canonicalize(path)?;
    let folder = std::fs::canonicalize(folder)?;
    if real.starts_with(&folder) {
        return Ok(real);
    }
    let said = format!(
        "a link leads to {}, outside of {}, and is not followed: put the file itself there",
        real.display(),
        folder.display()
    );
    Err(io::Error::new(io::ErrorKind::InvalidInput, said))
}

/// Opens a regular file; a pipe is not waited for.
pub(crate) fn open(options: &OpenOptions, links: &Links, path: &Path) -> io::Result<std::fs::File> {
    if let Links::Within(folder) = links {
        return open(options, &Links::Refused, &within(folder, path)?);
    }
    let mut options = options.clone();
    #[cfg(unix)]
    {
        let mut flags = rustix::fs::OFlags::NONBLOCK;
        if *links == Links::Refused {
            flags |= rustix::fs::OFlags::NOFOLLOW;
        }
        std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, flags.bits().cast_signed());
    }
    // Where the system has no such flags it is asked before; elsewhere an error may tell less than what is there.
    let refused = || named(links, path).ok().and_then(|kind| refused(kind, links));
    if let (false, Some(refused)) = (cfg!(unix), refused()) {
        return Err(refused);
    }
    let file = options.open(path).map_err(|error| refused().unwrap_or(error))?;
    match self::refused(file.metadata()?.file_type(), links) {
        None => Ok(file),
        Some(refused) => Err(refused),
    }
}

/// Refuses a file of the program itself that is no regular one.
pub(crate) fn check(kind: FileType) -> io::Result<()> {
    refused(kind, &Links::Refused).map_or(Ok(()), Err)
}

fn named(links: &Links, path: &Path) -> io::Result<FileType> {
    let found = match links {
        Links::Followed => std::fs::metadata(path),
        Links::Refused | Links::Within(_) => std::fs::symlink_metadata(path),
    };
    found.map(|found| found.file_type())
}

/// Why that is not opened; none for a regular file.
fn refused(kind: FileType, links: &Links) -> Option<io::Error> {
    let found = match kind {
        _ if kind.is_file() => return None,
        _ if kind.is_symlink() && *links == Links::Refused => "a link",
        _ if kind.is_dir() => "a folder",
        _ => "a pipe, a socket or a device",
    };
    let said = format!(
        "{found} has that name, and a regular file is needed: put the file itself there, or take what is there away"
    );
    Some(io::Error::new(io::ErrorKind::InvalidInput, said))
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::symlink;
    use std::path::{Path, PathBuf};

    use crate::fs;

    /// A name for everything that may stand in the place of a file, with a word of what is said of it.
    fn in_its_place(folder: &Path) -> Vec<(PathBuf, &'static str)> {
        let at = |name: &str| folder.join(name);
        rustix::fs::mkfifoat(rustix::fs::CWD, at("pipe"), rustix::fs::Mode::RWXU).unwrap();
        std::fs::create_dir(at("folder")).unwrap();
        symlink("/dev/zero", at("to-zero")).unwrap();
        symlink(at("pipe"), at("to-pipe")).unwrap();
        vec![
            (at("pipe"), "a pipe"),
            (PathBuf::from("/dev/zero"), "a device"),
            (at("folder"), "a folder"),
            (at("to-zero"), ""),
            (at("to-pipe"), ""),
        ]
    }

    #[test]
    fn what_is_no_regular_file_is_refused_at_once_however_it_is_opened() {
        let folder = tempfile::tempdir().unwrap();
        for (path, word) in in_its_place(folder.path()) {
            let mut to_write = fs::OpenOptions::own();
            to_write.read(true).write(true);
            let refusals = [
                fs::read_own(&path).unwrap_err(),
                fs::read_own_text(&path).unwrap_err(),
                fs::read_named(&path).unwrap_err(),
                fs::read_stated(Path::new("/"), &path).unwrap_err(),
                fs::write(&path, "x").unwrap_err(),
                to_write.open(&path).unwrap_err(),
            ];
            for refused in refusals {
                assert_eq!(refused.kind(), std::io::ErrorKind::InvalidInput, "{refused}");
                let told = refused.to_string();
                assert!(
                    told.contains(word) && told.contains("a regular file is needed"),
                    "{told}"
                );
            }
        }
    }

    #[test]
    fn a_stated_file_is_reached_through_a_link_in_its_folder_and_no_other() {
        let (root, campaign) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let at = |name: &str| campaign.path().join(name);
        std::fs::write(at("file"), "mine").unwrap();
        std::fs::write(root.path().join("secret"), "theirs").unwrap();
        std::fs::create_dir(at("below")).unwrap();
        symlink(at("file"), at("below/link")).unwrap();
        symlink(root.path().join("secret"), at("below/out")).unwrap();
        symlink(root.path(), at("folder")).unwrap();
        symlink("out", at("below/chain")).unwrap();
        for path in [at("file"), at("below/link"), at("below/../file")] {
            assert_eq!(fs::read_stated(campaign.path(), path).unwrap(), b"mine");
        }
        let secret = root.path().join("secret").canonicalize().unwrap();
        for name in ["below/out", "below/chain", "folder/secret"] {
            let refused = fs::read_stated(campaign.path(), at(name)).unwrap_err();
            assert_eq!(refused.kind(), std::io::ErrorKind::InvalidInput);
            let said = refused.to_string();
            assert!(said.contains(secret.to_str().unwrap()), "{name}: {said}");
            assert!(said.contains("outside of"), "{name}: {said}");
        }
        let gone = fs::read_stated(campaign.path(), at("gone")).unwrap_err();
        assert_eq!(gone.kind(), std::io::ErrorKind::NotFound);
    }

    #[test]
    fn an_own_file_is_not_reached_through_a_link_and_one_that_is_named_is() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        std::fs::write(&file, "mine").unwrap();
        symlink(&file, &link).unwrap();
        assert_eq!(fs::read_named(&link).unwrap(), b"mine");
        assert_eq!(fs::read_own(&file).unwrap(), b"mine");
        let refused = fs::read_own(&link).unwrap_err().to_string();
        assert!(refused.starts_with("a link has that name"), "{refused}");
        assert!(fs::write(&link, "other").is_err());
        assert!(fs::check_own(&link).is_err() && fs::check_own(&file).is_ok());
        assert!(fs::check_own(folder.path().join("gone")).is_ok());
        assert_eq!(std::fs::read(&file).unwrap(), b"mine");
        let gone = fs::read_own(folder.path().join("gone")).unwrap_err();
        assert_eq!(gone.kind(), std::io::ErrorKind::NotFound);
    }
}
