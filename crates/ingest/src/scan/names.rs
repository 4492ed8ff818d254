//! What the name of a file in the campaign folder says of it.

use std::ffi::OsStr;
use std::path::{Component, Path};

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

/// Whether a file of that name states tags or the campaign rather than readings: any `.toml`.
pub fn is_statement(name: &OsStr) -> bool {
    name.to_string_lossy().to_lowercase().ends_with(".toml")
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
        assert!(is_statement(OsStr::new("a.csv.toml")) && is_statement(OsStr::new("TAGS.TOML")));
        assert!(!is_statement(OsStr::new("toml.csv")));
    }
}
