//! The rows of a file of results, each held against its checksum.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::Value;

use super::told::other_told;
use crate::ingest::parquet_rows;
use crate::pipeline::fits::result::{FitResult, SCHEMA};
use crate::pipeline::{PipelineError, failed};
use crate::system::fs;

/// Why a row cannot be used, with the run that it names.
pub type Refusal = (Option<String>, String);

/// Reads the rows of a Parquet file, in order. It has no end of its own: who writes it, Spark for one, splits rows over files as it
/// likes, and the runs of a row that is lost are still to be fitted.
///
/// # Errors
/// It cannot be read at all.
pub fn read(file: &Path) -> Result<Vec<Result<FitResult, Refusal>>, PipelineError> {
    let bytes = fs::read(file).map_err(failed(file, "reading results"))?;
    let table = parquet_rows::read(&bytes).map_err(|reason| PipelineError::BadArgument {
        what: "FILES",
        found: format!("{}: {reason}", file.display()),
        needed: "a Parquet file with the text columns run, data_hash, input_hash, code_version, fit, issue and checksum"
            .to_owned(),
    })?;
    Ok(table.iter().map(of_columns).collect())
}

/// The result of a row, which no column of the row contradicts.
fn of_columns(columns: &BTreeMap<String, Value>) -> Result<FitResult, Refusal> {
    let result = row(&as_json(columns)?)?;
    match other_told(columns, &result) {
        None => Ok(result),
        Some(column) => Err((
            Some(result.run),
            format!(
                "its column {column} says something else than the fit that its checksum is of: it was damaged on its way, or changed; bring the file over again, or fit it again"
            ),
        )),
    }
}

/// The texts of a row as the JSON of a [`FitResult`]: `fit`, `issue` and `asked` hold JSON themselves.
fn as_json(columns: &BTreeMap<String, Value>) -> Result<String, Refusal> {
    let text = |name: &str| columns.get(name).and_then(Value::as_str);
    let run = text("run").map(str::to_owned);
    let mut object = serde_json::Map::new();
    object.insert("schema".to_owned(), SCHEMA.into());
    for (name, text) in columns.keys().filter_map(|name| Some((name, text(name)?))) {
        let value = match name.as_str() {
            "fit" | "issue" | "asked" => serde_json::from_str(text)
                .map_err(|error| (run.clone(), format!("column {name}: {error}; needed JSON")))?,
            _ => text.into(),
        };
        object.insert(name.clone(), value);
    }
    Ok(Value::Object(object).to_string())
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

    #[test]
    fn a_row_without_a_checksum_or_with_another_is_refused_with_the_mend() {
        let issue = Issue::warning("not-fitted", "too few readings");
        let result = FitResult::of("a", "d", "i", &AskedFit::default(), Err(issue));
        let text = serde_json::to_string(&result).unwrap();
        assert_eq!(row(&text), Ok(result));
        let without = text.replace("\"checksum\"", "\"chacksum\"");
        let changed = text.replace("too few", "too raw");
        for (text, said) in [
            (without, "it has no checksum"),
            (changed, "its checksum is not that"),
        ] {
            let (run, reason) = row(&text).unwrap_err();
            assert_eq!(run.as_deref(), Some("a"));
            assert!(
                reason.contains(said) && reason.contains("fit it again"),
                "{reason}"
            );
        }
    }
}
