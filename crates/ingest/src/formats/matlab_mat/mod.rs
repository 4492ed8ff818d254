//! MATLAB's .mat files of version 5 (`save` with -v6 or -v7, also as Octave and scipy write them): vectors under the
//! names of their variables, or of the fields of a struct, as the columns of a run.
//!
//! The format after "MAT-File Format", The MathWorks, chapter 1 (level 5).

mod elements;
mod tables;
#[cfg(test)]
mod tests;
mod variables;

use super::assemble::{Raw, assemble};
use super::cells::CellTable;
use super::error::{ReadError, escaped, quoted};
use super::recognition::{FileHead, Match};
use super::{About, Format, ReadContext};
use crate::table::layout::time_among;
use crate::{Reading, RunTable};
use ieap_domain::{Issue, RunStatus};
use tables::Columns;
use variables::{Content, Variable};

/// Reader of .mat files.
pub struct MatlabMat;

/// What a file of version 5 begins with.
const MAGIC: &[u8] = b"MATLAB 5.0 MAT-file";
/// What a file of version 7.3 begins with: it is HDF5.
const MAGIC_HDF5: &[u8] = b"MATLAB 7.3 MAT-file";
/// Text of the header.
const HEADER_TEXT: usize = 116;

impl Format for MatlabMat {
    fn about(&self) -> About {
        About {
            id: "matlab-mat",
            title: "MATLAB .mat of version 5 (save -v6, -v7), vectors named as columns, such as time_s or current_mA",
            extensions: &["mat"],
            version: 2,
        }
    }

    fn is_generic(&self) -> bool {
        true
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        Match::certain_if(
            head.bytes.starts_with(MAGIC) || head.bytes.starts_with(MAGIC_HDF5),
            "the file begins with MATLAB and its version",
        )
    }

    fn read(&self, bytes: &[u8], context: &ReadContext) -> Result<Reading, ReadError> {
        if bytes.is_empty() {
            return Err(ReadError::Empty);
        }
        if bytes.starts_with(MAGIC_HDF5) {
            return Err(ReadError::NotRead {
                kind: "a MATLAB file of version 7.3",
                sign: "its header says so; it is HDF5",
                mend: "load it in MATLAB and save it again with -v7: save('run.mat', '-struct', 'data', '-v7')",
            });
        }
        let variables = variables::read(bytes, context.within(bytes.len()).max_unpacked_bytes)?;
        let mut issues = Vec::new();
        let tables = run_tables(&variables, context, &mut issues)?;
        Ok(Reading {
            is_step_response: true,
            status: RunStatus::Complete,
            status_evidence: "every variable is whole; the format declares no number of variables".to_owned(),
            tables,
            original_metadata: metadata(bytes, &variables),
            issues,
            ..self.reading()
        })
    }
}

/// The tables that are runs. One that speaks of time and cannot be used is said with the reason, another is only noted.
fn run_tables(
    variables: &[Variable],
    context: &ReadContext,
    issues: &mut Vec<Issue>,
) -> Result<Vec<RunTable>, ReadError> {
    let (mut found, mut refusals) = (Vec::new(), Vec::new());
    for columns in tables::tables(variables, issues) {
        let name = columns.name.clone();
        let names: Vec<String> = columns
            .headers
            .iter()
            .map(|header| header.raw_name.clone())
            .collect();
        let speaks_of_time = time_among(names.iter().map(String::as_str)).is_some();
        let mut own = Vec::new();
        match table(columns, context, &mut own) {
            Ok(table) => {
                found.push(table);
                issues.extend(own);
            }
            Err(error) => {
                let place = if name.is_empty() {
                    "the variables of their own".to_owned()
                } else {
                    format!("variable {}", quoted(&name))
                };
                refusals.push((speaks_of_time, format!("{place}: {error}")));
            }
        }
    }
    if found.is_empty() {
        let said: Vec<&str> = refusals.iter().map(|(_, said)| said.as_str()).collect();
        let names: Vec<String> = variables
            .iter()
            .map(|variable| quoted(&variable.path()))
            .collect();
        return Err(ReadError::NoRunAmong {
            found: if said.is_empty() {
                format!("the variables {}, none of them a vector", shortened(&names))
            } else {
                said.join("; ")
            },
        });
    }
    for (speaks_of_time, said) in refusals {
        let message = format!("no run is read from {said}");
        issues.push(if speaks_of_time {
            Issue::warning("table-refused", message)
        } else {
            Issue::note("variable-left-out", message)
        });
    }
    if let [only] = found.as_mut_slice() {
        only.name.clear();
    }
    Ok(found)
}

fn table(
    columns: Columns<'_>,
    context: &ReadContext,
    issues: &mut Vec<Issue>,
) -> Result<RunTable, ReadError> {
    let numbers = columns.numbers.into_iter().map(<[f64]>::to_vec).collect();
    let cells = CellTable::of_numbers(numbers);
    let raw = Raw {
        time_zero_is_step: true,
        must_be_run: true,
        must_respond: context.needs_response,
        ..Raw::of_instrument(columns.name, columns.headers, cells)
    };
    assemble(raw, issues)
}

/// The first names of a list.
fn shortened(names: &[String]) -> String {
    const SHOWN: usize = 8;
    let more = if names.len() > SHOWN {
        format!(", and {} more", names.len() - SHOWN)
    } else {
        String::new()
    };
    names[..names.len().min(SHOWN)].join(", ") + &more
}

/// The header's text, single numbers and texts, as the file has them.
fn metadata(bytes: &[u8], variables: &[Variable]) -> Vec<(String, String)> {
    let header = String::from_utf8_lossy(&bytes[..HEADER_TEXT.min(bytes.len())]);
    let header = escaped(header.trim_end_matches(['\0', ' ']));
    let told = variables.iter().filter_map(|variable| match &variable.content {
        Content::Texts(texts) if !texts.is_empty() => Some((variable.path(), texts.join(", "))),
        Content::Numbers(numbers) if numbers.len() == 1 => Some((variable.path(), numbers[0].to_string())),
        _ => None,
    });
    std::iter::once(("header".to_owned(), header))
        .chain(told)
        .collect()
}
