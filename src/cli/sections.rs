//! What `ieap status` lists: sections of names with what is said of them, in which no name is printed twice. A name that belongs
//! to several sections is printed in the first, with what the later ones say of it; these only count it. What is longer than a
//! screen is shortened, the longest section first, and says how much it leaves out.

use std::collections::{BTreeSet, HashMap};
use std::fmt::Write;

use super::output::Output;
use crate::domain::words::counted;
use crate::domain::{Issue, Severity};
use crate::pipeline::infra::mends::{Reasoned, Together, together};

/// Lines that are shown without `--verbose`. Chosen: a screen.
const MOST_LINES: usize = 40;

/// The sections and entries that each name is in, in order.
type Mentions<'s> = HashMap<&'s str, Vec<(usize, &'s Entry)>>;

/// Sections in the order of their printing.
#[derive(Debug, Default)]
pub struct Sections {
    list: Vec<Section>,
}

/// A heading, what is said below it, and names.
#[derive(Debug, Default)]
struct Section {
    heading: String,
    entries: Vec<Entry>,
}

impl Section {
    /// Its heading, with the number of its names that an earlier section has.
    fn heading_beside(&self, mentions: &Mentions<'_>, at: usize) -> String {
        let names = self.entries.iter().flat_map(|entry| &entry.names);
        let above: BTreeSet<&String> = names.filter(|name| mentions[name.as_str()][0].0 < at).collect();
        match (above.len(), self.heading.strip_suffix(':')) {
            (0, _) | (_, None) => self.heading.clone(),
            (above, Some(heading)) => format!("{heading} ({above} named above):"),
        }
    }
}

/// Names of which the same is said.
#[derive(Debug, Default)]
struct Entry {
    names: Vec<String>,
    lines: Vec<String>,
}

impl Sections {
    /// A line by itself.
    pub fn say(&mut self, text: &str) {
        self.list.push(Section {
            heading: text.to_owned(),
            entries: Vec::new(),
        });
    }

    /// Something under the last heading, with its mend, of which no name is given.
    pub fn issue(&mut self, issue: &Issue) {
        self.entry(Vec::new(), lines_of(issue));
    }

    /// Names under the last heading, with what is said of them all.
    pub fn entry(&mut self, names: Vec<String>, lines: Vec<String>) {
        if let Some(section) = self.list.last_mut() {
            section.entries.push(Entry { names, lines });
        }
    }

    /// Names alone.
    pub fn list(&mut self, thing: &str, title: &str, names: &[String]) {
        if !names.is_empty() {
            self.say(&format!("{} {title}:", counted(names.len(), thing)));
            self.entry(names.to_vec(), Vec::new());
        }
    }

    /// Files or runs with the reasons for their state, notes left aside; what is said of several alike is said once.
    pub fn section(&mut self, thing: &str, title: &str, entries: &[Reasoned]) {
        if entries.is_empty() {
            return;
        }
        self.say(&format!("{} {title}:", counted(entries.len(), thing)));
        let worth = |entry: &Reasoned| -> Vec<Issue> {
            let issues = entry.issues.iter().cloned();
            issues.filter(|issue| issue.severity > Severity::Note).collect()
        };
        self.alike(&together(
            entries.iter().map(|entry| (entry.path.as_str(), worth(entry))),
        ));
    }

    /// Files or runs of which the same is said, under the last heading.
    pub fn alike(&mut self, told: &[Together]) {
        for one in told {
            let lines = one.issues.iter().flat_map(lines_of).collect();
            self.entry(one.paths.clone(), lines);
        }
    }

    /// Prints them, of a long list as much as a screen shows; all of it with `--verbose`.
    pub fn print(&self, output: &Output) {
        let most_lines = if output.is_verbose() {
            usize::MAX
        } else {
            MOST_LINES
        };
        self.text(most_lines).lines().for_each(|line| output.result(line));
    }

    /// Their text in at most so many lines, but that each heading stands.
    fn text(&self, most_lines: usize) -> String {
        let mentions = self.mentions();
        let text = |at: usize, names: usize| self.section_text(&mentions, at, names);
        let mut sections: Vec<(usize, String)> = (0..self.list.len())
            .map(|at| (self.names_in(at), text(at, usize::MAX)))
            .collect();
        let lines = |text: &String| text.lines().count();
        // One line says how all of it is seen.
        while sections.iter().map(|(_, text)| lines(text)).sum::<usize>() + 1 > most_lines {
            let long = (0..sections.len()).filter(|at| sections[*at].0 > 0);
            let Some(longest) = long.max_by_key(|at| (lines(&sections[*at].1), *at)) else {
                break;
            };
            let names = sections[longest].0 / 2;
            sections[longest] = (names, text(longest, names));
        }
        let is_short = (0..sections.len()).any(|at| sections[at].0 < self.names_in(at));
        let mut all: String = sections.into_iter().map(|(_, text)| text).collect();
        if is_short {
            all.push_str("all of it: the same command with --verbose\n");
        }
        all
    }

    /// Names and sayings without one that a section has.
    fn names_in(&self, at: usize) -> usize {
        let entries = self.list[at].entries.iter();
        entries.map(|entry| entry.names.len().max(1)).sum()
    }

    /// The text of a section with so many of its names.
    fn section_text(&self, mentions: &Mentions<'_>, at: usize, mut left: usize) -> String {
        let section = &self.list[at];
        let mut text = section.heading_beside(mentions, at) + "\n";
        let mut hidden = 0;
        for entry in &section.entries {
            let is_first = |name: &&String| std::ptr::eq(mentions[name.as_str()][0].1, entry);
            let own: Vec<&String> = entry.names.iter().filter(is_first).collect();
            if own.is_empty() && !entry.names.is_empty() {
                continue;
            }
            let shown = own.len().min(left);
            hidden += own.len() - shown;
            let is_told = left > 0;
            left = left.saturating_sub(own.len().max(1));
            if !is_told {
                hidden += usize::from(own.is_empty());
                continue;
            }
            let lines = entry.lines.iter().map(|line| format!("      {line}\n"));
            match own.as_slice() {
                [] => text.extend(lines),
                [only] => {
                    let _ = writeln!(text, "  {only}");
                    text.extend(lines);
                    self.later(&mentions[only.as_str()], &mut text);
                }
                several => {
                    for name in &several[..shown] {
                        let _ = writeln!(text, "  {name}");
                        self.later(&mentions[name.as_str()], &mut text);
                    }
                    if shown < several.len() {
                        let _ = writeln!(text, "  ... and {} more", several.len() - shown);
                        hidden -= several.len() - shown;
                    }
                    text.extend(lines);
                }
            }
        }
        if hidden > 0 {
            let _ = writeln!(text, "  ... and {hidden} more");
        }
        text
    }

    /// What comes after the first mention of a name, each section by the beginning of its heading.
    fn later(&self, mentions: &[(usize, &Entry)], text: &mut String) {
        let mut last = mentions[0].0;
        for (at, entry) in &mentions[1..] {
            if *at != last {
                let heading = self.list[*at].heading.trim_end_matches(':');
                let heading = heading.split([':', '(', ';']).next().unwrap_or_default();
                let _ = writeln!(text, "      also among {}", heading.trim_end());
                last = *at;
            }
            text.extend(entry.lines.iter().map(|line| format!("      {line}\n")));
        }
    }

    /// The sections and entries that each name is in, in order.
    fn mentions(&self) -> Mentions<'_> {
        let mut found = Mentions::new();
        for (at, section) in self.list.iter().enumerate() {
            for entry in &section.entries {
                for name in &entry.names {
                    found.entry(name).or_default().push((at, entry));
                }
            }
        }
        found
    }
}

