//! Impedance spectra of Scribner's ZPlot and ZView (.z), text of two layouts: `ZPLOT2 ASCII` with its settings line by
//! line, the names and `End Comments`, then rows with tabs; or quoted lines, `"ZPlotW Data File: Version 3.2c"`, then
//! the names and rows with commas.
//!
//! `(a)` and `(b)` behind the names of the two parts are marks and no units; they are in ohms, and Z'' has its own sign.
//! Rows stand for frequencies, so `Time(Sec)` times nothing. The date is month, day, year; whether the sweep began or
//! ended then, no file showed. The header declares the number of rows; fewer show a cut. Experiments other than a sweep
//! of the frequency were never seen and are refused.

use super::assemble::{Raw, assemble};
use super::error::{ReadError, quoted};
use super::recognition::{FileHead, Match};
use super::stamp::{self, DateOrder};
use super::{About, Format, ReadContext, delimited};
use crate::text::grid::Dialect;
use crate::text::header::Header;
use crate::text::{Decimal, Delimiter, Line, Lines};
use crate::{Reading, StartedAt, Timestamp};
use ieap_domain::{Issue, RunStatus};

/// Reader of ZPlot's and ZView's data files.
pub struct Zplot;

/// What the first line begins with, quotes aside.
const BEGINNINGS: [&str; 3] = ["ZPLOT2 ASCII", "ZPlotW Data File:", "ZView Calculated Data File:"];
/// Last line before the rows of the first layout.
const END: &str = "End Comments";
/// The experiment that is read.
const SWEEP: &str = "Sweep Frequency";

impl Format for Zplot {
    fn about(&self) -> About {
        About {
            id: "zplot",
            title: "Scribner ZPlot and ZView spectrum (.z)",
            extensions: &["z"],
            version: 1,
        }
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        let text = head.text().unwrap_or_default();
        let first = Lines::new(text).next().map_or("", |line| bare(line.text));
        Match::certain_if(
            BEGINNINGS.iter().any(|beginning| first.starts_with(beginning)),
            "the file begins with the name of ZPlot or ZView",
        )
    }

    fn read(&self, bytes: &[u8], _context: &ReadContext) -> Result<Reading, ReadError> {
        let decoded = delimited::decoded(bytes)?;
        let mut issues = Vec::new();
        let mut lines = decoded.lines();
        let (text_status, text_evidence) = delimited::drop_cut_line(&mut lines, &mut issues);
        delimited::note_replacements(&decoded, &lines, &mut issues);
        let Some(names_at) = lines.iter().position(|line| has_names(line.text)) else {
            return Err(ReadError::header_only(
                lines.len(),
                "no names of columns with Freq(Hz)",
            ));
        };
        let (preamble, below) = lines.split_at(names_at);
        let settings: Vec<(String, String)> = preamble.iter().map(|line| setting(line.text)).collect();
        let technique = technique(&settings)?;
        let rows = &below[1..];
        let rows = match rows.first() {
            Some(line) if line.text.trim() == END => &rows[1..],
            _ => rows,
        };
        let raw = raw(&below[0], rows);
        let rows = raw.cells.rows();
        let (status, status_evidence) = match declared(&settings) {
            Some(declared) if rows < declared || text_status == RunStatus::Complete => (
                if rows < declared {
                    RunStatus::Cut
                } else {
                    text_status
                },
                format!("the header declares {declared} rows, {rows} found"),
            ),
            _ => (text_status, text_evidence),
        };
        Ok(Reading {
            technique,
            is_step_response: false,
            encoding: Some(decoded.encoding),
            status,
            status_evidence,
            started_at: started_at(&settings, &mut issues),
            tables: vec![assemble(raw, &mut issues)?],
            original_metadata: settings,
            issues,
            ..self.reading()
        })
    }
}

/// A line of the header without the quotes and blanks around it.
fn bare(text: &str) -> &str {
    text.trim().trim_matches('"').trim()
}

fn has_names(text: &str) -> bool {
    bare(text).split_whitespace().next() == Some("Freq(Hz)")
}

/// Name and value of a line of the header; the name is empty where the line holds one thing only.
fn setting(text: &str) -> (String, String) {
    let text = bare(text);
    let (name, value) = text.split_once(':').unwrap_or(("", text));
    (name.trim().to_owned(), value.trim().to_owned())
}

fn value<'a>(settings: &'a [(String, String)], name: &str) -> Option<&'a str> {
    let found = settings.iter().find(|(key, _)| key == name)?;
    Some(found.1.as_str())
}

/// The experiment: `Experiment Type: Sweep Frequency, Control Voltage`, or a line `Sweep Frequency: Control Voltage`.
fn technique(settings: &[(String, String)]) -> Result<Option<String>, ReadError> {
    let controls =
        |(name, value): &&(String, String)| name.starts_with("Sweep") && value.starts_with("Control");
    let experiment = value(settings, "Experiment Type").map(str::to_owned).or_else(|| {
        let (name, control) = settings.iter().find(controls)?;
        Some(format!("{name}, {control}"))
    });
    match experiment {
        Some(other) if !other.starts_with(SWEEP) => Err(ReadError::NeverSeen {
            what: "this experiment of ZPlot",
            found: quoted(&other),
        }),
        experiment => Ok(experiment),
    }
}

/// How many rows the header declares: `Data Points`, or the number before the names.
fn declared(settings: &[(String, String)]) -> Option<usize> {
    let last = settings.last().filter(|(name, _)| name.is_empty());
    let count = value(settings, "Data Points").or(last.map(|(_, value)| value.as_str()))?;
    count.parse().ok()
}

