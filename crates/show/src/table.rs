//! A table as a value: columns with quantity and unit, cells with uncertainty and provenance. Nothing is rounded here.

use ieap_domain::{DisplayUnit, Estimate};

/// A finished table. `report::tables` writes it in every format.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Table {
    /// Name by which it is asked for, `table5`.
    pub name: String,
    /// Caption: what the table shows, one sentence.
    pub title: String,
    /// Columns from left to right.
    pub columns: Vec<Column>,
    /// How many of the first columns say what a row is about.
    pub stub: usize,
    /// Rows from top to bottom.
    pub rows: Vec<Row>,
    /// Footnotes; cells refer to them by position.
    pub notes: Vec<String>,
    /// What holds for the whole table: how numbers came about, which rules words follow.
    pub remarks: Vec<String>,
    /// The campaign's own statement, such as "simulated, not measured".
    pub notice: Option<String>,
    /// Program and state of the database that it was made from.
    pub origin: String,
}

/// A column.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Column {
    /// Name for machines, with the unit in which the numbers are: `rss_ohm_cm2`.
    pub key: String,
    /// Symbol or short title: `Rₛₛ`.
    pub symbol: String,
    /// The quantity in words.
    pub quantity: String,
    /// Unit of the numbers, empty for words and pure numbers: `Ω cm²`.
    pub unit: String,
    /// Unit in which people read them, where that is another.
    pub display: Option<DisplayUnit>,
}

impl Column {
    /// A column of words or counts, without a unit.
    pub fn plain(key: &str, symbol: &str, quantity: &str) -> Column {
        Column::of(key, symbol, quantity, "")
    }

    /// A column of a quantity in a unit.
    pub fn of(key: &str, symbol: &str, quantity: &str, unit: &str) -> Column {
        Column {
            key: key.to_owned(),
            symbol: symbol.to_owned(),
            quantity: quantity.to_owned(),
            unit: unit.to_owned(),
            display: None,
        }
    }
}

/// A row.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Row {
    /// What it is about, unique in its table: `CNaf, air, 2.5 V`.
    pub label: String,
    /// One cell a column.
    pub cells: Vec<Cell>,
}

/// What stands in a cell, in the unit of its column.
#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    /// Words.
    Text(String),
    /// A setting or a count, which carries no uncertainty.
    Exact(f64),
    /// A number of which that many leading digits mean something.
    Rough(f64, i32),
    /// A coefficient of determination: as many digits as tell it from 1.
    Score(f64),
    /// A value with its uncertainty.
    Measured(Measured),
    /// Only a bound is known, or one on each side.
    Bound {
        /// It is above this.
        low: Option<f64>,
        /// It is below this.
        high: Option<f64>,
    },
    /// Measured, but the data do not determine it; a footnote gives the reason.
    NotDetermined,
    /// Nothing was measured, or the question does not arise.
    Missing,
}

/// A value with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Value: of one run, or the mean of several.
    pub value: f64,
    /// Standard error, spread between runs and samples included; none where it is not known.
    pub standard_error: Option<f64>,
    /// Lower end of the 95 % interval.
    pub low_95: Option<f64>,
    /// Upper end.
    pub high_95: Option<f64>,
    /// How the mean came about, in the unit of the column as it is stored; none for a single run.
    pub pooled: Option<Pooled>,
}

/// The mean of repeats, in their unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pooled {
    /// Mean.
    pub value: f64,
    /// Standard error of the mean, all three sources of spread allowed for.
    pub standard_error: f64,
    /// Lower end of the 95 % interval of the mean.
    pub low_95: f64,
    /// Upper end.
    pub high_95: f64,
    /// Standard error that the fits alone would leave.
    pub fit_standard_error: f64,
    /// Standard deviation between runs of one sample, the errors of the fits taken out; none where no sample has two.
    pub between_runs: Option<f64>,
    /// Standard deviation between samples, all else taken out; none for one sample.
    pub between_samples: Option<f64>,
    /// Number of runs.
    pub runs: usize,
    /// Number of samples.
    pub samples: usize,
}

/// A cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// What stands in it.
    pub content: Content,
    /// Positions of its footnotes.
    pub notes: Vec<usize>,
    /// What it was made from.
    pub sources: Vec<Source>,
}

impl Cell {
    /// A cell without footnote.
    pub fn new(content: Content, sources: Vec<Source>) -> Cell {
        Cell {
            content,
            notes: Vec::new(),
            sources,
        }
    }

    /// Words, or a gap where there are none.
    pub fn text(text: Option<impl Into<String>>, sources: Vec<Source>) -> Cell {
        let content = text.map_or(Content::Missing, |text| Content::Text(text.into()));
        Cell::new(content, sources)
    }

    /// A setting or a count, or a gap.
    pub fn exact(number: Option<f64>, sources: Vec<Source>) -> Cell {
        Cell::new(number.map_or(Content::Missing, Content::Exact), sources)
    }

