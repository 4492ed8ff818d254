//! Any bytes in the place of a journal are read, and what is read of them reads the same again.

#![no_main]

use ieap_store::journal;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let found = journal::found(bytes);
    let lines: String = found.lines.iter().map(|line| format!("{}\n", line.text)).collect();
    let again = journal::found(lines.as_bytes());
    assert_eq!(found.lines, again.lines);
    assert!(again.damaged.is_empty() && !again.is_torn, "{again:?}");
});
