//! Profiles that cannot be read, and the files that they may be for: these wait, for another reader would read them in
//! another way without a word.

use std::collections::BTreeSet;
use std::ops::Deref;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::glob::Glob;
use super::{Profile, ProfileError};
use ieap_domain::Issue;

/// Texts of these beginnings are packed: what stands in them is not seen in their bytes.
const PACKED: [&[u8]; 3] = [b"PK", b"\xd0\xcf\x11\xe0", b"\x1f\x8b"];

/// Looks at a text, each without the lines that were wrong at the one before. Chosen: a slip or two are left out in as many.
const MOST_LOOKS: usize = 16;

/// The saved profiles of a campaign, and those among its files that cannot be read.
#[derive(Debug, Default)]
pub struct Profiles {
    /// Those that can be used, by id.
    pub saved: Vec<Profile>,
    /// Those that cannot.
    pub refused: Vec<RefusedProfile>,
}

impl Deref for Profiles {
    type Target = [Profile];

    fn deref(&self) -> &[Profile] {
        &self.saved
    }
}

impl Profiles {
    /// All of them, where all can be read.
    ///
    /// # Errors
    /// Why the first cannot.
    pub fn strict(mut self) -> Result<Profiles, ProfileError> {
        if self.refused.is_empty() {
            Ok(self)
        } else {
            Err(self.refused.swap_remove(0).error)
        }
    }

    /// A profile that cannot be read and may be for that file.
    pub fn waiting_for(&self, name: &str, bytes: &[u8]) -> Option<&RefusedProfile> {
        self.refused
            .iter()
            .find(|refused| refused.may_be_for(name, bytes))
    }
}

/// A profile that cannot be read.
#[derive(Debug)]
pub struct RefusedProfile {
    /// Its file, `profiles/laser.toml`.
    pub path: String,
    /// Why.
    pub error: ProfileError,
    /// What can be read of it all the same; none where the system does not give it, or nothing can be made of it.
    says: Option<Says>,
}

/// By what a profile recognises files, as far as it can be read.
#[derive(Debug, Default, PartialEq)]
struct Says {
    name: Option<Glob>,
    /// Texts and names of columns that all stand in the file.
    texts: BTreeSet<String>,
}

impl RefusedProfile {
    /// That of a file of which `text` is known.
    pub(super) fn new(path: String, error: ProfileError, text: Option<&str>) -> RefusedProfile {
        RefusedProfile {
            path,
            error,
            says: text.and_then(Says::of),
        }
    }

    /// What is said of it.
    pub fn issue(&self) -> Issue {
        Issue::error("profile-refused", self.error.to_string())
            .mend("files that it may be for wait until it can be read; what was read by it before stays")
    }

    /// What is said of a file that waits for it.
    pub fn issue_of_file(&self) -> Issue {
        let message = format!("{} cannot be read, and may say how this file is read", self.path);
        Issue::error("profile-not-read", message).mend(format!("mend the profile: {}", self.error))
    }

    /// Whether it may be for that file, as far as it can be told.
    fn may_be_for(&self, name: &str, bytes: &[u8]) -> bool {
        let Some(says) = &self.says else {
            return true;
        };
        // What recognises nothing is no profile: a sidecar that lies in the wrong folder.
        if says.name.is_none() && says.texts.is_empty() {
            return false;
        }
        let is_packed = PACKED.iter().any(|mark| bytes.starts_with(mark));
        says.name.as_ref().is_none_or(|glob| glob.fits(name)) && (is_packed || says.stands_in(bytes))
    }
}

impl Says {
    /// Without the lines that are wrong; none where what is left after some of them is wrong as well.
    fn of(text: &str) -> Option<Says> {
        let mut text = text.to_owned();
        for _ in 0..MOST_LOOKS {
            let (table, errors) = DeTable::parse_recoverable(&text);
            if errors.is_empty() {
                return Some(Says::of_table(table.get_ref()));
            }
            let wrong: BTreeSet<usize> = (errors.iter())
                .filter_map(|error| Some(text.get(..error.span()?.start)?.matches('\n').count()))
                .collect();
            let lines = text.split_inclusive('\n').enumerate();
            let left: String = lines
                .filter(|(at, _)| !wrong.contains(at))
                .map(|(_, line)| line)
                .collect();
            if left == text {
                return None;
            }
            text = left;
        }
        None
    }

