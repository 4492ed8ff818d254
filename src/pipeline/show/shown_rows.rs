//! What a report shows, as rows for whoever asks in SQL: the same tables that `ieap table` prints and `ieap export` writes.

use serde_json::json;

use crate::analysis::json_rows;
use crate::analysis::tables::{NamedTable, Need, TABLES, TableInput, named};
use crate::pipeline::campaign::standing;
use crate::pipeline::show::columns::columns_table;
use crate::report;
use crate::show::Frame;
use crate::store::{PublishedRows, has_view};

/// What a report shows, as rows for whoever asks in SQL: yes and no are 1 and 0 there.
pub fn shown(input: &report::Input) -> Vec<PublishedRows> {
    let from = TableInput {
        told: Some(&input.study),
        ..input.of_tables()
    };
    let frame = |name| named(name).map_or_else(Frame::new, |table| table.frame(&from));
    let mut runs = frame("runs");
    let kept = ["run", "standing", "standing_reason"];
    runs.retain(|column| kept.contains(&column.name.as_str()));
    let [table_rows, table_columns] = shown_tables(&from);
    vec![
        ("run", texts(&runs)),
        standing::shown_samples(&input.campaign),
        ("finding", texts(&frame("findings"))),
        ("law", texts(&frame("laws"))),
        ("monitoring", texts(&frame("monitoring"))),
        table_rows,
        table_columns,
    ]
}

/// Rows of a frame as a database has them: yes and no are 1 and 0.
fn in_json(frame: &Frame) -> impl Iterator<Item = String> {
    json_rows::texts(frame, ["0", "1"])
}

fn texts(frame: &Frame) -> Vec<String> {
    in_json(frame).collect()
}

/// The tables of `ieap table` that no view shows otherwise and that a report makes what they need for: their rows, and their
/// columns with units.
fn shown_tables(from: &TableInput) -> [PublishedRows; 2] {
    let is_made = |named: &&NamedTable| !matches!(named.needs, Need::Reductions | Need::OneLikelihood);
    let tables: Vec<(&'static str, Frame)> = (TABLES.iter())
        .filter(|named| !has_view(&format!("{}_view", named.name)))
        .filter(is_made)
        .map(|named| (named.name, named.frame(from)))
        .collect();
    let rows_of = |(name, frame): &(&'static str, Frame)| {
        let head = format!("{{\"table\":{},\"row\":", json!(name));
        let row = |(at, cells)| format!("{head}{},\"cells\":{cells}}}", at + 1);
        in_json(frame).enumerate().map(row).collect::<Vec<String>>()
    };
    let of_rows = tables.iter().flat_map(rows_of).collect();
    [
        ("table_row", of_rows),
        ("table_column", texts(&columns_table(tables))),
    ]
}
