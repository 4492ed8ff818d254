//! From what a profile's file holds to a profile that can be obeyed: every statement checked once.

use std::collections::BTreeMap;
use std::path::Path;

use encoding_rs::Encoding;
use toml::Spanned;

use super::definition::Profile;
use super::error::ProfileError as Error;
use super::glob::Glob;
use super::raw;
use crate::campaign_file::line_and_column;
use crate::table::Answers;
use crate::table::numbers::decimal_word;
use crate::table::stated::{Column, ColumnRef, Container, HeaderPlace, Stated};
use crate::text::grid::Dialect;
use crate::text::{Decimal, Delimiter};
use ieap_domain::Quantity;
use ieap_domain::unit;

/// Checks one file; `text` gives the line of each statement.
pub(super) struct Checker<'a> {
    pub path: &'a Path,
    pub id: &'a str,
    pub text: &'a str,
}

impl Checker<'_> {
    /// The profile.
    pub fn profile(&self, file: raw::File) -> Result<Profile, Error> {
        let missing = |table: &str, needed: &str| self.refused(None, table, "it is missing", needed);
        let head = file
            .profile
            .ok_or_else(|| missing("[profile]", "a table [profile] with version = 1"))?;
        let says_more =
            file.layout.is_some() || file.time.is_some() || file.start.is_some() || !file.column.is_empty();
        let mut answers = self.answers(&file.answers)?;
        if says_more || file.answers.is_empty() {
            let layout = file
                .layout
                .ok_or_else(|| missing("[layout]", "a table [layout]"))?;
            let time = file.time.ok_or_else(|| missing("[time]", "a table [time]"))?;
            answers.state(self.stated(layout, time, file.start, file.column)?);
        }
        let recognise = file.recognise;
        let says_nothing = recognise.name.is_none() && recognise.contains.is_empty();
        let is_unnamed = answers
            .table()
            .is_none_or(|stated| stated.header == HeaderPlace::None);
        if says_nothing && is_unnamed {
            let needed = "name or contains, for nothing else tells the files of this source apart";
            return Err(self.refused(None, "[recognise]", "it says nothing", needed));
        }
        Ok(Profile {
            id: self.id.to_owned(),
            version: self.version(head.version)?,
            title: head.title.unwrap_or_else(|| self.id.to_owned()),
            digest: blake3::hash(self.text.as_bytes()).to_hex().to_string(),
            text: self.text.to_owned(),
            technique: head.technique,
            step_response: head.step_response.unwrap_or(true),
            name: recognise.name.as_deref().map(Glob::new),
            contains: recognise.contains,
            over_vendor: recognise.over_vendor,
            answers,
        })
    }

    /// Answers to what the reader of tables asks.
    fn answers(&self, stated: &BTreeMap<String, String>) -> Result<Answers, Error> {
        let mut answers = Answers::default();
        for (key, answer) in stated {
            let added = answers.add(key, answer);
            added.map_err(|reason| {
                self.refused(None, "[answers]", &reason, "a question with one of its answers")
            })?;
        }
        Ok(answers)
    }

    /// What is stated of a table as a whole.
    fn stated(
        &self,
        layout: Spanned<raw::Layout>,
        time: Spanned<raw::Time>,
        start: Option<Spanned<raw::Start>>,
        columns: Vec<Spanned<raw::Column>>,
    ) -> Result<Stated, Error> {
        let (container, header, lines_after_header) = self.layout(layout)?;
        let time_at = time.span().start;
        let time = time.into_inner();
        let zeros = [("clock", false), ("step", true)];
        let zero_is_step = match &time.zero {
            None => false,
            zero => self.one_of(zero, "[time] zero", time_at, &zeros)?,
        };
        let columns = columns.into_iter().map(|column| self.column(column));
        let stated = Stated {
            container,
            header,
            lines_after_header,
            columns: columns.collect::<Result<Vec<_>, _>>()?,
            time: self.time(time, time_at)?,
            zero_is_step,
            start: start.map(|start| self.start(start)).transpose()?,
        };
        self.whole(&stated)?;
        Ok(stated)
    }

    /// What only the parts together show.
    fn whole(&self, stated: &Stated) -> Result<(), Error> {
        if stated.columns.is_empty() {
            let needed = "at least one [[column]] with column, quantity and unit";
            return Err(self.refused(None, "[[column]]", "it is missing", needed));
        }
        let columns = stated.columns.iter().map(|column| &column.column);
        let named: Vec<&ColumnRef> = stated.time.columns().iter().chain(columns).collect();
        for (index, column) in named.iter().enumerate() {
            if stated.header == HeaderPlace::None && matches!(column, ColumnRef::Name(_)) {
                let needed = "its number from 1, for header_line = 0 says that the file has no names";
                return Err(self.refused(None, &column.shown(), "it is given by name", needed));
            }
            if named[..index].contains(column) {
                let needed = "one meaning for each column";
                return Err(self.refused(None, &column.shown(), "it is named twice", needed));
            }
        }
        Ok(())
    }

    fn version(&self, version: Option<Spanned<i64>>) -> Result<u32, Error> {
        let (found, at) = match &version {
            None => ("it is missing".to_owned(), None),
            Some(number) => match u32::try_from(*number.get_ref()) {
                Ok(version) if version >= 1 => return Ok(version),
                _ => (number.get_ref().to_string(), Some(number.span().start)),
            },
        };
        Err(self.refused(at, "[profile] version", &found, "a whole number from 1"))
    }

    fn layout(&self, layout: Spanned<raw::Layout>) -> Result<(Container, HeaderPlace, usize), Error> {
        let at = layout.span().start;
        let layout = layout.into_inner();
        let header = match (&layout.header_line, &layout.header_contains) {
            (Some(line), None) => match usize::try_from(*line.get_ref()) {
                Ok(0) => HeaderPlace::None,
                Ok(line) => HeaderPlace::Line(line),
                Err(_) => {
                    let needed = "the line of the names from 1, or 0 where there are none";
                    let found = line.get_ref().to_string();
                    let at = Some(line.span().start);
                    return Err(self.refused(at, "[layout] header_line", &found, needed));
                }
            },
            (None, Some(text)) if !text.is_empty() => HeaderPlace::Contains(text.clone()),
            (None, _) => {
                let needed =
                    "header_line = 1, or header_contains = \"a text of the line that names the columns\"";
                return Err(self.refused(Some(at), "[layout]", "where the names stand is missing", needed));
            }
            (Some(_), Some(_)) => {
                let found = "header_line and header_contains both stand";
                return Err(self.refused(Some(at), "[layout]", found, "one of them"));
            }
        };
        let kinds = [("text", false), ("sheet", true)];
        let is_sheet = match &layout.kind {
            None => false,
            kind => self.one_of(kind, "[layout] kind", at, &kinds)?,
        };
        let container = if is_sheet {
            self.sheet_only(&layout)?;
            Container::Sheet { name: layout.sheet }
        } else {
            self.text_container(&layout, at)?
        };
        Ok((container, header, usize::from(layout.lines_after_header)))
    }

    fn text_container(&self, layout: &raw::Layout, at: usize) -> Result<Container, Error> {
        let separators = Delimiter::ALL.map(|delimiter| (delimiter.label(), delimiter));
        let delimiter = self.one_of(&layout.separator, "[layout] separator", at, &separators)?;
        let decimals = [Decimal::Point, Decimal::Comma].map(|decimal| (decimal_word(decimal), decimal));
        let decimal = self.one_of(&layout.decimal, "[layout] decimal", at, &decimals)?;
        if layout.sheet.is_some() {
            let found = "it stands beside kind = \"text\"";
            return Err(self.refused(Some(at), "[layout] sheet", found, "kind = \"sheet\""));
        }
        let encoding = match self.word(&layout.encoding, "[layout] encoding")? {
            None => None,
            Some(label) => Some(Encoding::for_label(label.as_bytes()).ok_or_else(|| {
                let needed = "\"utf-8\", \"utf-16le\", \"windows-1252\" or another name of the WHATWG list; leave it \
                              out to have it found";
                self.refused(span(&layout.encoding), "[layout] encoding", &shown(label), needed)
            })?),
        };
        Ok(Container::Text {
            encoding,
            dialect: Dialect::new(delimiter, decimal),
            comment: layout.comment.clone().unwrap_or_else(|| "#".to_owned()),
        })
    }

    /// A sheet has neither separator nor encoding.
    fn sheet_only(&self, layout: &raw::Layout) -> Result<(), Error> {
        let texts = [
            (&layout.separator, "separator"),
            (&layout.decimal, "decimal"),
            (&layout.encoding, "encoding"),
        ];
        for (value, key) in texts {
            if value.is_some() {
                let place = format!("[layout] {key}");
                let found = "it stands beside kind = \"sheet\"";
                let needed = "nothing: the workbook itself tells numbers from texts";
                return Err(self.refused(span(value), &place, found, needed));
            }
        }
        Ok(())
    }

    fn column(&self, column: Spanned<raw::Column>) -> Result<Column, Error> {
        let at = Some(column.span().start);
        let column = column.into_inner();
        let place = |key: &str| format!("[[column]] {key}");
        let needed = "the column's name as the file has it, or its number";
        let reference = column.column.as_ref();
        let reference =
            reference.ok_or_else(|| self.refused(at, &place("column"), "it is missing", needed))?;
        let reference = self.column_ref(reference, &place("column"))?;
        let has_meaning = |quantity: &Quantity| !matches!(quantity, Quantity::Time | Quantity::Other);
        let known = Quantity::ALL.into_iter().filter(has_meaning);
        let known: Vec<(&str, Quantity)> = known.map(|quantity| (quantity.key(), quantity)).collect();
        let word = self.word(&column.quantity, &place("quantity"))?;
        let quantity = known.iter().find(|(key, _)| Some(*key) == word);
        let (_, quantity) = *quantity.ok_or_else(|| {
            let found = word.map_or("it is missing".to_owned(), shown);
            let keys: Vec<&str> = known.iter().map(|(key, _)| *key).collect();
            let needed = format!(
                "one of {}; a column without a meaning needs no entry",
                keys.join(", ")
            );
            self.refused(span(&column.quantity).or(at), &place("quantity"), &found, &needed)
        })?;
        let text = column.unit.as_ref().map_or("", |unit| unit.get_ref().as_str());
        let conversion = unit::conversion(quantity, text).map_err(|error| {
            let at = span(&column.unit).or(at);
            let needed = "the unit of the column's numbers";
            self.refused(at, &place("unit"), &error.to_string(), needed)
        })?;
        let positive_or_negative = |value: &f64| value.is_finite() && *value != 0.0;
        Ok(Column {
            column: reference,
            quantity,
            unit: text.to_owned(),
            conversion,
            factor: self.number(
                &column.factor,
                &place("factor"),
                "a number other than 0",
                positive_or_negative,
            )?,
            position_mm: self.number(
                &column.position_mm,
                &place("position_mm"),
                "mm from the clamp, not below 0",
                |mm| mm.is_finite() && *mm >= 0.0,
            )?,
        })
    }

    pub(super) fn column_ref(
        &self,
        column: &Spanned<raw::ColumnRef>,
        place: &str,
    ) -> Result<ColumnRef, Error> {
        let refused =
            |found: &str, needed| Err(self.refused(Some(column.span().start), place, found, needed));
        match column.get_ref() {
            raw::ColumnRef::Name(name) if name.trim().is_empty() => refused("it is empty", "a name"),
            raw::ColumnRef::Name(name) => Ok(ColumnRef::Name(name.trim().to_owned())),
            raw::ColumnRef::Number(number @ 1..=10_000) => Ok(ColumnRef::Index(*number as usize - 1)),
            raw::ColumnRef::Number(number) => refused(&number.to_string(), "a number from 1"),
        }
    }

    pub(super) fn number(
        &self,
        value: &Option<Spanned<f64>>,
        place: &str,
        needed: &str,
        rule: impl Fn(&f64) -> bool,
    ) -> Result<Option<f64>, Error> {
        match value.as_ref().map(|value| *value.get_ref()) {
            Some(number) if !rule(&number) => {
                Err(self.refused(span(value), place, &number.to_string(), needed))
            }
            number => Ok(number),
        }
    }

    /// One of some words, which must stand there; `at` is where its table begins.
    pub(super) fn one_of<T: Clone>(
        &self,
        value: &Option<Spanned<String>>,
        place: &str,
        at: usize,
        words: &[(&str, T)],
    ) -> Result<T, Error> {
        let word = self.word(value, place)?;
        let known = words.iter().find(|(known, _)| Some(*known) == word);
        known.map(|(_, meaning)| meaning.clone()).ok_or_else(|| {
            let found = word.map_or("it is missing".to_owned(), shown);
            let known: Vec<String> = words.iter().map(|(known, _)| format!("\"{known}\"")).collect();
            let needed = match known.as_slice() {
                [others @ .., last] => format!("{} or {last}", others.join(", ")),
                [] => String::new(),
            };
            self.refused(span(value).or(Some(at)), place, &found, &needed)
        })
    }

    /// A word that is not empty, where there is one.
    pub(super) fn word<'v>(
        &self,
        value: &'v Option<Spanned<String>>,
        place: &str,
    ) -> Result<Option<&'v str>, Error> {
        match value.as_ref().map(|value| value.get_ref().as_str()) {
            Some("") => {
                let needed = "a word, or no such line at all";
                Err(self.refused(span(value), place, "it is empty", needed))
            }
            word => Ok(word),
        }
    }

    pub(super) fn refused(&self, at: Option<usize>, place: &str, found: &str, needed: &str) -> Error {
        let line = at.map(|at| line_and_column(self.text, at).0);
        Error::Statement {
            path: self.path.into(),
            place: match line {
                Some(line) => format!("line {line}, {place}"),
                None => place.to_owned(),
            },
            found: found.to_owned(),
            needed: needed.to_owned(),
        }
    }
}

/// Where a value stands in the text.
pub(super) fn span<T>(value: &Option<Spanned<T>>) -> Option<usize> {
    value.as_ref().map(|value| value.span().start)
}

pub(super) fn shown(word: &str) -> String {
    format!("found {}", crate::formats::error::quoted(word))
}
