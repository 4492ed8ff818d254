//! How a delimited text is written and where its table stands: that reading under which the most columns are known.
//!
//! The decision comes from the grammar of the rows and never from the computer's locale.

use super::columns::headers;
use super::kind::{Kind, kind};
use super::numbers::{Found, Writing, decimal_word};
use super::policy::ROWS_ASKED;
use super::shape::{Shape, sample, shape};
use super::stated::AsStated;
use crate::formats::ReadContext;
use crate::formats::assemble::{is_modulus_sweep, is_spectrum};
use crate::formats::error::{ReadError, quoted};
use crate::text::grid::{Dialect, is_blank_or_comment};
use crate::text::header::{Header, Meaning};
use crate::text::names::names_time;
use crate::text::number;
use crate::text::policy::{HEADER_WITHIN_LINES, LINES_ASKED, OBEYING_SHARE};
use crate::text::{Decimal, Delimiter, Group, Line, NumberForm};
use ieap_domain::unit;
use ieap_domain::{Issue, Quantity};

/// What was decided.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// Delimiter and form of numbers.
    pub dialect: Dialect,
    /// Where names and readings stand, and what the columns hold.
    pub shape: Shape,
    /// How the numbers of each column are written, where columns differ; else empty.
    pub own_numbers: Vec<NumberForm>,
    /// What a profile states of it.
    pub stated: Option<AsStated>,
}

impl Layout {
    /// The columns as their names and units describe them.
    pub fn headers(&self) -> Vec<Header> {
        if let Some(stated) = &self.stated {
            return stated.headers.clone();
        }
        let names: Vec<&str> = self.shape.names.iter().map(String::as_str).collect();
        let units = (!self.shape.units.is_empty()).then_some(self.shape.units.as_slice());
        headers(&names, units)
    }

    /// Whether a line holds no reading.
    pub fn is_no_reading(&self, text: &str) -> bool {
        match &self.stated {
            Some(stated) => stated.is_no_reading(text),
            None => is_blank_or_comment(text),
        }
    }

    /// Ranges of lines of readings: one, or several where the names stand again because a logger was started anew.
    pub fn parts(&self, lines: &[Line<'_>]) -> Vec<std::ops::Range<usize>> {
        let Some(names) = self.shape.names_at.map(|at| lines[at].text.trim()) else {
            let all = self.shape.data_at..lines.len();
            return std::iter::once(all.start..self.without_foot(lines, all.clone())).collect();
        };
        let mut parts = Vec::new();
        let mut from = self.shape.data_at;
        let again: Vec<usize> = (from..lines.len())
            .filter(|at| lines[*at].text.trim() == names)
            .collect();
        // A row of units stands below the names each time.
        let below = self.shape.data_at - self.shape.names_at.unwrap_or(self.shape.data_at);
        for at in again {
            parts.push(from..self.without_foot(lines, from..at));
            from = (at + below).min(lines.len());
        }
        parts.push(from..self.without_foot(lines, from..lines.len()));
        parts
    }

    /// Says how many lines between the parts and behind them are no rows.
    pub fn between(&self, lines: &[Line<'_>]) -> Option<Issue> {
        let parts = self.parts(lines);
        let ends = parts.iter().skip(1).map(|part| part.start).chain([lines.len()]);
        let gaps = parts.iter().zip(ends).map(|(part, end)| part.end..end);
        let is_other = |at: &usize| {
            !self.is_no_reading(lines[*at].text)
                && lines[*at].text.trim() != lines[self.shape.names_at.unwrap_or(0)].text.trim()
        };
        let mut others = gaps.flatten().filter(is_other);
        let first = others.next()?;
        let message = format!(
            "{} lines between or behind the rows have neither their fields nor what these hold, first {}; they are no rows",
            1 + others.count(),
            quoted(lines[first].text)
        );
        Some(Issue::note("lines-between", message).at(format!("line {}", lines[first].number)))
    }

    /// The end of a part without the lines behind it that are no rows, such as `Logging to: LD0029.CSV`.
    fn without_foot(&self, lines: &[Line<'_>], part: std::ops::Range<usize>) -> usize {
        let is_row = |at: &usize| self.stated.is_some() || self.is_row(lines[*at].text);
        part.clone()
            .rev()
            .find(is_row)
            .map_or(part.start, |last| last + 1)
    }

    /// Whether a line is a row: it has as many fields as there are names, or its fields hold what their columns do.
    fn is_row(&self, text: &str) -> bool {
        let names = self.shape.names.len();
        let (fields, filled) = width_of(self.dialect.delimiter, text);
        if fields == names || filled == names {
            return true;
        }
        let (mut holds, mut strays) = (false, false);
        self.dialect.delimiter.split(text, |index, cell| {
            let (own, of) = (
                kind(cell),
                self.shape.kinds.get(index).copied().unwrap_or(Kind::Empty),
            );
            strays |= own != of && own != Kind::Empty;
            holds |= own == of && !matches!(own, Kind::Empty | Kind::Word);
        });
        holds && !strays
    }

    /// The parts as one, with the lines above them: for a table whose names stand again although its rows go on.
    pub fn joined<'a>(&self, lines: &[Line<'a>], parts: &[std::ops::Range<usize>]) -> Vec<Line<'a>> {
        let rows = parts.iter().flat_map(|part| &lines[part.clone()]);
        lines[..self.shape.data_at].iter().chain(rows).copied().collect()
    }

