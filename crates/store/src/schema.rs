//! Whether the database's own tables, indexes and triggers are those that this program makes.
//!
//! A trigger that somebody puts into the file changes numbers on their way in, and every checksum is then right. So what SQLite
//! keeps of the schema is held against what this program makes in an empty database, at every opening. Tables of others that
//! touch none of ours may stand beside; views are put right elsewhere ([`super::views`]).

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::OnceLock;

use rusqlite::Connection;

use super::StoreError;

/// Kind and name of what a schema holds.
type Named = (String, String);

/// Texts of what a schema holds, and of each the table that it belongs to.
type Schema = BTreeMap<Named, (String, String)>;

/// Refuses a database whose schema somebody changed.
pub(super) fn refuse_changed(connection: &Connection, path: &Path) -> Result<(), StoreError> {
    let failed = |e| StoreError::from_sql(path, "reading the schema", e);
    let (stored, wanted) = (of(connection).map_err(failed)?, wanted().map_err(failed)?);
    match first_difference(&stored, wanted) {
        None => Ok(()),
        Some(detail) => Err(StoreError::ChangedSchema {
            path: path.to_owned(),
            detail,
        }),
    }
}

/// What is not as this program makes it, in words.
fn first_difference(stored: &Schema, wanted: &Schema) -> Option<String> {
    let named = |(kind, name): &Named| format!("the {kind} \"{name}\"");
    let lost = wanted.iter().find_map(|(own, (sql, _))| match stored.get(own) {
        None => Some(format!("{} is missing", named(own))),
        Some((other, _)) if other != sql => Some(format!("{} is another one", named(own))),
        Some(_) => None,
    });
    lost.or_else(|| {
        let is_ours = |table: &String| wanted.contains_key(&("table".to_owned(), table.clone()));
        let foreign = |(own, (_, table)): &(&Named, &(String, String))| {
            !wanted.contains_key(own) && (own.0 == "trigger" || is_ours(table))
        };
        let (own, (_, table)) = stored.iter().find(foreign)?;
        Some(format!("{} on \"{table}\" is not of ieap", named(own)))
    })
}

/// What this program makes.
fn wanted() -> rusqlite::Result<&'static Schema> {
    static WANTED: OnceLock<Schema> = OnceLock::new();
    if let Some(wanted) = WANTED.get() {
        return Ok(wanted);
    }
    let connection = Connection::open_in_memory()?;
    connection.execute_batch(ieap_migrations::SCHEMA)?;
    let wanted = of(&connection)?;
    Ok(WANTED.get_or_init(|| wanted))
}

/// Tables, indexes and triggers of a database but SQLite's own.
fn of(connection: &Connection) -> rusqlite::Result<Schema> {
    let mut statement = connection.prepare(
        "SELECT type, name, sql, tbl_name FROM sqlite_schema WHERE type <> 'view' AND sql IS NOT NULL AND name NOT LIKE 'sqlite^_%' ESCAPE '^'",
    )?;
    let rows = statement.query_map([], |row| {
        let named = (row.get("type")?, row.get("name")?);
        Ok((named, (row.get("sql")?, row.get("tbl_name")?)))
    })?;
    rows.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Store;

    fn difference(sql: &str) -> Option<String> {
        let store = Store::in_memory().unwrap();
        store.connection.execute_batch(sql).unwrap();
        first_difference(&of(&store.connection).unwrap(), wanted().unwrap())
    }

    #[test]
    fn what_others_put_into_our_tables_is_found_and_what_stands_beside_is_not() {
        assert_eq!(difference(""), None);
        assert_eq!(
            difference("CREATE TABLE notes (text TEXT); CREATE INDEX n ON notes (text)"),
            None
        );
        let trigger = "CREATE TRIGGER t AFTER INSERT ON run BEGIN UPDATE run SET revision = 2; END";
        assert_eq!(
            difference(trigger).unwrap(),
            "the trigger \"t\" on \"run\" is not of ieap"
        );
        assert!(
            difference("CREATE UNIQUE INDEX u ON run (data_hash)")
                .unwrap()
                .contains("\"u\"")
        );
        let index = "CREATE TABLE x (a TEXT); CREATE TRIGGER y AFTER INSERT ON x BEGIN DELETE FROM run; END";
        assert!(
            difference(index).unwrap().contains("\"y\""),
            "a trigger reaches any table"
        );
        assert!(
            difference("ALTER TABLE run ADD COLUMN more TEXT")
                .unwrap()
                .contains("another one")
        );
    }

    #[test]
    fn a_database_that_another_changed_is_refused_by_whoever_opens_it() {
        let folder = tempfile::tempdir().unwrap();
        drop(Store::open(folder.path()).unwrap());
        let path = folder.path().join(crate::FILE_NAME);
        let connection = Connection::open(&path).unwrap();
        connection
            .execute_batch("CREATE TRIGGER t AFTER INSERT ON run BEGIN UPDATE run SET revision = 1; END")
            .unwrap();
        drop(connection);
        for refused in [
            Store::open(folder.path()).err(),
            Store::open_read_only(folder.path()).err(),
        ] {
            let refused = refused.unwrap();
            assert!(matches!(refused, StoreError::ChangedSchema { .. }), "{refused}");
        }
    }
}
