//! A line of the journal: JSON whose last field is a checksum over what stands before it.

use super::entry::{Entry, Line};

/// What every line begins with.
pub(super) const BEGIN: &str = "{\"n\":";
/// What stands between the entry and its checksum.
const BEFORE_SUM: &str = ",\"sum\":\"";
/// What ends a line, but for the line feed.
const AFTER_SUM: &str = "\"}";
/// Hexadecimal digits of BLAKE3 that are kept.
const SUM_DIGITS: usize = 32;

impl Line {
    /// The line that follows the one with the checksum `after`; none where it is the first.
    pub(super) fn following(
        after: Option<&str>,
        n: u64,
        (at, entry, of): (String, Entry, Option<String>),
    ) -> serde_json::Result<Line> {
        let mut line = Line {
            n,
            at,
            entry,
            of,
            after: after.map(str::to_owned),
            text: String::new(),
        };
        let body = serde_json::to_string(&line)?;
        let open = body.strip_suffix('}').unwrap_or(&body);
        line.text = format!("{open}{BEFORE_SUM}{}{AFTER_SUM}", sum(open));
        Ok(line)
    }

    /// Its checksum. It holds that of the line before, so that of a last line is one over all of them.
    pub fn sum(&self) -> &str {
        sum_of(&self.text).unwrap_or_default()
    }
}

/// What a line says, given without its line feed; or why it cannot be trusted.
pub(super) fn read(text: &[u8]) -> Result<Line, String> {
    let text = std::str::from_utf8(text).map_err(|_| "it is no text".to_owned())?;
    let stated = sum_of(text).ok_or("it does not end with a checksum")?;
    let open = &text[..text.len() - stated.len() - BEFORE_SUM.len() - AFTER_SUM.len()];
    if sum(open) != stated {
        return Err("its checksum does not match".to_owned());
    }
    let line: Line =
        serde_json::from_str(&format!("{open}}}")).map_err(|e| format!("it does not read back: {e}"))?;
    let text = text.to_owned();
    Ok(Line { text, ..line })
}

/// The checksum that a line states.
fn sum_of(text: &str) -> Option<&str> {
    let (_, sum) = text.strip_suffix(AFTER_SUM)?.rsplit_once(BEFORE_SUM)?;
    Some(sum)
}

fn sum(open: &str) -> String {
    let mut sum = blake3::hash(open.as_bytes()).to_hex().to_string();
    sum.truncate(SUM_DIGITS);
    sum
}
