//! Where the lines of a text begin, so that many places of it are named without counting from its beginning each time.

/// The beginnings of the lines of a text.
pub(super) struct Lines<'a> {
    text: &'a str,
    /// Byte offset of each line, the first one at 0.
    begins: Vec<usize>,
}

impl<'a> Lines<'a> {
    /// Looks through the text once.
    pub fn of(text: &'a str) -> Lines<'a> {
        let after = text.match_indices('\n').map(|(at, _)| at + 1);
        Lines {
            text,
            begins: std::iter::once(0).chain(after).collect(),
        }
    }

    /// Line and column (from 1, in characters) of a byte offset.
    pub fn place(&self, offset: usize) -> (usize, usize) {
        let line = self.begins.partition_point(|begin| *begin <= offset).max(1);
        let begin = self.begins[line - 1];
        let before = self.text.get(begin..offset).unwrap_or("");
        (line, before.chars().count() + 1)
    }
}

/// Line and column (from 1, in characters) of a byte offset in `text`.
pub(crate) fn line_and_column(text: &str, offset: usize) -> (usize, usize) {
    let before = text.get(..offset).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |at| at + 1);
    let line = before.matches('\n').count() + 1;
    (line, before[line_start..].chars().count() + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_those_that_counting_gives() {
        for text in ["", "a", "\n", "a\n\nµ = 2\r\nlast", "x\n"] {
            let lines = Lines::of(text);
            for (offset, _) in text.char_indices().chain([(text.len(), ' ')]) {
                assert_eq!(
                    lines.place(offset),
                    line_and_column(text, offset),
                    "{text:?} {offset}"
                );
            }
        }
    }
}
