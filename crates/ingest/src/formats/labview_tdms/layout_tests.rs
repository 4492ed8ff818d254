//! Whatever the layout in which values are written, they read back, and a cut never changes one.

use proptest::prelude::*;

use super::LabviewTdms;
use crate::formats::{Format, ReadContext};
use crate::{Reading, RunTable};

/// How a file is written.
#[derive(Debug, Clone, Copy)]
struct Layout {
    big_endian: bool,
    interleaved: bool,
    /// Rows of a chunk.
    chunk: usize,
    /// Chunks of a segment.
    chunks: usize,
    /// Whether segments behind the first repeat their objects.
    repeats_objects: bool,
}

struct Writer {
    layout: Layout,
    bytes: Vec<u8>,
}

impl Writer {
    fn number<const N: usize>(&self, to: &mut Vec<u8>, little_endian: [u8; N]) {
        let mut bytes = little_endian;
        if self.layout.big_endian {
            bytes.reverse();
        }
        to.extend(bytes);
    }

    fn text(&self, to: &mut Vec<u8>, text: &str) {
        self.number(to, (text.len() as u32).to_le_bytes());
        to.extend(text.as_bytes());
    }

    /// Two channels of doubles with their units.
    fn objects(&self, same_as_before: bool) -> Vec<u8> {
        let mut meta = Vec::new();
        self.number(&mut meta, 2u32.to_le_bytes());
        for (name, unit) in [("time", "s"), ("current", "A")] {
            self.text(&mut meta, &format!("/'run'/'{name}'"));
            if same_as_before {
                self.number(&mut meta, 0u32.to_le_bytes());
            } else {
                self.number(&mut meta, 20u32.to_le_bytes());
                self.number(&mut meta, 10u32.to_le_bytes());
                self.number(&mut meta, 1u32.to_le_bytes());
                self.number(&mut meta, (self.layout.chunk as u64).to_le_bytes());
            }
            self.number(&mut meta, 1u32.to_le_bytes());
            self.text(&mut meta, "unit_string");
            self.number(&mut meta, 0x20u32.to_le_bytes());
            self.text(&mut meta, unit);
        }
        meta
    }

    fn values(&self, rows: &[(f64, f64)]) -> Vec<u8> {
        let mut raw = Vec::new();
        for chunk in rows.chunks(self.layout.chunk) {
            if self.layout.interleaved {
                for (time, current) in chunk {
                    self.number(&mut raw, time.to_le_bytes());
                    self.number(&mut raw, current.to_le_bytes());
                }
            } else {
                chunk
                    .iter()
                    .for_each(|(time, _)| self.number(&mut raw, time.to_le_bytes()));
                chunk
                    .iter()
                    .for_each(|(_, current)| self.number(&mut raw, current.to_le_bytes()));
            }
        }
        raw
    }

    fn segment(&mut self, rows: &[(f64, f64)], is_first: bool) {
        let has_objects = is_first || self.layout.repeats_objects;
        let meta = if has_objects {
            self.objects(!is_first)
        } else {
            Vec::new()
        };
        let raw = self.values(rows);
        let flags = [
            (has_objects, 1u32 << 1),
            (is_first, 1 << 2),
            (true, 1 << 3),
            (self.layout.interleaved, 1 << 5),
            (self.layout.big_endian, 1 << 6),
        ];
        let contents: u32 = flags.iter().filter(|(set, _)| *set).map(|(_, flag)| flag).sum();
        let mut head = b"TDSm".to_vec();
        head.extend(contents.to_le_bytes());
        self.number(&mut head, 4713u32.to_le_bytes());
        self.number(&mut head, ((meta.len() + raw.len()) as u64).to_le_bytes());
        self.number(&mut head, (meta.len() as u64).to_le_bytes());
        self.bytes.extend([head, meta, raw].concat());
    }
}

fn written(rows: &[(f64, f64)], layout: Layout) -> Vec<u8> {
    let mut writer = Writer {
        layout,
        bytes: Vec::new(),
    };
    for (index, part) in rows.chunks(layout.chunk * layout.chunks).enumerate() {
        writer.segment(part, index == 0);
    }
    writer.bytes
}

fn read(bytes: &[u8]) -> Option<Reading> {
    LabviewTdms.read(bytes, &ReadContext::default()).ok()
}

fn currents(table: &RunTable) -> Vec<f64> {
    table
        .channels
        .iter()
        .flat_map(|channel| channel.values.to_vec())
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn values_read_back_from_every_layout(
        currents_a in proptest::collection::vec(-1.0f64..1.0, 1..10),
        chunk in 1usize..5,
        chunks in 1usize..4,
        big_endian in any::<bool>(),
        interleaved in any::<bool>(),
        repeats_objects in any::<bool>(),
        cut in any::<prop::sample::Index>(),
    ) {
        // Whole chunks, as a writer leaves them.
        let count = currents_a.len() * chunk;
        let rows: Vec<(f64, f64)> = (0..count).map(|k| (0.5 * k as f64, currents_a[k % currents_a.len()])).collect();
        let layout = Layout { big_endian, interleaved, chunk, chunks, repeats_objects };
        let bytes = written(&rows, layout);
        let reading = read(&bytes).unwrap();
        let table = &reading.tables[0];
        prop_assert_eq!(reading.status.key(), "complete");
        prop_assert_eq!((table.rows, table.time_first_last_s), (count, Some((0.0, rows[count - 1].0))));
        let expected: Vec<f64> = rows.iter().map(|(_, current)| *current).collect();
        prop_assert_eq!(currents(table), expected.clone());

        let end = cut.index(bytes.len());
        if let Some(part) = read(&bytes[..end]) {
            let found = currents(&part.tables[0]);
            prop_assert!(expected.starts_with(&found), "{:?} of {:?}", found, expected);
        }
    }
}
