//! Pages that stand already: a page of runs whose outline, curves and frame are those that a page of the report before was
//! made from is that page, and is taken over. A hash over all of them stands for them; a file of the report lists the hashes.

use std::collections::BTreeMap;
use std::io;

use ieap_analysis::cache::Cache;

/// File of the list, one file of the report a line: what it was made from, two blanks, its path.
pub const FILE: &str = ".made";

/// The files that were made from what has that hash.
pub type Made = BTreeMap<String, Vec<String>>;

/// A report that stands.
pub struct Earlier<'a> {
    /// Files of it that are as they were written, by what they were made from.
    pub made: Made,
    /// Takes files of it over under their names, all or none. Says whether that was done; they are made anew else.
    pub take: &'a (dyn Fn(&[String]) -> io::Result<bool> + Sync),
    /// Values that took long to make.
    pub values: Option<&'a Cache>,
}

impl Earlier<'_> {
    /// None.
    pub fn none() -> Earlier<'static> {
        Earlier {
            made: Made::new(),
            take: &|_| Ok(false),
            values: None,
        }
    }

    /// Takes over what was made from what has that hash; none where it is not there, or not as it was.
    ///
    /// # Errors
    /// What the system says.
    pub fn take(&self, hash: &str) -> io::Result<Option<&[String]>> {
        match self.made.get(hash) {
            Some(files) if (self.take)(files)? => Ok(Some(files)),
            _ => Ok(None),
        }
    }
}

/// The list as text.
pub fn text(made: &Made) -> String {
    let lines = made
        .iter()
        .flat_map(|(hash, files)| files.iter().map(move |file| format!("{hash}  {file}\n")));
    lines.collect()
}

/// What a list says, without what has a file for which `is_whole` says no. A line that is none is passed over.
pub fn read(text: &str, is_whole: impl Fn(&str) -> bool) -> Made {
    let mut made = Made::new();
    for (hash, file) in text.lines().filter_map(|line| line.split_once("  ")) {
        made.entry(hash.to_owned()).or_default().push(file.to_owned());
    }
    made.retain(|_, files| files.iter().all(|file| is_whole(file)));
    made
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_comes_back_without_what_is_not_whole() {
        let made: Made = [
            ("a", vec!["runs/a.html", "readings/a.js"]),
            ("b", vec!["runs/b.html"]),
        ]
        .map(|(hash, files)| (hash.to_owned(), files.into_iter().map(str::to_owned).collect()))
        .into();
        assert_eq!(read(&text(&made), |_| true), made);
        let left = read(&format!("torn\n{}", text(&made)), |file| file != "readings/a.js");
        assert_eq!(left.keys().collect::<Vec<_>>(), ["b"]);
    }

    #[test]
    fn what_is_not_there_is_not_taken() {
        let take = |files: &[String]| Ok(!files.contains(&"lost".to_owned()));
        let earlier = Earlier {
            made: read("a  one\nb  two\nb  lost\n", |_| true),
            take: &take,
            values: None,
        };
        assert_eq!(earlier.take("a").unwrap(), Some(&["one".to_owned()][..]));
        assert_eq!(earlier.take("b").unwrap(), None);
        assert_eq!(earlier.take("c").unwrap(), None);
    }
}
