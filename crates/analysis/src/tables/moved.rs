//! Two versions of one table held against each other: which cells moved after a refit, and how far.

use ieap_show::{Cell, Content, Table};

/// A cell that is not what it was.
#[derive(Debug, Clone, PartialEq)]
pub struct MovedCell {
    /// Label of its row.
    pub row: String,
    /// Key of its column.
    pub column: String,
    /// Unit of its column.
    pub unit: String,
    /// What stood there.
    pub before: Content,
    /// What stands there now.
    pub after: Content,
    /// Distance in standard errors of what stood there; none where either is no value.
    pub sigma: Option<f64>,
}

impl MovedCell {
    /// Whether it became something else: other words, or a bound where a value stood, or the other way round.
    pub fn became_other(&self) -> bool {
        let is_text = matches!(self.after, Content::Text(_));
        is_text || std::mem::discriminant(&self.before) != std::mem::discriminant(&self.after)
    }

    /// What became something else first, then the farthest in standard errors, then what has none: a score without an
    /// error is no finding.
    fn rank(&self) -> f64 {
        if self.became_other() {
            f64::INFINITY
        } else {
            self.sigma.unwrap_or(-1.0)
        }
    }
}

/// What changed between two versions of a table.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Moved {
    /// Cells with numbers or words that were compared.
    pub compared: usize,
    /// Cells that moved, those that became something else first, then the farthest, then what has no error.
    pub cells: Vec<MovedCell>,
    /// Rows that are gone.
    pub rows_gone: Vec<String>,
    /// Rows that are new.
    pub rows_new: Vec<String>,
}

/// Relative differences below this are rounding.
const ROUNDING: f64 = 1e-12;

/// Holds `after` against `before`: rows by label, columns by key.
pub fn moved(before: &Table, after: &Table) -> Moved {
    let labels = |table: &Table| -> Vec<String> { table.rows.iter().map(|row| row.label.clone()).collect() };
    let (old, new) = (labels(before), labels(after));
    let mut found = Moved {
        rows_gone: old.iter().filter(|label| !new.contains(label)).cloned().collect(),
        rows_new: new.iter().filter(|label| !old.contains(label)).cloned().collect(),
        ..Moved::default()
    };
    for row in &after.rows {
        let Some(earlier) = before.rows.iter().find(|earlier| earlier.label == row.label) else {
            continue;
        };
        for (column, cell) in after.columns.iter().zip(&row.cells).skip(after.stub) {
            let place = before.columns.iter().position(|known| known.key == column.key);
            let Some(was) = place.and_then(|place| earlier.cells.get(place)) else {
                continue;
            };
            found.compared += 1;
            if let Some(sigma) = distance(was, cell) {
                found.cells.push(MovedCell {
                    row: row.label.clone(),
                    column: column.key.clone(),
                    unit: column.unit.clone(),
                    before: was.content.clone(),
                    after: cell.content.clone(),
                    sigma,
                });
            }
        }
    }
    found.cells.sort_by(|a, b| b.rank().total_cmp(&a.rank()));
    found
}

/// None where the cell did not move; otherwise by how many standard errors, where that can be said.
fn distance(before: &Cell, after: &Cell) -> Option<Option<f64>> {
    let (was, is) = match (&before.content, &after.content) {
        (Content::Measured(was), Content::Measured(is)) => (was, is),
        (Content::Score(was), Content::Score(is))
        | (Content::Rough(was, _), Content::Rough(is, _))
        | (Content::Exact(was), Content::Exact(is)) => return (!same(*was, *is)).then_some(None),
        (
            Content::Bound { low, high },
            Content::Bound {
                low: low_now,
                high: high_now,
            },
        ) => {
            let sides = [(low, low_now), (high, high_now)];
            let moved = sides.iter().any(|(was, is)| match (was, is) {
                (Some(was), Some(is)) => !same(*was, *is),
                (was, is) => was != is,
            });
            return moved.then_some(None);
        }
        (was, is) => return (was != is).then_some(None),
    };
    if same(was.value, is.value) {
        return None;
    }
    let error = was.standard_error.filter(|&error| error > 0.0);
    Some(error.map(|error| (is.value - was.value).abs() / error))
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= ROUNDING * a.abs().max(b.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_show::{Column, Measured, Row};

    fn table(rows: &[(&str, Content)]) -> Table {
        let row = |(label, content): &(&str, Content)| Row {
            label: (*label).to_owned(),
            cells: vec![
                Cell::text(Some(*label), vec![]),
                Cell::new(content.clone(), vec![]),
            ],
        };
        Table {
            columns: vec![Column::plain("name", "", ""), Column::of("alpha", "α", "", "cm")],
            stub: 1,
            rows: rows.iter().map(row).collect(),
            ..Table::default()
        }
    }

    fn value(value: f64, error: f64) -> Content {
        Content::Measured(Measured {
            value,
            standard_error: Some(error),
            low_95: None,
            high_95: None,
            pooled: None,
        })
    }

    #[test]
    fn cells_that_moved_are_told_in_errors_of_what_stood_there() {
        let bound = Content::Bound {
            low: None,
            high: Some(1.0),
        };
        let before = table(&[
            ("a", value(10.0, 0.5)),
            ("b", value(3.0, 0.1)),
            ("c", value(1.0, 0.1)),
            ("gone", value(1.0, 0.1)),
        ]);
        let after = table(&[
            ("a", value(11.0, 0.01)),
            ("b", value(3.0, 0.2)),
            ("c", bound.clone()),
            ("new", value(1.0, 0.1)),
        ]);
        let found = moved(&before, &after);
        assert_eq!(found.compared, 3);
        let told: Vec<(&str, Option<f64>)> = found
            .cells
            .iter()
            .map(|cell| (cell.row.as_str(), cell.sigma))
            .collect();
        assert_eq!(told, [("c", None), ("a", Some(2.0))]);
        assert_eq!(found.cells[0].after, bound);
        assert_eq!(
            (found.rows_gone, found.rows_new),
            (vec!["gone".to_owned()], vec!["new".to_owned()])
        );
    }

    #[test]
    fn a_score_without_an_error_stands_below_values_that_moved() {
        let before = table(&[("score", Content::Score(0.99)), ("a", value(10.0, 0.5))]);
        let after = table(&[("score", Content::Score(0.98)), ("a", value(10.1, 0.5))]);
        let rows: Vec<String> = moved(&before, &after)
            .cells
            .iter()
            .map(|cell| cell.row.clone())
            .collect();
        assert_eq!(rows, ["a", "score"]);
    }

    #[test]
    fn a_table_has_not_moved_against_itself() {
        let same = table(&[("a", value(10.0, 0.5)), ("b", Content::NotDetermined)]);
        assert_eq!(moved(&same, &same).cells, []);
    }
}
