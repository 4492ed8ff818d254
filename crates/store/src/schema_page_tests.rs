//! The page of the book that tells what every column of the database is: made from the schema that the migrations give, so
//! that it cannot tell of another.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use rusqlite::Connection;

use super::Store;
use super::meanings::meanings;

/// What stands above this line on the page is written by hand.
const BEGIN: &str = "<!-- From here on made by a test: cargo unit -p ieap-store schema_page -->";
/// Sets the page anew in place of holding it.
const UPDATE: &str = "IEAP_UPDATE_EXPECTED";

/// The comment behind a column in the text of its table.
fn comment<'a>(sql: &'a str, column: &str) -> Option<&'a str> {
    let is_of = |line: &&str| {
        line.trim_start()
            .strip_prefix(column)
            .is_some_and(|rest| rest.starts_with(' '))
    };
    let line = sql.lines().find(is_of)?;
    line.split_once("-- ").map(|(_, comment)| comment.trim())
}

/// The comment above a view, and above a table in the migrations.
fn about(name: &str, kind: &str) -> String {
    let texts = [ieap_migrations::SCHEMA, super::views::VIEWS].into_iter();
    let head = format!("CREATE {} {name} ", kind.to_uppercase());
    let mut found = texts.filter_map(|text| {
        let at = text.find(&head)?;
        let above: Vec<&str> = text[..at]
            .lines()
            .rev()
            .skip_while(|line| line.is_empty())
            .take_while(|line| line.starts_with("--"))
            .collect();
        let words = above
            .iter()
            .rev()
            .map(|line| line.trim_start_matches("--").trim());
        Some(words.collect::<Vec<_>>().join(" "))
    });
    found.find(|words| !words.is_empty()).unwrap_or_default()
}

fn section(connection: &Connection, kind: &str, name: &str, sql: &str, page: &mut String) -> Vec<String> {
    let meanings: BTreeMap<&str, &str> = meanings().collect();
    let mut lacking = Vec::new();
    let _ = writeln!(page, "\n### {name}\n{}\n", about(name, kind));
    let mut statement = connection.prepare(&format!("PRAGMA table_info({name})")).unwrap();
    let columns = statement.query_map([], |row| row.get::<_, String>("name"));
    for column in columns.unwrap() {
        let column = column.unwrap();
        let own = format!("{name}.{column}");
        let known = meanings.get(own.as_str()).copied();
        let said = known
            .or_else(|| comment(sql, &column))
            .or_else(|| meanings.get(column.as_str()).copied());
        let Some(said) = said else {
            lacking.push(own);
            continue;
        };
        match page.strip_suffix(&format!(": {said}\n")) {
            // Columns of one meaning, as of one that another view has, share a line.
            Some(line) => *page = format!("{line}, `{column}`: {said}\n"),
            None => page.push_str(&format!("- `{column}`: {said}\n")),
        }
    }
    lacking
}

/// The part of the page that is made, and what it leaves out: the columns of tables.
fn made() -> (String, String) {
    let store = Store::in_memory().unwrap();
    let sql = "SELECT type, name, sql FROM sqlite_schema
               WHERE type IN ('table', 'view') AND name NOT LIKE 'sqlite_%' ORDER BY type DESC, name";
    let mut statement = store.connection.prepare(sql).unwrap();
    let rows = statement.query_map([], |row| {
        Ok((row.get("type")?, row.get("name")?, row.get("sql")?))
    });
    let rows: Vec<(String, String, String)> = rows.unwrap().map(Result::unwrap).collect();
    let mut page = format!("{BEGIN}\n");
    let (mut lacking, mut columns_of_tables) = (Vec::new(), String::new());
    page += "\n## Views\n";
    for (kind, name, sql) in rows.iter().filter(|(kind, ..)| kind == "view") {
        lacking.extend(section(&store.connection, kind, name, sql, &mut page));
    }
    page += "\n## Tables behind the views\n\n";
    for (kind, name, sql) in rows.iter().filter(|(kind, ..)| kind == "table") {
        // Every column has a meaning, though the page shows those of views alone.
        lacking.extend(section(
            &store.connection,
            kind,
            name,
            sql,
            &mut columns_of_tables,
        ));
        let _ = writeln!(page, "- `{name}`: {}", about(name, kind));
    }
    assert!(
        lacking.is_empty(),
        "columns without a meaning; write one into migrations/meanings.txt: {lacking:?}"
    );
    (page, columns_of_tables)
}

fn path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/schema.md")
}

#[test]
fn schema_page_tells_of_every_column() {
    let page = std::fs::read_to_string(path()).unwrap();
    let by_hand = page.split(BEGIN).next().unwrap_or_default();
    let whole = format!("{by_hand}{}", made().0);
    if std::env::var_os(UPDATE).is_some() {
        std::fs::write(path(), whole).unwrap();
    } else {
        assert!(
            page == whole,
            "docs/schema.md tells of another schema: {UPDATE}=1 cargo unit -p ieap-store schema_page"
        );
    }
}

#[test]
fn no_meaning_is_of_a_column_that_is_gone() {
    let (page, columns_of_tables) = made();
    let made = [ieap_migrations::SCHEMA, super::views::VIEWS].concat();
    for (name, _) in meanings() {
        let (table, column) = name.split_once('.').unwrap_or(("", name));
        // Those of tables that are exported are held where these are made.
        let is_here = |table: &str| {
            made.contains(&format!("CREATE TABLE {table} "))
                || made.contains(&format!("CREATE VIEW {table} "))
        };
        if !table.is_empty() && !is_here(table) {
            continue;
        }
        let row = format!("`{column}`");
        assert!(page.contains(&row) || columns_of_tables.contains(&row), "{name}");
    }
}
