//! In what two databases differ about a row, as who measures would say it: of what, in what, and last the table.

use crate::store::{How, RowDiffers, meaning};

/// Of what a row is: a run or log by its name (with its revision where an earlier one is meant), a result by its run or group.
pub fn subject(differs: &RowDiffers) -> String {
    let key = differs.key.as_str();
    match differs.table.as_str() {
        "run" | "climate_log" => revision(key),
        "run_file" | "channel" | "climate_series" => revision(numbered(key).0),
        "result" => of_result(key).1,
        _ => key.to_owned(),
    }
}

/// In what it differs, a clause, with the table and its columns in brackets.
pub fn words(differs: &RowDiffers) -> String {
    let table = differs.table.as_str();
    let of = of_table(differs);
    match &differs.how {
        How::OnlyHere => format!("{of} is stored and not made again (table {table})"),
        How::OnlyThere => format!("{of} is made and not stored (table {table})"),
        How::Columns(columns) => {
            let mut named: Vec<String> = columns.iter().map(|column| in_column(table, column)).collect();
            named.dedup();
            format!(
                "{of} has another {} (table {table}: {})",
                named.join(", another "),
                columns.join(", ")
            )
        }
    }
}

/// What a row of a table is to who measures.
fn of_table(differs: &RowDiffers) -> String {
    let number = || numbered(&differs.key).1;
    match differs.table.as_str() {
        "run" => "the run".to_owned(),
        "run_file" => format!("its raw file {}", number()),
        "channel" => format!("its channel {}", number()),
        "climate_log" => "the climate log".to_owned(),
        "climate_series" => format!("its series {}", number()),
        "content" => "the copy of a raw file".to_owned(),
        "source_file" => "the file".to_owned(),
        "journal_line" => "what somebody said".to_owned(),
        "identity" => "the database".to_owned(),
        "result" => format!("the {}", of_result(&differs.key).0),
        other => format!("a row of {other}"),
    }
}

/// What a column holds, in a word or two; else what the list of columns says of it, or its name.
fn in_column(table: &str, column: &str) -> String {
    let known = match (table, column) {
        ("run", "tag_digest") => "statement of its tags",
        ("run", "tagging") => "set of tags, drive or climate",
        ("run" | "climate_log", "reading" | "data_hash" | "hash") | (_, "value_blob") => "set of readings",
        (_, "time_blob" | "time_of") => "set of times",
        (_, "excluded_blob") => "set of readings that are left out",
        ("result", "key") => "ground that it was made from",
        ("result", "document") => "set of numbers",
        ("result", "drawn") => "set of curves",
        ("journal_line", _) => "text",
        _ => meaning(&[table], column).unwrap_or(column),
    };
    known.to_owned()
}

/// The key of what hangs on a revision, and its number.
fn numbered(key: &str) -> (&str, &str) {
    key.rsplit_once(' ').unwrap_or((key, ""))
}

/// A name and its revision: the name, where it is the first one.
fn revision(key: &str) -> String {
    match key.rsplit_once(' ') {
        Some((name, "1")) => name.to_owned(),
        Some((name, revision)) => format!("{name} (revision {revision})"),
        None => key.to_owned(),
    }
}

/// The kind of a result, and its run or group.
fn of_result(key: &str) -> (&str, String) {
    let (kind, of) = key.split_once(' ').unwrap_or((key, ""));
    let kind = match kind {
        "modulus" => "analysis of the modulus",
        "group" | "run" => "diagnosis",
        other => other,
    };
    let is_named = kind == "diagnosis" && key.starts_with("group");
    (kind, if is_named { of.to_owned() } else { revision(of) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_said_by_its_run_first_and_its_table_last() {
        let differs = |table: &str, key: &str, how| RowDiffers {
            table: table.to_owned(),
            key: key.to_owned(),
            how,
        };
        let columns = |of: &[&str]| How::Columns(of.iter().map(|own| (*own).to_owned()).collect());
        for (differs, of, said) in [
            (
                differs("run", "runs/my run.csv 1", columns(&["tagging"])),
                "runs/my run.csv",
                "the run has another set of tags, drive or climate (table run: tagging)",
            ),
            (
                differs("channel", "runs/a.csv 3 0", columns(&["value_blob"])),
                "runs/a.csv (revision 3)",
                "its channel 0 has another set of readings (table channel: value_blob)",
            ),
            (
                differs("result", "fit runs/a.csv 1", columns(&["document", "drawn"])),
                "runs/a.csv",
                "the fit has another set of numbers, another set of curves (table result: document, drawn)",
            ),
            (
                differs("result", "group sample=S1,environment=air", How::OnlyHere),
                "sample=S1,environment=air",
                "the diagnosis is stored and not made again (table result)",
            ),
            (
                differs("journal_line", "7", How::OnlyThere),
                "7",
                "what somebody said is made and not stored (table journal_line)",
            ),
        ] {
            assert_eq!((subject(&differs).as_str(), words(&differs).as_str()), (of, said));
        }
    }
}
