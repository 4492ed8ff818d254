//! Any bytes, under any of the names that files of instruments have, are read or refused.

#![no_main]

use ieap_ingest::formats::{self, ReadContext};
use libfuzzer_sys::fuzz_target;

/// Endings that formats are known by.
const ENDINGS: [&str; 13] = [
    "csv", "txt", "dta", "mpt", "mpr", "lvm", "tdms", "par", "idf", "pssession", "parquet", "mat", "xlsx",
];

fuzz_target!(|bytes: &[u8]| {
    let Some((ending, bytes)) = bytes.split_first() else { return };
    let name = format!("a.{}", ENDINGS[*ending as usize % ENDINGS.len()]);
    let context = ReadContext {
        max_unpacked_bytes: 16 << 20,
        ..ReadContext::default()
    };
    if let Ok(reading) = formats::read(&name, bytes, &context) {
        for channel in reading.tables.iter().flat_map(|table| &table.channels) {
            assert!(channel.values.iter().all(|value| value.is_finite()), "{name}: {}", channel.raw_name);
            assert_eq!(channel.values.len(), channel.time_s.len(), "{name}: {}", channel.raw_name);
        }
    }
});