    /// The lines of each of several blocks that stand side by side under the same names, from the names on; none where there is
    /// one. Each has a name: what stands above its names.
    pub fn blocks<'a>(&self, lines: &[Line<'a>]) -> Vec<(String, Vec<Line<'a>>)> {
        let names: Vec<String> = self
            .shape
            .names
            .iter()
            .map(|name| name.trim().to_lowercase())
            .collect();
        let repeats = |width: &usize| {
            let at = |index: usize| names.get(index).map_or("", String::as_str);
            (0..names.len().next_multiple_of(*width)).all(|index| at(index) == at(index % width))
        };
        let is_timed = |width: &usize| names[..*width].iter().any(|name| names_time(name));
        let width = (2..=names.len().div_ceil(2)).find(|width| repeats(width) && is_timed(width));
        let width = width.filter(|_| self.stated.is_none());
        let (Some(width), Some(names_at)) = (width.filter(|width| *width < names.len()), self.shape.names_at)
        else {
            return Vec::new();
        };
        let part = |line: &Line<'a>, block: usize| Line {
            text: fields(
                self.dialect.delimiter,
                line.text,
                block * width..(block + 1) * width,
            ),
            ..*line
        };
        let count = names.len().div_ceil(width);
        let label = |block: usize| {
            let above = lines[..names_at].last().map(|line| part(line, block).text);
            let mark = |c: char| c.is_whitespace() || ",;\"|".contains(c);
            above.unwrap_or("").trim_matches(mark).to_owned()
        };
        (0..count)
            .map(|block| {
                (
                    label(block),
                    lines[names_at..].iter().map(|line| part(line, block)).collect(),
                )
            })
            .collect()
    }

    /// Decides the form of numbers anew, from all rows.
    ///
    /// # Errors
    /// They contradict each other, or can be read in two ways.
    pub fn ask_all(&mut self, lines: &[Line<'_>], context: &ReadContext) -> Result<(), ReadError> {
        if self.stated.is_some() {
            return Ok(());
        }
        (self.dialect.numbers, self.own_numbers) = numbers(&self.shape, lines, usize::MAX, context)?;
        Ok(())
    }
}

