//! File names with `*` and `?`.

/// A pattern of a file name; letter case does not count.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Glob(glob::Pattern);

impl Glob {
    /// The pattern; `*` stands for any letters, `?` for one, and every other letter for itself, brackets too.
    pub fn new(pattern: &str) -> Glob {
        let mut plain = pattern.to_lowercase().replace('[', "[[]");
        while plain.contains("**") {
            plain = plain.replace("**", "*");
        }
        let parsed = glob::Pattern::new(&plain);
        Glob(parsed.expect("without brackets and double stars every text is a pattern"))
    }

    /// Whether a name fits.
    pub fn fits(&self, name: &str) -> bool {
        self.0.matches(&name.to_lowercase())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stars_and_question_marks() {
        for (pattern, name, fits) in [
            ("*.csv", "a.csv", true),
            ("*.csv", "a.CSV", true),
            ("laser_*_?.txt", "laser_x_y_1.txt", true),
            ("laser_*_?.txt", "laser_1.txt", false),
            ("a*b*c", "aXbYbZc", true),
            ("a*b*c", "aXbYbZ", false),
            ("", "a", false),
            ("*", "", true),
            ("a***b", "aXYb", true),
            ("run[1]*.txt", "RUN[1]_a.txt", true),
            ("run[1]*.txt", "run1_a.txt", false),
            ("a]?", "A]é", true),
            ("É*.csv", "é1.csv", true),
        ] {
            assert_eq!(Glob::new(pattern).fits(name), fits, "{pattern} {name}");
        }
    }
}
