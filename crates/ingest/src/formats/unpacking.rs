//! How large a packed file may get: in proportion to itself, so that a small file costs little whoever wrote it. It is
//! counted by unpacking, for a declared size may lie.

use std::borrow::Cow;
use std::io::Read;

use flate2::read::{MultiGzDecoder, ZlibDecoder};

use super::error::{ReadError, escaped};

/// Most bytes that any file may unpack to.
pub const MOST: u64 = 512 << 20;
/// What even the smallest file may unpack to, bytes. Chosen: a reader holds up to six times of it, and stays below 512 MB.
const ALWAYS: u64 = 64 << 20;
/// How many times its own size a larger file may unpack to. Chosen: tables of numbers that were measured pack to between a
/// third and a tenth.
const TIMES: u64 = 20;

/// Most bytes that a file of this size may unpack to.
pub fn allowance(packed: usize) -> u64 {
    (packed as u64).saturating_mul(TIMES).clamp(ALWAYS, MOST)
}

/// What zlib packed into a part of a file; none where that is more than `limit` bytes.
///
/// # Errors
/// It is damaged.
pub fn of_zlib(packed: &[u8], limit: u64) -> std::io::Result<Option<Vec<u8>>> {
    within(ZlibDecoder::new(packed), limit)
}

/// All bytes of a stream; none where there are more than `limit`.
fn within(packed: impl Read, limit: u64) -> std::io::Result<Option<Vec<u8>>> {
    let mut unpacked = Vec::new();
    // One byte more tells what is too large from what just fits.
    packed.take(limit.saturating_add(1)).read_to_end(&mut unpacked)?;
    Ok((unpacked.len() as u64 <= limit).then_some(unpacked))
}

/// What a file packed with gzip begins with, and how its name ends.
const GZIP: &[u8] = &[0x1f, 0x8b];
const GZIP_EXTENSION: &str = ".gz";

/// A file as its reader takes it: what gzip packed (`run.csv.gz`) under the name and with the bytes that it had before.
///
/// # Errors
/// It is damaged, or unpacks to more than `limit` bytes, or more than a file of its size may.
pub fn of_gzip<'f>(
    name: &'f str,
    bytes: &'f [u8],
    limit: u64,
) -> Result<(&'f str, Cow<'f, [u8]>), ReadError> {
    if !bytes.starts_with(GZIP) {
        return Ok((name, Cow::Borrowed(bytes)));
    }
    let limit = limit.min(allowance(bytes.len()));
    let unpacked = within(MultiGzDecoder::new(bytes), limit);
    let unpacked = unpacked.map_err(|error| ReadError::BrokenContainer {
        kind: "file packed with gzip",
        found: escaped(&error.to_string()),
    })?;
    let unpacked = unpacked.ok_or_else(|| ReadError::TooLarge {
        what: "the file, once unpacked,".to_owned(),
        found: limit + 1,
        limit,
    })?;
    let own = name.len().checked_sub(GZIP_EXTENSION.len());
    let own = own.filter(|at| {
        name.get(*at..)
            .is_some_and(|end| end.eq_ignore_ascii_case(GZIP_EXTENSION))
    });
    Ok((&name[..own.unwrap_or(name.len())], Cow::Owned(unpacked)))
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

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
    fn what_a_file_may_unpack_to_grows_with_it_within_two_ends() {
        let megabytes = |packed: usize| allowance(packed << 20) >> 20;
        assert_eq!([0, 1, 10, 100, 1000].map(megabytes), [64, 64, 200, 512, 512]);
        // 70 MB of blanks in a file of 70 kB.
        let bomb = gzip(&vec![b' '; 70 << 20]);
        let refused = of_gzip("a.csv.gz", &bomb, MOST).unwrap_err();
        assert!(
            matches!(refused, ReadError::TooLarge { limit: ALWAYS, .. }),
            "{refused}"
        );
    }
}
