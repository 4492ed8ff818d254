//! What the database holds at one moment.

use rusqlite::Connection;

/// What the database holds at one moment, for as long as this lives: another program may change it between two queries.
/// Within a transaction it is that of the transaction.
#[derive(Debug)]
pub struct Snapshot<'c>(Option<&'c Connection>);

impl Snapshot<'_> {
    /// Begins with the next query.
    pub(super) fn of(connection: &Connection) -> rusqlite::Result<Snapshot<'_>> {
        if !connection.is_autocommit() {
            return Ok(Snapshot(None));
        }
        connection.prepare_cached("BEGIN")?.execute([])?;
        Ok(Snapshot(Some(connection)))
    }
}

impl Drop for Snapshot<'_> {
    fn drop(&mut self) {
        // Nothing was changed: what fails here leaves the snapshot to the end of the connection.
        let end = self.0.map(|connection| connection.prepare_cached("COMMIT"));
        if let Some(Ok(mut end)) = end {
            let _ = end.execute([]);
        }
    }
}
