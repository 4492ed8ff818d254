//! Columns over rows of a kind: the table that they make is written in every medium.

use ieap_domain::Estimate;

use crate::frame::{Frame, Kind, OfKind};
use crate::quantities::Quantity;
use crate::table::{Cell, Column, Content, Measured, Notes, Row, Source, Table};

/// Digits that a number without uncertainty is told by.
const ROUGH_DIGITS: i32 = 3;

/// What stands in a cell, in the unit that it is stored in. Digits, shown units and notation are the writers' work.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Words.
    Text(String),
    /// A setting.
    Exact(f64),
    /// A whole number.
    Count(i64),
    /// Yes or no.
    Flag(bool),
    /// A number without uncertainty, with its digits.
    Rough(f64, i32),
    /// A coefficient of determination.
    Score(f64),
    /// A number with its uncertainty, a bound, or why there is neither.
    Estimate(Estimate),
    /// What several sources say together.
    Combined(Combined),
    /// Nothing.
    Missing,
    /// The same with footnotes.
    Noted(Box<Value>, Vec<String>),
    /// What files have, and what people read in its place.
    Printed(Box<Value>, Box<Value>),
}

/// What several sources say together, such as a mean over repeats, with sources of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct Combined {
    /// What stands in the cell.
    pub content: Content,
    /// Its footnotes.
    pub notes: Vec<String>,
    /// What it is made from.
    pub sources: Vec<Source>,
}

impl Value {
    /// The same with footnotes.
    pub fn noted(self, notes: impl IntoIterator<Item = String>) -> Value {
        Value::Noted(Box::new(self), notes.into_iter().collect())
    }
}

impl From<Combined> for Value {
    fn from(combined: Combined) -> Value {
        Value::Combined(combined)
    }
}

/// A number without uncertainty, with its digits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rough(pub f64, pub i32);

/// What files have, and what people read in its place: words for a key, fewer digits, a footnote.
#[derive(Debug, Clone, PartialEq)]
pub struct Printed<V>(pub V, pub Value);

impl<V: Into<Value>> From<Printed<V>> for Value {
    fn from(Printed(stored, read): Printed<V>) -> Value {
        Value::Printed(Box::new(stored.into()), Box::new(read))
    }
}

/// A number that carries no uncertainty and is no setting: three digits.
pub fn rough(number: impl Into<Option<f64>>) -> Value {
    let number = number.into();
    number.map_or(Value::Missing, |number| Value::Rough(number, ROUGH_DIGITS))
}

impl From<&str> for Value {
    fn from(words: &str) -> Value {
        Value::Text(words.to_owned())
    }
}

impl From<String> for Value {
    fn from(words: String) -> Value {
        Value::Text(words)
    }
}

impl From<f64> for Value {
    fn from(setting: f64) -> Value {
        Value::Exact(setting)
    }
}

impl From<usize> for Value {
    fn from(count: usize) -> Value {
        Value::Count(count as i64)
    }
}

impl From<u32> for Value {
    fn from(count: u32) -> Value {
        Value::Count(count.into())
    }
}

impl From<i64> for Value {
    fn from(count: i64) -> Value {
        Value::Count(count)
    }
}

impl From<bool> for Value {
    fn from(flag: bool) -> Value {
        Value::Flag(flag)
    }
}

impl From<Rough> for Value {
    fn from(Rough(number, digits): Rough) -> Value {
        Value::Rough(number, digits)
    }
}

impl From<Estimate> for Value {
    fn from(estimate: Estimate) -> Value {
        Value::Estimate(estimate)
    }
}

impl From<&Estimate> for Value {
    fn from(estimate: &Estimate) -> Value {
        Value::Estimate(estimate.clone())
    }
}

impl<T: Into<Value>> From<Option<T>> for Value {
    fn from(of: Option<T>) -> Value {
        of.map_or(Value::Missing, Into::into)
    }
}

/// What is read off a row.
type Of<'s, R, T> = Box<dyn Fn(&R) -> T + 's>;

/// A column: its head, and what is read off a row.
pub(crate) struct SheetColumn<'s, R> {
    pub(crate) head: Column,
    pub(crate) kind: Kind,
    pub(crate) of: Of<'s, R, Value>,
    /// Whether people see it where nobody chooses columns.
    printed: bool,
}

/// What a sheet with columns for files is made into: a table as people see it, or the frame of all columns. Who asks for one
/// does not pay for the other.
pub trait Made: Sized {
    /// That of these rows.
    fn of<R>(sheet: &Sheet<R>, rows: &[R]) -> Self;
}

impl Made for Table {
    fn of<R>(sheet: &Sheet<R>, rows: &[R]) -> Table {
        sheet.table_of(rows)
    }
}

impl Made for Frame {
    fn of<R>(sheet: &Sheet<R>, rows: &[R]) -> Frame {
        sheet.frame_of(rows)
    }
}

/// Columns over rows of a kind.
pub struct Sheet<'s, R> {
    name: &'static str,
    title: &'static str,
    said: Vec<String>,
    remark: String,
    empty: String,
    stub: usize,
    pub(crate) columns: Vec<SheetColumn<'s, R>>,
    source: Of<'s, R, Vec<Source>>,
    label: Option<Of<'s, R, String>>,
}

