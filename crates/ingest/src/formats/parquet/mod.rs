//! Parquet as a run table: columns by name as in the plain table, units in the names.
//!
//! Polars writes Parquet for the export, but does not read it here: its decoder leaves out checks of bounds on purpose, so
//! that a damaged page can end the program or give other numbers. The library of the Arrow project refuses such pages;
//! what their heads declare is checked before it reserves memory by it (`pages`).

mod arrow_schema;
mod columns;
mod error;
mod pages;
#[cfg(test)]
mod tests;

use std::panic::{AssertUnwindSafe, catch_unwind};

use bytes::Bytes;
use parquet::basic::Compression;
use parquet::file::reader::FileReader;
use parquet::file::serialized_reader::SerializedFileReader;

use super::assemble::{Raw, assemble};
use super::cells::CellTable;
use super::error::{ReadError, quoted};
use super::recognition::{FileHead, Match};
use super::{About, Format, ReadContext, plain_table, unpacking};
use crate::Reading;
use crate::text::header::Header;
use columns::Kind;
use error::{broken, failed};
use ieap_domain::{Issue, RunStatus};

/// Reader of Parquet files.
pub struct Parquet;

/// What a Parquet file begins and ends with.
const MAGIC: &[u8] = b"PAR1";
/// Bytes of a cell as it is held.
const CELL_BYTES: u64 = 8;

impl Format for Parquet {
    fn about(&self) -> About {
        About {
            id: "parquet",
            title: "Parquet with the columns of a run table, such as time_s or Current [mA] (.parquet)",
            extensions: &["parquet", "pq"],
            version: 6,
        }
    }

    fn is_generic(&self) -> bool {
        true
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        Match::certain_if(head.bytes.starts_with(MAGIC), "the file begins with PAR1")
    }

    fn read(&self, bytes: &[u8], context: &ReadContext) -> Result<Reading, ReadError> {
        if bytes.is_empty() {
            return Err(ReadError::Empty);
        }
        // The table of contents stands at the end, and so does the mark of a whole file.
        if bytes.len() < 12 || !bytes.ends_with(MAGIC) {
            return Err(ReadError::Structure {
                offset: bytes.len() as u64,
                found: "the file ends without PAR1".to_owned(),
                needed: "a whole Parquet file: its table of contents stands at the end",
            });
        }
        let mut issues = Vec::new();
        let (headers, cells) = table(bytes, context.max_unpacked_bytes, &mut issues)?;
        let raw = Raw {
            time_zero_is_step: true,
            must_be_run: true,
            must_respond: context.needs_response,
            ..Raw::of_instrument(String::new(), headers, cells)
        };
        let table = assemble(raw, &mut issues)?;
        Ok(Reading {
            is_step_response: true,
            status: RunStatus::Complete,
            status_evidence: format!("the table of contents declares {} rows, all found", table.rows),
            tables: vec![table],
            issues,
            ..self.reading()
        })
    }
}

/// Headers and cells of the columns that hold numbers or texts; others are named in an issue.
fn table(
    bytes: &[u8],
    max_bytes: u64,
    issues: &mut Vec<Issue>,
) -> Result<(Vec<Header>, CellTable), ReadError> {
    // The library asserts here and there what damaged records break; such a file is refused and stops no other one.
    let attempt = catch_unwind(AssertUnwindSafe(|| read_columns(bytes, max_bytes, issues)));
    attempt.unwrap_or_else(|_| Err(broken("its records contradict each other")))
}

fn read_columns(
    bytes: &[u8],
    max_bytes: u64,
    issues: &mut Vec<Issue>,
) -> Result<(Vec<Header>, CellTable), ReadError> {
    let (file, rows) = opened(bytes, max_bytes)?;
    let durations = arrow_schema::durations(file.metadata().file_metadata());
    if durations.is_none() {
        let message =
            "what `ARROW:schema` says cannot be read: a column of durations would be taken for plain numbers";
        let issue = Issue::warning("arrow-schema-unread", message);
        issues.push(issue.mend("write the file anew, or state the unit in the column's name"));
    }
    let durations = durations.unwrap_or_default();
    let kept = kept(&file, &durations, issues);
    check_compression(&file, &kept)?;
    pages::check(bytes, file.metadata(), &kept)?;
    let schema = file.metadata().file_metadata().schema_descr();
    let headers: Vec<Header> = kept
        .iter()
        .map(|(leaf, _)| match schema.column(*leaf).name() {
            name if duration(&durations, name).is_some() => Header::of_durations(name),
            name => Header::parse(name),
        })
        .collect();
    let keep_text: Vec<bool> = headers.iter().map(plain_table::is_flag).collect();
    // No room by the declared number of rows: a damaged file may declare any.
    let mut cells = CellTable::new(0, &keep_text, 0);
    for group in 0..file.num_row_groups() {
        let group = file.get_row_group(group).map_err(failed)?;
        for (column, (leaf, kind)) in cells.columns.iter_mut().zip(&kept) {
            let max_level = schema.column(*leaf).max_def_level();
            let reader = group.get_column_reader(*leaf).map_err(failed)?;
            columns::fill(column, reader, *kind, max_level)?;
        }
    }
    if cells.columns.iter().any(|column| column.numbers.len() != rows) {
        return Err(broken("its columns hold other numbers of rows than it declares"));
    }
    cells.line_of_row = (1..=rows as u32).collect();
    Ok((headers, cells))
}

