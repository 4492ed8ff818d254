//! CH Instruments text export (.txt): date, technique, parameters, results, names, then rows.
//!
//! Units are SI and stand in the names (`Time/sec`, `Current/A`). The date is the END of the run: on one instrument,
//! sets follow each other in a way that only end stamps allow. The printed time of an i-t curve has four digits and
//! is a running sum in single precision; the samples are timed by row number times `Sample Interval (s)`, and the
//! printed column is kept. The potential of an i-t curve stands in `Init E (V)` only. `Run Time (sec)` is the plan and
//! says nothing of how the run ended; a missing line end shows a cut. The binary file (.bin) was never seen.

use super::assemble::{Raw, assemble};
use super::error::ReadError;
use super::recognition::{FileHead, Match};
use super::sample_clock::{self, SampleClock};
use super::stamp::{self, DateOrder};
use super::{About, Format, ReadContext, delimited};
use crate::text::grid::Dialect;
use crate::text::header::Header;
use crate::text::{Decimal, Delimiter, Line, Lines};
use crate::{Reading, Timestamp};
use ieap_domain::tag::keys;
use ieap_domain::{Issue, Quantity, RunStatus};

/// Reader of CH Instruments text.
pub struct Chi;

/// Parameters and results: name, value.
type Parameters<'a> = Vec<(&'a str, &'a str)>;

const SAMPLE_INTERVAL: &str = "Sample Interval (s)";
const HELD_POTENTIAL: &str = "Init E (V)";

impl Format for Chi {
    fn about(&self) -> About {
        About {
            id: "chi-text",
            title: "CH Instruments text export (.txt)",
            extensions: &["txt", "csv"],
            version: 4,
        }
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        let text = head.text().unwrap_or_default();
        let first = Lines::new(text).next().map_or("", |line| line.text);
        let has_model = Lines::new(text)
            .take(8)
            .any(|line| line.text.starts_with("Instrument Model:"));
        if has_model && stamp::civil(first, DateOrder::MonthFirst).is_some() {
            return Match::Certain("a date, then Instrument Model");
        }
        Match::certain_if(
            first.starts_with("Init E (V) =") && Lines::new(text).any(|line| names(line.text).is_some()),
            "the file begins with Init E (V)",
        )
    }

    fn read(&self, bytes: &[u8], _context: &ReadContext) -> Result<Reading, ReadError> {
        let decoded = delimited::decoded(bytes)?;
        let mut issues = Vec::new();
        let mut lines = decoded.lines();
        let (status, status_evidence) = delimited::drop_cut_line(&mut lines, &mut issues);
        let found = lines
            .iter()
            .enumerate()
            .find_map(|(at, line)| Some((at, names(line.text)?)));
        let Some((names_at, (delimiter, mut headers))) = found else {
            return Err(ReadError::header_only(lines.len(), "no names of columns"));
        };
        let (preamble, rows) = (&lines[..names_at], &lines[names_at + 1..]);
        drop_empty_columns(&mut headers, rows, delimiter, &mut issues);
        let dialect = Dialect::new(delimiter, Decimal::Point);
        let cells = delimited::cells_of(lines[names_at].number, headers.len(), rows, dialect);
        let mut raw = Raw::of_instrument(String::new(), headers, cells);
        let parameters = parameters(preamble);
        let stamped = stamp::civil(
            preamble.first().map_or("", |line| line.text),
            DateOrder::MonthFirst,
        )
        .is_some();
        let technique = stamped.then(|| preamble.get(1).map_or("", |line| line.text.trim()));
        let holds = technique.is_some_and(holds_potential);
        if holds {
            use_sample_clock(&mut raw, &parameters, &mut issues);
        }
        Ok(Reading {
            technique: technique.map(str::to_owned),
            is_step_response: holds || technique.is_some_and(|technique| steps_potential(technique, &raw)),
            encoding: Some(decoded.encoding),
            status,
            status_evidence: match status {
                RunStatus::Complete => status_evidence + "; Run Time (sec) is a plan and no evidence",
                _ => status_evidence,
            },
            started_at: stamped.then(|| {
                let raw = preamble[0].text.trim();
                let basis = "the month is a name; it is the end of the run";
                stamp::in_order(raw, DateOrder::MonthFirst, Timestamp::End, basis).0
            }),
            header_tags: header_tags(&parameters, holds),
            tables: vec![assemble(raw, &mut issues)?],
            original_metadata: parameters
                .into_iter()
                .map(|(name, value)| (name.to_owned(), value.to_owned()))
                .collect(),
            issues,
            ..self.reading()
        })
    }
}

