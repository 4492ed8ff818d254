//! Tags from file names: `{sample}_{environment}[_rh{relative_humidity_percent}]_{voltage_v}V_{cycle}`; `{_}` ignores a word, and
//! what stands in square brackets with a tag in it may be missing.

mod number;
mod propose;
mod words;

use crate::tags::value::shortest;
use ieap_domain::surroundings::id_of_word;
use ieap_domain::tag::keys;

pub(crate) use number::number as number_of_name;
pub use propose::{ProposedPattern, explained, propose, tags_of_name};
pub use words::{NoSurroundings, parts_of_name};

/// Why a name pattern cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PatternError {
    /// A `{` without `}`.
    #[error("the `{{` at character {at} has no closing `}}`; add it")]
    NotClosed {
        /// Place of the `{`, from 1.
        at: usize,
    },
    /// A `}` without `{`.
    #[error("the `}}` at character {at} has no opening `{{`; add it or take the `}}` away")]
    NotOpened {
        /// Place of the `}`, from 1.
        at: usize,
    },
    /// A placeholder whose name is empty or holds other signs than letters, digits and `_`.
    #[error(
        "`{{{found}}}` is no tag key; write letters, digits and `_` between the braces, such as `{{sample}}`"
    )]
    BadKey {
        /// What stands between the braces.
        found: String,
    },
    /// The same placeholder twice.
    #[error("`{{{key}}}` stands twice; use each tag once")]
    Twice {
        /// The key.
        key: String,
    },
    /// Two placeholders with nothing between them.
    #[error("`{{{first}}}` and `{{{second}}}` touch; put a sign between them, such as `_`")]
    Touching {
        /// The first placeholder.
        first: String,
        /// The second placeholder.
        second: String,
    },
    /// More parts that may be missing than can be told apart.
    #[error("it holds {found} parts in square brackets; write at most {MOST_OPTIONAL}")]
    Optional {
        /// How many.
        found: usize,
    },
    /// No placeholder at all.
    #[error("it holds no placeholder; write at least one tag key in braces, such as `{{sample}}`")]
    NoPlaceholder,
}

/// Parts that may be missing, at most: each doubles the ways to read a name. Chosen.
const MOST_OPTIONAL: usize = 4;

/// The placeholder of a word that is ignored.
const IGNORED: &str = "_";

/// One piece of a pattern.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Part {
    /// This text.
    Literal(String),
    /// The value of a tag of this key.
    Tag(String),
}

/// Ids that `{sample}` and `{environment}` stand for, where the campaign names them.
#[derive(Debug, Clone, Copy, Default)]
pub struct KnownIds<'a> {
    /// Ids of the samples.
    pub samples: &'a [&'a str],
    /// Ids of the environments.
    pub environments: &'a [&'a str],
}

/// What a file name says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NameMatch {
    /// The name is none of this pattern.
    None,
    /// One reading: (key, value) in the pattern's order.
    One(Vec<(String, String)>),
    /// Several readings are possible: the values on which all agree, and the keys on which they do not.
    Several {
        /// (key, value) that every reading gives.
        agreed: Vec<(String, String)>,
        /// Keys with more than one possible value, each with two of them.
        open: Vec<(String, String, String)>,
    },
}

/// A pattern ready to be matched.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamePattern {
    /// With all that may be missing, then with less and less of it.
    forms: Vec<Form>,
}

/// A pattern of which nothing may be missing.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Form {
    parts: Vec<Part>,
}

/// The texts of a pattern with and without what stands in square brackets, the fullest first. Brackets without a tag are signs
/// of the name.
fn with_and_without(text: &str) -> Vec<String> {
    let brackets = text.match_indices('[').find_map(|(from, _)| {
        let to = from + text[from..].find(']')?;
        text[from..to].contains('{').then_some((from, to))
    });
    let Some((from, to)) = brackets else {
        return vec![text.to_owned()];
    };
    let (before, within, after) = (&text[..from], &text[from + 1..to], &text[to + 1..]);
    let with = with_and_without(after).into_iter();
    let with = with.map(|rest| format!("{before}{within}{rest}"));
    let without = with_and_without(after).into_iter();
    with.chain(without.map(|rest| format!("{before}{rest}")))
        .collect()
}

