//! Puts a finished folder in the place of another in one step, so that a reader never sees half of it.

use std::io;
use std::path::Path;

/// Exchanges `fresh` with `target` (or renames it there) and removes what stood there before.
///
/// # Errors
/// What the system says; `target` is then what it was, or the fresh folder.
pub fn replace_folder(fresh: &Path, target: &Path) -> io::Result<()> {
    if !target.exists() {
        return std::fs::rename(fresh, target);
    }
    if exchange(fresh, target).is_err() {
        // File systems without an exchange: a moment without a folder, never half a folder.
        let aside = fresh.with_extension("old");
        std::fs::rename(target, &aside)?;
        std::fs::rename(fresh, target)?;
        return std::fs::remove_dir_all(&aside);
    }
    std::fs::remove_dir_all(fresh)
}

#[cfg(target_os = "linux")]
fn exchange(one: &Path, other: &Path) -> io::Result<()> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    Ok(renameat_with(CWD, one, CWD, other, RenameFlags::EXCHANGE)?)
}

#[cfg(not(target_os = "linux"))]
fn exchange(_one: &Path, _other: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_new_folder_stands_and_the_old_is_gone() {
        let root = tempfile::tempdir().unwrap();
        let (fresh, target) = (root.path().join(".fresh"), root.path().join("report"));
        for turn in ["one", "two"] {
            std::fs::create_dir(&fresh).unwrap();
            std::fs::write(fresh.join(turn), turn).unwrap();
            replace_folder(&fresh, &target).unwrap();
            assert!(target.join(turn).exists() && !fresh.exists());
        }
        assert!(!target.join("one").exists());
    }
}