/// An issue with its place, and the way to mend it.
fn lines_of(issue: &Issue) -> Vec<String> {
    let place = if issue.place.is_empty() {
        String::new()
    } else {
        format!("{}: ", issue.place)
    };
    let mut lines = vec![format!("{place}{}", issue.message)];
    if !issue.mend.is_empty() {
        lines.push(format!("-> {}", issue.mend));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(path: &str, message: &str) -> Reasoned {
        Reasoned {
            path: path.to_owned(),
            issues: vec![Issue::warning("code", message).mend("mend it")],
        }
    }

    #[test]
    fn a_name_is_printed_once_with_all_that_is_said_of_it() {
        let mut sections = Sections::default();
        sections.section(
            "run",
            "without tags",
            &[named("x1", "no sample"), named("y2", "no sample")],
        );
        sections.section(
            "run",
            "without a response",
            &[named("y2", "no current"), named("z3", "no time")],
        );
        sections.list("run", "not covered", &["x1".to_owned(), "z3".to_owned()]);
        assert_eq!(
            sections.text(usize::MAX),
            "2 runs without tags:\n  x1\n      also among 2 runs not covered\n  y2\n      also among 2 runs without a response\n      \
             no current\n      -> mend it\n      no sample\n      -> mend it\n2 runs without a response (1 named above):\n  z3\n      \
             no time\n      -> mend it\n      also among 2 runs not covered\n2 runs not covered (2 named above):\n"
        );
    }

    #[test]
    fn what_is_longer_than_a_screen_is_shortened_and_says_so() {
        let mut sections = Sections::default();
        let runs: Vec<String> = (0..300).map(|k| format!("runs/{k:03}.csv")).collect();
        let each: Vec<Reasoned> = runs
            .iter()
            .map(|run| named(run, &format!("waits for {run}.txt")))
            .collect();
        sections.section("run", "alone", &each);
        sections.list("file", "gone", &["z".to_owned()]);
        sections.list("run", "not covered", &runs);
        let others: Vec<String> = (0..50).map(|k| format!("condition {k}")).collect();
        sections.list("condition", "without a run", &others);
        let text = sections.text(MOST_LINES);
        assert!((30..=MOST_LINES).contains(&text.lines().count()), "{text}");
        for said in [
            "300 runs alone:\n  runs/000.csv\n",
            "  z\n",
            "300 runs not covered",
            "50 conditions",
            " more\n",
            "--verbose\n",
        ] {
            assert!(text.contains(said), "{said} in {text}");
        }
        assert!(sections.text(usize::MAX).lines().count() > 600);
    }

    #[test]
    fn of_one_section_a_name_stands_once_too() {
        let mut sections = Sections::default();
        sections.say("2 tag keys:");
        sections.alike(&together([
            ("a", vec![Issue::warning("code", "foo")]),
            ("a", vec![Issue::warning("code", "bar")]),
        ]));
        let text = sections.text(usize::MAX);
        assert_eq!(text.matches("  a\n").count(), 1, "{text}");
        assert!(text.contains("foo") && text.contains("bar"), "{text}");
    }
}
