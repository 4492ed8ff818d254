//! What files become in a campaign: where each goes, which tags its name gives, and what is still missing.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use schemars::JsonSchema;
use serde::Serialize;

use super::look::{Looked, Seen, Taken};
use crate::domain::campaign::BUILT_IN_ENVIRONMENTS;
use crate::domain::pairs::{LoneHalf, Pair, PairRules};
use crate::domain::tag::keys;
use crate::ingest::name_pattern::{
    KnownIds, NameMatch, NamePattern, NoSurroundings, ProposedPattern, environment, propose, tags_of_name,
};
use crate::ingest::pairs::{Half, Paired, pair};
use crate::ingest::run_sheet::pairs_of;
use crate::ingest::tags;

/// Tags by key.
type Tags = BTreeMap<String, String>;

/// A file with what it becomes.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct PlannedFile {
    /// What it is.
    #[serde(flatten)]
    pub seen: Seen,
    /// The other file of its run, where two are one.
    pub partner: Option<String>,
    /// Where it is copied to, relative to the campaign; none where it is not.
    pub to: Option<String>,
    /// Tags that are known of it, by key.
    pub tags: BTreeMap<String, String>,
    /// Those among them that the name pattern does not give: they are written beside the copy.
    pub beside: BTreeMap<String, String>,
    /// Tags without which the run waits.
    pub missing: Vec<&'static str>,
}

/// A sample that names speak of.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct NamedSample {
    /// Its id, as most names write it.
    pub id: String,
    /// Its material, as far as the id shows it.
    pub material: String,
    /// Runs that name it.
    pub runs: usize,
}

/// What a folder becomes.
#[derive(Debug)]
pub struct Plan {
    /// Its files.
    pub files: Vec<PlannedFile>,
    /// Samples by id.
    pub samples: Vec<NamedSample>,
    /// The pattern that explains the most names of runs.
    pub pattern: Option<ProposedPattern>,
    /// Files that are two of a run.
    pub pairs: Vec<Pair>,
    /// Files that hold half of a run and whose partner is not among them.
    pub lone: Vec<LoneHalf>,
}

/// Plans a campaign of the files that were looked at.
pub fn plan(looked: &Looked) -> Plan {
    let stem_of = |seen: &Seen| tags::stem(Path::new(&seen.path));
    let none = no_surroundings(looked);
    let Paired { pairs, lone } = paired(looked);
    // The run of two files has the name of the one with the current.
    let is_partner = |seen: &Seen| pairs.iter().any(|pair| pair.bending == seen.path);
    let is_run = |seen: &Seen| seen.taken == Taken::Run && !is_partner(seen);
    let runs: Vec<&Seen> = looked.files.iter().filter(|seen| is_run(seen)).collect();
    let stems: Vec<String> = runs.iter().map(|seen| stem_of(seen)).collect();
    let rows: Vec<Tags> = (runs.iter())
        .map(|seen| partner_rows(looked, &pairs, seen))
        .collect();
    let named: Vec<Tags> = (runs.iter().zip(&stems).zip(&rows))
        .map(|((seen, stem), rows)| named(seen, stem, rows, &none))
        .collect();
    let pattern = propose(&stems.iter().map(String::as_str).collect::<Vec<_>>(), &none)
        .filter(|found| !contradicts(found, &stems, &rows));
    let logs = looked.files.iter().filter(|seen| seen.taken == Taken::ModulusLog);
    let of_logs: Vec<String> = logs.filter_map(|seen| sample_of_name(seen, &none)).collect();
    let of_runs = named.iter().filter_map(|tags| tags.get(keys::SAMPLE));
    let samples = Samples::of(of_runs.chain(&of_logs));
    let compiled = pattern
        .as_ref()
        .and_then(|found| NamePattern::compile(&found.pattern).ok());
    let mut of_runs = runs
        .iter()
        .zip(&stems)
        .zip(named)
        .map(|((seen, stem), mut known)| {
            if let Some(sample) = known.get_mut(keys::SAMPLE) {
                *sample = samples.id_of(sample);
            }
            let by_pattern = compiled
                .as_ref()
                .map_or(Vec::new(), |pattern| read(pattern, stem, &samples));
            let mut stated = stated_beside(looked, seen);
            for (key, value) in partner_rows(looked, &pairs, seen) {
                stated.entry(key).or_insert(value);
            }
            let is_given = |(key, value): &(&String, &String)| {
                stated.contains_key(*key)
                    || by_pattern
                        .iter()
                        .any(|(by, read)| by == *key && same(key, read, value))
            };
            let beside = known.iter().filter(|pair| !is_given(pair));
            let beside = beside.map(|(key, value)| (key.clone(), value.clone())).collect();
            known.extend(stated);
            planned(seen, known, beside)
        });
    let files = looked
        .files
        .iter()
        .filter_map(|seen| match seen.taken {
            Taken::Run if is_partner(seen) => Some(partner(seen)),
            Taken::Run => of_runs.next(),
            Taken::ModulusLog => Some(modulus_log(looked, seen, &samples, &none)),
            _ => Some(planned(seen, stated_beside(looked, seen), BTreeMap::new())),
        })
        .map(|file: PlannedFile| PlannedFile {
            partner: partner_of(&pairs, &file.seen.path),
            ..file
        })
        .collect();
    Plan {
        files,
        pairs,
        lone,
        samples: samples.into_list(),
        pattern,
    }
}

