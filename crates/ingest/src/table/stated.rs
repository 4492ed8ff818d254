//! What a profile states of a table, for the reader of tables: it takes the place of what that would find by itself.

use encoding_rs::Encoding;
use jiff::tz::TimeZone;

use super::kind::Kind;
use super::shape::Shape;
use super::sheet;
use crate::Timestamp;
use crate::formats::cells::CellTable;
use crate::formats::error::{ReadError, quoted};
use crate::formats::sheet_cells::Sheet;
use crate::formats::stamp::DateOrder;
use crate::text::grid::Dialect;
use crate::text::header::{Header, Meaning};
use crate::text::{Decimal, Decoded, Delimiter, Line, decode, number};
use ieap_domain::Quantity;
use ieap_domain::unit::Conversion;

/// What is stated of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Stated {
    /// What holds it.
    pub container: Container,
    /// Where the names of its columns stand.
    pub header: HeaderPlace,
    /// Lines between the names and the first row of readings.
    pub lines_after_header: usize,
    /// What times the rows.
    pub time: TimeBase,
    /// Whether time zero is the voltage step.
    pub zero_is_step: bool,
    /// The line that states a date.
    pub start: Option<StartLine>,
    /// The columns with a meaning.
    pub columns: Vec<Column>,
}

/// What holds a table.
#[derive(Debug, Clone, PartialEq)]
pub enum Container {
    /// A delimited text.
    Text {
        /// Encoding; none where it is found.
        encoding: Option<&'static Encoding>,
        /// Delimiter and decimal sign.
        dialect: Dialect,
        /// What comment lines begin with; empty where there are none.
        comment: String,
    },
    /// A sheet of a workbook.
    Sheet {
        /// Its name; none takes the first that fits.
        name: Option<String>,
    },
}

/// Where the names of the columns stand.
#[derive(Debug, Clone, PartialEq)]
pub enum HeaderPlace {
    /// On that line (or row of a sheet), from 1.
    Line(usize),
    /// On the first line that holds the text.
    Contains(String),
    /// Nowhere: columns go by number.
    None,
}

/// A column by its name or its number.
#[derive(Debug, Clone, PartialEq)]
pub enum ColumnRef {
    /// The text of the header's cell.
    Name(String),
    /// From 0.
    Index(usize),
}

/// What times the rows.
#[derive(Debug, Clone, PartialEq)]
pub enum TimeBase {
    /// Numbers in a unit.
    Counted {
        /// Their column.
        column: ColumnRef,
        /// The unit as it is written.
        unit: String,
        /// To seconds.
        conversion: Conversion,
        /// Whether they count from 1970, in UTC; else from any moment.
        since_1970: bool,
    },
    /// Dates with times of day.
    Clock {
        /// Their column, or that of the times of day and that of the days.
        columns: Vec<ColumnRef>,
        /// Order of day, month and year.
        order: DateOrder,
        /// Where the clock stood; none where the campaign says it.
        zone: Option<TimeZone>,
    },
    /// Times of day without a date; midnight may pass.
    TimeOfDay {
        /// Their column.
        column: ColumnRef,
    },
    /// Nothing: rows follow each other after this many seconds.
    Interval {
        /// From row to row, s.
        interval_s: f64,
    },
}

/// The line before the table that states a date.
#[derive(Debug, Clone, PartialEq)]
pub struct StartLine {
    /// What it begins with.
    pub begins: String,
    /// Order of day, month and year.
    pub order: DateOrder,
    /// The moment that it means.
    pub kind: Timestamp,
}

/// A column with a meaning.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Which it is.
    pub column: ColumnRef,
    /// What it measures.
    pub quantity: Quantity,
    /// Its unit as it is written.
    pub unit: String,
    /// From that unit.
    pub conversion: Conversion,
    /// What readings are multiplied by before their unit converts, such as the sensitivity of a sensor.
    pub factor: Option<f64>,
    /// Where along the strip, mm from the clamp.
    pub position_mm: Option<f64>,
}

/// What a layout holds of a table that was stated.
#[derive(Debug, Clone, PartialEq)]
pub struct AsStated {
    /// What each column means.
    pub headers: Vec<Header>,
    /// The columns that time the rows.
    pub times: Vec<usize>,
    factors: Vec<(usize, f64)>,
    comment: String,
}

