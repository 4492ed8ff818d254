//! Splitting a line into cells.

/// What stands between the cells of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Delimiter {
    /// A tab.
    Tab,
    /// A semicolon.
    Semicolon,
    /// A comma.
    Comma,
    /// A vertical bar.
    Bar,
    /// Two or more blanks: names and dates hold single ones.
    WideBlanks,
    /// One or more blanks or tabs.
    Blanks,
}

impl Delimiter {
    /// Every delimiter, the surest first.
    pub const ALL: [Delimiter; 6] = [
        Delimiter::Tab,
        Delimiter::Semicolon,
        Delimiter::Comma,
        Delimiter::Bar,
        Delimiter::WideBlanks,
        Delimiter::Blanks,
    ];

    /// The marks that separate cells and nothing else, the surest first.
    pub const SURE: [Delimiter; 4] = [
        Delimiter::Tab,
        Delimiter::Semicolon,
        Delimiter::Comma,
        Delimiter::Bar,
    ];

    /// The delimiter in words.
    pub fn label(self) -> &'static str {
        match self {
            Delimiter::Tab => "tab",
            Delimiter::Semicolon => "semicolon",
            Delimiter::Comma => "comma",
            Delimiter::Bar => "bar",
            Delimiter::WideBlanks => "two blanks",
            Delimiter::Blanks => "blanks",
        }
    }

    /// Calls `each` with the number (from 0) and text of every cell and gives their count. Cells keep their
    /// padding and quotes; a delimiter inside quotes separates nothing.
    pub fn split<'a>(self, line: &'a str, mut each: impl FnMut(usize, &'a str)) -> usize {
        let mark = match self {
            Delimiter::Tab => b'\t',
            Delimiter::Semicolon => b';',
            Delimiter::Comma => b',',
            Delimiter::Bar => b'|',
            Delimiter::WideBlanks => {
                let cells = line.split("  ").map(str::trim).filter(|cell| !cell.is_empty());
                return cells.enumerate().map(|(k, cell)| each(k, cell)).count();
            }
            Delimiter::Blanks => {
                return line
                    .split_whitespace()
                    .enumerate()
                    .map(|(k, cell)| each(k, cell))
                    .count();
            }
        };
        let (mut count, mut start, mut in_quotes, mut is_quoted) = (0, 0, false, false);
        let bytes = line.as_bytes();
        // By index: where nothing is inlined, as in the dev profile, an iterator costs more than what is done for a byte.
        let mut at = 0;
        while at < bytes.len() {
            let byte = bytes[at];
            if byte == mark && !in_quotes {
                each(count, &line[start..at]);
                count += 1;
                (start, is_quoted) = (at + 1, false);
            } else if byte == b'"' {
                // A mark inside a cell that did not begin with one is a letter of it: E" is a loss modulus.
                is_quoted |= line[start..at].trim().is_empty();
                in_quotes = is_quoted && !in_quotes;
            }
            at += 1;
        }
        each(count, &line[start..]);
        count + 1
    }

    /// The cells of a header line. Between blanks, `(s)`, `[s]` and `/ s` belong to the name before them.
    pub fn header_cells(self, line: &str) -> Vec<String> {
        let mut cells: Vec<String> = Vec::new();
        self.split(line, |_, cell| {
            let cell = cell.trim();
            let continues = self == Delimiter::Blanks
                && (cell.starts_with(['(', '[', '/'])
                    || cells.last().is_some_and(|last| last.ends_with('/')));
            match cells.last_mut().filter(|_| continues) {
                Some(last) => {
                    last.push(' ');
                    last.push_str(cell);
                }
                None => cells.push(cell.to_owned()),
            }
        });
        cells
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(delimiter: Delimiter, line: &str) -> Vec<&str> {
        let mut cells = Vec::new();
        let count = delimiter.split(line, |_, cell| cells.push(cell));
        assert_eq!(count, cells.len());
        cells
    }

    #[test]
    fn lines_are_split_outside_quotes() {
        assert_eq!(cells(Delimiter::Comma, "1,\"a,b\",,"), ["1", "\"a,b\"", "", ""]);
        assert_eq!(cells(Delimiter::Semicolon, "0,5; 1,2"), ["0,5", " 1,2"]);
        assert_eq!(cells(Delimiter::Tab, "\t1\t2"), ["", "1", "2"]);
        assert_eq!(cells(Delimiter::Blanks, "  1 \t 2  "), ["1", "2"]);
        assert_eq!(cells(Delimiter::Comma, "t,E\" (MPa),T"), ["t", "E\" (MPa)", "T"]);
        assert_eq!(cells(Delimiter::Comma, " \"E\"\", x\",1"), [" \"E\"\", x\"", "1"]);
    }

    #[test]
    fn a_header_between_blanks_keeps_its_units() {
        assert_eq!(
            Delimiter::Blanks.header_cells("Time (s)   Current [A] U / V"),
            ["Time (s)", "Current [A]", "U / V"]
        );
    }
}
