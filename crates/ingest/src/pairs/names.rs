//! Halves of a run that share the words of their names, across endings and folders.

use std::collections::BTreeSet;

use super::alone_with_key;
use super::half::Half;
use crate::name_pattern::{NoSurroundings, parts_of_name};
use ieap_domain::pairs::{HalfKind, PairedBy};
use ieap_domain::tag::keys;

/// Words for what a half holds or was recorded with: they tell no run from another.
const OF_A_HALF: &str = "current;voltage;curvature;displacement;tip;force;blocking;bending;electrical;laser;camera;cam;pot;\
     potentiostat;ec;it;ca;iv;i;u;v;x;d;courant;tension;déplacement;deplacement;caméra;flèche;fleche;\
     strom;spannung;weg;auslenkung;kamera;vool;pinge;siire;kaamera";

/// The words of a path: those of the folders below the first, and those of the name.
struct Words {
    folders: BTreeSet<String>,
    name: Vec<String>,
}

impl Words {
    fn of(path: &str, none: &NoSurroundings) -> Words {
        let (folders, stem) = parts_of(path);
        let mut name = parts_of_name(stem, none);
        name.sort_unstable();
        let folders = folders.split('/').skip(1);
        Words {
            folders: folders.flat_map(|folder| parts_of_name(folder, none)).collect(),
            name,
        }
    }
}

/// The folders of a path, and its name without the ending.
fn parts_of(path: &str) -> (&str, &str) {
    let (folders, file) = path.rsplit_once('/').unwrap_or(("", path));
    (folders, file.rsplit_once('.').map_or(file, |(stem, _)| stem))
}

/// What the names of all halves say together of which words are no surroundings.
pub(super) fn no_surroundings(halves: &[Half]) -> NoSurroundings {
    let names: BTreeSet<&str> = halves
        .iter()
        .flat_map(|half| {
            let (folders, stem) = parts_of(&half.path);
            folders.split('/').skip(1).chain([stem])
        })
        .collect();
    NoSurroundings::among(names.into_iter())
}

/// Pairs of open halves whose names share their words. Words that only names of one side have may be no more than what all
/// of them have, what the half holds, or a date; and what folders say must agree where both sides' folders say it, but where
/// names alone leave no choice.
pub(super) fn pairs(
    halves: &[Half],
    electrical: &[usize],
    bending: &[usize],
    none: &NoSurroundings,
) -> Vec<(usize, usize)> {
    let of = |side: &[usize]| -> Vec<(usize, Words)> {
        let words = side.iter().map(|&at| (at, Words::of(&halves[at].path, none)));
        words.collect()
    };
    let mut sides = (of(electrical), of(bending));
    let mut found = Vec::new();
    for with_folders in [true, false] {
        let keyed = |own: &[(usize, Words)], other: &[(usize, Words)]| {
            let shared = Shared::of(own, other, with_folders);
            let key = |(at, words): &(usize, Words)| Some((shared.key(words)?, *at));
            own.iter().filter_map(key).collect::<Vec<_>>()
        };
        let (e, b) = (keyed(&sides.0, &sides.1), keyed(&sides.1, &sides.0));
        let pairs = alone_with_key(e.into_iter(), b.into_iter());
        sides.0.retain(|(at, _)| pairs.iter().all(|(e, _)| e != at));
        sides.1.retain(|(at, _)| pairs.iter().all(|(_, b)| b != at));
        found.extend(pairs);
    }
    found
}

/// Words that both sides know, and those that all names of this side have.
struct Shared<'a> {
    names: BTreeSet<&'a str>,
    folders: BTreeSet<&'a str>,
    in_all: BTreeSet<&'a str>,
}

impl<'a> Shared<'a> {
    fn of(own: &'a [(usize, Words)], other: &'a [(usize, Words)], with_folders: bool) -> Shared<'a> {
        let names = other
            .iter()
            .flat_map(|(_, words)| words.name.iter().map(String::as_str));
        let folders = other
            .iter()
            .filter(|_| with_folders)
            .flat_map(|(_, words)| words.folders.iter().map(String::as_str));
        // What one name has says nothing of all.
        let first = own.first().filter(|_| own.len() > 1);
        let is_in_all = |word: &&str| own.iter().all(|(_, words)| words.name.iter().any(|w| w == word));
        let in_all = first
            .into_iter()
            .flat_map(|(_, words)| words.name.iter().map(String::as_str));
        Shared {
            names: names.collect(),
            folders: folders.collect(),
            in_all: in_all.filter(is_in_all).collect(),
        }
    }

    /// What the other side can know of a half; none where its name says more, or nothing that is shared.
    fn key(&self, words: &Words) -> Option<Vec<String>> {
        let (shared, own): (Vec<&String>, Vec<&String>) = words
            .name
            .iter()
            .partition(|word| self.names.contains(word.as_str()));
        let says_nothing =
            |word: &&String| self.in_all.contains(word.as_str()) || is_of_a_half(word) || is_date(word);
        let telling = shared.iter().filter(|word| !is_of_a_half(word));
        if telling.count() == 0 || !own.iter().all(says_nothing) {
            return None;
        }
        let folders = words
            .folders
            .iter()
            .filter(|word| self.folders.contains(word.as_str()));
        // A word of a half that both sides write, as `current` in a comment, tells nothing either.
        let key = shared.into_iter().filter(|word| !is_of_a_half(word));
        Some(key.chain(folders).cloned().collect())
    }
}

