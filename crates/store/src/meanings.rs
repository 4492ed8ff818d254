//! What columns mean: the one list that the page of the schema and the table of columns are made from.

const MEANINGS: &str = include_str!("../../../migrations/meanings.txt");

/// Its entries: a column, or a table and its column, with the meaning.
pub fn meanings() -> impl Iterator<Item = (&'static str, &'static str)> {
    let lines = MEANINGS.lines().filter(|line| !line.starts_with('#'));
    lines.filter_map(|line| line.split_once(": "))
}

/// What is said of a column of the first of these tables or views that has an entry of it; an empty name stands for all.
pub fn meaning(tables: &[&str], column: &str) -> Option<&'static str> {
    tables.iter().find_map(|table| {
        let is_of = |name: &str| name.split_once('.').unwrap_or(("", name)) == (*table, column);
        meanings().find(|(name, _)| is_of(name)).map(|(_, said)| said)
    })
}
