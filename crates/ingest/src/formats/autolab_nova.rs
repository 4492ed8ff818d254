//! Metrohm Autolab NOVA ASCII export: a header row, no preamble, no date.
//!
//! `Time (s)` is the clock of the whole procedure; `Corrected time (s)` starts at 0 with the command that
//! recorded the table and is the time of the run where it is present.

use super::assemble::{Raw, assemble};
use super::recognition::{FileHead, Match};
use super::{About, Format, ReadContext, ReadError, delimited, overload};
use crate::text::header::Header;
use crate::text::{Delimiter, Lines};
use crate::{Reading, RunTable};
use ieap_domain::Issue;

/// Reader of NOVA ASCII files.
pub struct AutolabNova;

impl Format for AutolabNova {
    fn about(&self) -> About {
        About {
            id: "autolab-nova",
            title: "Metrohm Autolab NOVA ASCII export (spreadsheets of NOVA are read as `spreadsheet`)",
            extensions: &["txt", "csv"],
            version: 3,
        }
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        let text = head.text().unwrap_or_default();
        let Some(first) = Lines::new(text).next() else {
            return Match::No;
        };
        let is_nova = Delimiter::ALL.into_iter().any(|delimiter| {
            let headers: Vec<Header> = delimiter
                .header_cells(first.text)
                .iter()
                .map(|c| Header::parse(c))
                .collect();
            is_nova(&headers)
        });
        Match::certain_if(is_nova, "the first line names Time (s) and WE(1) signals")
    }

    fn read(&self, bytes: &[u8], context: &ReadContext) -> Result<Reading, ReadError> {
        let mut issues = Vec::new();
        let decoded = delimited::decoded(bytes)?;
        let text = delimited::text(&decoded, &mut issues)?;
        let layout = crate::table::layout::decide(&text.lines, context)?;
        let part = layout.shape.data_at..text.lines.len();
        let read = crate::table::read(&text.lines, &layout, part, is_flag);
        let is_step_response = !is_cyclic(&read.headers);
        let table = table(String::new(), read.headers, read.cells, &mut issues)?;
        Ok(Reading {
            is_step_response,
            encoding: Some(text.encoding),
            status: text.status,
            original_metadata: text.metadata(layout.shape.names_at),
            status_evidence: text.status_evidence,
            tables: vec![table],
            issues,
            ..self.reading()
        })
    }
}

/// Whether columns are those of NOVA: there is no other mark.
pub fn is_nova(headers: &[Header]) -> bool {
    let has = |test: &dyn Fn(&str) -> bool| headers.iter().any(|header| test(&header.raw_name));
    has(&|name| matches!(name, "Time (s)" | "Corrected time (s)")) && has(&|name| name.starts_with("WE(1)."))
}

/// Whether the columns are those of a potential scan, which no step response has.
pub fn is_cyclic(headers: &[Header]) -> bool {
    headers
        .iter()
        .any(|header| header.raw_name == "Scan" || header.raw_name.starts_with("Potential applied"))
}

/// Whether a column holds overload texts.
pub fn is_flag(header: &Header) -> bool {
    header.raw_name.trim().eq_ignore_ascii_case("overload")
}

/// The run table of NOVA's columns.
///
/// # Errors
/// As [`assemble`].
pub fn table(
    name: String,
    headers: Vec<Header>,
    cells: super::cells::CellTable,
    issues: &mut Vec<Issue>,
) -> Result<RunTable, ReadError> {
    let flags = headers.iter().position(is_flag);
    let mut raw = Raw {
        name,
        must_be_run: !is_cyclic(&headers),
        must_respond: !is_cyclic(&headers),
        headers,
        cells,
        flags: Vec::new(),
        printed_time: None,
        time_zero_is_step: false,
    };
    if let Some(index) = flags {
        overload::exclude(&mut raw, index, is_overload, is_overload, issues);
    }
    assemble(raw, issues)
}

fn is_overload(text: &str) -> bool {
    !matches!(
        text.trim().to_ascii_lowercase().as_str(),
        "" | "no" | "none" | "false" | "no overload" | "ok"
    )
}
