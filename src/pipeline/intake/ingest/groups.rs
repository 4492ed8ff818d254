//! Which files make one run: a file of its own, or the parts of one stem.

use std::collections::BTreeMap;

/// Parts that a run may be recorded in, `a.current.csv` beside `a.curvature.csv`.
const PARTS: [&str; 10] = [
    "current",
    "curvature",
    "voltage",
    "displacement",
    "tip_displacement",
    "force",
    "blocking_force",
    "temperature",
    "humidity",
    "modulus",
];

/// Ending of a folder of frames that belongs to a run, `a.frames` beside `a.csv` or `a.current.csv`.
const FRAMES: &str = "frames";

/// Name of the run that the file at `path` (relative, with `/`) belongs to: `runs/a.csv` for
/// `runs/a.current.csv`, else the path itself.
pub fn run_name(path: &str) -> String {
    let (folder, file) = path
        .rsplit_once('/')
        .map_or(("", path), |(folder, file)| (folder, file));
    let mut pieces: Vec<&str> = file.split('.').collect();
    // A folder of frames belongs to the run of its stem, whose other readings are a text.
    if let Some(last) = pieces.last_mut().filter(|last| **last == FRAMES) {
        *last = "csv";
    }
    if pieces.len() >= 3 {
        let part = pieces[pieces.len() - 2].to_ascii_lowercase();
        if PARTS.contains(&part.as_str()) {
            pieces.remove(pieces.len() - 2);
        }
    }
    let file = pieces.join(".");
    if folder.is_empty() {
        file
    } else {
        format!("{folder}/{file}")
    }
}

/// Groups paths by the run they belong to, both in order; files of a pair stay together.
pub fn grouped<'a>(
    paths: impl Iterator<Item = &'a str>,
    pairs: &[(String, [String; 2])],
) -> BTreeMap<String, Vec<&'a str>> {
    let of_pair: BTreeMap<&str, (&String, usize)> = pairs
        .iter()
        .flat_map(|(run, files)| {
            files
                .iter()
                .enumerate()
                .map(move |(at, file)| (file.as_str(), (run, at)))
        })
        .collect();
    let mut groups: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for path in paths {
        let run = of_pair
            .get(path)
            .map_or_else(|| run_name(path), |(run, _)| (*run).clone());
        groups.entry(run).or_default().push(path);
    }
    // A pair is in the order in which it was joined, the current first.
    for group in groups.values_mut() {
        group.sort_by_key(|path| of_pair.get(path).map(|(_, at)| *at));
    }
    groups
}

/// Words that programs and people put into the name of a copy.
const OF_A_COPY: [&str; 7] = ["copy", "copie", "kopie", "koopia", "copia", "cópia", "копия"];

/// Whether a name is that of a copy: `a (copie).txt`, `a - Kopie.txt`, `a (2).txt`.
pub fn is_named_as_copy(path: &str) -> bool {
    let file = path.rsplit('/').next().unwrap_or(path).to_lowercase();
    let stem = file.rsplit_once('.').map_or(file.as_str(), |(stem, _)| stem);
    let is_word = |word: &str| OF_A_COPY.contains(&word);
    let numbered = stem.strip_suffix(')').and_then(|rest| rest.rsplit_once('('));
    let is_number =
        |(_, number): (&str, &str)| !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit());
    stem.split(|c: char| !c.is_alphabetic()).any(is_word) || numbered.is_some_and(is_number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_are_told_by_their_names() {
        for name in ["r/a (copie).txt", "r/a - Kopie.txt", "a (2).txt", "copy of a.csv"] {
            assert!(is_named_as_copy(name), "{name}");
        }
        for name in ["r/a.txt", "copyright.txt", "a (air).txt", "a().txt"] {
            assert!(!is_named_as_copy(name), "{name}");
        }
    }

    #[test]
    fn parts_of_one_stem_share_a_run() {
        assert_eq!(run_name("runs/a.current.csv"), "runs/a.csv");
        assert_eq!(run_name("runs/a.Curvature.csv"), "runs/a.csv");
        assert_eq!(run_name("runs/a.b.csv"), "runs/a.b.csv");
        assert_eq!(run_name("current.csv"), "current.csv");
        assert_eq!(run_name("runs/a.frames"), "runs/a.csv");
        let groups = grouped(
            ["r/a.current.csv", "r/a.curvature.csv", "r/b.csv"].into_iter(),
            &[],
        );
        assert_eq!(groups.len(), 2);
        assert_eq!(groups["r/a.csv"].len(), 2);
    }
}