impl NamePattern {
    /// Makes a pattern of its text.
    ///
    /// # Errors
    /// Where braces do not pair, a key is no key or stands twice, two placeholders touch, or there is none, also where what may
    /// be missing is.
    pub fn compile(text: &str) -> Result<NamePattern, PatternError> {
        let optional = text
            .split('[')
            .skip(1)
            .filter(|part| part.contains('{') && part.contains(']'));
        let found = optional.count();
        if found > MOST_OPTIONAL {
            return Err(PatternError::Optional { found });
        }
        let forms = with_and_without(text);
        let forms: Result<Vec<Form>, PatternError> = forms.iter().map(|text| Form::compile(text)).collect();
        Ok(NamePattern { forms: forms? })
    }

    /// The placeholders' keys in the pattern's order, without ignored words.
    pub fn keys(&self) -> impl Iterator<Item = &str> {
        self.forms[0].keys()
    }

    /// The name that these values give; none where a value is missing that may not be.
    pub fn format(&self, value_of: impl Fn(&str) -> Option<String>) -> Option<String> {
        self.forms.iter().find_map(|form| form.format(&value_of))
    }

    /// Reads a file name without its extension.
    ///
    /// Known samples and environments are tried first, so that an id may hold the sign that separates tags;
    /// where no known id fits, any text does, and the caller can say that the id is not known.
    pub fn match_stem(&self, stem: &str, known: KnownIds) -> NameMatch {
        let tries = [
            (known.samples, known.environments),
            (known.samples, &[][..]),
            (&[][..], known.environments),
            (&[][..], &[][..]),
        ];
        // With the ids that are known first, whatever is missing then.
        let mut ways = tries.into_iter().flat_map(|(samples, environments)| {
            let ids = KnownIds {
                samples,
                environments,
            };
            self.forms.iter().map(move |form| form.matched(stem, ids))
        });
        ways.find(|found| *found != NameMatch::None)
            .unwrap_or(NameMatch::None)
    }

    /// The words of a name, each with what it is taken for, of the first way to read it; none where the pattern does not
    /// read it.
    pub fn words(&self, stem: &str, known: KnownIds) -> Option<Vec<(String, String)>> {
        self.forms.iter().find_map(|form| form.words(stem, known))
    }

    /// Where a name that the pattern does not read leaves it: behind the longest beginning that it reads.
    pub fn mismatch(&self, stem: &str, known: KnownIds) -> Mismatch {
        let of = self.forms.iter().map(|form| form.mismatch(stem, known));
        let furthest = of.reduce(|most, next| {
            if next.read.len() > most.read.len() {
                next
            } else {
                most
            }
        });
        furthest.unwrap_or_else(|| Mismatch {
            read: String::new(),
            rest: stem.to_owned(),
            wanted: String::new(),
        })
    }
}

impl Form {
    fn compile(text: &str) -> Result<Form, PatternError> {
        let mut parts = Vec::new();
        let mut literal = String::new();
        let mut signs = text.chars().enumerate();
        while let Some((index, sign)) = signs.next() {
            match sign {
                '}' => return Err(PatternError::NotOpened { at: index + 1 }),
                '{' => {
                    if !literal.is_empty() {
                        parts.push(Part::Literal(std::mem::take(&mut literal)));
                    }
                    let key = read_key(&mut signs).ok_or(PatternError::NotClosed { at: index + 1 })?;
                    check_key(&key, &parts)?;
                    parts.push(Part::Tag(key));
                }
                _ => literal.push(sign),
            }
        }
        if !literal.is_empty() {
            parts.push(Part::Literal(literal));
        }
        let pattern = Form { parts };
        let has_key = pattern.keys().next().is_some();
        has_key.then_some(pattern).ok_or(PatternError::NoPlaceholder)
    }

    fn keys(&self) -> impl Iterator<Item = &str> {
        self.parts.iter().filter_map(|part| match part {
            Part::Tag(key) if key != IGNORED => Some(key.as_str()),
            _ => None,
        })
    }

    fn format(&self, value_of: impl Fn(&str) -> Option<String>) -> Option<String> {
        let text = |part: &Part| match part {
            Part::Literal(text) => Some(text.clone()),
            Part::Tag(key) => value_of(key),
        };
        self.parts.iter().map(text).collect()
    }

    fn matched(&self, stem: &str, ids: KnownIds) -> NameMatch {
        summary(Search::new(&self.parts, stem, ids).readings())
    }
}

/// Where a name leaves its pattern.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mismatch {
    /// What the pattern reads of the name.
    pub read: String,
    /// What stands behind it.
    pub rest: String,
    /// What the pattern wants there: `{voltage_v}`, `V`, or the end of the name.
    pub wanted: String,
}

