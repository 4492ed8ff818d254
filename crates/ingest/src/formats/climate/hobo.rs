//! Onset HOBO loggers: text of HOBOware (`Plot Title`, in German `Plot-Titel`) and HOBOmobile (`Serial Number`).
//!
//! Names hold quantity, unit and serial numbers: `Temp, °F (LGR S/N: 1, SEN S/N: 2)`, `RH, (%)`. The offset from UTC
//! stands in the name of the date column and is fixed, without summer time. Columns without a unit are events (`Logged`);
//! the last of them says that the log was read out. Relative humidity above 100 % occurs and is kept. The rest is as in
//! any table of a logger.

use super::table::read_text;
use crate::Reading;
use crate::formats::recognition::{FileHead, Match};
use crate::formats::{About, Format, ReadContext, ReadError, delimited};
use crate::text::{Line, Lines};
use ieap_domain::RunStatus;

/// Reader of HOBO text.
pub struct Hobo;

impl Format for Hobo {
    fn about(&self) -> About {
        About {
            id: "hobo",
            title: "Onset HOBO climate logger, text of HOBOware or HOBOmobile (.csv)",
            extensions: &["csv", "txt"],
            version: 4,
        }
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        const BEGINS: [&str; 3] = ["Plot Title:", "Plot-Titel:", "Serial Number:"];
        const DATES: [&str; 3] = ["Date Time", "Time,", "Datum Zeit"];
        let text = head.text().unwrap_or_default();
        let first = text.trim_start_matches('"');
        let mut lines = Lines::new(text).take(4);
        let names_date =
            |line: Line<'_>| line.text.contains("GMT") && DATES.iter().any(|date| line.text.contains(date));
        Match::certain_if(
            BEGINS.iter().any(|begin| first.starts_with(begin)) && lines.any(names_date),
            "Plot Title or Serial Number, then a column Date Time with GMT",
        )
    }

    fn read(&self, bytes: &[u8], context: &ReadContext) -> Result<Reading, ReadError> {
        let mut is_read_out = false;
        let reading = read_text(self.reading(), &delimited::decoded(bytes)?, context, |lines| {
            is_read_out = lines.last().is_some_and(|line| ends_the_log(line.text));
            Ok(0)
        })?;
        Ok(match reading.status {
            RunStatus::Complete if is_read_out => Reading {
                status_evidence: "the last row is an event of the read-out".to_owned(),
                ..reading
            },
            _ => reading,
        })
    }
}

/// The last row of a log that was read out names the end of the file as an event.
fn ends_the_log(row: &str) -> bool {
    let filled = row.trim_end_matches([',', ';', '\t']);
    ["Logged", "Protokolliert"]
        .iter()
        .any(|event| filled.ends_with(event))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::read;
    use ieap_domain::Quantity;

    #[test]
    fn a_german_log_is_read_between_commas_and_between_semicolons() {
        let title = "\u{feff}\"Plot-Titel: 10347351\"\r\n";
        let commas = format!(
            "{title}\"Anz.\",\"Datum Zeit, GMT+02:00\",\"Temp., \u{b0}C (LGR S/N: 10347351, SEN S/N: 7)\",\"RH, % (LGR S/N: \
             10347351)\",\"Gestoppt\"\r\n1,\"31.05.26 23:50:00\",\"21,5\",\"40,25\",\r\n2,\"01.06.26 00:00:00\",\"21,75\",\"41\",\r\n"
        );
        let semicolons = format!(
            "{title}\"Anz.\";\"Datum Zeit, GMT+02:00\";\"Temperatur, \u{b0}C (LGR S/N: 10347351)\";\"RF, % (LGR S/N: \
             10347351)\"\r\n1;31.05.2026 23:50:00;21,5;40,25\r\n2;01.06.2026 00:00:00;21,75;41\r\n"
        );
        for text in [commas, semicolons] {
            let reading = read("log.csv", text.as_bytes(), &ReadContext::default()).unwrap();
            let start = reading.started_at.unwrap();
            assert_eq!(
                (reading.format, start.local.as_deref()),
                ("hobo", Some("2026-05-31T23:50:00"))
            );
            assert_eq!(start.offset.as_deref(), Some("+02:00"));
            let values = |quantity: Quantity| {
                let channel = reading.tables[0].channels.iter().find(|c| c.quantity == quantity);
                channel.map(|c| (c.time_s.to_vec(), c.values.to_vec()))
            };
            let expected = |first, second| Some((vec![0.0, 600.0], vec![first, second]));
            assert_eq!(values(Quantity::Temperature), expected(21.5, 21.75), "{text}");
            assert_eq!(
                values(Quantity::RelativeHumidity),
                expected(40.25, 41.0),
                "{text}"
            );
        }
    }

    #[test]
    fn columns_of_events_that_hold_nothing_for_long_are_columns() {
        let rows: String = (1..90)
            .map(|row| {
                format!(
                    "{row},05/17/26 {:02}:{:02}:00 PM,70.5,,,,,\n",
                    1 + row / 60,
                    row % 60
                )
            })
            .collect();
        let text = format!(
            "Plot Title: a\n#,\"Date Time, GMT+03:00\",\"Temp, \u{b0}F (LGR S/N: 5)\",Attached (LGR S/N: 5),Detached (LGR S/N: \
             5),Connected (LGR S/N: 5),Stopped (LGR S/N: 5),End (LGR S/N: 5)\n{rows}90,05/17/26 02:30:02 PM,,,,,,Logged\n"
        );
        let reading = read("log.csv", text.as_bytes(), &ReadContext::default()).unwrap();
        assert_eq!(reading.format, "hobo");
        assert_eq!(
            reading.started_at.unwrap().local.as_deref(),
            Some("2026-05-17T13:01:00")
        );
        assert_eq!(
            reading.status_evidence,
            "the last row is an event of the read-out"
        );
        let channel = (reading.tables[0].channels.iter())
            .find(|channel| channel.quantity == Quantity::Temperature)
            .unwrap();
        assert_eq!((channel.values.len(), channel.raw_unit.as_str()), (89, "\u{b0}F"));
    }
}
