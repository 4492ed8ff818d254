//! Reads a file as a profile says.

use super::definition::{Container, Profile};
use super::time;
use crate::formats::assemble::{Raw, assemble};
use crate::formats::cells::CellTable;
use crate::formats::error::{ReadError, quoted};
use crate::formats::{self};
use crate::formats::{ReadContext, stamp};
use crate::text::header::{Header, Meaning};
use crate::{Reading, StartedAt};
use ieap_domain::{Issue, RunStatus};

impl Profile {
    /// Reads a whole file.
    ///
    /// # Errors
    /// No table can be had from the bytes; everything less is an issue of the reading.
    pub fn read(&self, bytes: &[u8], context: &ReadContext) -> Result<Reading, ReadError> {
        if let Container::Answers(answers) = &self.container {
            let answered = ReadContext {
                answers: context.answers.with(answers),
                ..context.clone()
            };
            return formats::read("table", bytes, &answered);
        }
        let mut issues = Vec::new();
        let mut found = self.table(bytes, context.max_unpacked_bytes, &mut issues)?;
        if found.cells.rows() == 0 {
            return Err(ReadError::header_only(
                found.cells.header_line,
                "no row of numbers",
            ));
        }
        let places = self.places(&found.names)?;
        let mut headers = self.headers(&found.names, &places);
        self.scale(&mut found.cells, &places);
        let clock = time::apply(self, &mut headers, &mut found.cells, &places, &mut issues)?;
        let started_at = self.start(&found.preamble, &mut issues).or(clock);
        let raw = Raw {
            name: String::new(),
            headers,
            cells: found.cells,
            flags: Vec::new(),
            printed_time: None,
            time_zero_is_step: self.time_zero_is_step,
            must_be_run: false,
            must_respond: false,
        };
        let table = assemble(raw, &mut issues)?;
        let metadata = found.preamble.iter().filter(|line| !line.is_empty());
        Ok(Reading {
            technique: self.technique.clone(),
            is_step_response: self.step_response,
            encoding: found.encoding,
            status: found.status,
            status_evidence: match found.status {
                RunStatus::Complete => found.status_evidence + "; the profile declares no number of rows",
                _ => found.status_evidence,
            },
            started_at,
            tables: vec![table],
            original_metadata: metadata
                .map(|line| ("preamble".to_owned(), line.clone()))
                .collect(),
            issues,
            ..Reading::of("profile", Profile::READER_VERSION)
        })
    }

    /// Meaning of every column: what the profile says, or none.
    fn headers(&self, names: &[String], places: &[usize]) -> Vec<Header> {
        let named = |(index, name): (usize, &String)| {
            if name.is_empty() {
                Header::other(&format!("column {}", index + 1))
            } else {
                Header::other(name)
            }
        };
        let mut headers: Vec<Header> = names.iter().enumerate().map(named).collect();
        for (column, place) in self.columns.iter().zip(&places[self.time.columns().len()..]) {
            let header = &mut headers[*place];
            header.raw_unit = column.unit.clone();
            header.position_mm = column.position_mm;
            header.meaning = Meaning::Known {
                quantity: column.quantity,
                conversion: column.conversion,
            };
        }
        headers
    }

    fn scale(&self, cells: &mut CellTable, places: &[usize]) {
        for (column, place) in self.columns.iter().zip(&places[self.time.columns().len()..]) {
            if let Some(factor) = column.factor {
                cells.columns[*place]
                    .numbers
                    .iter_mut()
                    .for_each(|number| *number *= factor);
            }
        }
    }

    /// The date of the line that the profile names.
    fn start(&self, preamble: &[String], issues: &mut Vec<Issue>) -> Option<StartedAt> {
        let wanted = self.start.as_ref()?;
        let line = preamble
            .iter()
            .find_map(|line| line.trim_start_matches('"').strip_prefix(wanted.begins.as_str()));
        let Some(rest) = line else {
            let message = format!("no line begins with {}", quoted(&wanted.begins));
            issues.push(Issue::warning("date-uncertain", message).at("[start] line_begins"));
            return None;
        };
        let date = rest.trim_matches(|c: char| c.is_whitespace() || "\";,:=\t'".contains(c));
        let (stamp, issue) = stamp::in_order(date, wanted.order, wanted.kind, "as the profile says");
        issues.extend(issue);
        Some(stamp)
    }
}
