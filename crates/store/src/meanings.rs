//! What columns mean: the one list that the page of the schema and the table of columns are made from.

use std::collections::HashMap;
use std::sync::LazyLock;

/// Its entries: a column, or a table and its column, with the meaning.
pub fn meanings() -> impl Iterator<Item = (&'static str, &'static str)> {
    let lines = ieap_migrations::MEANINGS
        .lines()
        .filter(|line| !line.starts_with('#'));
    lines.filter_map(|line| line.split_once(": "))
}

/// What is said of a column of the first of these tables or views that has an entry of it; an empty name stands for all.
pub fn meaning(tables: &[&str], column: &str) -> Option<&'static str> {
    // Of two entries of one name the first counts.
    static BY_NAME: LazyLock<HashMap<(&str, &str), &str>> = LazyLock::new(|| {
        let entries = meanings().collect::<Vec<_>>().into_iter().rev();
        let named = entries.map(|(name, said)| (name.split_once('.').unwrap_or(("", name)), said));
        named.collect()
    });
    let mut found = tables.iter().filter_map(|table| BY_NAME.get(&(*table, column)));
    found.next().copied()
}