impl<'s, R> Sheet<'s, R> {
    /// A sheet of which the first `stub` columns say what a row is about; `title` is one sentence without a full stop.
    pub fn new(name: &'static str, title: &'static str, stub: usize) -> Sheet<'s, R> {
        Sheet {
            name,
            title,
            said: Vec::new(),
            remark: String::new(),
            empty: String::new(),
            stub,
            columns: Vec::new(),
            source: Box::new(|_| Vec::new()),
            label: None,
        }
    }

    /// What holds for all of it, and what is said in its place where there is no row.
    pub fn remarks(self, remark: impl Into<String>, empty: impl Into<String>) -> Sheet<'s, R> {
        Sheet {
            remark: remark.into(),
            empty: empty.into(),
            ..self
        }
    }

    /// What is said of it before that, whether there are rows or not.
    pub fn said(mut self, sentences: impl IntoIterator<Item = String>) -> Sheet<'s, R> {
        self.said.extend(sentences);
        self
    }

    /// What a row is called, where that is not the words of its first cells.
    pub fn called(self, label: impl Fn(&R) -> String + 's) -> Sheet<'s, R> {
        Sheet {
            label: Some(Box::new(label)),
            ..self
        }
    }

    /// What a row is made from.
    pub fn made_from(self, source: impl Fn(&R) -> Vec<Source> + 's) -> Sheet<'s, R> {
        Sheet {
            source: Box::new(source),
            ..self
        }
    }

    /// A column.
    pub fn column<V: OfKind>(mut self, quantity: Quantity, of: impl Fn(&R) -> V + 's) -> Sheet<'s, R> {
        self.columns.push(SheetColumn {
            head: quantity.of_column(),
            kind: V::KIND,
            of: Box::new(move |row| of(row).into()),
            printed: true,
        });
        self
    }

    /// A column whose head is known only when the table is made.
    pub fn column_under<V: OfKind>(mut self, head: Column, of: impl Fn(&R) -> V + 's) -> Sheet<'s, R> {
        self.columns.push(SheetColumn {
            head,
            kind: V::KIND,
            of: Box::new(move |row| of(row).into()),
            printed: true,
        });
        self
    }

    /// A column that its key heads: of a table for programs, or of one that stands on a page alone.
    pub fn plain<V: OfKind>(self, key: &str, of: impl Fn(&R) -> V + 's) -> Sheet<'s, R> {
        self.column_under(Column::plain(key, key, ""), of)
    }

    /// The same with columns that files alone have.
    pub fn in_files(self, add: impl FnOnce(Sheet<'s, R>) -> Sheet<'s, R>) -> Sheet<'s, R> {
        let before = self.columns.len();
        add(self).printing_first(before)
    }

    /// The same, of which only that many of the first columns are printed.
    pub fn printing_first(mut self, columns: usize) -> Sheet<'s, R> {
        for column in self.columns.iter_mut().skip(columns) {
            column.printed = false;
        }
        self
    }

    /// A column for each of these.
    pub fn columns<V: OfKind>(
        self,
        quantities: &[Quantity],
        of: impl Fn(&R, &Quantity) -> V + Copy + 's,
    ) -> Sheet<'s, R> {
        quantities.iter().fold(self, |sheet, &quantity| {
            sheet.column(quantity, move |row| of(row, &quantity))
        })
    }

    /// A column for each of these, of which a row knows the numbers by their place.
    pub fn columns_by_place<V: OfKind>(
        self,
        quantities: &[Quantity],
        of: impl Fn(&R, usize) -> V + Copy + 's,
    ) -> Sheet<'s, R> {
        let places = quantities.iter().enumerate();
        places.fold(self, |sheet, (at, &quantity)| {
            sheet.column(quantity, move |row| of(row, at))
        })
    }

    /// The table of these rows.
    pub fn over(&self, rows: impl IntoIterator<Item = R>) -> Table {
        self.table_of(&rows.into_iter().collect::<Vec<R>>())
    }

    /// The table of these rows, or the frame of all columns: what is asked for.
    pub fn made<M: Made>(&self, rows: impl IntoIterator<Item = R>) -> M {
        M::of(self, &rows.into_iter().collect::<Vec<R>>())
    }

    fn printed(&self) -> impl Iterator<Item = &SheetColumn<'s, R>> {
        self.columns.iter().filter(|column| column.printed)
    }

    fn table_of(&self, rows: &[R]) -> Table {
        let mut notes = Notes::default();
        let rows: Vec<Row> = rows.iter().map(|row| self.row(row, &mut notes)).collect();
        let remark = if rows.is_empty() {
            &self.empty
        } else {
            &self.remark
        };
        let remark = (!remark.is_empty()).then_some(remark);
        Table {
            name: self.name.to_owned(),
            title: self.title.to_owned(),
            columns: self.printed().map(|column| column.head.clone()).collect(),
            stub: self.stub,
            rows,
            notes: notes.into_texts(),
            remarks: self.said.iter().chain(remark).cloned().collect(),
            ..Table::default()
        }
    }

    fn row(&self, row: &R, notes: &mut Notes) -> Row {
        let sources = (self.source)(row);
        let cells: Vec<Cell> = (self.printed())
            .map(|column| column.cell((column.of)(row), &sources, notes))
            .collect();
        let called = self.label.as_ref().map(|label| label(row));
        Row {
            label: called.unwrap_or_else(|| label(&cells[..self.stub])),
            cells,
        }
    }
}

