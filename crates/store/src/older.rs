//! What a database of an earlier schema names in the archive, which every schema says in the same words.

use std::path::Path;

use rusqlite::OpenFlags;

use super::StoreError;
use super::new_run::RunContent;
use super::place::FILE_NAME;
use super::store::open_to_read;

/// The raw files that the database of the campaign in `folder` names, whatever its schema is. Rows are not held against their
/// hashes.
///
/// # Errors
/// See [`StoreError`].
pub fn raw_files_named(folder: &Path) -> Result<Vec<RunContent>, StoreError> {
    let path = folder.join(FILE_NAME);
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let (connection, _) = open_to_read(&path, &path.to_string_lossy(), flags)?;
    let list = || -> rusqlite::Result<Vec<RunContent>> {
        let mut statement =
            connection.prepare("SELECT hash, size_bytes, archive_path FROM content ORDER BY hash")?;
        let rows = statement.query_map([], |row| {
            Ok(RunContent {
                path: row.get("archive_path")?,
                hash: row.get("hash")?,
                size_bytes: row.get::<_, i64>("size_bytes")?.unsigned_abs(),
                archive_path: row.get("archive_path")?,
            })
        })?;
        rows.collect()
    };
    list().map_err(|error| StoreError::from_sql(&path, "listing the raw files that it names", error))
}