/// What the names of all files and folders say together of which words are no surroundings.
fn no_surroundings(looked: &Looked) -> NoSurroundings {
    let stems: BTreeSet<String> = (looked.files.iter())
        .flat_map(|seen| {
            let folders = seen.path.split('/').rev().skip(1).map(str::to_owned);
            folders.chain([tags::stem(Path::new(&seen.path))])
        })
        .collect();
    NoSurroundings::among(stems.iter().map(String::as_str))
}

/// Whether the word that a pattern takes for the sample is another than the run sheet's in every run that one lists: the number of
/// a record, which would contradict them all.
fn contradicts(found: &ProposedPattern, stems: &[String], rows: &[Tags]) -> bool {
    let Ok(pattern) = NamePattern::compile(&found.pattern) else {
        return false;
    };
    let of_name = |stem: &String| {
        let read = read(&pattern, stem, &Samples::of(std::iter::empty()));
        read.into_iter()
            .find_map(|(key, value)| (key == keys::SAMPLE).then_some(value))
    };
    let mut both = (stems.iter().zip(rows))
        .filter_map(|(stem, row)| Some((of_name(stem)?, row.get(keys::SAMPLE)?)))
        .peekable();
    both.peek().is_some() && both.all(|(name, row)| shared_spelling(&name) != shared_spelling(row))
}

/// Pairs of files, by what was read of them: as a campaign of these files will pair them.
fn paired(looked: &Looked) -> Paired {
    let in_runs = |path: &str| format!("runs/{path}");
    let half = |seen: &Seen| {
        Some(Half {
            path: in_runs(&seen.path),
            kind: seen.half?,
            window_s: seen.window_s,
        })
    };
    let halves: Vec<Half> = looked.files.iter().filter_map(half).collect();
    let found = pair(&halves, &PairRules::default(), "runs", &pairs_of(&looked.rows));
    let below = |path: String| path.strip_prefix("runs/").map_or(path.clone(), str::to_owned);
    let pairs = found.pairs.into_iter().map(|pair| Pair {
        electrical: below(pair.electrical),
        bending: below(pair.bending),
        ..pair
    });
    let lone = found.lone.into_iter().map(|half| LoneHalf {
        path: below(half.path),
        waits_for: below(half.waits_for),
        ..half
    });
    Paired {
        pairs: pairs.collect(),
        lone: lone.collect(),
    }
}

