//! A table for programs: each column of one kind, numbers in full and as they are stored. Files, SQL views and Python have it.

use ieap_domain::{Estimate, unit_of_key};

use crate::sheet::{Combined, Printed, Rough, Sheet, Value};
use crate::table::{Cell, Column, Content, Table};

/// Columns of the same height.
pub type Frame = Vec<FrameColumn>;

/// One column; an empty cell is none.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameColumn {
    /// Its name, with the unit in it.
    pub name: String,
    /// The quantity in words, as tables for people head it; empty of columns that only programs have.
    pub quantity: String,
    /// Unit of its numbers, as tables for people head it; empty where the name alone tells it, and of words.
    pub headed_unit: String,
    /// Its cells.
    pub cells: FrameCells,
}

/// The cells of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum FrameCells {
    /// Numbers.
    Numbers(Vec<Option<f64>>),
    /// Whole numbers.
    Counts(Vec<Option<i64>>),
    /// Yes or no.
    Flags(Vec<Option<bool>>),
    /// Words; times stand in RFC 3339.
    Texts(Vec<Option<String>>),
}

impl FrameColumn {
    /// Unit of its numbers; none of words and pure numbers.
    pub fn unit(&self) -> Option<&str> {
        if !matches!(self.cells, FrameCells::Numbers(_)) {
            return None;
        }
        let headed = Some(self.headed_unit.as_str()).filter(|unit| !unit.is_empty());
        headed.or_else(|| unit_of_key(&self.name))
    }
}

impl FrameCells {
    /// Number of rows.
    pub fn len(&self) -> usize {
        match self {
            FrameCells::Numbers(cells) => cells.len(),
            FrameCells::Counts(cells) => cells.len(),
            FrameCells::Flags(cells) => cells.len(),
            FrameCells::Texts(cells) => cells.len(),
        }
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// What all cells of a column are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Words.
    Text,
    /// Numbers.
    Number,
    /// Whole numbers.
    Count,
    /// Yes or no.
    Flag,
    /// Numbers with their uncertainty: five columns.
    Estimate,
    /// The same of several sources.
    Combined,
    /// That of the first cell that is there.
    Any,
}

/// What a column may be read off as.
pub trait OfKind: Into<Value> {
    /// The kind of every cell.
    const KIND: Kind;
}

macro_rules! kinds {
    ($($kind:ident: $($of:ty),+;)+) => {
        $($(impl OfKind for $of {
            const KIND: Kind = Kind::$kind;
        })+)+
    };
}

kinds! {
    Text: &str, String;
    Number: f64, Rough;
    Count: usize, u32, i64;
    Flag: bool;
    Estimate: Estimate, &Estimate;
    Combined: Combined;
    Any: Value;
}

impl<T: OfKind> OfKind for Option<T> {
    const KIND: Kind = T::KIND;
}

impl<T: OfKind> OfKind for Printed<T> {
    const KIND: Kind = T::KIND;
}

impl<R> Sheet<'_, R> {
    /// The frame of these rows. A number that is not finite is missing.
    pub fn frame(&self, rows: impl IntoIterator<Item = R>) -> Frame {
        self.frame_of(&rows.into_iter().collect::<Vec<R>>())
    }

    pub(crate) fn frame_of(&self, rows: &[R]) -> Frame {
        let columns = self.columns.iter().map(|column| {
            let values: Vec<Value> = rows.iter().map(|row| (column.of)(row).bare()).collect();
            columns(&column.head, column.kind, values)
        });
        columns.flatten().collect()
    }
}

/// The frame of a finished table. A column of numbers without uncertainty that holds words as well has these in a column of
/// its own, `_reason`, as what is not determined has.
pub fn frame_of(table: &Table) -> Frame {
    let of_column = |(at, column): (usize, &Column)| {
        let cells: Vec<&Cell> = table.rows.iter().map(|row| &row.cells[at]).collect();
        let is = |wanted: fn(&Content) -> bool| cells.iter().any(|cell| wanted(&cell.content));
        let is_number = is(|content| {
            matches!(
                content,
                Content::Exact(_) | Content::Rough(..) | Content::Score(_)
            )
        });
        let is_open = is(|content| {
            matches!(
                content,
                Content::Measured(_) | Content::Bound { .. } | Content::NotDetermined
            )
        });
        let is_text = is(|content| matches!(content, Content::Text(_)));
        let kind = match (is_open || is_number && is_text, is_number) {
            (true, _) => Kind::Combined,
            (false, true) => Kind::Number,
            (false, false) => Kind::Text,
        };
        let value = |cell: &&Cell| value(cell, &table.notes, kind);
        columns(column, kind, cells.iter().map(value).collect())
    };
    table.columns.iter().enumerate().flat_map(of_column).collect()
}

