//! VersaStudio (.par): sections in angle brackets; `Segment1` holds a definition of the columns and the rows.
//!
//! Columns stand between commas with their units in round brackets: `E(V)`, `I(A)`, `Elapsed Time(s)`. The date names its
//! month in the language of the system; English names and numbers are read. The technique is the name of the action. A
//! segment without its closing tag shows a cut. Files seen hold an open circuit without rows and an impedance spectrum;
//! a decimal comma was never seen and is refused, for it also separates the columns.

use super::assemble::{Raw, assemble_untimed};
use super::error::ReadError;
use super::recognition::{FileHead, Match};
use super::stamp::{self, DateOrder};
use super::{About, Format, ReadContext, delimited};
use crate::text::grid::Dialect;
use crate::text::header::{Header, Meaning};
use crate::text::{Decimal, Delimiter, Line, Lines, decode};
use crate::{Reading, RunTable, StartedAt, Timestamp};
use ieap_domain::tag::keys;
use ieap_domain::{Issue, Quantity, RunStatus};

/// Reader of VersaStudio files.
pub struct VersastatPar;

/// A section: its name, its lines, and whether it is closed.
struct Section<'a> {
    name: &'a str,
    lines: &'a [Line<'a>],
    is_closed: bool,
}

impl Section<'_> {
    fn value(&self, key: &str) -> Option<&str> {
        let pairs = self.lines.iter().filter_map(|line| line.text.split_once('='));
        let mut found = pairs
            .filter(|(name, _)| *name == key)
            .map(|(_, value)| value.trim());
        found.next()
    }
}

impl Format for VersastatPar {
    fn about(&self) -> About {
        About {
            id: "versastat-par",
            title: "VersaStudio file of a VersaSTAT or PAR potentiostat (.par)",
            extensions: &["par"],
            version: 4,
        }
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        let text = head.text().unwrap_or_default();
        let mut lines = Lines::new(text).map(|line| line.text.trim());
        Match::certain_if(
            (lines.next(), lines.next()) == (Some("<Application>"), Some("Name=VersaStudio")),
            "the file begins with <Application> and Name=VersaStudio",
        )
    }

    fn read(&self, bytes: &[u8], _context: &ReadContext) -> Result<Reading, ReadError> {
        if bytes.is_empty() {
            return Err(ReadError::Empty);
        }
        let mut issues = Vec::new();
        let decoded = decode(bytes);
        let mut lines: Vec<Line<'_>> = Lines::new(&decoded.text).collect();
        // The last line of a whole file may lack its end; only an open segment is a cut.
        let unended = lines.pop_if(|line| !line.ended && !line.text.trim().starts_with("</"));
        let sections = sections(&lines);
        let segments: Vec<&Section<'_>> = sections
            .iter()
            .filter(|section| section.name.starts_with("Segment"))
            .collect();
        let is_action =
            |section: &&Section<'_>| section.name.starts_with("Action") && section.name != "Action0";
        let technique = sections
            .iter()
            .find(is_action)
            .and_then(|action| action.value("Name"));
        let is_spectrum = technique.is_some_and(|name| name.contains("EIS"));
        let mut tables = Vec::new();
        for section in &segments {
            let name = if segments.len() > 1 {
                section.name.to_owned()
            } else {
                String::new()
            };
            tables.extend(table(section, name, is_spectrum, &mut issues)?);
        }
        if tables.is_empty() {
            return Err(ReadError::header_only(
                lines.len(),
                format!("{} segments without rows", segments.len()),
            ));
        }
        let of = |name: &str| sections.iter().find(|section| section.name == name);
        let open = segments.iter().find(|section| !section.is_closed);
        let (status, status_evidence) = match (open, unended) {
            (Some(section), _) => (RunStatus::Cut, format!("{} is not closed", section.name)),
            (None, Some(line)) => (RunStatus::Cut, format!("line {} has no line end", line.number)),
            (None, None) => (RunStatus::Complete, "every segment is closed".to_owned()),
        };
        let instrument = of("Instrument").and_then(|section| section.value("Type"));
        Ok(Reading {
            technique: technique.map(str::to_owned),
            is_step_response: technique == Some("Chronoamperometry"),
            encoding: Some(decoded.encoding),
            status,
            status_evidence,
            started_at: of("Experiment").and_then(|section| started_at(section, &mut issues)),
            header_tags: instrument
                .map(|name| {
                    (
                        keys::INSTRUMENT.to_owned(),
                        name.to_owned(),
                        "Instrument Type".to_owned(),
                    )
                })
                .into_iter()
                .collect(),
            tables,
            original_metadata: metadata(&sections),
            issues,
            ..self.reading()
        })
    }
}

