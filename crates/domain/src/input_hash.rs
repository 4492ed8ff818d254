//! Hashes of what a result is made from.
//!
//! Each value is written by hand, with its kind and its length, so that two inputs that differ never look alike, and no
//! other name of a type or a field makes a stored result out of date.

use super::{Drive, Issue};

/// BLAKE3 over values in the order in which they are written.
#[derive(Debug, Clone, Default)]
pub struct InputHash(blake3::Hasher);

impl InputHash {
    /// Of nothing yet.
    pub fn new() -> InputHash {
        InputHash::default()
    }

    /// Adds a text.
    pub fn text(&mut self, text: &str) -> &mut InputHash {
        self.bytes(text.as_bytes())
    }

    /// Adds bytes.
    pub fn bytes(&mut self, bytes: &[u8]) -> &mut InputHash {
        self.0.update(b"t").update(&(bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
        self
    }

    /// Adds a text that may not be there; none is another input than an empty one.
    pub fn text_or_none(&mut self, text: Option<&str>) -> &mut InputHash {
        self.flag(text.is_some());
        match text {
            Some(text) => self.text(text),
            None => self,
        }
    }

    /// Adds a number by its bits: 0 and -0 are two inputs.
    pub fn number(&mut self, number: f64) -> &mut InputHash {
        self.0.update(b"f").update(&number.to_le_bytes());
        self
    }

    /// Adds a number that may not be there.
    pub fn number_or_none(&mut self, number: Option<f64>) -> &mut InputHash {
        self.flag(number.is_some());
        match number {
            Some(number) => self.number(number),
            None => self,
        }
    }

    /// Adds numbers and how many they are.
    pub fn numbers(&mut self, numbers: &[f64]) -> &mut InputHash {
        self.count(numbers.len());
        numbers.iter().for_each(|number| {
            self.number(*number);
        });
        self
    }

    /// Adds a count or a place.
    pub fn count(&mut self, count: usize) -> &mut InputHash {
        self.whole(count as u64)
    }

    /// Adds a whole number: a version, a seed.
    pub fn whole(&mut self, number: u64) -> &mut InputHash {
        self.0.update(b"i").update(&number.to_le_bytes());
        self
    }

    /// Adds a yes or no.
    pub fn flag(&mut self, flag: bool) -> &mut InputHash {
        self.0.update(if flag { b"+" } else { b"-" });
        self
    }

    /// Adds a drive: baseline, and start and level of each segment, with the reading before it where only readings tell of
    /// the start.
    pub fn drive(&mut self, drive: &Drive) -> &mut InputHash {
        self.number(drive.baseline_v).count(drive.segments.len());
        for segment in &drive.segments {
            self.number(segment.start_s());
            self.number_or_none(segment.level.volts());
            // A start that is stated has the hash that it always had.
            if !segment.edge.is_stated() {
                self.number_or_none(Some(segment.edge.no_earlier_s));
            }
        }
        self
    }

    /// Adds an issue with all of its words.
    pub fn issue(&mut self, issue: &Issue) -> &mut InputHash {
        [
            issue.severity.key(),
            &issue.code,
            &issue.place,
            &issue.message,
            &issue.mend,
        ]
        .into_iter()
        .for_each(|text| {
            self.text(text);
        });
        self
    }

    /// The hash, hexadecimal.
    pub fn finished(&self) -> String {
        self.0.finalize().to_hex().to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Level, Segment};

    fn of(write: impl Fn(&mut InputHash) -> &mut InputHash) -> String {
        let mut hash = InputHash::new();
        write(&mut hash);
        hash.finished()
    }

    #[test]
    fn inputs_that_differ_have_hashes_that_differ() {
        let drive = |level| Drive {
            baseline_v: 0.0,
            segments: vec![Segment::at(1.0, level)],
        };
        let mut seen = Drive::step(1.0);
        seen.segments[0].edge = crate::Edge::between(-1.0, 0.0);
        let note = |place: &str| Issue::note("code", "message").at(place);
        let all = [
            of(|hash| hash),
            of(|hash| hash.text("")),
            of(|hash| hash.text("ab").text("c")),
            of(|hash| hash.text("a").text("bc")),
            of(|hash| hash.text_or_none(None)),
            of(|hash| hash.text_or_none(Some(""))),
            of(|hash| hash.number(0.0)),
            of(|hash| hash.number(-0.0)),
            of(|hash| hash.numbers(&[0.0, 1.0])),
            of(|hash| hash.numbers(&[0.0]).numbers(&[1.0])),
            of(|hash| hash.drive(&drive(Level::Voltage(0.0)))),
            of(|hash| hash.drive(&drive(Level::OpenCircuit))),
            of(|hash| hash.drive(&Drive::step(1.0))),
            of(|hash| hash.drive(&seen)),
            of(|hash| hash.issue(&note("a"))),
            of(|hash| hash.issue(&note("b"))),
        ];
        for (k, hash) in all.iter().enumerate() {
            assert!(!all[..k].contains(hash), "{k}");
        }
    }

    /// A stored result is out of date where this changes: the change is to be said in CHANGELOG.md.
    #[test]
    fn the_form_of_a_drive_is_the_stored_one() {
        let stored = "f53dd028f9929f9368e60fa7bbcabe2c1e8731c4a0bb67ce9154b813c8e7bb82";
        assert_eq!(of(|hash| hash.drive(&Drive::step(1.5))), stored);
    }
}
