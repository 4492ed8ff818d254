//! What a database that may be damaged and the journal beside it know together, for a rebuilding.

use std::path::Path;

use rusqlite::{Connection, OpenFlags};

use super::bring_up::{completed, parted};
use super::entry::Line;
use super::file::locked;
use super::{Compared, Found, line, path_in, read};
use crate::{FILE_NAME, StoreError};

/// What both know.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Union {
    /// The journal as it was found; none where there was none.
    pub found: Option<Found>,
    /// What only the database had; the journal has it now.
    pub of_database: Vec<Line>,
    /// Whether there are lines that neither has.
    pub lacks_lines: bool,
}

/// Brings into the journal of the campaign in `folder` what only its database has, as far as that can be read; what is
/// damaged in it is left out, and the journal as it was is kept under another name. `owner` is the id of the database that
/// belongs there: another one is not asked.
///
/// # Errors
/// See [`StoreError`]; [`StoreError::Parted`] where they are of two courses.
pub fn union(folder: &Path, owner: Option<&str>) -> Result<Union, StoreError> {
    let stored = lines_of(&folder.join(FILE_NAME), owner).unwrap_or_default();
    let found = read(folder)?;
    let known = found.clone().unwrap_or_default();
    let compared = Compared::of(&stored, &known).map_err(|detail| parted(folder, detail))?;
    let is_damaged = !known.damaged.is_empty();
    if !compared.of_database.is_empty() || (is_damaged && path_in(folder).exists()) {
        completed(folder, locked(folder)?, &known, &compared)?;
    }
    Ok(Union {
        found,
        lacks_lines: !compared.missing.is_empty(),
        of_database: compared.of_database,
    })
}

/// The lines that can be read in a database, whatever is wrong with the rest of it.
fn lines_of(path: &Path, owner: Option<&str>) -> rusqlite::Result<Vec<Line>> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let connection = Connection::open_with_flags(path, flags)?;
    let id = connection.query_row("SELECT id FROM identity", [], |row| row.get::<_, String>(0));
    if id.is_ok_and(|id| owner.is_some_and(|owner| owner != id)) {
        return Ok(Vec::new());
    }
    let mut lines = Vec::new();
    // From both ends: a page that cannot be read ends each.
    for order in ["", "DESC"] {
        let mut statement =
            connection.prepare(&format!("SELECT line FROM journal_line ORDER BY n {order}"))?;
        let mut rows = statement.query([])?;
        while let Ok(Some(row)) = rows.next() {
            let read = row.get_ref(0).ok().and_then(|text| text.as_bytes().ok());
            lines.extend(read.and_then(|text| line::read(text).ok()));
        }
    }
    lines.sort_by_key(|line| line.n);
    lines.dedup_by_key(|line| line.n);
    Ok(lines)
}
