//! Columns over rows of a kind: the table that they make is written in every medium.

use ieap_domain::Estimate;

use crate::quantities::Quantity;
use crate::table::{Cell, Column, Content, Measured, Notes, Row, Source, Table};

/// Digits that a number without uncertainty is told by.
const ROUGH_DIGITS: i32 = 3;

/// What stands in a cell. Digits, units and notation are the writers' work.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Words.
    Text(String),
    /// A setting or a count.
    Exact(f64),
    /// A number without uncertainty, with its digits.
    Rough(f64, i32),
    /// A coefficient of determination.
    Score(f64),
    /// A number with its uncertainty, a bound, or why there is neither; in its stored unit.
    Estimate(Estimate),
    /// A finished cell, in the column's unit: for means over several sources.
    Cell(Cell),
    /// Nothing.
    Missing,
    /// Nothing, and why.
    Without(String),
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
        Value::Exact(count as f64)
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

/// Columns over rows of a kind.
pub struct Sheet<'s, R> {
    name: &'static str,
    title: &'static str,
    remark: &'static str,
    empty: &'static str,
    stub: usize,
    columns: Vec<(Quantity, Of<'s, R, Value>)>,
    source: Of<'s, R, Vec<Source>>,
}

impl<'s, R> Sheet<'s, R> {
    /// A sheet of which the first `stub` columns say what a row is about; `title` is one sentence without a full stop.
    pub fn new(name: &'static str, title: &'static str, stub: usize) -> Sheet<'s, R> {
        Sheet {
            name,
            title,
            remark: "",
            empty: "",
            stub,
            columns: Vec::new(),
            source: Box::new(|_| Vec::new()),
        }
    }

    /// What holds for all of it, and what is said in its place where there is no row.
    pub fn remarks(self, remark: &'static str, empty: &'static str) -> Sheet<'s, R> {
        Sheet {
            remark,
            empty,
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
    pub fn column<V: Into<Value>>(mut self, quantity: Quantity, of: impl Fn(&R) -> V + 's) -> Sheet<'s, R> {
        self.columns.push((quantity, Box::new(move |row| of(row).into())));
        self
    }

    /// A column for each of these.
    pub fn columns<V: Into<Value>>(
        self,
        quantities: &[Quantity],
        of: impl Fn(&R, &Quantity) -> V + Copy + 's,
    ) -> Sheet<'s, R> {
        quantities.iter().fold(self, |sheet, &quantity| {
            sheet.column(quantity, move |row| of(row, &quantity))
        })
    }

    /// The table of these rows.
    pub fn over(&self, rows: impl IntoIterator<Item = R>) -> Table {
        let mut notes = Notes::default();
        let rows: Vec<Row> = rows.into_iter().map(|row| self.row(&row, &mut notes)).collect();
        let remark = if rows.is_empty() { self.empty } else { self.remark };
        Table {
            name: self.name.to_owned(),
            title: self.title.to_owned(),
            columns: self.columns.iter().map(|(of, _)| of.of_column()).collect(),
            stub: self.stub,
            rows,
            notes: notes.into_texts(),
            remarks: Vec::from_iter((!remark.is_empty()).then(|| remark.to_owned())),
            ..Table::default()
        }
    }

    fn row(&self, row: &R, notes: &mut Notes) -> Row {
        let sources = (self.source)(row);
        let cells: Vec<Cell> = (self.columns.iter())
            .map(|(quantity, of)| cell(quantity, of(row), &sources, notes))
            .collect();
        Row {
            label: label(&cells[..self.stub]),
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

fn cell(quantity: &Quantity, value: Value, sources: &[Source], notes: &mut Notes) -> Cell {
    let of = |content| Cell::new(content, sources.to_vec());
    match value {
        Value::Text(words) => of(Content::Text(words)),
        Value::Exact(number) => of(Content::Exact(number)),
        Value::Rough(number, digits) => of(Content::Rough(number, digits)),
        Value::Score(score) => of(Content::Score(score)),
        Value::Cell(cell) => cell,
        Value::Missing => of(Content::Missing),
        Value::Without(why) => of(Content::Missing).noted(notes.at(&why)),
        Value::Estimate(estimate) => {
            let of_number = |source: &Source| Source {
                key: Some(quantity.key.to_owned()),
                estimate: Some(estimate.clone()),
                ..source.clone()
            };
            let sources = sources.iter().map(of_number).collect();
            of_estimate(&estimate, quantity.factor, sources, notes)
        }
    }
}

/// The cell of an estimate in a unit that is `factor` times its own, with a footnote where it has a reason.
pub fn of_estimate(estimate: &Estimate, factor: f64, sources: Vec<Source>, notes: &mut Notes) -> Cell {
    let own = estimate.scaled(factor);
    let content = match (own.value, own.low_95, own.high_95) {
        (Some(value), low_95, high_95) => Content::Measured(Measured {
            value,
            standard_error: own.standard_error,
            low_95,
            high_95,
            pooled: None,
        }),
        (None, None, None) => Content::NotDetermined,
        (None, low, high) => Content::Bound { low, high },
    };
    let cell = Cell::new(content, sources);
    match &own.reason {
        Some(reason) => cell.noted(notes.at(reason)),
        None => cell,
    }
}

impl Table {
    /// The same without these columns: where what is around it says them already.
    pub fn without(mut self, keys: &[&str]) -> Table {
        let is_kept = |column: &Column| !keys.contains(&column.key.as_str());
        let kept: Vec<bool> = self.columns.iter().map(is_kept).collect();
        self.stub = kept.iter().take(self.stub).filter(|kept| **kept).count();
        let mut at = kept.iter();
        self.columns.retain(|_| at.next() == Some(&true));
        for row in &mut self.rows {
            let mut at = kept.iter();
            row.cells.retain(|_| at.next() == Some(&true));
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantities;

    const C1: Quantity = Quantity::new("c1_f", "C₁", "capacitance", "F").shown_in("c1_mf", "mF", 1e3);

    fn sheet() -> Sheet<'static, (&'static str, Estimate)> {
        Sheet::<(&'static str, Estimate)>::new("strips", "Strips", 1)
            .remarks("Of the whole strip.", "There is none.")
            .made_from(|(name, _)| vec![Source::file(name)])
            .column(quantities::SAMPLE, |(name, _)| *name)
            .column(C1, |(_, c1)| Value::from(c1))
    }

    #[test]
    fn a_number_stands_in_the_unit_of_its_column_and_its_source_as_stored() {
        let known = Estimate::determined(0.012, 1e-3, 0.01, 0.014);
        let open = Estimate::not_determined("the record is too short");
        let table = sheet().over([("a", known.clone()), ("b", open)]);
        assert_eq!(table.columns[1].key, "c1_mf");
        assert_eq!(table.rows[0].label, "a");
        let cell = &table.rows[0].cells[1];
        assert!(matches!(cell.content, Content::Measured(own) if (own.value - 12.0).abs() < 1e-9));
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
