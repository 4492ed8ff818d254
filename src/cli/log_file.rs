//! What a verb says, in a file of its own that does not grow without end: for what runs for weeks.

use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Size from which a new file is begun, bytes: the lines of some ten thousand runs.
const LARGEST: u64 = 4 << 20;

/// An open log. The one before it is kept under the same name with `.1` behind it, and no other.
#[derive(Debug)]
pub struct LogFile {
    path: PathBuf,
    file: File,
    bytes: u64,
}

impl LogFile {
    /// Goes on with the file at that path, or begins it.
    ///
    /// # Errors
    /// What the system says.
    pub fn open(path: &Path) -> io::Result<LogFile> {
        let file = OpenOptions::new().append(true).create(true).open(path)?;
        let bytes = file.metadata()?.len();
        let path = path.to_owned();
        Ok(LogFile { path, file, bytes })
    }

    /// Adds a line.
    ///
    /// # Errors
    /// What the system says.
    pub fn line(&mut self, text: &str) -> io::Result<()> {
        self.grow_to(text, LARGEST)
    }

    fn grow_to(&mut self, text: &str, largest: u64) -> io::Result<()> {
        if self.bytes >= largest {
            let mut earlier = self.path.clone().into_os_string();
            earlier.push(".1");
            std::fs::rename(&self.path, &earlier)?;
            *self = LogFile::open(&self.path)?;
        }
        self.bytes += text.len() as u64 + 1;
        self.file.write_all(format!("{text}\n").as_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_is_gone_on_with_and_never_larger_than_twice_its_size() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("watch.log");
        for turn in 0..50 {
            let mut log = LogFile::open(&path).unwrap();
            log.grow_to(&format!("line {turn}"), 64).unwrap();
        }
        let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
        let (now, before) = (read("watch.log"), read("watch.log.1"));
        assert!(now.ends_with("line 49\n") && now.len() + before.len() <= 2 * (64 + 8));
        let both = before + &now;
        let turns: Vec<&str> = both.lines().collect();
        let whole: Vec<String> = (50 - turns.len()..50)
            .map(|turn| format!("line {turn}"))
            .collect();
        assert_eq!(turns, whole, "no line between them is lost");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    }
}