/// What a row is about: the words of its first cells.
fn label(stub: &[Cell]) -> String {
    let words = stub.iter().filter_map(|cell| match &cell.content {
        Content::Text(words) => Some(words.clone()),
        Content::Exact(number) => Some(number.to_string()),
        _ => None,
    });
    words.collect::<Vec<_>>().join(", ")
}

impl<R> SheetColumn<'_, R> {
    fn cell(&self, value: Value, sources: &[Source], notes: &mut Notes) -> Cell {
        let of = |content| Cell::new(content, sources.to_vec());
        match value {
            Value::Text(words) => of(Content::Text(words)),
            Value::Exact(number) => of(Content::Exact(number)),
            Value::Count(count) => of(Content::Exact(count as f64)),
            Value::Flag(flag) => of(Content::Text(if flag { "yes" } else { "no" }.to_owned())),
            Value::Rough(number, digits) => of(Content::Rough(number, digits)),
            Value::Score(score) => of(Content::Score(score)),
            Value::Missing => of(Content::Missing),
            Value::Combined(own) => noted(Cell::new(own.content, own.sources), own.notes, notes),
            Value::Noted(value, of_it) => noted(self.cell(*value, sources, notes), of_it, notes),
            Value::Printed(_, read) => self.cell(*read, sources, notes),
            Value::Estimate(estimate) => {
                let of_number = |source: &Source| Source {
                    key: Some(self.head.key.clone()),
                    estimate: Some(estimate.clone()),
                    ..source.clone()
                };
                let cell = Cell::new(content_of(&estimate), sources.iter().map(of_number).collect());
                noted(cell, estimate.reason.clone(), notes)
            }
        }
    }
}

fn noted(cell: Cell, texts: impl IntoIterator<Item = String>, notes: &mut Notes) -> Cell {
    texts
        .into_iter()
        .fold(cell, |cell, text| cell.noted(notes.at(&text)))
}

/// What a cell has of an estimate.
pub fn content_of(estimate: &Estimate) -> Content {
    match (estimate.value, estimate.low_95, estimate.high_95) {
        (Some(value), low_95, high_95) => Content::Measured(Measured {
            value,
            standard_error: estimate.standard_error,
            low_95,
            high_95,
            pooled: None,
        }),
        (None, None, None) => Content::NotDetermined,
        (None, low, high) => Content::Bound { low, high },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantities;

    const C1: Quantity = Quantity::new("c1_f", "C₁", "capacitance", "F").shown_in("mF", 1e3);

    fn sheet() -> Sheet<'static, (&'static str, Estimate)> {
        Sheet::<(&'static str, Estimate)>::new("strips", "Strips", 1)
            .remarks("Of the whole strip.", "There is none.")
            .made_from(|(name, _)| vec![Source::file(name)])
            .column(quantities::SAMPLE, |(name, _)| *name)
            .column(C1, |(_, c1)| Value::from(c1))
    }

    #[test]
    fn a_number_stands_as_it_is_stored_and_is_read_in_the_unit_that_it_is_shown_in() {
        let known = Estimate::determined(0.012, 1e-3, 0.01, 0.014);
        let open = Estimate::not_determined("the record is too short");
        let table = sheet().over([("a", known.clone()), ("b", open)]);
        let head = |table: &Table| (table.columns[1].key.clone(), table.columns[1].unit.clone());
        let number = |table: &Table| match table.rows[0].cells[1].content {
            Content::Measured(own) => own.value,
            _ => f64::NAN,
        };
        assert_eq!(
            (head(&table), number(&table)),
            (("c1_f".into(), "F".into()), 0.012)
        );
        let read = table.as_read();
        assert_eq!((head(&read), number(&read)), (("c1_f".into(), "mF".into()), 12.0));
        assert_eq!(table.rows[0].label, "a");
        let cell = &table.rows[0].cells[1];
        assert_eq!(cell.sources[0].estimate.as_ref(), Some(&known));
        assert_eq!(cell.sources[0].key.as_deref(), Some("c1_f"));
        assert_eq!(table.rows[1].cells[1].content, Content::NotDetermined);
        assert_eq!(table.notes, ["the record is too short"]);
        assert_eq!(table.remarks, ["Of the whole strip."]);
    }

    #[test]
    fn a_sheet_without_rows_says_why_and_columns_can_be_left_out() {
        let table = sheet().over([]);
        assert_eq!(table.remarks, ["There is none."]);
        let bare = table.without(&["sample"]);
        assert_eq!((bare.columns.len(), bare.stub), (1, 0));
    }
}
