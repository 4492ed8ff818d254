//! What is disturbed, and how; each row of the table.

use super::damage::Damage;
use super::disturber::Act;
use super::meets::Meets;
use super::trial::How;
use super::verbs::Verb;

/// A disturbance, and the verbs that meet it.
#[derive(Debug)]
pub struct Row {
    pub name: &'static str,
    pub how: How,
    pub verbs: &'static [Verb],
}

const fn call(name: &'static str, act: Act) -> Row {
    let (how, verbs) = (How::Call(act), Verb::CHANGING);
    Row { name, how, verbs }
}

const fn meets(name: &'static str, other: Meets) -> Row {
    let (how, verbs) = (How::Call(Act::Meets(other)), Verb::BESIDE);
    Row { name, how, verbs }
}

const fn damaged(name: &'static str, damage: Damage) -> Row {
    let (how, verbs) = (How::Damaged(damage), Verb::MEETING);
    Row { name, how, verbs }
}

const fn both(name: &'static str, damage: Damage, act: Act, verbs: &'static [Verb]) -> Row {
    let how = How::Both(damage, act);
    Row { name, how, verbs }
}

pub const ROWS: &[Row] = &[
    call("a call fails once (EIO)", Act::Fails),
    call("a listing fails once (EIO)", Act::ListFails),
    call("a path stays unreadable (EMFILE)", Act::StaysUnreadable),
    call("the disk is full, once", Act::DiskFull),
    call("a sync fails, the power goes later", Act::SyncFails),
    call("killed", Act::Killed),
    call("the power goes", Act::PowerLost),
    call("the clock is set back a year", Act::ClockBack),
    meets("a run and a sidecar are saved", Meets::Save),
    meets("a run is renamed", Meets::Rename),
    meets("a run is tagged", Meets::Tag),
    meets("a second program takes in", Meets::Run),
    meets("the same, lock file deleted", Meets::RunWithoutLock),
    meets("a second program rebuilds", Meets::Rebuild),
    Row {
        name: "twice with a frozen clock",
        how: How::Twice,
        verbs: &[
            Verb::Run,
            Verb::Watch,
            Verb::Tag,
            Verb::Drop,
            Verb::Rebuild,
            Verb::BackupAgain,
        ],
    },
    damaged("a sector is zeroed", Damage::Sector),
    damaged("a sector is zeroed, a number flipped", Damage::SectorAndNumber),
    damaged("a bit is flipped", Damage::Bit),
    damaged("a written page is lost", Damage::LostPage),
    damaged("an older database, a newer log", Damage::OlderDatabase),
    damaged("an older words file", Damage::OlderWords),
    damaged("the words file is cut", Damage::WordsCut),
    damaged("a bit of the words is flipped", Damage::WordsFlipped),
    damaged("the words file is gone", Damage::WordsGone),
    damaged("the lock file is gone or foreign", Damage::Lock),
    damaged("a raw file is gone or flipped", Damage::RawFile),
    both(
        "older words, a path stays unreadable",
        Damage::OlderWords,
        Act::StaysUnreadable,
        Verb::INSIDE,
    ),
    both(
        "words flipped, a run is tagged",
        Damage::WordsFlipped,
        Act::Meets(Meets::Tag),
        Verb::INSIDE,
    ),
    both(
        "words flipped, killed",
        Damage::WordsFlipped,
        Act::Killed,
        Verb::INSIDE,
    ),
];
