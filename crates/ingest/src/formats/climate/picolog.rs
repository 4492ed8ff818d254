//! PicoLog text: a first column without a name that counts Unix seconds, then quoted names with units.

use super::table::read_text;
use crate::Reading;
use crate::formats::recognition::{FileHead, Match};
use crate::formats::{About, Format, ReadContext, ReadError, delimited};
use crate::table::epoch;
use crate::text::Lines;

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
        let mut lines = Lines::new(text).map(|line| line.text);
        let (first, second) = (lines.next().unwrap_or(""), lines.next().unwrap_or(""));
        Match::certain_if(
            first.starts_with("\"\",\"") && second.split(',').next().is_some_and(epoch::is_moment),
            "a first column without a name that counts Unix seconds",
        )
    }

    fn read(&self, bytes: &[u8], context: &ReadContext) -> Result<Reading, ReadError> {
        let mut decoded = delimited::decoded(bytes)?;
        decoded.text = decoded.text.replacen("\"\"", "\"Unix time\"", 1).into();
        read_text(self.reading(), &decoded, context, |_| Ok(0))
    }
}
