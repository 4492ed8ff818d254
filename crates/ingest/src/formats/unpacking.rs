//! How large a packed file gets: counted by unpacking it, for a declared size may lie.

use std::borrow::Cow;
use std::io::{self, Cursor, Read};

use flate2::read::MultiGzDecoder;

use zip::ZipArchive;

use super::error::{ReadError, escaped};

/// What kind of container a message speaks of.
const KIND: &str = "spreadsheet (zip archive)";

/// What a file packed with gzip begins with, and how its name ends.
const GZIP: &[u8] = &[0x1f, 0x8b];
const GZIP_EXTENSION: &str = ".gz";

/// A file as its reader takes it: what gzip packed (`run.csv.gz`) under the name and with the bytes that it had before.
///
/// # Errors
/// It is damaged, or unpacks to more than `limit` bytes.
pub fn of_gzip<'f>(
    name: &'f str,
    bytes: &'f [u8],
    limit: u64,
) -> Result<(&'f str, Cow<'f, [u8]>), ReadError> {
    if !bytes.starts_with(GZIP) {
        return Ok((name, Cow::Borrowed(bytes)));
    }
    let mut unpacked = Vec::new();
    let read = MultiGzDecoder::new(bytes)
        .take(limit + 1)
        .read_to_end(&mut unpacked);
    read.map_err(|error| ReadError::BrokenContainer {
        kind: "file packed with gzip",
        found: escaped(&error.to_string()),
    })?;
    if unpacked.len() as u64 > limit {
        return Err(ReadError::TooLarge {
            what: "the file, once unpacked,".to_owned(),
            found: unpacked.len() as u64,
            limit,
        });
    }
    let own = name.len().checked_sub(GZIP_EXTENSION.len());
    let own = own.filter(|at| {
        name.get(*at..)
            .is_some_and(|end| end.eq_ignore_ascii_case(GZIP_EXTENSION))
    });
    Ok((&name[..own.unwrap_or(name.len())], Cow::Owned(unpacked)))
}

/// Unpacks every member into nothing and sees that all together stay below `limit` bytes.
///
/// # Errors
/// The archive is damaged, or unpacks to more than `limit` bytes.
pub fn check_size(bytes: &[u8], limit: u64) -> Result<(), ReadError> {
    let broken = |error: &dyn std::fmt::Display| ReadError::BrokenContainer {
        kind: KIND,
        found: escaped(&error.to_string()),
    };
    let too_large = |found: u64| ReadError::TooLarge {
        what: "the spreadsheet, once unpacked,".to_owned(),
        found,
        limit,
    };
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|error| broken(&error))?;
    let mut declared: u64 = 0;
    for index in 0..archive.len() {
        let member = archive.by_index(index).map_err(|error| broken(&error))?;
        declared = declared.saturating_add(member.size());
        if declared > limit {
            return Err(too_large(declared));
        }
    }
    let mut unpacked: u64 = 0;
    for index in 0..archive.len() {
        let member = archive.by_index(index).map_err(|error| broken(&error))?;
        let mut counted = member.take(limit - unpacked + 1);
        unpacked += io::copy(&mut counted, &mut io::sink()).map_err(|error| broken(&error))?;
        if unpacked > limit {
            return Err(too_large(unpacked));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use zip::write::SimpleFileOptions;
    use zip::{CompressionMethod, ZipWriter};

    use super::*;

    fn zip(size: usize) -> Vec<u8> {
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
        writer.start_file("xl/worksheets/sheet1.xml", options).unwrap();
        writer.write_all(&vec![b' '; size]).unwrap();
        writer.finish().unwrap().into_inner()
    }

    fn gzip(bytes: &[u8]) -> Vec<u8> {
        let mut writer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
        writer.write_all(bytes).unwrap();
        writer.finish().unwrap()
    }

    #[test]
    fn a_table_packed_with_gzip_is_read_as_the_table() {
        let text = b"time_s,voltage_v,current_a\n0,1,0.5\n1,1,0.25\n2,1,0.125\n";
        let context = crate::formats::ReadContext::default();
        let read =
            |name: &str, bytes: &[u8]| crate::profiles::read(&[], name, bytes, &context).map(|(own, _)| own);
        let packed = gzip(text);
        assert_eq!(read("run.bdf.gz", &packed), read("run.bdf", text));
        // Cut short it is damaged, and no other table.
        let cut = read("run.csv.gz", &packed[..packed.len() - 10]).unwrap_err();
        assert!(matches!(cut, ReadError::BrokenContainer { .. }), "{cut}");
        let large = of_gzip("a.csv.gz", &gzip(&[b' '; 100_000]), 99_999).unwrap_err();
        assert!(matches!(large, ReadError::TooLarge { .. }), "{large}");
    }

    #[test]
    fn what_unpacks_to_too_much_is_refused() {
        let bytes = zip(100_000);
        assert!(bytes.len() < 1_000);
        assert_eq!(check_size(&bytes, 100_000), Ok(()));
        assert!(matches!(
            check_size(&bytes, 99_999),
            Err(ReadError::TooLarge { found: 100_000, .. })
        ));
    }

    #[test]
    fn a_declared_size_that_lies_is_found_out() {
        let mut bytes = zip(100_000);
        let size = 100_000u32.to_le_bytes();
        let places: Vec<usize> = (0..bytes.len() - 4)
            .filter(|&at| bytes[at..at + 4] == size)
            .collect();
        assert_eq!(places.len(), 2, "local header and central directory");
        for at in places {
            bytes[at..at + 4].copy_from_slice(&10u32.to_le_bytes());
        }
        assert!(check_size(&bytes, 50_000).is_err());
    }

    #[test]
    fn a_damaged_archive_is_named() {
        let bytes = zip(1_000);
        let error = check_size(&bytes[..bytes.len() / 2], 1 << 20).unwrap_err();
        assert!(matches!(error, ReadError::BrokenContainer { .. }), "{error}");
    }
}
