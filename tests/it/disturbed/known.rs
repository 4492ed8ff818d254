//! What does not hold yet. Each of these is tried in every form of the test and must fail: one that holds again goes from
//! the list.

use super::verbs::Verb;

/// Places of a disturbance of a verb at which the program keeps silent.
#[derive(Debug)]
pub struct Known {
    /// Name of the row.
    pub row: &'static str,
    pub verb: Verb,
    /// Each place where it does has one of these in its name. What fits the first is tried in every form.
    pub places: &'static [&'static str],
    /// Why.
    #[expect(
        dead_code,
        reason = "it is printed where the place holds again, and read here"
    )]
    pub reason: &'static str,
}

impl Known {
    /// Whether it is of that row and verb.
    pub fn is_of(&self, row: &str, verb: Verb) -> bool {
        self.row == row && self.verb == verb
    }

    /// Whether it is of that place, too.
    pub fn has(&self, row: &str, verb: Verb, place: &str) -> bool {
        self.is_of(row, verb) && self.places.iter().any(|part| place.contains(part))
    }
}

const fn known(
    row: &'static str,
    verb: Verb,
    places: &'static [&'static str],
    reason: &'static str,
) -> Known {
    Known {
        row,
        verb,
        places,
        reason,
    }
}

const NO_SEALS: &str = "without the row that says of which schema the seals are no seal is looked at, and the next program \
                        that writes seals the wrong number anew";

const NO_INDEX: &str = "no seal is over an index: what is hashed as the content of the database is read by one, and is \
                        another than what the tables say, until `verify` looks at the structure";

const UNTAGGED: &str = "the tag is stored, but where a tag file cannot be read now its run is tagged by the next look: it is \
                        not shown until then, though `tag` ends with 0";

const ASIDE: &str = "what is set aside is named by the second";

const UNOPENED: &str =
    "a database that cannot be opened now is taken for a damaged one, and what only it knows is left out";

const UNLINKED: &str = "who waits for the lock of the words while they are written anew writes into a file that has no name any more";

const SECTOR: &str = "a sector is zeroed, a number flipped";
const PAGE: &str = "a written page is lost";
const BIT: &str = "a bit is flipped";
const OLDER: &str = "older words, a path stays unreadable";
const INDEXES: &[&str] = &[
    "run_word_path, cells",
    "run_word_path",
    "fit_current",
    "fit_run",
    "run_current",
];
const DATABASE: &[&str] = &[
    "Open c/campaign.db #",
    "Read c/campaign.db #",
    "Open c/campaign.db-wal #",
];
const ANEW: &[&str] = &["Lock c/archive/journal.jsonl #1", " c/archive"];

pub static KNOWN: &[Known] = &[
    known(
        "a sync fails, the power goes later",
        Verb::Restore,
        &["SyncAll"],
        "a sync that fails is thrown away",
    ),
    known("twice with a frozen clock", Verb::Rebuild, &[""], ASIDE),
    known(
        "a call fails once (EIO)",
        Verb::Tag,
        &["Stat c/runs/tags.toml #1", "toml"],
        UNTAGGED,
    ),
    known(
        "a path stays unreadable (EMFILE)",
        Verb::Tag,
        &["Open c/runs/tags.toml #1", "toml"],
        UNTAGGED,
    ),
    known(OLDER, Verb::Tag, &["Open c/runs/tags.toml #1", "toml"], UNTAGGED),
    known(OLDER, Verb::Rebuild, DATABASE, UNOPENED),
    known("words flipped, a run is tagged", Verb::Rebuild, ANEW, UNLINKED),
    known(SECTOR, Verb::Read, &["schema"], NO_SEALS),
    known(SECTOR, Verb::Run, &["schema"], NO_SEALS),
    known(SECTOR, Verb::Tag, &["schema"], NO_SEALS),
    known(PAGE, Verb::Read, &["run_word_path as it was first"], NO_INDEX),
    known(PAGE, Verb::Run, &["run_word_path as it was first"], NO_INDEX),
    known(PAGE, Verb::Tag, &["run_word_path as it was first"], NO_INDEX),
    known(BIT, Verb::Read, INDEXES, NO_INDEX),
    known(BIT, Verb::Run, INDEXES, NO_INDEX),
    known(BIT, Verb::Tag, INDEXES, NO_INDEX),
];
