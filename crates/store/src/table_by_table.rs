//! A database against another that was made anew: table by table, row by row, column by column, as the schema has them.
//!
//! Nothing here knows a table by name but for what is left out ([`LEFT_OUT`], [`ROWS_LEFT_OUT`]) and what two columns are
//! compared as ([`COMPARED_AS`]). A row is known by the columns that are unique in its table; where it hangs on a row of another,
//! by what that one is known by, for row ids are others in every database.

use std::collections::BTreeMap;

use super::rows::{RowHash, add_value, finished};
use super::{ResultKind, StepError, Store, StoreError};

/// Columns that two databases need not have in common: table (`*`: every one), column (`*`: the whole table), why.
pub const LEFT_OUT: [(&str, &str, &str); 19] = [
    (
        "*",
        "row_hash",
        "hash of the row with its times, which every reading holds against the row",
    ),
    ("list_sum", "*", "sums of those hashes"),
    ("change_count", "*", "how often the database changed"),
    ("shown", "*", "rows for SQL, made anew with every report"),
    ("shown_of", "*", "what those were made from"),
    ("unread_file", "*", "what the system said at the last look"),
    (
        "profile",
        "*",
        "profiles of earlier readings; a rebuilding reads with those of today",
    ),
    ("content", "ingested_at", "when it was stored"),
    ("run", "ingested_at", "when it was stored"),
    ("climate_log", "ingested_at", "when it was stored"),
    ("source_file", "size_bytes", "of the last look"),
    ("source_file", "modified_ns", "of the last look"),
    ("source_file", "inode", "of the last look"),
    ("source_file", "changed_ns", "of the last look"),
    ("source_file", "reader", "of the last look"),
    ("source_file", "missing_since", "of the last look"),
    ("result", "made_at", "when it was made"),
    ("source_file", "state", "of the last look"),
    (
        "result",
        "version",
        "of the program that made it: the same numbers are asked for",
    ),
];

/// Rows that a rebuilding does not bring back: table, which rows are compared (SQL), why not the others.
const ROWS_LEFT_OUT: [(&str, &str, &str); 4] = [
    (
        "source_file",
        "state IN ('run', 'alias', 'log')",
        "files of no run or log: the last look decided, and the next one does",
    ),
    ("result", "superseded_at IS NULL", "earlier results"),
    (
        "channel",
        "(SELECT superseded_at FROM run WHERE run.id = run_id) IS NULL",
        "earlier revisions, as an earlier reader had them",
    ),
    (
        "climate_series",
        "(SELECT superseded_at FROM climate_log WHERE climate_log.id = log_id) IS NULL",
        "earlier revisions, as an earlier reader had them",
    ),
];

/// What of an earlier revision is compared: the rest is as an earlier reader and the tags of then had it.
const OF_EARLIER: [&str; 5] = ["path", "revision", "superseded_at", "kind", "hash"];

/// Columns that are compared as something else: when is left out, and of a fit that came from elsewhere nothing that is drawn is
/// stored.
const COMPARED_AS: [(&str, &str, &str); 4] = [
    ("run", "superseded_at", "superseded_at IS NOT NULL"),
    ("climate_log", "superseded_at", "superseded_at IS NOT NULL"),
    (
        "result",
        "document",
        "CASE WHEN json_valid(document) THEN json_remove(document, '$.found.drawn_hash') ELSE document END",
    ),
    ("result", "drawn", "CASE kind WHEN 'fit' THEN NULL ELSE drawn END"),
];

/// A row that is not the same in both.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct RowDiffers {
    /// Its table.
    pub table: String,
    /// What it is known by: the values of its unique columns.
    pub key: String,
    /// In what.
    pub how: How,
}

/// In what two databases differ about a row.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum How {
    /// These columns have other values.
    Columns(Vec<String>),
    /// The other one lacks it.
    OnlyHere,
    /// Only the other one has it.
    OnlyThere,
}

/// A table as the schema has it, with what of it is compared.
struct Table {
    name: String,
    /// Unique columns, as SQL that gives a text.
    key: Vec<String>,
    /// The other ones that are compared: name and SQL.
    columns: Vec<(String, String)>,
}

/// Hashes of the values of a row, in the order of the columns.
type Row = Vec<RowHash>;