impl Form {
    fn words(&self, stem: &str, known: KnownIds) -> Option<Vec<(String, String)>> {
        let search = Search::new(&self.parts, stem, known);
        let search = if search.leads_to_end[0][0] {
            search
        } else {
            Search::new(&self.parts, stem, KnownIds::default())
        };
        let (mut start, mut words) = (0, Vec::new());
        for (part, of) in self.parts.iter().enumerate() {
            let end = search
                .ends(part, start)
                .find(|&end| search.leads_to_end[part + 1][end])?;
            let text = &stem[start..end];
            start = end;
            match of {
                Part::Literal(literal) if literal.contains(char::is_alphanumeric) => {
                    words.push((text.to_owned(), "part of the pattern".to_owned()));
                }
                Part::Literal(_) => {}
                Part::Tag(key) if key == IGNORED => words.push((text.to_owned(), "ignored".to_owned())),
                Part::Tag(key) => {
                    let value = search.value(key, text);
                    let taken = if value == text {
                        key.clone()
                    } else {
                        format!("{key} = {value}")
                    };
                    words.push((text.to_owned(), taken));
                }
            }
        }
        (start == stem.len()).then_some(words)
    }

    fn mismatch(&self, stem: &str, known: KnownIds) -> Mismatch {
        let search = Search::new(&self.parts, stem, known);
        let mut at: std::collections::BTreeSet<usize> = [0].into();
        let (mut part, mut reached) = (0, 0);
        while part < self.parts.len() {
            let next = at
                .iter()
                .flat_map(|&start| search.ends(part, start).collect::<Vec<_>>());
            let next: std::collections::BTreeSet<usize> = next.collect();
            if next.is_empty() {
                break;
            }
            (at, part) = (next, part + 1);
            // The furthest place from which the next part has a way, or the nearest where none has.
            reached = at.first().copied().unwrap_or(0);
        }
        Mismatch {
            read: stem[..reached].to_owned(),
            rest: stem[reached..].to_owned(),
            wanted: match self.parts.get(part) {
                Some(Part::Literal(text)) => format!("\"{text}\""),
                Some(Part::Tag(key)) => format!("{{{key}}}"),
                None => "the end of the name".to_owned(),
            },
        }
    }
}

fn read_key(signs: &mut impl Iterator<Item = (usize, char)>) -> Option<String> {
    let mut key = String::new();
    for (_, sign) in signs {
        match sign {
            '}' => return Some(key),
            '{' => return None,
            _ => key.push(sign),
        }
    }
    None
}

fn check_key(key: &str, before: &[Part]) -> Result<(), PatternError> {
    if key.is_empty()
        || !key
            .chars()
            .all(|sign| sign.is_ascii_alphanumeric() || sign == '_')
    {
        return Err(PatternError::BadKey {
            found: key.to_owned(),
        });
    }
    if key != IGNORED && before.contains(&Part::Tag(key.to_owned())) {
        return Err(PatternError::Twice { key: key.to_owned() });
    }
    match before.last() {
        Some(Part::Tag(first)) => Err(PatternError::Touching {
            first: first.clone(),
            second: key.to_owned(),
        }),
        _ => Ok(()),
    }
}

/// How many readings of one name are looked at; two already show that the name is not clear.
const MOST_READINGS: usize = 64;

type ReadingOfName = Vec<(String, String)>;

/// All readings of one name. `leads_to_end` keeps the search from walking ways that fail, so that it takes
/// time in proportion to (length of the name)^2, whatever the pattern.
struct Search<'a> {
    parts: &'a [Part],
    stem: &'a str,
    known: KnownIds<'a>,
    /// Signs that end a word that is ignored.
    separators: &'static [char],
    /// For each part and each byte of the name: whether the rest of the parts can read the rest of the name.
    leads_to_end: Vec<Vec<bool>>,
}

