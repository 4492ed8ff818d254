//! Data sets of an Ivium file: settings `key=value`, then `primary_data` with the counts of columns and rows.
//!
//! Sections carry their length, but the lengths do not tile the file and re-saved files lost them (NUL became a
//! blank, CR LF became CR or LF alone), so labels are searched and no length is walked.

/// A line of any kind of end, without control characters around it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SectionLine<'a> {
    /// Number, from 1; ends of every kind count.
    pub number: usize,
    /// Text without blanks and control characters at both ends.
    pub text: &'a str,
}

/// One measurement of a file.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct DataSet<'a> {
    /// Settings in the file's order, those of the file's head with the first data set.
    pub settings: Vec<(&'a str, &'a str)>,
    /// Line of the label `primary_data`.
    pub line: usize,
    /// Columns as declared.
    pub columns: Option<usize>,
    /// Rows as declared.
    pub declared_rows: Option<usize>,
    /// Rows in which every column holds something.
    pub rows: Vec<SectionLine<'a>>,
}

impl<'a> DataSet<'a> {
    /// Value of a setting.
    pub fn setting(&self, key: &str) -> Option<&'a str> {
        let found = self.settings.iter().find(|(name, _)| *name == key);
        found.map(|(_, value)| *value)
    }
}

/// Lines that have an end; a last one without is left out, for a number in it may be cut.
pub fn lines(text: &str) -> Vec<SectionLine<'_>> {
    let mut lines = Vec::new();
    let mut rest = text;
    while let Some(at) = rest.find(['\r', '\n']) {
        let length = if rest[at..].starts_with("\r\n") { 2 } else { 1 };
        let number = lines.len() + 1;
        lines.push(SectionLine {
            number,
            text: rest[..at].trim_matches(|c: char| c.is_whitespace() || c == '\0'),
        });
        rest = &rest[at + length..];
    }
    lines
}

/// The data sets, and the settings behind the last of them: all there are where no data were written yet.
pub fn data_sets<'a>(lines: &[SectionLine<'a>]) -> (Vec<DataSet<'a>>, Vec<(&'a str, &'a str)>) {
    let mut sets = Vec::new();
    let mut settings = Vec::new();
    let mut rest = lines;
    while let Some((line, tail)) = rest.split_first() {
        rest = tail;
        if line.text == "primary_data" {
            let (set, used) = data_set(std::mem::take(&mut settings), *line, tail);
            sets.push(set);
            rest = &tail[used..];
        } else if let Some((key, value)) = line.text.split_once('=') {
            settings.push((key.trim(), value.trim()));
        }
    }
    (sets, settings)
}

fn data_set<'a>(
    settings: Vec<(&'a str, &'a str)>,
    label: SectionLine<'a>,
    lines: &[SectionLine<'a>],
) -> (DataSet<'a>, usize) {
    let mut set = DataSet {
        settings,
        line: label.number,
        ..DataSet::default()
    };
    let mut used = 0;
    for line in lines {
        let is_wanted = set.declared_rows.is_none_or(|declared| set.rows.len() < declared);
        if !is_wanted {
            break;
        }
        if !line.text.is_empty() {
            let cells = line.text.split_whitespace().count();
            match (set.columns, set.declared_rows) {
                (None, _) if cells == 1 => set.columns = line.text.parse().ok(),
                (Some(_), None) if cells == 1 => set.declared_rows = line.text.parse().ok(),
                (Some(columns), Some(_)) if cells == columns => set.rows.push(*line),
                _ => break,
            }
        }
        used += 1;
    }
    (set, used)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_found_whatever_became_of_the_line_ends() {
        for end in ["\r\n", "\n", "\r"] {
            let text = "\0\0x\r\0Title=a\r\0primary_data    \r\u{0}2   \r1   \r1.0E+00 -2.0E+00 \rosc_data\r1\rTitle=b\r\
                        primary_data\r2\r9\r3.0E+00\t1.0E+00\r4.0E+00 2.0"
                .replace('\r', end);
            let lines = lines(&text);
            let (sets, _) = data_sets(&lines);
            let shown: Vec<_> = sets
                .iter()
                .map(|set| (set.setting("Title"), set.declared_rows, set.rows.len()))
                .collect();
            assert_eq!(
                shown,
                [(Some("a"), Some(1), 1), (Some("b"), Some(9), 1)],
                "{end:?}"
            );
        }
    }

    #[test]
    fn settings_without_data_are_told() {
        let (sets, settings) = data_sets(&lines("Method=Transients\nprimary_dat"));
        assert!(sets.is_empty() && settings == [("Method", "Transients")]);
    }
}
