//! PicoLog text: a first column without a name that counts Unix seconds, then quoted names with units.

use super::table::read_lines;
use crate::Reading;
use crate::formats::recognition::{FileHead, Match};
use crate::formats::{About, Format, ReadContext, ReadError, delimited};
use crate::table::epoch;
use crate::text::{Line, Lines};

/// Reader of PicoLog text.
pub struct Picolog;

impl Format for Picolog {
    fn about(&self) -> About {
        About {
            id: "picolog",
            title: "Pico Technology PicoLog climate logger, text with Unix seconds (.csv)",
            extensions: &["csv"],
            version: 4,
        }
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        let text = head.text().unwrap_or_default();
        let mut lines = Lines::new(&text).map(|line| line.text);
        let (first, second) = (lines.next().unwrap_or(""), lines.next().unwrap_or(""));
        Match::certain_if(
            first.starts_with("\"\",\"") && second.split(',').next().is_some_and(epoch::is_moment),
            "a first column without a name that counts Unix seconds",
        )
    }

    fn read(&self, bytes: &[u8], context: &ReadContext) -> Result<Reading, ReadError> {
        let mut issues = Vec::new();
        let decoded = delimited::decoded(bytes)?;
        let text = delimited::text(&decoded, &mut issues)?;
        let mut lines = text.lines.clone();
        let names = lines[0].text.replacen("\"\"", "\"Unix time\"", 1);
        lines[0] = Line {
            text: &names,
            ..lines[0]
        };
        let status = (text.status, text.evidence());
        read_lines(
            self.reading(),
            Some(text.encoding),
            context,
            &lines,
            status,
            issues,
        )
    }
}
