//! The plain run table: a header that names quantities with their units, then numbers.

use super::assemble::{Raw, assemble};
use super::delimited;
use super::recognition::{FileHead, Match};
use super::{About, Format, ReadContext, ReadError};
use crate::table::columns::said_by_unit;
use crate::table::{self, layout, start, times, zone};
use crate::text::header::Header;
use crate::text::lines::lines_of;
use crate::text::{Delimiter, Line};
use crate::{Reading, RunTable, StartedAt};
use ieap_domain::tag::keys;
use ieap_domain::{Issue, Quantity};

/// Reader of the plain run table, in every spelling: delimiter, decimal sign, encoding and units are found.
pub struct PlainTable;

impl Format for PlainTable {
    fn about(&self) -> About {
        About {
            id: "plain-table",
            title: "plain table of a run (time_s, voltage_v, current_a, curvature_per_cm), of a modulus log or of a spectrum (CSV, TSV)",
            extensions: &["csv", "tsv", "txt", "dat"],
            version: 11,
        }
    }

    fn is_generic(&self) -> bool {
        true
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        let Some(text) = head.text() else {
            return Match::No;
        };
        match head.shape() {
            Ok(_) | Err(ReadError::HeaderOnly { .. } | ReadError::NoReading { .. }) => Match::Possible {
                score: 0.6,
                reason: "a header row names a time column",
            },
            Err(_)
                if layout::shapes(&lines_of(text))
                    .iter()
                    .any(|shape| !matches!(shape.delimiter, Delimiter::Blanks | Delimiter::WideBlanks)) =>
            {
                Match::Possible {
                    score: 0.1,
                    reason: "text with delimiters",
                }
            }
            Err(_) => Match::No,
        }
    }

    fn read(&self, bytes: &[u8], context: &ReadContext) -> Result<Reading, ReadError> {
        let mut issues = Vec::new();
        let stated = context.answers.table();
        let decoded = match stated {
            Some(stated) if !bytes.is_empty() => stated.decoded(bytes),
            _ => delimited::decoded(bytes)?,
        };
        let text = delimited::text(&decoded, &mut issues)?;
        let (tables, started_at, names_at) = runs(&text.lines, context, stated.is_none(), &mut issues)?;
        let metadata = text.metadata(names_at);
        let is_tag = |(key, value): &&(String, String)| is_comment_tag(key) && !value.is_empty();
        let header_tags = metadata.iter().filter(is_tag);
        Ok(Reading {
            is_step_response: !tables.iter().all(holds_spectrum),
            encoding: Some(text.encoding),
            status: text.status,
            status_evidence: text.evidence(),
            started_at,
            header_tags: header_tags
                .map(|(key, value)| (key.clone(), value.clone(), format!("# {key}")))
                .collect(),
            tables,
            original_metadata: metadata,
            issues,
            ..self.reading()
        })
    }
}

/// What lines hold: the tables of runs, the start that they state, and the index of the line of the names.
pub type Runs = (Vec<RunTable>, Option<StartedAt>, Option<usize>);

