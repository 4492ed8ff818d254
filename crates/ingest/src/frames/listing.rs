//! The frames of a folder, in the order of their numbers.

use std::cmp::Ordering;
use std::path::{Path, PathBuf};

use super::FramesError;
use ieap_strip::ENDINGS;
use ieap_system::fs;

/// A file that is a frame by its name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FrameFile {
    /// The file.
    pub path: PathBuf,
    /// Its name.
    pub name: String,
    /// Size, bytes.
    pub size_bytes: u64,
}

/// The frames of a folder: numbers in names count as numbers, so that frame 10 follows frame 9, and times in names as
/// times, so that -2 s comes before -1 s. Hidden files are left out.
///
/// # Errors
/// The folder cannot be listed, or there is no frame.
pub fn list(folder: &Path) -> Result<Vec<FrameFile>, FramesError> {
    let unreadable = |source| FramesError::Unreadable {
        path: folder.into(),
        source,
    };
    let mut frames = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let entry = entry.map_err(unreadable)?;
        let path = entry.path();
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.starts_with('.') || !is_frame(&path) {
            continue;
        }
        let metadata = fs::metadata(&path).map_err(unreadable)?;
        if metadata.is_file() {
            frames.push(FrameFile {
                path,
                name,
                size_bytes: metadata.len(),
            });
        }
    }
    if frames.is_empty() {
        return Err(FramesError::NoFrames { path: folder.into() });
    }
    frames.sort_by(|a, b| by_number(&a.name, &b.name));
    super::times::in_order(&mut frames);
    Ok(frames)
}

/// Files named one by one, in the order given.
///
/// # Errors
/// One of them cannot be read.
pub fn of_paths(paths: &[PathBuf]) -> Result<Vec<FrameFile>, FramesError> {
    let frame = |path: &PathBuf| {
        let metadata = fs::metadata(path).map_err(|source| FramesError::Unreadable {
            path: path.clone(),
            source,
        })?;
        Ok(FrameFile {
            name: path
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned(),
            path: path.clone(),
            size_bytes: metadata.len(),
        })
    };
    paths.iter().map(frame).collect()
}

fn is_frame(path: &Path) -> bool {
    let ending = path
        .extension()
        .unwrap_or_default()
        .to_string_lossy()
        .to_lowercase();
    ENDINGS.contains(&ending.as_str())
}

/// Order of names in which runs of digits are compared as numbers; equal numbers by their text.
fn by_number(a: &str, b: &str) -> Ordering {
    let (mut left, mut right) = (a.as_bytes(), b.as_bytes());
    while let (Some(x), Some(y)) = (left.first(), right.first()) {
        if x.is_ascii_digit() && y.is_ascii_digit() {
            let (p, q) = (digits(left), digits(right));
            let order = significant(p).len().cmp(&significant(q).len());
            let order = order.then_with(|| significant(p).cmp(significant(q)));
            if order != Ordering::Equal {
                return order;
            }
            (left, right) = (&left[p.len()..], &right[q.len()..]);
        } else if x != y {
            return x.cmp(y);
        } else {
            (left, right) = (&left[1..], &right[1..]);
        }
    }
    left.len().cmp(&right.len()).then_with(|| a.cmp(b))
}

fn digits(text: &[u8]) -> &[u8] {
    let end = text
        .iter()
        .position(|c| !c.is_ascii_digit())
        .unwrap_or(text.len());
    &text[..end]
}

fn significant(digits: &[u8]) -> &[u8] {
    let zeros = digits.iter().take_while(|c| **c == b'0').count();
    &digits[zeros..]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_follow_their_numbers() {
        let mut names = ["f10.png", "f9.png", "f009.png", "f1_2.png", "f1_10.png", "a.png"];
        names.sort_by(|a, b| by_number(a, b));
        assert_eq!(
            names,
            ["a.png", "f1_2.png", "f1_10.png", "f009.png", "f9.png", "f10.png"]
        );
    }

    #[test]
    fn times_before_the_step_come_first_and_in_order() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["f_-1s.png", "f_-2s.png", "f_0s.png", "f_10s.png", "f_500ms.png"] {
            std::fs::write(folder.path().join(name), "x").unwrap();
        }
        let frames = list(folder.path()).unwrap();
        let found = crate::frames::times(&frames, &crate::frames::FrameSettings::default());
        assert_eq!(found.unwrap(), [-2.0, -1.0, 0.0, 0.5, 10.0]);
    }

    #[test]
    fn only_pictures_are_frames() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["2.PNG", "1.jpeg", "frames.toml", ".3.png", "notes.txt"] {
            std::fs::write(folder.path().join(name), "x").unwrap();
        }
        let names: Vec<String> = list(folder.path()).unwrap().into_iter().map(|f| f.name).collect();
        assert_eq!(names, ["1.jpeg", "2.PNG"]);
        let empty = tempfile::tempdir().unwrap();
        assert!(list(empty.path()).unwrap_err().to_string().contains("no PNG"));
    }
}
