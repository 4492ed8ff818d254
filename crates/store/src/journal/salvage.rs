//! What a database that may be damaged and the journal beside it know together, for a rebuilding.

use std::path::Path;

use rusqlite::{Connection, OpenFlags};

use super::bring_up::{completed, parted};
use super::entry::Line;
use super::file::{hold, opened_in};
use super::{Compared, Found, line, path_in, read};
use crate::error::plain;
use crate::{FILE_NAME, StoreError};
use ieap_system::fs;

/// What both know.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Union {
    /// The journal as it was found; none where there was none.
    pub found: Option<Found>,
    /// What only the database had; the journal has it now.
    pub of_database: Vec<Line>,
    /// Whether there are lines that neither has.
    pub lacks_lines: bool,
    /// Why lines of the database could not be read, where that is so.
    pub unread: Option<String>,
}

/// Brings into the journal of the campaign in `folder` what only its database has, as far as that can be read; what is
/// damaged in it is left out, and the journal as it was is kept under another name. `owner` is the id of the database that
/// belongs there: another one is not asked.
///
/// # Errors
/// See [`StoreError`]; [`StoreError::Parted`] where they are of two courses.
pub fn union(folder: &Path, owner: Option<&str>) -> Result<Union, StoreError> {
    let held = hold(folder)?;
    let (stored, unread) = match lines_of(&folder.join(FILE_NAME), owner) {
        Ok((lines, unread)) => (lines, unread),
        Err(error) => (Vec::new(), Some(plain(&error))),
    };
    let found = read(folder)?;
    let known = found.clone().unwrap_or_default();
    let compared = Compared::of(&stored, &known).map_err(|detail| parted(folder, detail))?;
    let is_damaged = !known.damaged.is_empty();
    if !compared.of_database.is_empty() || (is_damaged && path_in(folder).exists()) {
        completed(folder, opened_in(folder, held)?, &known, &compared)?;
    }
    Ok(Union {
        found,
        lacks_lines: !compared.missing.is_empty(),
        unread,
        of_database: compared.of_database,
    })
}

/// The lines that can be read in a database, whatever is wrong with the rest of it, and why not all could be.
fn lines_of(path: &Path, owner: Option<&str>) -> rusqlite::Result<(Vec<Line>, Option<String>)> {
    match fs::symlink_metadata(path) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok((Vec::new(), None)),
        Err(error) => return Ok((Vec::new(), Some(error.to_string()))),
        Ok(_) => {}
    }
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let connection = Connection::open_with_flags(path, flags)?;
    let id = connection.query_row("SELECT id FROM identity", [], |row| row.get::<_, String>(0));
    if id.is_ok_and(|id| owner.is_some_and(|owner| owner != id)) {
        return Ok((Vec::new(), None));
    }
    let (mut lines, mut unread) = (Vec::new(), None);
    // From both ends: a page that cannot be read ends each.
    for order in ["", "DESC"] {
        let mut statement =
            connection.prepare(&format!("SELECT n, line FROM journal_line ORDER BY n {order}"))?;
        let mut rows = statement.query([])?;
        loop {
            match rows.next() {
                Ok(Some(row)) => match line_in(row) {
                    Some(line) => lines.push(line),
                    None => unread = Some("a line of the journal in it is damaged".to_owned()),
                },
                Ok(None) => break,
                Err(error) => {
                    unread = Some(plain(&error));
                    break;
                }
            }
        }
    }
    lines.sort_by_key(|line| line.n);
    lines.dedup_by_key(|line| line.n);
    Ok((lines, unread))
}

fn line_in(row: &rusqlite::Row<'_>) -> Option<Line> {
    let text = row.get_ref("line").ok()?.as_bytes().ok()?;
    line::read(text).ok()
}
