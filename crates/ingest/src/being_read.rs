//! Which files are being read: one during which the program died is known at the next look.
//!
//! A small file in the campaign's folder names each file from before a reader gets it until the reader is done; the lock of
//! the campaign sees to it that one program alone does so. A program may be ended from outside while it reads any file: one
//! that is named when a look begins is read once more, with no other beside it, and refused where the program dies again.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use ieap_domain::Issue;
use ieap_system::fs::{self, OpenOptions};
use ieap_system::passing::Passing;

use crate::scan::{SeenFile, modified_ns, parse_display_path};

/// Code of the refusal of a file that ended the program.
pub const ENDED_PROGRAM: &str = "ended-program";
/// What the names of the files begin with.
const PREFIX: &str = ".ieap-reading-";
/// Ends of the program during a file that refuse it: the second one happened with no other file beside it.
const REFUSED_AFTER: u32 = 2;

/// What a look found of files that were being read.
#[derive(Debug)]
pub struct BeingRead {
    folder: PathBuf,
    /// Ends of the program during a file, by the name of the file that tells them.
    ended: BTreeMap<String, u32>,
}

/// Tells that a file is being read, as long as this value lives.
#[derive(Debug)]
pub struct Mark(Option<Passing>);

impl Drop for Mark {
    fn drop(&mut self) {
        if let Some(passing) = &self.0 {
            let _ = fs::remove_file(passing.path());
        }
    }
}

impl BeingRead {
    /// What earlier programs left in a campaign, whose lock this one holds. A folder that cannot be looked at tells nothing.
    pub fn of(campaign: &Path) -> BeingRead {
        let entries = fs::entries(campaign).unwrap_or_default().into_iter();
        let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
        let mut ended = BTreeMap::new();
        for name in names.filter(|name| name.starts_with(PREFIX)) {
            let text = fs::read_own_text(campaign.join(&name)).unwrap_or_default();
            if is_of_another_file(campaign, &name, &text) {
                let _ = fs::remove_file(campaign.join(&name));
            } else {
                ended.insert(name, ends_of(&text));
            }
        }
        BeingRead {
            folder: campaign.to_owned(),
            ended,
        }
    }

    /// Whether the program died while it read that file: it is read with no other beside it.
    pub fn is_suspect(&self, file: &SeenFile) -> bool {
        !self.ended.is_empty() && self.ended.contains_key(&name_of(file))
    }

    /// Says that a file is being read now. Where that cannot be written, the file is read without.
    ///
    /// # Errors
    /// The refusal of a file during which the program died, and died again when it read no other.
    pub fn begin(&self, file: &SeenFile) -> Result<Mark, Issue> {
        let name = name_of(file);
        let ended = self.ended.get(&name).copied().unwrap_or(0);
        if ended >= REFUSED_AFTER {
            return Err(refusal(file));
        }
        let path = self.folder.join(&name);
        // What stands in it counts from now on: nothing may be left to write when the program dies.
        let text = format!("{} {}\n{}\n", ended + 1, env!("CARGO_PKG_VERSION"), file.display);
        let make = || {
            let mut options = OpenOptions::own();
            let mut made = options.write(true).create(true).truncate(true).open(&path)?;
            std::io::Write::write_all(&mut made, text.as_bytes())
        };
        let made = Passing::made(make, |()| path.clone());
        Ok(Mark(made.ok().map(|((), passing)| passing)))
    }
}

/// Name of the file that tells that this one is being read: of another size or time it is another file.
fn name_of(file: &SeenFile) -> String {
    name_with(&file.display, file.size_bytes, file.modified_ns)
}

fn name_with(path: &str, size_bytes: u64, modified_ns: i64) -> String {
    let marks = format!("{path}\0{size_bytes}\0{modified_ns}");
    format!("{PREFIX}{}", &blake3::hash(marks.as_bytes()).to_hex()[..16])
}

