//! Damage of the files of a campaign while nobody works on it.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::room::{Base, CAMPAIGN, base, files};
use super::verbs::{DATABASE, LOCK, LOG, WORDS};

/// A sector, bytes.
const SECTOR: usize = 512;
/// A page of the database, bytes.
const PAGE: usize = 4096;
/// Seed of where bits are flipped.
const SEED: u64 = 20_261_127;

/// What is damaged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Damage {
    /// A sector of the database reads as zeros.
    Sector,
    /// The same, and a bit of a number that is shown is flipped.
    SectorAndNumber,
    /// A bit of the database is flipped: each of the eight, in each part of each page.
    Bit,
    /// A page that was written is as it was before.
    LostPage,
    /// An older database, with the log of the last change.
    OlderDatabase,
    /// Older words.
    OlderWords,
    /// The words are cut at a line end.
    WordsCut,
    /// A bit of a line of the words is flipped.
    WordsFlipped,
    /// The words are gone.
    WordsGone,
    /// The lock file is gone, or holds what no lock writes.
    Lock,
    /// A raw file of the archive is gone, or a bit of it is flipped.
    RawFile,
}

/// A change of a campaign's files.
type Change = Box<dyn Fn(&Path)>;

/// One place of a damage, in words, and how it is done.
pub struct DamagedPlace {
    pub name: String,
    pub does: Change,
}

impl Damage {
    /// Every place that it may have.
    pub fn places(self) -> Vec<DamagedPlace> {
        let base = base();
        match self {
            Damage::Sector => sectors(base, false),
            Damage::SectorAndNumber => sectors(base, true),
            Damage::Bit => bits(base),
            Damage::LostPage => lost_pages(base),
            Damage::OlderDatabase => older_databases(base),
            Damage::OlderWords => vec![words("those before the last", base.older_words.clone())],
            Damage::WordsCut => cut_words(base),
            Damage::WordsFlipped => flipped_words(base),
            Damage::WordsGone => vec![gone(WORDS)],
            Damage::Lock => vec![
                gone(LOCK),
                written("another word", LOCK, b"process 1 on another\n".to_vec()),
            ],
            Damage::RawFile => raw_files(),
        }
    }
}

fn place(name: impl Into<String>, does: impl Fn(&Path) + 'static) -> DamagedPlace {
    DamagedPlace {
        name: name.into(),
        does: Box::new(does),
    }
}

fn written(name: &str, file: &'static str, bytes: Vec<u8>) -> DamagedPlace {
    place(name, move |campaign| {
        fs::write(campaign.join(file), &bytes).unwrap()
    })
}

fn words(name: &str, bytes: Vec<u8>) -> DamagedPlace {
    written(name, WORDS, bytes)
}

fn gone(file: &'static str) -> DamagedPlace {
    place(format!("{file} gone"), move |campaign| {
        fs::remove_file(campaign.join(file)).unwrap()
    })
}

/// The database with other bytes, and nothing beside it.
fn database(name: impl Into<String>, change: impl Fn(&mut Vec<u8>) + 'static) -> DamagedPlace {
    place(name, move |campaign| {
        let mut bytes = base().database.clone();
        change(&mut bytes);
        put(campaign, &bytes);
    })
}

fn put(campaign: &Path, database: &[u8]) {
    for companion in ["-wal", "-shm"] {
        let _ = fs::remove_file(campaign.join(format!("{DATABASE}{companion}")));
    }
    fs::write(campaign.join(DATABASE), database).unwrap();
}

fn sectors(base: &Base, with_number: bool) -> Vec<DamagedPlace> {
    let number = number_shown(base);
    let all = (0..base.database.len() / SECTOR).map(|sector| {
        let span = sector * SECTOR..(sector + 1) * SECTOR;
        // A word at the end of the one before is a part of this one's name, too.
        let near = span.start.saturating_sub(8)..(span.end + 8).min(base.database.len());
        let name = format!("sector {sector}: {}", text_of(&base.database[near]));
        database(name, move |bytes| {
            if with_number {
                bytes[number] ^= 1;
            }
            bytes[span.clone()].fill(0);
        })
    });
    all.collect()
}

/// The text that stands in some bytes.
fn text_of(bytes: &[u8]) -> String {
    let parts = bytes.split(|byte| !byte.is_ascii_graphic() && *byte != b' ');
    let words: Vec<String> = parts
        .filter(|part| part.len() > 3)
        .map(|part| String::from_utf8_lossy(part).into_owned())
        .collect();
    words.join(" ")
}

/// Where a digit of a λ that is shown lies in the database: the document of its fit holds it as JSON writes a number. Another
/// last bit of a digit is another digit.
fn number_shown(base: &Base) -> usize {
    let number = serde_json::to_string(&base.lambda_per_s).unwrap();
    let found = base
        .database
        .windows(number.len())
        .position(|window| window == number.as_bytes());
    let digit = number.rfind(|c: char| ('1'..='8').contains(&c)).unwrap();
    found.expect("the database holds the number") + digit
}

