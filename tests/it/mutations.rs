//! Files made worse at random, with a seed: bits and bytes, numbers, lengths, blocks, splices, cuts.

use rand::{Rng, RngExt};

/// Numbers as a broken writer, another locale or a hostile file may have them.
const NUMBERS: [&str; 22] = [
    "0",
    "-0",
    "1e308",
    "-1e309",
    "1e-400",
    "NaN",
    "inf",
    "-1.#IND",
    "1,5",
    "1.5.5",
    "",
    "99999999999999999999",
    "-1",
    "4294967295",
    "2147483648",
    "18446744073709551615",
    "1e",
    "+",
    "0x10",
    "\u{2212}3",
    "1\u{a0}000",
    "1 2",
];
/// Whole numbers at the ends of their ranges, for lengths and counts of binary files.
const LENGTHS: [u64; 12] = [
    0,
    1,
    2,
    0x7F,
    0xFF,
    0xFFFF,
    0x7FFF_FFFF,
    0x8000_0000,
    0xFFFF_FFFF,
    0x7FFF_FFFF_FFFF_FFFF,
    0x8000_0000_0000_0000,
    0xFFFF_FFFF_FFFF_FFFF,
];
/// Bytes that mean something to a reader.
const MARKS: &[u8] = b"\0\t\n\r ,;.\"'#:/()[]{}<>=-+eE@\xB5\xB0\xFF\xFE\xEF\xBB\xBF\x1A\x1C\x1E";

/// `bytes` with one to six changes, at most `largest` bytes of it; blocks may come from `other`.
pub fn mutated(bytes: &[u8], other: &[u8], largest: usize, random: &mut impl Rng) -> Vec<u8> {
    let mut made = bytes.to_vec();
    for _ in 0..random.random_range(1..=6) {
        change(&mut made, other, largest, random);
        made.truncate(largest);
    }
    made
}

fn change(bytes: &mut Vec<u8>, other: &[u8], largest: usize, random: &mut impl Rng) {
    if bytes.is_empty() {
        bytes.extend_from_slice(&other[..other.len().min(64)]);
        return;
    }
    let at = random.random_range(0..bytes.len());
    match random.random_range(0..11) {
        0 => bytes[at] ^= 1 << random.random_range(0..8),
        1 => bytes[at] = random.random(),
        2 => bytes[at] = MARKS[random.random_range(0..MARKS.len())],
        3 => bytes.truncate(at),
        4 => {
            bytes.drain(block(bytes.len(), random));
        }
        5 => repeat(bytes, largest, random),
        6 => {
            let taken = block(other.len(), random);
            bytes.splice(at..at, other[taken].iter().copied());
        }
        7 => number(bytes, at, random),
        8 => length(bytes, at, random),
        9 => {
            let mark = MARKS[random.random_range(0..MARKS.len())];
            bytes.insert(at, mark);
        }
        _ => {
            let (from, to) = (block(bytes.len(), random), random.random_range(0..bytes.len()));
            let moved: Vec<u8> = bytes.drain(from).collect();
            let to = to.min(bytes.len());
            bytes.splice(to..to, moved);
        }
    }
}

/// A short stretch of `length` bytes.
fn block(length: usize, random: &mut impl Rng) -> std::ops::Range<usize> {
    if length == 0 {
        return 0..0;
    }
    let from = random.random_range(0..length);
    let most = (length - from).min(1 << random.random_range(0..12));
    from..from + random.random_range(0..=most)
}

fn repeat(bytes: &mut Vec<u8>, largest: usize, random: &mut impl Rng) {
    let repeated = bytes[block(bytes.len(), random)].to_vec();
    let at = random.random_range(0..=bytes.len());
    let times = 1 << random.random_range(0..10);
    let most = largest / repeated.len().max(1);
    let run = repeated.repeat(times.min(most));
    bytes.splice(at..at, run);
}

/// Another number in place of the one nearest after `at`.
fn number(bytes: &mut Vec<u8>, at: usize, random: &mut impl Rng) {
    let Some(from) = bytes[at..].iter().position(u8::is_ascii_digit).map(|k| at + k) else {
        return;
    };
    let more = bytes[from..]
        .iter()
        .take_while(|byte| byte.is_ascii_digit())
        .count();
    let number = NUMBERS[random.random_range(0..NUMBERS.len())];
    bytes.splice(from..from + more, number.bytes());
}

/// Another length or count of four or eight bytes at `at`.
fn length(bytes: &mut [u8], at: usize, random: &mut impl Rng) {
    let value = LENGTHS[random.random_range(0..LENGTHS.len())];
    let width = [2, 4, 8][random.random_range(0..3usize)];
    let little = value.to_le_bytes();
    for (slot, byte) in bytes[at..].iter_mut().zip(&little[..width]) {
        *slot = *byte;
    }
}