/// Whether the file that a text tells of has gone or changed since. What is in a folder is not looked at.
fn is_of_another_file(campaign: &Path, name: &str, text: &str) -> bool {
    let Some(path) = text.lines().nth(1) else {
        return false;
    };
    match fs::metadata(campaign.join(parse_display_path(path))) {
        Ok(found) if found.is_dir() => false,
        Ok(found) => name_with(path, found.len(), modified_ns(&found)) != name,
        Err(error) => error.kind() == std::io::ErrorKind::NotFound,
    }
}

/// Ends that a text tells of. One of another version of the program may be well now; one that was cut tells of one.
fn ends_of(text: &str) -> u32 {
    let mut words = text.lines().next().unwrap_or_default().split(' ');
    let count = words.next().and_then(|count| count.parse().ok()).unwrap_or(1);
    match words.next() {
        Some(version) if version != env!("CARGO_PKG_VERSION") => 1,
        _ => count,
    }
}

fn refusal(file: &SeenFile) -> Issue {
    let message = format!(
        "the program died twice while it read this file ({} bytes), the second time with no other file beside it; it needed \
         more memory than there is, or a fault of the program ended it",
        file.size_bytes
    );
    Issue::error(ENDED_PROGRAM, message).mend(
        "export it anew, smaller or as CSV; to have it tried again as it is, give it a new time of change (touch FILE); the \
         other files are not affected",
    )
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use crate::scan::{ScanLimits, scan};

    /// A campaign with these files.
    fn campaign(names: &[&str]) -> (tempfile::TempDir, Vec<SeenFile>) {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("runs")).unwrap();
        names
            .iter()
            .for_each(|name| std::fs::write(folder.path().join("runs").join(name), "1").unwrap());
        let limits = ScanLimits::default();
        let found = scan(folder.path(), "runs", &[], limits).unwrap();
        (
            folder,
            found.files.iter().map(|file| SeenFile::clone(file)).collect(),
        )
    }

    /// Reads a file and dies.
    fn dies(campaign: &Path, file: &SeenFile) {
        let mark = BeingRead::of(campaign).begin(file).unwrap();
        std::mem::forget(mark);
    }

    #[test]
    fn a_file_is_refused_when_the_program_died_with_it_alone() {
        let (folder, files) = campaign(&["a.xls", "b.xls"]);
        let (bad, good) = (&files[0], &files[1]);
        let look = || BeingRead::of(folder.path());
        assert!(!look().is_suspect(bad));
        dies(folder.path(), bad);
        assert!(look().is_suspect(bad) && !look().is_suspect(good));
        dies(folder.path(), bad);
        let refused = look().begin(bad).unwrap_err();
        assert!(refused.message.contains("died twice"), "{refused:?}");
        assert!(look().begin(good).is_ok());
        // It stays refused until it has another time.
        assert!(look().begin(bad).is_err());
        let later = std::time::SystemTime::now() + std::time::Duration::from_secs(60);
        let opened = std::fs::File::options()
            .write(true)
            .open(folder.path().join("runs/a.xls"));
        opened.unwrap().set_modified(later).unwrap();
        let again = scan(folder.path(), "runs", &[], ScanLimits::default()).unwrap();
        assert!(!look().is_suspect(&again.files[0]));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_file_that_is_read_after_the_program_died_is_under_no_suspicion_any_more() {
        let (folder, files) = campaign(&["a.xls"]);
        for _ in 0..3 {
            dies(folder.path(), &files[0]);
            drop(BeingRead::of(folder.path()).begin(&files[0]).unwrap());
            assert!(!BeingRead::of(folder.path()).is_suspect(&files[0]));
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn another_version_tries_again_and_a_text_that_was_cut_counts_once() {
        let own = env!("CARGO_PKG_VERSION");
        for (text, ends) in [
            (format!("2 {own}\nruns/a.xls\n"), 2),
            ("2 0.0.0\nruns/a.xls\n".to_owned(), 1),
            (String::new(), 1),
        ] {
            assert_eq!(ends_of(&text), ends, "{text}");
        }
    }
}
