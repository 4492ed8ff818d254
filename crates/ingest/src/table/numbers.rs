//! Which marks stand before decimals and between thousands: decided for a table as a whole, by all its numbers.
//!
//! Every way to write numbers is a hypothesis. One that cannot read a cell which another reads is out. So is one under which
//! a column was written as nobody writes: with marks between some of its thousands only, or with decimals that are kept where
//! they are zero and left away where they are zero. Where two are left under which the numbers differ, a person is asked.

use std::collections::BTreeMap;

use super::kind::Pattern;
use super::question::Question;
use crate::text::number::unquote;
use crate::text::{Decimal, Delimiter, Group, NumberForm};

/// How the numbers of each column are written: a pattern with how often it occurs, and an example with its line.
#[derive(Debug, Default)]
pub struct Writing {
    columns: Vec<BTreeMap<Pattern, Seen>>,
    /// That of the cell that was added last.
    last: Pattern,
}

#[derive(Debug, Clone)]
struct Seen {
    count: usize,
    line: usize,
    text: String,
}

/// What the numbers of a table may be.
#[derive(Debug)]
pub enum Found {
    /// One way reads all of them, or all ways that do give the same numbers.
    One(NumberForm),
    /// Each column is written in one way, and not all in the same.
    Each(Vec<NumberForm>),
    /// Cells of which no way reads both.
    Contradiction {
        /// Line of the first.
        line: usize,
        /// The one with a comma.
        first: String,
        /// The one with a point.
        second: String,
    },
    /// Two ways read all of them and give different numbers.
    Open(Question),
}

impl Writing {
    /// Nothing of so many columns yet.
    pub fn new(columns: usize) -> Writing {
        let mut writing = Writing::default();
        writing.columns.resize_with(columns, BTreeMap::new);
        writing
    }

    /// Takes a cell of a column, where it is a number.
    pub fn add(&mut self, column: usize, line: usize, cell: &str) {
        let text = unquote(cell);
        let Some((column, ())) = self.columns.get_mut(column).zip(self.last.take(text)) else {
            return;
        };
        if let Some(seen) = column.get_mut(&self.last) {
            seen.count += 1;
        } else if is_readable(&self.last) {
            let first = Seen {
                count: 1,
                line,
                text: text.to_owned(),
            };
            column.insert(self.last.clone(), first);
        }
    }

    /// The way in which these numbers are written; what a person answered counts where they leave it open.
    pub fn decide(
        &self,
        delimiter: Delimiter,
        decimal: Option<Decimal>,
        group: Option<Option<Group>>,
    ) -> Found {
        let holds_commas = self
            .columns
            .iter()
            .flatten()
            .any(|(pattern, _)| pattern.marks.iter().any(|(mark, _)| *mark == ','));
        let mut forms: Vec<(usize, NumberForm)> = all_forms(delimiter, holds_commas)
            .map(|form| (self.unread(form), form))
            .collect();
        let fewest = forms.iter().map(|(unread, _)| *unread).min().unwrap_or(0);
        if fewest > 0
            && let Some((line, first, second)) = self.contradiction()
        {
            let of_column = |column: &BTreeMap<Pattern, Seen>| {
                let alone = Writing {
                    columns: vec![column.clone()],
                    ..Writing::default()
                };
                match alone.decide(delimiter, decimal, group) {
                    Found::One(form) if alone.unread(form) == 0 => Some(form),
                    _ => None,
                }
            };
            if self.columns.len() > 1
                && let Some(forms) = self.columns.iter().map(of_column).collect::<Option<Vec<_>>>()
            {
                return Found::Each(forms);
            }
            return Found::Contradiction { line, first, second };
        }
        forms.retain(|(unread, _)| *unread == fewest);
        let sane: Vec<NumberForm> = (forms.iter().map(|(_, form)| *form))
            .filter(|form| self.columns.iter().all(|column| is_written_so(column, *form)))
            .collect();
        let left = if sane.is_empty() {
            forms.into_iter().map(|(_, form)| form).collect()
        } else {
            sane
        };
        // An answer settles what is open, and nothing else.
        let is_answer = |form: &&NumberForm| {
            decimal.is_none_or(|decimal| decimal == form.decimal)
                && group.is_none_or(|group| group == form.group)
        };
        match self.open_among(&left) {
            None => Found::One(left[0]),
            Some(question) => {
                let answered: Vec<NumberForm> = left.iter().filter(is_answer).copied().collect();
                let has_answer = decimal.is_some() || group.is_some();
                match answered
                    .first()
                    .filter(|_| has_answer && self.open_among(&answered).is_none())
                {
                    Some(form) => Found::One(*form),
                    None => Found::Open(question),
                }
            }
        }
    }