fn is_of_a_half(word: &str) -> bool {
    OF_A_HALF.split(';').any(|known| known == word)
}

/// Six digits and more: a day, a time of day, or both.
fn is_date(word: &str) -> bool {
    let digits = word.bytes().filter(u8::is_ascii_digit).count();
    digits >= 6
        && word
            .bytes()
            .all(|byte| byte.is_ascii_digit() || matches!(byte, b'-' | b'.' | b't' | b'h'))
}

/// Whether two names state different values of one thing. Two instruments count by themselves: numbers of records are none.
pub(super) fn contradict(one: &str, other: &str, none: &NoSurroundings) -> bool {
    let (one, other) = (Words::of(one, none).name, Words::of(other, none).name);
    let stated = |words: &[String]| -> Vec<(String, String)> {
        let pairs = words.iter().filter_map(|word| word.split_once('='));
        let pairs = pairs.filter(|(key, _)| *key != keys::CYCLE);
        pairs
            .map(|(key, value)| (key.to_owned(), value.to_owned()))
            .collect()
    };
    let other = stated(&other);
    stated(&one).iter().any(|(key, value)| {
        let mut of_key = other.iter().filter(|(known, _)| known == key).peekable();
        of_key.peek().is_some() && of_key.all(|(_, known)| known != value)
    })
}

/// The partner that a half waits for, in words: its name as those of the pairs show it, else what it must share.
pub(super) fn partner_of(
    halves: &[Half],
    lone: usize,
    pairs: &[(usize, usize, PairedBy)],
    none: &NoSurroundings,
) -> String {
    let half = &halves[lone];
    let of_pair = |&(e, b, _): &(usize, usize, PairedBy)| match half.kind {
        HalfKind::Electrical => (halves[e].path.as_str(), halves[b].path.as_str()),
        HalfKind::Bending => (halves[b].path.as_str(), halves[e].path.as_str()),
    };
    let holds = half.kind.partner();
    // A name is told where all pairs that lead to one lead to the same: else nobody ever called a file so.
    let names: BTreeSet<String> = pairs
        .iter()
        .map(of_pair)
        .filter_map(|(own, partner)| translated(&half.path, own, partner))
        .collect();
    let named = names.first().filter(|_| names.len() == 1);
    match named {
        Some(name) => format!("{name} with {holds}"),
        None => {
            let words = Words::of(&half.path, none).name;
            let words = words.iter().filter(|word| !is_of_a_half(word));
            let values: Vec<&str> = words
                .map(|word| word.split_once('=').map_or(word.as_str(), |(_, value)| value))
                .collect();
            format!(
                "a file with {holds} whose name shares the words {}",
                values.join(", ")
            )
        }
    }
}

/// The path that `path` has on the other side, where `own` has `partner`: pieces that both share are taken over.
fn translated(path: &str, own: &str, partner: &str) -> Option<String> {
    let pieces = |text: &str| -> Vec<String> {
        let mut pieces = vec![String::new()];
        for c in text.chars() {
            if matches!(c, '/' | '_' | ' ' | '.') {
                pieces.extend([c.to_string(), String::new()]);
            } else if let Some(last) = pieces.last_mut() {
                last.push(c);
            }
        }
        pieces
    };
    let (path, own, partner) = (pieces(path), pieces(own), pieces(partner));
    if path.len() != own.len() {
        return None;
    }
    let moved = |piece: &String| {
        let at = own
            .iter()
            .position(|known| known == piece && known.chars().any(char::is_alphanumeric));
        at.map_or(piece, |at| &path[at]).clone()
    };
    // What differs between the two of one side must have been found on the other side.
    let changed = path.iter().zip(&own).filter(|(new, old)| new != old);
    let is_found = changed.into_iter().all(|(_, old)| partner.contains(old));
    is_found.then(|| partner.iter().map(moved).collect())
}