/// The date and the time of day, on two lines or on one: `Date: 12-17-2019    Time: 16:24:35`.
fn started_at(settings: &[(String, String)], issues: &mut Vec<Issue>) -> Option<StartedAt> {
    let date = value(settings, "Date")?;
    let raw = match date.split_once("Time:") {
        Some((day, time)) => format!("{} {}", day.trim(), time.trim()),
        None => format!("{date} {}", value(settings, "Time")?),
    };
    let basis = "ZPlot writes the month first";
    let (stamp, issue) = stamp::in_order(&raw, DateOrder::MonthFirst, Timestamp::Start, basis);
    issues.extend(issue);
    Some(stamp)
}

fn raw(names: &Line<'_>, rows: &[Line<'_>]) -> Raw {
    let headers: Vec<Header> = bare(names.text).split_whitespace().map(header).collect();
    let has_tabs = rows.first().is_some_and(|row| row.text.contains('\t'));
    let dialect = Dialect::new(
        if has_tabs {
            Delimiter::Tab
        } else {
            Delimiter::Comma
        },
        Decimal::Point,
    );
    let cells = delimited::cells_of(names.number, headers.len(), rows, dialect);
    Raw::of_instrument(String::new(), headers, cells)
}

fn header(name: &str) -> Header {
    let part = match name {
        "Freq(Hz)" => return Header::parse(name),
        "Z'(a)" => "Z'",
        "Z''(b)" => "Z''",
        _ => return Header::other(name),
    };
    Header {
        raw_name: name.to_owned(),
        raw_unit: String::new(),
        ..Header::with_unit(part, "Ohm")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::Quantity;

    const LINE_BY_LINE: &str = "ZPLOT2 ASCII\n  Measured Data, ZPlot:       3.2c\n  \
        Experiment Type:            Sweep Frequency, Control Voltage\n  Date:                       10-12-2018\n  \
        Time:                       12:33:17\n    vs Time-Freq:             1000\n  Data Points:                2\n  \
        Freq(Hz)\tAmpl\tBias\tTime(Sec)\tZ'(a)\tZ''(b)\tGD\tErr\tRange\nEnd Comments\n\
        1.000000E+04\t1.0000E-02\t0.0000E+00\t2.5E+00\t2.0E+01\t-6.5E+00\t0.0E+00\t0\t4\n\
        1.000000E+03\t1.0000E-02\t0.0000E+00\t3.5E+00\t3.0E+01\t-7.5E+00\t0.0E+00\t0\t4\n";

    const QUOTED: &str = "\"ZPlotW Data File: Version 3.2c\"\r\n\"Raw Data\"\r\n\"Sweep Frequency: Control Voltage\"\r\n\
        Date: 12-17-2018    Time: 16:24:35\r\nwet strip\r\n\"Frequency\"\r\n0,3,0,1,300000,0.005\r\n2\r\n\
        \"  Freq(Hz)    Ampl     Bias   Time(Sec)   Z'(a)    Z''(b)    GD   Err   Range\"\r\n\
        1.000000E+04, 1.0000E-02, 0.0000E+00, 2.5E+00, 2.0E+01, -6.5E+00, 0.0E+00, 0, 4\r\n\
        1.000000E+03, 1.0000E-02, 0.0000E+00, 3.5E+00, 3.0E+01, -7.5E+00, 0.0E+00, 0, 4\r\n";

    fn read(text: &str) -> Result<Reading, ReadError> {
        Zplot.read(text.as_bytes(), &ReadContext::default())
    }

    #[test]
    fn both_layouts_hold_the_spectrum() {
        for (text, local) in [
            (LINE_BY_LINE, "2018-10-12T12:33:17"),
            (QUOTED, "2018-12-17T16:24:35"),
        ] {
            let head = FileHead::of("a.z", text.as_bytes());
            assert!(matches!(Zplot.recognise(&head), Match::Certain(_)));
            let reading = read(text).unwrap();
            let channels = &reading.tables[0].channels;
            let of = |quantity| {
                let mut found = channels.iter().filter(|channel| channel.quantity == quantity);
                found.next().map(|channel| channel.values.to_vec())
            };
            assert_eq!(of(Quantity::Frequency), Some(vec![1e4, 1e3]));
            assert_eq!(of(Quantity::ImpedanceReal), Some(vec![20.0, 30.0]));
            assert_eq!(of(Quantity::ImpedanceImaginary), Some(vec![-6.5, -7.5]));
            assert_eq!(
                (channels.len(), reading.tables[0].time_column.as_ref()),
                (9, None)
            );
            assert_eq!(
                reading.technique.as_deref(),
                Some("Sweep Frequency, Control Voltage")
            );
            assert_eq!(reading.started_at.unwrap().local.as_deref(), Some(local));
            assert_eq!(
                (reading.status, reading.issues),
                (RunStatus::Complete, Vec::new())
            );
        }
    }

    #[test]
    fn fewer_rows_than_declared_and_none_at_all() {
        for text in [LINE_BY_LINE, QUOTED] {
            let without_last = text.trim_end().rfind('\n').unwrap() + 1;
            let reading = read(&text[..without_last]).unwrap();
            assert_eq!((reading.status, reading.tables[0].rows), (RunStatus::Cut, 1));
            assert!(
                read(&text[..text.find("Freq(Hz)").unwrap()])
                    .unwrap_err()
                    .is_pending()
            );
        }
    }

    #[test]
    fn another_experiment_is_refused() {
        for text in [LINE_BY_LINE, QUOTED] {
            let other = text.replace("Sweep Frequency", "Sweep DC Potential");
            assert!(
                matches!(read(&other), Err(ReadError::NeverSeen { .. })),
                "{other}"
            );
        }
    }
}