/// Techniques that hold one potential, `Init E (V)`.
fn holds_potential(technique: &str) -> bool {
    matches!(
        technique,
        "Amperometric i-t Curve" | "Bulk Electrolysis with Coulometry"
    )
}

/// Techniques that step the potential, where its readings say when.
fn steps_potential(technique: &str, raw: &Raw) -> bool {
    let is_voltage = |header: &Header| header.meaning.quantity() == Some(Quantity::Voltage);
    matches!(technique, "Chronoamperometry" | "Multi-Potential Steps") && raw.headers.iter().any(is_voltage)
}

/// The columns of a line `Time/sec, Current/A`: two and more names, each with a unit behind a slash.
fn names(text: &str) -> Option<(Delimiter, Vec<Header>)> {
    let is_name = |cell: &String| {
        let (name, unit) = cell.split_once('/').unwrap_or(("", ""));
        !name.is_empty()
            && !unit.is_empty()
            && !cell.contains(['=', ':', '\\'])
            && !name.starts_with(char::is_numeric)
    };
    [Delimiter::Tab, Delimiter::Comma]
        .into_iter()
        .find_map(|delimiter| {
            // A quote here is a double prime (`Z"/ohm`) and encloses nothing.
            let mark = if delimiter == Delimiter::Tab { '\t' } else { ',' };
            let cells: Vec<String> = text.split(mark).map(|cell| cell.trim().to_owned()).collect();
            let fits = cells.len() >= 2 && cells.iter().all(is_name);
            fits.then(|| (delimiter, cells.iter().map(|cell| Header::parse(cell)).collect()))
        })
}

/// Some exports name a last column that no row has.
fn drop_empty_columns(
    headers: &mut Vec<Header>,
    rows: &[Line<'_>],
    delimiter: Delimiter,
    issues: &mut Vec<Issue>,
) {
    let filled = rows.iter().filter(|row| !row.text.trim().is_empty());
    let widest = filled
        .map(|row| delimiter.split(row.text, |_, _| {}))
        .max()
        .unwrap_or(0);
    if widest > 0 && widest < headers.len() {
        let gone: Vec<String> = headers.drain(widest..).map(|header| header.raw_name).collect();
        let message = format!("no row has a value under {}", gone.join(", "));
        issues.push(Issue::note("empty-column", message));
    }
}

/// `Name (unit) = value` and `Name: value`.
fn parameters<'a>(lines: &[Line<'a>]) -> Parameters<'a> {
    let pair = |line: &Line<'a>| {
        let text = line.text.trim();
        let (name, value) = text
            .split_once('=')
            .or_else(|| text.split_once(": "))
            .or(text.split_once(':'))?;
        Some((name.trim(), value.trim()))
    };
    lines.iter().skip(1).filter_map(pair).collect()
}

fn parameter<'a>(parameters: &Parameters<'a>, name: &str) -> Option<&'a str> {
    parameters
        .iter()
        .find(|(key, _)| *key == name)
        .map(|(_, value)| *value)
}

fn use_sample_clock(raw: &mut Raw, parameters: &Parameters<'_>, issues: &mut Vec<Issue>) {
    let is_time = |header: &Header| header.meaning.quantity() == Some(Quantity::Time);
    let interval = parameter(parameters, SAMPLE_INTERVAL).and_then(|text| text.parse().ok());
    if let (Some(index), Some(interval_s)) = (raw.headers.iter().position(is_time), interval) {
        let clock = SampleClock {
            interval_s,
            name: SAMPLE_INTERVAL,
            digits: 4,
            // The running sum in single precision was 0.7 % off after 18 hours.
            drift: 0.01,
        };
        sample_clock::rebuild(raw, index, clock, issues);
    }
}

fn header_tags(parameters: &Parameters<'_>, holds: bool) -> Vec<(String, String, String)> {
    let mut tags = Vec::new();
    let tag = |key: &str, value: String, name: &str| (key.to_owned(), value, name.to_owned());
    if let Some(model) = parameter(parameters, "Instrument Model").filter(|model| !model.is_empty()) {
        tags.push(tag(keys::INSTRUMENT, model.to_owned(), "Instrument Model"));
    }
    let held = parameter(parameters, HELD_POTENTIAL).and_then(|text| text.parse::<f64>().ok());
    if let Some(volts) = held.filter(|volts| holds && volts.is_finite()) {
        tags.push(tag(keys::VOLTAGE_V, (volts + 0.0).to_string(), HELD_POTENTIAL));
    }
    tags
}
