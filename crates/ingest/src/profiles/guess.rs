//! What the rows of a file show of its layout, for a profile: the reader of tables' own findings, also where they do not
//! suffice to read it.

use crate::formats::ReadContext;
use crate::formats::sheet_cells::Sheet;
use crate::formats::stamp::DateOrder;
use crate::profiles::policy::ROWS_ASKED;
use crate::table::kind::{self, Kind};
use crate::table::layout::Layout;
use crate::table::shape::Shape;
use crate::table::{self, Table, layout, order, sheet, start};
use crate::text::grid::Dialect;
use crate::text::header::Header;
use crate::text::names::names_time;
use crate::text::{Decimal, Line, Lines, decode};
use ieap_domain::Quantity;

/// What was seen.
pub(super) struct Guess {
    /// Separator and form of numbers; none for a workbook.
    pub dialect: Option<Dialect>,
    pub encoding: Option<&'static str>,
    /// The workbook's sheet.
    pub sheet: Option<String>,
    /// Line of the names, from 1; 0 where there are none.
    pub header_line: usize,
    /// The line of a text that names the columns.
    pub names_line: Option<String>,
    pub lines_after_header: usize,
    /// Names of the columns; empty texts where there are none.
    pub names: Vec<String>,
    /// Units in a row of their own.
    pub units: Vec<String>,
    /// Which columns hold numbers.
    pub is_number: Vec<bool>,
    pub time: Option<TimeGuess>,
    /// The line of the head that holds the start.
    pub start: Option<StartGuess>,
}

/// A line above the names that says when the run began.
pub(super) struct StartGuess {
    /// What the line begins with: `Start:`.
    pub begins: String,
    /// The orders of day and month in which its date can be read.
    pub orders: Vec<&'static str>,
}

/// What times the rows.
pub(super) enum TimeGuess {
    Elapsed {
        index: usize,
        unit: Option<String>,
    },
    Epoch {
        index: usize,
        unit: &'static str,
    },
    Clock {
        index: usize,
        date: Option<usize>,
        orders: Vec<&'static str>,
    },
    TimeOfDay {
        index: usize,
    },
}

impl Guess {
    /// Columns that the time is read from.
    pub fn time_columns(&self) -> Vec<usize> {
        match &self.time {
            Some(TimeGuess::Clock { index, date, .. }) => std::iter::once(*index).chain(*date).collect(),
            Some(
                TimeGuess::Elapsed { index, .. }
                | TimeGuess::Epoch { index, .. }
                | TimeGuess::TimeOfDay { index },
            ) => vec![*index],
            None => Vec::new(),
        }
    }
}

