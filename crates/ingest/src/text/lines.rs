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

/// The lines of a text. Where each line is one quoted cell as a whole, as spreadsheets write a table that was pasted into one column,
/// it is what stands in the quotes.
pub fn lines_of(text: &str) -> Vec<Line<'_>> {
    fn inner<'a>(line: &Line<'a>) -> Option<&'a str> {
        let inner = line.text.trim().strip_prefix('"')?.strip_suffix('"')?;
        (!inner.contains('"') && inner.contains([',', ';', '\t'])).then_some(inner)
    }
    let mut lines: Vec<Line<'_>> = Lines::new(text).collect();
    // A last line may be cut.
    let (last, whole) = lines
        .split_last()
        .map_or((None, &[][..]), |(last, whole)| (Some(last), whole));
    let filled = |line: &&Line<'_>| !line.text.trim().is_empty();
    let are_quoted = whole.len() > 1 && whole.iter().filter(filled).all(|line| inner(line).is_some());
    if are_quoted && last.is_some() {
        for line in &mut lines {
            line.text = inner(line).unwrap_or(line.text);
        }
    }
    lines
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