impl Store {
    /// Rows that are not the same in `other`, a database of the same schema, but for what is left out; of results those of
    /// `kinds`. Gives them with the names of the tables that were compared.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn table_by_table(
        &self,
        other: &Store,
        kinds: &[ResultKind],
    ) -> Result<(Vec<RowDiffers>, Vec<String>), StoreError> {
        const DOING: &str = "comparing two databases";
        let (_moment, _other_moment) = (self.snapshot()?, other.snapshot()?);
        let (mut differing, mut compared) = (Vec::new(), Vec::new());
        for table in tables(&self.connection).map_err(self.named(DOING))? {
            let here = table.rows(&self.connection, kinds).map_err(self.named(DOING))?;
            let there = table.rows(&other.connection, kinds).map_err(other.named(DOING))?;
            differing.extend(table.differing(&here, &there));
            compared.push(table.name);
        }
        differing.sort();
        Ok((differing, compared))
    }
}

/// Whether a column, or `*` a whole table, is left out.
fn is_left_out(table: &str, column: &str) -> bool {
    LEFT_OUT
        .iter()
        .any(|(of, what, _)| (*of == table || *of == "*") && *what == column)
}

/// Every table of the schema that is compared.
fn tables(connection: &rusqlite::Connection) -> Result<Vec<Table>, StepError> {
    let names = texts(
        connection,
        "SELECT name FROM sqlite_schema WHERE type = 'table' AND name NOT LIKE 'sqlite_%' ORDER BY name",
        "",
    )?;
    names
        .into_iter()
        .filter(|name| !is_left_out(name, "*"))
        .map(|name| table(connection, name))
        .collect()
}

fn table(connection: &rusqlite::Connection, name: String) -> Result<Table, StepError> {
    let columns = texts(connection, "SELECT name FROM pragma_table_info(?1)", &name)?;
    let unique = unique(connection, &name)?;
    let is_earlier = columns.iter().any(|column| column == "superseded_at") && name != "result";
    let mut key = Vec::new();
    for column in &unique {
        key.push(known_by(connection, &name, column)?);
    }
    let of = |column: &String| {
        let row_id = column == "id" && !unique.is_empty() && name != "identity";
        if row_id || unique.contains(column) || is_left_out(&name, column) {
            return None;
        }
        let changed = COMPARED_AS
            .iter()
            .find(|(of, what, _)| *of == name && what == column);
        let sql = changed.map_or_else(|| format!("\"{column}\""), |(_, _, sql)| (*sql).to_owned());
        let sql = if is_earlier && !OF_EARLIER.contains(&column.as_str()) {
            format!("CASE WHEN superseded_at IS NULL THEN {sql} END")
        } else {
            sql
        };
        Some((column.clone(), sql))
    };
    let columns = columns.iter().filter_map(of).collect();
    Ok(Table { name, key, columns })
}

/// The columns of all unique indices of a table; where there is none, its primary key.
fn unique(connection: &rusqlite::Connection, table: &str) -> Result<Vec<String>, StepError> {
    let of_indices = texts(
        connection,
        "SELECT info.name FROM pragma_index_list(?1) AS list, pragma_index_info(list.name) AS info
         WHERE list.\"unique\" ORDER BY list.seq DESC, info.seqno",
        table,
    )?;
    let mut found: Vec<String> = Vec::new();
    for column in of_indices {
        if !found.contains(&column) {
            found.push(column);
        }
    }
    if found.is_empty() {
        found = texts(
            connection,
            "SELECT name FROM pragma_table_info(?1) WHERE pk > 0 ORDER BY pk",
            table,
        )?;
    }
    Ok(found)
}

/// SQL of what a column of a key says: where it is the row id of another table, what that row is known by.
fn known_by(connection: &rusqlite::Connection, table: &str, column: &str) -> Result<String, StepError> {
    let parents = "SELECT \"table\" FROM pragma_foreign_key_list(?1) WHERE \"to\" = 'id' AND \"from\" = ";
    let parent = texts(connection, &format!("{parents}'{column}'"), table)?;
    let Some(parent) = parent.first() else {
        return Ok(format!("coalesce({table}.\"{column}\" || ' ', '')"));
    };
    let mut of_parent = Vec::new();
    for column in unique(connection, parent)? {
        of_parent.push(known_by(connection, parent, &column)?);
    }
    let of_parent = of_parent.join(" || ");
    Ok(format!(
        "coalesce((SELECT {of_parent} FROM {parent} WHERE {parent}.id = {table}.\"{column}\"), '')"
    ))
}

