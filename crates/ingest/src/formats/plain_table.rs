//! The plain run table: a header that names quantities with their units, then numbers.

use super::assemble::{Raw, assemble};
use super::delimited;
use super::recognition::{FileHead, Match};
use super::{Format, ReadContext, ReadError};
use crate::Reading;
use crate::text::grid::is_blank_or_comment;
use crate::text::header::Header;
use crate::text::{Delimiter, Lines, layout};
use ieap_domain::tag::keys;
use ieap_domain::{Quantity, RunStatus};

/// Reader of the plain run table, in every spelling: delimiter, decimal sign, encoding and units are found.
pub struct PlainTable;

impl Format for PlainTable {
    fn id(&self) -> &'static str {
        "plain-table"
    }

    fn title(&self) -> &'static str {
        "plain table of a run (time_s, voltage_v, current_a, curvature_per_cm), of a modulus log or of a spectrum (CSV, TSV)"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["csv", "tsv", "txt", "dat"]
    }

    fn version(&self) -> u32 {
        5
    }

    fn is_generic(&self) -> bool {
        true
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        let Some(text) = head.text() else {
            return Match::No;
        };
        let lines = Lines::new(&text).filter(|line| !is_blank_or_comment(line.text));
        let mut is_table = false;
        for line in lines.take(64) {
            for delimiter in Delimiter::ALL {
                let cells = delimiter.header_cells(line.text);
                is_table |= cells.len() >= 2 && delimiter != Delimiter::Blanks;
                if layout::time_among(cells.iter().map(String::as_str)).is_some() {
                    return Match::Possible {
                        score: 0.6,
                        reason: "a header row names a time column",
                    };
                }
            }
        }
        match is_table {
            true => Match::Possible {
                score: 0.1,
                reason: "text with delimiters",
            },
            false => Match::No,
        }
    }

    fn read(&self, bytes: &[u8], context: &ReadContext) -> Result<Reading, ReadError> {
        let mut issues = Vec::new();
        let text = delimited::read(bytes, is_flag, &mut issues)?;
        let raw = Raw {
            name: String::new(),
            headers: text.headers,
            cells: text.cells,
            flags: Vec::new(),
            printed_time: None,
            time_zero_is_step: true,
            must_be_run: true,
            must_respond: context.needs_response,
        };
        let table = assemble(raw, &mut issues)?;
        let is_tag = |(key, value): &&(String, String)| is_comment_tag(key) && !value.is_empty();
        let header_tags = text.metadata.iter().filter(is_tag);
        Ok(Reading {
            format: self.id(),
            reader_version: self.version(),
            technique: None,
            is_step_response: !holds_spectrum(&table),
            encoding: Some(text.encoding),
            status: text.status,
            status_evidence: match text.status {
                RunStatus::Complete => text.status_evidence + "; the format declares no number of rows",
                _ => text.status_evidence,
            },
            started_at: None,
            header_tags: header_tags
                .map(|(key, value)| (key.clone(), value.clone(), format!("# {key}")))
                .collect(),
            tables: vec![table],
            original_metadata: text.metadata,
            issues,
        })
    }
}

/// Whether the table is an impedance spectrum.
fn holds_spectrum(table: &crate::RunTable) -> bool {
    !ieap_domain::Spectrum::of(&table.channels).is_empty()
}

/// Whether a column may hold `true` and `false`.
pub fn is_flag(header: &Header) -> bool {
    header.meaning.quantity() == Some(Quantity::OpenCircuit)
}

/// Whether a `#` comment with that key is a tag, as in `# sample: CNaf-01`.
fn is_comment_tag(key: &str) -> bool {
    key == keys::NOTE
        || key == keys::OPEN_CIRCUIT
        || key == keys::LEAVE_OUT
        || keys::CONDITIONS.contains(&key)
}
