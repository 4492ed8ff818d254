//! The schema of a campaign's database, its number, and what its columns mean.

/// The schema, whose number is the schema version. Not even a comment inside a statement may change under a number: SQLite keeps
/// it with the table, and the store compares it.
pub const SCHEMA: &str = include_str!("0022_base.sql");

/// Schema version that this program writes.
pub const NEWEST: i64 = 22;

/// What columns mean, an entry a line: a column, or a table and its column, then `: ` and the meaning.
pub const MEANINGS: &str = include_str!("meanings.txt");

#[cfg(test)]
mod tests {
    use super::NEWEST;

    #[test]
    fn the_number_of_the_file_is_the_schema_version() {
        let files = std::fs::read_dir(env!("CARGO_MANIFEST_DIR")).unwrap();
        let names = files.map(|file| file.unwrap().file_name().into_string().unwrap());
        let names: Vec<_> = names.filter(|name| name.ends_with(".sql")).collect();
        assert_eq!(names, [format!("{NEWEST:04}_base.sql")]);
    }
}