fn texts(connection: &rusqlite::Connection, sql: &str, of: &str) -> Result<Vec<String>, StepError> {
    let mut statement = connection.prepare(sql)?;
    let parameters = [of];
    let parameters = &parameters[..statement.parameter_count()];
    let rows = statement.query_map(rusqlite::params_from_iter(parameters), |row| row.get(0))?;
    Ok(rows.collect::<Result<_, _>>()?)
}

impl Table {
    fn rows(
        &self,
        connection: &rusqlite::Connection,
        kinds: &[ResultKind],
    ) -> Result<BTreeMap<String, Row>, StepError> {
        let key = self.key.join(" || ");
        let columns: String = self.columns.iter().map(|(_, sql)| format!(", {sql}")).collect();
        let mut which: Vec<String> = (ROWS_LEFT_OUT.iter())
            .filter(|(of, _, _)| *of == self.name)
            .map(|(_, which, _)| (*which).to_owned())
            .collect();
        if self.name == "result" {
            let kinds: Vec<String> = kinds.iter().map(|kind| format!("'{}'", kind.key())).collect();
            which.push(format!("kind IN ({})", kinds.join(", ")));
        }
        which.push("1".to_owned());
        let sql = format!(
            "SELECT trim({key}){columns} FROM {} WHERE {}",
            self.name,
            which.join(" AND ")
        );
        let mut statement = connection.prepare(&sql)?;
        let mut rows = statement.query([])?;
        let mut found = BTreeMap::new();
        while let Some(row) = rows.next()? {
            let mut values = Vec::with_capacity(self.columns.len());
            for column in 1..=self.columns.len() {
                let mut hasher = blake3::Hasher::new();
                add_value(&mut hasher, row.get_ref(column)?);
                values.push(finished(&hasher));
            }
            found.insert(row.get(0)?, values);
        }
        Ok(found)
    }

    fn differing(&self, here: &BTreeMap<String, Row>, there: &BTreeMap<String, Row>) -> Vec<RowDiffers> {
        let row = |key: &String, how| RowDiffers {
            table: self.name.clone(),
            key: key.clone(),
            how,
        };
        let mut found = Vec::new();
        for (key, values) in here {
            match there.get(key) {
                None => found.push(row(key, How::OnlyHere)),
                Some(others) => {
                    let columns = self.columns.iter().zip(values.iter().zip(others));
                    let columns: Vec<String> = columns
                        .filter(|(_, (one, other))| one != other)
                        .map(|((name, _), _)| name.clone())
                        .collect();
                    if !columns.is_empty() {
                        found.push(row(key, How::Columns(columns)));
                    }
                }
            }
        }
        // Of a file that the last look refused, a rebuilding knows what it was before.
        if self.name != "source_file" {
            let more = there.keys().filter(|key| !here.contains_key(*key));
            found.extend(more.map(|key| row(key, How::OnlyThere)));
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::HandTag;

    #[test]
    fn databases_that_say_the_same_are_the_same_and_a_word_more_is_told_with_its_line() {
        let (mut one, mut other) = (Store::in_memory().unwrap(), Store::in_memory().unwrap());
        for (store, at) in [
            (&mut one, "2026-01-01T00:00:00Z"),
            (&mut other, "2026-02-02T00:00:00Z"),
        ] {
            store.take_identity(at, "a").unwrap();
        }
        let compared = |one: &Store, other: &Store| one.table_by_table(other, &[ResultKind::Fit]).unwrap();
        let (differing, tables) = compared(&one, &other);
        assert_eq!(differing, []);
        assert!(tables.len() > 9, "{tables:?}");
        let tag = HandTag {
            run_path: "runs/a.csv".into(),
            key: "note".into(),
            value: Some("wet".into()),
            set_by: "tester".into(),
            set_at: "2026-01-01T00:00:00Z".into(),
        };
        one.add_hand_tags("2026-01-01T00:00:00Z", &[tag]).unwrap();
        let row = |how| RowDiffers {
            table: "journal_line".to_owned(),
            key: "1".to_owned(),
            how,
        };
        assert_eq!(compared(&one, &other).0, [row(How::OnlyHere)]);
        assert_eq!(compared(&other, &one).0, [row(How::OnlyThere)]);
        other.take_identity("2026-02-02T00:00:00Z", "b").unwrap();
        let found = compared(&other, &one).0;
        assert_eq!(found[0].how, How::Columns(vec!["id".to_owned()]));
    }
}