/// The runs in lines: more than one where a logger was started anew.
///
/// # Errors
/// As [`table::tables`], [`times::settle`] and [`assemble`].
pub fn runs(
    lines: &[Line<'_>],
    context: &ReadContext,
    must_be_run: bool,
    issues: &mut Vec<Issue>,
) -> Result<Runs, ReadError> {
    let tables = table::tables(lines, is_flag, context)?;
    let blocks = tables[0].layout.blocks(lines);
    if !blocks.is_empty() {
        return side_by_side(lines, blocks, context, must_be_run, issues);
    }
    issues.extend(tables[0].layout.between(lines));
    let stated = context.answers.table();
    if stated.is_none() {
        issues.extend(said_by_unit(&tables[0].headers, |_| true));
    }
    if !tables[0].layout.own_numbers.is_empty() {
        let message = "columns have decimal marks of their own: a comma in some, a point in others; each is read by its own";
        issues.push(Issue::note("decimal-marks-differ", message));
    }
    let shape = &tables[0].layout.shape;
    let names_at = shape.names_at.or(stated.map(|_| shape.data_at));
    let head = || lines[..names_at.unwrap_or(0)].iter().map(|line| line.text);
    let start_line = stated.and_then(|stated| stated.start.as_ref());
    let named = start_line.and_then(|line| start::behind(head(), line, issues));
    let mut started_at = start::answered(start::stated(head(), context.date_order), &context.answers);
    let several = tables.len() > 1;
    let mut found = Vec::new();
    for (index, mut table) in tables.into_iter().enumerate() {
        let settled = times::settle(&mut table, context, issues)?;
        if index == 0 {
            let names = settled
                .spent
                .iter()
                .map(|at| table.headers[*at].raw_name.as_str());
            let own = named.clone().or(settled.started_at);
            started_at = zone::complete(own.or(started_at), names, head(), issues);
        } else if settled.started_at.is_some() {
            // Each part has its own moment; a file has one.
            let message = format!(
                "part {} began at another moment than the file; only the first start is kept",
                index + 1
            );
            issues.push(Issue::warning("starts-differ", message));
        }
        table.drop_columns(&settled.spent);
        let raw = Raw {
            name: if several {
                format!("part {}", index + 1)
            } else {
                String::new()
            },
            headers: table.headers,
            cells: table.cells,
            flags: Vec::new(),
            printed_time: None,
            time_zero_is_step: stated.map_or(!settled.is_clock, |stated| stated.zero_is_step),
            must_be_run,
            must_respond: context.needs_response,
        };
        found.push(RunTable {
            clock_set_back: settled.set_back,
            ..assemble(raw, issues)?
        });
    }
    if several {
        let message = format!(
            "the names stand {} times: a logger that was started anew; each part is a run",
            found.len()
        );
        issues.push(Issue::note("logger-restarted", message));
    }
    Ok((found, started_at, names_at))
}

/// The runs of blocks of columns that stand side by side, each read as a text of its own.
fn side_by_side(
    lines: &[Line<'_>],
    blocks: Vec<(String, Vec<Line<'_>>)>,
    context: &ReadContext,
    must_be_run: bool,
    issues: &mut Vec<Issue>,
) -> Result<Runs, ReadError> {
    let names_at = blocks[0].1.first().map_or(0, |names| names.number);
    let names_at = lines.iter().position(|line| line.number == names_at);
    let head = lines[..names_at.unwrap_or(0)].iter().map(|line| line.text);
    let mut started_at = start::answered(start::stated(head, context.date_order), &context.answers);
    let mut found = Vec::new();
    let message = format!(
        "the same names stand {} times side by side: each block of columns is a run",
        blocks.len()
    );
    issues.push(Issue::note("blocks-side-by-side", message));
    for (index, (label, block)) in blocks.into_iter().enumerate() {
        let (tables, own_start, _) = runs(&block, context, must_be_run, issues)?;
        started_at = started_at.or(own_start);
        let name = if label.is_empty() {
            format!("block {}", index + 1)
        } else {
            label
        };
        found.extend(tables.into_iter().map(|table| RunTable {
            name: if table.name.is_empty() {
                name.clone()
            } else {
                format!("{name}, {}", table.name)
            },
            ..table
        }));
    }
    Ok((found, started_at, names_at))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::read;

    fn table(text: &str) -> Result<Reading, ReadError> {
        read("run.csv", text.as_bytes(), &ReadContext::default())
    }

    #[test]
    fn rows_with_dates_are_read_as_a_profile_would_be_proposed() {
        let dates = "Datum;Zeit;Strom (mA);Spannung (V)\n15.02.2026;10:00:00;0,5;1,5\n15.02.2026;10:00:02;1,5;1,5\n\
                     15.02.2026;10:00:04;2,5;1,5\n";
        let reading = table(dates).unwrap();
        assert_eq!(
            (reading.format, reading.tables[0].time_first_last_s),
            ("plain-table", Some((0.0, 4.0)))
        );
        assert_eq!(
            reading.started_at.unwrap().local.as_deref(),
            Some("2026-02-15T10:00:00")
        );
        let current = reading.tables[0]
            .channels
            .iter()
            .find(|c| c.quantity == Quantity::Current)
            .unwrap();
        assert_eq!(&current.values[..], [5e-4, 1.5e-3, 2.5e-3]);
        let times = "Time;Current (mA)\n10:00:00;0,5\n10:00:02;1,5\n";
        assert_eq!(
            table(times).unwrap().tables[0].time_first_last_s,
            Some((0.0, 2.0))
        );
    }

    #[test]
    fn a_logger_that_was_started_anew_wrote_several_runs() {
        let rows: String = (0..9).map(|k| format!("{k},1e-3\n")).collect();
        let part = format!("time_s,current_a\n{rows}");
        let reading = table(&format!("{part}Logging to: LD2.CSV\n{part}")).unwrap();
        let rows: Vec<usize> = reading.tables.iter().map(|table| table.rows).collect();
        assert_eq!(rows, [9, 9]);
        assert!(reading.issues.iter().any(|issue| issue.code == "lines-between"));
    }

    #[test]
    fn dates_beside_a_time_show_its_unit() {
        let mut text = "Timestamp,Time,Current (A)\n".to_owned();
        (0..30).for_each(|k| text.push_str(&format!("2026-03-19 14:00:{k:02},{},1e-3\n", 1000 * k)));
        let reading = table(&text).unwrap();
        assert_eq!(reading.tables[0].time_first_last_s, Some((0.0, 29.0)));
        assert!(reading.issues.iter().any(|issue| issue.code == "time-unit-shown"));
    }

    #[test]
    fn what_a_profile_would_leave_open_or_misread_stays_refused() {
        for text in [
            "Time;Current (mA)\n01/02/2026 10:00:00;0,5\n01/02/2026 10:00:02;1,5\n",
            "time_s,current_a\n0,5,1,5\n1,5,2,5\n2,5,3,5\n",
            "Time;Current (mA)\n10:00:00;0,5\n10:00:02;1.5\n",
            "Time;Current\n10:00:00;0,5\n10:00:02;1,5\n",
        ] {
            assert!(table(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_data_logger_of_keysight_is_read_in_utf_16() {
        let mut text =
            "Name:,strip\r\nInstrument:,34972A\r\nAcquisition Date:,10/15/2026 2:12:32 PM\r\n".to_owned();
        (0..80).for_each(|k| text.push_str(&format!("{},input,DCV,Auto\r\n", 101 + k)));
        text.push_str("Scan,Time,101 <voltage> (VDC),102 <current> (ADC)\r\n");
        (0..3).for_each(|k| {
            text.push_str(&format!(
                "{},10/15/2026 14:12:3{k}:250,1.5,{}.5E-03\r\n",
                k + 1,
                k
            ))
        });
        let bytes: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        for mark in [&[][..], &[0xFF, 0xFE]] {
            let reading = read("dat.csv", &[mark, &bytes].concat(), &ReadContext::default()).unwrap();
            assert_eq!(
                (reading.format, reading.encoding),
                ("plain-table", Some("utf-16le"))
            );
            assert_eq!(reading.tables[0].time_first_last_s, Some((0.0, 2.0)));
            let found: Vec<(Quantity, f64)> = reading.tables[0]
                .channels
                .iter()
                .map(|c| (c.quantity, c.values[2]))
                .collect();
            assert!(
                found.contains(&(Quantity::Voltage, 1.5)) && found.contains(&(Quantity::Current, 2.5e-3)),
                "{found:?}"
            );
        }
    }

    #[test]
    fn a_modulus_log_of_an_eplexor_as_text_has_its_units_in_the_second_row() {
        let names =
            "Nr;F stat.;Time;f;T;E';E'';|E*|;tan delta;|J*|\r\n;N;s;Hz;\u{b0}C;MPa;MPa;MPa;;1/MPa\r\n";
        let text = format!(
            "{names}1;0,5;10,5;1;25;60,5;11,2;61,5;0,185;0,016\r\n2;0,5;11,5;1;25;60;11;61;0,18;---\r\n"
        );
        let reading = table(&text).unwrap();
        assert_eq!(reading.tables[0].time_first_last_s, Some((10.5, 11.5)));
        let sweep = "Nr;f;T;E';tan delta\r\n;Hz;\u{b0}C;MPa;\r\n1;0,5;25;60,5;0,185\r\n2;1;25;61;0,18\r\n";
        let reading = table(sweep).unwrap();
        let found: Vec<Quantity> = reading.tables[0].channels.iter().map(|c| c.quantity).collect();
        let expected = [
            Quantity::Frequency,
            Quantity::Temperature,
            Quantity::StorageModulus,
            Quantity::LossFactor,
        ];
        assert_eq!(found[1..], expected);
        assert_eq!(reading.tables[0].time_column, None);
        assert!(reading.issues.iter().any(|issue| issue.code == "time-not-used"));
    }

    #[test]
    fn an_oscilloscope_of_keysight_numbers_its_inputs() {
        let text = "x-axis,1,2\nsecond,Volt,Ampere\n-1.0E-03,0.0E+00,1.5E-03\n+0.0E+00,5.0E-01,2.5E-03\n";
        let reading = table(text).unwrap();
        let found: Vec<Quantity> = reading.tables[0].channels.iter().map(|c| c.quantity).collect();
        assert_eq!(found, [Quantity::Voltage, Quantity::Current]);
        let refused = table("x-axis,1,2\nsecond,Volt,Volt\n0,0.5,1\n1,1,2\n").unwrap_err();
        assert!(matches!(refused, ReadError::NoResponse { .. }), "{refused}");
    }
}