    fn of_table(table: &DeTable<'_>) -> Says {
        let within = |first: &str, key: &str| table.get(first)?.get_ref().as_table()?.get(key);
        let column = |column: &Spanned<DeValue<'_>>| as_text(column.get_ref().as_table()?.get("column"));
        let contains = as_list(within("recognise", "contains")).iter();
        let columns = as_list(table.get("column")).iter();
        let times = ["column", "date_column"].map(|key| as_text(within("time", key)));
        let texts = contains
            .map(|text| as_text(Some(text)))
            .chain(columns.map(column))
            .chain(times);
        Says {
            name: as_text(within("recognise", "name")).map(|name| Glob::new(&name)),
            texts: texts.flatten().collect(),
        }
    }

    /// Whether all its texts stand there. The encoding is not known: only letters that all encodings share are looked for.
    fn stands_in(&self, bytes: &[u8]) -> bool {
        let plain: Vec<u8> = bytes.iter().copied().filter(|byte| *byte != 0).collect();
        let stands = |part: &str| plain.windows(part.len()).any(|found| found == part.as_bytes());
        let shared = |text: &String| -> Vec<String> {
            let parts = text.split(|letter: char| !letter.is_ascii());
            parts.filter(|part| !part.is_empty()).map(str::to_owned).collect()
        };
        self.texts.iter().flat_map(shared).all(|part| stands(&part))
    }
}

fn as_text(value: Option<&Spanned<DeValue<'_>>>) -> Option<String> {
    value?.get_ref().as_str().map(str::to_owned)
}

fn as_list<'t, 's>(value: Option<&'t Spanned<DeValue<'s>>>) -> &'t [Spanned<DeValue<'s>>] {
    value
        .and_then(|value| value.get_ref().as_array())
        .map_or(&[], |list| &**list)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PROFILE: &str = "[recognise]\nname = \"laser_*\"\ncontains = [\"µ Laser\"]\n[time]\ncolumn = \"Zeit\"\n[[column]]\ncolumn = \"Weg [µm]\"\nquantity = \"tip_displacement\"\n";

    fn refused(text: Option<&str>) -> RefusedProfile {
        let error = ProfileError::NotUtf8 { path: "a".into() };
        RefusedProfile::new("profiles/a.toml".to_owned(), error, text)
    }

    #[test]
    fn it_may_be_for_files_that_have_what_can_still_be_read_of_it() {
        let file = "\u{b5} Laser\nZeit;Weg [\u{b5}m]\n0;1\n".as_bytes();
        let wide: Vec<u8> = "x Laser\nZeit;Weg [xm]\n"
            .bytes()
            .flat_map(|byte| [byte, 0])
            .collect();
        // A line that is no TOML anywhere in it.
        for broken in ["", "oh no\n"] {
            for at in 0..=PROFILE.matches('\n').count() {
                let mut lines: Vec<&str> = PROFILE.split_inclusive('\n').collect();
                lines.insert(at, broken);
                let refused = refused(Some(&lines.concat()));
                assert!(refused.may_be_for("laser_1.csv", file), "{at} {broken:?}");
                assert!(refused.may_be_for("laser_1.csv", &wide), "{at} {broken:?}");
                assert!(refused.may_be_for("laser_1.xlsx", b"PK\x03\x04"));
                assert!(
                    !refused.may_be_for("laser_1.csv", b"time_s,current_a\n"),
                    "{at} {broken:?}"
                );
                assert!(!refused.may_be_for("other.csv", file), "{at} {broken:?}");
            }
        }
        assert!(refused(None).may_be_for("other.csv", b"time_s\n"));
        assert!(!refused(Some("sample = \"S1\"\n")).may_be_for("other.csv", b"time_s\n"));
    }
}