impl<'a> Search<'a> {
    fn new(parts: &'a [Part], stem: &'a str, known: KnownIds<'a>) -> Search<'a> {
        let mut search = Search {
            parts,
            stem,
            known,
            separators: words::separators(stem),
            leads_to_end: vec![vec![false; stem.len() + 1]; parts.len() + 1],
        };
        search.leads_to_end[parts.len()][stem.len()] = true;
        for part in (0..parts.len()).rev() {
            for start in (0..=stem.len()).filter(|&start| stem.is_char_boundary(start)) {
                let reaches = search
                    .ends(part, start)
                    .any(|end| search.leads_to_end[part + 1][end]);
                search.leads_to_end[part][start] = reaches;
            }
        }
        search
    }

    /// Where a part that starts at byte `start` can end.
    fn ends(&self, part: usize, start: usize) -> impl Iterator<Item = usize> + use<'_, 'a> {
        let rest = &self.stem[start..];
        let possible = (start..=self.stem.len()).filter(|&end| self.stem.is_char_boundary(end));
        let part = &self.parts[part];
        possible.filter(move |&end| {
            let text = &rest[..end - start];
            match part {
                Part::Literal(literal) => text == literal,
                Part::Tag(key) => self.can_be(key, text),
            }
        })
    }

    fn can_be(&self, key: &str, text: &str) -> bool {
        let ids = match key {
            keys::SAMPLE => self.known.samples,
            keys::ENVIRONMENT => self.known.environments,
            // A word ends at the next sign that separates words, so that several of them are read in one way.
            IGNORED => return !text.is_empty() && !text.contains(self.separators),
            keys::CYCLE => return !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit()),
            key if keys::NUMERIC.contains(&key) => return number::number(key, text).is_some(),
            _ => &[],
        };
        let is_word = || key == keys::ENVIRONMENT && environment(text, ids).is_some();
        !text.is_empty() && (ids.is_empty() || ids.contains(&text) || is_word())
    }

    /// The value that a text stands for: a number in plain digits, an environment under the id that is known.
    fn value(&self, key: &str, text: &str) -> String {
        let number = || {
            keys::NUMERIC
                .contains(&key)
                .then(|| number::number(key, text))
                .flatten()
        };
        match key {
            _ if is_plain_number(text) => text.to_owned(),
            keys::ENVIRONMENT => {
                environment(text, self.known.environments).unwrap_or_else(|| text.to_owned())
            }
            _ => number().map_or_else(|| text.to_owned(), shortest),
        }
    }

    fn readings(&self) -> Vec<ReadingOfName> {
        let mut found = Vec::new();
        if self.leads_to_end[0][0] {
            self.walk(0, 0, &mut Vec::new(), &mut found);
        }
        found
    }

    fn walk(&self, part: usize, start: usize, so_far: &mut ReadingOfName, found: &mut Vec<ReadingOfName>) {
        if part == self.parts.len() {
            found.push(so_far.clone());
            return;
        }
        for end in self
            .ends(part, start)
            .filter(|&end| self.leads_to_end[part + 1][end])
        {
            if found.len() == MOST_READINGS {
                return;
            }
            if let Part::Tag(key) = &self.parts[part]
                && key != IGNORED
            {
                so_far.push((key.clone(), self.value(key, &self.stem[start..end])));
                self.walk(part + 1, end, so_far, found);
                so_far.pop();
            } else {
                self.walk(part + 1, end, so_far, found);
            }
        }
    }
}

/// The id of the environment that a word stands for: one of `known`, whatever its letters' case, else that of its kind.
pub fn environment(word: &str, known: &[&str]) -> Option<String> {
    let lower = word.to_lowercase();
    let stated = || known.iter().find(|id| id.to_lowercase() == lower);
    match known.iter().find(|id| **id == word).or_else(stated) {
        Some(id) => Some((*id).to_owned()),
        None => id_of_word(&lower),
    }
}

/// Digits with a decimal point and a minus where needed: what a file name writes for a number.
fn is_plain_number(text: &str) -> bool {
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let text = text.strip_prefix('-').unwrap_or(text);
    match text.split_once('.') {
        Some((whole, fraction)) => digits(whole) && digits(fraction),
        None => digits(text),
    }
}

fn summary(mut readings: Vec<ReadingOfName>) -> NameMatch {
    // Two ways to read a name that say the same are one: `2V` as 2 and a unit, or as 2 V.
    let mut seen = std::collections::BTreeSet::new();
    readings.retain(|reading| seen.insert(reading.clone()));
    if readings.len() <= 1 {
        return readings.pop().map_or(NameMatch::None, NameMatch::One);
    }
    let (mut agreed, mut open) = (Vec::new(), Vec::new());
    for (index, (key, value)) in readings[0].iter().enumerate() {
        match readings.iter().find(|reading| reading[index].1 != *value) {
            Some(other) => open.push((key.clone(), value.clone(), other[index].1.clone())),
            None => agreed.push((key.clone(), value.clone())),
        }
    }
    NameMatch::Several { agreed, open }
}

#[cfg(test)]
mod tests;
