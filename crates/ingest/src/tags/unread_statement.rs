//! What is said of a statement that no file is read with.

use std::ffi::OsStr;
use std::path::Path;

use crate::campaign_file::nearest;
use crate::scan::compared;
use ieap_domain::Issue;

/// Code of what is said of a statement that no file is read with.
pub const UNREAD_STATEMENT: &str = "statement-unread";

/// What is said of a statement that no file is read with; `beside` are the names of the files in its folder that may be.
pub fn unread_statement(statement: &Path, beside: &[String]) -> Issue {
    let stem = |path: &Path| path.file_stem().unwrap_or_default().to_owned();
    let wanted = stem(statement);
    let same = compared(&wanted);
    let wanted = wanted.to_string_lossy();
    let with_stem = |name: &&String| compared(&stem(Path::new(name))) == same;
    let issue = |message: String| Issue::warning(UNREAD_STATEMENT, message);
    if beside.iter().any(|name| compared(OsStr::new(name)) == same) {
        let message = format!("no run is tagged by it: \"{wanted}\" beside it holds none");
        return issue(message).mend("delete it; of sensors campaign.toml states what is to be known");
    }
    let message = format!("no run is tagged by it: there is no file \"{wanted}\" beside it");
    let near = beside.iter().find(with_stem).map(String::as_str);
    let near = near.or_else(|| nearest(&wanted, beside.iter().map(String::as_str)));
    issue(message).mend(match near {
        Some(near) => format!("rename it to \"{near}.toml\" if it is for \"{near}\", or delete it"),
        None => "give it the whole name of its file with .toml behind it, or delete it".to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_that_is_meant_is_named() {
        let beside = ["b.csv".to_owned(), "run 1.dta".to_owned(), "log.csv".to_owned()];
        let mend = |name: &str| unread_statement(Path::new(name), &beside).mend;
        assert!(mend("bb.csv.toml").starts_with("rename it to \"b.csv.toml\""));
        assert!(mend("run 1.toml").starts_with("rename it to \"run 1.dta.toml\""));
        assert!(mend("something else.toml").starts_with("give it the whole name"));
        assert!(mend("log.csv.toml").starts_with("delete it"));
    }
}
