//! What the rows of a file show of its layout: separator, decimal sign, where names and readings stand, what the time
//! is.

use crate::formats::sheet_cells::{Sheet, SheetCell};
use crate::formats::stamp::{self, DateOrder};
use crate::profiles::policy::ROWS_ASKED;
use crate::text::grid::{Dialect, is_blank_or_comment};
use crate::text::header::Header;
use crate::text::unit_row::unit_row;
use crate::text::{Cell, Decimal, Delimiter, Line, Lines, decode, number};
use ieap_domain::Quantity;

/// What was seen.
pub(super) struct Guess {
    /// Separator and decimal sign; none for a workbook.
    pub dialect: Option<Dialect>,
    pub encoding: Option<&'static str>,
    /// The workbook's sheet.
    pub sheet: Option<String>,
    /// Line of the names, from 1; 0 where there are none.
    pub header_line: usize,
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

/// What a line begins with that says when a run began, in small letters, the longer first.
const STARTS: [&str; 14] = [
    "startzeitpunkt",
    "startzeit",
    "start time",
    "start date",
    "start_time",
    "started at",
    "started",
    "start",
    "messbeginn",
    "beginn",
    "begin",
    "date and time",
    "datum",
    "date",
];

/// The first line that begins so and goes on with a date and a time.
fn start_line(lines: &[Line<'_>]) -> Option<StartGuess> {
    lines.iter().find_map(|line| {
        let text = line.text.trim_start_matches(['"', '#', ' ']);
        let lower = text.to_lowercase();
        let word = STARTS.into_iter().find(|word| lower.starts_with(word))?;
        let is_mark = |c: char| c.is_whitespace() || "\";,:=".contains(c);
        let rest = text.get(word.len()..)?;
        let date = rest.trim_matches(is_mark);
        let reads = |order: &DateOrder| stamp::civil(date, *order).is_some();
        let mut orders: Vec<DateOrder> = DateOrder::ALL.into_iter().filter(reads).collect();
        // So are dates with dots written.
        if date.contains('.') && orders.contains(&DateOrder::DayFirst) {
            orders = vec![DateOrder::DayFirst];
        }
        let end = text.len() - rest.trim_start_matches(is_mark).len();
        let begins = line.text.trim_start_matches('"').strip_suffix(&text[end..])?;
        (!orders.is_empty()).then(|| StartGuess {
            begins: begins.trim_end_matches(['"', ' ', '\t']).to_owned(),
            orders: orders.into_iter().map(DateOrder::key).collect(),
        })
    })
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

/// Rows of cells as texts, with the line of each.
struct Grid {
    lines: Vec<usize>,
    rows: Vec<Vec<String>>,
    decimal: Decimal,
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

/// The layout of a delimited text from that line on; none where no separator makes a table of numbers.
pub(super) fn guess_text(bytes: &[u8], from_line: usize) -> Option<Guess> {
    let decoded = decode(bytes);
    if decoded.text.contains('\0') {
        return None;
    }
    let lines = Lines::new(&decoded.text).skip(from_line.saturating_sub(1));
    let mut lines: Vec<Line<'_>> = lines.take(ROWS_ASKED).collect();
    lines.pop_if(|line| !line.ended);
    let lines: Vec<Line<'_>> = lines
        .into_iter()
        .filter(|l| !is_blank_or_comment(l.text))
        .collect();
    let mut best: Option<(usize, Guess)> = None;
    for delimiter in Delimiter::ALL {
        for decimal in [Decimal::Point, Decimal::Comma] {
            let grid = grid(&lines, delimiter, decimal);
            if let Some((numbers, mut guess)) = judge(&grid)
                && best.as_ref().is_none_or(|(most, _)| numbers > *most)
            {
                guess.dialect = Some(Dialect { delimiter, decimal });
                guess.encoding = Some(decoded.encoding);
                best = Some((numbers, guess));
            }
        }
    }
    best.map(|(_, mut guess)| {
        let head: Vec<Line<'_>> = Lines::new(&decoded.text)
            .take(guess.header_line.saturating_sub(1))
            .collect();
        guess.start = start_line(&head);
        guess
    })
}

/// The layout of the first sheet with a table of numbers.
pub(super) fn guess_sheet(sheets: &[Sheet]) -> Option<Guess> {
    for sheet in sheets {
        let width = sheet.rows.iter().filter_map(|row| row.cells.last());
        let width = width.map(|(column, _)| *column as usize + 1).max().unwrap_or(0);
        let text = |cell: &SheetCell| match cell {
            SheetCell::Number(number) => number.to_string(),
            SheetCell::Text(text) | SheetCell::Date(text) | SheetCell::Error(text) => text.clone(),
        };
        let sample = &sheet.rows[..sheet.rows.len().min(ROWS_ASKED)];
        let row = |row: &crate::formats::sheet_cells::SheetRow| {
            let mut cells = vec![String::new(); width];
            for (column, cell) in &row.cells {
                cells[*column as usize] = text(cell);
            }
            cells
        };
        let grid = Grid {
            lines: sample.iter().map(|row| row.number as usize).collect(),
            rows: sample.iter().map(row).collect(),
            decimal: Decimal::Point,
        };
        if let Some((_, mut guess)) = judge(&grid) {
            guess.sheet = Some(sheet.name.clone());
            return Some(guess);
        }
    }
    None
}

fn grid(lines: &[Line<'_>], delimiter: Delimiter, decimal: Decimal) -> Grid {
    let row = |line: &Line<'_>| {
        let mut cells = Vec::new();
        delimiter.split(line.text, |_, cell| {
            cells.push(number::unquote(cell).to_owned());
        });
        cells
    };
    let mut rows: Vec<Vec<String>> = lines.iter().map(row).collect();
    // Separators at the end of every line begin no column; a column that is read less often than the others is one.
    let filled = |row: &Vec<String>| {
        row.iter()
            .rposition(|cell| !cell.is_empty())
            .map_or(0, |last| last + 1)
    };
    let width = rows.iter().map(filled).max().unwrap_or(0);
    rows.iter_mut().for_each(|row| row.truncate(width));
    Grid {
        lines: lines.iter().map(|line| line.number).collect(),
        rows,
        decimal,
    }
}

/// What the rows come to, and how many cells of them are numbers.
fn judge(grid: &Grid) -> Option<(usize, Guess)> {
    let is_number = |cell: &String| matches!(number::parse(cell, grid.decimal), Cell::Number(_));
    let width = most_common(grid.rows.iter().map(Vec::len).filter(|width| *width >= 2))?;
    let is_row = |row: &Vec<String>| row.len() <= width && row.len() >= 2 && row.iter().any(is_number);
    // The table ends at the file's end and begins where its rows begin to look alike.
    let data_at = (0..grid.rows.len()).find(|&at| {
        let alike = grid.rows[at..]
            .iter()
            .filter(|row| is_row(row) && row.len() == width);
        let first = &grid.rows[at];
        is_row(first)
            && first.len() == width
            && 10 * alike.count() >= 9 * (grid.rows.len() - at)
            && shapes_agree(grid, at)
    })?;
    let rows = &grid.rows[data_at..];
    if rows.len() < 2 {
        return None;
    }
    let numbers_of = |column: usize| {
        rows.iter()
            .filter(|row| row.get(column).is_some_and(is_number))
            .count()
    };
    let counts: Vec<usize> = (0..width).map(numbers_of).collect();
    let filled_of = |column: usize| {
        let filled = |row: &&Vec<String>| row.get(column).is_some_and(|cell| !cell.is_empty());
        rows.iter().filter(filled).count()
    };
    let holds_numbers = |(column, count): (usize, &usize)| *count > 0 && 10 * count >= 9 * filled_of(column);
    let columns_of_numbers: Vec<bool> = counts.iter().enumerate().map(holds_numbers).collect();
    let (header_at, units) = names_before(grid, data_at, width);
    let mut names = header_at.map_or(Vec::new(), |at| grid.rows[at].clone());
    names.resize(width, String::new());
    let time = time(grid.decimal, &names, &units, rows);
    let guess = Guess {
        dialect: None,
        encoding: None,
        sheet: None,
        header_line: header_at.map_or(0, |at| grid.lines[at]),
        lines_after_header: match header_at {
            Some(at) => grid.lines[data_at] - grid.lines[at] - 1,
            None => grid.lines[data_at] - 1,
        },
        names,
        units,
        is_number: columns_of_numbers,
        time,
        start: None,
    };
    Some((counts.iter().sum(), guess))
}

/// Whether the row at `at` holds numbers where nearly all rows below it do, and words where nearly all do.
fn shapes_agree(grid: &Grid, at: usize) -> bool {
    let is_number = |cell: &String| matches!(number::parse(cell, grid.decimal), Cell::Number(_));
    let below = &grid.rows[at + 1..];
    grid.rows[at].iter().enumerate().all(|(column, cell)| {
        let filled = below
            .iter()
            .filter_map(|row| row.get(column))
            .filter(|c| !c.is_empty());
        let (all, numbers) = filled.fold((0usize, 0usize), |(all, numbers), cell| {
            (all + 1, numbers + usize::from(is_number(cell)))
        });
        let of_numbers = 10 * numbers >= 9 * all;
        let of_words = 10 * numbers <= all;
        all == 0 || cell.is_empty() || (is_number(cell) && !of_words) || (!is_number(cell) && !of_numbers)
    })
}

fn most_common(widths: impl Iterator<Item = usize>) -> Option<usize> {
    let mut counts = std::collections::BTreeMap::new();
    widths.for_each(|width| *counts.entry(width).or_insert(0usize) += 1);
    counts
        .into_iter()
        .max_by_key(|(width, count)| (*count, *width))
        .map(|(width, _)| width)
}

/// Index of the row of names above the readings, and the units where they stand in a row of their own.
fn names_before(grid: &Grid, data_at: usize, width: usize) -> (Option<usize>, Vec<String>) {
    let is_number = |cell: &String| matches!(number::parse(cell, grid.decimal), Cell::Number(_));
    let of_words = |at: usize| {
        let row = &grid.rows[at];
        (2..=width).contains(&row.len()) && !row.iter().any(is_number)
    };
    let filled = |at: usize| grid.rows[at].iter().filter(|cell| !cell.is_empty()).count();
    let Some(last) = data_at.checked_sub(1) else {
        return (None, Vec::new());
    };
    let units = last
        .checked_sub(1)
        .filter(|&above| of_words(above) && filled(above) >= 2)
        .and_then(|above| {
            let cells = grid.rows[last].iter().map(String::as_str);
            Some((above, unit_row(grid.rows[above].len(), cells)?))
        });
    match units {
        Some((above, units)) => (Some(above), units),
        None => (of_words(last).then_some(last), Vec::new()),
    }
}

/// Whether a column is headed by a unit of time alone: `s`, `min`. A letter in upper case stands for something else.
fn is_unit_of_time(name: &str) -> bool {
    matches!(name.trim(), "s" | "ms" | "us" | "min" | "h")
}

fn time(decimal: Decimal, names: &[String], units: &[String], rows: &[Vec<String>]) -> Option<TimeGuess> {
    const WORDS: [&str; 9] = [
        "time",
        "zeit",
        "date",
        "datum",
        "timestamp",
        "uts",
        "epoch",
        "aeg",
        "elapsed",
    ];
    let speaks = |name: &str| {
        let lower = name.to_lowercase();
        let known = Header::parse(name).meaning.named_quantity() == Some(Quantity::Time);
        known || is_unit_of_time(name) || WORDS.iter().any(|word| lower.contains(word))
    };
    let mut candidates: Vec<usize> = (0..names.len()).filter(|&at| speaks(&names[at])).collect();
    // A letter such as T may be a temperature as well: words go before it.
    candidates.sort_by_key(|&at| names[at].chars().count() == 1);
    let cells = |at: usize| {
        rows.iter()
            .filter_map(move |row| row.get(at))
            .filter(|c| !c.is_empty())
    };
    let numbers = |at: usize| -> Option<Vec<f64>> {
        cells(at)
            .map(|cell| match number::parse(cell, decimal) {
                Cell::Number(number) => Some(number),
                _ => None,
            })
            .collect()
    };
    let rising = |numbers: &[f64]| numbers.windows(2).all(|pair| pair[1] >= pair[0]);
    // Numbers that rise come first: a clock beside them is the same time again, with fewer digits.
    for &index in &candidates {
        let Some(found) = numbers(index).filter(|found| found.len() >= 2 && rising(found)) else {
            continue;
        };
        let epoch_unit = match found[0] {
            first if (1e9..1e11).contains(&first) => Some("s"),
            first if (1e12..1e14).contains(&first) => Some("ms"),
            _ => None,
        };
        let unit = units.get(index).filter(|unit| !unit.is_empty());
        return Some(match epoch_unit {
            Some(unit) => TimeGuess::Epoch { index, unit },
            None => {
                let parsed = if is_unit_of_time(&names[index]) {
                    names[index].clone()
                } else {
                    Header::parse(&names[index]).raw_unit
                };
                let stated = unit.cloned().or((!parsed.is_empty()).then_some(parsed));
                let unit = stated.filter(|unit| ieap_domain::unit::conversion(Quantity::Time, unit).is_ok());
                TimeGuess::Elapsed { index, unit }
            }
        });
    }
    let reads = |at: usize, date: Option<usize>, order: DateOrder| {
        let mut any = false;
        let all = rows.iter().all(|row| {
            let cell = |at: usize| row.get(at).map(String::as_str).unwrap_or("");
            let text = match date {
                Some(date) => format!("{} {}", cell(date), cell(at)),
                None => cell(at).to_owned(),
            };
            any = true;
            text.starts_with("date ") && date.is_none() || stamp::civil(&text, order).is_some()
        });
        any && all
    };
    for &index in &candidates {
        for date in std::iter::once(None).chain(candidates.iter().copied().filter(|d| *d != index).map(Some))
        {
            let orders: Vec<&'static str> = DateOrder::ALL
                .into_iter()
                .filter(|order| reads(index, date, *order))
                .map(DateOrder::key)
                .collect();
            if !orders.is_empty() {
                // Dates of a workbook are numbers, which have no order.
                let of_workbook = cells(index).all(|cell| cell.starts_with("date "));
                let orders = if of_workbook { vec!["year-first"] } else { orders };
                return Some(TimeGuess::Clock { index, date, orders });
            }
        }
    }
    let is_time_of_day = |at: usize| {
        let mut found =
            cells(at).map(|cell| stamp::civil(&format!("2000-01-01 {cell}"), DateOrder::YearFirst));
        cells(at).count() >= 2 && found.all(|moment| moment.is_some())
    };
    candidates
        .into_iter()
        .find(|&index| is_time_of_day(index))
        .map(|index| TimeGuess::TimeOfDay { index })
}