/// The first line that begins so and goes on with a date and a time.
fn start_line(lines: &[Line<'_>]) -> Option<StartGuess> {
    lines.iter().find_map(|line| {
        let text = line.text.trim_start_matches(['"', '#', ' ']);
        let (_, rest) = start::after_word(text)?;
        let orders = order::orders(rest.trim_matches(start::is_mark));
        let end = text.len() - rest.trim_start_matches(start::is_mark).len();
        let begins = line.text.trim_start_matches('"').strip_suffix(&text[end..])?;
        (!orders.is_empty()).then(|| StartGuess {
            begins: begins.trim_end_matches(['"', ' ', '\t']).to_owned(),
            orders: orders.into_iter().map(DateOrder::key).collect(),
        })
    })
}

/// The layout of a delimited text; none where no separator makes a table of numbers.
pub(super) fn guess_text(bytes: &[u8]) -> Option<Guess> {
    let decoded = decode(bytes);
    if decoded.text.contains('\0') {
        return None;
    }
    let mut lines: Vec<Line<'_>> = Lines::new(&decoded.text).take(ROWS_ASKED).collect();
    lines.pop_if(|line| !line.ended);
    let mut guess = guess(&lines)?;
    guess.encoding = Some(decoded.encoding);
    let head = lines.iter().position(|line| line.number == guess.header_line);
    guess.names_line = head.map(|at| lines[at].text.trim().trim_start_matches('\u{feff}').to_owned());
    guess.start = start_line(&lines[..head.unwrap_or(0)]);
    Some(guess)
}

/// The layout of the first sheet with a table of numbers.
pub(super) fn guess_sheet(sheets: &[Sheet]) -> Option<Guess> {
    sheets.iter().find_map(|sheet| {
        let texts = sheet::texts(sheet, usize::MAX);
        let mut guess = guess(&sheet::lines(sheet, &texts))?;
        guess.dialect = None;
        guess.sheet = Some(sheet.name.clone());
        Some(guess)
    })
}

fn guess(lines: &[Line<'_>]) -> Option<Guess> {
    let numbers = |shape: &Shape| shape.kinds.iter().filter(|kind| **kind == Kind::Number).count();
    let shapes = layout::shapes(lines)
        .into_iter()
        .filter(|shape| shape.kinds.len() >= 2 && numbers(shape) > 0);
    let mut shape = shapes.max_by_key(|shape| (shape.known, numbers(shape)))?;
    let width = shape.kinds.len().max(shape.names.len());
    shape.names.resize(width, String::new());
    // Where several forms of numbers fit, the plainest.
    let form = layout::numbers(&shape, lines, usize::MAX, &ReadContext::default());
    let layout = Layout {
        dialect: Dialect {
            delimiter: shape.delimiter,
            numbers: form.map_or(Decimal::Point.into(), |(form, _)| form),
        },
        shape,
        own_numbers: Vec::new(),
        stated: None,
    };
    let shape = &layout.shape;
    let table = table::read(lines, &layout, shape.data_at..lines.len(), |_| false);
    if table.cells.rows() < 2 {
        return None;
    }
    let header_line = shape.names_at.map_or(0, |at| lines[at].number);
    Some(Guess {
        dialect: Some(layout.dialect),
        encoding: None,
        sheet: None,
        header_line,
        names_line: None,
        lines_after_header: lines[shape.data_at].number - header_line - 1,
        is_number: (0..width)
            .map(|column| table.kind(column) == Kind::Number)
            .collect(),
        names: shape.names.clone(),
        units: shape.units.clone(),
        time: time(&table),
        start: None,
    })
}

fn time(table: &Table<'_>) -> Option<TimeGuess> {
    let Shape { names, units, .. } = &table.layout.shape;
    let of_kind = |kind: Kind| (0..names.len()).filter(move |at| table.kind(*at) == kind);
    let mut candidates: Vec<usize> = of_kind(Kind::Number)
        .filter(|at| names_time(&names[*at]))
        .collect();
    // A letter such as T may be a temperature as well: words go before it.
    candidates.sort_by_key(|&at| names[at].chars().count() == 1);
    // Numbers that rise come first: a clock beside them is the same time again, with fewer digits.
    for &index in &candidates {
        let numbers = table.cells.columns[index].numbers.iter().copied();
        let found: Vec<f64> = numbers.filter(|number| number.is_finite()).collect();
        if found.len() < 2 || found.windows(2).any(|pair| pair[1] < pair[0]) {
            continue;
        }
        let unit = units.get(index).filter(|unit| !unit.is_empty());
        return Some(match found[0] {
            first if (1e9..1e11).contains(&first) => TimeGuess::Epoch { index, unit: "s" },
            first if (1e12..1e14).contains(&first) => TimeGuess::Epoch { index, unit: "ms" },
            _ => {
                let parsed = Header::parse(&names[index]).raw_unit;
                let alone = (parsed.is_empty()).then(|| names[index].trim().to_owned());
                let stated = unit.cloned().or(alone).or(Some(parsed));
                let unit = stated.filter(|unit| ieap_domain::unit::conversion(Quantity::Time, unit).is_ok());
                TimeGuess::Elapsed { index, unit }
            }
        });
    }
    let orders = |texts: &mut dyn Iterator<Item = String>| {
        let mut left: Vec<DateOrder> = DateOrder::ALL.to_vec();
        for text in texts.filter(|text| kind::is_moment(text)) {
            let own = order::orders(&text);
            left.retain(|order| own.contains(order));
        }
        left.into_iter()
            .map(DateOrder::key)
            .collect::<Vec<&'static str>>()
    };
    if let Some(index) = of_kind(Kind::Moment).next() {
        let orders = orders(&mut table.texts_of(index).into_iter().map(str::to_owned));
        return Some(TimeGuess::Clock {
            index,
            date: None,
            orders,
        });
    }
    let clock = of_kind(Kind::Clock).next();
    if let (Some(date), Some(index)) = (of_kind(Kind::Date).next(), clock) {
        let rows = table.texts_of(date).into_iter().zip(table.texts_of(index));
        let orders = orders(&mut rows.map(|(date, clock)| format!("{date} {clock}")));
        return Some(TimeGuess::Clock {
            index,
            date: Some(date),
            orders,
        });
    }
    clock.map(|index| TimeGuess::TimeOfDay { index })
}