fn sections<'a>(lines: &'a [Line<'a>]) -> Vec<Section<'a>> {
    let mut sections = Vec::new();
    let mut at = 0;
    while at < lines.len() {
        let name = lines[at]
            .text
            .trim()
            .strip_prefix('<')
            .and_then(|text| text.strip_suffix('>'));
        at += 1;
        let is_name = |name: &&str| !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric());
        let Some(name) = name.filter(is_name) else {
            continue;
        };
        let closing = format!("</{name}>");
        let rest = &lines[at..];
        let end = rest.iter().position(|line| line.text.trim() == closing);
        sections.push(Section {
            name,
            lines: &rest[..end.unwrap_or(rest.len())],
            is_closed: end.is_some(),
        });
        at += end.map_or(rest.len(), |end| end + 1);
    }
    sections
}

fn table(
    section: &Section<'_>,
    name: String,
    is_spectrum: bool,
    issues: &mut Vec<Issue>,
) -> Result<Option<RunTable>, ReadError> {
    let is_definition = |line: &Line<'_>| line.text.starts_with("Definition=");
    let Some(at) = section.lines.iter().position(is_definition) else {
        return Ok(None);
    };
    let rows = &section.lines[at + 1..];
    let Some(first) = rows.iter().find(|row| !row.text.trim().is_empty()) else {
        return Ok(None);
    };
    let definition = section.lines[at].text.trim_start_matches("Definition=");
    let mut headers: Vec<Header> = definition
        .split(',')
        .map(|name| match name.trim() {
            // The definition names no unit of an impedance; it is in Ohm.
            part @ ("Z Real" | "Z Imag") => Header::with_unit(part, "Ohm"),
            name => Header::parse(name),
        })
        .collect();
    // The definition ends in a number that names no column.
    let fields = Delimiter::Comma.split(first.text, |_, _| {});
    if headers.len() == fields + 1 && headers.last().is_some_and(|header| header.raw_name == "0") {
        headers.pop();
    }
    let dialect = Dialect::new(Delimiter::Comma, Decimal::Point);
    let cells = delimited::cells_of(section.lines[at].number, headers.len(), rows, dialect);
    if is_spectrum {
        // Rows of a spectrum stand for frequencies; their times may repeat.
        let is_time = |header: &&mut Header| header.meaning.quantity() == Some(Quantity::Time);
        headers
            .iter_mut()
            .filter(is_time)
            .for_each(|header| header.meaning = Meaning::Other);
    }
    assemble_untimed(Raw::of_instrument(name, headers, cells), issues).map(Some)
}

/// `Friday, July 3, 2026` with `8:07:06 AM`.
fn started_at(section: &Section<'_>, issues: &mut Vec<Issue>) -> Option<StartedAt> {
    let (date, time) = (section.value("DateAcquired")?, section.value("TimeAcquired")?);
    let weekday_ends = date
        .find(", ")
        .filter(|at| date[..*at].chars().all(char::is_alphabetic));
    let day = weekday_ends.map_or(date, |at| &date[at + 2..]);
    let order = if day.starts_with(|c: char| c.is_ascii_digit()) {
        DateOrder::DayFirst
    } else {
        DateOrder::MonthFirst
    };
    let has_month_name = day.chars().any(|c| c.is_ascii_alphabetic());
    let shown = if has_month_name {
        format!("{day} {time}")
    } else {
        String::new()
    };
    let (stamp, issue) = stamp::in_order(&shown, order, Timestamp::Start, "the month is a name");
    issues.extend(issue);
    Some(StartedAt {
        raw: format!("{date} {time}"),
        ..stamp
    })
}

fn metadata(sections: &[Section<'_>]) -> Vec<(String, String)> {
    let is_kept = |section: &&Section<'_>| {
        let name = section.name;
        ["Application", "Instrument", "Experiment"].contains(&name) || name.starts_with("Action")
    };
    let mut metadata = Vec::new();
    for section in sections.iter().filter(is_kept) {
        let pairs = section.lines.iter().filter_map(|line| line.text.split_once('='));
        metadata
            .extend(pairs.map(|(key, value)| (format!("{} {key}", section.name), value.trim().to_owned())));
    }
    metadata
}
