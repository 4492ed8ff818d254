//! Which format a file has: by its content; the extension only breaks a tie.

use super::error::{ReadError, quoted};
use super::{ALL, no_data, sidecar, unread};
use crate::formats::policy::{CERTAIN, EXTENSION, LEAD};
use crate::profiles::propose;
use crate::text::decode;

pub use super::format::{FileHead, Format, Match};
pub use crate::text::policy::HEAD_BYTES;

/// A format that fits, with its score.
#[derive(Clone, Copy)]
pub struct Candidate {
    /// The format.
    pub format: &'static dyn Format,
    /// 1 for a certain match, less for a possible one, without the extension's part.
    pub score: f64,
    /// What speaks for it.
    pub reason: &'static str,
}

impl std::fmt::Debug for Candidate {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {} ({})", self.format.id(), self.score, self.reason)
    }
}

/// The format of a file, with everything that fits, the best first.
///
/// # Errors
/// The file is empty, a sidecar of a run, nothing fits, or the best does not lead clearly.
pub fn recognise(head: &FileHead<'_>) -> Result<(&'static dyn Format, Vec<Candidate>), ReadError> {
    if head.size == 0 {
        return Err(ReadError::Empty);
    }
    sidecar::check(head)?;
    let extension = head.extension();
    let with_extension = |candidate: &Candidate| {
        let bonus = candidate.format.about().extensions.contains(&extension.as_str());
        candidate.score + if bonus { EXTENSION } else { 0.0 }
    };
    let mut candidates = candidates(head);
    candidates.sort_by(|a, b| with_extension(b).total_cmp(&with_extension(a)));
    if candidates.iter().all(|candidate| candidate.score < CERTAIN)
        && let Some(refusal) = unread::refusal(head)
    {
        return Err(refusal);
    }
    match candidates.as_slice() {
        [] => no_data::check(head).and(Err(unknown(head))),
        [first, second, ..] if leads(first, second, with_extension) => Ok((first.format, candidates)),
        [only] => Ok((only.format, candidates)),
        _ => Err(ReadError::AmbiguousFormat {
            candidates: candidates
                .iter()
                .map(|c| format!("{c:?}"))
                .collect::<Vec<_>>()
                .join(", "),
        }),
    }
}

/// Every format that fits, in no order; no file is too small or a sidecar here.
pub fn candidates(head: &FileHead<'_>) -> Vec<Candidate> {
    ALL.iter().filter_map(|&format| candidate(format, head)).collect()
}

/// Whether a text bears the mark of an instrument's own format.
pub fn is_of_instrument(head: &FileHead<'_>) -> bool {
    ALL.iter()
        .any(|format| matches!(format.recognise(head), Match::Certain(_)))
}

/// Whether the first leads by content, or is as good by content and has the extension for it.
fn leads(first: &Candidate, second: &Candidate, with_extension: impl Fn(&Candidate) -> f64) -> bool {
    let by_content = first.score - second.score;
    by_content >= LEAD - 1e-9
        || (by_content >= -1e-9 && with_extension(first) - with_extension(second) >= EXTENSION - 1e-9)
}

fn candidate(format: &'static dyn Format, head: &FileHead<'_>) -> Option<Candidate> {
    let (score, reason) = match format.recognise(head) {
        Match::Certain(reason) => (CERTAIN, reason),
        Match::Possible { score, reason } => (score, reason),
        Match::No => return None,
    };
    Some(Candidate {
        format,
        score,
        reason,
    })
}

fn unknown(head: &FileHead<'_>) -> ReadError {
    let begins = decode(&head.bytes[..head.bytes.len().min(120)]);
    let first_line = begins.text.lines().next().unwrap_or("");
    let tried: Vec<&str> = ALL.iter().map(|format| format.id()).collect();
    ReadError::UnknownFormat {
        found: quoted(first_line),
        tried: tried.join(", "),
        is_table: propose(head.name, head.bytes, &[]).is_ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn id(name: &str, bytes: &[u8]) -> Result<&'static str, ReadError> {
        recognise(&FileHead::of(name, bytes)).map(|(format, _)| format.id())
    }

    #[test]
    fn content_decides_against_the_extension() {
        assert_eq!(id("a.csv", b"EXPLAIN\r\nTAG\tCHRONOA\r\n"), Ok("gamry-dta"));
        assert_eq!(id("a.DTA", b"time_s,current_a\n0,1\n"), Ok("plain-table"));
        assert_eq!(
            id("a.csv", b"Time (s),WE(1).Current (A)\n0,1\n"),
            Ok("autolab-nova")
        );
        assert_eq!(
            id("a.txt", b"PK\x03\x04....[Content_Types].xml"),
            Ok("spreadsheet")
        );
    }

    #[test]
    fn what_no_format_knows_is_refused_with_what_was_tried() {
        let error = id("a.csv", b"\x1b[31mhello\nworld\n").unwrap_err();
        let message = error.to_string();
        assert!(
            message.contains(r#""\u{1b}[31mhello""#) && message.contains("gamry-dta, autolab-nova"),
            "{message}"
        );
        assert!(id("a.avro", b"Obj\x01\x04\0\x15").is_err());
    }
}
