//! Kinds of files that are known and not read: they are refused by their name, with what to do instead.

use super::error::ReadError;
use super::recognition::FileHead;

/// What a file is, and how to get its readings in.
type Kind = (&'static str, &'static str, &'static str);

const AS_TABLE: &str = "export the run as a plain table, a spreadsheet or Parquet, with units in the names";

/// The refusal of a file that is known and not read; none for any other.
pub fn refusal(head: &FileHead<'_>) -> Option<ReadError> {
    let (kind, sign, mend) = binary(head).or_else(|| text(head))?;
    Some(ReadError::NotRead { kind, sign, mend })
}

const BY_NEWARE: &str = "open it in Neware's BTSDA and export the records as Excel or CSV, with time, voltage and \
                         current and their units in the names";

fn binary(head: &FileHead<'_>) -> Option<Kind> {
    let bytes = head.bytes;
    match bytes {
        [0x89, b'H', b'D', b'F', ..] => {
            Some(("an HDF5 or NetCDF-4 file", "it begins with \\x89HDF", AS_TABLE))
        }
        [b'A', b'R', b'R', b'O', b'W', b'1', ..] | [b'F', b'E', b'A', b'1', ..] => Some((
            "a Feather or Arrow file (.feather, .arrow, .ipc)",
            "it begins with ARROW1 or FEA1",
            "write the table as Parquet, which keeps its columns and units: pyarrow.parquet.write_table, or to_parquet of pandas",
        )),
        [b'C', b'D', b'F', 1 | 2 | 5, ..] => Some(("a NetCDF-3 file", "it begins with CDF", AS_TABLE)),
        [b'P', b'K', 3, 4, ..] => zip(head),
        [b'N', b'E', b'W', b'A', b'R', b'E', ..] => Some((
            "a binary file of Neware (.nda)",
            "it begins with NEWARE",
            BY_NEWARE,
        )),
        [_, _, _, _, name @ ..]
            if name.starts_with(b"Standard Jet DB") || name.starts_with(b"Standard ACE DB") =>
        {
            Some(access(head))
        }
        // The beginning of both files that were seen; alone it would be too little.
        [0, 0, 0xFF, 0xFF, 0xFF, 0xFE | 0xFF, ..] if head.extension() == "ism" => Some((
            "a binary impedance file of Zahner (.ism)",
            "the extension .ism, and the first six bytes of such files",
            "export the spectrum as text: frequency, real and imaginary part, with units in the names",
        )),
        bytes if bytes.starts_with(b"SQLite format 3\0") => {
            Some(("an SQLite database", "it begins with SQLite format 3", AS_TABLE))
        }
        _ => None,
    }
}

fn zip(head: &FileHead<'_>) -> Option<Kind> {
    /// Bytes before the name of the first member of a zip archive.
    const NAME_AT: usize = 30;
    let member = head.bytes.get(NAME_AT..).unwrap_or_default();
    if member.starts_with(b"Streams/") {
        Some((
            "a binary file of NETZSCH Proteus (.ngb-*)",
            "a zip archive of Streams/",
            "export it as text from Proteus (ASCII file, with names and units)",
        ))
    } else if member.starts_with(b"mimetypeapplication/vnd.oasis.opendocument.spreadsheet") {
        Some((
            "an OpenDocument spreadsheet (.ods)",
            "a zip archive that says so in its mimetype",
            "open it in LibreOffice and save it as Excel 2007-365 (.xlsx), or each sheet as Text CSV (.csv)",
        ))
    } else if head.extension() == "ndax" {
        Some((
            "a binary file of Neware (.ndax)",
            "a zip archive with the extension .ndax",
            BY_NEWARE,
        ))
    } else {
        None
    }
}

fn access(head: &FileHead<'_>) -> Kind {
    match head.extension().as_str() {
        "res" => (
            "a result file of Arbin (.res), which is an Access database",
            "the extension .res, and Standard Jet DB or Standard ACE DB behind its first four bytes",
            "export the test from Arbin's Data Watcher as Excel or CSV, or the table Channel_Normal_Table from the \
             database (mdb-export run.res Channel_Normal_Table > run.csv), and put the units into the names: \
             Test_Time (s), Current (A), Voltage (V)",
        ),
        _ => (
            "a Microsoft Access database",
            "Standard Jet DB or Standard ACE DB behind its first four bytes",
            AS_TABLE,
        ),
    }
}

fn text(head: &FileHead<'_>) -> Option<Kind> {
    let text = head.text()?;
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let (first, second) = (lines.next()?, lines.next().unwrap_or(""));
    let is_json =
        first.starts_with(['{', '[']) && (first.len() > 1 || second.starts_with(['"', '{', '[', '}', ']']));
    if is_json && (first == "{" || first == "[" || first.starts_with("{\"") || first.starts_with("[{")) {
        return Some(("a JSON document", "it begins with a brace", AS_TABLE));
    }
    if first.starts_with("<?xml") || first.starts_with("<!DOCTYPE") || first.starts_with("<html") {
        Some(("an XML or HTML document", "it begins with a tag", AS_TABLE))
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::recognise;

    fn error(name: &str, bytes: &[u8]) -> ReadError {
        let found = recognise(&FileHead::of(name, bytes));
        found.map(|(format, _)| format.id()).unwrap_err()
    }

    /// The beginning of a zip archive whose first member is stored as it is.
    fn zip_of(name: &str, content: &str) -> Vec<u8> {
        let mut bytes = b"PK\x03\x04\x14\0\0\0\0\0".to_vec();
        bytes.extend([0; 16]);
        bytes.extend((name.len() as u16).to_le_bytes());
        bytes.extend([0; 2]);
        bytes.extend(name.bytes().chain(content.bytes()));
        bytes
    }

    #[test]
    fn files_of_cyclers_and_of_libreoffice_are_known_and_told_how_to_export() {
        let sheet = zip_of("mimetype", "application/vnd.oasis.opendocument.spreadsheet");
        for (name, bytes, kind, how) in [
            ("a.ods", sheet.as_slice(), "OpenDocument", "LibreOffice"),
            (
                "a.res",
                b"\0\x01\0\0Standard Jet DB\0\x01\0",
                "Arbin",
                "Channel_Normal_Table",
            ),
            (
                "a.res",
                b"\0\x01\0\0Standard ACE DB\0\x02\0",
                "Arbin",
                "Channel_Normal_Table",
            ),
            (
                "a.mdb",
                b"\0\x01\0\0Standard Jet DB\0\x01\0",
                "Access",
                "plain table",
            ),
            ("a.nda", b"NEWARE\0\0\x08\0", "(.nda)", "BTSDA"),
            ("a.ndax", &zip_of("EditStep.xml", "<?xml"), "(.ndax)", "BTSDA"),
        ] {
            let error = error(name, bytes);
            let ReadError::NotRead {
                kind: found, mend, ..
            } = error
            else {
                panic!("{name}: {error}");
            };
            assert!(
                found.contains(kind) && mend.contains(how),
                "{name}: {found}; {mend}"
            );
        }
    }

    #[test]
    fn other_archives_are_no_spreadsheet_and_no_cycler() {
        let text = zip_of("mimetype", "application/vnd.oasis.opendocument.text");
        for (name, bytes) in [("a.odt", text), ("a.zip", zip_of("EditStep.xml", "<?xml"))] {
            let error = error(name, &bytes);
            assert!(
                matches!(error, ReadError::UnknownFormat { .. }),
                "{name}: {error}"
            );
        }
    }
}
