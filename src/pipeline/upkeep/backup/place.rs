//! Where a file of a backup's list belongs: below the folder of the campaign and nowhere else, on whatever system it is restored.

use std::path::{Component, Path, PathBuf};

use crate::ingest::scan::parse_display_path;

/// Names that Windows gives to devices, whatever ending they have
/// (<https://learn.microsoft.com/windows/win32/fileio/naming-a-file>).
const DEVICES: [&str; 6] = ["CON", "PRN", "AUX", "NUL", "CONIN$", "CONOUT$"];
/// The same with a digit behind them.
const NUMBERED_DEVICES: [&str; 2] = ["COM", "LPT"];

/// The path below the campaign that a list means by `text`.
///
/// # Errors
/// Why it means none.
pub fn place(text: &str) -> Result<PathBuf, &'static str> {
    text.split('/').map(name).collect()
}

/// One name of a path. What an escape in it means is looked at, too: `..\x2fevil` is two names.
fn name(part: &str) -> Result<PathBuf, &'static str> {
    let path = parse_display_path(part);
    let mut components = path.components();
    match (components.next(), components.next()) {
        (Some(Component::Normal(only)), None) if only == path.as_os_str() => {}
        _ => return Err("it leads out of the folder"),
    }
    let bytes = path.as_os_str().as_encoded_bytes();
    if bytes.contains(&0) || cfg!(windows) && bytes.contains(&b':') {
        return Err("it is no name of a file");
    }
    if is_device(&path) {
        Err("it is the name of a device on Windows; rename the file")
    } else {
        Ok(path)
    }
}

fn is_device(name: &Path) -> bool {
    let name = name.to_string_lossy().to_uppercase();
    let stem = name.split('.').next().unwrap_or_default().trim_end();
    let is_numbered = |device: &str| {
        let rest = stem.strip_prefix(device).unwrap_or_default();
        let mut signs = rest.chars();
        matches!(
            (signs.next(), signs.next()),
            (Some('0'..='9' | '¹' | '²' | '³'), None)
        )
    };
    DEVICES.contains(&stem) || NUMBERED_DEVICES.iter().any(|device| is_numbered(device))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_lies_below_the_folder_has_a_place() {
        for text in [
            "campaign.toml",
            "runs/a b.csv",
            "runs/..a/b..",
            "archive/ab/cd.csv",
            "runs/console.csv",
            "comb",
        ] {
            assert_eq!(place(text), Ok(PathBuf::from(text)));
        }
        for text in [
            "..",
            "../evil",
            "runs/../../evil",
            "runs/./a",
            "/tmp/evil",
            "runs//a",
            "runs/",
            "",
            "runs/..\\x2f..\\x2fevil",
            "\\u{2f}tmp/evil",
            "runs/\\u{2e}\\u{2e}/evil",
            "runs/a\\x00",
        ] {
            let refused = place(text).unwrap_err();
            assert!(
                refused.starts_with("it leads out") || refused.starts_with("it is no name"),
                "{text}"
            );
        }
        for text in [
            "NUL",
            "runs/con.csv",
            "aux .txt",
            "Com1",
            "lpt9.csv.toml",
            "com²",
            "conin$",
        ] {
            assert!(place(text).unwrap_err().contains("device"), "{text}");
        }
    }
}