    /// The same cell with a footnote.
    pub fn noted(mut self, note: usize) -> Cell {
        if !self.notes.contains(&note) {
            self.notes.push(note);
        }
        self
    }
}

/// Something a cell was made from.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// What kind of thing it is.
    pub origin: SourceOrigin,
    /// Its name: a run's or a file's path, a group's name.
    pub name: String,
    /// Stored key of the number that was taken, where one was.
    pub key: Option<String>,
    /// The number as it is stored, in the unit that its key names.
    pub estimate: Option<Estimate>,
    /// Why it was left out of the cell; none where it is part of it.
    pub left_out: Option<String>,
}

impl Source {
    /// A thing of that kind and name, no number taken from it.
    pub fn of(origin: SourceOrigin, name: &str) -> Source {
        Source {
            origin,
            name: name.to_owned(),
            key: None,
            estimate: None,
            left_out: None,
        }
    }

    /// A file that is no run.
    pub fn file(name: &str) -> Source {
        Source::of(SourceOrigin::File, name)
    }
}

/// Kinds of things that cells are made from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SourceOrigin {
    /// A run with its current fit; the row id in the database.
    Run(i64),
    /// A modulus log with its current analysis; the row id in the database.
    ModulusLog(i64),
    /// A comparison of models on a run; the run's row id in the database.
    Comparison(i64),
    /// The current diagnosis of a group.
    Diagnosis,
    /// A run that is read along its strip.
    Strip,
    /// A file that is no run.
    File,
}

/// Footnotes as they come up: equal texts share one.
#[derive(Debug, Default)]
pub struct Notes(Vec<String>);

impl Notes {
    /// Position of the footnote with that text.
    pub fn at(&mut self, text: &str) -> usize {
        self.0.iter().position(|known| known == text).unwrap_or_else(|| {
            self.0.push(text.to_owned());
            self.0.len() - 1
        })
    }

    /// All texts in order.
    pub fn into_texts(self) -> Vec<String> {
        self.0
    }
}

impl Table {
    /// The row with that number (from 1) or label; a part of a label will do where it fits one row only.
    ///
    /// # Errors
    /// What was asked for and which rows there are.
    pub fn row_named(&self, asked: &str) -> Result<usize, String> {
        let labels: Vec<&str> = self.rows.iter().map(|row| row.label.as_str()).collect();
        chosen("row", asked, &labels, |at| vec![labels[at].to_owned()])
    }

    /// The column with that number (from 1), key, symbol or quantity; a part of one of them will do where it fits
    /// one column only.
    ///
    /// # Errors
    /// What was asked for and which columns there are.
    pub fn column_named(&self, asked: &str) -> Result<usize, String> {
        let keys: Vec<&str> = self.columns.iter().map(|column| column.key.as_str()).collect();
        chosen("column", asked, &keys, |at| {
            let column = &self.columns[at];
            vec![column.key.clone(), column.symbol.clone(), column.quantity.clone()]
        })
    }
}

impl Content {
    /// The same in a unit of which `factor` make one of its own.
    fn scaled(&self, factor: f64) -> Content {
        let end = |number: Option<f64>| number.map(|number| number * factor);
        match *self {
            Content::Exact(number) => Content::Exact(number * factor),
            Content::Rough(number, digits) => Content::Rough(number * factor, digits),
            Content::Measured(own) => Content::Measured(Measured {
                value: own.value * factor,
                standard_error: end(own.standard_error),
                low_95: end(own.low_95),
                high_95: end(own.high_95),
                pooled: own.pooled,
            }),
            Content::Bound { low, high } => Content::Bound {
                low: end(low),
                high: end(high),
            },
            ref other => other.clone(),
        }
    }
}

impl Table {
    /// The same as people read it: numbers in the units that columns are shown in.
    pub fn as_read(&self) -> Table {
        let mut table = self.clone();
        for (at, column) in table.columns.iter_mut().enumerate() {
            let Some(DisplayUnit { unit, factor }) = column.display.take() else {
                continue;
            };
            unit.clone_into(&mut column.unit);
            for row in &mut table.rows {
                row.cells[at].content = row.cells[at].content.scaled(factor);
            }
        }
        table
    }

    /// The same without these columns: where what is around it says them already.
    pub fn without(&self, keys: &[&str]) -> Table {
        let is_kept = |&at: &usize| !keys.contains(&self.columns[at].key.as_str());
        let kept: Vec<usize> = (0..self.columns.len()).filter(is_kept).collect();
        self.with_columns(&kept)
    }

    /// The same without the columns in which no row has anything.
    pub fn without_empty(&self) -> Table {
        let is_there = |&at: &usize| {
            self.rows
                .iter()
                .any(|row| row.cells[at].content != Content::Missing)
        };
        let kept: Vec<usize> = (0..self.columns.len()).filter(is_there).collect();
        self.with_columns(&kept)
    }