/// A Parquet file and its rows, where it unpacks to no more than `max_bytes`, and to no more than a file of its size may. What
/// reads it catches panics of the library.
///
/// # Errors
/// It is damaged, or too large.
pub(crate) fn opened(
    bytes: &[u8],
    max_bytes: u64,
) -> Result<(SerializedFileReader<Bytes>, usize), ReadError> {
    let file = SerializedFileReader::new(Bytes::copy_from_slice(bytes)).map_err(failed)?;
    let rows = checked_rows(&file, max_bytes.min(unpacking::allowance(bytes.len())))?;
    Ok((file, rows))
}

/// Rows of the file, once its declared size is one that can be read.
fn checked_rows(file: &SerializedFileReader<Bytes>, max_bytes: u64) -> Result<usize, ReadError> {
    let metadata = file.metadata();
    let groups = metadata.row_groups();
    let sum = |part: fn(&parquet::file::metadata::RowGroupMetaData) -> i64| {
        groups.iter().try_fold(0u64, |sum, group| {
            sum.checked_add(u64::try_from(part(group)).ok()?)
        })
    };
    let rows = sum(|group| group.num_rows());
    // A group's own sum is not what its columns are unpacked by.
    let of_columns = |group: &parquet::file::metadata::RowGroupMetaData| {
        let sizes = group
            .columns()
            .iter()
            .map(|column| column.uncompressed_size().max(0));
        sizes.fold(0, i64::saturating_add).max(group.total_byte_size())
    };
    let unpacked = sum(of_columns);
    let (Some(rows), Some(unpacked)) = (rows, unpacked) else {
        return Err(broken("its row groups declare sizes below zero"));
    };
    if i64::try_from(rows).ok() != Some(metadata.file_metadata().num_rows()) {
        return Err(broken(&format!(
            "it declares {} rows, and its row groups {rows}",
            metadata.file_metadata().num_rows()
        )));
    }
    let columns = metadata.file_metadata().schema_descr().num_columns();
    if groups.iter().any(|group| group.num_columns() != columns) {
        return Err(broken("a row group holds other columns than the file"));
    }
    let cells = rows.saturating_mul(columns as u64);
    // Equal numbers pack to nothing: what counts is what they take when they are held.
    let unpacked = unpacked.max(cells.saturating_mul(CELL_BYTES));
    if unpacked > max_bytes {
        return Err(ReadError::TooLarge {
            what: "the Parquet file unpacked".to_owned(),
            found: unpacked,
            limit: max_bytes,
        });
    }
    Ok(rows as usize)
}

/// Refuses the two ways of compression that are not built in, by name: such a file is not damaged.
fn check_compression(file: &SerializedFileReader<Bytes>, kept: &[(usize, Kind)]) -> Result<(), ReadError> {
    let groups = file.metadata().row_groups();
    for (group, (leaf, _)) in groups
        .iter()
        .flat_map(|group| kept.iter().map(move |kept| (group, kept)))
    {
        let kind = match group.column(*leaf).compression() {
            Compression::BROTLI(_) => "a Parquet file compressed with Brotli",
            Compression::LZO => "a Parquet file compressed with LZO",
            _ => continue,
        };
        return Err(ReadError::NotRead {
            kind,
            sign: "its table of contents says so",
            mend: "write it anew with Snappy, Zstandard, gzip or LZ4, or as CSV",
        });
    }
    Ok(())
}

/// Digits behind the second of a column of durations; none of any other.
fn duration(durations: &[(String, i32)], name: &str) -> Option<i32> {
    let own = durations.iter().find(|(own, _)| own == name);
    own.map(|(_, digits)| *digits)
}

/// The columns that are read, by their number among the leaves of the schema; the others become issues.
fn kept(
    file: &SerializedFileReader<Bytes>,
    durations: &[(String, i32)],
    issues: &mut Vec<Issue>,
) -> Vec<(usize, Kind)> {
    let schema = file.metadata().file_metadata().schema_descr();
    let mut kept = Vec::new();
    let mut left_out: Vec<&str> = Vec::new();
    for leaf in 0..schema.num_columns() {
        let groups = file.metadata().row_groups();
        let by_delta = groups
            .iter()
            .any(|group| columns::is_by_delta(group.column(leaf)));
        let kind = if by_delta {
            Err("texts in an encoding that is not read (write them as PLAIN or with a dictionary)")
        } else {
            let column = schema.column(leaf);
            Kind::of(&column, duration(durations, column.name()))
        };
        match kind {
            Ok(kind) => kept.push((leaf, kind)),
            Err(held) => {
                let root = schema.get_column_root(leaf).name();
                if left_out.last() == Some(&root) {
                    continue;
                }
                left_out.push(root);
                let message = format!("column {} holds {held}; it is left out", quoted(root));
                issues.push(Issue::note("text-column", message));
            }
        }
    }
    kept
}
