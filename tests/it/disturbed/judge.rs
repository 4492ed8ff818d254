//! What must hold of a campaign after a trial, whatever keeps it.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, LazyLock, Mutex};

use super::answers::Answers;
use super::meets::Meets;
use super::room::{CAMPAIGN, room};
use super::verbs::{Verb, Word, ended, rebuild, settle, stored};

/// What came of a trial.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// All is as without the disturbance, and nothing was said.
    NoEffect,
    /// Something was refused, or said to be lost, with status 3 or 4.
    Said,
    /// A word that was acknowledged is not there, and nothing says so.
    Loss,
    /// A number is another one, and nothing says so.
    Change,
    /// What is stored is not what `rebuild` makes.
    Parted,
}

/// What came of a trial, and why.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Judged {
    pub verdict: Verdict,
    pub why: String,
}

pub fn silent(verdict: Verdict, why: String) -> Judged {
    Judged { verdict, why }
}

pub fn said() -> Judged {
    let why = String::new();
    Judged {
        verdict: Verdict::Said,
        why,
    }
}

/// What a campaign may answer.
pub struct Expected {
    /// Whether it is one that was restored: what a backup or a restoring said it left out stays out.
    pub is_copy: bool,
    /// Words that must be there.
    pub said: Vec<Word>,
    /// Right after the verb.
    pub at_once: Vec<Arc<Reference>>,
    /// When everything was taken in.
    pub settled: Vec<Arc<Reference>>,
}

/// What a campaign answers that nothing disturbed: right after a verb, and when everything was taken in.
pub struct Reference {
    at_once: Answers,
    settled: Answers,
}

/// What a campaign answers after these, undisturbed.
pub fn reference(verb: Option<Verb>, other: Option<Meets>) -> Arc<Reference> {
    type Known = BTreeMap<(Option<Verb>, Option<Meets>), Arc<Reference>>;
    static KNOWN: LazyLock<Mutex<Known>> = LazyLock::new(Mutex::default);
    let mut known = KNOWN.lock().unwrap();
    let made = || {
        let room = room();
        let campaign = room.path().join(CAMPAIGN);
        assert!(verb.is_none_or(|verb| verb.ask(room.path()).status == 0));
        assert!(other.is_none_or(|other| other.does(room.path()).status == 0));
        let at_once = Answers::of(&campaign);
        assert_eq!(settle(&campaign).unwrap(), 0);
        let settled = Answers::of(&campaign);
        Arc::new(Reference { at_once, settled })
    };
    Arc::clone(known.entry((verb, other)).or_insert_with(made))
}

impl Judged {
    pub fn max(self, other: Judged) -> Judged {
        if other.verdict > self.verdict { other } else { self }
    }
}

/// Holds a campaign that nothing disturbs any more against what must hold: right after a verb, which may have told that
/// something is left out; when everything was taken in; and after a rebuilding.
pub fn held(campaign: &Path, expected: &Expected, told: bool) -> Judged {
    let at_once = Answers::of(campaign);
    if let Some(found) = wrong_at_once(&at_once, expected).filter(|_| !told) {
        return found;
    }
    let settles = || ended(|| settle(campaign).map(|status| (status, None))).status;
    let (mut settled, mut rebuilt) = (settles(), 0);
    if ![0, 3].contains(&settled) {
        rebuilt = ended(|| rebuild(campaign)).status;
        settled = settles();
    }
    let later = Answers::of(campaign);
    let is_lost = (told && expected.is_copy)
        || [rebuilt, settled].iter().any(|status| [3, 4].contains(status))
        || later.told();
    if is_lost {
        return said();
    }
    if let Some(found) = wrong_later(&later, expected) {
        return found;
    }
    if let Some(found) = not_rebuilt(campaign) {
        return found;
    }
    let verdict = if at_once.told() || rebuilt != 0 {
        Verdict::Said
    } else {
        Verdict::NoEffect
    };
    Judged {
        verdict,
        why: String::new(),
    }
}

fn wrong_at_once(found: &Answers, expected: &Expected) -> Option<Judged> {
    let known = expected
        .at_once
        .iter()
        .flat_map(|known| [&known.at_once, &known.settled]);
    let known: Vec<&Answers> = known.collect();
    if let Some(word) = expected.said.iter().find(|word| found.lacks(word)) {
        return Some(silent(Verdict::Loss, format!("{word:?} is not shown at once")));
    }
    let other = found.other_numbers(&known).into_iter().next()?;
    Some(silent(Verdict::Change, format!("at once {other}")))
}

fn wrong_later(found: &Answers, expected: &Expected) -> Option<Judged> {
    if let Some(word) = expected.said.iter().find(|word| found.lacks(word)) {
        return Some(silent(Verdict::Loss, format!("{word:?} is not shown")));
    }
    let differences = expected
        .settled
        .iter()
        .map(|known| found.differences(&known.settled));
    let fewest = differences.min_by_key(Vec::len).unwrap_or_default();
    let first = fewest.into_iter().next()?;
    Some(silent(Verdict::Change, format!("later {first}")))
}

/// What is stored, held against what a rebuilding makes now.
fn not_rebuilt(campaign: &Path) -> Option<Judged> {
    let Ok(content) = stored(campaign) else {
        return Some(said());
    };
    match ended(|| rebuild(campaign)).status {
        0 => {}
        3 | 4 => return Some(said()),
        status => {
            return Some(silent(
                Verdict::Parted,
                format!("a rebuilding ends with {status}"),
            ));
        }
    }
    let rebuilt = stored(campaign).expect("a new database is whole");
    let (kind, name) = rebuilt.differences(&content).into_iter().next()?;
    Some(silent(Verdict::Parted, format!("rebuilt, {kind} {name} differs")))
}