fn value(cell: &Cell, notes: &[String], kind: Kind) -> Value {
    match &cell.content {
        Content::Missing => Value::Missing,
        content if kind == Kind::Combined => {
            let noted = cell.notes.iter().filter_map(|&at| notes.get(at).cloned());
            let words = match content {
                Content::Text(words) => Some(words.clone()),
                _ => None,
            };
            Value::Combined(Combined {
                content: match *content {
                    Content::Rough(number, _) | Content::Score(number) => Content::Exact(number),
                    ref content => content.clone(),
                },
                notes: words.into_iter().chain(noted).collect(),
                sources: Vec::new(),
            })
        }
        Content::Text(words) => Value::Text(words.clone()),
        Content::Exact(number) | Content::Score(number) => Value::Exact(*number),
        Content::Rough(number, digits) => Value::Rough(*number, *digits),
        _ => Value::Missing,
    }
}

impl Value {
    fn bare(self) -> Value {
        match self {
            Value::Noted(value, _) | Value::Printed(value, _) => value.bare(),
            value => value,
        }
    }

    fn kind(&self) -> Kind {
        match self {
            Value::Text(_) => Kind::Text,
            Value::Exact(_) | Value::Rough(..) | Value::Score(_) => Kind::Number,
            Value::Count(_) => Kind::Count,
            Value::Flag(_) => Kind::Flag,
            Value::Estimate(_) => Kind::Estimate,
            Value::Combined(_) => Kind::Combined,
            Value::Noted(value, _) | Value::Printed(value, _) => value.kind(),
            Value::Missing => Kind::Any,
        }
    }
}

/// The columns under a head.
fn columns(head: &Column, kind: Kind, values: Vec<Value>) -> Frame {
    let name = head.key.as_str();
    let named = |name: &str, cells| FrameColumn {
        name: name.to_owned(),
        quantity: head.quantity.clone(),
        headed_unit: head.unit.clone(),
        cells,
    };
    let first = || values.iter().map(Value::kind).find(|kind| *kind != Kind::Any);
    let kind = match kind {
        Kind::Any => first().unwrap_or(Kind::Text),
        kind => kind,
    };
    let values = values.into_iter();
    let cells = match kind {
        Kind::Text | Kind::Any => FrameCells::Texts(values.map(text).collect()),
        Kind::Number => FrameCells::Numbers(values.map(number).collect()),
        Kind::Count => FrameCells::Counts(values.map(count).collect()),
        Kind::Flag => FrameCells::Flags(values.map(flag).collect()),
        Kind::Estimate | Kind::Combined => {
            let all: Vec<Option<Estimate>> = values.map(estimate).collect();
            let numbers = |end: &str, of: fn(&Estimate) -> Option<f64>| {
                let cells = all.iter().map(|own| finite(own.as_ref().and_then(of)?));
                named(&format!("{name}{end}"), FrameCells::Numbers(cells.collect()))
            };
            let reasons = all.iter().map(|own| own.as_ref()?.reason.clone());
            return vec![
                numbers("", |own| own.value),
                numbers("_standard_error", |own| own.standard_error),
                numbers("_low_95", |own| own.low_95),
                numbers("_high_95", |own| own.high_95),
                named(&format!("{name}_reason"), FrameCells::Texts(reasons.collect())),
            ];
        }
    };
    vec![named(name, cells)]
}

fn finite(number: f64) -> Option<f64> {
    number.is_finite().then_some(number)
}

fn text(value: Value) -> Option<String> {
    match value {
        Value::Text(words) => Some(words),
        _ => None,
    }
}

fn number(value: Value) -> Option<f64> {
    match value {
        Value::Exact(number) | Value::Rough(number, _) | Value::Score(number) => finite(number),
        _ => None,
    }
}

fn count(value: Value) -> Option<i64> {
    match value {
        Value::Count(count) => Some(count),
        _ => None,
    }
}

fn flag(value: Value) -> Option<bool> {
    match value {
        Value::Flag(flag) => Some(flag),
        _ => None,
    }
}