/// Decides how to read `lines`, all of which have their line end.
///
/// # Errors
/// No line names what times the rows, no row follows, no delimiter fits, or the numbers can be read in several ways.
pub fn decide(lines: &[Line<'_>], context: &ReadContext) -> Result<Layout, ReadError> {
    if let Some(stated) = context.answers.table() {
        let (mut dialect, shape, stated) = stated.place(lines)?;
        let is_decimal = |mark: &Group| mark.label() == decimal_word(dialect.numbers.decimal);
        dialect.numbers.group = group_answered(context).flatten().filter(|mark| !is_decimal(mark));
        return Ok(Layout {
            dialect,
            shape,
            own_numbers: Vec::new(),
            stated: Some(stated),
        });
    }
    let shape = best_shape(lines)?;
    let (numbers, own_numbers) = numbers(&shape, lines, ROWS_ASKED, context)?;
    Ok(Layout {
        own_numbers,
        stated: None,
        dialect: Dialect {
            delimiter: shape.delimiter,
            numbers,
        },
        shape,
    })
}

/// The shape of a text that has names and is timed by something.
///
/// # Errors
/// As [`decide`], but for the numbers.
pub fn best_shape(lines: &[Line<'_>]) -> Result<Shape, ReadError> {
    let shapes = shapes(lines);
    if let Some(refusal) = on_its_side(lines) {
        return Err(refusal);
    }
    let Some(best) = best_of(&shapes) else {
        return Err(match names_alone(lines) {
            Some(names) => without_rows(names, lines),
            None => no_header(lines),
        });
    };
    let mut best = best.clone();
    from_first_names(&mut best, lines);
    best.units = with_preamble(&best, lines);
    let headers = headers(
        &best.names.iter().map(String::as_str).collect::<Vec<_>>(),
        (!best.units.is_empty()).then_some(best.units.as_slice()),
    );
    let names_one = best.names.iter().any(|name| names_time(name));
    match evenness(&best, lines) {
        Some(ends_early) if !names_one || is_timed(&best, &headers) => best.ends_early = ends_early,
        _ => return Err(no_reading(&best, lines)),
    }
    if !is_timed(&best, &headers) {
        return Err(no_header(lines));
    }
    Ok(best)
}

/// Begins a shape at the first place where its names stand: a logger that was started anew writes them again, and what it wrote
/// before may look otherwise.
fn from_first_names(shape: &mut Shape, lines: &[Line<'_>]) {
    let Some(at) = shape.names_at else {
        return;
    };
    let is_same = |line: &Line<'_>| line.text.trim() == lines[at].text.trim();
    if let Some(first) = lines[..at].iter().position(is_same) {
        shape.data_at = first + shape.data_at - at;
        shape.names_at = Some(first);
    }
}

/// The shapes of a text under every delimiter, or under the one that its first line states as spreadsheets do: `sep=;`.
pub fn shapes(lines: &[Line<'_>]) -> Vec<Shape> {
    let stated = lines
        .first()
        .and_then(|line| line.text.trim().strip_prefix("sep="));
    let stated = stated.and_then(|mark| match mark {
        "" | "\t" | "\\t" => Some(Delimiter::Tab),
        ";" => Some(Delimiter::Semicolon),
        "," => Some(Delimiter::Comma),
        "|" => Some(Delimiter::Bar),
        _ => None,
    });
    let sample = sample(lines);
    let under = |delimiter: Delimiter| {
        let is_possible = stated.is_none_or(|stated| stated == delimiter);
        is_possible.then(|| shape(lines, &sample, delimiter)).flatten()
    };
    let mut found: Vec<Shape> = Delimiter::SURE.into_iter().filter_map(under).collect();
    // Blanks also stand inside names and texts: two together separate columns only where the rows are even under them, and one
    // only where nothing else does.
    found.extend(under(Delimiter::WideBlanks).filter(|shape| has_even_rows(shape, lines)));
    if !found
        .iter()
        .any(|shape| shape.names_at.is_some() && shape.known > 0)
    {
        found.extend(under(Delimiter::Blanks));
    }
    found
}

/// The shape under which most is known; of several the one with the surest delimiter.
fn best_of(shapes: &[Shape]) -> Option<&Shape> {
    let named = shapes
        .iter()
        .filter(|shape| shape.names_at.is_some() && shape.known > 0);
    named.reduce(|a, b| if b.known > a.known { b } else { a })
}

/// Units with those that lines above the names state: `Humidity = %rh`.
fn with_preamble(shape: &Shape, lines: &[Line<'_>]) -> Vec<String> {
    let above = &lines[..shape.names_at.unwrap_or(0)];
    // `T` and `t` are two names, where both stand there.
    let among = |name: &String, is_same: &dyn Fn(&str) -> bool| {
        let values = above.iter().filter_map(|line| {
            let (key, value) = line.text.split_once(['=', ':'])?;
            let value = value.trim_matches(|c: char| c.is_whitespace() || ",;\"".contains(c));
            is_same(number::unquote(key).trim_start_matches('#').trim()).then(|| value.to_owned())
        });
        values.into_iter().find(|value| {
            unit::is_known(value) || Header::with_unit(name, value).meaning.quantity().is_some()
        })
    };
    let stated = |name: &String| {
        let exactly = among(name, &|key| key == name.trim());
        exactly.or_else(|| among(name, &|key| key.eq_ignore_ascii_case(name.trim())))
    };
    let unit = |(index, name): (usize, &String)| {
        let own = shape.units.get(index).filter(|unit| !unit.is_empty()).cloned();
        own.or_else(|| stated(name)).unwrap_or_default()
    };
    let units: Vec<String> = shape.names.iter().enumerate().map(unit).collect();
    if units.iter().all(String::is_empty) {
        Vec::new()
    } else {
        units
    }
}

/// Whether something times the rows, or they are those of a spectrum or a sweep.
fn is_timed(shape: &Shape, headers: &[Header]) -> bool {
    let is_clock = |kind: &Kind| matches!(kind, Kind::Moment | Kind::Clock);
    let is_named = |(name, kind): (&String, &Kind)| *kind == Kind::Number && names_time(name);
    let meanings = meanings(headers);
    let is_time = |(meaning, kind): (&Meaning, &Kind)| {
        *kind == Kind::Number && meaning.quantity() == Some(Quantity::Time)
    };
    shape.kinds.iter().any(is_clock)
        || meanings.iter().zip(&shape.kinds).any(is_time)
        || is_spectrum(&meanings)
        || is_modulus_sweep(&meanings)
        || shape.names.iter().zip(&shape.kinds).any(is_named)
}

/// Whether rows have as many fields as there are names. What is empty at the end of a row may be left away with its
/// delimiters; a delimiter behind the last field begins no other.
fn has_even_rows(shape: &Shape, lines: &[Line<'_>]) -> bool {
    evenness(shape, lines).is_some()
}

/// Whether rows end early, where they are even at all.
fn evenness(shape: &Shape, lines: &[Line<'_>]) -> Option<bool> {
    let names = shape.names.len();
    let (mut all, mut fitting, mut full, mut shortest) = (0usize, 0usize, 0usize, names);
    for line in rows(shape, lines).take(LINES_ASKED) {
        let (fields, filled) = width_of(shape.delimiter, line.text);
        all += 1;
        fitting += usize::from(filled <= names);
        full += usize::from(filled == names || fields == names);
        shortest = shortest.min(filled.max(fields));
    }
    let obeys = |part: usize| part > 0 && part as f64 >= OBEYING_SHARE * all as f64;
    // Columns of events are filled in few rows.
    let is_known = |index: usize| {
        let header = Header::parse(&shape.names[index]);
        header.meaning.named_quantity().is_some()
    };
    let ends_early = full > 0 && !(shortest..names).any(is_known);
    (obeys(fitting) && (obeys(full) || ends_early)).then_some(!obeys(full))
}

/// Some fields of a line with what stands between them.
fn fields(delimiter: Delimiter, text: &str, wanted: std::ops::Range<usize>) -> &str {
    let (mut from, mut to) = (None, 0);
    delimiter.split(text, |index, cell| {
        if wanted.contains(&index) {
            let start = cell.as_ptr() as usize - text.as_ptr() as usize;
            from = from.or(Some(start));
            to = start + cell.len();
        }
    });
    from.map_or("", |from| &text[from..to])
}

/// Fields of a line, and fields up to the last that holds anything.
fn width_of(delimiter: Delimiter, text: &str) -> (usize, usize) {
    let mut filled = 0;
    let fields = delimiter.split(text, |index, text| {
        if !number::unquote(text).is_empty() {
            filled = index + 1;
        }
    });
    (fields, filled)
}

/// Lines of readings.
fn rows<'l, 'a>(shape: &Shape, lines: &'l [Line<'a>]) -> impl Iterator<Item = &'l Line<'a>> + use<'l, 'a> {
    let names = shape.names_at.map(|at| lines[at].text);
    let data = lines[shape.data_at..].iter();
    data.filter(move |line| !is_blank_or_comment(line.text) && Some(line.text) != names)
}

/// The form of the numbers of a shape, by its first `most` rows; that of each column, where they differ.
///
/// # Errors
/// The numbers contradict each other, or can be read in several ways.
pub fn numbers(
    shape: &Shape,
    lines: &[Line<'_>],
    most: usize,
    context: &ReadContext,
) -> Result<(NumberForm, Vec<NumberForm>), ReadError> {
    let mut writing = Writing::new(shape.names.len());
    for line in rows(shape, lines).take(most) {
        shape.delimiter.split(line.text, |index, cell| {
            if shape.kinds.get(index) == Some(&Kind::Number) {
                writing.add(index, line.number, cell);
            }
        });
    }
    let decimal = match context.answers.of("decimal") {
        Some("point") => Some(Decimal::Point),
        Some("comma") => Some(Decimal::Comma),
        _ => None,
    };
    let group = group_answered(context);
    match writing.decide(shape.delimiter, decimal, group) {
        Found::One(form) => Ok((form, Vec::new())),
        Found::Each(forms) => Ok((forms[0], forms)),
        Found::Open(question) => Err(ReadError::Asked(question)),
        Found::Contradiction { line, first, second } => Err(ReadError::AmbiguousNumbers {
            line,
            found: format!(
                "{} has a decimal comma and {} a decimal point",
                quoted(&first),
                quoted(&second)
            ),
            mend: match shape.delimiter {
                Delimiter::Comma => {
                    "export with a point as decimal sign, or with semicolons or tabs between the columns"
                }
                _ => "export with a point as decimal sign",
            },
        }),
    }
}

/// The marks between thousands that somebody answered.
fn group_answered(context: &ReadContext) -> Option<Option<Group>> {
    let marks = [Group::Comma, Group::Point, Group::Apostrophe, Group::Space];
    let word = context.answers.of("thousands")?;
    Some(marks.into_iter().find(|mark| mark.label() == word))
}

/// Whether a time column among two cells or more can be used; none where there is no such column. The frequency of a
/// spectrum, or of a modulus without any time, does as well.
pub fn time_among<'a>(cells: impl Iterator<Item = &'a str>) -> Option<bool> {
    let headers: Vec<Header> = cells.map(Header::parse).collect();
    axis_among(&meanings(&headers))
}

fn axis_among(meanings: &[Meaning]) -> Option<bool> {
    if meanings.len() < 2 {
        return None;
    }
    if is_spectrum(meanings) || is_modulus_sweep(meanings) {
        return Some(true);
    }
    let times = meanings
        .iter()
        .filter(|meaning| meaning.named_quantity() == Some(Quantity::Time));
    times
        .map(|meaning| meaning.quantity().is_some())
        .reduce(|a, b| a || b)
}

fn meanings(headers: &[Header]) -> Vec<Meaning> {
    headers.iter().map(|header| header.meaning.clone()).collect()
}

/// A line that names what times the rows, where no row follows it.
fn names_alone<'l, 'a>(lines: &'l [Line<'a>]) -> Option<&'l Line<'a>> {
    lines
        .iter()
        .take(HEADER_WITHIN_LINES)
        .filter(|line| !is_blank_or_comment(line.text))
        .find(|line| {
            Delimiter::ALL.into_iter().any(|delimiter| {
                let cells = delimiter.header_cells(line.text);
                cells.len() > 1 && time_among(cells.iter().map(String::as_str)).is_some()
            })
        })
}

/// Names of a table below which no row holds numbers: none follows yet, or what follows is none.
fn without_rows(names: &Line<'_>, lines: &[Line<'_>]) -> ReadError {
    let below = |line: &&Line<'_>| line.number > names.number && !is_blank_or_comment(line.text);
    match lines.iter().find(below) {
        None => ReadError::header_only(names.number, quoted(names.text)),
        Some(first) => ReadError::NoReading {
            header: names.number,
            line: first.number,
            found: format!(
                "under {} stands {}, and no row holds numbers",
                quoted(names.text),
                quoted(first.text)
            ),
            mend: "write only numbers below the name of the time, with one decimal sign in the whole file",
        },
    }
}

/// Rows that do not fit their names: says how the first differs.
fn no_reading(shape: &Shape, lines: &[Line<'_>]) -> ReadError {
    let first = rows(shape, lines).next();
    let (line, text) = first.map_or((0, ""), |line| (line.number, line.text));
    let fields = shape.delimiter.split(text, |_, _| {});
    ReadError::NoReading {
        header: shape.names_at.map_or(0, |at| lines[at].number),
        line,
        found: format!(
            "under the {} names of the header (between them: {}) stands {}, which has {} fields",
            shape.names.len(),
            shape.delimiter.label(),
            quoted(text),
            fields
        ),
        mend: match shape.delimiter {
            Delimiter::Comma => {
                "export with a point as decimal sign, or with semicolons or tabs between the columns"
            }
            _ => {
                "give every row as many fields as there are names, and only numbers below the name of the time"
            }
        },
    }
}

/// A table on its side: each line begins with a name, and numbers stand behind it.
fn on_its_side(lines: &[Line<'_>]) -> Option<ReadError> {
    const FEWEST_NUMBERS: usize = 3;
    let is_named = |line: &&Line<'_>| {
        Delimiter::ALL.into_iter().any(|delimiter| {
            let mut cells = Vec::new();
            delimiter.split(line.text, |_, cell| cells.push(cell));
            let is_known = |name: &str| Header::parse(name).meaning.quantity().is_some();
            cells.len() > FEWEST_NUMBERS
                && is_known(cells[0])
                && cells[1..]
                    .iter()
                    .all(|cell| matches!(kind(cell), Kind::Number | Kind::Empty))
        })
    };
    let mut filled = lines.iter().filter(|line| !is_blank_or_comment(line.text));
    let (first, second) = (filled.next()?, filled.next()?);
    (is_named(&first) && is_named(&second)).then(|| ReadError::NoReading {
        header: first.number,
        line: first.number,
        found: format!(
            "the table stands on its side (it is transposed): its names are in the first column, first {}",
            quoted(first.text)
        ),
        mend: "transpose it, so that each column has its name in the first row",
    })
}

fn no_header(lines: &[Line<'_>]) -> ReadError {
    if let Some(line) = lines
        .iter()
        .take(HEADER_WITHIN_LINES)
        .find(|line| names_frequency(line))
    {
        return ReadError::NoImpedance {
            line: line.number,
            found: quoted(line.text),
        };
    }
    let first = lines.iter().find(|line| !is_blank_or_comment(line.text));
    ReadError::NoHeader {
        line: first.map_or(0, |line| line.number),
        found: quoted(first.map_or("", |line| line.text)),
    }
}

/// Whether a line names a frequency beside other columns.
fn names_frequency(line: &Line<'_>) -> bool {
    let is_frequency =
        |cell: &String| Header::parse(cell).meaning.named_quantity() == Some(Quantity::Frequency);
    !is_blank_or_comment(line.text)
        && Delimiter::ALL.into_iter().any(|delimiter| {
            let cells = delimiter.header_cells(line.text);
            cells.len() > 1 && cells.iter().any(is_frequency)
        })
}

#[cfg(test)]
#[path = "layout_tests.rs"]
mod tests;
