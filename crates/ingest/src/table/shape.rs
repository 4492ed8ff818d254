//! Where the readings of a text stand under one delimiter, and what stands above them.
//!
//! Readings are the rows at the end of the text that look alike: numbers below numbers, dates below dates. The names are
//! that reading of the rows above them under which the most columns are known: a row alone, a row with units below it, or
//! two rows that make one name. Where no such row is there, a comment just above the readings may hold the names.

use super::kind::{Kind, kind};
use crate::formats::climate::meaning::climate_column;
use crate::table::policy::MOST_COLUMNS;
use crate::text::grid::{is_blank, is_comment};
use crate::text::header::{Header, Meaning};
use crate::text::names::names_dew_point;
use crate::text::number::unquote;
use crate::text::policy::{HEADER_WITHIN_LINES, OBEYING_SHARE};
use crate::text::unit_row::unit_row;
use crate::text::{Delimiter, Line};

/// Rows beyond those of a head that show what readings are. Chosen.
const ROWS_LOOKED_AT: usize = 64;
/// Rows above the readings that names are looked for in. Chosen: loggers write a row of names for each property of a channel.
const ROWS_ABOVE: usize = 8;

/// What stands where in a text.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// Between the cells.
    pub delimiter: Delimiter,
    /// Index of the line of the names; none where there are none.
    pub names_at: Option<usize>,
    /// Index of the first line of readings.
    pub data_at: usize,
    /// Names of the columns; empty texts where there are none.
    pub names: Vec<String>,
    /// Units in a row of their own; as many as names, or none.
    pub units: Vec<String>,
    /// What each column holds.
    pub kinds: Vec<Kind>,
    /// How much is known of the columns by their names.
    pub known: usize,
    /// Whether rows may end before the last columns, which hold a word now and then.
    pub ends_early: bool,
}

/// How much is known under the best names so far, and how many names there may be.
struct Best {
    score: usize,
    most_names: usize,
}

struct Row<'a> {
    at: usize,
    /// Its fields, with those at its end that hold nothing.
    fields: usize,
    cells: Vec<&'a str>,
    kinds: Vec<Kind>,
}

/// The lines that shapes are found by, with their indices.
pub struct Sample<'l, 'a> {
    rows: Vec<(usize, &'l Line<'a>)>,
    comments: Vec<(usize, &'l Line<'a>)>,
}

/// The first lines that are not blank.
pub fn sample<'l, 'a>(lines: &'l [Line<'a>]) -> Sample<'l, 'a> {
    let first = (lines.iter().enumerate())
        .filter(|(_, line)| !is_blank(line.text))
        .take(HEADER_WITHIN_LINES + ROWS_LOOKED_AT);
    let (comments, rows) = first.partition(|(_, line)| is_comment(line.text));
    Sample { rows, comments }
}

