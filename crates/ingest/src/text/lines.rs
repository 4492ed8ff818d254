//! Lines of a text with their numbers; the last one is marked where its end is missing.

/// A line without its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Line<'a> {
    /// Number in the file, from 1.
    pub number: usize,
    /// Text without the line end.
    pub text: &'a str,
    /// Whether the line has an end; only the last one of a cut file has none.
    pub ended: bool,
}

/// Lines in the file's order. Ends are LF or CR LF, mixed or not; a text without LF may use CR alone.
#[derive(Debug, Clone)]
pub struct Lines<'a> {
    rest: &'a str,
    number: usize,
    end: char,
}

impl<'a> Lines<'a> {
    /// Lines of `text`.
    pub fn new(text: &'a str) -> Lines<'a> {
        let head = &text.as_bytes()[..text.len().min(65_536)];
        let cr_only = !head.contains(&b'\n') && head.contains(&b'\r') && !text.contains('\n');
        Lines {
            rest: text,
            number: 0,
            end: if cr_only { '\r' } else { '\n' },
        }
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let (text, ended) = match self.rest.find(self.end) {
            Some(at) => {
                let text = &self.rest[..at];
                self.rest = &self.rest[at + 1..];
                (text.strip_suffix('\r').unwrap_or(text), true)
            }
            None => (std::mem::take(&mut self.rest), false),
        };
        Some(Line {
            number: self.number,
            // Programs that append to a file as if it were new write their mark again.
            text: text.trim_start_matches('\u{feff}'),
            ended,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(text: &str) -> Vec<(usize, &str, bool)> {
        Lines::new(text)
            .map(|line| (line.number, line.text, line.ended))
            .collect()
    }

    #[test]
    fn ends_of_every_kind() {
        let whole = vec![(1, "a", true), (2, "", true), (3, "b", true)];
        for text in ["a\n\nb\n", "a\r\n\r\nb\r\n", "a\r\n\nb\r\n", "a\r\rb\r"] {
            assert_eq!(texts(text), whole, "{text:?}");
        }
    }

    #[test]
    fn a_missing_end_is_marked() {
        assert_eq!(texts("a\nb"), vec![(1, "a", true), (2, "b", false)]);
        assert_eq!(texts("a\r\nb\r"), vec![(1, "a", true), (2, "b\r", false)]);
        assert_eq!(texts(""), vec![]);
    }
}
