//! The rows of a file of results, each held against its checksum, and the file as a whole against the line that ends it.

use std::collections::BTreeMap;
use std::path::Path;

use crate::ingest::parquet_texts;
use crate::pipeline::PipelineError;
use crate::pipeline::fits::result::{END_SCHEMA, End, FitResult, SCHEMA};
use crate::system::fs;

/// Why a row cannot be used, with the run that it names.
pub type Refusal = (Option<String>, String);

/// A file of results.
#[derive(Debug, Default)]
pub struct Part {
    /// Its rows, in order.
    pub rows: Vec<Result<FitResult, Refusal>>,
    /// Why it is not the file that was written.
    pub damage: Vec<String>,
}

pub fn has_ending(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|found| found == ending)
}

impl Part {
    /// Reads a file. A Parquet file has no end of its own: who writes it, Spark for one, splits rows over files as it likes, and
    /// the runs of a row that is lost are still to be fitted.
    ///
    /// # Errors
    /// It cannot be read at all.
    pub fn read(file: &Path) -> Result<Part, PipelineError> {
        let bytes = fs::read(file).map_err(|source| PipelineError::File {
            path: file.to_owned(),
            doing: "reading results",
            source,
        })?;
        if !has_ending(file, "parquet") {
            return Ok(Part::of_lines(&bytes));
        }
        let table = parquet_texts::read(&bytes).map_err(|reason| PipelineError::BadArgument {
            what: "FILES",
            found: format!("{}: {reason}", file.display()),
            needed:
                "a Parquet file with the text columns run, data_hash, input_hash, code_version, fit, issue and checksum"
                    .to_owned(),
        })?;
        let rows = table.into_iter().map(of_columns);
        Ok(Part {
            rows: rows.map(|text| text.and_then(|text| row(&text))).collect(),
            damage: Vec::new(),
        })
    }

    /// Of lines of JSON. Several parts may stand in one file one after the other, each with its end.
    fn of_lines(bytes: &[u8]) -> Part {
        const MEND: &str = "bring the file over again, or fit that part again (`ieap fit --shard`)";
        let mut part = Part::default();
        let (mut rows, mut sum, mut has_ended) = (0, blake3::Hasher::new(), false);
        for line in bytes.split_inclusive(|byte| *byte == b'\n') {
            let end = end_of(line);
            has_ended = end.is_some() || has_ended && line.iter().all(u8::is_ascii_whitespace);
            match end {
                Some(end) if end == End::of(rows, &sum) => {}
                Some(end) if end.rows != rows => {
                    let wanted = end.rows;
                    part.damage
                        .push(format!("it has {rows} rows, {wanted} were written; {MEND}"));
                }
                Some(_) => part.damage.push(format!(
                    "its bytes are not those that were written (checksum); {MEND}"
                )),
                None => {
                    sum.update(line);
                    if !line.iter().all(u8::is_ascii_whitespace) {
                        rows += 1;
                        part.rows.push(of_line(line));
                    }
                    continue;
                }
            }
            (rows, sum) = (0, blake3::Hasher::new());
        }
        if !has_ended {
            part.damage
                .push(format!("its end is missing, so that rows may be; {MEND}"));
        }
        part
    }
}

/// What a line says as the end of a part; none where it is none.
fn end_of(line: &[u8]) -> Option<End> {
    let end: End = serde_json::from_slice(line).ok()?;
    (end.schema == END_SCHEMA).then_some(end)
}

fn of_line(line: &[u8]) -> Result<FitResult, Refusal> {
    match std::str::from_utf8(line) {
        Ok(text) => row(text),
        Err(_) => Err((
            None,
            "found bytes that are no UTF-8; needed a line of JSON".to_owned(),
        )),
    }
}

/// A row of texts by column as the JSON of a [`FitResult`]: `fit`, `issue` and `asked` hold JSON themselves.
fn of_columns(columns: BTreeMap<String, String>) -> Result<String, Refusal> {
    let run = columns.get("run").cloned();
    let mut object = serde_json::Map::new();
    object.insert("schema".to_owned(), SCHEMA.into());
    for (name, text) in columns {
        let value = match name.as_str() {
            "fit" | "issue" | "asked" => serde_json::from_str(&text)
                .map_err(|error| (run.clone(), format!("column {name}: {error}; needed JSON")))?,
            _ => text.into(),
        };
        object.insert(name, value);
    }
    Ok(serde_json::Value::Object(object).to_string())
}

