//! What holds for any bytes: no reader panics, and a cut never changes a number.

use std::collections::BTreeMap;

use ieap::ingest::formats::{ALL, ReadContext, ReadError, read};
use ieap::ingest::profiles::{from_text, read as read_by};
use ieap::ingest::{Reading, RunTable};
use proptest::prelude::*;

use crate::formats_fixtures::fixtures;

/// Reads with every format, whatever recognition says.
fn read_with_all(bytes: &[u8]) {
    let context = ReadContext::default();
    let _ = read("run.csv", bytes, &context);
    for format in ALL {
        if let Err(error) = format.read(bytes, &context) {
            let issue = error.issue();
            let shown = issue.message + &issue.place;
            assert!(!shown.chars().any(char::is_control), "{shown:?}");
        }
    }
}

/// Whether all readings of `cut` are the first ones of `whole`, to the last bit, with the same ones excluded.
fn is_prefix(cut: &RunTable, whole: &RunTable) -> bool {
    let bits = |numbers: &[f64]| numbers.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
    let begins = |whole: &[f64], cut: &[f64]| bits(whole).starts_with(&bits(cut));
    cut.channels.iter().all(|channel| {
        let same = whole
            .channels
            .iter()
            .find(|other| other.raw_name == channel.raw_name && other.raw_unit == channel.raw_unit);
        same.is_some_and(|other| {
            begins(&other.time_s, &channel.time_s)
                && begins(&other.values, &channel.values)
                && other.excluded.starts_with(&channel.excluded)
                && other.quantity == channel.quantity
        })
    })
}

/// Rows that a cut text still holds whole, at most.
fn whole_lines(bytes: &[u8]) -> usize {
    let count = |end: u8| bytes.iter().filter(|&&byte| byte == end).count();
    count(b'\n').max(count(b'\r'))
}

/// Cuts a file at every byte, holds what is left against the whole, and counts the cuts that could be read.
pub fn cuts(name: &str, bytes: &[u8]) -> usize {
    let context = ReadContext::default();
    cuts_by(name, bytes, &|bytes| read(name, bytes, &context).ok())
}

fn cuts_by(name: &str, bytes: &[u8], read: &dyn Fn(&[u8]) -> Option<Reading>) -> usize {
    let Some(whole) = read(bytes) else {
        return 0;
    };
    let mut survived = 0;
    for end in 0..bytes.len() {
        if let Some(cut) = read(&bytes[..end]) {
            survived += 1;
            assert_prefix(name, end, &cut, &whole);
            let rows = cut.tables.iter().map(|table| table.rows);
            // Tables of PSTrace stand side by side, on the same lines.
            let rows: usize = match cut.format {
                "palmsens-csv" => rows.max().unwrap_or(0),
                _ => rows.sum(),
            };
            // A last line without its end is kept where it shows that it is whole.
            let may_lack_end = 1;
            // Binary files and JSON have no lines.
            let has_lines = cut.encoding.is_some() && cut.format != "palmsens-session";
            assert!(
                !has_lines || rows < whole_lines(&bytes[..end]) + may_lack_end,
                "{name} cut at {end} holds {rows} rows"
            );
        }
    }
    survived
}

/// Formats that can be read only whole, but for blanks at their ends: their table of contents stands at the end, or
/// they are one document.
const WHOLE_OR_NOTHING: [&str; 4] = ["palmsens-session", "eplexor-xls", "parquet", "matlab-mat"];

/// Every format of the registry has at least one sample here that it reads, and of those that are not read whole or
/// not at all some cuts, too: what was never read was never compared.
#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn a_cut_at_any_byte_of_any_format_never_changes_a_number() {
    let typed = fixtures().into_iter().map(|(format, path, bytes)| {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        (format, name, bytes)
    });
    let made = crate::samples::made().into_iter();
    let made = made.map(|(format, name, bytes)| (format.to_owned(), name.to_owned(), bytes));
    let mut of_format: BTreeMap<String, (usize, usize)> = BTreeMap::new();
    for (format, name, bytes) in typed.chain(made) {
        if let Ok(whole) = read(&name, &bytes, &ReadContext::default()) {
            assert_eq!(whole.format, format, "{name}");
            let (read, survived) = of_format.entry(format).or_default();
            *read += 1;
            *survived += cuts(&name, &bytes);
        }
    }
    for format in ALL {
        let id = format.id();
        let Some((read, survived)) = of_format.get(id) else {
            panic!("{id} has no sample that it reads: add one to tests/formats or tests/it/samples.rs");
        };
        println!("{id}: {read} samples, {survived} cuts read");
        let any = *survived > 2 * read;
        assert_eq!(any, !WHOLE_OR_NOTHING.contains(&id), "{id}: {survived} cuts read");
    }
}

