//! One trial: a verb is disturbed at one place.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, LazyLock, Mutex};

use ieap::system::FaultInjector;

use super::damage::Damage;
use super::disturber::{Act, Disturber};
use super::judge::{Expected, Judged, Reference, Verdict, held, reference, said, silent};
use super::meets::Meets;
use super::room::{AGAIN, BACKUP, CAMPAIGN, RESTORED, SAID, room};
use super::verbs::{Ended, Verb, ended, rebuild, restore};
use crate::world::within;

/// What disturbs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum How {
    /// One call of the verb.
    Call(Act),
    /// The files, before the verb.
    Damaged(Damage),
    /// Both.
    Both(Damage, Act),
    /// The verb is asked for twice within one second.
    Twice,
}

/// Names of all places of a verb that is disturbed so.
pub fn places(how: How, verb: Verb) -> Vec<String> {
    match how {
        How::Call(act) => recorded(verb, None).places(act),
        How::Both(damage, act) => recorded(verb, Some(damage)).places(act),
        How::Damaged(damage) => damage.places().into_iter().map(|place| place.name).collect(),
        How::Twice => vec!["in one second".to_owned()],
    }
}

/// A computer on which a verb was asked for and not disturbed.
fn recorded(verb: Verb, damage: Option<Damage>) -> Arc<Disturber> {
    type Known = BTreeMap<(Verb, Option<Damage>), Arc<Disturber>>;
    static KNOWN: LazyLock<Mutex<Known>> = LazyLock::new(Mutex::default);
    let made = || {
        let room = room();
        damage
            .into_iter()
            .for_each(|damage| damaged(damage, None, room.path()));
        let computer = Arc::new(Disturber::new(room.path(), None));
        let world: Arc<dyn FaultInjector> = Arc::clone(&computer) as Arc<_>;
        within(&world, || verb.ask(room.path())).unwrap();
        computer
    };
    let mut known = KNOWN.lock().unwrap();
    Arc::clone(known.entry((verb, damage)).or_insert_with(made))
}

/// Damages the campaign of a room at the place of that name, or at the first one.
fn damaged(damage: Damage, name: Option<&str>, room: &Path) {
    let places = damage.places();
    let one = places
        .iter()
        .find(|place| name.is_none_or(|name| place.name == name));
    (one.expect("a place of that name").does)(&room.join(CAMPAIGN));
}

/// Disturbs a verb at one place; none where it does not come to that place.
pub fn tried(how: How, verb: Verb, place: &str) -> Option<Judged> {
    let room = room();
    let path = room.path();
    let act = match how {
        How::Call(act) => Some(act),
        How::Both(damage, act) => {
            damaged(damage, None, path);
            Some(act)
        }
        How::Damaged(damage) => {
            damaged(damage, Some(place), path);
            None
        }
        How::Twice => None,
    };
    let computer = Arc::new(Disturber::new(path, act.map(|act| (act, place.to_owned()))));
    let world: Arc<dyn FaultInjector> = Arc::clone(&computer) as Arc<_>;
    let times = if how == How::Twice { 2 } else { 1 };
    let mut kept = Vec::new();
    let mut end = None;
    for _ in 0..times {
        let done = within(&world, || verb.ask(path));
        end = done.ok().filter(|_| !computer.is_dead());
        kept.extend(
            end.iter()
                .filter_map(|end| Some((end.kept.clone()?, hash_of(end.kept.as_deref()?)))),
        );
    }
    let (met, happened) = computer.finish();
    if act.is_some() && !happened {
        return None;
    }
    let other = match act {
        Some(Act::Meets(other)) => Some(other),
        _ => None,
    };
    let is_damaged = matches!(how, How::Damaged(_));
    let trial = Trial {
        verb,
        end,
        other,
        met,
        is_damaged,
    };
    if let Some((file, _)) = kept.iter().find(|(file, hash)| hash_of(file) != *hash) {
        return Some(silent(
            Verdict::Loss,
            format!("{}, which was set aside, is overwritten", file.display()),
        ));
    }
    Some(trial.judged(path))
}

