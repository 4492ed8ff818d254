//! A table with some of its columns, in an order of one's own.

use ieap_show::{Cell, Row, Table};

/// The table with these columns, by position, in this order. Footnotes that no cell has any more go with their columns.
pub fn with_columns(table: &Table, columns: &[usize]) -> Table {
    let mut notes: Vec<usize> = Vec::new();
    let mut cell = |cell: &Cell| {
        let kept = cell.notes.iter().map(|&note| {
            let at = notes.iter().position(|&known| known == note);
            at.unwrap_or_else(|| {
                notes.push(note);
                notes.len() - 1
            })
        });
        Cell {
            notes: kept.collect(),
            ..cell.clone()
        }
    };
    let mut rows = Vec::new();
    for row in &table.rows {
        rows.push(Row {
            label: row.label.clone(),
            cells: columns.iter().map(|&column| cell(&row.cells[column])).collect(),
        });
    }
    Table {
        columns: columns
            .iter()
            .map(|&column| table.columns[column].clone())
            .collect(),
        // What says which row it is has to lead, or says so no more.
        stub: columns.iter().take_while(|&&column| column < table.stub).count(),
        rows,
        notes: notes
            .iter()
            .filter_map(|&note| table.notes.get(note).cloned())
            .collect(),
        ..table.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::{Column, Content};

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
        let chosen = with_columns(&table, &[2, 0]);
        let keys: Vec<&str> = chosen.columns.iter().map(|column| column.key.as_str()).collect();
        assert_eq!((keys, chosen.stub), (vec!["lambda", "sample"], 0));
        assert_eq!(chosen.notes, ["of lambda"]);
        assert_eq!(chosen.rows[0].cells[0].notes, [0]);
        assert_eq!(with_columns(&table, &[0, 1]).stub, 1);
    }
}
