//! Views for people, and the mark by which other programs know the file: neither is data, both are put right at every opening
//! for writing.

use std::collections::BTreeMap;

use rusqlite::{Connection, TransactionBehavior};

/// The views' text, in the order in which they can be made.
pub(super) const VIEWS: &str = include_str!("views.sql");

/// `PRAGMA application_id`: "ieap" in ASCII, for `file` and whoever else asks.
pub(super) const APPLICATION_ID: i32 = i32::from_be_bytes(*b"ieap");

/// Whether there is a view of that name.
pub fn has_view(name: &str) -> bool {
    VIEWS.contains(&format!("CREATE VIEW {name} "))
}

/// Makes the views of this program and marks the database, where that is not done yet.
pub(super) fn put(connection: &mut Connection) -> rusqlite::Result<()> {
    if is_put(connection)? {
        return Ok(());
    }
    let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
    drop_all(&transaction)?;
    transaction.execute_batch(VIEWS)?;
    transaction.pragma_update(None, "application_id", APPLICATION_ID)?;
    transaction.commit()
}

fn drop_all(connection: &Connection) -> rusqlite::Result<()> {
    for name in stored(connection)?.keys() {
        connection.execute_batch(&format!("DROP VIEW \"{}\"", name.replace('"', "\"\"")))?;
    }
    Ok(())
}

fn is_put(connection: &Connection) -> rusqlite::Result<bool> {
    let id: i32 = connection.pragma_query_value(None, "application_id", |row| row.get(0))?;
    Ok(id == APPLICATION_ID && stored(connection)? == wanted())
}

/// Views in the database with their text.
fn stored(connection: &Connection) -> rusqlite::Result<BTreeMap<String, String>> {
    let mut statement = connection.prepare("SELECT name, sql FROM sqlite_schema WHERE type = 'view'")?;
    let rows = statement.query_map([], |row| Ok((row.get(0)?, row.get(1)?)))?;
    rows.collect()
}

/// Views of this program with their text, as the database would store it.
fn wanted() -> BTreeMap<String, String> {
    let statements = VIEWS.split(";\n").filter_map(|part| {
        let start = part.find("CREATE VIEW ")?;
        let text = part[start..].trim_end_matches([';', '\n']).to_owned();
        Some((text.split_whitespace().nth(2)?.to_owned(), text))
    });
    statements.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Store;

    #[test]
    fn views_are_made_once_and_again_where_they_are_others() {
        let mut store = Store::in_memory().unwrap();
        let connection = &mut store.connection;
        assert_eq!(wanted().len(), 10);
        assert!(is_put(connection).unwrap());
        connection
            .execute_batch("DROP VIEW tags_view; CREATE VIEW tags_view AS SELECT 1 AS other")
            .unwrap();
        assert!(!is_put(connection).unwrap());
        put(connection).unwrap();
        assert!(is_put(connection).unwrap());
        for name in wanted().keys() {
            let sql = format!("SELECT count(*) FROM {name}");
            let rows: i64 = connection.query_row(&sql, [], |row| row.get(0)).unwrap();
            assert_eq!(rows, 0, "{name}");
        }
    }

    #[test]
    fn units_of_readings_are_those_of_the_program() {
        for quantity in ieap_domain::Quantity::ALL {
            let (key, unit) = (quantity.key(), quantity.unit());
            let case = format!("WHEN '{key}' THEN '{unit}'");
            assert!(VIEWS.contains(&case) || unit.is_empty(), "{key}");
        }
    }

    #[test]
    fn units_of_parameters_are_those_that_their_keys_end_in() {
        let store = Store::in_memory().unwrap();
        let rule =
            &VIEWS[VIEWS.find("    CASE\n        WHEN key").unwrap()..VIEWS.find("    END AS unit").unwrap()];
        for (ending, unit) in ieap_domain::UNITS {
            let sql = format!("SELECT {rule} END FROM (SELECT 'x{ending}' AS key)");
            let said: String = store.connection.query_row(&sql, [], |row| row.get(0)).unwrap();
            assert_eq!(said, unit, "{ending}");
        }
    }
}