    /// The same with these columns, by position, in this order. Footnotes that no cell has any more go with their columns.
    pub fn with_columns(&self, columns: &[usize]) -> Table {
        let mut notes = Notes::default();
        let mut cell = |cell: &Cell| Cell {
            notes: cell
                .notes
                .iter()
                .map(|&note| notes.at(&self.notes[note]))
                .collect(),
            ..cell.clone()
        };
        let rows = self.rows.iter().map(|row| Row {
            label: row.label.clone(),
            cells: columns.iter().map(|&column| cell(&row.cells[column])).collect(),
        });
        Table {
            rows: rows.collect(),
            columns: columns
                .iter()
                .map(|&column| self.columns[column].clone())
                .collect(),
            // What says which row it is has to lead, or says so no more.
            stub: columns.iter().take_while(|&&column| column < self.stub).count(),
            notes: notes.into_texts(),
            ..self.clone()
        }
    }
}

/// Picks one of `listed` by number, by one of its names, or by a part of a name that fits one only.
fn chosen(
    what: &str,
    asked: &str,
    listed: &[&str],
    names: impl Fn(usize) -> Vec<String>,
) -> Result<usize, String> {
    if let Ok(number) = asked.parse::<usize>()
        && (1..=listed.len()).contains(&number)
    {
        return Ok(number - 1);
    }
    let wanted = asked.to_lowercase();
    let fits = |fit: &dyn Fn(&str) -> bool| -> Vec<usize> {
        (0..listed.len())
            .filter(|&at| names(at).iter().any(|name| fit(&name.to_lowercase())))
            .collect()
    };
    for found in [
        fits(&|name| name == wanted),
        fits(&|name| name.starts_with(&wanted)),
        fits(&|name| name.contains(&wanted)),
    ] {
        match found.as_slice() {
            [] => {}
            [one] => return Ok(*one),
            several => {
                let fitting: Vec<&str> = several.iter().map(|&at| listed[at]).collect();
                return Err(format!(
                    "{what} {asked:?} fits several: {}. Give one of them in full, or its number.",
                    fitting.join("; ")
                ));
            }
        }
    }
    let numbered = listed
        .iter()
        .enumerate()
        .map(|(at, name)| format!("\n  {} {name}", at + 1));
    Err(format!(
        "there is no {what} {asked:?}. The {what}s are:{}",
        numbered.collect::<String>()
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let row = |label: &str| Row {
            label: label.to_owned(),
            cells: vec![],
        };
        Table {
            columns: vec![
                Column::plain("environment", "Environment", "environment"),
                Column::of("rss_ohm_cm2", "Rₛₛ", "steady-state resistance", "Ω cm²"),
            ],
            rows: vec![row("CNaf, air, 1.2 V"), row("CNaf, air, 2.5 V"), row("CNaf, air")],
            ..Table::default()
        }
    }

    #[test]
    fn rows_and_columns_are_found_by_number_name_and_part() {
        let table = table();
        assert_eq!(table.row_named("2"), Ok(1));
        assert_eq!(
            table.row_named("cnaf, AIR"),
            Ok(2),
            "a whole name goes before a part"
        );
        assert_eq!(table.row_named("2.5 V"), Ok(1));
        assert_eq!(table.column_named("rss"), Ok(1));
        assert_eq!(table.column_named("Rₛₛ"), Ok(1));
    }

    #[test]
    fn what_is_not_there_is_answered_by_what_there_is() {
        let refused = table().row_named("CPvf").unwrap_err();
        assert!(
            refused.contains("\"CPvf\"") && refused.contains("1 CNaf, air, 1.2 V"),
            "{refused}"
        );
        let refused = table().row_named("V").unwrap_err();
        assert!(refused.contains("several"), "{refused}");
        assert!(table().column_named("9").unwrap_err().contains("2 rss_ohm_cm2"));
    }

    #[test]
    fn columns_come_in_the_order_asked_for_and_footnotes_follow_their_cells() {
        let cell = |text: &str, note: Option<usize>| {
            let cell = Cell::new(Content::Text(text.to_owned()), Vec::new());
            note.map_or(cell.clone(), |note| cell.noted(note))
        };
        let table = Table {
            columns: ["sample", "c", "lambda"]
                .map(|key| Column::plain(key, key, key))
                .to_vec(),
            stub: 1,
            rows: vec![Row {
                label: "S1".to_owned(),
                cells: vec![cell("S1", None), cell("1.0", Some(0)), cell("2.0", Some(1))],
            }],
            notes: vec!["of c".to_owned(), "of lambda".to_owned()],
            ..Table::default()
        };
        let chosen = table.with_columns(&[2, 0]);
        let keys: Vec<&str> = chosen.columns.iter().map(|column| column.key.as_str()).collect();
        assert_eq!((keys, chosen.stub), (vec!["lambda", "sample"], 0));
        assert_eq!(chosen.notes, ["of lambda"]);
        assert_eq!(chosen.rows[0].cells[0].notes, [0]);
        assert_eq!(table.with_columns(&[0, 1]).stub, 1);
    }
}