/// The shape of lines under a delimiter; none where no two rows of two columns look alike.
pub fn shape(lines: &[Line<'_>], sample: &Sample<'_, '_>, delimiter: Delimiter) -> Option<Shape> {
    let Sample { rows, comments } = sample;
    // A delimiter that separates nothing where readings are looked for is none: that is told soonest.
    let is_split = |(_, line): &&(usize, &Line<'_>)| delimiter.split(line.text, |_, _| {}) > 1;
    let splits = |window: std::ops::Range<usize>| {
        let window = &rows[window];
        2 * window.iter().filter(is_split).count() >= window.len()
    };
    if !windows(rows.len()).any(splits) {
        return None;
    }
    // No instrument writes so many columns: a line of that many cells is damage, and looking into each takes seconds.
    let is_too_wide = |(_, line): &(usize, &Line<'_>)| {
        line.text.len() >= MOST_COLUMNS && delimiter.split(line.text, |_, _| {}) > MOST_COLUMNS
    };
    if rows.iter().any(is_too_wide) {
        return None;
    }
    let rows: Vec<Row<'_>> = rows
        .iter()
        .map(|(at, line)| row(*at, line.text, delimiter))
        .collect();
    let found = blocks(&rows)
        .into_iter()
        .map(|(first, kinds)| named(lines, &rows, comments, delimiter, first, kinds));
    found.max_by_key(|shape| (shape.known, std::cmp::Reverse(shape.data_at)))
}

/// The shape whose readings begin in that row, with its names.
fn named(
    lines: &[Line<'_>],
    rows: &[Row<'_>],
    comments: &[(usize, &Line<'_>)],
    delimiter: Delimiter,
    first: usize,
    kinds: Vec<Kind>,
) -> Shape {
    let above = &rows[..first];
    let from = above.len().saturating_sub(ROWS_ABOVE);
    let mut found = Shape {
        delimiter,
        names_at: None,
        data_at: rows[first].at,
        names: vec![String::new(); kinds.len()],
        units: Vec::new(),
        known: 0,
        ends_early: false,
        kinds,
    };
    let width = found.kinds.len();
    // Columns of events hold nothing in most rows.
    let fields = rows[first..].iter().map(|row| row.fields).max();
    let mut best = Best {
        score: 0,
        most_names: 2 * width.max(fields.unwrap_or(0)),
    };
    let told = comments.iter().map(|(at, _)| *at);
    let told: Vec<usize> = told.filter(|at| *at < found.data_at).collect();
    // The mark of comments may be the name of a column of numbers of rows; before units it is none.
    let is_row = |at: &usize| {
        let own = names_in(lines[*at].text, delimiter);
        let is_units = || unit_row(width, own[1..].iter().map(String::as_str)).is_some();
        own.len() == width && own[0] == "#" && !is_units()
    };
    let rows_above = above[from..].iter().map(|row| row.at);
    let mut names_at: Vec<usize> = rows_above.chain(told.iter().copied().filter(is_row)).collect();
    names_at.sort_unstable();
    let texts: Vec<(usize, &str)> = names_at.iter().map(|at| (*at, lines[*at].text)).collect();
    found.take_from(&mut best, &texts);
    if found.names_at.is_none() {
        let told = &told[told.len().saturating_sub(ROWS_ABOVE)..];
        let bare = |at: &usize| (*at, bare_comment(lines[*at].text));
        let texts: Vec<(usize, &str)> = told.iter().map(bare).collect();
        found.take_from(&mut best, &texts);
        if found.names.len() != width {
            found.forget_names();
        }
    }
    if let Some(names_at) = found.names_at {
        // The first reading may hold a word in the place of a number: it is none of the names all the same.
        let is_reading = |row: &&Row<'_>| {
            let is_units =
                !found.units.is_empty() && unit_row(row.cells.len(), row.cells.iter().copied()).is_some();
            row.at > names_at && !is_units && row.fit(&found.kinds).matches > 0
        };
        if let Some(earlier) = above.iter().find(is_reading) {
            found.data_at = earlier.at;
        }
        // Columns that are filled in few rows are columns all the same.
        let readings = rows
            .iter()
            .position(|row| row.at >= found.data_at)
            .unwrap_or(first);
        let mut kinds = kinds_of(&rows[readings..]).unwrap_or_default();
        kinds.resize(kinds.len().max(found.names.len()), Kind::Empty);
        found.kinds = kinds;
    }
    found
}

fn row<'a>(at: usize, text: &'a str, delimiter: Delimiter) -> Row<'a> {
    let mut cells = Vec::new();
    delimiter.split(text, |_, cell| cells.push(cell));
    let fields = cells.len();
    while cells.last().is_some_and(|cell| unquote(cell).is_empty()) {
        cells.pop();
    }
    let kinds = cells.iter().map(|cell| kind(cell)).collect();
    Row {
        at,
        fields,
        cells,
        kinds,
    }
}

/// Places among so many rows that readings are looked for in.
fn windows(rows: usize) -> impl Iterator<Item = std::ops::Range<usize>> {
    let ends = [rows, rows * 3 / 4, rows.div_ceil(2)];
    let ends = ends.into_iter().filter(|end| *end > 0);
    ends.flat_map(|end| [12, 3, 1].map(|size| end.saturating_sub(size)..end))
}

/// Where the readings may begin, and what their columns hold then. The last rows may be a foot, and rows above the table may
/// look alike, too: what readings are is tried from several places.
fn blocks(rows: &[Row<'_>]) -> Vec<(usize, Vec<Kind>)> {
    let mut tried: Vec<Vec<Kind>> = Vec::new();
    for kinds in windows(rows.len()).filter_map(|window| kinds_of(&rows[window])) {
        if !tried.contains(&kinds) {
            tried.push(kinds);
        }
    }
    let mut found: Vec<(usize, Vec<Kind>)> = Vec::new();
    for kinds in tried {
        if let Some(first) = first_of(rows, &kinds)
            && !found.iter().any(|(known, _)| *known == first)
        {
            found.push((first, kinds));
        }
    }
    found
}

/// What the columns of rows hold: for each what most filled cells of it are.
fn kinds_of(rows: &[Row<'_>]) -> Option<Vec<Kind>> {
    let of_readings = |row: &&Row<'_>| {
        row.kinds
            .iter()
            .any(|kind| *kind != Kind::Word && *kind != Kind::Empty)
    };
    let readings: Vec<&Row<'_>> = rows.iter().filter(of_readings).collect();
    let width = readings
        .iter()
        .map(|row| row.cells.len())
        .max()
        .filter(|width| *width >= 2)?;
    let kind_at = |column: usize| {
        let kinds = readings
            .iter()
            .filter_map(|row| row.kinds.get(column).copied())
            .filter(|kind| *kind != Kind::Empty);
        most_common(kinds).unwrap_or(Kind::Empty)
    };
    Some((0..width).map(kind_at).collect())
}

fn most_common<T: Ord + Copy>(items: impl Iterator<Item = T>) -> Option<T> {
    let mut counts = std::collections::BTreeMap::new();
    items.for_each(|item| *counts.entry(item).or_insert(0usize) += 1);
    counts
        .into_iter()
        .max_by_key(|(item, count)| (*count, *item))
        .map(|(item, _)| item)
}

/// Rows of words alone that stand more than once, letter by letter.
fn standing_again<'r, 'a>(rows: &'r [Row<'a>]) -> std::collections::BTreeSet<&'r Vec<&'a str>> {
    let (mut once, mut again) = (
        std::collections::BTreeSet::new(),
        std::collections::BTreeSet::new(),
    );
    let is_words = |row: &&Row<'_>| row.kinds.iter().all(|kind| *kind == Kind::Word);
    for row in rows.iter().filter(is_words) {
        if !once.insert(&row.cells) {
            again.insert(&row.cells);
        }
    }
    again
}

/// The first row from which on nearly all rows are readings.
fn first_of(rows: &[Row<'_>], kinds: &[Kind]) -> Option<usize> {
    let mut first = None;
    let (mut all, mut readings) = (0usize, 0usize);
    let again = standing_again(rows);
    for (at, row) in rows.iter().enumerate().rev() {
        let fit = row.fit(kinds);
        // Names that stand again are neither readings nor anything else.
        if !fit.is_reading && again.contains(&row.cells) {
            continue;
        }
        all += 1;
        readings += usize::from(fit.is_reading);
        let nearly_all = readings as f64 >= OBEYING_SHARE * all as f64 || all - readings <= 1;
        if fit.is_plain && nearly_all {
            first = Some(at);
        }
    }
    first.filter(|_| readings > 0)
}

/// How a row fits the kinds of columns.
struct Fit {
    /// Cells that hold what their column holds.
    matches: usize,
    /// Whether most of it are such cells, and no other stands where times are.
    is_reading: bool,
    /// Whether it is a reading without anything odd in it.
    is_plain: bool,
}

impl Row<'_> {
    fn fit(&self, kinds: &[Kind]) -> Fit {
        let (mut matches, mut strays, mut strays_of_time, mut gaps_of_time) = (0, 0, 0, 0);
        let mut at = 0;
        while at < self.kinds.len() && at < kinds.len() {
            let (own, of) = (self.kinds[at], kinds[at]);
            at += 1;
            if matches!(of, Kind::Empty | Kind::Word) {
                continue;
            }
            if own == of {
                matches += 1;
            } else if own == Kind::Empty {
                gaps_of_time += usize::from(of != Kind::Number);
            } else {
                strays += 1;
                strays_of_time += usize::from(of != Kind::Number);
            }
        }
        let is_reading = matches > strays && strays_of_time == 0;
        Fit {
            matches,
            is_reading,
            is_plain: is_reading && strays == 0 && gaps_of_time == 0,
        }
    }
}

/// A comment without its mark.
fn bare_comment(text: &str) -> &str {
    text.trim_start().trim_start_matches('#')
}

/// What names and units a row can be, with the two rows below it.
fn readings_of(
    text: &str,
    delimiter: Delimiter,
    below: Option<&Row<'_>>,
    next: Option<&Row<'_>>,
) -> Vec<(Vec<String>, Vec<String>)> {
    let names = names_in(text, delimiter);
    let Some(below) = below else {
        return vec![(names, Vec::new())];
    };
    let below_cells = || below.cells.iter().map(|cell| unquote(cell));
    let units = unit_row(names.len().max(below.cells.len()), below_cells());
    let is_words = below
        .kinds
        .iter()
        .all(|kind| matches!(kind, Kind::Word | Kind::Empty));
    let joined = |(index, name): (usize, &String)| match below_cells().nth(index).unwrap_or("") {
        "" => name.clone(),
        lower if name.is_empty() => lower.to_owned(),
        lower => format!("{name} {lower}"),
    };
    let mut found = Vec::new();
    match units {
        Some(mut units) => {
            units.resize(names.len(), String::new());
            found.push((names, units));
        }
        None if is_words => {
            // `CH0 CH1` between names and units.
            let units_of =
                |next: &Row<'_>| unit_row(names.len(), next.cells.iter().map(|cell| unquote(cell)));
            if let Some(mut units) = next.and_then(units_of) {
                units.resize(names.len(), String::new());
                found.push((names.clone(), units));
            }
            found.push((names.iter().enumerate().map(joined).collect(), Vec::new()));
            found.extend(partly_units(&names, below_cells()));
            found.push((names, Vec::new()));
        }
        None => found.push((names, Vec::new())),
    }
    found
}

/// Names of a row that holds units below some names of the row above it, and names of its own elsewhere.
fn partly_units<'b>(
    upper: &[String],
    lower: impl Iterator<Item = &'b str>,
) -> Option<(Vec<String>, Vec<String>)> {
    let unit = |cell: &str| {
        unit_row(1, std::iter::once(cell))?
            .pop()
            .filter(|unit| !unit.is_empty())
    };
    let column = |(index, cell): (usize, &str)| match (unit(cell), upper.get(index)) {
        (Some(unit), Some(name)) => (name.clone(), unit),
        _ => (cell.to_owned(), String::new()),
    };
    let (names, units): (Vec<String>, Vec<String>) = lower.enumerate().map(column).unzip();
    units
        .iter()
        .any(|unit| !unit.is_empty())
        .then_some((names, units))
}

fn names_in(text: &str, delimiter: Delimiter) -> Vec<String> {
    let mut names: Vec<String> = delimiter
        .header_cells(text)
        .iter()
        .map(|cell| unquote(cell).trim_end_matches([',', ':']).trim_end().to_owned())
        .collect();
    while names.last().is_some_and(String::is_empty) {
        names.pop();
    }
    names
}

impl Shape {
    /// A comment has as many names as there are columns, or is none of names.
    fn forget_names(&mut self) {
        self.names = vec![String::new(); self.kinds.len()];
        (self.names_at, self.units, self.known) = (None, Vec::new(), 0);
    }

    /// Takes the names from lines above the readings, the last of which is the next to them.
    fn take_from(&mut self, best: &mut Best, texts: &[(usize, &str)]) {
        for index in (0..texts.len()).rev() {
            let (at, text) = texts[index];
            // Units are no names where names stand above them.
            let cells = names_in(text, self.delimiter);
            let is_named = index > 0 && names_in(texts[index - 1].1, self.delimiter).len() > 1;
            if is_named && unit_row(cells.len(), cells.iter().map(String::as_str)).is_some() {
                continue;
            }
            let below = |by: usize| {
                let (at, text) = texts.get(index + by)?;
                Some(row(*at, text, self.delimiter))
            };
            for (names, units) in readings_of(text, self.delimiter, below(1).as_ref(), below(2).as_ref()) {
                self.take(best, names, units, (at, cells.len()));
            }
        }
    }

    /// Takes names where more is known under them than under those before. They stand at `at`, in a row of `own` names.
    fn take(&mut self, best: &mut Best, names: Vec<String>, units: Vec<String>, (at, own): (usize, usize)) {
        let words = names
            .iter()
            .filter(|name| matches!(kind(name), Kind::Word))
            .count();
        if names.len() < 2 || words == 0 || names.len() > best.most_names {
            return;
        }
        let unit = |index: usize| units.get(index).map_or("", String::as_str);
        let known: Vec<usize> = (names.iter().enumerate())
            .map(|(index, name)| known(name, unit(index), self.kinds.get(index).copied()))
            .collect();
        let known = known.iter().sum::<usize>();
        let score = 1 + words.min(self.kinds.len()) + 100 * known;
        // Of two rows of words under which as much is known both are the names; a shorter one above must tell more.
        let is_better = if names.len() > own {
            known > self.known
        } else {
            score > best.score || (score == best.score && self.names_at.is_some_and(|lower| at < lower))
        };
        if is_better {
            best.score = score;
            self.known = known;
            self.names_at = Some(at);
            (self.names, self.units) = (names, units);
        }
    }
}

/// How much a name says: its quantity and unit, its quantity, or nothing.
fn known(name: &str, unit: &str, kind: Option<Kind>) -> usize {
    if matches!(kind, Some(Kind::Moment | Kind::Date | Kind::Clock)) {
        return usize::from(crate::text::names::names_time(name));
    }
    let header = if unit.is_empty() {
        Header::parse(name)
    } else {
        Header::with_unit(name, unit)
    };
    match header.meaning {
        Meaning::Known { .. } => 2,
        Meaning::Refused { .. } => 1,
        Meaning::Other if names_dew_point(name) => 2,
        Meaning::Other => match climate_column(name, unit) {
            Some(column) => 1 + usize::from(column.unit_is_stated),
            None => usize::from(crate::text::names::names_time(name)),
        },
    }
}
