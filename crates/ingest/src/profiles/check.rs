//! From what a profile's file holds to a profile that can be obeyed: every statement checked once.

use std::collections::BTreeMap;
use std::path::Path;

use encoding_rs::Encoding;
use toml::Spanned;

use super::definition::{Column, ColumnRef, Container, HeaderPlace, Profile, TimeBase};
use super::error::ProfileError as Error;
use super::glob::Glob;
use super::raw;
use crate::campaign_file::line_and_column;
use crate::table::Answers;
use crate::text::grid::Dialect;
use crate::text::{Decimal, Delimiter};
use ieap_domain::Quantity;
use ieap_domain::unit;

const SEPARATORS: &str = "\"tab\", \"semicolon\", \"comma\", \"bar\", \"two blanks\" or \"blanks\"";

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
        let says_more = file.layout.is_some() || file.time.is_some() || !file.column.is_empty();
        if !file.answers.is_empty() {
            return self.answered(file.answers, file.recognise, says_more, &head);
        }
        let layout = file
            .layout
            .ok_or_else(|| missing("[layout]", "a table [layout]"))?;
        let time = file.time.ok_or_else(|| missing("[time]", "a table [time]"))?;
        let (container, header, lines_after_header) = self.layout(layout)?;
        let at = |spanned: &Spanned<raw::Time>| Some(spanned.span().start);
        let time_at = at(&time);
        let time = time.into_inner();
        let time_zero_is_step = match self.word(&time.zero, "[time] zero")? {
            None | Some("clock") => false,
            Some("step") => true,
            Some(other) => {
                let needed =
                    "\"clock\" (an instrument's clock), or \"step\" (the voltage is stepped at time 0)";
                return Err(self.refused(span(&time.zero), "[time] zero", &shown(other), needed));
            }
        };
        let columns = file
            .column
            .into_iter()
            .map(|column| self.column(column))
            .collect::<Result<Vec<_>, _>>()?;
        let profile = Profile {
            id: self.id.to_owned(),
            version: self.version(head.version)?,
            title: head.title.unwrap_or_else(|| self.id.to_owned()),
            digest: blake3::hash(self.text.as_bytes()).to_hex().to_string(),
            text: self.text.to_owned(),
            technique: head.technique,
            step_response: head.step_response.unwrap_or(true),
            name: file.recognise.name.as_deref().map(Glob::new),
            contains: file.recognise.contains,
            over_vendor: file.recognise.over_vendor,
            time: self.time(time, time_at)?,
            time_zero_is_step,
            start: file.start.map(|start| self.start(start)).transpose()?,
            container,
            header,
            lines_after_header,
            columns,
        };
        self.whole(&profile)?;
        Ok(profile)
    }

    /// A profile that leaves the table to the reader of tables and answers what that asks.
    fn answered(
        &self,
        stated: BTreeMap<String, String>,
        recognise: raw::Recognise,
        says_more: bool,
        head: &raw::Head,
    ) -> Result<Profile, Error> {
        if says_more {
            let needed =
                "either answers to what the reader of tables asks, or [layout], [time] and [[column]]";
            return Err(self.refused(None, "[answers]", "it stands beside a layout", needed));
        }
        let mut answers = Answers::default();
        for (key, answer) in &stated {
            let added = answers.add(key, answer);
            added.map_err(|reason| {
                self.refused(None, "[answers]", &reason, "a question with one of its answers")
            })?;
        }
        if recognise.name.is_none() && recognise.contains.is_empty() {
            let needed = "name or contains, for nothing else tells the files of this source apart";
            return Err(self.refused(None, "[recognise]", "it says nothing", needed));
        }
        Ok(Profile {
            id: self.id.to_owned(),
            version: self.version(head.version.clone())?,
            title: head.title.clone().unwrap_or_else(|| self.id.to_owned()),
            digest: blake3::hash(self.text.as_bytes()).to_hex().to_string(),
            text: self.text.to_owned(),
            technique: head.technique.clone(),
            step_response: head.step_response.unwrap_or(true),
            name: recognise.name.as_deref().map(Glob::new),
            contains: recognise.contains,
            over_vendor: false,
            time: TimeBase::Interval { interval_s: 1.0 },
            time_zero_is_step: false,
            start: None,
            container: Container::Answers(answers),
            header: HeaderPlace::None,
            lines_after_header: 0,
            columns: Vec::new(),
        })
    }

    /// What only the parts together show.
    fn whole(&self, profile: &Profile) -> Result<(), Error> {
        if profile.columns.is_empty() {
            let needed = "at least one [[column]] with column, quantity and unit";
            return Err(self.refused(None, "[[column]]", "it is missing", needed));
        }
        let unnamed = matches!(profile.header, HeaderPlace::None);
        if unnamed && profile.name.is_none() && profile.contains.is_empty() {
            let needed = "name or contains, for nothing else tells files without names of columns apart";
            return Err(self.refused(None, "[recognise]", "it says nothing", needed));
        }
        let named: Vec<&ColumnRef> = profile.named_columns().collect();
        for (index, column) in named.iter().enumerate() {
            if unnamed && matches!(column, ColumnRef::Name(_)) {
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
        let at = Some(layout.span().start);
        let layout = layout.into_inner();
        let header = match (&layout.header_line, &layout.header_contains) {
            (Some(line), None) => match usize::try_from(*line.get_ref()) {
                Ok(0) => HeaderPlace::None,
                Ok(line) => HeaderPlace::Line(line),
                Err(_) => {
                    let needed = "the line of the names from 1, or 0 where there are none";
                    let found = line.get_ref().to_string();
                    return Err(self.refused(
                        Some(line.span().start),
                        "[layout] header_line",
                        &found,
                        needed,
                    ));
                }
            },
            (None, Some(text)) if !text.is_empty() => HeaderPlace::Contains(text.clone()),
            (None, _) => {
                let needed =
                    "header_line = 1, or header_contains = \"a text of the line that names the columns\"";
                return Err(self.refused(at, "[layout]", "where the names stand is missing", needed));
            }
            (Some(_), Some(_)) => {
                return Err(self.refused(
                    at,
                    "[layout]",
                    "header_line and header_contains both stand",
                    "one of them",
                ));
            }
        };
        let container = match self.word(&layout.kind, "[layout] kind")? {
            None | Some("text") => self.text_container(&layout, at)?,
            Some("sheet") => {
                self.sheet_only(&layout)?;
                Container::Sheet {
                    name: layout.sheet.clone(),
                }
            }
            Some(other) => {
                return Err(self.refused(
                    span(&layout.kind),
                    "[layout] kind",
                    &shown(other),
                    "\"text\" or \"sheet\"",
                ));
            }
        };
        Ok((container, header, usize::from(layout.lines_after_header)))
    }

    fn text_container(&self, layout: &raw::Layout, at: Option<usize>) -> Result<Container, Error> {
        let separator = self.word(&layout.separator, "[layout] separator")?;
        let delimiter = match separator {
            Some("tab") => Delimiter::Tab,
            Some("semicolon") => Delimiter::Semicolon,
            Some("comma") => Delimiter::Comma,
            Some("bar") => Delimiter::Bar,
            Some("two blanks") => Delimiter::WideBlanks,
            Some("blanks") => Delimiter::Blanks,
            Some(other) => {
                return Err(self.refused(
                    span(&layout.separator),
                    "[layout] separator",
                    &shown(other),
                    SEPARATORS,
                ));
            }
            None => return Err(self.refused(at, "[layout] separator", "it is missing", SEPARATORS)),
        };
        let decimal = match self.word(&layout.decimal, "[layout] decimal")? {
            Some("point") => Decimal::Point,
            Some("comma") => Decimal::Comma,
            other => {
                let found = other.map_or("it is missing".to_owned(), shown);
                let at = span(&layout.decimal).or(at);
                return Err(self.refused(at, "[layout] decimal", &found, "\"point\" or \"comma\""));
            }
        };
        if layout.sheet.is_some() {
            return Err(self.refused(
                at,
                "[layout] sheet",
                "it stands beside kind = \"text\"",
                "kind = \"sheet\"",
            ));
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
                return Err(self.refused(
                    span(value),
                    &place,
                    found,
                    "nothing: the workbook itself tells numbers from texts",
                ));
            }
        }
        Ok(())
    }

    fn column(&self, column: Spanned<raw::Column>) -> Result<Column, Error> {
        let at = Some(column.span().start);
        let column = column.into_inner();
        let place = |key: &str| format!("[[column]] {key}");
        let reference = column.column.as_ref().ok_or_else(|| {
            self.refused(
                at,
                &place("column"),
                "it is missing",
                "the column's name as the file has it, or its number",
            )
        })?;
        let reference = self.column_ref(reference, &place("column"))?;
        let quantity = self.quantity(&column.quantity, at)?;
        let text = column.unit.as_ref().map_or("", |unit| unit.get_ref().as_str());
        let conversion = unit::conversion(quantity, text).map_err(|error| {
            let at = span(&column.unit).or(at);
            self.refused(
                at,
                &place("unit"),
                &error.to_string(),
                "the unit of the column's numbers",
            )
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

    fn quantity(&self, quantity: &Option<Spanned<String>>, at: Option<usize>) -> Result<Quantity, Error> {
        let place = "[[column]] quantity";
        let known: Vec<&str> = Quantity::ALL
            .into_iter()
            .filter(|quantity| !matches!(quantity, Quantity::Time | Quantity::Other))
            .map(Quantity::key)
            .collect();
        let word = self.word(quantity, place)?;
        match word
            .filter(|word| known.contains(word))
            .and_then(Quantity::from_key)
        {
            Some(quantity) => Ok(quantity),
            None => {
                let found = word.map_or("it is missing".to_owned(), shown);
                let needed = format!(
                    "one of {}; a column without a meaning needs no entry",
                    known.join(", ")
                );
                Err(self.refused(span(quantity).or(at), place, &found, &needed))
            }
        }
    }

    pub(super) fn column_ref(
        &self,
        column: &Spanned<raw::ColumnRef>,
        place: &str,
    ) -> Result<ColumnRef, Error> {
        match column.get_ref() {
            raw::ColumnRef::Name(name) if !name.trim().is_empty() => {
                Ok(ColumnRef::Name(name.trim().to_owned()))
            }
            raw::ColumnRef::Number(number) if (1..=10_000).contains(number) => {
                Ok(ColumnRef::Index(*number as usize - 1))
            }
            raw::ColumnRef::Number(number) => Err(self.refused(
                Some(column.span().start),
                place,
                &number.to_string(),
                "a number from 1",
            )),
            raw::ColumnRef::Name(_) => {
                Err(self.refused(Some(column.span().start), place, "it is empty", "a name"))
            }
        }
    }

    fn number(
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

    /// A word that is not empty, where there is one.
    pub(super) fn word<'v>(
        &self,
        value: &'v Option<Spanned<String>>,
        place: &str,
    ) -> Result<Option<&'v str>, Error> {
        match value.as_ref().map(|value| value.get_ref().as_str()) {
            Some("") => Err(self.refused(
                span(value),
                place,
                "it is empty",
                "a word, or no such line at all",
            )),
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