fn partner_of(pairs: &[Pair], path: &str) -> Option<String> {
    pairs.iter().find_map(|pair| match path {
        path if path == pair.electrical => Some(pair.bending.clone()),
        path if path == pair.bending => Some(pair.electrical.clone()),
        _ => None,
    })
}

/// The file with the bending of a run: the other one has its tags.
fn partner(seen: &Seen) -> PlannedFile {
    PlannedFile {
        missing: Vec::new(),
        ..planned(seen, BTreeMap::new(), BTreeMap::new())
    }
}

/// What run sheets state of a file or of its partner.
fn partner_rows(looked: &Looked, pairs: &[Pair], seen: &Seen) -> BTreeMap<String, String> {
    let partner = partner_of(pairs, &seen.path);
    let stems: Vec<String> = std::iter::once(&seen.path)
        .chain(&partner)
        .map(|path| tags::stem(Path::new(path)))
        .collect();
    let mut stated = BTreeMap::new();
    for row in looked.rows.iter().filter(|row| stems.contains(&row.file)) {
        for (key, value) in &row.tags {
            let value = match key.as_str() {
                keys::PLANNED => continue,
                keys::ENVIRONMENT => environment(value, &[]).unwrap_or_else(|| value.clone()),
                _ => value.clone(),
            };
            stated.entry(key.clone()).or_insert(value);
        }
    }
    stated
}

fn planned(seen: &Seen, tags: BTreeMap<String, String>, beside: BTreeMap<String, String>) -> PlannedFile {
    let needed: &[&'static str] = match seen.taken {
        Taken::Run if seen.has_drive => &[keys::SAMPLE, keys::ENVIRONMENT],
        Taken::Run => &[keys::SAMPLE, keys::ENVIRONMENT, keys::VOLTAGE_V],
        Taken::ModulusLog => &[keys::SAMPLE],
        _ => &[],
    };
    let missing = needed.iter().copied().filter(|key| !tags.contains_key(*key));
    PlannedFile {
        to: seen
            .taken
            .folder()
            .map(|folder| format!("{folder}/{}", seen.path)),
        missing: missing.collect(),
        partner: None,
        seen: seen.clone(),
        tags,
        beside,
    }
}

/// A modulus log, whose name may name a sample of the runs.
fn modulus_log(looked: &Looked, seen: &Seen, samples: &Samples, none: &NoSurroundings) -> PlannedFile {
    let mut known = stated_beside(looked, seen);
    let mut beside = BTreeMap::new();
    let name = sample_of_name(seen, none).filter(|_| !known.contains_key(keys::SAMPLE));
    if let Some(name) = name {
        beside.insert(keys::SAMPLE.to_owned(), samples.id_of(&name));
        known.insert(keys::SAMPLE.to_owned(), samples.id_of(&name));
    }
    planned(seen, known, beside)
}

fn sample_of_name(seen: &Seen, none: &NoSurroundings) -> Option<String> {
    let said = tags_of_name(&tags::stem(Path::new(&seen.path)), none);
    let mut samples = said.into_iter().filter(|(key, _)| key == keys::SAMPLE);
    samples.next().map(|(_, name)| name)
}

/// What run sheets state of the run; where none does, what the name says, then the environment that a folder's name says.
fn named(
    seen: &Seen,
    stem: &str,
    stated: &BTreeMap<String, String>,
    none: &NoSurroundings,
) -> BTreeMap<String, String> {
    if !stated.is_empty() {
        return stated.clone();
    }
    let mut tags: BTreeMap<String, String> = tags_of_name(stem, none).into_iter().collect();
    let folders = seen.path.rsplit('/').skip(1);
    let environment = folders.filter_map(|name| none.environment_of(name)).next();
    if let Some(environment) = environment {
        let known = tags.entry(keys::ENVIRONMENT.to_owned());
        known.or_insert(environment);
    }
    tags
}