fn estimate(value: Value) -> Option<Estimate> {
    let all = match value {
        Value::Estimate(estimate) => return Some(estimate),
        Value::Combined(all) => all,
        _ => return None,
    };
    let none = || Estimate::not_determined(all.notes.join("; "));
    Some(match all.content {
        Content::Measured(own) => Estimate {
            value: Some(own.value),
            standard_error: own.standard_error,
            low_95: own.low_95,
            high_95: own.high_95,
            ..none()
        },
        Content::Exact(value) => Estimate {
            value: Some(value),
            ..none()
        },
        Content::Bound { low, high } => Estimate {
            low_95: low,
            high_95: high,
            ..none()
        },
        _ => none(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Quantity;

    const C1: Quantity = Quantity::new("c1_f", "C₁", "capacitance", "F").shown_in("mF", 1e3);

    #[test]
    fn each_kind_keeps_its_kind_and_its_empty_cells() {
        type Row = (&'static str, Option<f64>, Option<usize>, Option<bool>);
        let sheet = Sheet::<Row>::new("strips", "Strips", 1)
            .column(Quantity::plain("run", "", ""), |row| row.0)
            .column(Quantity::plain("a_v", "", ""), |row| row.1)
            .column(Quantity::plain("runs", "", ""), |row| row.2)
            .column(Quantity::plain("converged", "", ""), |row| row.3)
            .column(C1, |row| {
                row.1
                    .map(|_| Estimate::determined(0.012, 1e-3, 0.01, f64::INFINITY))
            });
        let rows = [
            ("a", Some(1.5), Some(3), Some(true)),
            ("b", Some(f64::NAN), None, None),
        ];
        let frame = sheet.frame(rows);
        let cells: Vec<&FrameCells> = frame.iter().map(|column| &column.cells).collect();
        assert_eq!(
            *cells[0],
            FrameCells::Texts(vec![Some("a".into()), Some("b".into())])
        );
        assert_eq!(*cells[1], FrameCells::Numbers(vec![Some(1.5), None]));
        assert_eq!(*cells[2], FrameCells::Counts(vec![Some(3), None]));
        assert_eq!(*cells[3], FrameCells::Flags(vec![Some(true), None]));
        assert_eq!(frame[4].name, "c1_f");
        assert_eq!(*cells[4], FrameCells::Numbers(vec![Some(0.012), Some(0.012)]));
        assert_eq!(
            (frame[7].name.as_str(), cells[7]),
            ("c1_f_high_95", &FrameCells::Numbers(vec![None, None]))
        );
        let empty = sheet.frame([]);
        let kinds = |frame: &[FrameColumn]| -> Vec<_> {
            frame
                .iter()
                .map(|column| std::mem::discriminant(&column.cells))
                .collect()
        };
        assert_eq!(kinds(&empty), kinds(&frame), "also without rows");
    }

    #[test]
    fn a_finished_table_keeps_its_numbers_in_full_and_its_words() {
        let measured = Content::Measured(crate::Measured {
            value: 1.25,
            standard_error: Some(0.5),
            low_95: None,
            high_95: Some(2.0),
            pooled: None,
        });
        let row = |words: &str, number: Content, count: Content| crate::Row {
            label: words.to_owned(),
            cells: vec![Content::Text(words.to_owned()), number, count]
                .into_iter()
                .map(|content| Cell::new(content, Vec::new()))
                .collect(),
        };
        let open = row("b", Content::NotDetermined, Content::Missing);
        let table = Table {
            columns: ["run", "r_ohm", "runs"]
                .map(|key| Column::plain(key, "", ""))
                .to_vec(),
            rows: vec![
                row("a", measured, Content::Exact(3.0)),
                crate::Row {
                    cells: open.cells.into_iter().map(|cell| cell.noted(0)).collect(),
                    ..open
                },
            ],
            notes: vec!["too few readings".to_owned()],
            ..Table::default()
        };
        let frame = frame_of(&table);
        let names: Vec<&str> = frame.iter().map(|column| column.name.as_str()).collect();
        let of = |name: &str| &frame[names.iter().position(|own| *own == name).unwrap()].cells;
        assert_eq!(*of("r_ohm"), FrameCells::Numbers(vec![Some(1.25), None]));
        assert_eq!(*of("r_ohm_high_95"), FrameCells::Numbers(vec![Some(2.0), None]));
        let reasons = FrameCells::Texts(vec![Some(String::new()), Some("too few readings".to_owned())]);
        assert_eq!(*of("r_ohm_reason"), reasons);
        assert_eq!(*of("runs"), FrameCells::Numbers(vec![Some(3.0), None]));
    }
}