/// The result that stands in a row, as it was written.
fn row(text: &str) -> Result<FitResult, Refusal> {
    let result: FitResult = serde_json::from_str(text).map_err(|error| {
        let read: Option<serde_json::Value> = serde_json::from_str(text).ok();
        let run = read
            .as_ref()
            .and_then(|value| value["run"].as_str())
            .map(str::to_owned);
        (run, format!("{error}; needed a result of a fit ({SCHEMA})"))
    })?;
    let refused = |reason: &str| Err((Some(result.run.clone()), reason.to_owned()));
    match result.outcome() {
        _ if result.schema != SCHEMA => {
            refused(&format!("found schema {:?}, needed {SCHEMA:?}", result.schema))
        }
        _ if result.checksum.is_empty() => refused(
            "it has no checksum: an earlier version of ieap wrote it, or it is damaged, and nothing tells which; needed a row that this version wrote; fit it again",
        ),
        _ if result.checksum != result.sum() => refused(
            "its checksum is not that of what it says: it was damaged on its way, or changed; bring the file over again, or fit it again",
        ),
        None => refused("needed either a fit or an issue that says why there is none"),
        Some(_) => Ok(result),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::{AskedFit, Issue};

    fn lines(names: &[&str]) -> Vec<u8> {
        let (mut text, mut sum) = (String::new(), blake3::Hasher::new());
        for name in names {
            let issue = Issue::warning("not-fitted", "too few readings");
            let result = FitResult::of(name, "d", "i", &AskedFit::default(), Err(issue));
            let line = serde_json::to_string(&result).unwrap() + "\n";
            sum.update(line.as_bytes());
            text += &line;
        }
        text += &(serde_json::to_string(&End::of(names.len(), &sum)).unwrap() + "\n");
        text.into_bytes()
    }

    fn read(bytes: &[u8]) -> (usize, usize, Vec<String>) {
        let part = Part::of_lines(bytes);
        let whole = part.rows.iter().filter(|row| row.is_ok()).count();
        (part.rows.len(), whole, part.damage)
    }

    #[test]
    fn whole_parts_are_whole_also_one_after_the_other_and_without_a_row() {
        let two = lines(&["a", "b"]);
        assert_eq!(read(&two), (2, 2, vec![]));
        assert_eq!(
            read(&[two.clone(), lines(&[]), lines(&["c"])].concat()),
            (3, 3, vec![])
        );
        assert_eq!(read(&lines(&[])), (0, 0, vec![]));
        assert_eq!(read(&[two, b"\n".to_vec()].concat()), (2, 2, vec![]));
    }

    #[test]
    fn a_row_that_is_lost_doubled_or_cut_off_is_told_and_the_others_are_read() {
        let whole = lines(&["a", "b", "c"]);
        let rows: Vec<&[u8]> = whole.split_inclusive(|byte| *byte == b'\n').collect();
        let told = |bytes: &[u8]| {
            let (rows, whole, damage) = read(bytes);
            (rows, whole, damage.join(" "))
        };
        for (bytes, found, said) in [
            (
                [rows[0], rows[2], rows[3]].concat(),
                (2, 2),
                "2 rows, 3 were written",
            ),
            (
                [rows[0], rows[1], rows[1], rows[2], rows[3]].concat(),
                (4, 4),
                "4 rows, 3 were written",
            ),
            (
                [rows[1], rows[0], rows[2], rows[3]].concat(),
                (3, 3),
                "not those that were written",
            ),
            (rows[..3].concat(), (3, 3), "its end is missing"),
            (whole[..rows[0].len() + 20].to_vec(), (2, 1), "its end is missing"),
            (Vec::new(), (0, 0), "its end is missing"),
            ([&whole[..], rows[0]].concat(), (4, 4), "its end is missing"),
        ] {
            let (count, taken, damage) = told(&bytes);
            assert_eq!((count, taken), found, "{damage}");
            assert!(damage.contains(said), "{damage}");
        }
    }

    #[test]
    fn a_row_without_a_checksum_or_with_another_is_refused_with_the_mend() {
        let text = String::from_utf8(lines(&["a"])).unwrap();
        let without = text.replace("\"checksum\"", "\"chacksum\"");
        let changed = text.replace("too few", "too raw");
        for (text, said) in [
            (without, "it has no checksum"),
            (changed, "its checksum is not that"),
        ] {
            let part = Part::of_lines(text.as_bytes());
            let (run, reason) = part.rows[0].as_ref().unwrap_err();
            assert_eq!(run.as_deref(), Some("a"));
            assert!(
                reason.contains(said) && reason.contains("fit it again"),
                "{reason}"
            );
        }
    }
}
