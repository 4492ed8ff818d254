//! Numbers as compressed BLOBs.
//!
//! Layout: one byte of layout version (1), the number of readings (u32, little-endian), then zstd of the
//! little-endian bytes, transposed so that all first bytes come first, then all second bytes, ...: neighbouring
//! readings share their high bytes, which compresses two to four times better than the plain order.

use super::StoreError;

const LAYOUT: u8 = 1;
const ZSTD_LEVEL: i32 = 1;
/// Readings above this count are refused when a BLOB is unpacked: 2^31 bytes of numbers.
const MOST_READINGS: usize = 1 << 28;

/// Packs readings.
pub(super) fn pack_f64(values: &[f64]) -> Result<Vec<u8>, StoreError> {
    pack(values.iter().map(|value| value.to_le_bytes()), values.len())
}

/// Packs indices.
pub(super) fn pack_u32(values: &[u32]) -> Result<Vec<u8>, StoreError> {
    pack(values.iter().map(|value| value.to_le_bytes()), values.len())
}

fn pack<const WIDTH: usize>(
    values: impl Iterator<Item = [u8; WIDTH]>,
    count: usize,
) -> Result<Vec<u8>, StoreError> {
    let mut planes = vec![0u8; count * WIDTH];
    for (index, bytes) in values.enumerate() {
        for (plane, byte) in bytes.into_iter().enumerate() {
            planes[plane * count + index] = byte;
        }
    }
    let body = zstd::bulk::compress(&planes, ZSTD_LEVEL).map_err(|error| StoreError::BadValue {
        what: "a channel's readings",
        detail: error.to_string(),
    })?;
    Ok([&[LAYOUT], &(count as u32).to_le_bytes()[..], &body[..]].concat())
}

/// Unpacks readings.
pub(super) fn unpack_f64(packed: &[u8]) -> Result<Vec<f64>, StoreError> {
    Ok(unpack::<8>(packed)?.into_iter().map(f64::from_le_bytes).collect())
}

/// Unpacks indices.
pub(super) fn unpack_u32(packed: &[u8]) -> Result<Vec<u32>, StoreError> {
    Ok(unpack::<4>(packed)?.into_iter().map(u32::from_le_bytes).collect())
}

fn unpack<const WIDTH: usize>(packed: &[u8]) -> Result<Vec<[u8; WIDTH]>, StoreError> {
    let bad = |detail: String| StoreError::BadValue {
        what: "a channel's readings",
        detail,
    };
    let (head, body) = packed
        .split_at_checked(5)
        .ok_or_else(|| bad(format!("a BLOB of {} bytes", packed.len())))?;
    let count = u32::from_le_bytes([head[1], head[2], head[3], head[4]]) as usize;
    if head[0] != LAYOUT || count > MOST_READINGS {
        return Err(bad(format!("layout {}, {count} readings", head[0])));
    }
    let planes = zstd::bulk::decompress(body, count * WIDTH).map_err(|error| bad(error.to_string()))?;
    if planes.len() != count * WIDTH {
        return Err(bad(format!(
            "{} bytes where {} were stored",
            planes.len(),
            count * WIDTH
        )));
    }
    let reading = |index: usize| std::array::from_fn(|plane| planes[plane * count + index]);
    Ok((0..count).map(reading).collect())
}

/// BLAKE3 of blobs in order, hexadecimal.
pub(super) fn hash_of(blobs: &[&[u8]]) -> String {
    let mut hasher = blake3::Hasher::new();
    for blob in blobs {
        hasher.update(&(blob.len() as u64).to_le_bytes());
        hasher.update(blob);
    }
    hasher.finalize().to_hex().to_string()
}

/// Level of compression of documents that are blobs.
const DOCUMENT_LEVEL: i32 = 3;

/// A value as compressed JSON.
pub(super) fn packed_json<T: serde::Serialize + ?Sized>(
    what: &'static str,
    value: &T,
) -> Result<Vec<u8>, StoreError> {
    let text = serde_json::to_vec(value).map_err(|e| bad(what, &e))?;
    zstd::bulk::compress(&text, DOCUMENT_LEVEL).map_err(|e| bad(what, &e))
}

/// The value of compressed JSON.
pub(super) fn unpacked_json<T: serde::de::DeserializeOwned>(
    what: &'static str,
    packed: &[u8],
) -> Result<T, StoreError> {
    let text = zstd::decode_all(packed).map_err(|e| bad(what, &e))?;
    serde_json::from_slice(&text).map_err(|e| bad(what, &e))
}

fn bad(what: &'static str, error: &dyn std::fmt::Display) -> StoreError {
    StoreError::BadValue {
        what,
        detail: error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn readings_come_back_to_the_bit(values in prop::collection::vec(any::<f64>(), 0..300)) {
            let back = unpack_f64(&pack_f64(&values).unwrap()).unwrap();
            prop_assert!(values.iter().zip(&back).all(|(a, b)| a.to_bits() == b.to_bits()));
            prop_assert_eq!(values.len(), back.len());
        }

        #[test]
        fn damaged_blobs_are_refused_or_harmless(bytes in prop::collection::vec(any::<u8>(), 0..80)) {
            let _ = unpack_u32(&bytes);
        }
    }

    #[test]
    fn a_wrong_count_is_refused() {
        let packed = pack_u32(&[1, 2, 3]).unwrap();
        for count in [0u8, 2, 4, 255] {
            let mut wrong = packed.clone();
            wrong[1] = count;
            assert!(unpack_u32(&wrong).is_err(), "{count}");
        }
        assert!(unpack_u32(&[]).is_err());
    }
}