fn hash_of(file: &Path) -> Option<blake3::Hash> {
    Some(blake3::hash(&std::fs::read(file).ok()?))
}

/// What was done in a trial.
struct Trial {
    verb: Verb,
    /// How the verb ended; none where it was ended by force.
    end: Option<Ended>,
    other: Option<Meets>,
    met: Option<Ended>,
    /// Whether the campaign was damaged before: what refuses it tells so.
    is_damaged: bool,
}

impl Trial {
    fn status(&self) -> Option<i32> {
        self.end.as_ref().map(|end| end.status)
    }

    fn judged(&self, room: &Path) -> Judged {
        let told = self.status() == Some(3);
        if self.is_damaged && self.status() == Some(4) {
            let mended = ended(|| rebuild(&room.join(CAMPAIGN)));
            let judged = held(&room.join(CAMPAIGN), &self.expected(true), mended.status != 0);
            return said().max(judged);
        }
        let is_done = [Some(0), Some(3)].contains(&self.status());
        let inside = self.expected(true);
        let judged = match self.verb {
            Verb::Restore if is_done => held(&room.join(RESTORED), &self.expected(false), told),
            Verb::Restore => said(),
            Verb::Backup | Verb::BackupAgain => {
                let campaign = held(&room.join(CAMPAIGN), &inside, told);
                let has_one = is_done || self.verb == Verb::BackupAgain;
                if campaign.verdict > Verdict::Said || !has_one {
                    campaign
                } else {
                    self.brought_back(room, told).max(campaign)
                }
            }
            _ => held(&room.join(CAMPAIGN), &inside, told),
        };
        match judged.verdict {
            Verdict::NoEffect if self.status() != Some(0) => Judged {
                verdict: Verdict::Said,
                ..judged
            },
            _ => judged,
        }
    }

    /// What the backup gives.
    fn brought_back(&self, room: &Path, told: bool) -> Judged {
        let backup = if self.verb == Verb::Backup { AGAIN } else { BACKUP };
        let folder = room.join(RESTORED);
        let end = ended(|| restore(&room.join(backup), &folder).map(|status| (status, None)));
        match end.status {
            0 | 3 => held(&folder, &self.expected(false), told || end.status == 3),
            _ => Judged {
                verdict: Verdict::Said,
                why: format!("the backup is refused with {}", end.status),
            },
        }
    }

    /// What must hold of the campaign, or of a copy that may have been made before anything was said.
    fn expected(&self, inside: bool) -> Expected {
        let word = self.verb.word().map(|_| self.verb);
        let is_said = self.status() == Some(0) && inside;
        let is_met = self.met.as_ref().is_some_and(|met| met.status == 0) && inside;
        let other = self.other.filter(|other| other.changes());
        let verbs = if is_said { vec![word] } else { both(word) };
        let none = (!is_met).then_some(None);
        let seen = other.into_iter().flat_map(Meets::seen_as).map(Some);
        let others: Vec<Option<Meets>> = match other {
            None => vec![None],
            Some(_) => none.into_iter().chain(seen).collect(),
        };
        let mut said = SAID.to_vec();
        said.extend(word.filter(|_| is_said).and_then(Verb::word));
        said.extend(other.filter(|_| is_met).and_then(Meets::word));
        let of = |verbs: &[Option<Verb>], others: &[Option<Meets>]| -> Vec<Arc<Reference>> {
            let pairs = verbs
                .iter()
                .flat_map(|verb| others.iter().map(|other| (*verb, *other)));
            pairs.map(|(verb, other)| reference(verb, other)).collect()
        };
        Expected {
            is_copy: !inside,
            said,
            at_once: of(&both(word), &both(other)),
            settled: of(&verbs, &others),
        }
    }
}

/// None, and that where there is one.
fn both<T: Copy>(one: Option<T>) -> Vec<Option<T>> {
    [None].into_iter().chain(one.map(Some)).collect()
}