    /// What is asked where forms read a cell differently.
    fn open_among(&self, forms: &[NumberForm]) -> Option<Question> {
        let first = *forms.first()?;
        let (seen, other) = forms.iter().find_map(|other| self.differing(first, *other))?;
        Some(question(seen, first, other))
    }

    /// Numbers that cannot be read in that way and can in another.
    fn unread(&self, form: NumberForm) -> usize {
        let patterns = self.columns.iter().flatten();
        let unread =
            patterns.filter(|(pattern, _)| !pattern.marks.is_empty() && places(pattern, form).is_none());
        unread.map(|(_, seen)| seen.count).sum()
    }

    /// Two cells of which no form reads both.
    fn contradiction(&self) -> Option<(usize, String, String)> {
        let reads = |decimal: Decimal| {
            let is_so = move |pattern: &Pattern| {
                let own = places(pattern, decimal.into()).is_some();
                let others = places(pattern, other(decimal).into()).is_some();
                !pattern.marks.is_empty() && own && !others
            };
            self.columns
                .iter()
                .flatten()
                .find(move |(pattern, _)| is_so(pattern))
        };
        let ((_, point), (_, comma)) = reads(Decimal::Point).zip(reads(Decimal::Comma))?;
        Some((comma.line, comma.text.clone(), point.text.clone()))
    }

    /// A cell that the two forms read differently.
    fn differing(&self, first: NumberForm, other: NumberForm) -> Option<(&Seen, NumberForm)> {
        let patterns = self.columns.iter().flatten();
        let mut differ = patterns.filter(|(pattern, _)| {
            let (a, b) = (places(pattern, first), places(pattern, other));
            a.is_some() && b.is_some() && a != b && !pattern.is_zero
        });
        differ.next().map(|(_, seen)| (seen, other))
    }
}

/// Whether any way of writing numbers reads a pattern: `28.03.2026` is none.
pub fn is_readable(pattern: &Pattern) -> bool {
    pattern.marks.is_empty()
        || all_forms(Delimiter::Semicolon, true).any(|form| places(pattern, form).is_some())
}

fn other(decimal: Decimal) -> Decimal {
    match decimal {
        Decimal::Point => Decimal::Comma,
        Decimal::Comma => Decimal::Point,
    }
}

/// The ways in which people and programs write numbers, the plainest first. Between commas as delimiters a point that groups
/// thousands has nothing to be a decimal mark beside it, unless quoted cells hold commas.
fn all_forms(delimiter: Delimiter, holds_commas: bool) -> impl Iterator<Item = NumberForm> {
    const FORMS: [(Decimal, Option<Group>); 8] = [
        (Decimal::Point, None),
        (Decimal::Comma, None),
        (Decimal::Point, Some(Group::Comma)),
        (Decimal::Comma, Some(Group::Point)),
        (Decimal::Point, Some(Group::Apostrophe)),
        (Decimal::Comma, Some(Group::Apostrophe)),
        (Decimal::Point, Some(Group::Space)),
        (Decimal::Comma, Some(Group::Space)),
    ];
    let is_possible = move |form: &NumberForm| match form.group {
        Some(Group::Point) => delimiter != Delimiter::Comma || holds_commas,
        Some(Group::Space) => delimiter != Delimiter::Blanks,
        _ => true,
    };
    let forms = FORMS
        .into_iter()
        .map(|(decimal, group)| NumberForm { decimal, group });
    forms.filter(is_possible)
}

/// How many decimals a number of that pattern has under a form; none where it cannot be read so.
fn places(pattern: &Pattern, form: NumberForm) -> Option<usize> {
    let decimal = match form.decimal {
        Decimal::Point => '.',
        Decimal::Comma => ',',
    };
    let is_group = |mark: char| form.group.is_some() && Group::of(mark) == form.group;
    let (groups, decimals) = match pattern.marks.as_slice() {
        [groups @ .., (mark, digits)] if *mark == decimal => (groups, *digits),
        groups => (groups, 0),
    };
    // `5,` is a list.
    let is_list = form.decimal == Decimal::Comma
        && pattern
            .marks
            .last()
            .is_some_and(|(mark, digits)| *mark == ',' && *digits == 0);
    let are_groups = groups
        .iter()
        .all(|(mark, digits)| is_group(*mark) && *digits == 3);
    let is_grouped = groups.is_empty() || ((1..=3).contains(&pattern.first) && !pattern.begins_with_zero);
    let without_power = groups.is_empty() || !pattern.has_exponent;
    (are_groups && is_grouped && without_power && !is_list).then_some(decimals)
}

