//! What the name of a file in the campaign folder says of it.

use std::ffi::OsStr;
use std::path::{Component, Path};

use unicode_normalization::UnicodeNormalization;

use super::display::display_path;

/// Whether a path relative to the campaign is, or lies in, something that the program writes itself: the
/// database with its companions, the archive, the report and backups.
pub fn is_own_product(relative: &Path) -> bool {
    let mut components = relative.components();
    let Some(Component::Normal(first)) = components.next() else {
        return false;
    };
    let own_folder = ["archive", "report", "backups"]
        .iter()
        .any(|name| first == OsStr::new(name));
    let database = first.to_string_lossy().starts_with("campaign.db") && components.next().is_none();
    own_folder || database
}

/// Whether a file or folder of that name is never data: hidden, a copy in progress, an editor's or a file
/// manager's own file. Letter case does not count.
pub fn is_passing_name(name: &OsStr) -> bool {
    const ENDS: [&str; 5] = ["~", ".tmp", ".part", ".filepart", ".crdownload"];
    const NAMES: [&str; 2] = ["thumbs.db", "desktop.ini"];
    let name = name.to_string_lossy().to_lowercase();
    name.starts_with('.')
        || name.starts_with("~$")
        || ENDS.iter().any(|end| name.ends_with(end))
        || NAMES.contains(&name.as_str())
}

/// What a statement is for.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum StatesFor {
    /// Everything below its folder: `tags.toml`.
    Folder,
    /// The file beside it of that name, in the form of [`compared`]: `a.csv.toml` is for `a.csv`.
    File(String),
}

/// What a file of that name states something for; none where it holds readings. A statement ends in `.toml`; letter case does
/// not count, nor how marks above letters are written.
pub fn states_for(name: &OsStr) -> Option<StatesFor> {
    let name = compared(name);
    match name.strip_suffix(".toml")? {
        "tags" => Some(StatesFor::Folder),
        file => Some(StatesFor::File(file.to_owned())),
    }
}

/// The form in which names are compared: that of Macs and that of others of the same letters is one, and so are small and
/// capital letters.
pub fn compared(name: &OsStr) -> String {
    composed(&display_path(Path::new(name)).to_lowercase())
}

/// A text with each letter and its marks as one character (Unicode form NFC), as all but Macs write it.
pub fn composed(text: &str) -> String {
    text.nfc().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn own_products_are_known_by_their_place() {
        for own in [
            "archive/ab/abc.csv",
            "report",
            "campaign.db",
            "campaign.db-wal",
            "campaign.db.lock",
            "backups/x",
        ] {
            assert!(is_own_product(Path::new(own)), "{own}");
        }
        for other in [
            "runs/report/a.csv",
            "runs/campaign.db",
            "campaign.toml",
            "reports/a.csv",
            "",
        ] {
            assert!(!is_own_product(Path::new(other)), "{other}");
        }
    }

    #[test]
    fn passing_names_are_left_out() {
        for name in [
            ".hidden",
            "a.csv~",
            "a.TMP",
            "b.part",
            "c.filepart",
            "d.crdownload",
            "~$e.xlsx",
            "Thumbs.db",
            "Desktop.ini",
        ] {
            assert!(is_passing_name(OsStr::new(name)), "{name}");
        }
        for name in [
            "a.csv",
            "part",
            "a.partial.csv",
            "temp.dta",
            "thumbs.db.csv",
            "a~b.csv",
        ] {
            assert!(!is_passing_name(OsStr::new(name)), "{name}");
        }
    }

    #[test]
    fn a_statement_is_for_the_file_of_its_name_however_that_is_written() {
        let file = |name: &str| Some(StatesFor::File(name.to_owned()));
        for (name, states) in [
            ("a.csv.toml", file("a.csv")),
            ("A.CSV.Toml", file("a.csv")),
            ("a.toml", file("a")),
            ("So\u{308}.csv.toml", file("s\u{f6}.csv")),
            ("S\u{d6}.csv.toml", file("s\u{f6}.csv")),
            ("TAGS.TOML", Some(StatesFor::Folder)),
            ("toml.csv", None),
        ] {
            assert_eq!(states_for(OsStr::new(name)), states, "{name}");
        }
        assert_eq!(
            compared(OsStr::new("So\u{308}.csv")),
            compared(OsStr::new("s\u{f6}.CSV"))
        );
    }
}