#[test]
fn a_cut_never_changes_a_number_that_a_profile_reads() {
    let profile = "[profile]\nversion = 1\n[layout]\nseparator = \"semicolon\"\ndecimal = \"comma\"\nheader_line = 2\n\
                   [time]\nbase = \"epoch\"\ncolumn = 1\nunit = \"ms\"\n[[column]]\ncolumn = 3\n\
                   quantity = \"current\"\nunit = \"mA\"\n";
    let profiles = [from_text(std::path::Path::new("log.toml"), profile).unwrap()];
    let text = "made\nEpoch;Distance;I\n1728937444032;12,5;1,25\n1728937444532;12,75;-20,5\n1728937445032;13;3,125\n";
    let context = ReadContext::default();
    let by_profile = |bytes: &[u8]| {
        read_by(&profiles, "log.csv", bytes, &context)
            .ok()
            .map(|(reading, _)| reading)
    };
    assert!(cuts_by("log.csv", text.as_bytes(), &by_profile) > 40);
}

fn assert_prefix(name: &str, end: usize, cut: &Reading, whole: &Reading) {
    for table in &cut.tables {
        // The only table of a file has no name; it may be the first of several in the whole file.
        let is_first = |other: &&RunTable| other.name == table.name || table.name.is_empty();
        let same = whole.tables.iter().find(is_first);
        assert!(
            same.is_some_and(|same| is_prefix(table, same)),
            "{name} cut at {end}: {:?}",
            table.columns()
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..600)) {
        read_with_all(&bytes);
    }

    #[test]
    fn random_tables_never_panic(text in "(time_s|t/ms|I \\(mA\\))[,;\t](current_a|kappa \\(1/m\\))\n([-0-9.,;eE\t\"#naNI \n]{0,200})") {
        read_with_all(text.as_bytes());
    }

    #[test]
    fn mutated_fixtures_never_panic(
        pick in any::<prop::sample::Index>(),
        changes in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
    ) {
        let fixtures = fixtures();
        let (_, _, mut bytes) = pick.get(&fixtures).clone();
        if !bytes.is_empty() {
            for (at, byte) in changes {
                let at = at.index(bytes.len());
                bytes[at] = byte;
            }
        }
        read_with_all(&bytes);
    }

    #[test]
    fn numbers_written_in_any_dialect_read_back(
        values in proptest::collection::vec((-1.0f64..1.0, -50.0f64..50.0), 2..40),
        comma in any::<bool>(),
        crlf in any::<bool>(),
    ) {
        let end = if crlf { "\r\n" } else { "\n" };
        let mut text = format!("time_s;current_a;curvature_per_cm{end}");
        for (k, (current, curvature)) in values.iter().enumerate() {
            let row = format!("{k}.25;{current:e};{curvature}{end}");
            text += &if comma { row.replace('.', ",") } else { row };
        }
        let reading = read("run.csv", text.as_bytes(), &ReadContext::default()).unwrap();
        let channels = &reading.tables[0].channels;
        let found: Vec<(f64, f64)> = channels[0].values.iter().copied().zip(channels[1].values.iter().copied()).collect();
        prop_assert_eq!(found, values);
        prop_assert_eq!(channels[0].time_s[1], 1.25);
    }
}

/// The library that reads .xls follows chains without end and makes room for every cell between two: both must be
/// refused before it sees them.
#[test]
fn workbooks_that_would_fill_the_memory_are_refused() {
    let context = ReadContext::default();
    let whole = crate::samples::xls(&[crate::samples::RUN]);
    assert!(read("run.xls", &whole, &context).is_ok());
    let mut cyclic = whole.clone();
    // The folder's sector, the second, follows itself.
    cyclic[512 + 4..512 + 8].copy_from_slice(&1u32.to_le_bytes());
    let refused = read("run.xls", &cyclic, &context).unwrap_err();
    assert!(
        refused.to_string().contains("leads back into itself"),
        "{refused}"
    );
    let number = [0x03, 0x02, 14, 0];
    let places: Vec<usize> = (0..whole.len() - 4)
        .filter(|&at| whole[at..at + 4] == number)
        .collect();
    let mut wide = whole.clone();
    wide[places[0] + 4..places[0] + 8].copy_from_slice(&[0xFF; 4]);
    let refused = read("run.xls", &wide, &context).unwrap_err();
    assert!(matches!(refused, ReadError::SheetTooWide { .. }), "{refused}");
}