/// What the database calls what begins on a page; nothing where a page goes on with what begins on another one.
fn names_of_pages() -> BTreeMap<usize, String> {
    let database = base().room().join(CAMPAIGN).join(DATABASE);
    let connection = rusqlite::Connection::open(database).unwrap();
    let sql = "SELECT rootpage - 1, name FROM sqlite_schema WHERE rootpage > 0";
    let mut statement = connection.prepare(sql).unwrap();
    let rows = statement.query_map([], |row| Ok((row.get::<_, i64>(0)?, row.get(1)?)));
    let named = rows.unwrap().map(Result::unwrap);
    named
        .map(|(page, name)| (usize::try_from(page).unwrap(), name))
        .collect()
}

fn bits(base: &Base) -> Vec<DamagedPlace> {
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let names = names_of_pages();
    let mut places = Vec::new();
    for page in 0..base.database.len() / PAGE {
        for (part, from, to) in parts_of(&base.database[page * PAGE..(page + 1) * PAGE], page) {
            for bit in 0..8 {
                let at = page * PAGE + rng.random_range(from..to);
                let of = names.get(&page).map_or("", String::as_str);
                let name = format!("page {page} {of}, {part}, byte {at}, bit {bit}");
                places.push(database(name, move |bytes| bytes[at] ^= 1 << bit));
            }
        }
    }
    places
}

/// The parts of a page that are not empty: its head, what points to its cells, the space between, and the cells.
fn parts_of(bytes: &[u8], page: usize) -> Vec<(&'static str, usize, usize)> {
    let head = if page == 0 { 100 } else { 0 };
    let two = |at: usize| usize::from(bytes[at]) << 8 | usize::from(bytes[at + 1]);
    let cells = two(head + 5).clamp(head + 8, PAGE - 1);
    let pointers = (head + 8 + 2 * two(head + 3)).min(cells);
    let parts = [
        ("head", 0, head + 8),
        ("pointers", head + 8, pointers),
        ("space", pointers, cells),
        ("cells", cells, PAGE),
    ];
    parts.into_iter().filter(|(_, from, to)| from < to).collect()
}

fn lost_pages(base: &Base) -> Vec<DamagedPlace> {
    let (mut places, names) = (Vec::new(), names_of_pages());
    for (age, older) in base.older.iter().enumerate() {
        for page in 0..base.database.len() / PAGE {
            let span = page * PAGE..(page + 1) * PAGE;
            let before = older
                .get(span.clone())
                .map_or_else(|| vec![0; PAGE], <[u8]>::to_vec);
            if before != base.database[span.clone()] {
                let of = names.get(&page).map_or("", String::as_str);
                let name = format!(
                    "page {page} {of} as it was {}",
                    ["first", "before the last word"][age]
                );
                places.push(database(name, move |bytes| {
                    bytes[span.clone()].copy_from_slice(&before)
                }));
            }
        }
    }
    places
}

fn older_databases(base: &Base) -> Vec<DamagedPlace> {
    let mut places = Vec::new();
    for (age, older) in base.older.iter().enumerate() {
        for (log, bytes) in [("no log", None), ("the last log", Some(base.log.clone()))] {
            let name = format!(
                "the one {}, with {log}",
                ["before any word", "before the last word"][age]
            );
            let older = older.clone();
            places.push(place(name, move |campaign| {
                put(campaign, &older);
                if let Some(bytes) = &bytes {
                    fs::write(campaign.join(LOG), bytes).unwrap();
                }
            }));
        }
    }
    places
}

/// The ends of the lines of the words.
fn line_ends(base: &Base) -> Vec<usize> {
    let ends = base.words.iter().enumerate().filter(|(_, byte)| **byte == b'\n');
    ends.map(|(at, _)| at + 1).collect()
}

fn cut_words(base: &Base) -> Vec<DamagedPlace> {
    let ends = line_ends(base);
    let kept = ends.iter().enumerate().rev().skip(1);
    kept.map(|(n, end)| words(&format!("after line {}", n + 1), base.words[..*end].to_vec()))
        .collect()
}

fn flipped_words(base: &Base) -> Vec<DamagedPlace> {
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let mut begin = 0;
    let flipped = line_ends(base).into_iter().enumerate().map(|(n, end)| {
        let at = rng.random_range(begin..end - 1);
        begin = end;
        let mut bytes = base.words.clone();
        bytes[at] ^= 1;
        words(&format!("line {}, byte {at}", n + 1), bytes)
    });
    flipped.collect()
}

fn raw_files() -> Vec<DamagedPlace> {
    let archive = Path::new(WORDS).parent().unwrap();
    let campaign = base().room().join(CAMPAIGN);
    let mut places = Vec::new();
    for file in files(&campaign.join(archive)) {
        let inside = file.strip_prefix(&campaign).unwrap().to_owned();
        if inside.components().count() < 3 {
            continue;
        }
        let (one, other) = (inside.clone(), inside.clone());
        places.push(place(format!("{} gone", inside.display()), move |campaign| {
            fs::remove_file(campaign.join(&one)).unwrap();
        }));
        places.push(place(format!("{} flipped", inside.display()), move |campaign| {
            let path = campaign.join(&other);
            let mut bytes = fs::read(&path).unwrap();
            let middle = bytes.len() / 2;
            bytes[middle] ^= 1;
            fs::remove_file(&path).unwrap();
            fs::write(&path, bytes).unwrap();
        }));
    }
    places
}