impl AsStated {
    /// Whether a line holds no reading: blank, or a comment.
    pub fn is_no_reading(&self, text: &str) -> bool {
        let is_comment = !self.comment.is_empty() && text.trim_start().starts_with(&self.comment);
        text.trim().is_empty() || is_comment
    }

    /// Multiplies the readings of columns that have a factor.
    pub fn scale(&self, cells: &mut CellTable) {
        for (column, factor) in &self.factors {
            let numbers = cells.columns[*column].numbers.iter_mut();
            numbers.for_each(|number| *number *= factor);
        }
    }
}

impl ColumnRef {
    /// As messages show it.
    pub fn shown(&self) -> String {
        match self {
            ColumnRef::Name(name) => format!("column {}", quoted(name)),
            ColumnRef::Index(index) => format!("column {}", index + 1),
        }
    }

    /// Its place among names.
    fn place(&self, names: &[String]) -> Result<usize, String> {
        let name = match self {
            ColumnRef::Name(name) => name,
            ColumnRef::Index(index) if *index < names.len() => return Ok(*index),
            ColumnRef::Index(_) => return Err(format!("no {}; there are {}", self.shown(), names.len())),
        };
        let mut places = (0..names.len()).filter(|at| names[*at] == *name);
        match (places.next(), places.next()) {
            (Some(place), None) => Ok(place),
            (None, _) => Err(format!(
                "no {}; there are {}",
                self.shown(),
                quoted(&names.join(", "))
            )),
            _ => Err(format!("{} stands twice: give its number", self.shown())),
        }
    }
}

impl TimeBase {
    /// The columns that time is read from.
    pub fn columns(&self) -> &[ColumnRef] {
        match self {
            TimeBase::Counted { column, .. } | TimeBase::TimeOfDay { column } => std::slice::from_ref(column),
            TimeBase::Clock { columns, .. } => columns,
            TimeBase::Interval { .. } => &[],
        }
    }

    /// What these columns hold.
    fn kinds(&self) -> &[Kind] {
        match self {
            TimeBase::Counted { .. } => &[Kind::Number],
            TimeBase::Clock { columns, .. } if columns.len() == 1 => &[Kind::Moment],
            TimeBase::Clock { .. } => &[Kind::Clock, Kind::Date],
            TimeBase::TimeOfDay { .. } => &[Kind::Clock],
            TimeBase::Interval { .. } => &[],
        }
    }
}

impl Stated {
    /// Whether a sheet of a workbook holds it.
    pub fn is_sheet(&self) -> bool {
        matches!(self.container, Container::Sheet { .. })
    }

