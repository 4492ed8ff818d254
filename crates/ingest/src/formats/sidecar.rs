//! Files that instrument software writes beside a run: logs, settings, methods, indices. They hold no readings.

use super::error::ReadError;
use super::recognition::FileHead;
use crate::text::{Lines, decode};

/// Says so where the file is a sidecar, judged by how it begins; only files without any mark of their own are
/// judged by their extension, too.
///
/// # Errors
/// [`ReadError::Sidecar`], with what it is.
pub fn check(head: &FileHead<'_>) -> Result<(), ReadError> {
    match binary(head).or_else(|| text(head)) {
        Some((kind, sign)) => Err(ReadError::Sidecar { kind, sign }),
        None => Ok(()),
    }
}

type Sidecar = (&'static str, &'static str);

fn binary(head: &FileHead<'_>) -> Option<Sidecar> {
    /// Eleven NUL bytes and more stand at places where no text has them; the state file has no mark.
    const STATE_FILE_BYTES: u64 = 4096;
    let extension = head.extension();
    match head.bytes {
        [b'T', b'D', b'S', b'h', ..] => Some(("TDMS index", "the file begins with TDSh")),
        [0x80, 2..=5, ..] if extension == "pkl" => {
            Some(("cache of a script", "a pickle with the extension .pkl"))
        }
        [0, 0, 0, 0, ..] if extension == "sta" && head.size <= STATE_FILE_BYTES => Some((
            "EC-Lab state of a channel",
            "a small binary file with the extension .sta",
        )),
        bytes
            if bytes.starts_with(b"SQLite format 3\0")
                && head.name.to_lowercase().ends_with(".idf.sqlite") =>
        {
            Some((
                "IviumSoft database of a run",
                "an SQLite database named .idf.sqlite",
            ))
        }
        _ => None,
    }
}

fn text(head: &FileHead<'_>) -> Option<Sidecar> {
    let start = &head.bytes[..head.bytes.len().min(4096)];
    let decoded = decode(start);
    let extension = head.extension();
    let mut lines = Lines::new(&decoded.text)
        .filter(|line| line.ended)
        .map(|line| line.text.trim());
    let (first, second) = (lines.next()?, lines.next().unwrap_or(""));
    let is_method = |line: &str| line.starts_with("Method=");
    let upper = first.to_ascii_uppercase();
    if upper == "EC-LAB LOG FILE" || upper == "BT-LAB LOG FILE" {
        return Some(("EC-Lab log", "the file begins with EC-Lab LOG FILE"));
    }
    if upper == "EC-LAB SETTING FILE" || upper == "BT-LAB SETTING FILE" {
        return Some(("EC-Lab settings", "the file begins with EC-LAB SETTING FILE"));
    }
    if first.starts_with("<?xml") && extension == "mgr" {
        return Some(("EC-Lab display settings", "XML with the extension .mgr"));
    }
    // A comment alone may stand above a table of readings.
    if first.starts_with("#PSTrace") && lines.any(|line| line.starts_with("METHOD_")) {
        return Some((
            "PSTrace method",
            "the file begins with #PSTrace and names a METHOD",
        ));
    }
    (is_method(first) || (first.starts_with("Version=") && is_method(second)))
        .then_some(("Ivium method", "the file begins with Version and Method"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kind(name: &str, bytes: &[u8]) -> Option<&'static str> {
        match check(&FileHead::of(name, bytes)) {
            Err(ReadError::Sidecar { kind, .. }) => Some(kind),
            _ => None,
        }
    }

    #[test]
    fn sidecars_are_known_by_how_they_begin() {
        for (name, bytes, expected) in [
            ("a.mpl", &b"EC-Lab LOG FILE\r\n\r\n"[..], Some("EC-Lab log")),
            ("a.mps", b"EC-LAB SETTING FILE\n", Some("EC-Lab settings")),
            ("a.sta", b"\0\0\0\0\0\x25\x30", Some("EC-Lab state of a channel")),
            (
                "a.mgr",
                b"<?xml version=\"1.0\"?>\n",
                Some("EC-Lab display settings"),
            ),
            ("a.tdms_index", b"TDSh\x0e\0\0\0", Some("TDMS index")),
            (
                "a.psmethod",
                b"#PSTrace 5.12,unknown\r\n#a comment\r\nMETHOD_ID=cv\r\n",
                Some("PSTrace method"),
            ),
            ("a.csv", b"#PSTrace, typed off\ntime_s,current_a\n0,1\n", None),
            (
                "a.imf",
                b"Version= 15\r\nMethod=Transients\r\n",
                Some("Ivium method"),
            ),
            (
                "a.idf.sqlite",
                b"SQLite format 3\0",
                Some("IviumSoft database of a run"),
            ),
            ("a.pkl", b"\x80\x04\x95", Some("cache of a script")),
            ("a.csv", b"time_s,current_a\n0,1\n", None),
            ("a.idf", b"\0\0\0\0Version=12\r\nMethod=Transients\r\n", None),
            ("a.sqlite", b"SQLite format 3\0", None),
            ("a.xml", b"<?xml version=\"1.0\"?>\n", None),
        ] {
            assert_eq!(kind(name, bytes), expected, "{name}");
        }
    }
}
