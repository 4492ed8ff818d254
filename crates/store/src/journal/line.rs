//! A line of the journal: JSON whose last field is a checksum over what stands before it.

use super::entry::Line;

/// What every line begins with.
pub(super) const BEGIN: &str = "{\"n\":";
/// What stands between the entry and its checksum.
const BEFORE_SUM: &str = ",\"sum\":\"";
/// What ends a line, but for the line feed.
const AFTER_SUM: &str = "\"}";
/// Hexadecimal digits of BLAKE3 that are kept.
const SUM_DIGITS: usize = 32;

/// The line with its checksum and line feed.
pub(super) fn written(line: &Line) -> serde_json::Result<String> {
    let body = serde_json::to_string(line)?;
    let open = body.strip_suffix('}').unwrap_or(&body);
    Ok(format!("{open}{BEFORE_SUM}{}{AFTER_SUM}\n", sum(open)))
}

/// What a line says, given without its line feed; or why it cannot be trusted.
pub(super) fn read(text: &[u8]) -> Result<Line, String> {
    let text = std::str::from_utf8(text).map_err(|_| "it is no text".to_owned())?;
    let parts = text
        .strip_suffix(AFTER_SUM)
        .and_then(|rest| rest.rsplit_once(BEFORE_SUM));
    let (open, stated) = parts.ok_or("it does not end with a checksum")?;
    if sum(open) != stated {
        return Err("its checksum does not match".to_owned());
    }
    serde_json::from_str(&format!("{open}}}")).map_err(|e| format!("it does not read back: {e}"))
}

fn sum(open: &str) -> String {
    let mut sum = blake3::hash(open.as_bytes()).to_hex().to_string();
    sum.truncate(SUM_DIGITS);
    sum
}