/// Whether a column was written as a program writes it under that form: marks between all thousands or none, and decimals
/// that are kept or trimmed alike.
fn is_written_so(column: &BTreeMap<Pattern, Seen>, form: NumberForm) -> bool {
    let is_grouped = |pattern: &Pattern| {
        let marks = pattern.marks.len();
        marks > usize::from(places(pattern, form).is_some_and(|decimals| decimals > 0))
    };
    let has_groups = column.keys().any(is_grouped);
    let is_bare_thousand =
        |pattern: &Pattern| pattern.first > 3 && !pattern.has_exponent && places(pattern, form).is_some();
    if has_groups && column.keys().any(is_bare_thousand) {
        return false;
    }
    let plain = || column.keys().filter(|pattern| !pattern.has_exponent);
    let decimals = |pattern: &Pattern| places(pattern, form).unwrap_or(0);
    let keeps_zeros = plain().any(|pattern| pattern.ends_in_zero && decimals(pattern) > 0);
    let leaves_away = plain().any(|pattern| decimals(pattern) == 0);
    let all_of_three = plain().all(|pattern| matches!(decimals(pattern), 0 | 3));
    !(keeps_zeros && leaves_away && all_of_three)
}

fn question(seen: &Seen, first: NumberForm, other: NumberForm) -> Question {
    let number = |form: NumberForm| match crate::text::number::parse_in(&seen.text, form) {
        crate::text::Cell::Number(number) => number.to_string(),
        _ => String::new(),
    };
    // The answer that tells the two apart.
    let (key, words) = if first.decimal != other.decimal {
        ("decimal", [first, other].map(|form| decimal_word(form.decimal)))
    } else {
        (
            "thousands",
            [first, other].map(|form| form.group.map_or("none", Group::label)),
        )
    };
    Question {
        key,
        column: String::new(),
        line: seen.line,
        found: format!(
            "a number is written {}",
            crate::formats::error::quoted(&seen.text)
        ),
        answers: [(words[0], first), (words[1], other)]
            .map(|(word, form)| (word.to_owned(), format!("it is {}", number(form))))
            .to_vec(),
    }
}

/// The decimal mark as an answer names it.
pub fn decimal_word(decimal: Decimal) -> &'static str {
    match decimal {
        Decimal::Point => "point",
        Decimal::Comma => "comma",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decided(columns: &[&[&str]]) -> Found {
        let mut writing = Writing::new(columns.len());
        for (index, cells) in columns.iter().enumerate() {
            cells
                .iter()
                .enumerate()
                .for_each(|(row, cell)| writing.add(index, row + 2, cell));
        }
        writing.decide(Delimiter::Semicolon, None, None)
    }

    #[test]
    fn all_numbers_of_a_table_are_witnesses() {
        use Decimal::{Comma, Point};
        for (columns, decimal, group) in [
            (
                vec![vec!["0", "945", "9,400", "5,411"]],
                Point,
                Some(Group::Comma),
            ),
            (
                vec![vec!["1.000", "2.000", "60.000"], vec!["0", "9.400", "945"]],
                Comma,
                Some(Group::Point),
            ),
            (vec![vec!["1'006.4", "945.2"]], Point, Some(Group::Apostrophe)),
            (
                vec![vec!["9,400.00", "0.00", "945.00"]],
                Point,
                Some(Group::Comma),
            ),
            (vec![vec!["0,000", "0,500", "1,000"], vec!["9,412"]], Comma, None),
            (vec![vec!["0.5", "1.25"]], Point, None),
            (vec![vec!["1", "2"]], Point, None),
            (vec![vec!["1.234E-03", "2.5"], vec!["1.234"]], Point, None),
        ] {
            let columns: Vec<&[&str]> = columns.iter().map(Vec::as_slice).collect();
            match decided(&columns) {
                Found::One(form) => assert_eq!((form.decimal, form.group), (decimal, group), "{columns:?}"),
                other => panic!("{columns:?}: {other:?}"),
            }
        }
    }

    #[test]
    fn what_two_ways_read_differently_is_asked_and_what_none_reads_is_refused() {
        assert!(matches!(decided(&[&["9,412", "8,123"]]), Found::Open(_)));
        assert!(matches!(decided(&[&["1.000", "2.000"]]), Found::Open(_)));
        assert!(matches!(
            decided(&[&["0,5", "0.5"], &["1"]]),
            Found::Contradiction { .. }
        ));
        assert!(matches!(decided(&[&["0,5"], &["0.5"]]), Found::Each(_)));
    }
}
