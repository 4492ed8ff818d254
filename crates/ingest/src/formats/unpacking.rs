//! How large a zipped file gets: counted by unpacking it, for a declared size may lie.

use std::io::{self, Cursor, Read};

use zip::ZipArchive;

use super::error::{ReadError, escaped};

/// What kind of container a message speaks of.
const KIND: &str = "spreadsheet (zip archive)";

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
