//! A dialect in words.

use crate::dialect::{Dialect, Encoding};
use crate::names::LANGUAGES;

impl Dialect {
    /// The choices that are not the commonest, in words.
    pub fn words(&self) -> String {
        let mut words = vec![
            format!("delimiter {:?}", self.delimiter),
            format!("decimal {:?}", self.decimal),
            format!("{:?}", self.numbers),
            format!("clock {}", self.clock.words()),
            format!("units {:?}", self.units),
            LANGUAGES[self.language].to_owned(),
        ];
        let mut add = |is: bool, text: String| {
            if is {
                words.push(text);
            }
        };
        add(
            self.thousands.is_some(),
            format!("thousands {:?}", self.thousands.unwrap_or(' ')),
        );
        add(self.minus != '-', "minus U+2212".to_owned());
        add(self.plus, "plus signs".to_owned());
        add(self.padded, "blank behind delimiters".to_owned());
        add(self.quoted, "quoted".to_owned());
        add(self.fraction, "humidity as a fraction".to_owned());
        add(self.newest_first, "newest first".to_owned());
        add(self.index, "index".to_owned());
        add(self.shuffled, "shuffled".to_owned());
        add(self.preamble > 0, format!("preamble of {}", self.preamble));
        if let Some(wall) = &self.preamble_date {
            add(
                self.preamble > 0,
                format!("start in the preamble {}", wall.words()),
            );
        }
        add(
            self.other_date && self.preamble > 0,
            "other date in the preamble".to_owned(),
        );
        add(self.sep_line, "sep= line".to_owned());
        add(self.commented, "names in a comment".to_owned());
        add(self.two_rows, "names over two rows".to_owned());
        add(self.encoding != Encoding::Utf8, format!("{:?}", self.encoding));
        add(self.line_end != "\n", format!("line end {:?}", self.line_end));
        add(self.trailing, "trailing delimiter".to_owned());
        add(
            self.blank_lines != (0, 0),
            format!("blank lines {:?}", self.blank_lines),
        );
        add(self.cut, "cut".to_owned());
        add(self.nul_tail > 0, format!("{} zero bytes", self.nul_tail));
        add(self.open_end, "open end".to_owned());
        add(self.sentinels > 0, format!("{} sentinels", self.sentinels));
        words.extend(self.odd.words().into_iter().map(str::to_owned));
        words.join(", ")
    }

    /// What it does that plain writers do not.
    pub fn oddities(&self) -> Vec<String> {
        let mut words: Vec<String> = self.odd.words().into_iter().map(str::to_owned).collect();
        if let Encoding::Other(encoding) = self.encoding {
            words.push(encoding.name().to_owned());
        }
        if let Some(wall) = &self.clock.wall {
            words.extend(wall.oddity().map(str::to_owned));
        }
        words
    }
}