fn read(pattern: &NamePattern, stem: &str, samples: &Samples) -> Vec<(String, String)> {
    let ids = samples.ids();
    let known = KnownIds {
        samples: &ids,
        environments: &BUILT_IN_ENVIRONMENTS,
    };
    match pattern.match_stem(stem, known) {
        NameMatch::None => Vec::new(),
        NameMatch::One(pairs) => pairs,
        NameMatch::Several { agreed, .. } => agreed,
    }
}

/// Whether two spellings of a tag's value are one value.
fn same(key: &str, a: &str, b: &str) -> bool {
    let numbers = || Some(a.parse::<f64>().ok()? == b.parse::<f64>().ok()?);
    a == b || (keys::NUMERIC.contains(&key) && numbers() == Some(true))
}

/// Tags that files beside this one state already: its sidecar, `tags.toml` of its folder and of those above.
fn stated_beside(looked: &Looked, seen: &Seen) -> BTreeMap<String, String> {
    let sidecar = format!("{}.toml", seen.path);
    let folders: Vec<&str> = seen
        .path
        .rmatch_indices('/')
        .map(|(at, _)| &seen.path[..=at])
        .chain([""])
        .collect();
    let is_of =
        |path: &str| path == sidecar || folders.iter().any(|folder| path == format!("{folder}tags.toml"));
    let mut stated = BTreeMap::new();
    for file in looked.files.iter().filter(|file| is_of(&file.path)) {
        let text = std::fs::read_to_string(&file.location).unwrap_or_default();
        for (key, value) in toml::from_str::<toml::Table>(&text).unwrap_or_default() {
            let text = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
            stated.entry(key).or_insert(text);
        }
    }
    stated
}

/// Samples under the spellings that names have for them.
struct Samples {
    /// By what all spellings share: each spelling with the number of runs.
    spellings: BTreeMap<String, BTreeMap<String, usize>>,
}

impl Samples {
    fn of<'a>(names: impl Iterator<Item = &'a String>) -> Samples {
        let mut spellings: BTreeMap<String, BTreeMap<String, usize>> = BTreeMap::new();
        for name in names {
            let of_one = spellings.entry(shared_spelling(name)).or_default();
            *of_one.entry(name.clone()).or_insert(0) += 1;
        }
        Samples { spellings }
    }

    /// The spelling that most names have.
    fn id_of(&self, name: &str) -> String {
        let spellings = self.spellings.get(&shared_spelling(name));
        spellings.and_then(most_frequent).unwrap_or(name).to_owned()
    }

    fn ids(&self) -> Vec<&str> {
        self.spellings.values().filter_map(most_frequent).collect()
    }

    fn into_list(self) -> Vec<NamedSample> {
        let sample = |spellings: &BTreeMap<String, usize>| {
            let id = most_frequent(spellings)?;
            let letters = id.find(|c: char| c.is_ascii_digit()).map_or(id, |at| &id[..at]);
            let material = letters.trim_end_matches(['-', '_', ' ', '.', '#']);
            Some(NamedSample {
                id: id.to_owned(),
                material: if material.is_empty() { id } else { material }.to_owned(),
                runs: spellings.values().sum(),
            })
        };
        self.spellings.values().filter_map(sample).collect()
    }
}

fn most_frequent(spellings: &BTreeMap<String, usize>) -> Option<&str> {
    let most = spellings.iter().max_by_key(|(_, count)| **count)?;
    Some(most.0)
}

/// What spellings of one id share: letter case, separators, zeros before a number, the letter O for a zero.
fn shared_spelling(name: &str) -> String {
    let mut shared = String::new();
    for c in name
        .to_lowercase()
        .chars()
        .filter(|c| !matches!(c, '-' | '_' | ' '))
    {
        let after_number = shared
            .chars()
            .next_back()
            .is_some_and(|last| last.is_ascii_digit());
        match c {
            'o' if after_number || shared.ends_with('0') => shared.push('0'),
            c => shared.push(c),
        }
    }
    shared
}
