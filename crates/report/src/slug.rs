//! File names of run pages: safe on every file system, unique, and the same whatever other runs there are.

use std::collections::HashSet;

/// Readable characters kept of a path.
const READABLE: usize = 60;

/// Page names that are given, so that each is given once.
#[derive(Debug, Default)]
pub struct Slugs {
    taken: HashSet<String>,
}

impl Slugs {
    /// The page name of a path, without `.html`.
    ///
    /// The readable part is lower case (some file systems do not tell `A` from `a`); the hash of the path makes
    /// it unique and keeps a link valid when other runs come and go.
    pub fn next(&mut self, path: &str) -> String {
        let hash = blake3::hash(path.as_bytes()).to_hex();
        let mut slug = format!("{}-{}", readable(path), &hash[..8]);
        if !self.taken.insert(slug.clone()) {
            slug = format!("{}-{hash}-{}", readable(path), self.taken.len());
            self.taken.insert(slug.clone());
        }
        slug
    }
}

/// One page name per path, in the order of `paths`.
pub fn slugs<'a>(paths: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut given = Slugs::default();
    paths.map(|path| given.next(path)).collect()
}

fn readable(path: &str) -> String {
    let path = path.strip_prefix("runs/").unwrap_or(path);
    let mut slug = String::new();
    for character in path.chars() {
        match character.to_ascii_lowercase() {
            kept @ ('a'..='z' | '0'..='9') => slug.push(kept),
            '.' if slug.ends_with(|c: char| c.is_ascii_digit()) => slug.push('.'),
            _ if !slug.is_empty() && !slug.ends_with(['-', '.']) => slug.push('-'),
            _ => {}
        }
        if slug.len() >= READABLE {
            break;
        }
    }
    let trimmed = slug.trim_matches(['-', '.']);
    if trimmed.is_empty() {
        "run".to_owned()
    } else {
        trimmed.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn names_stay_readable() {
        let slug = &slugs(["runs/CNaf-01_air_2.5V_3.csv"].into_iter())[0];
        assert!(
            slug.starts_with("cnaf-01-air-2.5v-3-csv-") || slug.starts_with("cnaf-01-air-2.5v-3.csv-"),
            "{slug}"
        );
    }

    #[test]
    fn equal_paths_still_get_different_pages() {
        let both = slugs(["a.csv", "a.csv"].into_iter());
        assert_ne!(both[0], both[1]);
    }

    proptest! {
        #[test]
        fn safe_and_unique_for_any_name(paths in proptest::collection::vec(".{0,80}", 1..20)) {
            let slugs = slugs(paths.iter().map(String::as_str));
            let distinct: HashSet<&String> = slugs.iter().collect();
            prop_assert_eq!(distinct.len(), slugs.len());
            for slug in &slugs {
                prop_assert!(slug.len() <= 150);
                prop_assert!(slug.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-' || c == '.'));
                prop_assert!(slug.starts_with(|c: char| c.is_ascii_alphanumeric()));
            }
        }
    }
}