    /// The text of a file, in the encoding that is stated or found.
    pub fn decoded<'b>(&self, bytes: &'b [u8]) -> Decoded<'b> {
        let Container::Text {
            encoding: Some(encoding),
            ..
        } = &self.container
        else {
            return decode(bytes);
        };
        let (text, used, has_replacements) = encoding.decode(bytes);
        Decoded {
            text,
            encoding: used.name(),
            has_replacements,
        }
    }

    /// How lines of a text or a sheet are read.
    ///
    /// # Errors
    /// The names are not there (yet), or a column that is stated is not among them.
    pub fn place(&self, lines: &[Line<'_>]) -> Result<(Dialect, Shape, AsStated), ReadError> {
        let (dialect, comment) = match &self.container {
            Container::Text { dialect, comment, .. } => (*dialect, comment.clone()),
            Container::Sheet { .. } => (Dialect::new(Delimiter::Tab, Decimal::Point), String::new()),
        };
        let waits = |found| ReadError::header_only(lines.len(), found);
        let names_at = match &self.header {
            HeaderPlace::None => None,
            HeaderPlace::Line(number) => {
                let at = lines.iter().position(|line| line.number == *number);
                Some(at.ok_or_else(|| waits("the line of the names is not there yet"))?)
            }
            HeaderPlace::Contains(text) => {
                let at = lines.iter().position(|line| line.text.contains(text.as_str()));
                Some(at.ok_or_else(|| waits("no line holds the text that marks the names"))?)
            }
        };
        let above = names_at.map_or(0, |at| lines[at].number) + self.lines_after_header;
        let data_at = lines.iter().position(|line| line.number > above);
        let data_at = data_at.unwrap_or(lines.len());
        let names = match names_at {
            Some(at) => self.names(lines[at].text, dialect.delimiter),
            None => {
                let first = lines[data_at..].iter().find(|line| !line.text.trim().is_empty());
                let first = first.ok_or_else(|| waits("no row"))?;
                vec![String::new(); dialect.delimiter.split(first.text, |_, _| {})]
            }
        };
        let (times, places) = self.places(&names).map_err(|reason| ReadError::Column {
            line: 0,
            index: 0,
            column: "of the profile".to_owned(),
            reason,
        })?;
        let mut kinds = vec![Kind::Number; names.len()];
        (times.iter().zip(self.time.kinds())).for_each(|(place, kind)| kinds[*place] = *kind);
        let factors = self.columns.iter().zip(&places);
        let stated = AsStated {
            headers: self.headers(&names, &times, &places),
            factors: factors
                .filter_map(|(column, place)| Some((*place, column.factor?)))
                .collect(),
            comment,
            times,
        };
        let shape = Shape {
            delimiter: dialect.delimiter,
            names_at,
            data_at,
            known: names.len(),
            names,
            units: Vec::new(),
            kinds,
            ends_early: false,
        };
        Ok((dialect, shape, stated))
    }

    fn names(&self, line: &str, delimiter: Delimiter) -> Vec<String> {
        let cells = delimiter.header_cells(line);
        let mut names: Vec<String> = cells
            .iter()
            .map(|cell| number::unquote(cell).to_owned())
            .collect();
        // All rows of a sheet have the same number of cells.
        while !self.is_sheet() && names.last().is_some_and(String::is_empty) {
            names.pop();
        }
        names
    }

    /// Places of the columns of the time, and of the others that are stated.
    fn places(&self, names: &[String]) -> Result<(Vec<usize>, Vec<usize>), String> {
        let place = |column: &ColumnRef| match column {
            // As cells of a sheet are written out.
            ColumnRef::Name(name) if self.is_sheet() => ColumnRef::Name(sheet::plain(name)).place(names),
            _ => column.place(names),
        };
        let times = self.time.columns().iter().map(place).collect::<Result<_, _>>()?;
        let columns = self.columns.iter().map(|column| place(&column.column));
        Ok((times, columns.collect::<Result<_, _>>()?))
    }

    /// What every column means: what is stated of it, or nothing.
    fn headers(&self, names: &[String], times: &[usize], places: &[usize]) -> Vec<Header> {
        let named = |(index, name): (usize, &String)| match name.as_str() {
            "" => Header::other(&format!("column {}", index + 1)),
            name => Header::other(name),
        };
        let mut headers: Vec<Header> = names.iter().enumerate().map(named).collect();
        let mut mean = |place: usize, unit: &str, quantity, conversion| {
            headers[place].raw_unit = unit.to_owned();
            headers[place].meaning = Meaning::Known { quantity, conversion };
        };
        if let TimeBase::Counted { unit, conversion, .. } = &self.time {
            mean(times[0], unit, Quantity::Time, *conversion);
        }
        for (column, place) in self.columns.iter().zip(places) {
            mean(*place, &column.unit, column.quantity, column.conversion);
        }
        for (column, place) in self.columns.iter().zip(places) {
            headers[*place].position_mm = column.position_mm;
        }
        headers
    }

    /// The sheet that is stated, or the first that has all columns, as texts.
    ///
    /// # Errors
    /// There is none.
    pub fn sheet<'s>(&self, sheets: &'s [Sheet]) -> Result<(&'s Sheet, Vec<String>), ReadError> {
        let name = match &self.container {
            Container::Sheet { name } => name.as_ref(),
            Container::Text { .. } => None,
        };
        let mut refusal = ReadError::NoHeader {
            line: 0,
            found: name.map_or("no sheet".to_owned(), |name| format!("no sheet {}", quoted(name))),
        };
        for sheet in sheets
            .iter()
            .filter(|sheet| name.is_none_or(|name| sheet.name == *name))
        {
            let last = sheet
                .rows
                .iter()
                .filter_map(|row| row.cells.last())
                .map(|(at, _)| *at);
            let texts = sheet::texts(sheet, last.max().map_or(0, |last| last as usize + 1));
            match self.place(&sheet::lines(sheet, &texts)) {
                Ok(_) => return Ok((sheet, texts)),
                Err(error) => refusal = error,
            }
        }
        Err(refusal)
    }
}
